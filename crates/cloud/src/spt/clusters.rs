//! Normals by cluster: 128 triangles of a sphere, which face away together [SPT §3.10].
//!
//! An octahedron's eight faces are halved twice along each edge. Runs of discs with normals of one triangle are
//! passed over when nowhere in their box a disc can face the eye.

use super::normals::unpack;
use base::space::Bounds;
use glam::DVec3;
use std::sync::LazyLock;

/// Number of clusters: one for each triangle.
pub const NUM_CLUSTERS: usize = 128;
/// Halvings of an octahedron's edge.
const HALVINGS: u32 = 2;

/// Directions round an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Middle of the directions, unit length.
    pub axis: DVec3,
    /// Largest angle to the axis, radians.
    pub angle: f64,
}

/// The cluster of a packed normal.
#[must_use]
pub fn cluster_of(normal: u32) -> u8 {
    let n = unpack(normal);
    let octant = u8::from(n.x < 0.0) | u8::from(n.y < 0.0) << 1 | u8::from(n.z < 0.0) << 2;
    // A face is halved into four triangles: one at each corner, with the numbers 0 to 2, and the one between them, 3.
    let mut corners = face(octant);
    let mut number = octant;
    for _ in 0..HALVINGS {
        let parts = halved(corners);
        // Each triangle is a cone of three planes; its middle one takes what rounding leaves over.
        let part = (0..3).find(|&part| is_inside(n, parts[part])).unwrap_or(3);
        corners = parts[part];
        number = number << 2 | part as u8;
    }
    number
}

/// The directions of a cluster.
#[must_use]
pub fn cone_of(cluster: u8) -> Cone {
    static CONES: LazyLock<Vec<Cone>> = LazyLock::new(|| (0..NUM_CLUSTERS as u8).map(cone).collect());
    CONES[usize::from(cluster) % NUM_CLUSTERS]
}

fn cone(cluster: u8) -> Cone {
    let mut corners = face(cluster >> (2 * HALVINGS));
    for level in (0..HALVINGS).rev() {
        corners = halved(corners)[usize::from(cluster >> (2 * level) & 3)];
    }
    let axis = (corners[0] + corners[1] + corners[2]).normalize();
    // Packing moves a normal by less than the slack.
    let slack = 1e-3;
    let angle =
        corners.iter().map(|corner| libm::acos(corner.dot(axis).clamp(-1.0, 1.0))).fold(0.0, f64::max);
    Cone { axis, angle: angle + slack }
}

/// The octahedron's face in an octant: x < 0 | y < 0 ≪ 1 | z < 0 ≪ 2.
fn face(octant: u8) -> [DVec3; 3] {
    let sign = |bit: u8| if octant >> bit & 1 == 1 { -1.0 } else { 1.0 };
    [DVec3::X * sign(0), DVec3::Y * sign(1), DVec3::Z * sign(2)]
}

/// Four triangles: one at each corner, and the one between them. Corners stay on the sphere.
fn halved([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 4] {
    let [ab, bc, ca] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

/// True if a direction lies in a triangle of the sphere, whichever way round its corners are.
fn is_inside(n: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let turn = a.cross(b).dot(c).signum();
    [(a, b), (b, c), (c, a)].iter().all(|(p, q)| turn * p.cross(*q).dot(n) >= 0.0)
}

impl Cone {
    /// The directions of view in which no disc shows its front whose normal lies in this cone or within `spread` of it;
    /// `None` if there are none. A disc faces away if its normal and the direction to it lie less than a right angle
    /// apart.
    #[must_use]
    pub fn behind(&self, spread: f64) -> Option<Self> {
        let angle = std::f64::consts::FRAC_PI_2 - self.angle - spread;
        (angle > 0.0).then_some(Self { angle, ..*self })
    }

    /// True if all of a box is seen in these directions from `eye_in_world`.
    #[must_use]
    pub fn holds(&self, bounds: &Bounds, eye_in_world: DVec3) -> bool {
        let to_center = bounds.center() - eye_in_world;
        let along = to_center.dot(self.axis);
        let across = (to_center.length_squared() - along * along).max(0.0).sqrt();
        // The left side is how far the center lies within the cone; a sphere round the box must lie within it too.
        along * libm::sin(self.angle) - across * libm::cos(self.angle) >= 0.5 * bounds.size().length()
    }
}

#[cfg(test)]
mod tests {
    use super::super::normals::pack;
    use super::super::normals::tests::direction;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn a_normal_lies_in_its_clusters_cone(n in direction()) {
            let cone = cone_of(cluster_of(pack(n)));
            prop_assert!(cone.axis.angle_between(n) <= cone.angle);
        }

        #[test]
        fn what_faces_away_shows_no_front(
            n in direction(), to in direction(), distance in 0.1f64..30.0, at in [-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0],
        ) {
            let bounds = Bounds { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };
            let eye = distance * to;
            if cone_of(cluster_of(pack(n))).behind(0.0).is_some_and(|behind| behind.holds(&bounds, eye)) {
                prop_assert!((DVec3::from_array(at) - eye).dot(n) > 0.0);
            }
        }
    }

    #[test]
    fn there_are_128_clusters_of_about_one_size() {
        let mut counts = [0; NUM_CLUSTERS];
        // Points of a Fibonacci spiral lie evenly on a sphere.
        let num_points = 128_000;
        for i in 0..num_points {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(num_points);
            let (sin, cos) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
            let across = (1.0 - z * z).sqrt();
            counts[usize::from(cluster_of(pack(DVec3::new(across * cos, across * sin, z))))] += 1;
        }
        assert!(counts.iter().all(|count| (500..2000).contains(count)), "{counts:?}");
    }

    #[test]
    fn from_far_away_nearly_half_of_all_face_away() {
        let bounds = Bounds { min: DVec3::splat(-1.0), max: DVec3::splat(1.0) };
        let away = |eye: DVec3| {
            let cones = (0..NUM_CLUSTERS as u8).map(cone_of);
            cones.filter(|cone| cone.behind(0.0).is_some_and(|behind| behind.holds(&bounds, eye))).count()
        };
        assert!((36..64).contains(&away(DVec3::new(300.0, 200.0, 100.0))));
        assert_eq!(away(DVec3::ZERO), 0, "from within, everything may be seen");
    }
}
