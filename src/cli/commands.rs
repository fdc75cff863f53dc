//! From arguments to work: resolves the settings, refuses what does not exist yet, calls the command.

use super::{Cli, Command, ReportArgs, Usage, doctor};
use crate::config::{self, Config};
use crate::progress::Stop;
use crate::timing::{self, Report};
use std::io::{self, Write};

/// Runs the command that was asked for.
pub(super) fn run(cli: &Cli, stop: &Stop) -> anyhow::Result<()> {
    let mut config = config::load(cli.shared.config.as_deref(), &cli.shared.set)?;
    if let Some(adapter) = &cli.shared.adapter {
        config.gpu.adapter.clone_from(adapter);
    }
    match &cli.command {
        Command::View(args) => landing::view(args, config, stop.clone()),
        Command::Render(args) => {
            args.check()?;
            args.apply_to(&mut config);
            landing::render(args, &config, stop)
        }
        Command::Info(args) => landing::info(&args.scans, args.json, stop),
        Command::Synth(args) => landing::synth(args, stop),
        Command::Report(args) => report(args),
        Command::Doctor(args) => doctor::run(&config, args.json),
        Command::Convert(_) => Err(not_there_yet("convert", "LAS and LAZ files can be viewed as they are")),
        Command::Bench(_) => Err(not_there_yet("bench", "`scanwalk view --log` measures a walk")),
    }
}

/// A command that the contract names and nobody has built: wrong usage, said kindly.
fn not_there_yet(command: &str, instead: &str) -> anyhow::Error {
    Usage(format!("{command} does not exist yet; {instead}")).into()
}

fn report(args: &ReportArgs) -> anyhow::Result<()> {
    if args.out.is_some() {
        let sentence = "report: -o does not exist yet; without it the report is printed";
        return Err(Usage(sentence.into()).into());
    }
    let report = Report::of(&timing::read(&args.log)?);
    write!(io::stdout().lock(), "{report}")?;
    Ok(())
}

/// Commands whose parts land separately: each body becomes the one call that its comment shows.
mod landing {
    use super::{Config, Stop};
    use crate::cli::{RenderArgs, SynthArgs, ViewArgs};
    use anyhow::bail;
    use std::path::PathBuf;

    /// `view::run(args, config, stop)`
    pub fn view(_args: &ViewArgs, _config: Config, _stop: Stop) -> anyhow::Result<()> {
        bail!("this build has no view command")
    }

    /// `shot::run(args, config, stop)`
    pub fn render(_args: &RenderArgs, _config: &Config, _stop: &Stop) -> anyhow::Result<()> {
        bail!("this build has no render command")
    }

    /// `scan::info::print(scans, json, stop)`
    pub fn info(_scans: &[PathBuf], _json: bool, _stop: &Stop) -> anyhow::Result<()> {
        bail!("this build has no info command")
    }

    /// `synth::write(&SynthOptions { kind, out, points, seed }, stop)`, with `synth::Kind` in place of
    /// [`SynthKind`](crate::cli::SynthKind).
    pub fn synth(_args: &SynthArgs, _stop: &Stop) -> anyhow::Result<()> {
        bail!("this build has no synth command")
    }
}
