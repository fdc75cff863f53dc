//! Tests of the ways the head moves.

use super::motion::*;
use base::space::{Eye, Fov, Pose, View};
use glam::DVec3;

/// A view of an eye that looks somewhere.
pub fn view() -> View {
    let eye = Eye {
        world_from_view: Pose::look_at(DVec3::ONE, DVec3::new(9.0, 4.0, 1.0), DVec3::Z),
        fov: Fov::symmetric(1.0, 1.0),
        size_px: [40, 36],
        gaze_in_view: Eye::AHEAD,
    };
    View { eyes: vec![eye], near: 0.05 }
}

#[test]
fn the_head_trembles_a_little_and_always_alike() {
    let views = tremor(&view(), 50);
    assert_eq!(views, tremor(&view(), 50));
    let turns: Vec<f64> = views
        .iter()
        .map(|v| {
            v.eyes[0].world_from_view.orientation.angle_between(view().eyes[0].world_from_view.orientation)
        })
        .map(f64::to_degrees)
        .collect();
    let largest = turns.iter().copied().fold(0.0, f64::max);
    // Both axes together turn by at most 0.1° · √2.
    assert!(turns[0] < 1e-6 && largest > TREMOR_DEG && largest < 1.5 * TREMOR_DEG, "{largest}");
    assert!(views.iter().all(|v| v.eyes[0].world_from_view.position == DVec3::ONE));
}

#[test]
fn the_walk_goes_straight_to_the_target() {
    let target = DVec3::new(9.0, 4.0, 1.0);
    let views = walk(&view(), target, 501);
    assert!((views[500].eyes[0].world_from_view.position - target).length() < 1e-9);
    assert_eq!(views[0], view());
}

#[test]
fn level_of_detail_approaches_as_the_walk_does() {
    let target = DVec3::new(9.0, 4.0, 1.0);
    let away = |view: &View| (target - view.eyes[0].world_from_view.position).length();
    let views = walk(&view(), target, 4);
    let scales = approach(4);
    assert_eq!(scales.len(), 3);
    for (view, scale) in views[1..].iter().zip(scales) {
        assert!((away(view) / away(&views[0]) - f64::from(scale)).abs() < 1e-6);
    }
}
