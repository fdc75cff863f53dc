//! The points of a scan's files under one running number.

use glam::DVec3;
use points::Scan;

/// Points of all files by one running number.
pub(super) struct Index<'a> {
    scan: &'a Scan,
    /// First number of each file.
    starts: Vec<usize>,
    /// Points in all files.
    pub(super) num_points: usize,
}

impl<'a> Index<'a> {
    pub(super) fn new(scan: &'a Scan) -> Self {
        let mut num_points = 0;
        let starts = scan.files.iter().map(|f| {
            let start = num_points;
            num_points += f.points.xyz.len();
            start
        });
        Self { scan, starts: starts.collect(), num_points }
    }

    /// File of a point, and the point's number within that file.
    fn locate(&self, i: usize) -> (usize, usize) {
        let file = self.starts.partition_point(|&start| start <= i) - 1;
        (file, i - self.starts[file])
    }

    /// A point's normal as its file stores it.
    pub(super) fn normal(&self, i: usize) -> Option<[f32; 3]> {
        let (file, i) = self.locate(i);
        self.scan.files[file].points.normals.get(i).copied()
    }

    /// World position.
    pub(super) fn position(&self, i: usize) -> DVec3 {
        let (file, i) = self.locate(i);
        let file = &self.scan.files[file];
        file.grid.p_in_world(file.points.xyz[i])
    }

    /// World position and color.
    pub(super) fn point(&self, i: usize) -> (DVec3, u32) {
        let (file, i) = self.locate(i);
        let file = &self.scan.files[file];
        (file.grid.p_in_world(file.points.xyz[i]), file.color(i))
    }

    /// Color: r | g≪8 | b≪16 | 255≪24.
    pub(super) fn color(&self, i: usize) -> u32 {
        let (file, i) = self.locate(i);
        self.scan.files[file].color(i)
    }
}
