//! The first view shows the scan, however small it is and whatever lies far from it. Nothing far costs the scene its
//! precision. Deleted points and noise are reported. The program and the library are tested from outside, on files
//! made here.

use crate::PROGRAM;
use base::space::Bounds;
use base::task::{CancelToken, Progress};
use cloud::{Cloud, quantize};
use glam::DVec3;
use kit::frames::octree_of;
use kit::las_files::las_bytes;
use kit::program::{self, RunOutput};
use kit::reading;
use lab::order::Order;
use las::point::{Classification, Format};
use las::{Builder, Color, Point, Transform, Vector};
use points::{self, ReadOptions};
use std::path::{Path, PathBuf};

const UTM: DVec3 = DVec3::new(500_000.0, 5_000_000.0, 300.0);

/// A floor and a wall, `edge` long.
fn building(num: usize, edge: f64) -> Vec<DVec3> {
    let part = |i: usize, step: f64| (i as f64 * step).fract() * edge;
    let at = |i: usize| {
        let (u, v) = (part(i, 0.754_877_666), part(i, 0.569_840_291));
        if i.is_multiple_of(2) { DVec3::new(u, v, 0.0) } else { DVec3::new(u, 0.0, 0.4 * v) }
    };
    (0..num).map(at).collect()
}

/// Sets what a made-up point has beside its place.
type Mark = fn(&mut Point, usize);

fn las(points: &[DVec3], format: u8, compressed: bool, scale: f64, mark: Mark) -> Vec<u8> {
    let mut point_format = Format::new(format).unwrap();
    point_format.is_compressed = compressed;
    let mut builder = Builder::from((1, if format < 6 { 2 } else { 4 }));
    builder.point_format = point_format;
    let first = points[0];
    let axis = |offset: f64| Transform { scale, offset };
    builder.transforms = Vector { x: axis(first.x), y: axis(first.y), z: axis(first.z) };
    let made_up = points.iter().enumerate().map(|(i, p)| {
        let mut point = Point {
            x: p.x,
            y: p.y,
            z: p.z,
            return_number: 1,
            number_of_returns: 1,
            gps_time: point_format.has_gps_time.then_some(0.0),
            color: point_format.has_color.then(|| Color::new(60_000, 30_000, 20_000 + 20 * (i as u16 % 999))),
            ..Point::default()
        };
        mark(&mut point, i);
        point
    });
    las_bytes(builder, made_up)
}

fn ply_text(points: &[DVec3]) -> Vec<u8> {
    let header = "ply\nformat ascii 1.0\nelement vertex";
    let mut text = format!(
        "{header} {}\nproperty double x\nproperty double y\nproperty double z\nend_header\n",
        points.len()
    );
    points.iter().for_each(|p| text += &format!("{:e} {:e} {:e}\n", p.x, p.y, p.z));
    text.into_bytes()
}

struct SceneFiles(tempfile::TempDir);

