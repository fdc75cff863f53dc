//! Unfolds the nodes of Potree 2 that are compressed with Brotli: one stream a node, attribute after attribute.
//!
//! No more is unfolded than is wanted: attributes behind the last wanted one stay folded. Memory is taken as bytes come
//! out, never for points that a node only claims.

use brotli_decompressor::{BrotliDecompressStream, BrotliResult, BrotliState, StandardAlloc};

/// Most points that a node may hold per byte. Real nodes hold less than one; only made-up ones, of many equal points, come
/// near.
const MOST_POINTS_PER_BYTE: u64 = 64;
/// Points that a node may hold on top of those per byte.
const POINTS_FOR_FREE: u64 = 1 << 16;
/// Bytes that memory is taken for at once.
const STEP_BYTES: usize = 1 << 18;

/// Points of a node that are believed, given its bytes.
pub(super) fn most_points(num_bytes: u64) -> u64 {
    num_bytes.saturating_mul(MOST_POINTS_PER_BYTE).saturating_add(POINTS_FOR_FREE)
}

/// Why nothing more can be unfolded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CannotUnfold {
    /// The stream is damaged.
    Damaged,
    /// The stream ends before all points.
    Ends,
    /// There is no memory.
    Memory,
}

/// A stream on its way out.
pub(super) struct Unfolding<'a> {
    folded: &'a [u8],
    /// Bytes of it that are used.
    used: usize,
    state: BrotliState<StandardAlloc, StandardAlloc, StandardAlloc>,
}

impl<'a> Unfolding<'a> {
    pub fn new(folded: &'a [u8]) -> Self {
        let [a, b, c] = std::array::from_fn(|_| StandardAlloc::default());
        // Only streams of an extension have windows of more than 16 MiB; the converter writes none.
        Self { folded, used: 0, state: BrotliState::new_strict(a, b, c) }
    }

    /// The next bytes.
    ///
    /// # Errors
    /// The stream ends before, or is damaged, or there is no memory.
    pub fn next(&mut self, num_bytes: usize) -> Result<Vec<u8>, CannotUnfold> {
        let mut bytes = Vec::new();
        while bytes.len() < num_bytes {
            let (first, more) = (bytes.len(), STEP_BYTES.min(num_bytes - bytes.len()));
            bytes.try_reserve(more).map_err(|_| CannotUnfold::Memory)?;
            bytes.resize(first + more, 0);
            self.fill(&mut bytes[first..])?;
        }
        Ok(bytes)
    }

    /// Passes over the next bytes.
    ///
    /// # Errors
    /// The stream ends before, or is damaged.
    pub fn skip(&mut self, num_bytes: usize) -> Result<(), CannotUnfold> {
        let mut passed = vec![0; num_bytes.min(STEP_BYTES)];
        let mut left = num_bytes;
        while left > 0 {
            let num = left.min(passed.len());
            self.fill(&mut passed[..num])?;
            left -= num;
        }
        Ok(())
    }

    fn fill(&mut self, to: &mut [u8]) -> Result<(), CannotUnfold> {
        let (mut written, mut total) = (0, 0);
        while written < to.len() {
            let (mut num_folded, mut room) = (self.folded.len() - self.used, to.len() - written);
            let result = BrotliDecompressStream(
                &mut num_folded,
                &mut self.used,
                self.folded,
                &mut room,
                &mut written,
                to,
                &mut total,
                &mut self.state,
            );
            match result {
                BrotliResult::NeedsMoreOutput => {}
                _ if written == to.len() => {}
                BrotliResult::ResultSuccess | BrotliResult::NeedsMoreInput => return Err(CannotUnfold::Ends),
                BrotliResult::ResultFailure => return Err(CannotUnfold::Damaged),
            }
        }
        Ok(())
    }
}

/// Folds bytes into a stream that does not compress: blocks of at most 64 KiB, as they are.
#[cfg(test)]
pub(super) fn fold(bytes: &[u8]) -> Vec<u8> {
    // A window of 16 bits is a single 0 bit; each block then says that it is not the last, that its length has 4 digits,
    // its length less one, and that it is stored. The last block is empty.
    let mut bits: Vec<bool> = vec![false];
    let mut folded = Vec::new();
    for block in bytes.chunks(1 << 16) {
        bits.extend([false, false, false]);
        bits.extend((0..16).map(|bit| (block.len() - 1) >> bit & 1 == 1));
        bits.push(true);
        folded.extend(
            bits.chunks(8).map(|bits| bits.iter().rev().fold(0, |byte, &bit| byte << 1 | u8::from(bit))),
        );
        folded.extend(block);
        bits.clear();
    }
    bits.extend([true, true]);
    folded
        .extend(bits.chunks(8).map(|bits| bits.iter().rev().fold(0, |byte, &bit| byte << 1 | u8::from(bit))));
    folded
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_folded_comes_out_in_parts() {
        let bytes: Vec<u8> = (0..200_000u32).map(|at| (at * 7 % 251) as u8).collect();
        let folded = fold(&bytes);
        let mut unfolding = Unfolding::new(&folded);
        assert_eq!(unfolding.next(5).unwrap(), bytes[..5]);
        unfolding.skip(70_000).unwrap();
        assert_eq!(unfolding.next(129_995).unwrap(), bytes[70_005..]);
        assert_eq!(unfolding.next(1), Err(CannotUnfold::Ends));
        assert_eq!(unfolding.next(0), Ok(Vec::new()));
    }

    #[test]
    fn a_claim_takes_no_memory_and_damage_is_seen() {
        let folded = fold(&[7; 100]);
        assert_eq!(Unfolding::new(&folded).next(1 << 50), Err(CannotUnfold::Ends));
        assert_eq!(Unfolding::new(&folded).skip(1 << 50), Err(CannotUnfold::Ends));
        assert_eq!(Unfolding::new(&folded[..50]).next(100), Err(CannotUnfold::Ends));
        assert_eq!(Unfolding::new(&[]).next(1), Err(CannotUnfold::Ends));
        assert_eq!(Unfolding::new(&[0xff; 40]).next(1), Err(CannotUnfold::Damaged));
    }
}
