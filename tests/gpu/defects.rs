//! Mistakes that point renderers are known to make, each of which must not happen here (docs/FRAME.md §10).

use base::space::View;
use glam::DVec3;
use kit::frames::{Drawn, cloud_of, draw, mono, scan_of};
use lab::order::Order;
use lab::reference::clear::EMPTY;

/// One eye at the origin that looks along +y, x right, z up; `half` is the tangent of its half angles.
fn look_north(size_px: [u32; 2], half: f64) -> View {
    mono(DVec3::ZERO, DVec3::Y, half, size_px)
}

fn draw_points(xyz: &[[i32; 3]], view: &View) -> Drawn {
    draw(&cloud_of(xyz, 0.001, DVec3::ZERO, Order::Original), view, true, 0)
}

/// Pixels that hold a point, as (x, y, index).
fn hits(drawn: &Drawn, eye: usize, width: u32) -> Vec<(u32, u32, u32)> {
    let filled = drawn.keys[eye].iter().enumerate().filter(|(_, p)| **p != EMPTY);
    filled.map(|(i, p)| (i as u32 % width, i as u32 / width, *p as u32 >> 1)).collect()
}

#[test]
fn odd_sizes_are_painted_to_the_last_row_and_column() {
    // The wall is 1 m away, denser than the pixels and wider than the view.
    let wall: Vec<[i32; 3]> =
        (-550..=550).flat_map(|x| (-550..=550).map(move |z| [x * 2, 1000, z * 2])).collect();
    for size in [[333, 217], [17, 9], [1, 1], [129, 1]] {
        let drawn = draw_points(&wall, &look_north(size, 1.0));
        let empty = drawn.keys[0].iter().filter(|&&p| p == EMPTY).count();
        assert_eq!(empty, 0, "{size:?}: every pixel shows the wall");
        assert!(drawn.images[0].iter().all(|&c| c != u32::from_le_bytes([1, 2, 3, 255])), "{size:?}");
    }
}

#[test]
fn eyes_above_eight_megapixels_have_their_last_pixel() {
    let size = [3000, 2881];
    let mut view = look_north(size, 1.0);
    view.eyes.push(view.eyes[0]);
    let drawn = draw_points(&[[-999, 1000, 999], [999, 1000, -999]], &view);
    for eye in 0..2 {
        assert_eq!(hits(&drawn, eye, size[0]), [(1, 1, 0), (2998, 2879, 1)], "eye {eye}");
    }
}

#[test]
fn the_point_on_the_far_face_stays_where_it_is() {
    let drawn = draw_points(&[[0, 1000, 0], [500, 1500, 500]], &look_north([101, 101], 1.0));
    // The point lies 500/1500 right and up of the center: 50.5 · (1 ± 1/3).
    assert_eq!(hits(&drawn, 0, 101), [(67, 33, 1), (50, 50, 0)]);
}

#[test]
fn flat_clouds_lines_and_single_points_are_drawn() {
    let view = look_north([100, 100], 1.0);
    let plane: Vec<[i32; 3]> =
        (0..10).flat_map(|x| (0..10).map(move |z| [x * 100 - 450, 1000, z * 100 - 450])).collect();
    assert_eq!(hits(&draw_points(&plane, &view), 0, 100).len(), 100);
    let line: Vec<[i32; 3]> = (0..10).map(|x| [x * 100 - 450, 1000, 0]).collect();
    assert_eq!(hits(&draw_points(&line, &view), 0, 100).len(), 10);
    assert_eq!(hits(&draw_points(&[[0, 1000, 0]], &view), 0, 100), [(50, 50, 0)]);
    let same = vec![[0, 1000, 0]; 30_000];
    assert_eq!(hits(&draw_points(&same, &view), 0, 100), [(50, 50, 0)], "the smallest index wins");
}

#[test]
fn point_zero_is_a_point_and_not_the_background() {
    let drawn = draw_points(&[[0, 1000, 0], [10, 1000, 0]], &look_north([99, 99], 1.0));
    let center = 49 * 99 + 49;
    assert_eq!(drawn.keys[0][center] as u32, 0);
    assert_eq!(drawn.images[0][center], u32::from_le_bytes([0, 0, 0, 255]), "point 0's own color");
    assert_eq!(drawn.images[0][0], u32::from_le_bytes([1, 2, 3, 255]), "the background");
}

#[test]
fn nothing_is_drawn_at_or_behind_the_near_clip() {
    let view = look_north([99, 99], 1.0);
    assert_eq!(hits(&draw_points(&[[0, 51, 0]], &view), 0, 99).len(), 1);
    for y in [50, 49, 0, -1000] {
        assert_eq!(hits(&draw_points(&[[0, y, 0]], &view), 0, 99).len(), 0, "y = {y} mm");
    }
}

#[test]
fn the_left_eye_sees_a_near_point_further_right() {
    let mut view = look_north([200, 100], 1.0);
    let mut right = view.eyes[0];
    view.eyes[0].world_from_view.position.x = -0.0315;
    right.world_from_view.position.x = 0.0315;
    view.eyes.push(right);
    let drawn = draw_points(&[[0, 500, 0], [0, 400_000, 200_000]], &view);
    let near = |eye: usize| hits(&drawn, eye, 200).iter().find(|h| h.2 == 0).expect("near point").0;
    let far = |eye: usize| hits(&drawn, eye, 200).iter().find(|h| h.2 == 1).expect("far point").0;
    // The near point moves by 100 px · 0.0315 / 0.5 = 6.3 px to either side.
    assert_eq!((near(0), near(1)), (106, 93));
    assert_eq!((far(0), far(1)), (100, 99), "a far point hardly moves");
}

#[test]
fn every_stored_color_comes_out_as_it_went_in() {
    let xyz: Vec<[i32; 3]> = (0..768).map(|i| [i % 32 * 60 - 930, 1000, i / 32 * 60 - 690]).collect();
    let mut scan = scan_of(&xyz, 0.001, DVec3::ZERO);
    scan.files[0].points.rgb = (0..768u16)
        .map(|i| [[i % 256, 0, 255], [0, i % 256, 7], [i % 256; 3]][usize::from(i / 256)])
        .collect();
    let want: Vec<[u16; 3]> = scan.files[0].points.rgb.clone();
    let cloud = Order::Original.build(&scan, &base::task::Progress::hidden()).expect("cloud");
    let view = look_north([320, 320], 1.0);
    let drawn = draw(&cloud, &view, true, 0);
    let hits = hits(&drawn, 0, 320);
    assert_eq!(hits.len(), 768);
    for (x, y, index) in hits {
        let [r, g, b] = want[index as usize].map(|c| c as u8);
        assert_eq!(
            drawn.images[0][(y * 320 + x) as usize],
            u32::from_le_bytes([r, g, b, 255]),
            "point {index}"
        );
    }
}
