//! `scanwalk report`: what measurements say, as text on stdout, and as a page if one is wanted.

use super::{ReportArgs, Usage};
use crate::output::{Output, OutputKind, Outputs};
use crate::report::{BenchResults, Comparison, Summary, bench_page, walk_page, worst_poses};
use crate::timing::{self, FrameLogFile};
use anyhow::Context;
use std::io::{self, Write};
use std::path::Path;

/// Reads what is named, writes the files that are wanted, prints the text.
pub(super) fn run(args: &ReportArgs, mut outputs: Outputs) -> anyhow::Result<()> {
    let (text, page) = match &args.files[..] {
        [file] if is_json(file) => {
            refuse_poses(args)?;
            let results = BenchResults::read(file)?;
            (results.to_string(), args.out.is_some().then(|| bench_page(&results)))
        }
        [file] => {
            let log = timing::read(file)?;
            if let Some(output) = outputs.take_one(OutputKind::Poses) {
                write_poses(&log, file, &output)?;
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
    if let Some((output, page)) = outputs.take_one(OutputKind::Page).zip(page) {
        output.write(page.as_bytes())?;
    }
    write!(io::stdout().lock(), "{text}")?;
    Ok(())
}

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
}

fn refuse_poses(args: &ReportArgs) -> Result<(), Usage> {
    match args.worst_poses {
        None => Ok(()),
        Some(_) => Err(Usage("report: --worst-poses needs one frame log".into())),
    }
}

fn write_poses(log: &FrameLogFile, file: &Path, output: &Output) -> anyhow::Result<()> {
    let poses = worst_poses(log).with_context(|| {
        format!(
            "{} has no head poses with GPU times; log the walk again with this version's `scanwalk view --log`",
            file.display()
        )
    })?;
    Ok(output.write(poses.to_string().as_bytes())?)
}
