//! Interface between a made-up measuring device and the file that stores its points.

use super::plan::LinePlan;
use super::record::{WrittenLayout, WrittenRecord};
use base::random::Rng;

/// Something that measures points, line after line.
pub trait MeasuringDevice: Sync {
    /// How its points are stored.
    fn layout(&self) -> WrittenLayout;

    /// How many points each line has.
    fn plan(&self) -> &LinePlan;

    /// Appends exactly `num_points` points: line number `line` of the plan, in the order of measurement.
    /// The same arguments give the same points.
    fn measure(&self, line: u64, num_points: u64, rng: &mut Rng, out: &mut Vec<WrittenRecord>);
}
