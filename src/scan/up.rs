//! Which axis of a file points up. Everything here has z up; models and many photogrammetry programs have y.

use super::{Lattice, Scan, ScanFile};
use crate::space::Bounds;
use glam::DVec3;
use rayon::prelude::*;

/// The axis of the files' coordinates that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Up {
    /// z, as surveyors have it.
    #[default]
    Z,
    /// y, and z points towards the viewer.
    Y,
}

impl Scan {
    /// The scan with z up: where `up` is y, (x, y, z) becomes (x, −z, y), which no coordinate is rounded by.
    #[must_use]
    pub(super) fn upright(mut self, up: Up) -> Self {
        if up == Up::Y {
            self.files.iter_mut().for_each(turn);
        }
        self
    }
}

fn turn(file: &mut ScanFile) {
    let turned = |v: DVec3| DVec3::new(v.x, -v.z, v.y);
    let Lattice { scale, offset } = file.lattice;
    // The sign is the scale's: a negated coordinate might not fit.
    file.lattice = Lattice { scale: turned(scale), offset: turned(offset) };
    file.points.xyz.par_iter_mut().for_each(|p| p.swap(1, 2));
    file.points.normals.par_iter_mut().for_each(|n| *n = [n[0], -n[2], n[1]]);
    let corners = [file.bounds.min, file.bounds.max].map(turned);
    file.bounds = Bounds::EMPTY.with(corners[0]).with(corners[1]);
}

#[cfg(test)]
mod tests {
    use super::super::{ColorSource, Points};
    use super::*;

    fn scan() -> Scan {
        let lattice = Lattice { scale: DVec3::new(0.5, 0.25, 2.0), offset: DVec3::new(1.0, 20.0, 300.0) };
        let xyz = vec![[1, 2, 3], [-4, 9, i32::MIN]];
        let bounds = xyz.iter().fold(Bounds::EMPTY, |b, &p| b.with(lattice.p_in_world(p)));
        let points = Points { xyz, normals: vec![[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], ..Points::default() };
        let color = ColorSource::Height { low: 0.0, high: 0.0 };
        let (path, format) = ("a.ply".into(), String::new());
        let file = ScanFile { path, format, lattice, points, color, bounds, ..ScanFile::default() };
        Scan { files: vec![file], ..Scan::default() }
    }

    #[test]
    fn what_pointed_up_does() {
        let (before, after) = (scan(), scan().upright(Up::Y).with_scene());
        let (before, after) = (&before.files[0], &after.files[0]);
        for (p, turned) in before.points.xyz.iter().zip(&after.points.xyz) {
            let p = before.lattice.p_in_world(*p);
            assert_eq!(after.lattice.p_in_world(*turned), DVec3::new(p.x, -p.z, p.y));
        }
        assert_eq!(after.points.normals, [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]);
        let found = after.points.xyz.iter().fold(Bounds::EMPTY, |b, &p| b.with(after.lattice.p_in_world(p)));
        assert_eq!(after.bounds, found);
        let ColorSource::Height { low, high } = after.color else { panic!("no ramp") };
        assert!(low >= found.min.z && high <= found.max.z && low < high);
    }

    #[test]
    fn z_up_stays() {
        assert_eq!(scan().upright(Up::Z).files[0].lattice, scan().files[0].lattice);
    }
}
