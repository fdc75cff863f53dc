//! The place from which a whole scene is seen: so far away that its silhouette fits the picture, and no further.
//!
//! The direction of view is given. A position is in the picture if it is between four planes through the eye, so each
//! plane asks for a distance that is linear in the scene's extremes. The least distance that suits all planes is
//! found without search, for any field of view, also of two eyes.

use crate::draw::NEAR_SHARE;
use base::space::{Fov, View};
use glam::{DQuat, DVec2, DVec3};
use points::Scene;

/// Part of the field of view that the silhouette fills, across or down, whichever it reaches first.
const FILL: f64 = 0.9;
/// Distance from which one sees a scene that is a single point, world units.
const FROM_A_POINT: f64 = 1.0;
/// Steps that find the place from which the silhouette is in the middle, to a thousandth of a pixel of a picture.
const HALVINGS: usize = 24;

/// One of the eyes that look the same way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Distance to the right of the middle between the eyes, world units.
    pub sideways: f64,
    /// What it sees.
    pub fov: Fov,
}

/// Where the middle between `lenses` is to be, world space, so that all of them see the whole scene; `orientation` is
/// `world_from_view`. With `target`, a position in world space, the middle looks straight at it.
#[must_use]
pub fn place(scene: &Scene, orientation: DQuat, lenses: &[Lens], target: Option<DVec3>) -> DVec3 {
    let center = scene.bounds.center();
    let view_from_world = orientation.inverse();
    // Positions are relative to the scene's middle, because coordinates may be large and scenes small.
    let seen: Vec<DVec3> = scene.samples.iter().map(|&p| view_from_world * (p - center)).collect();
    let across: Vec<Range> = lenses.iter().map(|lens| Range::of(&seen, lens, 0)).collect();
    let down: Vec<Range> = lenses.iter().map(|lens| Range::of(&seen, lens, 1)).collect();
    let aim = target.map(|target| view_from_world * (target - center));
    let axes = [(&across, 0), (&down, 1)];
    let nearest = seen.iter().fold(f64::NEG_INFINITY, |z, p| z.max(p.z)).max(0.0);
    let least = if scene.is_a_point() { FROM_A_POINT } else { nearest };
    let back = axes.into_iter().fold(least, |back, (ranges, axis)| match aim {
        Some(aim) => back.max(back_at(ranges, aim[axis])),
        None => back.max(least_back(ranges)),
    });
    let back = back + NEAR_SHARE * scene.bounds.edge();
    let aside =
        axes.map(|(ranges, axis)| aim.map_or_else(|| middle(ranges, &seen, axis, back), |aim| aim[axis]));
    center + orientation * DVec3::new(aside[0], aside[1], back)
}

/// Says of a picture without points where the scene lies instead.
#[must_use]
pub fn out_of_view(scene: &Scene, view: &View) -> String {
    let bounds = scene.bounds;
    let Some(eye) = view.eyes.first().map(|eye| eye.world_from_view) else { return String::new() };
    let to_scene = eye.orientation.inverse() * (bounds.center() - eye.position);
    let distance = to_scene.length();
    let degrees = to_scene.angle_between(DVec3::NEG_Z).to_degrees();
    let side = match (to_scene.x, to_scene.y) {
        (x, y) if x.abs() >= y.abs() && x < 0.0 => "to the left of",
        (x, y) if x.abs() >= y.abs() => "to the right of",
        (_, y) if y < 0.0 => "below",
        _ => "above",
    };
    let direction = if degrees < 0.5 {
        "straight ahead".to_owned()
    } else {
        format!("{degrees:.0} degrees {side} the picture's middle")
    };
    // Coordinates show three digits of the scene's edge, whatever its size.
    let decimals = (3.0 - bounds.edge().max(1e-9).log10()).clamp(0.0, 12.0) as usize;
    let three = |v: DVec3| format!("{:.decimals$},{:.decimals$},{:.decimals$}", v.x, v.y, v.z);
    let (from, to) = (three(bounds.min), three(bounds.max));
    let nearest = (bounds.min - eye.position).max(eye.position - bounds.max).max(DVec3::ZERO).length();
    let clipped = if nearest <= view.near {
        format!("; nothing nearer than {} is drawn (frame.near_m)", short(view.near))
    } else {
        String::new()
    };
    format!(
        "nothing of the scan is in view: its middle is {} units from the eye, {direction}; \
         it reaches from {from} to {to}{clipped}",
        short(distance)
    )
}

