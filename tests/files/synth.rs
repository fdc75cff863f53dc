//! Made-up scans as a reader of the files sees them: exact counts, true boxes, the order and the habits of
//! each device, the same bytes again, nothing left behind when something goes wrong.

use base::output::{Files, Output, Partials};
use base::task::{CancelToken, Count, Task};
use lab::synth::{SynthError, SynthKind, SynthOptions, WrittenScan, viewpoints, write};
use las::{Point, Reader};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const KINDS: [SynthKind; 3] = [SynthKind::Terrestrial, SynthKind::Aerial, SynthKind::Photogrammetry];

/// An output that may take the place of a scan made before.
fn output(path: &Path) -> Output {
    let mut files = Files::default();
    files.force();
    files.writes("-o", path, lab::synth::SCAN);
    files.check(&Partials::default()).unwrap().take_one(lab::synth::SCAN).unwrap()
}

fn make(folder: &Path, name: &str, kind: SynthKind, points: u64, seed: u64) -> (PathBuf, WrittenScan) {
    let out = folder.join(name);
    let options = SynthOptions { kind, out: output(&out), points, seed };
    let summary = write(&options, &CancelToken::default()).unwrap();
    (out, summary)
}

fn read(path: &Path) -> (las::Header, Vec<Point>) {
    let mut reader = Reader::from_path(path).unwrap();
    let header = reader.header().clone();
    let points = reader.read_all().unwrap().points().map(Result::unwrap).collect();
    (header, points)
}

fn num_files(folder: &Path) -> usize {
    fs::read_dir(folder).unwrap().count()
}

#[test]
fn same_seed_same_bytes_whatever_the_threads() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, points) in [(KINDS[0], 300_000), (KINDS[1], 60_000), (KINDS[2], 40_000)] {
        let bytes = |threads: usize, name: &str, seed| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| fs::read(make(folder.path(), name, kind, points, seed).0).unwrap())
        };
        let one = bytes(1, "one.las", 7);
        assert!(one == bytes(2, "two.las", 7), "{kind:?}: threads change the bytes");
        assert!(one == bytes(3, "three.las", 7), "{kind:?}: threads change the bytes");
        assert!(one != bytes(2, "other.las", 8), "{kind:?}: the seed changes nothing");
        let packed = bytes(1, "one.laz", 7);
        assert!(packed == bytes(2, "two.laz", 7), "{kind:?}: threads change the compressed bytes");
    }
}

/// A digest of 64 bits (FNV-1a): enough to notice a change.
fn digest(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |hash, b| (hash ^ u64::from(*b)).wrapping_mul(0x100_0000_01B3))
}

/// These are the bytes of small scans, as first made: another machine or compiler must give them too. Whoever changes
/// a scene or a device on purpose puts the new values here.
#[test]
fn same_bytes_on_every_machine() {
    let folder = tempfile::tempdir().unwrap();
    let digests = KINDS.map(|kind| {
        let (path, _) = make(folder.path(), "scan.las", kind, 3_000, 42);
        digest(&fs::read(path).unwrap())
    });
    assert_eq!(digests, [16_173_658_192_736_658_459, 5_305_181_035_456_891_137, 1_673_666_415_707_929_338]);
}

#[test]
fn exactly_as_many_points_as_asked_in_a_true_box() {
    let folder = tempfile::tempdir().unwrap();
    for kind in KINDS {
        for points in [1, 2, 127, 10_007] {
            let (path, summary) = make(folder.path(), "scan.las", kind, points, points);
            let (header, read) = read(&path);
            assert_eq!(read.len() as u64, points, "{kind:?}");
            assert_eq!((summary.num_points, header.number_of_points()), (points, points));
            assert_eq!(summary.file_bytes, fs::metadata(&path).unwrap().len());
            let bounds = header.bounds();
            for axis in 0..3 {
                let values = read.iter().map(|p| [p.x, p.y, p.z][axis]);
                let low = values.clone().fold(f64::INFINITY, f64::min);
                let high = values.fold(f64::NEG_INFINITY, f64::max);
                let stated = |v: las::Vector<f64>| [v.x, v.y, v.z][axis];
                assert_eq!((stated(bounds.min), stated(bounds.max)), (low, high), "{kind:?} {points}");
                assert_eq!((summary.bounds.min[axis], summary.bounds.max[axis]), (low, high));
            }
            let by_return: u64 = (1..=5).filter_map(|n| header.number_of_points_by_return(n)).sum();
            assert_eq!(by_return, points);
        }
    }
}

