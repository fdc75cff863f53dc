//! `scanwalk report`: what measurements say, as text on stdout, and as a page if one is wanted.

use super::ReportArgs;
use crate::failure::Failure;
use base::output::{Output, OutputKind, Outputs};
use lab::report::{BenchResults, Comparison, Summary, bench_markdown, bench_page, walk_page, worst_poses};
use std::io::{self, Write};
use std::path::Path;
use timing::{self, FrameLogFile};

/// Reads what is named, writes the files that are wanted, prints the text.
pub(super) fn run(args: &ReportArgs, mut outputs: Outputs) -> Result<(), Failure> {
    let (text, page) = match &args.files[..] {
        files if !files.is_empty() && files.iter().all(|file| is_json(file)) => {
            refuse_poses(args)?;
            let runs: Vec<_> = files.iter().map(|file| BenchResults::read(file)).collect::<Result<_, _>>()?;
            let results = BenchResults::merged(runs).map_err(|[one, other]| {
                Failure::Usage(format!(
                    "report: results of one GPU make one page, not those of {one} and {other}"
                ))
            })?;
            (results.to_string(), args.out.as_ref().map(|out| bench_document(&results, out)))
        }
        _ if args.out.as_ref().is_some_and(|out| has_ending(out, "md")) => {
            return Err(Failure::Usage(
                "report: of a frame log a page is made, so -o must end in .html".into(),
            ));
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
                let problem = "report: a frame log and benchmark results cannot be compared";
                return Err(Failure::Usage(problem.into()));
            }
            let names = [a, b].map(|path| path.display().to_string());
            let comparison = Comparison::of(names, [&timing::read(a)?, &timing::read(b)?]);
            (comparison.to_string(), args.out.is_some().then(|| comparison.page()))
        }
        files => return Err(Failure::Usage(format!("report: one file or two, not {}", files.len()))),
    };
    if let Some((output, page)) = outputs.take_one(OutputKind::Page).zip(page) {
        output.write(page.as_bytes())?;
    }
    write!(io::stdout().lock(), "{text}")?;
    Ok(())
}

/// Formats results as the file's ending says: as Markdown tables, or as a page.
pub(super) fn bench_document(results: &BenchResults, out: &Path) -> String {
    if has_ending(out, "md") { bench_markdown(results) } else { bench_page(results) }
}

fn is_json(path: &Path) -> bool {
    has_ending(path, "json")
}

fn has_ending(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(wanted))
}

fn refuse_poses(args: &ReportArgs) -> Result<(), Failure> {
    match args.worst_poses {
        None => Ok(()),
        Some(_) => Err(Failure::Usage("report: --worst-poses needs one frame log".into())),
    }
}

fn write_poses(log: &FrameLogFile, file: &Path, output: &Output) -> Result<(), Failure> {
    let poses = worst_poses(log).ok_or_else(|| {
        Failure::Input(format!(
            "{} has no head poses with GPU times; log the walk again with this version's `scanwalk view --log`",
            file.display()
        ))
    })?;
    Ok(output.write(poses.to_string().as_bytes())?)
}
