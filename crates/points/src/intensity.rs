//! Finds the ends of the ramp that intensities are drawn by: the same for all files of a scan, so that neighboring
//! tiles match.
//!
//! LAS asks for intensities of 16 bits, but many programs write 8. Where a scan has files of both kinds, files of 8
//! bits would all be dark, so their 255 counts as 65535.

use super::{ColorSource, ScanFile};
use base::space::Bounds;
use base::words::{self, agreeing};
use rayon::prelude::*;

/// Part of the values that may lie beyond each end of a ramp: single outliers must not flatten the rest.
const TAIL: f64 = 0.01;
/// Points that are a task for a core.
const BLOCK: usize = 1 << 20;
/// Largest intensity of 8 bits.
const LEAST_WHITE: usize = 255;
/// Factor of 8-bit intensities beside those of 16 bits: 65535 / 255.
const TIMES: u16 = 257;
/// Part of the values of a file of 8 bits that may be larger: they are taken for wrong.
const WRONG: f64 = 0.002;
/// Files of 8 bits together reach at least this without the tail; otherwise they are dim.
const BRIGHT_OF_8: f64 = 64.0;
/// A file of 16 bits reaches more than this without the tail; otherwise it is dim.
const BRIGHT_OF_16: f64 = 4095.0;

/// Gives the files that are drawn by intensity the ends of their ramps, which are those of a scene. Returns a sentence
/// about files of fewer bits than others.
pub(super) fn share_range(files: &mut [ScanFile], scene: &Bounds) -> Option<String> {
    let times = times(files);
    let (low, high) = range(files, &times, scene);
    for (file, &times) in files.iter_mut().zip(&times) {
        if is_by_intensity(file) {
            let [low, high] = [low, high].map(|end| end / f64::from(times));
            file.coloring.source = ColorSource::Intensity { low, high };
        }
    }
    let of_8: Vec<&ScanFile> =
        files.iter().zip(&times).filter(|(_, times)| **times > 1).map(|(file, _)| file).collect();
    let num = of_8.len();
    let (subject, have) = (words::files(of_8.first()?.path.display(), num), agreeing(num, "has", "have"));
    Some(format!(
        "{subject}: {have} intensities of 8 bits, other files of 16; {} drawn by {} own white, 255 as bright as 65535 there",
        agreeing(num, "it is", "they are"),
        agreeing(num, "its", "their"),
    ))
}

fn is_by_intensity(file: &ScanFile) -> bool {
    matches!(file.coloring.source, ColorSource::Intensity { .. })
}

/// Factors that make the intensities of each file match those of the others.
fn times(files: &[ScanFile]) -> Vec<u16> {
    let mut times = vec![1; files.len()];
    let by_intensity: Vec<usize> = (0..files.len()).filter(|&at| is_by_intensity(&files[at])).collect();
    if by_intensity.len() < 2 {
        return times;
    }
    let (mut of_8, mut brightest_of_8, mut brightest) = (Vec::new(), 0.0, 0.0);
    for at in by_intensity {
        let histogram = histogram(&files[at], 1, None);
        let num: u64 = histogram.iter().sum();
        let bright = beyond(histogram.iter().enumerate().rev(), (TAIL * num as f64) as u64);
        let num_larger: u64 = histogram[LEAST_WHITE + 1..].iter().sum();
        if num_larger as f64 <= WRONG * num as f64 {
            of_8.push(at);
            brightest_of_8 = bright.max(brightest_of_8);
        }
        brightest = bright.max(brightest);
    }
    if brightest_of_8 >= BRIGHT_OF_8 && brightest > BRIGHT_OF_16 {
        of_8.into_iter().for_each(|at| times[at] = TIMES);
    }
    times
}

/// Number of points that have each intensity after multiplication, among all points of a file or those in a scene.
fn histogram(file: &ScanFile, times: u16, scene: Option<&Bounds>) -> Vec<u64> {
    let scene = scene.filter(|scene| !(scene.contains(file.bounds.min) && scene.contains(file.bounds.max)));
    let blocks = file.points.intensity.par_chunks(BLOCK).zip(file.points.xyz.par_chunks(BLOCK));
    let counts = blocks.map(|(block, xyz)| {
        let mut counts = vec![0u64; 1 << 16];
        let mut count = |value: u16| counts[usize::from(value.saturating_mul(times))] += 1;
        match scene {
            None => block.iter().for_each(|&value| count(value)),
            Some(scene) => {
                let inside = |xyz: &[i32; 3]| scene.contains(file.grid.p_in_world(*xyz));
                block.iter().zip(xyz).filter(|(_, xyz)| inside(xyz)).for_each(|(&value, _)| count(value));
            }
        }
        counts
    });
    let sum = |mut sum: Vec<u64>, block: Vec<u64>| {
        sum.iter_mut().zip(block).for_each(|(sum, count)| *sum += count);
        sum
    };
    counts.reduce_with(sum).unwrap_or_else(|| vec![0; 1 << 16])
}