/// Formats a length for people: some digits of it, without an exponent unless it is very large or small.
fn short(length: f64) -> String {
    match length.abs() {
        0.0 => "0".into(),
        l if (1e-4..1e9).contains(&l) => format!("{length:.*}", (2.0 - l.log10()).clamp(0.0, 6.0) as usize),
        _ => format!("{length:.2e}"),
    }
}

/// Along one axis of the picture, the two planes of a lens: a position (v along the axis, z toward the eye) is seen
/// from (e, back) if `high_tan · z + v ≤ high_tan · back + e` and `low_tan · z + v ≥ low_tan · back + e`.
struct Range {
    low_tan: f64,
    high_tan: f64,
    /// Distance of the lens from the middle between all lenses.
    shift: f64,
    /// Least `low_tan · z + v` of the scene's positions, less the shift.
    low: f64,
    /// Greatest `high_tan · z + v` of the scene's positions, less the shift.
    high: f64,
}

impl Range {
    fn of(seen: &[DVec3], lens: &Lens, axis: usize) -> Self {
        let Fov { left, right, up, down } = lens.fov;
        let ([low, high], shift) = if axis == 0 { ([left, right], lens.sideways) } else { ([down, up], 0.0) };
        let (middle, half) = (0.5 * (low + high), 0.5 * FILL * (high - low));
        let (low_tan, high_tan) = (middle - half, middle + half);
        let mut range = Self { low_tan, high_tan, shift, low: f64::INFINITY, high: f64::NEG_INFINITY };
        for p in seen {
            range.low = range.low.min(low_tan * p.z + p[axis] - shift);
            range.high = range.high.max(high_tan * p.z + p[axis] - shift);
        }
        range
    }
}

/// The least distance from which all is seen, wherever along the axis.
fn least_back(ranges: &[Range]) -> f64 {
    let pairs = ranges.iter().flat_map(|a| ranges.iter().map(move |b| (a, b)));
    // Lenses that look past each other have no place from which both see all.
    let pairs = pairs.filter(|(a, b)| a.high_tan - b.low_tan > 1e-6);
    pairs.map(|(a, b)| (a.high - b.low) / (a.high_tan - b.low_tan)).fold(f64::NEG_INFINITY, f64::max)
}

/// The least distance from which all is seen at a place along the axis.
fn back_at(ranges: &[Range], at: f64) -> f64 {
    let of = |range: &Range| {
        let high = if range.high_tan > 1e-6 { (range.high - at) / range.high_tan } else { f64::NEG_INFINITY };
        let low = if range.low_tan < -1e-6 { (at - range.low) / -range.low_tan } else { f64::NEG_INFINITY };
        high.max(low)
    };
    ranges.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
}

/// The place along the axis from which all is seen at a distance, and as much of the picture is left on one side of
/// the silhouette as on the other. Near parts look larger, so this is not the middle of the places from which all is
/// seen.
fn middle(ranges: &[Range], seen: &[DVec3], axis: usize, back: f64) -> f64 {
    let mut from = ranges.iter().map(|r| r.high - r.high_tan * back).fold(f64::NEG_INFINITY, f64::max);
    let mut to = ranges.iter().map(|r| r.low - r.low_tan * back).fold(f64::INFINITY, f64::min);
    // The further one stands to the high side, the more is left there.
    for _ in 0..HALVINGS {
        let at = 0.5 * (from + to);
        let [low, high] = left_over(ranges, seen, axis, DVec2::new(at, back));
        if high < low {
            from = at;
        } else {
            to = at;
        }
    }
    0.5 * (from + to)
}

