//! Faults in every phase of a walk: while the headset is opened, the scan is read, its octree is built, the user walks, has
//! the menu open. Whatever happens and whenever, the scan is walked at the end, the log has every frame, and the program
//! can be left.
//!
//! `SCANWALK_PHASES=TABLE.csv` has every fault happen in every phase, and writes what has come of it.

use crate::recovery::{
    GOES_ON, HITCHES, LOSSES, TAKEN, assert_place_is_kept, end, log_file, start_with, wait_for_rows,
};
use crate::scene::ViewedScans;
use kit::rows::LogRows;
use kit::wait::wait_for;
use kit::xr::poses::{Packet, Remote, RemoteHand, RemotePose};
use kit::xr::{Running, RuntimeSlot};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Instant;

/// Where a walk is when a fault happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FaultPhase {
    /// The session has just begun.
    Opening,
    /// The scan is read.
    Reading,
    /// The octree is built, and sent as far as it has come.
    Building,
    /// All of the scan is there.
    Walking,
    /// So it is, and the menu is open.
    Menu,
}

use FaultPhase::{Building, Menu, Opening, Reading, Walking};

/// What comes of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fate {
    /// The headset is lost, and taken again.
    Retaken,
    /// It costs frames.
    Hitch,
    /// The runtime does not answer any more; the user leaves.
    Left,
}

/// A fault of the layer's without the frame in which it happens, what comes of it, and words by which the user is told.
type PlannedFault = (String, Fate, &'static str);

fn faults() -> Vec<PlannedFault> {
    let name = |fault: &str| fault.split(':').next().expect("a name").to_owned();
    let lost = LOSSES.iter().map(|(fault, words)| (name(fault), Fate::Retaken, *words));
    let others = [
        ("devicelost", Fate::Retaken, "the GPU was lost"),
        ("hang", Fate::Left, "left without waiting"),
        ("hangbegin", Fate::Left, "left without waiting"),
    ];
    let hitches = HITCHES.iter().map(|(fault, words)| (name(fault), Fate::Hitch, *words));
    let others = others.map(|(fault, fate, words)| (fault.to_owned(), fate, words));
    lost.chain(others).chain(hitches).collect()
}

/// Faults that a run of all tests goes through: each phase, and each fate where it is hardest. Walking with all other
/// faults is in [`crate::recovery`].
const CHOSEN: [(&str, FaultPhase); 8] = [
    ("sessionlost", Opening),
    ("instancelost", Reading),
    ("devicelost", Building),
    ("devicelost", Walking),
    ("sessionlost", Menu),
    ("waiterr", Reading),
    ("hang", Building),
    ("hangbegin", Menu),
];

/// Points of the scan that takes long.
const NUM_POINTS: usize = 3_000_000;

/// A scan of text, which takes seconds to read and to build.
fn long_scan() -> &'static Path {
    static SCAN: OnceLock<PathBuf> = OnceLock::new();
    SCAN.get_or_init(|| {
        let mut text = format!("ply\nformat ascii 1.0\nelement vertex {NUM_POINTS}\n");
        for name in ["x", "y", "z"] {
            let _ = writeln!(text, "property double {name}");
        }
        text += "end_header\n";
        for i in 0..NUM_POINTS {
            let [x, y] = [i % 1731, i / 1731].map(|step| step as f64 * 0.015);
            let _ = writeln!(text, "{x:.4} {y:.4} {:.4}", 0.3 * x.sin() * y.cos());
        }
        let file = ViewedScans::get().file("long.ply");
        std::fs::write(&file, text).expect("the scan can be written");
        file
    })
}

/// A head, and hands, of which the right one presses the button of the menu or does not.
fn packet(menu: bool) -> Packet {
    let hand = |x: f32| RemotePose::at([x, 1.2, -0.4]);
    Packet {
        head: RemotePose::at([0.0, 1.6, 0.0]),
        left: RemoteHand { pose: hand(-0.25), ..RemoteHand::default() },
        right: RemoteHand { pose: hand(0.25), b_pressed: menu, ..RemoteHand::default() },
        ..Packet::default()
    }
}

/// Waits until a walk is in a phase. The device that presses the menu's button is kept as long as it is open.
fn reach(run: &mut Running, phase: FaultPhase, log: &Path) -> Option<Remote> {
    // Before the session is in focus a fault of it would be one of opening.
    run.wait_until_said("headset session: FOCUSED", 1);
    match phase {
        Opening => {}
        Reading => run.wait_until_said("reading begins", 1),
        Building => run.wait_until_said("building the octree begins", 1),
        Walking | Menu => {
            let walks = |rows: LogRows| rows.column("phase").contains(&"walking");
            wait_for("the walk", || LogRows::so_far(log).is_some_and(walks).then_some(()));
        }
    }
    (phase == Menu).then(|| {
        let mut remote = run.remote();
        remote.send(&packet(false));
        remote.send(&packet(true));
        run.wait_until_said("the menu is open", 1);
        remote.send(&packet(false));
        remote
    })
}