#[test]
fn terrestrial_scans_station_after_station() {
    let folder = tempfile::tempdir().unwrap();
    let (path, _) = make(folder.path(), "scan.las", SynthKind::Terrestrial, 100_003, 1);
    let (header, points) = read(&path);
    assert_eq!((header.version().minor, header.point_format().to_u8().unwrap()), (4, 7));
    assert_eq!(points.len(), 100_003);
    for pair in points.windows(2) {
        assert!(pair[0].gps_time < pair[1].gps_time && pair[0].point_source_id <= pair[1].point_source_id);
    }
    for station in [1, 2] {
        let share = points.iter().filter(|p| p.point_source_id == station).count() as f64 / 100_003.0;
        assert!((0.3..0.7).contains(&share), "station {station}: {share}");
    }
    assert!(points.iter().all(|p| p.number_of_returns == 1 && p.intensity > 0));
    let brightest = points.iter().filter_map(|p| p.color).map(|c| c.red.max(c.green)).max();
    assert!(brightest > Some(40_000), "16-bit colors");
}

/// Heights of the paving west of the first station: y from −1.7 to −0.7, x as given.
fn paving(points: &[Point], west: f64, east: f64) -> Vec<f64> {
    let inside = |p: &&Point| {
        let (x, y, z) = (p.x - 500_000.0, p.y - 4_000_000.0, p.z - 100.0);
        p.point_source_id == 1 && (west..east).contains(&x) && (-1.7..-0.7).contains(&y) && z.abs() < 0.05
    };
    points.iter().filter(inside).map(|p| p.z - 100.0).collect()
}

#[test]
fn floor_is_flat_within_the_noise_and_thins_out_with_distance() {
    let folder = tempfile::tempdir().unwrap();
    let (path, _) = make(folder.path(), "scan.las", SynthKind::Terrestrial, 200_000, 1);
    let (_, points) = read(&path);
    let (near, far) = (paving(&points, -6.3, -5.3), paving(&points, -8.3, -7.3));
    // There is a ray every few degrees each way, so the density per area of floor is h / (r·(r² + h²)). Here it is
    // 1.6 / (1.6 · 5.12) against 1.6 / (3.6 · 15.5), or 6.8 : 1 at the middles of the rectangles.
    let ratio = near.len() as f64 / far.len() as f64;
    assert!((5.0..9.5).contains(&ratio), "{} : {}", near.len(), far.len());
    for heights in [near, far] {
        let deviation = (heights.iter().map(|z| z * z).sum::<f64>() / heights.len() as f64).sqrt();
        assert!((0.0002..0.003).contains(&deviation), "{deviation} m");
    }
}

#[test]
fn aerial_flies_strips_and_sees_through_trees() {
    let folder = tempfile::tempdir().unwrap();
    let (path, _) = make(folder.path(), "scan.las", SynthKind::Aerial, 60_000, 1);
    let (header, points) = read(&path);
    assert_eq!((header.version().minor, header.point_format().to_u8().unwrap()), (4, 7));
    let class = |n: u8| points.iter().filter(|p| u8::from(p.classification) == n).count();
    for (n, at_least) in [(2, 20_000), (3, 500), (5, 5_000), (6, 300), (9, 100)] {
        assert!(class(n) >= at_least, "class {n}: {}", class(n));
    }
    assert!(points.iter().any(|p| p.number_of_returns == 3));
    for p in &points {
        assert!((1..=p.number_of_returns).contains(&p.return_number) && p.number_of_returns <= 3);
        assert!(p.scan_angle.abs() < 12.0);
    }
    for pair in points.windows(2) {
        let (a, b) = (&pair[0], &pair[1]);
        assert!(a.gps_time <= b.gps_time && a.point_source_id <= b.point_source_id);
        // Returns of a pulse follow each other, downwards.
        if a.gps_time == b.gps_time {
            assert!(a.return_number + 1 == b.return_number && a.z > b.z - 0.4);
        }
    }
    let size = [points.iter().map(|p| p.x).fold(0.0, f64::max) - 452_000.0, 1000.0];
    assert!((size[0] - size[1]).abs() < 5.0);
}

#[test]
fn photogrammetry_has_8_bit_colors_and_tiles() {
    let folder = tempfile::tempdir().unwrap();
    let (path, _) = make(folder.path(), "scan.las", SynthKind::Photogrammetry, 30_000, 1);
    let (header, points) = read(&path);
    assert_eq!((header.version().minor, header.point_format().to_u8().unwrap()), (2, 2));
    let colors: Vec<_> = points.iter().filter_map(|p| p.color).collect();
    assert!(colors.iter().all(|c| c.red <= 255 && c.green <= 255 && c.blue <= 255));
    assert!(colors.iter().any(|c| c.red > 180));
    // Neighbors in the file are mostly neighbors in space, far closer than by chance.
    let step = |i: usize, j: usize| {
        let (a, b) = (&points[i], &points[j]);
        ((a.x - b.x).powi(2) + (a.y - b.y).powi(2) + (a.z - b.z).powi(2)).sqrt()
    };
    let mean = |stride: usize| (0..10_000).map(|i| step(i, i + stride)).sum::<f64>() / 1e4;
    assert!(mean(1) < 0.1 * mean(15_000), "{} m, by chance {} m", mean(1), mean(15_000));
}

