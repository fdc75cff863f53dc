//! The color that most points of a file have, found while blocks of it are read.

use std::cmp::Ordering;

/// Points of a run that are looked at first: in most files they differ, and nothing is to be counted.
const NUM_PROBES: usize = 9;

/// The color of more than half of some points, if there is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Majority {
    pub color: [u16; 3],
    /// By how many points it outnumbers all others, at least; 0 if it does not.
    pub more: u64,
}

impl Majority {
    pub const NONE: Self = Self { color: [0; 3], more: 0 };

    /// Of a run of points. Of colors that half of it have or fewer, none counts.
    pub fn of(rgb: &[[u16; 3]]) -> Self {
        // At no regular distance: what is odd may come at one.
        let golden = |number: usize| (number as f64 * 0.618_033_988_749_895).fract();
        let probe = |number: usize| rgb.get((golden(number) * rgb.len() as f64) as usize);
        let probes = (0..NUM_PROBES).filter_map(probe).map(|&color| Self { color, more: 1 });
        let Self { color, more } = probes.fold(Self::NONE, Self::union);
        if more == 0 {
            return Self::NONE;
        }
        let num: u64 = rgb.iter().map(|rgb| u64::from(*rgb == color)).sum();
        match (2 * num).saturating_sub(rgb.len() as u64) {
            0 => Self::NONE,
            more => Self { color, more },
        }
    }

    /// Of two runs together: points of two colors cancel each other (Boyer and Moore's vote).
    pub fn union(self, other: Self) -> Self {
        match self.more.cmp(&other.more) {
            _ if self.color == other.color => Self { more: self.more + other.more, ..self },
            Ordering::Greater => Self { more: self.more - other.more, ..self },
            Ordering::Less => Self { more: other.more - self.more, ..other },
            Ordering::Equal => Self::NONE,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_color_of_nearly_all_points_is_found_wherever_the_others_are() {
        let [common, other] = [[7; 3], [0, 9, 0]];
        for num in [100, 101, 1000, 50_000] {
            for step in [num, 1000, 512, 100] {
                for first in [0, step / 2, step - 1] {
                    let mut rgb = vec![common; num];
                    rgb.iter_mut().skip(first).step_by(step).for_each(|rgb| *rgb = other);
                    let num_others = rgb.iter().filter(|rgb| **rgb == other).count();
                    let more = (num - 2 * num_others) as u64;
                    assert_eq!(Majority::of(&rgb), Majority { color: common, more }, "{num} {step} {first}");
                    let blocks = rgb.chunks(997).map(Majority::of).fold(Majority::NONE, Majority::union);
                    assert_eq!(blocks.color, common, "{num} {step} {first}");
                    assert!(blocks.more >= more, "{num} {step} {first}: {}", blocks.more);
                }
            }
        }
        // All of one end.
        let rgb = [vec![other; 100], vec![common; 9900]].concat();
        let blocks = rgb.chunks(50).map(Majority::of).fold(Majority::NONE, Majority::union);
        assert_eq!(blocks, Majority { color: common, more: 9800 });
    }

    #[test]
    fn without_a_majority_there_is_none() {
        let rgb: Vec<[u16; 3]> = (0..1000).map(|at| [at, 1, 2]).collect();
        for rgb in [&[][..], &rgb, &[[1; 3], [2; 3]]] {
            assert_eq!(Majority::of(rgb), Majority::NONE);
        }
        assert_eq!(Majority::of(&[[4; 3]]), Majority { color: [4; 3], more: 1 });
        let halves = [[5; 3], [6; 3]].map(|color| Majority { color, more: 8 });
        assert_eq!(halves[0].union(halves[1]), Majority::NONE);
    }
}
