//! What a stick's deflection means: nothing near its middle, and as far as it goes at its edge in all directions.

use glam::DVec2;

/// Deflection below this is noise.
pub const DEAD_ZONE: f64 = 0.15;

/// Deflection of a stick, each axis −1 to 1, as a vector of a length from 0, at the edge of the dead zone, to 1, in all
/// directions alike.
#[must_use]
pub fn deflection(stick: [f32; 2]) -> DVec2 {
    let stick = DVec2::from_array(stick.map(f64::from));
    let length = stick.length();
    // NaN compares as false.
    if !(length > DEAD_ZONE && length.is_finite()) {
        return DVec2::ZERO;
    }
    stick / length * ((length - DEAD_ZONE) / (1.0 - DEAD_ZONE)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_direction_is_faster(x in -1f32..1.0, y in -1f32..1.0) {
            let moved = deflection([x, y]);
            prop_assert!(moved.length() <= 1.0 + 1e-12);
            let raw = DVec2::new(x.into(), y.into());
            prop_assert_eq!(moved == DVec2::ZERO, raw.length() <= DEAD_ZONE);
            prop_assert!(moved == DVec2::ZERO || moved.normalize().dot(raw.normalize()) > 1.0 - 1e-9);
        }
    }

    #[test]
    fn the_dead_zone_ends_without_a_jump() {
        assert_eq!(deflection([0.1, -0.1]), DVec2::ZERO);
        assert!(deflection([0.0, 0.151]).length() < 0.002);
        assert_eq!(deflection([0.0, 1.0]), DVec2::Y);
        assert!((deflection([1.0, 1.0]).length() - 1.0).abs() < 1e-12);
        assert!((deflection([0.575, 0.0]).x - 0.5).abs() < 1e-6);
        assert_eq!(deflection([f32::NAN, 0.4]), DVec2::ZERO);
    }
}
