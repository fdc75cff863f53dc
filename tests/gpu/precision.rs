//! Far from the origin and in a huge cloud, a millimeter is still a millimeter, and it stays where it is.

use base::space::{Eye, Fov, Pose, View};
use base::task::Progress;
use cloud::quantize::{Cells, cells_of};
use cloud::{Batch, Cloud};
use glam::{DVec3, DVec4};
use kit::frames::{draw, sample_options, scan_of};
use lab::order::Order;
use lab::reference;
use points::Scene;
use std::collections::HashMap;

const CORNER: DVec3 = DVec3::new(500_000.0, 4_000_000.0, 100.0);
/// Grid points on each side; the grid is a wall in the x-z plane, 1 mm apart.
const SIDE: i32 = 120;
/// Distance of a point's exact pixel coordinate from a pixel's edge below which either side is right.
const EDGE: f64 = 0.05;

/// A cloud of the wall and of two points that stretch it to 20 km and are none of its strays: at random they share a
/// batch with the wall. With it come the points' places, and which point of the cloud each is.
fn wall() -> (Cloud, Vec<DVec3>, Vec<u32>) {
    let mut xyz = vec![[-10_000_000, -10_000_000, -50_000]];
    for z in 0..SIDE {
        xyz.extend((0..SIDE).map(|x| [x, 0, z]));
    }
    xyz.push([10_000_000, 10_000_000, 50_000]);
    let positions: Vec<DVec3> =
        xyz.iter().map(|p| CORNER + DVec3::from_array(p.map(f64::from)) * 0.001).collect();
    let mut scan = scan_of(&xyz, 0.001, CORNER);
    scan.scene = Scene::around(positions.clone());
    let cloud = Order::Shuffled.build(&scan, &Progress::hidden()).expect("a cloud");
    let widest = cloud.batches.iter().flat_map(|batch| batch.cell).fold(0.0, f32::max);
    assert!(widest > 5e-6, "a batch is kilometers wide: {widest}");
    let numbers = numbers(&cloud);
    let numbers = xyz.iter().map(|p| numbers[p]).collect();
    (cloud, positions, numbers)
}

/// The number of each point of a cloud by its place on the grid.
fn numbers(cloud: &Cloud) -> HashMap<[i32; 3], u32> {
    let of_batch = |batch: &Batch| {
        let cells = Cells { min: batch.min, cell: batch.cell };
        let range = batch.first_point..batch.first_point + batch.num_points;
        let place = move |i: u32| {
            let p = cells.center(cells_of([0, 1, 2].map(|plane: usize| cloud.planes[plane][i as usize])));
            ((p - CORNER) * 1000.0).round().to_array().map(|v| v as i32)
        };
        range.map(move |i| (place(i), i))
    };
    cloud.batches.iter().flat_map(of_batch).collect()
}

fn view(head_offset: DVec3) -> View {
    let target = CORNER + DVec3::new(0.06, 0.0, 0.06);
    let eye = target - DVec3::Y + head_offset;
    let world_from_view = Pose { position: eye, ..Pose::look_at(target - DVec3::Y, target, DVec3::Z) };
    let size_px = [701, 701];
    View {
        eyes: vec![Eye { world_from_view, fov: Fov::symmetric(0.2, 1.0), size_px, gaze_in_view: Eye::AHEAD }],
        near: 0.05,
    }
}

/// Exact pixel coordinates by the picture formula in f64.
fn exact(view: &View, p: DVec3) -> (f64, f64) {
    let rows = view.eyes[0].pixel_from_head(view.head_in_world());
    let q: DVec4 = (p - view.head_in_world()).extend(1.0);
    let [x, y, w] = rows.map(|r| DVec4::from_array(r).dot(q));
    (x / w, y / w)
}

/// Grid points whose pixel does not show them, of those that are not within `EDGE` of a pixel's edge.
fn misplaced(
    pixels: &[u64],
    view: &View,
    positions: &[DVec3],
    order: &dyn Fn(usize) -> u32,
) -> (usize, usize) {
    let [width, height] = view.eyes[0].size_px;
    let inside = |(x, y): (f64, f64)| {
        let fine = |v: f64| v.fract() > EDGE && v.fract() < 1.0 - EDGE;
        (x >= 0.0 && y >= 0.0 && x < f64::from(width) && y < f64::from(height) && fine(x) && fine(y))
            .then(|| y as usize * width as usize + x as usize)
    };
    let seen: Vec<(usize, usize)> =
        (0..positions.len()).filter_map(|i| Some((i, inside(exact(view, positions[i]))?))).collect();
    let wrong = seen.iter().filter(|(i, pixel)| pixels[*pixel] as u32 >> 1 != order(*i)).count();
    (wrong, seen.len())
}

#[test]
fn a_millimeter_grid_in_twenty_kilometers_is_drawn_to_the_pixel() {
    let (cloud, positions, numbers) = wall();
    for full in [false, true] {
        let view = view(DVec3::new(0.0003, 0.0, 0.0001));
        let drawn = draw(&cloud, &view, full, 0);
        let (wrong, seen) = misplaced(&drawn.keys[0], &view, &positions, &|i| numbers[i]);
        assert!(seen > 10_000, "{seen} of {} grid points are in view", SIDE * SIDE);
        assert_eq!(wrong, 0, "of {seen}");
    }
}

#[test]
fn nothing_jitters_while_the_head_moves() {
    let (cloud, positions, numbers) = wall();
    // The CPU reference equals the GPU bit for bit (tests/gpu/frame.rs), so a hundred frames are cheap here.
    for step in 0..100 {
        let s = f64::from(step);
        let view = view(DVec3::new(0.000_137 * s, -0.000_071 * s, 0.000_093 * s));
        let frame =
            reference::frame(&reference::ReferenceCloud::flat(&cloud), &view, &sample_options(), None);
        let (wrong, seen) = misplaced(&frame.keys[0], &view, &positions, &|i| numbers[i]);
        assert!(seen > 5_000);
        assert_eq!(wrong, 0, "step {step}, of {seen}");
    }
}

/// The comparison sees an error of 0.4 mm, less than a step of f32 at 10 km from the cloud's center.
#[test]
fn the_comparison_notices_less_than_half_a_millimeter() {
    let (cloud, positions, numbers) = wall();
    let view = view(DVec3::ZERO);
    let frame = reference::frame(&reference::ReferenceCloud::flat(&cloud), &view, &sample_options(), None);
    let shifted: Vec<DVec3> = positions.iter().map(|p| *p + DVec3::new(0.0004, 0.0, 0.0004)).collect();
    let (wrong, seen) = misplaced(&frame.keys[0], &view, &shifted, &|i| numbers[i]);
    assert!(wrong > seen / 2, "{wrong} of {seen}");
}
