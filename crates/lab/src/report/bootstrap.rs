//! Intervals in which medians lie, by a block bootstrap.
//!
//! A frame takes about as long as the one before it, so n frames say less than n independent measurements would, and
//! drawing single frames again would promise too narrow an interval. Therefore the log is cut into blocks of about √n
//! consecutive frames, and as many whole blocks are drawn with replacement (Carlstein 1986; Künsch 1989), which keeps
//! similar frames together. The spread of the resampled medians stands for that of the median. For two logs, which are
//! independent, the spread of the differences of their resampled medians stands for that of the difference. An interval
//! is the middle 95 % of the resampled values (percentile bootstrap).
//!
//! The interval covers chance within a walk, no more: two walks along different paths differ for that alone. Logs that
//! are to be compared should replay one pose path.

use base::percentile::{Sorted, middle};
use base::random::Rng;
use rayon::prelude::*;

/// Number of resamples. Another set of them would move the ends of an interval by about a fiftieth of its length.
const NUM_RESAMPLES: u64 = 2000;
/// Fewest values: with fewer there are fewer than ten blocks, and nothing can be said of the spread.
const MIN_VALUES: usize = 100;
/// Seed, so that the same logs give the same interval.
const SEED: u64 = 1;
/// Ends of the interval, in per mille.
const ENDS: [usize; 2] = [25, 975];

/// The lower and the upper end of a 95 % interval.
pub type Interval = [f64; 2];

/// Medians of resamples of values in the order in which they were measured, in blocks of at least `block_len` values;
/// `None` if there are too few. `stream` keeps the draws of one series apart from another's.
fn resampled_medians(values: &[f64], block_len: usize, stream: u64) -> Option<Vec<f64>> {
    if values.len() < MIN_VALUES {
        return None;
    }
    let num_blocks = values.len() / block_len;
    let block_of = |at: usize| at * num_blocks / values.len();
    let mut block_lens = vec![0; num_blocks];
    (0..values.len()).for_each(|at| block_lens[block_of(at)] += 1);
    // A resample only says how often each block counts, so the values are sorted once and the median is found by
    // walking up.
    let mut ascending: Vec<(f64, usize)> =
        values.iter().enumerate().map(|(at, v)| (*v, block_of(at))).collect();
    ascending.sort_unstable_by(|(a, _), (b, _)| a.total_cmp(b));
    let median = |resample: u64| {
        let mut rng = Rng::new(SEED, stream * NUM_RESAMPLES + resample);
        let mut times_drawn = vec![0; num_blocks];
        (0..num_blocks).for_each(|_| times_drawn[(rng.unit() * num_blocks as f64) as usize] += 1);
        let num: usize = times_drawn.iter().zip(&block_lens).map(|(times, len)| times * len).sum();
        let (mut walked, mut seen) = (ascending.iter(), 0);
        let mut value = f64::NAN;
        let [before, after] = middle(num).map(|place| {
            // The walk is over `num` drawn values, more than any place, so each place is reached.
            while seen <= place
                && let Some((next, block)) = walked.next()
            {
                (value, seen) = (*next, seen + times_drawn[*block]);
            }
            value
        });
        f64::midpoint(before, after)
    };
    Some((0..NUM_RESAMPLES).into_par_iter().map(median).collect())
}

/// Intervals of the difference B − A and of the ratio B / A of the medians of two series of values, each in the
/// order in which they were measured. `None` below a hundred values; no ratio where A's median may be 0.
pub(super) fn compare_medians(a: &[f64], b: &[f64]) -> Option<(Interval, Option<Interval>)> {
    compare_in_blocks([a, b], usize::isqrt)
}

