//! Sampling: which points of its children a node takes, and which colors they then stand for.
//!
//! Candidates come in Morton order, so the candidates of a grid cell follow one another: the one nearest to the cell's
//! center in each run is proposed. It is kept unless one already kept in a neighboring cell is closer than half a cell.
//! Which cells are taken is a bitmap in Morton order; since cells come in that order too, the number of a cell's sample
//! is the count of bits before its own, and no hash table is needed.
//!
//! If more are kept than a node may have, some are dropped at regular steps along the Morton curve, which is evenly
//! over the surface. A coarser grid would not do: a node of 64³ cells below one of 128³ has the same cells, so its
//! parent would take every sample, and a level would be missing.
//!
//! Distances are taken between code cells, of which at least 2⁴ make a grid cell: the gap between two code cells
//! is what their points are apart at least, so the guarantee holds for the points themselves.

use super::keys::SortKey;
use crate::format::{BLUE_SHIFT, CHANNEL_MASK, GREEN_SHIFT, OPAQUE};
use crate::morton::{compact, spread};

/// A point that stands for others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sample {
    /// Morton code in the frame of the node that samples it.
    pub code: u64,
    /// Its key, counted over all keys.
    pub key: u32,
    /// Points that it stands for, itself included.
    pub num_points: u32,
    /// Sums of their red, green and blue.
    pub rgb: [u64; 3],
}

impl Sample {
    /// A point that stands for itself.
    pub fn of(key: &SortKey, number: usize) -> Self {
        let channel = |shift: u32| u64::from(key.color >> shift & CHANNEL_MASK);
        let rgb = [channel(0), channel(8), channel(16)];
        Self { code: key.code, key: number as u32, num_points: 1, rgb }
    }

    /// Average of what it stands for, rounded.
    pub fn color(&self) -> u32 {
        let n = u64::from(self.num_points);
        let [r, g, b] = self.rgb.map(|sum| ((2 * sum + n) / (2 * n)) as u32);
        r | g << GREEN_SHIFT | b << BLUE_SHIFT | OPAQUE
    }

    fn absorb(&mut self, other: &Sample) {
        self.num_points += other.num_points;
        for (sum, more) in self.rgb.iter_mut().zip(other.rgb) {
            *sum += more;
        }
    }
}

/// The points that a node takes.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Sampled {
    /// Samples in Morton order.
    pub samples: Vec<Sample>,
    /// How many of them came from each child.
    pub num_taken: [u32; 8],
    /// How many were kept before [`Self::thin`] dropped some.
    pub num_spread: usize,
}

impl Sampled {
    /// Keeps at most `limit` samples. The one before a dropped sample, its neighbor on the curve, stands for it.
    fn thin(&mut self, limit: usize) {
        let num_samples = self.samples.len();
        self.num_spread = num_samples;
        if num_samples <= limit {
            return;
        }
        // The quotient grows by less than one from each sample to the next and so takes each value below `limit`:
        // `limit` are kept.
        let reached = |number: usize| number * limit / num_samples;
        let (mut kept, mut next) = (0, 0);
        for num_taken in &mut self.num_taken {
            let (first, end) = (kept, next + *num_taken as usize);
            for number in next..end {
                let sample = self.samples[number];
                if number == 0 || reached(number) > reached(number - 1) {
                    self.samples[kept] = sample;
                    kept += 1;
                } else {
                    self.samples[kept - 1].absorb(&sample);
                }
            }
            (*num_taken, next) = ((kept - first) as u32, end);
        }
        self.samples.truncate(kept);
    }
}

/// Cells in a word of the grid's bitmap.
const WORD_CELLS: u64 = 64;

/// Memory of a thread for sampling, used again for node after node.
#[derive(Debug)]
pub(super) struct Sampler {
    /// Bitmap of the grid cells that have a sample.
    taken: Vec<u64>,
    /// Number of samples before the first cell of each word.
    before: Vec<u32>,
    /// Code cells of the samples, relative to the node.
    places: Vec<[u64; 3]>,
    sampled: Sampled,
    /// The current run of candidates: its best so far, which stands for all of them, the child that this one comes
    /// from, and how near to the cell's center it is.
    run: Option<(Sample, usize, u64)>,
    grid: SamplingGrid,
}

/// How codes fall into a node's grid.
#[derive(Clone, Copy, Debug, Default)]
struct SamplingGrid {
    /// Bits of a code below the node's cube.
    node_bits: u32,
    /// Bits an axis below a grid cell.
    cell_bits: u32,
}

impl SamplingGrid {
    fn inside(&self, code: u64) -> u64 {
        code & ((1 << self.node_bits) - 1)
    }

    /// Morton number of the grid cell within the node.
    fn cell(&self, code: u64) -> u64 {
        self.inside(code) >> (3 * self.cell_bits)
    }

    /// Code cell within the node.
    fn place(&self, code: u64) -> [u64; 3] {
        let inside = self.inside(code);
        [compact(inside), compact(inside >> 1), compact(inside >> 2)]
    }

    /// Square of the distance to the grid cell's center, in half code cells.
    fn off_center(&self, code: u64) -> u64 {
        let size = 1i64 << self.cell_bits;
        let axis_sq = |v: u64| (2 * (v as i64 & (size - 1)) + 1 - size).unsigned_abs().pow(2);
        let [x, y, z] = self.place(code);
        axis_sq(x) + axis_sq(y) + axis_sq(z)
    }

