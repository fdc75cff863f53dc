//! Points without a color in files where few have one: a merged scan without photographs, a few marked points. Their
//! zeros are no color, and black points would not be seen.

use super::ScanFile;
use rayon::prelude::*;

/// Greys that black points get, as parts of white: seen before black and before white.
const GREYS: [f64; 2] = [0.25, 0.75];
/// Values looked at, evenly over the file, to find the ends of the greys.
const MOST_VALUES: usize = 1 << 18;
/// Part of the values that may lie beyond each end.
const TAIL: f64 = 0.01;

/// Gives the black points of a file greys: by intensity, or by height where that is the same everywhere.
pub(super) fn fill_with_grey(file: &mut ScanFile) {
    let Some(white) = file.color.white().map(f64::from) else { return };
    let (lattice, xyz) = (file.lattice, &file.points.xyz);
    let intensity = |at: usize| file.points.intensity.get(at).map_or(0.0, |&value| f64::from(value));
    let height = |at: usize| lattice.p_in_world(xyz[at]).z;
    let by_intensity = ends(&intensity, xyz.len());
    let (value, [low, high]): (&(dyn Fn(usize) -> f64 + Sync), _) = if by_intensity[0] < by_intensity[1] {
        (&intensity, by_intensity)
    } else {
        (&height, ends(&height, xyz.len()))
    };
    file.points.rgb.par_iter_mut().enumerate().filter(|(_, rgb)| **rgb == [0; 3]).for_each(|(at, rgb)| {
        let t = if high > low { ((value(at) - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
        *rgb = [(white * (GREYS[0] + (GREYS[1] - GREYS[0]) * t)).round() as u16; 3];
    });
}

/// The values between which all but the tails lie.
fn ends(value: &dyn Fn(usize) -> f64, num_points: usize) -> [f64; 2] {
    let step = num_points.div_ceil(MOST_VALUES).max(1);
    let mut values: Vec<f64> = (0..num_points).step_by(step).map(value).collect();
    let Some(last) = values.len().checked_sub(1) else { return [0.0; 2] };
    let tail = (values.len() as f64 * TAIL) as usize;
    [tail, last - tail].map(|at| *values.select_nth_unstable_by(at, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::super::{ColorSource, Lattice, Points};
    use super::*;
    use glam::DVec3;

    fn filled(color: ColorSource, intensity: Vec<u16>) -> Vec<[u16; 3]> {
        let xyz = (0..5).map(|z| [0, 0, z]).collect();
        let rgb = vec![[0; 3], [0; 3], [9, 0, 0], [0; 3], [0; 3]];
        let points = Points { xyz, rgb, intensity, ..Points::default() };
        let lattice = Lattice { scale: DVec3::splat(-0.5), offset: DVec3::ZERO };
        let mut file = ScanFile { lattice, points, color, ..ScanFile::default() };
        fill_with_grey(&mut file);
        file.points.rgb
    }

    #[test]
    fn black_points_are_grey_by_intensity_or_height_and_colored_ones_stay() {
        let by_intensity = filled(ColorSource::Rgb8, vec![100, 300, 0, 500, 900]);
        assert_eq!(by_intensity, [[78; 3], [106; 3], [9, 0, 0], [135; 3], [191; 3]]);
        // Heights fall along this file, and the sixteen bits are filled.
        let by_height = filled(ColorSource::Rgb16, vec![7; 5]);
        assert_eq!(by_height, [[49151; 3], [40959; 3], [9, 0, 0], [24576; 3], [16384; 3]]);
        assert_eq!(filled(ColorSource::Rgb12, vec![])[0], [3071; 3]);
        assert_eq!(filled(ColorSource::default(), vec![]), [[0; 3], [0; 3], [9, 0, 0], [0; 3], [0; 3]]);
    }
}
