//! Leaves out points that are too far away to be held beside the others, so that these keep their precision.

use super::{Marks, ScanFile};
use base::space::Bounds;
use base::words::{agreeing, counted};
use std::fmt::Display;

/// Says that this many points were left out, in a sentence whose subject is the file.
pub(super) fn sentence(count: impl Display) -> String {
    left_out(count, "point", "farther away than the scan's precision allows")
}

/// Says that this many things were left out and why, in a sentence whose subject is the file.
pub(super) fn left_out(count: impl Display, thing: &str, why: &str) -> String {
    format!("has {} {why}; {} left out", counted(&count, thing), agreeing(&count, "it was", "they were"))
}

/// Leaves out the marked points, and all triangles with such a corner.
pub(super) fn leave_out(file: &mut ScanFile, far: &Marks) {
    if far.count() == 0 {
        return;
    }
    let num_points = file.points.xyz.len();
    let mut numbers = vec![None; num_points];
    for (next, number) in (0..num_points).filter(|&number| !far.get(number)).enumerate() {
        numbers[number] = u32::try_from(next).ok();
    }
    file.points.leave_out(far);
    let renumbered = |triangle: &mut [u32; 3]| {
        let corners = triangle.map(|corner| numbers.get(corner as usize).copied().flatten());
        let [Some(a), Some(b), Some(c)] = corners else { return false };
        *triangle = [a, b, c];
        true
    };
    file.triangles.retain_mut(renumbered);
    let grid = file.in_file.grid;
    let places = file.points.xyz.iter().map(|&xyz| grid.p_in_world(xyz));
    file.in_file.bounds = places.fold(Bounds::EMPTY, Bounds::with);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, ScanBuilder};

    #[test]
    fn all_columns_lose_the_same_points() {
        let mut noise = Marks::default();
        [1, 4].into_iter().for_each(|number| noise.set(number));
        let made = ScanBuilder::new(Grid::default(), (0..6).map(|i| [i, 10 * i, 0]).collect());
        let made = made.intensity((0..6).collect()).noise(noise);
        let mut file = made.triangles(vec![[0, 1, 3], [3, 4, 5], [0, 2, 3]]).file();
        let mut far = Marks::default();
        leave_out(&mut file, &far);
        assert_eq!(file.points.xyz.len(), 6);
        [2, 5].into_iter().for_each(|number| far.set(number));
        leave_out(&mut file, &far);
        assert_eq!(file.points.intensity, [0, 1, 3, 4]);
        assert_eq!(file.points.xyz, [[0, 0, 0], [1, 10, 0], [3, 30, 0], [4, 40, 0]]);
        assert_eq!(
            (file.points.noise.get(1), file.points.noise.get(3), file.points.noise.count()),
            (true, true, 2)
        );
        assert_eq!(file.triangles, [[0, 1, 2]]);
        assert_eq!(file.in_file.bounds.max, glam::DVec3::new(4.0, 40.0, 0.0));
    }
}
