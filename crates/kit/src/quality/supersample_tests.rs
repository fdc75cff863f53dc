//! Tests of parts of a view, and of the pixels that they become.

use super::picture::{EyePicture, only_eye};
use super::supersample::*;
use base::space::{Eye, Fov, Pose, View};
use glam::{DVec3, DVec4};

const SIZE_PX: [u32; 2] = [16, 24];
const NONE: f32 = f32::INFINITY;

fn view() -> View {
    let eye = Eye {
        world_from_view: Pose::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 4.0, 2.0), DVec3::Z),
        fov: Fov { left: -1.1, right: 0.8, up: 0.7, down: -0.9 },
        size_px: SIZE_PX,
        gaze_in_view: Eye::AHEAD,
    };
    View { eyes: vec![eye], near: 0.05 }
}

fn pixel(view: &View, p_in_world: DVec3) -> (f64, f64) {
    let [x, y, w] = only_eye(view)
        .pixel_from_head(DVec3::ZERO)
        .map(|row| DVec4::from_array(row).dot(p_in_world.extend(1.0)));
    (x / w, y / w)
}

/// A point falls on the sample that lies at its place in its pixel, and on none of any other part.
#[test]
fn parts_are_the_whole_enlarged() {
    let view = view();
    let ahead = view.eyes[0].world_from_view.orientation * DVec3::NEG_Z;
    for shift in [DVec3::ZERO, DVec3::new(0.3, -0.2, 0.1), DVec3::new(-0.4, 0.5, 0.3)] {
        let p_in_world = view.eyes[0].world_from_view.position + 2.0 * ahead + shift;
        let (x, y) = pixel(&view, p_in_world);
        let (column, row) = ((x / 4.0).floor(), (y / 6.0).floor());
        for (number, place) in (0..16).map(|n| (n, [n % 4, n / 4])) {
            let (px, py) = pixel(&part(&view, place), p_in_world);
            let inside = (0.0..16.0).contains(&px) && (0.0..24.0).contains(&py);
            assert_eq!(inside, f64::from(number) == row * 4.0 + column);
            if inside {
                assert!((px - 4.0 * (x - 4.0 * column)).abs() < 1e-9);
                assert!((py - 4.0 * (y - 6.0 * row)).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn every_sample_reaches_its_pixel() {
    let empty = EyePicture { size_px: SIZE_PX, rgb: vec![[9; 3]; 16 * 24], depth: vec![NONE; 16 * 24] };
    let background = filtered(&vec![empty.clone(); 16], [1, 2, 3]);
    assert!(background.rgb.iter().all(|rgb| *rgb == [1, 2, 3]) && background.depth[0] == NONE);
    for (x, y) in [(0, 0), (15, 23), (5, 6), (4, 17)] {
        for (sx, sy) in [(0, 0), (3, 2)] {
            let mut parts = vec![empty.clone(); 16];
            let sample = (4 * (y % 6) + sy) * 16 + 4 * (x % 4) + sx;
            let part = &mut parts[y / 6 * 4 + x / 4];
            (part.rgb[sample], part.depth[sample]) = ([100, 150, 200], 3.0);
            let mut want = background.clone();
            (want.rgb[y * 16 + x], want.depth[y * 16 + x]) = ([100, 150, 200], 3.0);
            assert_eq!(filtered(&parts, [1, 2, 3]), want);
        }
    }
}

#[test]
fn only_the_nearest_surface_is_averaged() {
    let gray = |value: u8, depth: f32| ([value; 3], depth);
    assert_eq!(
        average([gray(10, 2.0), gray(21, 2.01), gray(250, 2.1), gray(250, NONE)], [0; 3]),
        gray(16, 2.0)
    );
    assert_eq!(average([gray(250, 2.1), gray(10, 2.0)], [0; 3]), gray(10, 2.0));
    assert_eq!(average([gray(255, 1.0); 16], [0; 3]), gray(255, 1.0));
    assert_eq!(average([gray(7, NONE)], [4; 3]), gray(4, NONE));
}
