//! Interface between a made-up measuring device and the file that stores its points.

use super::plan::Plan;
use super::record::{Layout, Record};
use base::random::Rng;

/// Something that measures points, line after line.
pub trait Device: Sync {
    /// How its points are stored.
    fn layout(&self) -> Layout;

    /// How many points each line has.
    fn plan(&self) -> &Plan;

    /// Appends exactly `num_points` points: line number `line` of the plan, in the order of measurement.
    /// The same arguments give the same points.
    fn measure(&self, line: u64, num_points: u64, rng: &mut Rng, out: &mut Vec<Record>);
}
