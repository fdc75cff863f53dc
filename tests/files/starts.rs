//! What scans are taken for, and where walks through them begin: one table, docs/bench/starts/starts.csv.

use glam::DVec3;
use kit::frames::scan_of;
use kit::{made_up, real_scans, spread};
use lab::synth::SynthKind;
use points::{Scan, Scene};
use scanwalk::walk::start::{Start, start};
use std::path::Path;

/// Real scans, below the folder of them.
const REAL: [&str; 9] = [
    real_scans::ROOM,
    "laz-tls-tree/pine.laz",
    "ply/Guanyin.ply",
    "laz-aerial-autzen/autzen_trim.laz",
    "laz-aerial-nocolour-bcts/bcts_1.laz",
    "laz-aerial-rgbnir-ign/las_with_several_extra_byte_bloc.laz",
    "laz-tiles-lone-star/split-1.laz",
    "copc/lone-star.copc.laz",
    "las-small/sample_c.las",
];

/// A scan of `points`, in units of `unit_m` meters, on a grid of a thousandth of its size.
fn scan(points: impl Iterator<Item = DVec3>, unit_m: Option<f64>, step: f64) -> Scan {
    let xyz: Vec<[i32; 3]> = points.map(|p| (p / step).as_ivec3().to_array()).collect();
    let mut scan = scan_of(&xyz, step, DVec3::ZERO);
    (scan.unit_m, scan.scene) = (unit_m, Scene::of(&scan).0);
    scan
}

/// The surface of a thing that is `height` high and half as wide.
fn thing(height: f64) -> impl Iterator<Item = DVec3> {
    spread::directions(20_000).map(move |d| (d * DVec3::new(0.25, 0.25, 0.5) + DVec3::Z * 0.5) * height)
}

/// Hilly land of 5 km by 4.
fn landscape() -> impl Iterator<Item = DVec3> {
    (0..200_000).map(|i| {
        let [u, v] = [0.754_877_666_246_693, 0.569_840_290_998_053].map(|step| (f64::from(i) * step).fract());
        DVec3::new(5000.0 * u, 4000.0 * v, 120.0 * ((7.0 * u).sin() + (5.0 * v).cos()))
    })
}

/// Made-up scans, with their names.
fn made_up() -> Vec<(&'static str, Scan)> {
    let synth = |kind| made_up::scan(kind, 200_000, 1).expect("a scan");
    vec![
        ("made up: courtyard", synth(SynthKind::Terrestrial)),
        ("made up: statue", synth(SynthKind::Photogrammetry)),
        ("made up: 1 km² with a village", synth(SynthKind::Aerial)),
        ("made up: 5 km by 4", scan(landscape(), Some(1.0), 0.01)),
        ("made up: thing of 10 cm", scan(thing(0.1), Some(1.0), 1e-5)),
        ("made up: thing of 1.8 m", scan(thing(1.8), Some(1.0), 1e-4)),
        ("made up: thing of 1800 mm, unit said", scan(thing(1800.0), Some(1e-3), 0.1)),
        ("made up: thing of 1800 mm, unit not said", scan(thing(1800.0), None, 0.1)),
    ]
}

/// A scan's row: the start in meters from the middle of the scene's floor.
fn row(name: &str, scan: &Scan) -> String {
    let unit_m = scan.unit_m.unwrap_or(1.0);
    let Start { kind, standpoint, bounds, .. } = start(&scan.scene, unit_m, None);
    let from = (standpoint.floor_in_world - bounds.center().with_z(bounds.min.z)) * unit_m;
    let size = bounds.size() * unit_m;
    let meters = |v: DVec3| v.to_array().map(|m| format!("{m:.2}")).join(",");
    let (yaw_deg, scale) = (standpoint.yaw.to_degrees(), standpoint.scale);
    format!("{name},{},{},{},{yaw_deg:.0},{scale:.3}\n", meters(size), kind.name(), meters(from))
}

/// The test writes the table anew with `SCANWALK_BLESS=1`.
#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn scans_are_taken_for_what_they_are() {
    let folder = real_scans::folder();
    let real = REAL.map(|name| (name, real_scans::read_in(&folder, name).expect("a scan")));
    let mut table = "scan,size x (m),y,z,seen as,start x from the middle (m),y,floor above the lowest,yaw (degrees),size shown\n".to_owned();
    for (name, scan) in real.into_iter().chain(made_up()) {
        table += &row(name, &scan);
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/bench/starts/starts.csv");
    if std::env::var_os("SCANWALK_BLESS").is_some() {
        std::fs::write(&path, &table).expect("the table is written");
    }
    let kept = std::fs::read_to_string(&path).expect("the table");
    assert_eq!(table, kept, "`SCANWALK_BLESS=1 cargo test --test files starts` writes the table anew");
}