/// Has a fault happen in a phase, checks what comes of it, and returns the seconds until the session is in focus again
/// where it was lost.
fn go_through(lab: &RuntimeSlot, (fault, fate, words): &PlannedFault, phase: FaultPhase) -> Option<f64> {
    let cell = format!("{fault} while {phase:?}");
    let log = log_file("phases", &format!("{fault}-{phase:?}"));
    let calls = if *fate == Fate::Hitch { 5 } else { 1 };
    let mut runtime = lab.runtime().fault(&format!("{fault}:0:{calls}")).timeout_s(120);
    if phase != Opening {
        runtime = runtime.fault_waits();
    }
    let scan = if matches!(phase, Reading | Building) { long_scan() } else { &ViewedScans::get().courtyard };
    let mut run = start_with(scan, &runtime, "auto", &log);
    let mut remote = None;
    if phase != Opening {
        remote = reach(&mut run, phase, &log);
        run.let_fault_happen();
    }
    run.wait_until_said(&format!("faultlayer: {fault}"), calls);
    let happened = Instant::now();
    let shown_then = LogRows::so_far(&log).map(|rows| rows.column("phase").last().map(|s| s.to_string()));
    let mut retaken_s = None;
    match fate {
        Fate::Retaken => {
            run.wait_until_said(GOES_ON, 1);
            run.wait_until_said(TAKEN, 1);
            let before = if phase == Opening { 1 } else { 2 };
            run.wait_until_said("headset session: FOCUSED", before);
            retaken_s = Some(happened.elapsed().as_secs_f64());
            wait_for_rows(&run, &log, &["simulated", "FOCUSED"]);
        }
        Fate::Hitch => wait_for_rows(&run, &log, &["FOCUSED"]),
        Fate::Left => {}
    }
    if *fate != Fate::Left {
        // All of the scan comes, whatever was lost on the way.
        wait_for(&format!("the whole scan, {cell}"), || {
            let rows = LogRows::so_far(&log)?;
            let last = rows.column("phase").len().checked_sub(1)?;
            let is_there =
                rows.column("phase")[last] == "walking" && rows.column("session")[last] == "FOCUSED";
            is_there.then_some(())
        });
    }
    drop(remote);
    let done = end(run);
    assert!(done.stderr.contains(words), "{cell}: {}", done.stderr);
    if *fate == Fate::Hitch {
        assert!(!done.stderr.contains(GOES_ON), "{cell}: {}", done.stderr);
    }
    assert!(!done.stderr.contains("was not waited for"), "{cell}: {}", done.stderr);
    match (phase, shown_then.flatten().as_deref()) {
        (Reading, shown) => assert!(!matches!(shown, Some("arriving" | "walking")), "{cell}: {shown:?}"),
        (Building, shown) => assert_ne!(shown, Some("walking"), "{cell}"),
        (Walking | Menu, shown) => assert_eq!(shown, Some("walking"), "{cell}"),
        (Opening, _) => {}
    }
    if *fate == Fate::Left {
        // The log is whole: reading it to the end is no error.
        timing::read(&log).expect("a log");
    } else {
        assert_place_is_kept(&log);
    }
    retaken_s
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn faults_in_every_phase_leave_the_walk_alive() {
    let lab = RuntimeSlot::enter();
    let table = std::env::var_os("SCANWALK_PHASES").map(PathBuf::from);
    let mut lines = String::from("fault,phase,fate,told,retaken_s\n");
    for planned in faults() {
        for phase in [Opening, Reading, Building, Walking, Menu] {
            if table.is_none() && !CHOSEN.contains(&(planned.0.as_str(), phase)) {
                continue;
            }
            let retaken_s = go_through(&lab, &planned, phase);
            let (fault, fate, words) = &planned;
            let seconds = retaken_s.map_or(String::new(), |seconds| format!("{seconds:.1}"));
            eprintln!("{fault} while {phase:?}: {fate:?} {seconds}");
            let _ = writeln!(lines, "{fault},{phase:?},{fate:?},{words},{seconds}");
            if let Some(table) = &table {
                std::fs::write(table, &lines).expect("the table can be written");
            }
        }
    }
}
