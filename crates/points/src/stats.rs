//! Extremes of columns, gathered block by block while the block is in the cache.

use rayon::prelude::*;

/// Points that are a task for a core.
const TASK_POINTS: usize = 1 << 16;

/// Extremes of the columns of some points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stats {
    /// Smallest grid coordinates.
    pub xyz_min: [i32; 3],
    /// Largest grid coordinates.
    pub xyz_max: [i32; 3],
    /// Smallest intensity.
    pub intensity_min: u16,
    /// Largest intensity.
    pub intensity_max: u16,
}

impl Stats {
    /// Extremes of no points, the neutral element of [`Stats::union`].
    pub const EMPTY: Self =
        Self { xyz_min: [i32::MAX; 3], xyz_max: [i32::MIN; 3], intensity_min: u16::MAX, intensity_max: 0 };

    /// Extremes of these columns.
    #[must_use]
    pub fn of(xyz: &[[i32; 3]], intensity: &[u16]) -> Self {
        let mut stats = Self::EMPTY;
        for p in xyz {
            stats.xyz_min = std::array::from_fn(|axis| stats.xyz_min[axis].min(p[axis]));
            stats.xyz_max = std::array::from_fn(|axis| stats.xyz_max[axis].max(p[axis]));
        }
        stats.intensity_min = intensity.iter().fold(u16::MAX, |min, &value| min.min(value));
        stats.intensity_max = intensity.iter().fold(0, |max, &value| max.max(value));
        stats
    }

    /// Extremes of long columns, found on all cores.
    pub(crate) fn of_all(xyz: &[[i32; 3]], intensity: &[u16]) -> Self {
        let xyz = xyz.par_chunks(TASK_POINTS).map(|block| Self::of(block, &[]));
        let intensity = intensity.par_chunks(TASK_POINTS).map(|block| Self::of(&[], block));
        xyz.chain(intensity).reduce(|| Self::EMPTY, Self::union)
    }

    /// Extremes of the points of both together.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            xyz_min: std::array::from_fn(|axis| self.xyz_min[axis].min(other.xyz_min[axis])),
            xyz_max: std::array::from_fn(|axis| self.xyz_max[axis].max(other.xyz_max[axis])),
            intensity_min: self.intensity_min.min(other.intensity_min),
            intensity_max: self.intensity_max.max(other.intensity_max),
        }
    }
}
