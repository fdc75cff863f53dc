//! The marks of a teleport: the arc from the hand, and where it lands a ring with an arrow that says which way one will
//! face.

use super::moving::{Guides, StagePlace, TeleportArc};
use glam::{DQuat, DVec3};
use render::scenery::Shapes;

/// Width of the arc, meters.
const ARC_M: f64 = 0.012;
/// Inner and outer radius of the ring, meters.
const RING_M: [f64; 2] = [0.24, 0.29];
/// The arrow on the ring: half its width, where it begins and where it ends, meters from the ring's middle.
const ARROW_M: [f64; 3] = [0.1, 0.31, 0.46];
/// Height of ring and arrow above the floor, meters: more than a floor's points differ.
const LIFT_M: f64 = 0.015;
/// Color of an arc that lands, linear light and how much it covers.
const LANDS: [f32; 4] = [0.05, 0.45, 0.9, 0.9];
/// Color of an arc that ends at a wall or nowhere.
const ENDS: [f32; 4] = [0.8, 0.12, 0.05, 0.7];
/// The arc grows out of the hand: how much its beginning covers.
const BEGINS: f32 = 0.15;

/// Lays out the arc, if a hand aims. `head` is in the stage.
pub(super) fn lay(shapes: &mut Shapes, guides: &Guides, stage: &StagePlace, head: DVec3) {
    if let Some(arc) = &guides.arc {
        shapes.marks(|shapes| lay_arc(shapes, arc, stage, head));
    }
}

fn lay_arc(shapes: &mut Shapes, arc: &TeleportArc, stage: &StagePlace, head: DVec3) {
    let color = if arc.landing.is_some() { LANDS } else { ENDS };
    let [r, g, b, alpha] = color;
    // The arc is solid from its fifth part on.
    let alpha_at = |i: usize| alpha * (BEGINS + 5.0 * i as f32 / arc.num.max(1) as f32).min(1.0);
    for (i, pair) in arc.points().windows(2).enumerate() {
        let ends = [pair[0], pair[1]].map(|p| stage.p_in_stage(p));
        shapes.band(ends, ARC_M, head, [i, i + 1].map(|i| [r, g, b, alpha_at(i)]));
    }
    if let Some(landing) = arc.landing {
        let center = stage.p_in_stage(landing.floor_in_world) + DVec3::Y * LIFT_M;
        shapes.ring(center, DVec3::Y, RING_M, color);
        let turn = DQuat::from_rotation_y(landing.yaw - stage.yaw);
        let [half, from, to] = ARROW_M;
        let corner = |x: f64, ahead: f64| center + turn * DVec3::new(x, 0.0, -ahead);
        shapes.triangle([corner(-half, from), corner(half, from), corner(0.0, to)], color);
    }
}

#[cfg(test)]
mod tests {
    use super::super::moving::Landing;
    use super::*;

    #[test]
    fn the_ring_lies_on_the_landing_and_the_arrow_points_ahead() {
        let place = DVec3::new(4e5, 5e6, 100.0);
        let stage = StagePlace::new(place, 0.7, 2.0);
        let landing = Landing { floor_in_world: place + DVec3::new(3.0, 4.0, 0.5), yaw: 0.7 };
        let mut arc = TeleportArc { points: [place; _], num: 4, landing: Some(landing) };
        let laid = |arc: &TeleportArc| {
            let mut shapes = Shapes::default();
            let guides = Guides { arc: Some(*arc), ..Guides::default() };
            lay(&mut shapes, &guides, &stage, DVec3::new(0.0, 1.7, 0.0));
            shapes.corners().iter().map(|corner| (corner.p_in_stage, corner.color)).collect::<Vec<_>>()
        };
        let corners = laid(&arc);
        // The last corner is the arrow's tip: with the stage's own yaw it points along the stage's −z.
        let tip = glam::Vec3::from(corners.last().expect("corners").0).as_dvec3();
        let center = stage.p_in_stage(landing.floor_in_world) + DVec3::Y * LIFT_M;
        assert!((tip - center - DVec3::NEG_Z * ARROW_M[2]).length() < 1e-6, "{tip} {center}");
        arc.landing = None;
        assert!(laid(&arc).iter().all(|(_, color)| color[0] == ENDS[0]));
    }
}
