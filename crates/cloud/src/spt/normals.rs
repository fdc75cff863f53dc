//! Normals: estimated as the direction in which neighbors spread least, and packed into a word.

use glam::{DMat3, DVec3};

/// Rounds of rotations at most; a symmetric 3 × 3 matrix needs four or five until nothing is left off its diagonal.
const MAX_ROUNDS: u32 = 12;

/// Direction of least spread of some points, unit length: a surface's normal, without a side. Points that do not tell a
/// plane, on a line say, give some direction in which they do not spread.
#[must_use]
pub fn least_spread(points: &[DVec3]) -> DVec3 {
    let mean = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let mut spread = DMat3::ZERO;
    for &p in points {
        let d = p - mean;
        spread += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    let (values, vectors) = eigen(spread);
    // The last of equals is taken: points that do not spread at all have a normal that points up.
    let least = (0..3).rev().min_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or(2);
    upward(vectors.col(least))
}

/// Eigenvalues and eigenvectors, as columns, of a symmetric matrix, by Jacobi's rotations. Square roots and divisions
/// are the same on every machine, which trigonometric formulas are not.
fn eigen(mut a: DMat3) -> (DVec3, DMat3) {
    let mut vectors = DMat3::IDENTITY;
    let size = a.to_cols_array().iter().fold(0.0f64, |m, v| m.max(v.abs()));
    for _ in 0..MAX_ROUNDS {
        let off = a.col(0).y.abs() + a.col(0).z.abs() + a.col(1).z.abs();
        if off <= 1e-15 * size {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let apq = a.col(q)[p];
            if apq == 0.0 {
                continue;
            }
            let theta = (a.col(q)[q] - a.col(p)[p]) / (2.0 * apq);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let mut rotation = DMat3::IDENTITY;
            (rotation.col_mut(p)[p], rotation.col_mut(q)[q]) = (c, c);
            (rotation.col_mut(q)[p], rotation.col_mut(p)[q]) = (t * c, -t * c);
            a = rotation.transpose() * a * rotation;
            vectors *= rotation;
        }
    }
    (DVec3::new(a.col(0).x, a.col(1).y, a.col(2).z), vectors)
}

/// An axis as the one of its two directions that points up.
fn upward(axis: DVec3) -> DVec3 {
    if axis.z < 0.0 { -axis } else { axis }
}

/// Packs a direction into a word: its place on an octahedron, unfolded into a square of 65535². Zero gives some
/// direction.
#[must_use]
pub fn pack(normal: DVec3) -> u32 {
    let length = normal.abs().element_sum();
    let n = if length > 0.0 { normal / length } else { DVec3::Z };
    let (x, y) = if n.z >= 0.0 { (n.x, n.y) } else { fold(n.x, n.y) };
    let word = |v: f64| (v * 32767.0).round() as i16 as u16;
    u32::from(word(x)) | u32::from(word(y)) << 16
}

/// Inverse of [`pack`], unit length.
#[must_use]
pub fn unpack(word: u32) -> DVec3 {
    let [x, y] = [word, word >> 16].map(|word| f64::from(word as u16 as i16) / 32767.0);
    let z = 1.0 - x.abs() - y.abs();
    let (x, y) = if z >= 0.0 { (x, y) } else { fold(x, y) };
    DVec3::new(x, y, z).normalize()
}

/// Turns the octahedron's lower half outwards round the upper one's edges, and back.
fn fold(x: f64, y: f64) -> (f64, f64) {
    let sign = |v: f64| if v < 0.0 { -1.0 } else { 1.0 };
    ((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Any unit vector.
    pub fn direction() -> impl Strategy<Value = DVec3> {
        [-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0]
            .prop_map(DVec3::from_array)
            .prop_filter("a direction", |v| v.length() > 0.1)
            .prop_map(DVec3::normalize)
    }

    proptest! {
        #[test]
        fn packing_keeps_a_direction(n in direction()) {
            prop_assert!(n.angle_between(unpack(pack(n))) < 1e-4);
        }

        #[test]
        fn a_plane_has_its_normal(
            n in direction(),
            at in prop::collection::vec((-1.0f64..1.0, -1.0f64..1.0, -1e-3f64..1e-3), 8..20),
        ) {
            let (u, v) = n.any_orthonormal_pair();
            let points: Vec<DVec3> = at.iter().map(|&(x, y, z)| x * u + y * v + z * n).collect();
            // Points on a line have no plane.
            let wide = points.iter().map(|p| p.dot(u).abs()).fold(0.0, f64::max) > 0.3
                && points.iter().map(|p| p.dot(v).abs()).fold(0.0, f64::max) > 0.3;
            let (_, b) = (points[0], points[1]);
            prop_assume!(wide && points.iter().any(|p| (*p - points[0]).cross(b - points[0]).length() > 0.2));
            let found = least_spread(&points);
            prop_assert!(found.dot(n).abs() > 0.999, "{found} for {n}");
            prop_assert!(found.z >= 0.0);
        }

        #[test]
        fn eigenvectors_are_what_the_name_says(
            d in [-9.0f64..9.0, -9.0f64..9.0, -9.0f64..9.0],
            o in [-9.0f64..9.0, -9.0f64..9.0, -9.0f64..9.0],
        ) {
            let a = DMat3::from_cols_array(&[d[0], o[0], o[1], o[0], d[1], o[2], o[1], o[2], d[2]]);
            let (values, vectors) = eigen(a);
            for i in 0..3 {
                let (value, vector) = (values[i], vectors.col(i));
                prop_assert!((a * vector - value * vector).length() < 1e-9);
                prop_assert!((vector.length() - 1.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn points_without_a_plane_have_some_unit_normal() {
        for points in
            [vec![], vec![DVec3::ONE], vec![DVec3::ONE; 5], vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X]]
        {
            let normal = least_spread(&points);
            assert!((normal.length() - 1.0).abs() < 1e-12 && normal.x.abs() < 1e-9, "{points:?}: {normal}");
        }
    }
}
