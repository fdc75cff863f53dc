//! CPU reference of the method `fixed40`: depths in 40-bit integers [2019 §2.1].

use super::points::cells;
use crate::technique::fixed40::{EMPTY40, RANGES, firsts};
use render::layout::{EyeUniform, VISIBLE_PLANES, VisibleBatch};

/// A pixel without points.
pub const EMPTY: u64 = EMPTY40;

/// A depth in world units as a 40-bit integer.
#[must_use]
pub fn depth40_of(depth: f64) -> u64 {
    // The first range holds whatever is nearer than the second.
    let range = RANGES.iter().rposition(|&(begin, _)| depth >= begin).unwrap_or(0);
    let (begin, steps) = RANGES[range];
    (firsts()[range] + ((depth - begin) * steps) as u64).min(EMPTY - 1)
}

/// The depth, world units, at which an integer's step begins.
#[must_use]
pub fn depth_of(depth40: u64) -> f64 {
    let firsts = firsts();
    let range = firsts.iter().rposition(|&first| depth40 >= first).unwrap_or(0);
    let (begin, steps) = RANGES[range];
    begin + (depth40 - firsts[range]) as f64 / steps
}

/// Depth before an eye, in f64 and world units, of a batch's point whose planes hold `words`.
#[must_use]
pub fn exact_depth(eye: &EyeUniform, batch: &VisibleBatch, words: [u32; 3]) -> f64 {
    let cells = cells(batch.flags & VISIBLE_PLANES, words);
    let place = |axis: usize| {
        let steps = f64::from(cells[axis] - batch.head_cell[axis]);
        steps * f64::from(batch.cell[axis]) + f64::from(batch.offset[axis])
    };
    let [x, y, z, w] = eye.row_w.map(f64::from);
    x * place(0) + y * place(1) + z * place(2) + w
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_depth_comes_back_to_the_precision_of_its_range(depth in 0.05f64..1e8) {
            let precision = if depth < 10.0 { 1e-9 } else if depth < 1e4 { 1e-6 } else { 1e-3 };
            let error = depth - depth_of(depth40_of(depth));
            prop_assert!((-1e-9 * depth..=1.001 * precision).contains(&error), "{error} at {depth}");
        }

        #[test]
        fn nearer_is_never_more(a in 0.05f64..1e9, b in 0.05f64..1e9) {
            prop_assert!((a <= b) == (depth40_of(a) <= depth40_of(b)) || depth40_of(a) == depth40_of(b));
        }
    }

    /// Depths up to 10 000 km take 30 billion of a trillion values, as the poster says.
    #[test]
    fn ranges_are_the_posters() {
        assert_eq!(firsts()[1], 10_000_000_000);
        assert_eq!(depth40_of(9.999_999_999), 9_999_999_999);
        assert_eq!(depth40_of(1e7), firsts()[2] + 9_990_000_000);
        assert_eq!(depth40_of(1e12), EMPTY - 1, "too far is as far as can be");
    }
}
