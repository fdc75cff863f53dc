//! Cubes of the octree as ranges of Morton-sorted keys.

use super::CodedPoint;
use crate::morton::BITS;
use std::ops::Range;

/// A cube and the keys in it.
#[derive(Clone, Debug)]
pub(super) struct CubeKeys {
    /// Its keys, at least one.
    pub keys: Range<usize>,
    /// Bits of a code below the cube; all above are the same in its keys.
    pub bits: u32,
}

impl CubeKeys {
    /// The cube of all keys: strays' codes have a bit of their own above those of the scene's.
    pub fn root(keys: &[CodedPoint]) -> Self {
        Self { keys: 0..keys.len(), bits: 3 * BITS + 3 }
    }

    /// The occupied octants of the smallest cube that holds the same keys; none if all codes are the same.
    pub fn octants(&self, keys: &[CodedPoint]) -> Vec<CubeKeys> {
        let (first, last) = (keys[self.keys.start].0, keys[self.keys.end - 1].0);
        if first == last {
            return Vec::new();
        }
        let bits = (63 - (first ^ last).leading_zeros()) / 3 * 3;
        self.parts(keys, bits)
    }

    /// The occupied cubes of a size within this one.
    fn parts(&self, keys: &[CodedPoint], bits: u32) -> Vec<CubeKeys> {
        let mut parts = Vec::with_capacity(8);
        let mut start = self.keys.start;
        while start < self.keys.end {
            let cube = keys[start].0 >> bits;
            let rest = &keys[start..self.keys.end];
            let end = start + rest.partition_point(|key| key.0 >> bits == cube);
            parts.push(CubeKeys { keys: start..end, bits });
            start = end;
        }
        parts
    }

    /// Cuts the cube in halves until each part has at most `max_keys`, or nothing tells its keys apart.
    pub fn cut(&self, keys: &[CodedPoint], max_keys: usize, each: &mut dyn FnMut(CubeKeys)) {
        if self.keys.len() <= max_keys || self.bits == 0 {
            return each(self.clone());
        }
        for part in self.parts(keys, self.bits - 3) {
            part.cut(keys, max_keys, each);
        }
    }
}
