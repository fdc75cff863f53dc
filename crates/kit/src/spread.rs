//! Points that are spread over a sphere.

use glam::DVec3;

/// Directions that cover the sphere evenly: a spiral from pole to pole, on which each is turned by the golden angle
/// from the one before.
pub fn directions(num: usize) -> impl Iterator<Item = DVec3> {
    const GOLDEN_ANGLE_RAD: f64 = 2.399_963_229_728_653;
    (0..num).map(move |i| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / num as f64;
        let (sin, cos) = (GOLDEN_ANGLE_RAD * i as f64).sin_cos();
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cos, across * sin, z)
    })
}
