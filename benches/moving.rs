//! What moving costs: frames while the user flies, turns, grabs the world, teleports and has the menu open, beside frames
//! while they stand, in a session of a real runtime without a headset. Prints CSV rows; `docs/bench/moving` keeps a run.
//!
//! `of_standing` is the median over that of the frames before, standing; `slower_than_standing_95` counts frames slower than
//! 95 % of those.

use anyhow::Result;
use base::percentile::Sorted;
use clap::Parser;
use kit::made_up;
use kit::rows::LogRows;
use kit::wait::wait_for;
use kit::xr::poses::{Packet, RemoteHand, RemotePose};
use kit::xr::{Running, RuntimeSlot};
use lab::synth::SynthKind;
use std::path::Path;

#[derive(Debug, Parser)]
struct Args {
    /// Millions of points of the made-up courtyard
    #[arg(long, value_name = "M", default_value_t = 2.0)]
    points: f64,
    /// Frames of each activity
    #[arg(long, value_name = "N", default_value_t = 100)]
    frames: usize,
    /// Few points and frames: shows that it works, not how fast
    #[arg(long)]
    quick: bool,
    /// Given by `cargo bench`; without it (`cargo test --benches`) the run is quick
    #[arg(long, hide = true)]
    bench: bool,
}

/// What the user does, in turns with standing.
const ACTIVITIES: [&str; 5] = ["flying", "turning", "grabbing", "teleporting", "menu"];

fn main() -> Result<()> {
    let mut args = Args::parse();
    if args.quick || !args.bench {
        (args.points, args.frames) = (0.05, 4);
    }
    if cfg!(not(feature = "with-runtime")) {
        println!("needs an OpenXR runtime, see scripts/headless-runtime: --features with-runtime");
        return Ok(());
    }
    let folder = tempfile::tempdir()?;
    let [scan, log] = ["courtyard.las", "log.csv"].map(|name| folder.path().join(name));
    made_up::file(&scan, SynthKind::Terrestrial, (1e6 * args.points) as u64, 1)?;
    let lab = RuntimeSlot::enter();
    let [scan, log_name] = [&scan, &log].map(|path| path.to_str().expect("a UTF-8 path"));
    let view = ["view", scan, "--headset", "require", "--window", "off", "--log", log_name];
    let settings = ["--set", "governor.enabled=false", "--set", "locomotion.turn=smooth"];
    let run = lab
        .runtime()
        .timeout_s(900)
        .start(Path::new(env!("CARGO_BIN_EXE_scanwalk")), &[&view[..], &settings].concat());
    let ranges = act(run, &log, args.frames);
    print(&LogRows::read(&log), &ranges);
    Ok(())
}

/// An activity and its frames in the log.
type Acted = (&'static str, std::ops::Range<usize>);

/// Stands and acts in turns, so many frames each.
fn act(mut run: Running, log: &Path, num_frames: usize) -> Vec<Acted> {
    let mut remote = run.remote();
    remote.send(&packet("standing", 0));
    let frames = || LogRows::so_far(log).map_or(0, |rows| rows.column("frame").len());
    wait_for("the whole scan", || LogRows::so_far(log)?.column("phase").contains(&"walking").then_some(()));
    let mut ranges = Vec::new();
    for activity in ACTIVITIES {
        for now in ["standing", activity] {
            // The first frames of an activity may still show the one before.
            let (begin, mut step) = (frames() + 3, 0);
            loop {
                let at = frames();
                remote.send(&packet(now, step));
                step += 1;
                if at >= begin + num_frames {
                    ranges.push((now, begin..begin + num_frames));
                    break;
                }
                wait_for("another frame", || (frames() > at).then_some(()));
            }
        }
        if activity == "menu" {
            remote.send(&packet(activity, 0));
        }
    }
    run.ask_to_end();
    run.finish().assert_ok();
    ranges
}

/// What the hands do in a step of an activity.
fn packet(activity: &str, step: usize) -> Packet {
    let hand = |x: f32, y: f32| RemoteHand { pose: RemotePose::at([x, y, -0.4]), ..RemoteHand::default() };
    let (mut left, mut right) = (hand(-0.25, 1.2), hand(0.25, 1.2));
    let swing = 0.1 * (step as f32 * 0.3).sin();
    match activity {
        "flying" => left.stick = [0.0, if step % 20 < 10 { 1.0 } else { -1.0 }],
        "turning" => right.stick = [1.0, 0.0],
        "grabbing" => {
            right = RemoteHand { squeeze: 1.0, squeeze_force: 1.0, ..hand(0.25 + swing, 1.2 + swing) };
        }
        // The arc is aimed for five steps, and let go for five.
        "teleporting" => right.stick = [0.0, if step % 10 < 5 { 1.0 } else { 0.0 }],
        // A short press opens it.
        "menu" => right.b_pressed = step < 2,
        _ => {}
    }
    Packet { head: RemotePose::at([0.0, 1.6, 0.0]), left, right, ..Packet::default() }
}

fn print(rows: &LogRows, ranges: &[Acted]) {
    println!(
        "activity,frames,missed,gpu_ms_median,gpu_ms_95,of_standing,slower_than_standing_95,\
         pose_age_ms_median,pose_age_ms_95"
    );
    let numbers = |column: &str| -> Vec<Option<f64>> {
        rows.column(column).into_iter().map(|cell| cell.parse().ok()).collect()
    };
    let (gpu, age, missed) = (numbers("gpu_ms"), numbers("pose_age_ms"), numbers("missed_periods"));
    let of = |all: &[Option<f64>], range: &std::ops::Range<usize>| -> Vec<f64> {
        all[range.clone()].iter().flatten().copied().collect()
    };
    let at = |sorted: &Sorted, per_mille| sorted.percentile(per_mille).unwrap_or(f64::NAN);
    for pair in ranges.chunks(2) {
        let standing = Sorted::new(of(&gpu, &pair[0].1));
        let (standing_median, standing_95) = (at(&standing, 500), at(&standing, 950));
        for (activity, range) in pair {
            let times = of(&gpu, range);
            let slower = times.iter().filter(|ms| **ms > standing_95).count();
            let (times, ages) = (Sorted::new(times), Sorted::new(of(&age, range)));
            let num_missed = of(&missed, range).iter().filter(|periods| **periods > 0.0).count();
            println!(
                "{activity},{},{num_missed},{:.2},{:.2},{:.3},{slower},{:.2},{:.2}",
                range.len(),
                at(&times, 500),
                at(&times, 950),
                at(&times, 500) / standing_median,
                at(&ages, 500),
                at(&ages, 950),
            );
        }
    }
}
