//! What is decided by all values of a file together: how bright its float colors are, and how its intensities are spread.

/// The factor of float colors, and the white that they have then. Float colors should be 0 to 1, but some programs
/// write 0 to 255, or to 65535. Single values beyond an end are wrong and prove nothing. Overexposed channels above 1
/// prove nothing either, while more channels lie between 0 and 1. The array counts channels between 0 and 1, above 1,
/// and above 255.
pub(in crate::formats) fn float_factor(
    [within, above_one, above_255]: [u64; 3],
    num_points: u64,
) -> (f64, u16) {
    let most_wrong = 3 * num_points / 500;
    if above_one <= most_wrong.max(within) {
        (65535.0, u16::MAX)
    } else if above_255 <= most_wrong {
        (1.0, 255)
    } else {
        (1.0, u16::MAX)
    }
}

/// Adds a color to the numbers of channels between 0 and 1, above 1, and above 255.
#[inline]
pub(in crate::formats) fn count_channels(counts: &mut [u64; 3], rgb: [f64; 3]) {
    for channel in rgb {
        counts[0] += u64::from(0.0 < channel && channel < 1.0);
        counts[1] += u64::from(channel > 1.0);
        counts[2] += u64::from(channel > 255.0);
    }
}

/// The ends of a file's intensities, given the least, the largest and some of them. A few values far beyond the others,
/// such as -1e10 for "none", do not count.
pub(in crate::formats) fn intensity_ends((least, most): (f64, f64), some: &[f64]) -> (f64, f64) {
    let mut sample = some.to_vec();
    sample.sort_unstable_by(f64::total_cmp);
    // None of so few values can be said to lie beyond the others.
    if sample.len() < 20 {
        return (least, most);
    }
    let tail = (sample.len() / 200).max(1);
    let (low, high) = (sample[tail], sample[sample.len() - 1 - tail]);
    if low == high {
        return (least, most);
    }
    let width = high - low;
    (least.max(low - width), most.min(high + width))
}

/// The number that is subtracted from intensities, and the factor that they are then multiplied by. Whole numbers stay
/// if 16 bits hold them; other intensities are spread so that the smallest becomes 0 and the largest 65535.
pub(in crate::formats) fn intensity_ramp((low, high): (f64, f64), are_whole: bool) -> (f64, f64) {
    if are_whole && low >= 0.0 && high <= 65535.0 {
        (0.0, 1.0)
    } else if low < high {
        // The ends are halved first, because their difference need not be finite.
        (low, 32767.5 / (0.5 * high - 0.5 * low))
    } else {
        // An intensity that is the same everywhere says nothing.
        (low, 0.0)
    }
}

/// Scales a direction to length 1; NaN where it is none.
pub(in crate::formats) fn unit(v: [f64; 3]) -> [f32; 3] {
    let v = glam::DVec3::from_array(v);
    // The vector is scaled first, because the square of its length need not be finite.
    let v = v / v.abs().max_element();
    (v / v.length()).as_vec3().to_array()
}

/// The range that covers two ranges.
pub(in crate::formats) fn both(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.min(b.0), a.1.max(b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integer_intensities_stay_and_others_are_spread() {
        let spread = |values: &[f64], are_whole| {
            let finite = values.iter().copied().filter(|value| value.is_finite());
            let range = finite.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
            let (start, factor) = intensity_ramp(range, are_whole);
            values.iter().map(|v| ((v - start) * factor).round() as u16).collect::<Vec<_>>()
        };
        assert_eq!(spread(&[0.0, 7.0, 65535.0], true), [0, 7, 65535]);
        assert_eq!(spread(&[-1.0, 0.0, 1.0], true), [0, 32768, 65535]);
        assert_eq!(spread(&[0.0, 0.25, f64::NAN, 0.5], false), [0, 32768, 0, 65535]);
        let (min, max) = (f64::from(f32::MIN), f64::from(f32::MAX));
        assert_eq!(spread(&[min, max, f64::INFINITY], false), [0, 65535, 65535]);
        assert_eq!(spread(&[3.5, 3.5], false), [0, 0]);
        assert_eq!(spread(&[f64::NAN], false), [0]);
    }

    #[test]
    fn float_colors_are_as_bright_as_they_say() {
        assert_eq!(float_factor([20, 0, 0], 10), (65535.0, u16::MAX));
        assert_eq!(float_factor([0, 1, 0], 10), (1.0, 255));
        assert_eq!(float_factor([0, 30, 1], 10), (1.0, u16::MAX));
        // Single values beyond the end are wrong.
        assert_eq!(float_factor([0, 12, 12], 2000), (65535.0, u16::MAX));
        assert_eq!(float_factor([0, 6000, 12], 2000), (1.0, 255));
        // Scenes are overexposed from some channels to a third of all; a dark scene has colors of 0 to 255.
        for overexposed in [20, 300, 2000] {
            assert_eq!(float_factor([6000 - overexposed, overexposed, 0], 2000), (65535.0, u16::MAX));
        }
        assert_eq!(float_factor([900, 4000, 0], 2000), (1.0, 255));
    }

    #[test]
    fn wild_intensities_leave_the_others_apart() {
        let ends = |values: &[f64]| {
            let range = values.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
            intensity_ends(range, values)
        };
        let even: Vec<f64> = (0..1000).map(|i| f64::from(i) / 1000.0).collect();
        assert_eq!(ends(&even), (0.0, 0.999));
        for wild in [-1e10, 1e20, f64::MAX, 2_147_483_647.0] {
            for num in [1, 5, 6] {
                let (low, high) = ends(&[even.clone(), vec![wild; num]].concat());
                let is_close = (-1.1..=0.0).contains(&low) && (0.999..=2.1).contains(&high);
                assert_eq!(is_close, num < 6, "{wild} {num}: {low} {high}");
            }
        }
        // Bright spots that are no accident stay, and so do the ends of a few points.
        assert_eq!(ends(&[even.clone(), vec![1.9; 30]].concat()), (0.0, 1.9));
        assert_eq!(ends(&[0.0, 1.0, 1e9]), (0.0, 1e9));
        assert_eq!(ends(&[vec![5.0; 100], vec![9.0]].concat()), (5.0, 9.0));
    }

    #[test]
    fn normals_have_unit_length_or_are_none() {
        assert_eq!(unit([0.0, -3.0, 4.0]), [0.0, -0.6, 0.8]);
        assert_eq!(unit([1e200, 0.0, 0.0]), [1.0, 0.0, 0.0]);
        assert_eq!(unit([0.0, 1e-300, 0.0]), [0.0, 1.0, 0.0]);
        for none in [[0.0; 3], [f64::NAN, 1.0, 0.0], [f64::INFINITY, 0.0, 0.0]] {
            assert!(unit(none)[0].is_nan(), "{none:?}");
        }
    }
}
