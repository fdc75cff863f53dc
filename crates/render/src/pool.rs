//! Where points lie on the GPU: chunks, each as large as a binding may be, cut into pages. A batch takes whole pages that
//! follow one another.

use crate::layout::{BATCH_POINTS, ChunkUniform};
use std::ops::Range;

/// Where a batch's points begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// The chunk.
    pub chunk: usize,
    /// First point in it: a multiple of a page.
    pub first_point: u32,
}

/// The places of all batches of a cloud, in their order.
#[derive(Debug, Default)]
pub(super) struct Places {
    /// A batch each.
    pub places: Vec<Place>,
    /// A chunk each: where its points stand in the pool.
    pub chunks: Vec<ChunkUniform>,
    /// A chunk each: its batches.
    pub batches: Vec<Range<usize>>,
}

impl Places {
    /// For batches of so many points, one after the other, in chunks whose planes fit `limit` bytes and one dispatch.
    pub fn new(sizes: impl Iterator<Item = u32>, page: u32, limit: u64, max_batches: usize) -> Self {
        // At least one batch fits: no adapter binds less than 128 MiB, and a lower wish is raised to a batch.
        let max_points = (limit / 4).max(u64::from(BATCH_POINTS.next_multiple_of(page)));
        let mut all = Self::default();
        let mut first_index = 0;
        for (number, size) in sizes.enumerate() {
            let pages = size.next_multiple_of(page);
            let has_room = all.chunks.last().zip(all.batches.last()).is_some_and(|(chunk, batches)| {
                u64::from(chunk.num_points) + u64::from(pages) <= max_points && batches.len() < max_batches
            });
            if !has_room {
                all.chunks.push(ChunkUniform { first_index, num_points: 0, reserved: [0; 2] });
                all.batches.push(number..number);
            }
            let chunk = all.chunks.len() - 1;
            let uniform = &mut all.chunks[chunk];
            all.places.push(Place { chunk, first_point: uniform.num_points });
            uniform.num_points += pages;
            all.batches[chunk].end = number + 1;
            first_index += pages;
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
    fn batches_lie_in_whole_pages_of_chunks_that_fit() {
        let sizes = [300, 128, 1, 10_240, 5];
        let places = Places::new(sizes.into_iter(), 128, 0, usize::MAX);
        let firsts: Vec<_> = places.places.iter().map(|place| (place.chunk, place.first_point)).collect();
        // A chunk holds 10 240 points.
        assert_eq!(firsts, [(0, 0), (0, 384), (0, 512), (1, 0), (2, 0)]);
        assert_eq!(places.batches, [0..3, 3..4, 4..5]);
        let uniforms: Vec<_> = places.chunks.iter().map(|c| (c.first_index, c.num_points)).collect();
        assert_eq!(uniforms, [(0, 640), (640, 10_240), (10_880, 128)]);
        assert_eq!((places.slot(2), places.slot(4)), (2, 0));
        // One after the other without gaps, but for whole loads.
        let flat = Places::new([8, 4, 3, 4].into_iter(), 4, u64::MAX, 3);
        let firsts: Vec<_> = flat.places.iter().map(|place| (place.chunk, place.first_point)).collect();
        assert_eq!(firsts, [(0, 0), (0, 8), (0, 12), (1, 0)]);
    }
}
