//! sRGB, as images hold it, and linear light: the standard's two curves. Shaders have the same ones in
//! `shaders/srgb.inc.wgsl`, of the same numbers.

/// Largest value in sRGB up to which the curves are straight.
pub const SRGB_STRAIGHT: f64 = 0.04045;
/// The same value in linear light.
pub const LINEAR_STRAIGHT: f64 = 0.003_130_8;
/// How steep the straight part is.
pub const SRGB_SLOPE: f64 = 12.92;
/// What the curved part is shifted by.
pub const SRGB_SHIFT: f64 = 0.055;
/// What the curved part is stretched by.
pub const SRGB_STRETCH: f64 = 1.055;
/// The power of the curved part.
pub const SRGB_POWER: f64 = 2.4;

/// A value of sRGB, 0 to 1, as linear light.
#[must_use]
pub fn linear_from_srgb(srgb: f64) -> f64 {
    if srgb <= SRGB_STRAIGHT {
        srgb / SRGB_SLOPE
    } else {
        ((srgb + SRGB_SHIFT) / SRGB_STRETCH).powf(SRGB_POWER)
    }
}

/// A step of an 8-bit image in sRGB as linear light.
#[must_use]
pub fn linear_of_step(step: u8) -> f64 {
    linear_from_srgb(f64::from(step) / 255.0)
}

/// Linear light, 0 to 1, as a value of sRGB.
#[must_use]
pub fn srgb_from_linear(linear: f64) -> f64 {
    if linear <= LINEAR_STRAIGHT {
        SRGB_SLOPE * linear
    } else {
        SRGB_STRETCH * linear.powf(1.0 / SRGB_POWER) - SRGB_SHIFT
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_curve_undoes_the_other() {
        for step in 0..=255 {
            let srgb = srgb_from_linear(linear_of_step(step));
            assert!((255.0 * srgb - f64::from(step)).abs() < 1e-4, "{step}: {srgb}");
        }
    }

    /// The standard's own example: mid-gray, 18 % of the light, is step 118 of an image.
    #[test]
    fn middle_gray_is_where_the_standard_has_it() {
        assert_eq!((255.0 * srgb_from_linear(0.18)).round(), 118.0);
        assert_eq!([linear_from_srgb(0.0), linear_from_srgb(1.0)], [0.0, 1.0]);
    }
}