fn compare_in_blocks(
    series: [&[f64]; 2],
    block_len: impl Fn(usize) -> usize,
) -> Option<(Interval, Option<Interval>)> {
    let medians = |which: usize| {
        let values: Vec<f64> = series[which].iter().copied().filter(|value| !value.is_nan()).collect();
        resampled_medians(&values, block_len(values.len()), which as u64)
    };
    let (a, b) = (medians(0)?, medians(1)?);
    let interval = |of: fn(f64, f64) -> f64| {
        let sorted = Sorted::new(a.iter().zip(&b).map(|(a, b)| of(*a, *b)));
        Some([sorted.percentile(ENDS[0])?, sorted.percentile(ENDS[1])?])
    };
    let ratio = if a.iter().all(|median| *median > 0.0) { interval(|a, b| b / a) } else { None };
    Some((interval(|a, b| b - a)?, ratio))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frame times like a walk's: each resembles the one before it.
    fn walk(num: usize, mean: f64, seed: u64) -> Vec<f64> {
        let mut rng = Rng::new(seed, 77);
        let mut state = 0.0;
        let mut next = || {
            state = 0.9 * state + 0.3 * rng.normal();
            mean + state
        };
        (0..num).map(|_| next()).collect()
    }

    fn contains(interval: Interval, value: f64) -> bool {
        interval[0] <= value && value <= interval[1]
    }

    #[test]
    fn a_resample_has_the_median_of_its_values() {
        let values = walk(137, 5.0, 3);
        let medians = resampled_medians(&values, 12, 5).unwrap();
        let num_blocks = 137 / 12;
        for (resample, median) in medians.iter().enumerate().take(50) {
            let mut rng = Rng::new(SEED, 5 * NUM_RESAMPLES + resample as u64);
            let drawn = (0..num_blocks).map(|_| (rng.unit() * num_blocks as f64) as usize);
            let of_block = |block| (0..137).filter(move |at| at * num_blocks / 137 == block);
            let gathered = Sorted::new(drawn.flat_map(of_block).map(|at| values[at]));
            assert_eq!(Some(*median), gathered.median());
        }
        assert_ne!(medians[0], medians[1], "the comparison can fail");
    }

    #[test]
    fn intervals_hold_what_they_promise() {
        let mut held = [0, 0];
        const NUM: u64 = 100;
        for seed in 0..NUM {
            let (a, b) = (walk(2000, 8.0, 2 * seed), walk(2000, 8.0, 2 * seed + 1));
            let single = compare_in_blocks([&a, &b], |_| 1).unwrap().0;
            let blocks = compare_medians(&a, &b).unwrap().0;
            held[0] += u64::from(contains(single, 0.0));
            held[1] += u64::from(contains(blocks, 0.0));
        }
        assert!(held[1] >= 85, "blocks: {held:?} of {NUM} intervals contain the true difference, 0");
        assert!(held[0] < 60, "single frames promise too much, or this test shows nothing: {held:?}");
    }

    #[test]
    fn a_shift_is_seen() {
        let (a, b) = (walk(5000, 8.0, 1), walk(4000, 9.0, 2));
        let (difference, ratio) = compare_medians(&a, &b).unwrap();
        assert!(difference[0] > 0.5 && difference[1] < 1.5, "{difference:?}");
        let ratio = ratio.unwrap();
        assert!(ratio[0] > 1.05 && ratio[1] < 1.2, "{ratio:?}");
        assert_eq!(compare_medians(&a, &b).unwrap().0, difference, "the same again");
    }

    #[test]
    fn too_little_says_nothing() {
        assert_eq!(compare_medians(&[], &[]), None);
        assert_eq!(compare_medians(&[1.0], &[2.0]), None);
        assert_eq!(compare_medians(&walk(80, 1.0, 1), &walk(5000, 1.0, 1)), None);
        assert_eq!(compare_medians(&vec![f64::NAN; 5000], &walk(5000, 1.0, 1)), None);
        let (difference, ratio) = compare_medians(&vec![0.0; 500], &vec![0.0; 500]).unwrap();
        assert_eq!((difference, ratio), ([0.0, 0.0], None), "nothing is no multiple of nothing");
    }
}
