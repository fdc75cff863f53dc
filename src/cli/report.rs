//! `scanwalk report`: what measurements say, as text on stdout, and as a page if one is wanted.

use super::{ReportArgs, Usage};
use crate::report::{BenchResults, Comparison, Summary, bench_page, walk_page, worst_poses};
use crate::timing::{self, FrameLogFile};
use anyhow::Context;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Reads what is named, writes the files that are wanted, prints the text.
pub(super) fn run(args: &ReportArgs) -> anyhow::Result<()> {
    refuse_overwriting(args)?;
    let (text, page) = match &args.files[..] {
        [file] if is_json(file) => {
            refuse_poses(args)?;
            let results = BenchResults::read(file)?;
            (results.to_string(), args.out.is_some().then(|| bench_page(&results)))
        }
        [file] => {
            let log = timing::read(file)?;
            if let Some(out) = &args.worst_poses {
                write_poses(&log, file, out)?;
            }
            (Summary::of(&log).to_string(), args.out.is_some().then(|| walk_page(&log)))
        }
        [a, b] => {
            refuse_poses(args)?;
            if is_json(a) || is_json(b) {
                return Err(
                    Usage("report: two frame logs can be compared, benchmark results not".into()).into()
                );
            }
            let names = [a, b].map(|path| path.display().to_string());
            let comparison = Comparison::of(names, [&timing::read(a)?, &timing::read(b)?]);
            (comparison.to_string(), args.out.is_some().then(|| comparison.page()))
        }
        files => return Err(Usage(format!("report: one file or two, not {}", files.len())).into()),
    };
    if let Some((out, page)) = args.out.as_ref().zip(page) {
        std::fs::write(out, page).with_context(|| format!("the page {} cannot be written", out.display()))?;
    }
    write!(io::stdout().lock(), "{text}")?;
    Ok(())
}

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
}

/// A slip of the hand must not cost a log.
fn refuse_overwriting(args: &ReportArgs) -> Result<(), Usage> {
    let written: Vec<&PathBuf> = args.out.iter().chain(&args.worst_poses).collect();
    let is_same = |a: &Path, b: &Path| {
        a == b || std::fs::canonicalize(a).is_ok_and(|a| std::fs::canonicalize(b).is_ok_and(|b| a == b))
    };
    let read_too = written.iter().find(|out| args.files.iter().any(|file| is_same(file, out)));
    let written_twice = written.len() == 2 && is_same(written[0], written[1]);
    match read_too.or(written.first().filter(|_| written_twice)) {
        None => Ok(()),
        Some(out) => Err(Usage(format!("report: {} would be overwritten; name another file", out.display()))),
    }
}

fn refuse_poses(args: &ReportArgs) -> Result<(), Usage> {
    match args.worst_poses {
        None => Ok(()),
        Some(_) => Err(Usage("report: --worst-poses needs one frame log".into())),
    }
}

fn write_poses(log: &FrameLogFile, file: &Path, out: &Path) -> anyhow::Result<()> {
    let poses = worst_poses(log).with_context(|| {
        format!(
            "{} has no head poses with GPU times; log the walk again with this version's `scanwalk view --log`",
            file.display()
        )
    })?;
    poses.write(out)?;
    Ok(())
}