impl SceneFiles {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn save(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

fn scanwalk(args: &[&str]) -> RunOutput {
    program::run(program::command(PROGRAM).args(args)).ok()
}

/// The part of the picture's width and height that points span, how many pixels have one, and the warnings.
fn rendered(files: &SceneFiles, scan: &Path, more: &[&str], size: [u32; 2]) -> ([f64; 2], usize, String) {
    let depth = files.0.path().join("depth.npy");
    let picture = files.0.path().join("picture.png");
    let size_text = format!("{}x{}", size[0], size[1]);
    let mut args = vec!["render", scan.to_str().unwrap(), "-o", picture.to_str().unwrap()];
    args.extend(["--depth", depth.to_str().unwrap(), "--size", &size_text]);
    args.extend(more);
    let output = scanwalk(&args);
    let bytes = std::fs::read(&depth).unwrap();
    let depths = &bytes[bytes.len() - 4 * (size[0] * size[1]) as usize..];
    let (mut low, mut high, mut num) = ([u32::MAX; 2], [0; 2], 0);
    for (i, depth) in depths.chunks_exact(4).enumerate() {
        if f32::from_le_bytes(depth.try_into().unwrap()).is_finite() {
            num += 1;
            for (axis, at) in [i as u32 % size[0], i as u32 / size[0]].into_iter().enumerate() {
                (low[axis], high[axis]) = (low[axis].min(at), high[axis].max(at));
            }
        }
    }
    let span =
        [0, 1].map(|axis| f64::from((high[axis] + 1).saturating_sub(low[axis])) / f64::from(size[axis]));
    let warnings = output.err.lines().filter(|line| line.contains("warning")).collect();
    (span, num, warnings)
}

/// The scene fills at least 70 % of the picture's shorter side, and nothing is at its border.
fn assert_fills([across, down]: [f64; 2], [width, height]: [u32; 2], what: &str) {
    let filled = (across * f64::from(width)).max(down * f64::from(height));
    assert!(filled >= 0.7 * f64::from(width.min(height)), "{what}: {across} x {down}");
    assert!(across < 0.98 && down < 0.98, "{what}: {across} x {down} is cut");
}

#[test]
fn the_default_picture_shows_the_scene_whatever_is_astray() {
    let files = SceneFiles::new();
    let scene = building(2000, 20.0);
    let high = (0..30).map(|i| DVec3::new(3.0 + i as f64 % 10.0, 7.0, 500.0 + 120.0 * f64::from(i)));
    let cases: [(&str, Vec<DVec3>); 4] = [
        ("none", vec![]),
        ("one", vec![DVec3::new(40_000.0, -30_000.0, 0.0)]),
        ("zeros", vec![-UTM; 220]),
        ("high", high.collect()),
    ];
    for (name, strays) in cases {
        let points: Vec<DVec3> = scene.iter().chain(&strays).map(|&p| UTM + p).collect();
        // A stray must be on the grid.
        let scale = if name == "zeros" { 0.01 } else { 0.001 };
        let path = files.save(&format!("{name}.las"), &las(&points, 2, false, scale, |_, _| ()));
        let scan = reading::file(&path).unwrap();
        let found = scan.scene.bounds;
        assert!((found.size() - DVec3::new(20.0, 20.0, 8.0)).abs().max_element() < 0.2, "{name}: {found:?}");
        for size in [[320, 200], [120, 300]] {
            let (span, num, stderr) = rendered(&files, &path, &[], size);
            assert!(num > 200 && stderr.is_empty(), "{name}: {num} pixels, {stderr}");
            // Strays may be in the picture too; the scene must not be small for them.
            if name == "none" {
                assert_fills(span, size, name);
            }
        }
    }
}

#[test]
fn strays_beside_a_scene_neither_widen_nor_lift_it() {
    let files = SceneFiles::new();
    // `part` gives irregular numbers from 0 to 1, and `bell` sums of them: strays all around, most of them as far
    // away as twice the scene's length.
    let part = |at: usize| {
        let hash = (at as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let hash = (hash ^ hash >> 31).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (hash >> 40) as f64 / (1u64 << 24) as f64
    };
    let bell = |at: usize| (0..6).map(|i| part(6 * at + i)).sum::<f64>() - 3.0;
    for (num, share) in [(1500, 0.03), (6000, 0.03), (6000, 0.15), (20_000, 0.15)] {
        for far in [40.0, 80.0] {
            let scene = building(num, 20.0);
            let truth = Bounds::around(&scene);
            let num_strays = (share * num as f64) as usize;
            let stray =
                |i: usize| DVec3::new(bell(3 * i), bell(3 * i + 1), bell(3 * i + 2)) * (far / 0.7) + 10.0;
            let points: Vec<DVec3> = scene.into_iter().chain((0..num_strays).map(stray)).collect();
            let scan = reading::file(&files.save("halo.ply", &ply_text(&points))).unwrap();
            let (found, most) = (scan.scene.bounds, truth.grown(0.15 * truth.edge()));
            let what = format!("{num} {share} {far}: {found:.1?}");
            assert!(most.contains(found.min) && most.contains(found.max), "{what}");
            assert!(found.grown(0.01).contains(truth.min) && found.grown(0.01).contains(truth.max), "{what}");
        }
    }
}

#[test]
fn strays_on_one_ray_do_not_count() {
    let files = SceneFiles::new();
    for (num, share) in [(3_000, 0.049), (40_000, 0.15)] {
        let scene = building(num, 30.0);
        let truth = Bounds::around(&scene);
        let num_strays = (share * num as f64) as usize;
        let ray = DVec3::new(0.8, -0.55, 0.1).normalize();
        let stray = |i: usize| DVec3::new(4.0, 9.0, 1.7) + ray * 3000.0 * (i as f64 * 0.618_034).fract();
        let points: Vec<DVec3> =
            scene.into_iter().chain((0..num_strays).map(stray)).map(|p| UTM + p).collect();
        let path = files.save("ray.las", &las(&points, 2, false, 0.001, |_, _| ()));
        let found = reading::file(&path).unwrap().scene.bounds;
        let most = truth.grown(0.4 * truth.edge());
        let what = format!("{num} {share}: {found:.1?}");
        assert!(most.contains(found.min - UTM) && most.contains(found.max - UTM), "{what}");
        let info = scanwalk(&["info", path.to_str().unwrap()]);
        let text = info.text();
        assert!(text.contains("scene from"), "{text}");
    }
}

#[test]
fn small_scans_are_seen_whole() {
    let files = SceneFiles::new();
    for (name, points) in [
        ("one.ply", vec![UTM]),
        ("equal.ply", vec![DVec3::ONE; 500]),
        ("two.ply", vec![DVec3::ZERO, DVec3::X * 1e-3]),
    ] {
        let path = files.save(name, &ply_text(&points));
        let (_, num, stderr) = rendered(&files, &path, &[], [101, 75]);
        assert!((1..=2).contains(&num) && stderr.is_empty(), "{name}: {num} pixels; {stderr}");
    }
    for edge in [0.05, 5e-3, 5e-5, 1.0, 5e4] {
        let path = files.save("small.ply", &ply_text(&building(3000, edge)));
        for (more, size) in
            [(&[][..], [300, 200]), (&["--fov-y", "100"], [150, 250]), (&["--target", "0,0,0"], [200, 200])]
        {
            let (span, num, stderr) = rendered(&files, &path, more, size);
            assert!(num > 1000 && stderr.is_empty(), "{edge}: {num} pixels; {stderr}");
            if !more.contains(&"--target") {
                assert_fills(span, size, &format!("{edge} {more:?}"));
            }
        }
    }
}

#[test]
fn a_picture_of_nothing_says_where_the_scan_is() {
    let files = SceneFiles::new();
    let path = files.save("a.ply", &ply_text(&building(500, 10.0)));
    let away = ["--eye", "5,-30,2", "--target", "5,-60,2"];
    let (_, num, stderr) = rendered(&files, &path, &away, [64, 64]);
    assert_eq!(num, 0);
    assert!(stderr.contains("nothing of the scan is in view") && stderr.contains("180 degrees"), "{stderr}");
    let (_, num, stderr) = rendered(&files, &path, &["--eye", "5,-30,2", "--target", "5,0,2"], [64, 64]);
    assert!(num > 0 && stderr.is_empty(), "{stderr}");
    // A value that the user sets holds.
    let (_, num, stderr) = rendered(&files, &path, &["--set", "frame.near_m=1000"], [64, 64]);
    assert!(num == 0 && stderr.contains("frame.near_m"), "{stderr}");
}

#[test]
fn far_points_of_a_ply_are_left_out_and_named_or_cost_nothing() {
    let files = SceneFiles::new();
    let scene = building(1000, 1.0);
    for far in [30.0, 1e9, 3e12, 1e38, f64::INFINITY, f64::NAN] {
        let points: Vec<DVec3> = scene.iter().copied().chain([DVec3::new(far, 0.5, 0.5)]).collect();
        let path = files.save("far.ply", &ply_text(&points));
        let scan = reading::file(&path).unwrap();
        let file = &scan.files[0];
        for (p, xyz) in scene.iter().zip(&file.points.xyz) {
            let moved = (file.grid.p_in_world(*xyz) - *p).length();
            assert!(moved < 1e-6, "{far}: {p} moved by {moved}");
        }
        let is_left_out = file.points.xyz.len() == scene.len();
        assert_eq!(is_left_out, far != 30.0, "{far}");
        assert_eq!(scan.warnings.len(), usize::from(is_left_out), "{:?}", scan.warnings);
        assert!(scan.warnings.iter().all(|w| w.contains("far.ply: has 1 point ")), "{:?}", scan.warnings);
        let (_, num, _) = rendered(&files, &path, &[], [100, 100]);
        assert!(num > 500, "{far}: {num} pixels");
        let info = scanwalk(&["info", path.to_str().unwrap()]);
        let text = info.text();
        let longest = text.split(|c: char| !c.is_ascii_digit()).map(str::len).max();
        assert!(longest < Some(16), "{text}");
    }
}

/// World positions of a cloud's points, as they are drawn.
fn drawn(cloud: &Cloud) -> Vec<DVec3> {
    let of_batch = |batch: &cloud::Batch| {
        let cells = quantize::Cells { min: batch.min, cell: batch.cell };
        let range = batch.first_point as usize..(batch.first_point + batch.num_points) as usize;
        let at =
            move |i: usize| cells.center(quantize::cells_of([0, 1, 2].map(|p: usize| cloud.planes[p][i])));
        range.map(at).collect::<Vec<_>>()
    };
    cloud.batches.iter().flat_map(of_batch).collect()
}

#[test]
fn far_points_of_a_las_never_cost_the_scene_its_precision() {
    let files = SceneFiles::new();
    let scene = building(60_000, 20.0);
    let strays = [DVec3::new(2e6, 0.0, 0.0), DVec3::new(0.0, -2e6, 2e6), DVec3::splat(-2e6)];
    // The strays are in the midst of the other points, with which they share batches in the files' order.
    let mut points = scene.clone();
    strays.iter().enumerate().for_each(|(i, &p)| points.insert(20_000 * i + 5000, p));
    let far = files.save("far.las", &las(&points, 0, false, 0.001, |_, _| ()));
    let near = files.save("near.las", &las(&scene, 0, false, 0.001, |_, _| ()));
    let (far, near) = (reading::file(&far).unwrap(), reading::file(&near).unwrap());
    assert_eq!(far.scene.bounds, near.scene.bounds);
    let sorted = |mut positions: Vec<DVec3>| {
        positions.retain(|p| p.abs().max_element() < 1e3);
        positions.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
        positions
    };
    let rounded = |p: &DVec3| (*p * 1000.0).round() / 1000.0;
    let truth = sorted(near.files[0].points.xyz.iter().map(|&p| near.files[0].grid.p_in_world(p)).collect());
    for order in [Order::Original, Order::Morton, Order::Shuffled, Order::ShuffledMorton] {
        let cloud = order.build(&far, &Progress::hidden()).unwrap();
        let positions = sorted(drawn(&cloud));
        assert_eq!(positions.len(), truth.len());
        let worst = positions.iter().map(|p| (*p - rounded(p)).abs().max_element()).fold(0.0, f64::max);
        assert!(worst < 1e-7, "{order:?}: {worst}");
        // The box of each batch of the scene is within the scene.
        let wide = cloud.batches.iter().filter(|batch| batch.cell.iter().any(|&c| c > 1e-6)).count();
        assert_eq!(wide, 1, "{order:?}: only the strays' batch is wide");
    }
    let (far, near) = (octree_of(&far), octree_of(&near));
    let positions = sorted(drawn(&far.cloud));
    // Cells are shares of a node's cube, and the root's cube is as wide as everything. The point or two of the scene
    // that the root takes are millimeters off; all points below it are right to micrometers.
    let moved = positions.iter().filter(|&p| (*p - rounded(p)).abs().max_element() > 2e-6).count();
    assert!(positions.len() == truth.len() && moved <= 2, "{moved}");
    // The tree reaches as far down into the scene as without strays, with not many more nodes.
    let finest = |octree: &cloud::octree::Octree| {
        octree.nodes.iter().map(|node| node.edge).fold(f64::INFINITY, f64::min)
    };
    assert!(finest(&far) < 2.0 * finest(&near), "{} and {}", finest(&far), finest(&near));
    assert!(far.nodes.len() < 2 * near.nodes.len() + 30, "{} and {}", far.nodes.len(), near.nodes.len());
    assert!(!far.is_crowded());
}

#[test]
fn the_withheld_are_not_drawn_and_noise_does_not_count() {
    let files = SceneFiles::new();
    let scene = building(1000, 20.0);
    let high = (0..60).map(|i| DVec3::new(2.0, f64::from(i) / 4.0, 500.0 + 50.0 * f64::from(i)));
    let points: Vec<DVec3> = scene.iter().copied().chain(high).map(|p| UTM + p).collect();
    let withheld: Mark = |point, i| {
        point.is_withheld = i >= 1000;
        point.classification = Classification::new(if i < 1000 { 2 } else { 7 }).unwrap();
    };
    let noise: Mark = |point, i| {
        point.classification =
            Classification::new(if i < 1000 { 2 } else { 7 + 11 * (i as u8 % 2) }).unwrap();
    };
    for format in [0, 2, 3, 6, 7] {
        for compressed in [false, true] {
            let what = format!("format {format}, compressed {compressed}");
            let path = files.save("withheld.las", &las(&points, format, compressed, 0.001, withheld));
            let scan = reading::file(&path).unwrap();
            assert_eq!((scan.num_points(), scan.files[0].points.num_withheld), (1000, 60), "{what}");
            assert!(scan.bounds().size().z < 9.0, "{what}");
            assert!(scan.warnings[0].contains("withheld.las: has 60 points that are withheld"), "{what}");
            let shown = ReadOptions { show_withheld: true, ..ReadOptions::AS_FILES_SAY };
            let shown = points::read(&[path], &shown, &CancelToken::default()).unwrap();
            assert_eq!((shown.num_points(), shown.warnings.len()), (1060, 0), "{what}");
            assert_eq!(shown.scene.bounds, scan.scene.bounds, "{what}");

            let path = files.save("noise.las", &las(&points, format, compressed, 0.001, noise));
            let scan = reading::file(&path).unwrap();
            assert_eq!(scan.num_points(), 1060, "{what}");
            assert_eq!((scan.files[0].points.noise.count(), scan.warnings.len()), (60, 0), "{what}");
            assert_eq!(scan.scene.bounds, shown.scene.bounds, "{what}");
        }
    }
    let path = files.save(
        "both.las",
        &las(&points, 6, true, 0.001, |point, i| {
            point.is_withheld = i % 100 == 0;
            point.classification = Classification::new(if i < 1000 { 2 } else { 18 }).unwrap();
        }),
    );
    let json = scanwalk(&["info", "--json", path.to_str().unwrap()]).json();
    assert_eq!((json["points"].as_u64(), json["withheld"].as_u64()), (Some(1060), Some(11)));
    assert_eq!(json["noise"].as_u64(), Some(59));
    let said = json["warnings"].to_string();
    assert!(said.contains("11 points are withheld") && said.contains("59 points are noise"), "{said}");
    let info = scanwalk(&["info", path.to_str().unwrap()]);
    let text = info.text();
    assert!(text.contains("withheld") && text.contains("noise") && text.contains("scene from"), "{text}");
    // The reason is that there are only deleted points.
    let path = files.save("gone.las", &las(&scene, 6, true, 0.001, |point, _| point.is_withheld = true));
    let error = reading::file(&path).unwrap_err().to_string();
    assert!(error.contains("gone.las: holds no points: all 1000 are withheld"), "{error}");
}

#[test]
fn files_far_apart_are_named_and_the_larger_part_is_seen() {
    let files = SceneFiles::new();
    let local = files.save("local.las", &las(&building(3000, 20.0), 2, false, 0.001, |_, _| ()));
    let utm: Vec<DVec3> = building(2900, 20.0).into_iter().map(|p| UTM + p).collect();
    let utm = files.save("utm.las", &las(&utm, 2, true, 0.001, |_, _| ()));
    for paths in [[local.clone(), utm.clone()], [utm, local]] {
        let scan = reading::files(&paths).unwrap();
        assert!(scan.scene.bounds.max.x < 21.0, "{:?}", scan.scene.bounds);
        let [warning] = &scan.warnings[..] else { panic!("{:?}", scan.warnings) };
        assert!(warning.contains("utm.las: 5024") && warning.contains("away from"), "{warning}");
    }
}

#[test]
fn coordinates_that_nothing_has_name_their_file() {
    let files = SceneFiles::new();
    let path = files.save("broken.las", &las(&building(10, 1e30), 0, false, 1e24, |_, _| ()));
    let error = reading::file(&path).unwrap_err().to_string();
    assert!(error.contains("broken.las: has points ") && error.contains("e29 units from zero"), "{error}");
}
