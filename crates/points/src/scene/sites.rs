//! Finds files that were given together and lie so far apart that nobody could see them together.

use crate::Scan;
use base::space::Bounds;
use base::words;

/// Files lie far apart if more than this many edges of the larger are between them.
const FAR: f64 = 20.0;

/// Files that lie together, and the box of their scenes.
struct Site {
    files: Vec<usize>,
    bounds: Bounds,
}

impl Site {
    fn is_far_from(&self, other: &Self) -> bool {
        self.bounds.gap(&other.bounds) > FAR * self.bounds.edge().max(other.bounds.edge())
    }

    fn num_points(&self, scan: &Scan) -> usize {
        self.files.iter().map(|&file| scan.files[file].points.xyz.len()).sum()
    }

    fn name(&self, scan: &Scan) -> String {
        let first = self.files.first().map(|&file| scan.files[file].path.display().to_string());
        words::files(first.unwrap_or_default(), self.files.len())
    }
}

/// The files that lie together and have most points, in order, and a sentence about each other site. `boxes` are the
/// boxes of the files' scenes.
pub(super) fn larger(scan: &Scan, boxes: &[Bounds]) -> (Vec<usize>, Vec<String>) {
    let mut sites = sites(boxes);
    let Some(largest) = (0..sites.len()).rev().max_by_key(|&site| sites[site].num_points(scan)) else {
        return (Vec::new(), Vec::new());
    };
    let largest = sites.remove(largest);
    let sentence = |site: &Site| {
        let distance = distance(site.bounds.gap(&largest.bounds), scan.unit_m);
        let (far, near) = (site.name(scan), largest.name(scan));
        format!(
            "{far}: {distance} away from {near}: the view starts at the latter; \
             do all have the same coordinate system?"
        )
    };
    let warnings = sites.iter().map(sentence).collect();
    (largest.files, warnings)
}

/// Makes one site of files that are not far from each other, directly or by way of other files.
fn sites(boxes: &[Bounds]) -> Vec<Site> {
    let mut sites: Vec<Site> = Vec::new();
    for (file, &bounds) in boxes.iter().enumerate() {
        let mut site = Site { files: vec![file], bounds };
        // A site that has grown may be near to sites that it was far from.
        while let Some(near) = sites.iter().position(|other| !site.is_far_from(other)) {
            let near = sites.remove(near);
            site.files.extend(near.files);
            site.bounds = site.bounds.union(near.bounds);
        }
        site.files.sort_unstable();
        sites.push(site);
    }
    sites.sort_by_key(|site| site.files[0]);
    sites
}

/// A length for people.
fn distance(units: f64, unit_m: Option<f64>) -> String {
    match unit_m {
        Some(unit_m) if units * unit_m < 10_000.0 => format!("{:.0} m", units * unit_m),
        Some(unit_m) if units * unit_m < 1e9 => format!("{:.0} km", units * unit_m / 1000.0),
        Some(unit_m) => format!("{:.1e} km", units * unit_m / 1000.0),
        None if units < 1e9 => format!("{units:.0} units"),
        None => format!("{units:.1e} units"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn cube(at: f64, edge: f64) -> Bounds {
        Bounds { min: DVec3::splat(at), max: DVec3::splat(at + edge) }
    }

    fn files(boxes: &[Bounds]) -> Vec<Vec<usize>> {
        sites(boxes).into_iter().map(|site| site.files).collect()
    }

    #[test]
    fn what_is_far_from_all_is_another_site() {
        assert_eq!(files(&[cube(0.0, 20.0), cube(5e5, 20.0), cube(30.0, 20.0)]), [vec![0, 2], vec![1]]);
        // Two buildings are no mistake, and neither is a small object beside a large one.
        assert_eq!(files(&[cube(0.0, 20.0), cube(200.0, 20.0)]), [[0, 1]]);
        assert_eq!(files(&[cube(0.0, 0.0), cube(200.0, 20.0)]), [[0, 1]]);
        // Each would be a speck from where both are seen.
        assert_eq!(files(&[cube(0.0, 20.0), cube(700.0, 20.0)]), [[0], [1]]);
        // The tiles of a row are far apart only until those between have come.
        let row: Vec<Bounds> = [0, 30, 20, 10].map(|at| cube(f64::from(at), 0.9)).into();
        assert_eq!(files(&row), [[0, 1, 2, 3]]);
        assert_eq!(files(&[cube(3.0, 0.0), cube(3.0, 0.0)]), [[0, 1]]);
    }

    #[test]
    fn distances_are_read_by_people() {
        assert_eq!(distance(4_500_000.0, None), "4500000 units");
        assert_eq!(distance(4_500_000.0, Some(0.5)), "2250 km");
        assert_eq!(distance(1e38, Some(1.0)), "1.0e35 km");
    }
}
