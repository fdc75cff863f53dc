//! Cells in the making: a map from places on a grid to the points there, whose edge doubles when it would get too large.
//!
//! Sums are whole numbers, so that neither the order in which points come nor the number of threads changes a bit of what
//! comes out; nor does it matter when the edge doubles.

use rayon::prelude::*;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Bits of a coordinate within a cell of level 0.
pub(super) const FINE_BITS: u32 = 8;
/// Bits of the number of a layer in a key.
const LAYER_BITS: u32 = 20;
/// Bits of the number of a column along x in a key.
const X_BITS: u32 = 22;
/// Most columns along a side: they fit the key.
pub(super) const MOST_COLUMNS: f64 = (1u64 << 20) as f64;
/// Most layers: [`super::Cell`] has 16 bits for their numbers.
pub(super) const MOST_LAYERS: f64 = (1u64 << 16) as f64;

/// Points of a cell: their number, and the sums of their coordinates from the cell's corner, in fine steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct CellSums {
    pub num: u64,
    pub offset: [u64; 3],
}

impl CellSums {
    fn add(&mut self, other: &Self) {
        self.num += other.num;
        for axis in 0..3 {
            self.offset[axis] += other.offset[axis];
        }
    }
}

/// Place of a cell: columns along x and y, and the layer. Keys are ordered by y, then x, then upwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Key(u64);

impl Key {
    fn new([x, y, layer]: [u64; 3]) -> Self {
        Self((y << (X_BITS + LAYER_BITS)) | (x << LAYER_BITS) | layer)
    }

    pub fn xyz(self) -> [u64; 3] {
        let x = (self.0 >> LAYER_BITS) & ((1 << X_BITS) - 1);
        [x, self.0 >> (X_BITS + LAYER_BITS), self.0 & ((1 << LAYER_BITS) - 1)]
    }

    /// The column alone.
    pub fn column(self) -> u64 {
        self.0 >> LAYER_BITS
    }
}

/// The cell of twice the edge that a cell of `level` lies in, and its points seen from that cell's corner.
fn parent(key: Key, sums: &CellSums, level: u32) -> (Key, CellSums) {
    let xyz = key.xyz();
    let half = 1u64 << (FINE_BITS + level);
    let offset = std::array::from_fn(|axis| sums.offset[axis] + sums.num * half * (xyz[axis] & 1));
    (Key::new(xyz.map(|number| number >> 1)), CellSums { num: sums.num, offset })
}

/// Cells of one level: their edge is that of level 0, doubled `level` times.
#[derive(Clone, Debug, Default)]
pub(super) struct FloorCells {
    pub level: u32,
    map: HashMap<Key, CellSums, BuildHasherDefault<KeyHasher>>,
}

impl FloorCells {
    pub fn new(level: u32) -> Self {
        Self { level, map: HashMap::default() }
    }

    /// Adds a point at a place in fine steps, of which a cell of level 0 has 2⁸ along each edge.
    pub fn add(&mut self, fine: [u64; 3]) {
        let bits = FINE_BITS + self.level;
        let key = Key::new(fine.map(|place| place >> bits));
        let offset = fine.map(|place| place & ((1 << bits) - 1));
        self.map.entry(key).or_default().add(&CellSums { num: 1, offset });
    }

    /// Adds other cells, whose level is not above this one's, and doubles the edge while there are more than `most`.
    pub fn merge(&mut self, other: &Self, most: usize) {
        for (&key, sums) in &other.map {
            let (mut key, mut sums) = (key, *sums);
            for level in other.level..self.level {
                (key, sums) = parent(key, &sums, level);
            }
            self.map.entry(key).or_default().add(&sums);
        }
        while self.map.len() > most {
            let mut coarse = Self::new(self.level + 1);
            for (&key, sums) in &self.map {
                let (key, sums) = parent(key, sums, self.level);
                coarse.map.entry(key).or_default().add(&sums);
            }
            *self = coarse;
        }
    }

