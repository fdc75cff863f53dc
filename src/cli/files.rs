//! What each command reads and writes: all of it is declared here, before the command begins.

use super::{Cli, Command};
use crate::failure::Failure;
use base::output::{Files, OutputKind, Outputs, Partials};
use std::path::{Path, PathBuf};

/// Checks the files of the command that was asked for; gives what it may write.
pub(super) fn check(cli: &Cli, partials: &Partials) -> Result<Outputs, Failure> {
    let mut files = Files::default();
    if cli.shared.force {
        files.force();
    }
    if let Some(config) = &cli.shared.config {
        files.reads("the settings", config);
    }
    files.scans_end_in(points::format_endings());
    for scan in scans(&cli.command) {
        files.reads("a scan", scan);
    }
    match &cli.command {
        Command::View(args) => {
            args.pose_path.iter().for_each(|path| files.reads("the pose path", path));
            args.log.iter().for_each(|path| files.writes("--log", path, OutputKind::FrameLog));
        }
        Command::Render(args) => {
            for path in of_eyes("-o", &args.out, args.stereo)? {
                files.writes("-o", &path, OutputKind::Picture);
            }
            if let Some(depth) = &args.depth {
                for path in of_eyes("--depth", depth, args.stereo)? {
                    files.writes("--depth", &path, OutputKind::Depth);
                }
            }
            args.metrics.iter().for_each(|path| files.writes("--metrics", path, OutputKind::Metrics));
        }
        Command::Synth(args) => files.writes("-o", &args.out, lab::synth::SCAN),
        Command::Bench(args) => {
            files.prints();
            args.out.iter().for_each(|path| files.writes("-o", path, OutputKind::Page));
        }
        Command::Report(args) => {
            files.prints();
            args.files.iter().for_each(|path| files.reads("a log or results", path));
            args.out.iter().for_each(|path| files.writes("-o", path, OutputKind::Page));
            args.worst_poses.iter().for_each(|path| files.writes("--worst-poses", path, OutputKind::Poses));
        }
        Command::Info(_) | Command::Settings(_) | Command::Doctor(_) => files.prints(),
        // This command is not there yet: it writes nothing.
        Command::Convert(_) => {}
    }
    Ok(files.check(partials)?)
}

fn scans(command: &Command) -> &[PathBuf] {
    match command {
        Command::View(args) => &args.scans,
        Command::Render(args) => &args.scans,
        Command::Info(args) => &args.scans,
        Command::Convert(args) => &args.scans,
        Command::Bench(args) => args.scan.as_slice(),
        Command::Synth(_) | Command::Report(_) | Command::Settings(_) | Command::Doctor(_) => &[],
    }
}

/// Names the files of the eyes: `OUT.png`, or with `stereo` `OUT.left.png` and `OUT.right.png`.
fn of_eyes(option: &str, path: &Path, stereo: bool) -> Result<Vec<PathBuf>, Failure> {
    if !stereo {
        return Ok(vec![path.to_path_buf()]);
    }
    if path == Path::new("-") {
        return Err(Failure::Usage(format!(
            "{option} - with --stereo: two do not fit into stdout; name a file"
        )));
    }
    let ending = path.extension().map(|e| format!(".{}", e.display())).unwrap_or_default();
    Ok(["left", "right"].map(|side| path.with_extension(format!("{side}{ending}"))).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stereo_files_say_which_eye() {
        let names =
            |path: &str, stereo| of_eyes("-o", Path::new(path), stereo).map_err(|error| error.to_string());
        assert_eq!(names("a/b.png", true), Ok(vec!["a/b.left.png".into(), "a/b.right.png".into()]));
        assert_eq!(names("a/b.v2.npy", true).unwrap()[1], Path::new("a/b.v2.right.npy"));
        assert_eq!(names("b.png", false), Ok(vec!["b.png".into()]));
        assert!(names("-", true).unwrap_err().contains("stdout"));
    }
}
