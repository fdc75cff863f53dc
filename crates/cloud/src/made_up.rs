//! Scans for this room's own tests. Tests from outside have those of the test kit, which is built from this room.

use glam::DVec3;
use points::{Grid, Scan, ScanBuilder};

/// A scan of points on a grid of a millimeter far from the origin, colored by `color`.
pub(crate) fn scan_of(xyz: Vec<[i32; 3]>, color: impl Fn(usize) -> [u16; 3]) -> Scan {
    let grid = Grid { scale: DVec3::splat(0.001), offset: DVec3::new(5e5, 4e6, 100.0) };
    let rgb = (0..xyz.len()).map(color).collect();
    ScanBuilder::new(grid, xyz).rgb(rgb).scan()
}

/// A color made from a point's number.
pub(crate) fn motley(i: usize) -> [u16; 3] {
    [i * 7 % 256, i * 31 % 256, i / 5 % 256].map(|c| c as u16)
}
