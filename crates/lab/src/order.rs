//! The orders of points in memory that the papers compare. The program knows the Morton order alone.

use base::task::Progress;
use cloud::format::BATCH_POINTS;
use cloud::{BuildError, Cloud, CodedPoint, build_rearranged};
use points::Scan;
use rayon::prelude::*;

base::choice! {
    /// Order of the points of a flat cloud.
    pub enum Order {
        /// As the files have them.
        Original = "original",
        /// By Morton code, so that neighbors in space lie together, which is fast.
        Morton = "morton",
        /// At random, always the same way.
        Shuffled = "shuffled",
        /// Groups of 128 neighbors at random [2021 §4].
        ShuffledMorton = "shuffled-morton",
    }
}

/// Points of a group of [`Order::ShuffledMorton`].
pub const GROUP_POINTS: usize = 128;

impl Order {
    /// Builds a flat cloud in this order; see [`cloud::build()`]. Strays come last, in the same order.
    ///
    /// # Errors
    /// See [`BuildError`].
    pub fn build(self, scan: &Scan, progress: &Progress) -> Result<Cloud, BuildError> {
        build_rearranged(scan, BATCH_POINTS, |scene, strays| self.rearrange(scene, strays), progress)
    }

    /// Brings points from the Morton order into this one.
    fn rearrange(self, scene: &mut [CodedPoint], strays: &mut [CodedPoint]) {
        match self {
            Self::Morton => {}
            Self::Original => by_key(scene, strays, u64::from),
            Self::Shuffled => by_key(scene, strays, |number| scrambled(number as usize)),
            Self::ShuffledMorton => shuffle_groups(scene),
        }
    }
}

/// Sorts the scene's points and the strays, each by a key that a point has of its number alone.
fn by_key(scene: &mut [CodedPoint], strays: &mut [CodedPoint], key: fn(u32) -> u64) {
    for points in [scene, strays] {
        points.par_sort_unstable_by_key(|&(_, number)| key(number));
    }
}

/// A pseudo-random number, a different one for each `i`: splitmix64.
fn scrambled(i: usize) -> u64 {
    let z = (i as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

/// Shuffles points in groups of [`GROUP_POINTS`]. The last group, which may be smaller, stays last.
fn shuffle_groups(points: &mut [CodedPoint]) {
    let num_groups = points.len() / GROUP_POINTS;
    let mut groups: Vec<usize> = (0..num_groups).collect();
    groups.par_sort_unstable_by_key(|&group| scrambled(group));
    let shuffled: Vec<CodedPoint> = groups
        .par_iter()
        .flat_map_iter(|&group| points[group * GROUP_POINTS..][..GROUP_POINTS].iter().copied())
        .collect();
    points[..num_groups * GROUP_POINTS].copy_from_slice(&shuffled);
}
