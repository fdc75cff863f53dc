//! Where the cloud really is: its box without the few stray points that stretch it.

use super::{Cloud, quantize};
use crate::space::Bounds;
use glam::DVec3;

/// Points looked at.
const NUM_SAMPLES: usize = 200_000;
/// Share of the points at either end of an axis that may be strays.
const STRAYS: f64 = 0.005;
/// The box counts as stretched if an edge is this much longer than that of its body.
const STRETCH: f64 = 4.0;

impl Cloud {
    /// World positions of evenly spread points, at most about 200 000.
    pub fn samples(&self) -> impl Iterator<Item = DVec3> {
        let stride = (self.num_points as usize / NUM_SAMPLES).max(1);
        self.batches.iter().flat_map(move |batch| {
            let cells = quantize::Cells { min: batch.min, cell: batch.cell };
            let range = batch.first_point as usize..(batch.first_point + batch.num_points) as usize;
            range.step_by(stride).map(move |i| {
                cells.center(quantize::cells_of([0, 1, 2].map(|plane: usize| self.planes[plane][i])))
            })
        })
    }

    /// The box that a viewer means by "the whole scan", world space: the true box, unless a few stray points (a
    /// scanner's zeros at the origin, a bird) make it several times longer than where nearly all points are.
    #[must_use]
    pub fn body(&self) -> Bounds {
        let mut samples: Vec<DVec3> = self.samples().collect();
        let stray = (STRAYS * samples.len() as f64) as usize;
        let mut body = self.bounds;
        for axis in 0..3 {
            samples.sort_unstable_by(|a, b| a[axis].total_cmp(&b[axis]));
            let (Some(low), Some(high)) = (samples.get(stray), samples.iter().rev().nth(stray)) else {
                continue;
            };
            let margin = 0.1 * (high[axis] - low[axis]);
            body.min[axis] = body.min[axis].max(low[axis] - margin);
            body.max[axis] = body.max[axis].min(high[axis] + margin);
        }
        let stretched = self.bounds.size().max_element() > STRETCH * body.size().max_element();
        if stretched && body.size().max_element() > 0.0 { body } else { self.bounds }
    }
}

#[cfg(test)]
mod tests {
    use crate::cloud::{Order, build};
    use crate::progress::Progress;
    use crate::scan::{ColorSource, Lattice, Points, Scan, ScanFile};
    use crate::space::Bounds;
    use glam::DVec3;

    fn body_of(xyz: Vec<[i32; 3]>) -> (Bounds, Bounds) {
        let lattice = Lattice { scale: DVec3::ONE, offset: DVec3::ZERO };
        let bounds = xyz.iter().fold(Bounds::EMPTY, |b, &p| b.with(lattice.p_in_world(p)));
        let rgb = vec![[0; 3]; xyz.len()];
        let points = Points { xyz, rgb, intensity: vec![], ..Points::default() };
        let (path, format) = ("made-up".into(), "made up".into());
        let file = ScanFile {
            path,
            format,
            lattice,
            points,
            color: ColorSource::Rgb8,
            bounds,
            ..ScanFile::default()
        };
        let scan = Scan { files: vec![file], ..Scan::default() };
        let cloud = build(&scan, Order::Morton, &Progress::hidden()).expect("a cloud");
        (cloud.body(), bounds)
    }

    #[test]
    fn strays_do_not_count_and_honest_boxes_stay() {
        let block: Vec<[i32; 3]> =
            (0..8000).map(|i| [500_000 + i % 20, 6_000_000 + i / 20 % 20, i / 400]).collect();
        let (body, bounds) = body_of(block.clone());
        assert_eq!(body, bounds, "no strays: the true box");
        let strays = [[0, 0, 0], [0, 0, 1]];
        let (body, bounds) = body_of(block.into_iter().chain(strays).collect());
        assert!(bounds.size().max_element() > 5e6);
        assert!(body.size().max_element() < 30.0 && body.min.x > 499_990.0, "{body:?}");
        let (body, bounds) = body_of(vec![[7, 7, 7]; 3]);
        assert_eq!(body, bounds);
    }
}
