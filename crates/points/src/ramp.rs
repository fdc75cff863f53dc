//! Turns values into 8-bit colors: by a white, or through the ramp for points without a color.

use base::srgb::srgb_from_linear;
use std::sync::LazyLock;

/// round(c · 255 / white), in integers: no white here is even, so no tie exists. Values above the white become white.
pub(super) fn byte(c: u16, white: u16) -> u8 {
    let (c, white) = (u32::from(c.min(white)), u32::from(white));
    ((2 * 255 * c + white) / (2 * white)) as u8
}

pub(super) fn pack([r, g, b]: [u8; 3]) -> u32 {
    u32::from_le_bytes([r, g, b, 255])
}

/// The ramp's color of a value; the middle if the ends coincide.
pub(super) fn ramp(value: f64, low: f64, high: f64) -> u32 {
    let t = if high > low { (value - low) / (high - low) } else { 0.5 };
    // `as` saturates: below 0 becomes 0.
    RAMP[((t * 255.0 + 0.5) as usize).min(255)]
}

/// Violet to yellow by way of green. Lightness rises evenly in Oklab, so equal steps look equal, also to people who do
/// not see all hues, and when printed in gray.
pub(super) static RAMP: LazyLock<[u32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|index| {
        let t = index as f64 / 255.0;
        let lightness = 0.28 + 0.64 * t;
        let hue = (300.0 - 195.0 * t).to_radians();
        let chroma = 0.09 + 0.05 * t;
        pack(srgb_of_oklab(lightness, chroma * hue.cos(), chroma * hue.sin()))
    })
});

/// Converts Oklab to 8-bit sRGB, clamped to what can be shown.
fn srgb_of_oklab(lightness: f64, a: f64, b: f64) -> [u8; 3] {
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    let linear = [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ];
    linear.map(|c| (srgb_from_linear(c.clamp(0.0, 1.0)) * 255.0).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ramp_grows_lighter_everywhere() {
        let luminance = |color: u32| {
            let channel = |shift: u32| (f64::from(color >> shift & 255) / 255.0).powf(2.2);
            0.2126 * channel(0) + 0.7152 * channel(8) + 0.0722 * channel(16)
        };
        assert!(RAMP.windows(2).all(|pair| luminance(pair[0]) <= luminance(pair[1]) + 1e-3));
        assert!(luminance(RAMP[0]) < 0.05 && luminance(RAMP[255]) > 0.6);
        assert_eq!(ramp(f64::NAN, 0.0, 1.0), RAMP[0]);
        assert_eq!(ramp(-5.0, 0.0, 1.0), RAMP[0]);
        assert_eq!(ramp(5.0, 0.0, 1.0), RAMP[255]);
        assert_eq!(ramp(1.0, 1.0, 1.0), RAMP[128]);
    }
}