/// The tangents that the picture has left below and above the silhouette, seen from (place along the axis, distance).
fn left_over(ranges: &[Range], seen: &[DVec3], axis: usize, from: DVec2) -> [f64; 2] {
    let tangents = |range: &Range| {
        let at = from.x + range.shift;
        let extremes = |[low, high]: [f64; 2], p: &DVec3| {
            let tan = (p[axis] - at) / (from.y - p.z).max(f64::MIN_POSITIVE);
            [low.min(tan), high.max(tan)]
        };
        let [low, high] = seen.iter().fold([f64::INFINITY, f64::NEG_INFINITY], extremes);
        [low - range.low_tan, range.high_tan - high]
    };
    ranges.iter().map(tangents).fold([f64::INFINITY; 2], |[low, high], [l, h]| [low.min(l), high.min(h)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::space::{Eye, Pose};
    use proptest::prelude::*;

    fn scene(samples: Vec<DVec3>) -> Scene {
        Scene::around(samples)
    }

    /// The part of the picture that the scene's silhouette spans, across and down, as from 0 to 1; `None` if a part of
    /// it is outside.
    fn span(scene: &Scene, orientation: DQuat, lens: &Lens, middle: DVec3) -> Option<[f64; 2]> {
        let (low, high) = silhouette(scene, orientation, lens, middle)?;
        Some([high[0] - low[0], high[1] - low[1]])
    }

    /// The least and the greatest part of the picture that the silhouette reaches, across and down.
    fn silhouette(
        scene: &Scene,
        orientation: DQuat,
        lens: &Lens,
        middle: DVec3,
    ) -> Option<([f64; 2], [f64; 2])> {
        let position = middle + orientation * DVec3::X * lens.sideways;
        let world_from_view = Pose { position, orientation };
        let eye = Eye { world_from_view, fov: lens.fov, size_px: [1, 1], gaze_in_view: Eye::AHEAD };
        let rows = eye.pixel_from_head(position);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for &p in &scene.samples {
            let [x, y, w] = rows.map(|row| glam::DVec4::from_array(row).dot((p - position).extend(1.0)));
            if w <= 0.0 || !(0.0..1.0).contains(&(x / w)) || !(0.0..1.0).contains(&(y / w)) {
                return None;
            }
            for (axis, at) in [x / w, y / w].into_iter().enumerate() {
                (low[axis], high[axis]) = (low[axis].min(at), high[axis].max(at));
            }
        }
        Some((low, high))
    }

    fn position() -> impl Strategy<Value = DVec3> {
        [-1.0..1.0, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn the_silhouette_fills_the_picture_and_nothing_is_cut(
            more in proptest::collection::vec(position(), 0..40),
            stretch in position(),
            exponent in -5i32..5,
            origin in prop_oneof![Just(DVec3::ZERO), Just(DVec3::new(5e5, 5e6, 300.0))],
            toward in position(),
            fov_y in 0.2..1.1f64,
            aspect in 0.2..5.0f64,
        ) {
            prop_assume!(toward.length() > 0.1 && (exponent > -3 || origin == DVec3::ZERO));
            let size = 10f64.powi(exponent);
            // These corners keep the positions from lying in one line of sight.
            let corners = [DVec3::ONE, DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_ONE];
            let positions = corners.into_iter().chain(more).map(|p| origin + p * stretch.abs().max(DVec3::splat(0.1)) * size);
            let scene = scene(positions.collect());
            let orientation = Pose::look_at(DVec3::ZERO, toward, DVec3::Z).orientation;
            let lens = Lens { sideways: 0.0, fov: Fov::symmetric(fov_y, aspect) };
            let eye = place(&scene, orientation, &[lens], None);
            let [across, down] = span(&scene, orientation, &lens, eye).expect("all is seen");
            // From the least distance the silhouette would fill its part of the picture. The eye is further away by the
            // near clip, so that a part at depth z is smaller by 1 - near clip / z: the nearest part by the most.
            let nearest = scene.samples.iter().map(|&p| (orientation.inverse() * (eye - p)).z).fold(f64::MAX, f64::min);
            let fills = FILL * (1.0 - NEAR_SHARE * scene.bounds.edge() / nearest);
            let fullest = across.max(down);
            prop_assert!(fullest > fills - 1e-3, "{across} x {down}, no less than {fills} expected");
            prop_assert!(fullest <= FILL + 1e-4);
            // As much of the picture is left on either side.
            let (low, high) = silhouette(&scene, orientation, &lens, eye).expect("all is seen");
            for axis in 0..2 {
                prop_assert!((low[axis] + high[axis] - 1.0).abs() < 1e-3, "from {low:?} to {high:?}");
            }
            // Looking straight at a target makes the scene smaller in the picture, but never cuts a part of it.
            let target = scene.samples[0];
            let eye = place(&scene, orientation, &[lens], Some(target));
            prop_assert!(span(&scene, orientation, &lens, eye).is_some());
            let ahead = orientation * DVec3::NEG_Z;
            prop_assert!(((target - eye).normalize() - ahead).length() < 1e-5);
        }

        #[test]
        fn both_eyes_see_all(positions in proptest::collection::vec(position(), 2..40), ipd in 0.0..5.0f64) {
            let scene = scene(positions);
            let orientation = Pose::look_at(DVec3::ZERO, DVec3::new(-0.5, 0.7, -0.4), DVec3::Z).orientation;
            let fov = Fov::from_angles(-0.9, 0.7, 0.8, -0.85);
            let lenses = [
                Lens { sideways: -0.5 * ipd, fov },
                Lens { sideways: 0.5 * ipd, fov: fov.mirrored() },
            ];
            let middle = place(&scene, orientation, &lenses, None);
            for lens in &lenses {
                prop_assert!(span(&scene, orientation, lens, middle).is_some());
            }
        }
    }

    #[test]
    fn a_single_point_is_in_the_middle_beyond_the_near_clip() {
        let p = DVec3::new(5e5, 5e6, 300.0);
        let one = scene(vec![p; 500]);
        let orientation = Pose::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z).orientation;
        let lens = Lens { sideways: 0.0, fov: Fov::symmetric(1.0, 1.5) };
        let eye = place(&one, orientation, &[lens], None);
        assert!((eye - (p - DVec3::Y)).length() < 1e-6, "{eye}");
        assert_eq!(span(&one, orientation, &lens, eye), Some([0.0, 0.0]));
    }

    #[test]
    fn lengths_are_read_by_people() {
        let lengths = [0.0, 1e-300, 0.001, 0.05, 5.0, 123.4, 4e6, 1e12].map(short);
        assert_eq!(lengths, ["0", "1.00e-300", "0.00100", "0.050", "5.0", "123", "4000000", "1.00e12"]);
    }

    #[test]
    fn who_sees_nothing_is_told_where_the_scene_is() {
        let scene = scene(vec![DVec3::new(10.0, 20.0, 30.0), DVec3::new(12.0, 22.0, 31.0)]);
        let told = |eye: DVec3, target: DVec3, near: f64| {
            let world_from_view = Pose::look_at(eye, target, DVec3::Z);
            let fov = Fov::symmetric(1.0, 1.0);
            let eye = Eye { world_from_view, fov, size_px: [9, 9], gaze_in_view: Eye::AHEAD };
            out_of_view(&scene, &View { eyes: vec![eye], near })
        };
        let middle = scene.bounds.center();
        let left = told(middle + DVec3::X * 4000.0, middle + DVec3::new(4000.0, 1.0, 0.0), 0.05);
        assert!(
            left.contains("is 4000 units from the eye, 90 degrees to the left of the picture's middle;"),
            "{left}"
        );
        assert!(left.ends_with("from 10.00,20.00,30.00 to 12.00,22.00,31.00"), "{left}");
        let above = told(middle - DVec3::Z * 9.0, middle - DVec3::Z * 10.0 + DVec3::Y, 0.05);
        assert!(
            above.contains("is 9.0 units from the eye, 135 degrees above the picture's middle;"),
            "{above}"
        );
        let below = told(middle + DVec3::Z * 9.0, middle + DVec3::new(0.0, 1.0, 9.0), 0.05);
        assert!(below.contains("90 degrees below the picture's middle;"), "{below}");
        let near = told(middle - DVec3::Y * 2.0, middle, 5.0);
        assert!(near.contains("is 2.0 units from the eye, straight ahead;"), "{near}");
        assert!(near.contains("nothing nearer than 5.0 is drawn"), "{near}");
    }
}