fn range(files: &[ScanFile], times: &[u16], scene: &Bounds) -> (f64, f64) {
    let mut all = vec![0u64; 1 << 16];
    for (file, &times) in files.iter().zip(times).filter(|(file, _)| is_by_intensity(file)) {
        let counts = histogram(file, times, Some(scene));
        all.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
    }
    let tail = (all.iter().sum::<u64>() as f64 * TAIL) as u64;
    let robust = (beyond(all.iter().enumerate(), tail), beyond(all.iter().enumerate().rev(), tail));
    if robust.0 < robust.1 {
        return robust;
    }
    // Nearly all values are equal, so the few others set the ends.
    (beyond(all.iter().enumerate(), 0), beyond(all.iter().enumerate().rev(), 0))
}

/// The first value that has more than `tail` values before and at it.
fn beyond<'a>(histogram: impl Iterator<Item = (usize, &'a u64)>, tail: u64) -> f64 {
    let mut sum = 0;
    let mut found = histogram.skip_while(|(_, count)| {
        sum += **count;
        sum <= tail
    });
    found.next().map_or(0.0, |(value, _)| value as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, ScanBuilder};
    use glam::DVec3;

    const EVERYWHERE: Bounds = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };

    fn tile(name: &str, intensity: impl Fn(u32) -> u16) -> ScanFile {
        let source = ColorSource::Intensity { low: 0.0, high: 0.0 };
        let made = ScanBuilder::new(Grid::default(), vec![[0; 3]; 1000]).path(name);
        made.intensity((0..1000).map(intensity).collect()).color(source).file()
    }

    /// Intensities from dark to white, as every scene has them.
    fn scene(white: f64) -> impl Fn(u32) -> u16 {
        move |at| (f64::from(at * 37 % 1000) / 999.0 * white).round() as u16
    }

    #[test]
    fn outliers_do_not_set_the_ends_and_tiles_share_them() {
        let from = |from: u16| move |at: u32| if at == 0 { 60_000 } else { from + at as u16 % 100 };
        let mut files = [tile("a", from(100)), tile("b", from(300))];
        assert_eq!(share_range(&mut files, &EVERYWHERE), None);
        assert_eq!(files[0].coloring.source, files[1].coloring.source);
        let ColorSource::Intensity { low, high } = files[0].coloring.source else {
            panic!("{:?}", files[0].coloring.source)
        };
        assert!((100.0..110.0).contains(&low) && (390.0..400.0).contains(&high), "{low} {high}");
        // The outlier would decide without the robust ends.
        assert_eq!(files[0].points.intensity.iter().max(), Some(&60_000));
    }

    #[test]
    fn files_of_8_bits_match_those_of_16() {
        // Files count as 8 bits despite one wrong value, and a dark tile does beside bright ones.
        let wrong = |at: u32| if at == 7 { 60_000 } else { scene(255.0)(at) };
        let mut files = [tile("a.las", scene(65535.0)), tile("b.las", wrong), tile("c.las", scene(20.0))];
        let sentence = share_range(&mut files, &EVERYWHERE).unwrap();
        assert!(sentence.starts_with("b.las and 1 more file: have intensities of 8 bits"), "{sentence}");
        for at in (0..1000).filter(|&at| at != 7) {
            let [a, b] = [0, 1].map(|file: usize| files[file].color(at).to_le_bytes());
            // A step of the ramp changes green by at most 2, and other channels by more.
            assert!(a[1].abs_diff(b[1]) <= 3, "{at}: {a:?} {b:?}");
        }
        assert_eq!(files[1].coloring.source, files[2].coloring.source);
        let brightest = |file: &ScanFile| (0..1000).map(|at| file.color(at)).max();
        assert_ne!(brightest(&files[1]), brightest(&files[2]));
    }

    #[test]
    fn files_that_are_only_dim_stay_dark() {
        let bright = || tile("bright", scene(65535.0));
        for dim in [tile("dim", scene(60.0)), tile("dim", scene(300.0)), tile("dim", scene(4000.0))] {
            let mut files = [bright(), dim];
            assert_eq!(share_range(&mut files, &EVERYWHERE), None);
            assert_eq!(files[0].coloring.source, files[1].coloring.source);
        }
        // Nothing changes either where no file has 16 bits, or none has 8.
        for [a, b] in [[255.0, 255.0], [255.0, 3000.0], [65535.0, 9000.0]] {
            let mut files = [tile("a", scene(a)), tile("b", scene(b))];
            assert_eq!(share_range(&mut files, &EVERYWHERE), None);
            assert_eq!(files[0].coloring.source, files[1].coloring.source);
        }
    }
}