#[test]
fn laz_holds_the_same_points() {
    let folder = tempfile::tempdir().unwrap();
    for kind in KINDS {
        let plain = make(folder.path(), "scan.las", kind, 60_001, 3);
        let packed = make(folder.path(), "scan.laz", kind, 60_001, 3);
        assert!(packed.1.file_bytes < plain.1.file_bytes * 3 / 4);
        let (plain, packed) = (read(&plain.0), read(&packed.0));
        assert!(plain.1 == packed.1, "{kind:?}");
        assert_eq!(plain.0.bounds(), packed.0.bounds());
    }
}

#[test]
fn an_interrupted_run_leaves_nothing_and_harms_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("scan.las");
    fs::write(&out, "what was there before").unwrap();
    for (kind, num_points) in
        [(SynthKind::Terrestrial, 0), (SynthKind::Terrestrial, 10_000), (SynthKind::Aerial, 50_000)]
    {
        let stop = CancelToken::default();
        let options = SynthOptions { kind, out: output(&out), points: 2_000_000_000, seed: 0 };
        // Writing is stopped once this many points are written.
        let (counts, counted) = std::sync::mpsc::channel::<Arc<Count>>();
        let stopper = std::thread::spawn({
            let stop = stop.clone();
            move || {
                let count = counted.recv().unwrap();
                while count.now().done < num_points {
                    std::thread::yield_now();
                }
                stop.cancel();
            }
        });
        let task = Task::new(&stop).observed(move |count| counts.send(Arc::clone(count)).unwrap_or_default());
        let error = write(&options, task).unwrap_err();
        stopper.join().unwrap();
        assert!(matches!(error, SynthError::Cancelled { .. }), "{error}");
        assert_eq!(num_files(folder.path()), 1);
        assert_eq!(fs::read(&out).unwrap(), b"what was there before");
    }
}

#[test]
fn errors_name_the_file_and_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let fails = |out: PathBuf, points| {
        let options = SynthOptions { kind: SynthKind::Photogrammetry, out: output(&out), points, seed: 0 };
        write(&options, &CancelToken::default()).unwrap_err()
    };
    assert!(matches!(fails(folder.path().join("scan.las"), 0), SynthError::NoPoints));
    assert!(matches!(fails(folder.path().join("scan.las"), 1 << 33), SynthError::TooManyPoints { .. }));
    assert!(matches!(fails(folder.path().join("scan.ply"), 1 << 30), SynthError::TooManyPoints { .. }));
    let options = SynthOptions {
        kind: SynthKind::Aerial,
        out: output(&folder.path().join("scan.ply")),
        points: 10,
        seed: 0,
    };
    assert!(matches!(write(&options, &CancelToken::default()).unwrap_err(), SynthError::NoMesh { .. }));

    assert_eq!(num_files(folder.path()), 0);
}

#[test]
fn the_statue_is_a_mesh_too() {
    let folder = tempfile::tempdir().unwrap();
    let (path, summary) = make(folder.path(), "statue.ply", SynthKind::Photogrammetry, 30_000, 1);
    assert_eq!(summary.file_bytes, fs::metadata(&path).unwrap().len());
    let scan = kit::reading::file(&path).unwrap();
    let (file, num_points) = (&scan.files[0], scan.num_points());
    assert_eq!((num_points as u64, scan.warnings.len()), (summary.num_points, 0));
    assert!((27_000..33_000).contains(&num_points), "{num_points}");
    assert!((file.bounds.min - summary.bounds.min).abs().max_element() < 1e-8);
    assert!((file.bounds.max - summary.bounds.max).abs().max_element() < 1e-8);
    // A surface with one border has two triangles a point.
    let per_point = file.triangles.len() as f64 / num_points as f64;
    assert!((1.9..2.0).contains(&per_point), "{per_point}");
    assert!(file.points.normals.iter().all(|n| (n.iter().map(|c| c * c).sum::<f32>() - 1.0).abs() < 1e-4));
    assert!(file.points.rgb.iter().any(|rgb| rgb[0] > 150));
    let bytes = |threads: usize, seed| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let make = || make(folder.path(), "again.ply", SynthKind::Photogrammetry, 30_000, seed).0;
        pool.install(|| fs::read(make()).unwrap())
    };
    assert!(bytes(3, 1) == fs::read(&path).unwrap(), "threads change the bytes");
    assert!(bytes(1, 2) != fs::read(&path).unwrap(), "the seed changes nothing");
}

#[test]
fn viewpoints_lie_in_their_scans() {
    let folder = tempfile::tempdir().unwrap();
    for kind in KINDS {
        let (_, summary) = make(folder.path(), "scan.las", kind, 5_000, 0);
        let around = summary.bounds;
        assert_eq!(viewpoints(kind)[0].name, "overview");
        for view in viewpoints(kind) {
            let target = view.target;
            assert!(target.cmpge(around.min).all() && target.cmple(around.max).all(), "{view:?} {around:?}");
            assert!(view.eye.distance(target) > 0.5);
        }
    }
}