    /// The cells in the order of their keys. The edge is doubled while a column has fewer than `mean_points` points on
    /// average, as long as there are more than `few_columns`. Returns the level, too.
    pub fn sorted(self, mean_points: u64, few_columns: u64) -> (u32, Vec<(Key, CellSums)>) {
        let Self { mut level, map } = self;
        let mut cells: Vec<(Key, CellSums)> = map.into_iter().collect();
        cells.par_sort_unstable_by_key(|(key, _)| *key);
        loop {
            let num_columns = cells.chunk_by(|a, b| a.0.column() == b.0.column()).count() as u64;
            let num_points: u64 = cells.iter().map(|(_, sums)| sums.num).sum();
            if num_points >= mean_points * num_columns || num_columns <= few_columns {
                return (level, cells);
            }
            let mut coarse: Vec<(Key, CellSums)> =
                cells.iter().map(|(key, sums)| parent(*key, sums, level)).collect();
            coarse.par_sort_unstable_by_key(|(key, _)| *key);
            coarse.dedup_by(|next, kept| {
                let is_same = next.0 == kept.0;
                if is_same {
                    kept.1.add(&next.1);
                }
                is_same
            });
            (level, cells) = (level + 1, coarse);
        }
    }
}

/// Spreads the bits of a key. The standard library's hasher guards against attackers, which costs several times as long.
#[derive(Clone, Copy, Debug, Default)]
struct KeyHasher(u64);

impl Hasher for KeyHasher {
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(u64::from(byte)));
    }

    fn write_u64(&mut self, value: u64) {
        let mixed = (self.0 ^ value ^ (value >> 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = mixed ^ (mixed >> 29);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places all over a box, in fine steps.
    fn places(num: u64) -> Vec<[u64; 3]> {
        let at = |i: u64, step: u64, most: u64| i.wrapping_mul(step) % most;
        (0..num).map(|i| [at(i, 7919, 60_000), at(i, 104_729, 50_000), at(i, 1_299_709, 9000)]).collect()
    }

    fn made(blocks: &[&[[u64; 3]]], most: usize) -> (u32, Vec<(Key, CellSums)>) {
        let mut all = FloorCells::new(0);
        for block in blocks {
            let mut cells = FloorCells::new(0);
            block.iter().for_each(|&fine| cells.add(fine));
            all.merge(&cells, most);
        }
        all.sorted(0, 0)
    }

    #[test]
    fn neither_the_order_nor_the_blocks_change_a_bit() {
        let places = places(20_000);
        let mut reversed = places.clone();
        reversed.reverse();
        for most in [usize::MAX, 5000, 300, 1] {
            let whole = made(&[&places], most);
            assert!(whole.1.len() <= most);
            let (first, second) = reversed.split_at(3000);
            let (second, third) = second.split_at(900);
            assert_eq!(made(&[first, second, third], most), whole, "{most}");
        }
    }

    #[test]
    fn larger_cells_have_the_same_points_at_the_same_places() {
        let places = places(5000);
        let sum = |level: u32, cells: &[(Key, CellSums)]| {
            let place = |(key, sums): &(Key, CellSums)| {
                let corner = key.xyz().map(|number| number << (FINE_BITS + level));
                [0, 1, 2].map(|axis| sums.offset[axis] + sums.num * corner[axis])
            };
            cells.iter().map(place).fold([0; 3], |a, b| [0, 1, 2].map(|axis| a[axis] + b[axis]))
        };
        let (fine_level, fine) = made(&[&places], usize::MAX);
        let (coarse_level, coarse) = made(&[&places], 40);
        assert!(fine_level == 0 && coarse_level > 3);
        assert_eq!(sum(fine_level, &fine), sum(coarse_level, &coarse));
        assert_eq!(coarse.iter().map(|(_, sums)| sums.num).sum::<u64>(), 5000);
    }

    #[test]
    fn columns_get_as_many_points_as_are_wanted_on_average() {
        let mut cells = FloorCells::new(0);
        places(2000).into_iter().for_each(|fine| cells.add(fine));
        let (level, sorted) = cells.sorted(4, 16);
        let num_columns = sorted.chunk_by(|a, b| a.0.column() == b.0.column()).count();
        assert!(level > 0 && 2000 >= 4 * num_columns && num_columns > 100, "{level}: {num_columns}");
        assert!(sorted.is_sorted_by_key(|(key, _)| *key));
    }
}
