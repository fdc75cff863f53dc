//! From arguments to work: resolves the settings, refuses what does not exist yet, calls the command.

use super::{
    Cli, Command, InfoArgs, RenderArgs, SynthArgs, ViewArgs, bench, doctor, files, report, settings,
};
use crate::config::{Config, ConfigError, load};
use crate::failure::Failure;
use crate::offscreen::{self, PictureFov, PictureOptions};
use crate::resolve::Plan;
use crate::view::{self, Threads, ViewOptions};
use base::output::{OutputKind, Outputs, Partials};
use base::task::{CancelToken, Task};
use lab::synth::{self, SynthOptions};
use std::io::Write;

/// Runs the command that was asked for.
pub(super) fn run(cli: &Cli, partials: &Partials, stop: &CancelToken) -> (Threads, Result<(), Failure>) {
    let mut threads = Threads::Ended;
    let result = run_with(cli, partials, stop, &mut threads);
    (threads, result)
}

fn run_with(
    cli: &Cli,
    partials: &Partials,
    stop: &CancelToken,
    threads: &mut Threads,
) -> Result<(), Failure> {
    let outputs = files::check(cli, partials)?;
    let config = config(cli)?;
    let plan = &Plan::of(&config);
    plan.draw.check().map_err(|error| Failure::Usage(error.to_string()))?;
    let task = &Task::in_terminal(stop);
    match &cli.command {
        Command::View(args) => view(args, outputs, plan, stop, threads),
        Command::Render(args) => render(args, outputs, plan, task),
        Command::Info(args) => info(args, plan, task),
        Command::Synth(args) => synth(args, outputs, task),
        Command::Report(args) => report::run(args, outputs),
        Command::Settings(args) => settings::run(args, &config),
        Command::Doctor(args) => doctor::run(&plan.adapter, args.json, stop),
        Command::Convert(_) => {
            let files = points::format_names("and") + " files";
            Err(not_there_yet("convert", &format!("{files} can be viewed as they are")))
        }
        Command::Bench(args) => bench::run(args, outputs, plan, task),
    }
}

/// Resolves all settings: afterwards nobody looks again at the options that they come from.
pub(super) fn config(cli: &Cli) -> Result<Config, ConfigError> {
    let presets: &[String] = match &cli.command {
        Command::View(args) => &args.preset,
        Command::Render(args) => &args.preset,
        Command::Settings(args) => &args.preset,
        _ => &[],
    };
    let mut config = load(presets, cli.shared.config.as_deref(), &cli.shared.set)?;
    if let Some(adapter) = &cli.shared.adapter {
        config.gpu.adapter.clone_from(adapter);
    }
    let strict = match &cli.command {
        Command::View(args) => args.strict,
        Command::Render(args) => args.strict,
        Command::Info(args) => args.strict,
        _ => false,
    };
    config.cloud.strict |= strict;
    if let Command::Render(args) = &cli.command {
        args.apply_to(&mut config);
    }
    Ok(config)
}

/// A command that the contract names and nobody has built: wrong usage, said kindly.
fn not_there_yet(command: &str, instead: &str) -> Failure {
    Failure::Usage(format!("{command} does not exist yet; {instead}"))
}

fn view(
    args: &ViewArgs,
    mut outputs: Outputs,
    plan: &Plan,
    stop: &CancelToken,
    threads: &mut Threads,
) -> Result<(), Failure> {
    let options = ViewOptions {
        scans: args.scans.clone(),
        headset: args.headset,
        window: args.window,
        log: outputs.take_one(OutputKind::FrameLog),
        frames: args.frames,
        seconds: args.seconds,
        pose_path: args.pose_path.clone(),
    };
    view::run(&options, plan, stop, threads)
}

fn render(args: &RenderArgs, mut outputs: Outputs, plan: &Plan, task: &Task) -> Result<(), Failure> {
    let options = PictureOptions {
        scans: args.scans.clone(),
        out: outputs.take(OutputKind::Picture),
        eye: args.eye,
        target: args.target,
        up: args.up,
        fov: match args.half_angles {
            Some(half_angles_deg) => PictureFov::HalfAngles(half_angles_deg),
            None => PictureFov::Vertical(args.fov_y),
        },
        size_px: args.size,
        stereo: args.stereo,
        ipd: args.ipd,
        depth: outputs.take(OutputKind::Depth),
        metrics: outputs.take_one(OutputKind::Metrics),
    };
    Ok(offscreen::run(&options, plan, task)?)
}

fn info(args: &InfoArgs, plan: &Plan, task: &Task) -> Result<(), Failure> {
    let say = if args.attributes { points::info::attributes_text } else { points::info::text };
    let text = say(&args.scans, args.json, &plan.read, task)?;
    Ok(std::io::stdout().lock().write_all(text.as_bytes())?)
}

fn synth(args: &SynthArgs, mut outputs: Outputs, task: &Task) -> Result<(), Failure> {
    let SynthArgs { kind, points, seed, .. } = *args;
    if let Some(out) = outputs.take_one(lab::synth::SCAN) {
        synth::write(&SynthOptions { kind, out, points, seed }, task)?;
    }
    Ok(())
}
