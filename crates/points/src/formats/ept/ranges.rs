//! The first pass, where one is needed: the box of all points, and what their intensities range over.

use super::dims::{DimCell, Dims, is_whole};
use crate::column::Number;
use crate::formats::measured::{both, intensity_ramp};
use crate::grid::is_place;
use base::space::Bounds;
use glam::DVec3;

/// Most places that are kept of a node as a sample.
const NODE_SAMPLE: usize = 1 << 10;
/// Most places that are kept of all nodes.
const SAMPLE: usize = 1 << 17;

/// What was found of the points so far.
#[derive(Clone, Debug)]
pub(super) struct Ranges {
    pub bounds: Bounds,
    /// Places of a sample of the points.
    pub sample: Vec<DVec3>,
    /// The smallest and the largest stored step of each axis, if all are whole numbers.
    steps: Option<[[i128; 2]; 3]>,
    /// The smallest and the largest finite intensity.
    intensity: (f64, f64),
    /// True if intensities are whole numbers.
    is_whole: bool,
}

impl Ranges {
    /// The ranges of no points.
    pub fn none(dims: &Dims, intensity: Option<DimCell>) -> Self {
        let has_steps = dims.places.iter().all(|place| is_whole(place.cell.kind));
        Self {
            bounds: Bounds::EMPTY,
            sample: Vec::new(),
            steps: has_steps.then_some([[i128::MAX, i128::MIN]; 3]),
            intensity: (f64::MAX, f64::MIN),
            is_whole: intensity.is_some_and(|cell| is_whole(cell.kind)),
        }
    }

    /// The ranges of whole records.
    pub fn of(dims: &Dims, intensity: Option<DimCell>, records: &[u8]) -> Self {
        let mut ranges = Self::none(dims, intensity);
        let stride = (records.len() / dims.record_bytes).div_ceil(NODE_SAMPLE).max(1);
        for (number, record) in records.chunks_exact(dims.record_bytes).enumerate() {
            let p = [0, 1, 2].map(|axis| dims.places[axis].value(record));
            if is_place(&p) {
                let p = DVec3::from_array(p);
                ranges.bounds = ranges.bounds.with(p);
                if number % stride == 0 {
                    ranges.sample.push(p);
                }
                for (axis, [low, high]) in ranges.steps.iter_mut().flatten().enumerate() {
                    if let Number::Whole(step) = dims.places[axis].cell.number(record) {
                        (*low, *high) = ((*low).min(step), (*high).max(step));
                    }
                }
            }
            let value = intensity.map(|cell| cell.number(record).as_f64()).filter(|value| value.is_finite());
            if let Some(value) = value {
                ranges.intensity = both(ranges.intensity, (value, value));
            }
        }
        ranges
    }

    /// The ranges of the points of both together.
    pub fn union(mut self, other: Self) -> Self {
        self.bounds = self.bounds.union(other.bounds);
        self.sample.extend(other.sample);
        if self.sample.len() > SAMPLE {
            let mut number = 0;
            self.sample.retain(|_| {
                number += 1;
                number % 2 == 0
            });
        }
        let cover = |a: [i128; 2], b: [i128; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        self.steps = self.steps.zip(other.steps).map(|(a, b)| [0, 1, 2].map(|axis| cover(a[axis], b[axis])));
        self.intensity = both(self.intensity, other.intensity);
        self
    }

    /// The steps that are subtracted along each axis so that 32 bits hold what is left, if that can be.
    pub fn origin(&self) -> Option<[i128; 3]> {
        let steps = self.steps?;
        let fits = |[low, high]: &[i128; 2]| low <= high && high - low < i128::from(u32::MAX);
        steps.iter().all(fits).then(|| steps.map(|[low, high]| (low + high) / 2))
    }

    /// What is subtracted from intensities, and the factor that they are then multiplied by.
    pub fn intensity_ramp(&self) -> (f64, f64) {
        intensity_ramp(self.intensity, self.is_whole)
    }
}
