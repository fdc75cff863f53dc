//! Where points lie on the GPU: in one pool, which is cut into chunks, each as large as a binding may be.

use crate::layout::{BATCH_POINTS, ChunkUniform};
use std::ops::Range;

/// Where a batch's points begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct BatchPlace {
    /// Number of the chunk.
    pub chunk: usize,
    /// First point, counted in the chunk.
    pub first_point: u32,
}

/// The places of all batches of a cloud, in their order.
#[derive(Debug, Default)]
pub(super) struct BatchPlaces {
    /// Place of each batch.
    pub places: Vec<BatchPlace>,
    /// Place of each chunk's points in the pool.
    pub chunks: Vec<ChunkUniform>,
    /// Batches of each chunk.
    pub batches: Vec<Range<usize>>,
}

impl BatchPlaces {
    /// Places of batches that begin at these points of the pool, which ends at `end`, in chunks whose planes fit
    /// `limit` bytes and whose batches fit one dispatch.
    pub fn new(starts: &[u32], end: u32, limit: u64, max_batches: usize) -> Self {
        // At least one batch fits: no adapter binds less than 128 MiB, and a lower wish is raised to a batch.
        let max_points = (limit / 4).max(u64::from(BATCH_POINTS));
        let ends = starts.iter().skip(1).copied().chain([end]);
        let mut all = Self::default();
        for (number, (&start, end)) in starts.iter().zip(ends).enumerate() {
            let has_room = all.chunks.last().zip(all.batches.last()).is_some_and(|(chunk, batches)| {
                u64::from(end - chunk.first_index) <= max_points && batches.len() < max_batches
            });
            if !has_room {
                all.chunks.push(ChunkUniform { first_index: start, num_points: 0, reserved: [0; 2] });
                all.batches.push(number..number);
            }
            let chunk = all.chunks.len() - 1;
            let uniform = &mut all.chunks[chunk];
            all.places.push(BatchPlace { chunk, first_point: start - uniform.first_index });
            uniform.num_points = end - uniform.first_index;
            all.batches[chunk].end = number + 1;
        }
        all
    }

    /// A batch's number among those of its chunk.
    pub fn slot(&self, batch: usize) -> usize {
        batch - self.batches[self.places[batch].chunk].start
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_lie_one_after_the_other_in_chunks_that_fit() {
        let starts = [0, 384, 512, 640, 10_880];
        let places = BatchPlaces::new(&starts, 10_888, 0, usize::MAX);
        let firsts: Vec<_> = places.places.iter().map(|place| (place.chunk, place.first_point)).collect();
        // A chunk holds 10 240 points.
        assert_eq!(firsts, [(0, 0), (0, 384), (0, 512), (1, 0), (2, 0)]);
        assert_eq!(places.batches, [0..3, 3..4, 4..5]);
        let uniforms: Vec<_> = places.chunks.iter().map(|c| (c.first_index, c.num_points)).collect();
        assert_eq!(uniforms, [(0, 640), (640, 10_240), (10_880, 8)]);
        assert_eq!((places.slot(2), places.slot(4)), (2, 0));
        // A dispatch holds three batches.
        let few = BatchPlaces::new(&[0, 8, 12, 16], 20, u64::MAX, 3);
        assert_eq!(few.batches, [0..3, 3..4]);
        assert_eq!(few.chunks[1].first_index, 16);
    }
}