    /// Smallest distance between two samples, in code cells.
    fn min_distance(&self) -> u64 {
        1 << (self.cell_bits - 1)
    }

    /// Grid cells along each axis.
    fn size(&self) -> u64 {
        1 << (self.node_bits / 3 - self.cell_bits)
    }
}

impl Sampler {
    pub fn new() -> Self {
        let num_words = (1u64 << (3 * super::GRID_BITS)) / WORD_CELLS;
        Self {
            taken: vec![0; num_words as usize],
            before: vec![0; num_words as usize],
            places: Vec::new(),
            sampled: Sampled::default(),
            run: None,
            grid: SamplingGrid::default(),
        }
    }

    /// Takes at most `limit` samples, which is at least 1, for a node whose cube has `node_bits` bits of a code below
    /// it. `feed` gives all candidates, in Morton order, with the child that they come from.
    pub fn sample(
        &mut self,
        node_bits: u32,
        limit: usize,
        feed: impl FnOnce(&mut dyn FnMut(usize, &Sample)),
    ) -> Sampled {
        self.grid = SamplingGrid { node_bits, cell_bits: node_bits / 3 - super::GRID_BITS };
        feed(&mut |child, candidate| self.offer(child, candidate));
        self.end_run();
        let mut sampled = self.finish();
        sampled.thin(limit);
        sampled
    }

    fn offer(&mut self, child: usize, candidate: &Sample) {
        let off_center = self.grid.off_center(candidate.code);
        if let Some((best, best_child, best_off_center)) = &mut self.run {
            if self.grid.cell(best.code) == self.grid.cell(candidate.code) {
                best.absorb(candidate);
                if off_center < *best_off_center {
                    (best.code, best.key) = (candidate.code, candidate.key);
                    (*best_child, *best_off_center) = (child, off_center);
                }
                return;
            }
            self.end_run();
        }
        self.run = Some((*candidate, child, off_center));
    }

    /// Keeps the best of the run, or lets a sample that is too close stand for it.
    fn end_run(&mut self) {
        let Some((sample, child, _)) = self.run.take() else { return };
        let place = self.grid.place(sample.code);
        if let Some(near) = self.too_near(place) {
            self.sampled.samples[near].absorb(&sample);
            return;
        }
        let cell = self.grid.cell(sample.code);
        let word = (cell / WORD_CELLS) as usize;
        if self.taken[word] == 0 {
            self.before[word] = self.sampled.samples.len() as u32;
        }
        self.taken[word] |= 1 << (cell % WORD_CELLS);
        self.places.push(place);
        self.sampled.samples.push(sample);
        self.sampled.num_taken[child] += 1;
    }

    /// The nearest of the samples that are closer than the smallest distance; the first if several are equally near.
    fn too_near(&self, place: [u64; 3]) -> Option<usize> {
        let grid = &self.grid;
        // The gap between two code cells is one cell less than the difference of their numbers.
        let reach = grid.min_distance() + 1;
        let end = grid.size() - 1;
        // Spread numbers of the grid cells in reach along an axis: both neighbors are in reach from the middle of a
        // cell.
        let side = |v: u64| {
            let first = v.saturating_sub(reach) >> grid.cell_bits;
            let last = end.min((v + reach) >> grid.cell_bits);
            ([first, first + 1, first + 2].map(spread), (last - first + 1) as usize)
        };
        let (xs, num_xs) = side(place[0]);
        let (ys, num_ys) = side(place[1]);
        let (zs, num_zs) = side(place[2]);
        let mut nearest = (grid.min_distance().pow(2), usize::MAX);
        for z in &zs[..num_zs] {
            for y in &ys[..num_ys] {
                for x in &xs[..num_xs] {
                    if let Some(number) = self.number(x | y << 1 | z << 2) {
                        nearest = nearest.min((self.gap_sq(place, number), number));
                    }
                }
            }
        }
        // A sample at exactly the smallest distance is far enough.
        (nearest.0 < grid.min_distance().pow(2)).then_some(nearest.1)
    }

    /// Number of the sample in a grid cell.
    fn number(&self, cell: u64) -> Option<usize> {
        let word = (cell / WORD_CELLS) as usize;
        let bit = 1u64 << (cell % WORD_CELLS);
        let taken = self.taken[word];
        (taken & bit != 0).then(|| self.before[word] as usize + (taken & (bit - 1)).count_ones() as usize)
    }

    fn gap_sq(&self, place: [u64; 3], number: usize) -> u64 {
        let other = self.places[number];
        let axis_sq = |axis: usize| place[axis].abs_diff(other[axis]).saturating_sub(1).pow(2);
        axis_sq(0) + axis_sq(1) + axis_sq(2)
    }

    /// Hands over the samples and leaves the sampler empty.
    fn finish(&mut self) -> Sampled {
        for sample in &self.sampled.samples {
            self.taken[(self.grid.cell(sample.code) / WORD_CELLS) as usize] = 0;
        }
        self.places.clear();
        std::mem::take(&mut self.sampled)
    }
}
