//! How far one disc is from the discs that it stands for [SPT §3.2–3.4, 3.9].

use crate::format::CHANNEL_MASK;
use glam::DVec3;

/// A disc, relative to some origin near by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Center.
    pub center: DVec3,
    /// Normal of unit length; its sign does not matter here.
    pub normal: DVec3,
    /// Radius of the disc, and of the sphere round everything that it stands for.
    pub radius: f64,
}

impl Disc {
    /// Half its extent along a direction of unit length.
    fn reach(&self, along: DVec3) -> f64 {
        let cos = self.normal.dot(along);
        self.radius * (1.0 - cos * cos).max(0.0).sqrt()
    }
}

/// A disc covers at most this many times its error: it is drawn flat to the view and at one depth, which shows where
/// it is many pixels large [SPT §4: such discs are "acceptable for small point splats only"].
pub const MAX_DISC_ERRORS: f64 = 8.0;
/// Colors of a node's children may leave their mean by this much of 255 before they count as detail.
pub const COLOR_TOLERANCE: u32 = 16;
/// Directions in the parent's plane along which the children are measured, with cosine and sine.
const SLABS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [0.923_879_532_511_286_7, 0.382_683_432_365_089_8],
    [std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2],
    [0.382_683_432_365_089_8, 0.923_879_532_511_286_7],
    [0.0, 1.0],
    [-0.382_683_432_365_089_8, 0.923_879_532_511_286_7],
    [-std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2],
    [-0.923_879_532_511_286_7, 0.382_683_432_365_089_8],
];

/// Radius of the smallest sphere round `center` that holds the children's spheres [SPT §3.1].
#[must_use]
pub fn bounding_radius(center: DVec3, children: &[Disc]) -> f64 {
    children.iter().map(|c| (c.center - center).length() + c.radius).fold(0.0, f64::max)
}

/// Distance of the two planes, parallel to the disc, that hold all children [SPT §3.2].
#[must_use]
pub fn perpendicular(disc: &Disc, children: &[Disc]) -> f64 {
    width(disc.center, disc.normal, children)
}

/// How much wider the disc is than the children, projected into its plane and measured along their narrowest
/// direction [SPT §3.3]; 0 or more.
#[must_use]
pub fn tangential(disc: &Disc, children: &[Disc]) -> f64 {
    let (u, v) = disc.normal.any_orthonormal_pair();
    let widths = SLABS.iter().map(|[cos, sin]| width(disc.center, *cos * u + *sin * v, children));
    (2.0 * disc.radius - widths.fold(f64::INFINITY, f64::min)).max(0.0)
}

/// Extent of discs along a direction.
fn width(origin: DVec3, along: DVec3, discs: &[Disc]) -> f64 {
    let mut range = (f64::INFINITY, f64::NEG_INFINITY);
    for disc in discs {
        let (at, reach) = ((disc.center - origin).dot(along), disc.reach(along));
        range = (range.0.min(at - reach), range.1.max(at + reach));
    }
    range.1 - range.0
}

/// Both errors as one that does not depend on the direction of view [SPT §3.4], at most the disc's diameter, and at
/// least its [`MAX_DISC_ERRORS`]th part.
#[must_use]
pub fn geometric(disc: &Disc, children: &[Disc]) -> f64 {
    let diameter = 2.0 * disc.radius;
    let (perpendicular, tangential) = (perpendicular(disc, children), tangential(disc, children));
    let error = (perpendicular * perpendicular + tangential * tangential).sqrt();
    error.clamp(diameter / MAX_DISC_ERRORS, diameter)
}

/// True if the children's colors, r | g≪8 | b≪16, leave their mean by so much that a single color would wash them
/// out: then the node's error is its diameter [SPT §3.9].
#[must_use]
pub fn is_colorful(mean: u32, children: impl IntoIterator<Item = u32>) -> bool {
    let channel = |color: u32, shift: u32| color >> shift & CHANNEL_MASK;
    let leaves = |color: u32| {
        [0, 8, 16].iter().any(|&s| channel(color, s).abs_diff(channel(mean, s)) > COLOR_TOLERANCE)
    };
    children.into_iter().any(leaves)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(center: [f64; 3], normal: DVec3, radius: f64) -> Disc {
        Disc { center: DVec3::from_array(center), normal, radius }
    }

    /// Four discs that circumscribe the quarters of a square with an edge of 4.
    fn quarters(normal: DVec3) -> [Disc; 4] {
        let r = 2f64.sqrt();
        [[1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]].map(|c| disc(c, normal, r))
    }

    #[test]
    fn a_flat_square_errs_in_its_plane_only() {
        let children = quarters(DVec3::Z);
        let radius = bounding_radius(DVec3::ZERO, &children);
        assert!((radius - 8f64.sqrt()).abs() < 1e-12);
        let parent = disc([0.0; 3], DVec3::Z, radius);
        assert!(perpendicular(&parent, &children) < 1e-12);
        // The width along an axis is 2 from center to center and a radius at either end.
        let want = 2.0 * radius - (2.0 + 2.0 * 2f64.sqrt());
        assert!((tangential(&parent, &children) - want).abs() < 1e-12);
        assert!(geometric(&parent, &children) < 0.2 * 2.0 * radius, "small against the diameter");
    }

    #[test]
    fn what_sticks_out_or_leans_errs_perpendicularly() {
        let parent = disc([0.0; 3], DVec3::Z, 3.0);
        let mut children = quarters(DVec3::Z);
        children[0].center.z = 0.5;
        assert!((perpendicular(&parent, &children) - 0.5).abs() < 1e-12);
        // Discs that stand on edge are as high as they are wide, wherever their normals point to.
        let upright = perpendicular(&parent, &quarters(DVec3::X));
        assert!((upright - 8f64.sqrt()).abs() < 1e-12);
        assert_eq!(upright, perpendicular(&parent, &quarters(-DVec3::X)));
    }

    /// A wire is much narrower than the disc that covers it.
    #[test]
    fn a_row_errs_tangentially() {
        let row: Vec<Disc> = (-5..=5).map(|x| disc([f64::from(x), 0.0, 0.0], DVec3::Z, 0.1)).collect();
        let parent = disc([0.0; 3], DVec3::Z, bounding_radius(DVec3::ZERO, &row));
        assert!((tangential(&parent, &row) - 10.0).abs() < 1e-9);
        assert!(geometric(&parent, &row) <= 2.0 * parent.radius);
    }

    #[test]
    fn errors_are_bound_to_the_diameter() {
        let parent = disc([0.0; 3], DVec3::Z, 1.0);
        assert_eq!(geometric(&parent, &[parent]), 2.0 / MAX_DISC_ERRORS, "the same disc again");
        let far = disc([0.0, 0.0, 40.0], DVec3::Z, 1.0);
        assert_eq!(geometric(&parent, &[parent, far]), 2.0);
    }

    #[test]
    fn one_channel_is_enough_to_be_colorful() {
        let mean = 100 | 100 << 8 | 100 << 16;
        for shift in [0, 8, 16] {
            assert!(!is_colorful(mean, [mean, mean + (COLOR_TOLERANCE << shift)]));
            assert!(is_colorful(mean, [mean, mean + ((COLOR_TOLERANCE + 1) << shift)]));
            assert!(is_colorful(mean, [mean - ((COLOR_TOLERANCE + 1) << shift)]));
        }
    }
}
