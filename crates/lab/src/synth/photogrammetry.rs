//! A reconstruction from photographs: a dense, noisy, colored surface, tile by tile.
//!
//! Small cubes along the surface, tile after tile, are the lines of this device. Points are thrown into a
//! cube and fall onto the surface; they stay as often as photographs would show the place.

use super::Viewpoint;
use super::device::MeasuringDevice;
use super::plan::LinePlan;
use super::record::{WrittenFormat, WrittenLayout, WrittenRecord};
use super::statue;
use base::random::{Rng, fractal};
use glam::DVec3;
use points::Grid;
use rayon::prelude::*;
use std::sync::OnceLock;

/// Edge of a tile.
const TILE_M: f64 = 0.8;
/// Cubes along a tile's edge.
const CUBES: i64 = 16;
/// Edge of a cube.
const CUBE_M: f64 = TILE_M / CUBES as f64;
/// Number of tiles from the middle outwards, and upwards.
const TILES: [i64; 2] = [5, 5];
/// Points thrown into a cube to see how many stay.
const TRIALS: u32 = 12;
/// Noise of the depth maps.
const NOISE_M: f64 = 0.0012;
/// Share of points that are plainly wrong.
const OUTLIERS: f64 = 0.002;

/// Good places to stand.
pub const VIEWPOINTS: [Viewpoint; 2] = [
    Viewpoint { name: "overview", eye: DVec3::new(-1.7, -3.3, 2.3), target: DVec3::new(0.0, 0.0, 1.55) },
    Viewpoint { name: "face", eye: DVec3::new(-0.4, -1.5, 2.75), target: DVec3::new(0.0, -0.05, 2.52) },
];

/// The cubes and how many points each gets.
pub struct Reconstruction {
    cubes: &'static [DVec3],
    plan: LinePlan,
}

impl Reconstruction {
    /// Makes a reconstruction that will have this many points in all.
    pub fn new(points: u64) -> Self {
        static CUBES: OnceLock<(Vec<DVec3>, Vec<u32>)> = OnceLock::new();
        let (cubes, weights) = CUBES.get_or_init(find_cubes);
        Self { cubes, plan: LinePlan::new(points, 1, cubes.len() as u64, weights.clone()) }
    }
}

/// Smallest corners of the cubes that hold surface, tile by tile, and how many trial points stay in each.
fn find_cubes() -> (Vec<DVec3>, Vec<u32>) {
    let [out, up] = TILES;
    let tiles: Vec<DVec3> = (-out..out)
        .flat_map(|x| (-out..out).flat_map(move |y| (0..up).map(move |z| (x, y, z))))
        .map(|(x, y, z)| TILE_M * DVec3::new(x as f64, y as f64, z as f64 - 0.25))
        .collect();
    // A cube's half diagonal is 0.87 of its edge; the rest is for distances that are too large.
    let near = |middle: DVec3, edge: f64| statue::distance(middle).abs() < 0.9 * edge + 0.02;
    let found: Vec<(DVec3, u32)> = tiles
        .par_iter()
        .filter(|tile| near(**tile + 0.5 * TILE_M, TILE_M))
        .flat_map_iter(|tile| {
            let cubes = (0..CUBES * CUBES * CUBES).map(|i| [i / CUBES % CUBES, i % CUBES, i / CUBES / CUBES]);
            cubes.map(|c| *tile + CUBE_M * DVec3::from_array(c.map(|c| c as f64)))
        })
        .filter(|corner| near(*corner + 0.5 * CUBE_M, CUBE_M))
        .filter_map(|corner| {
            let key = corner.to_array().iter().fold(0_u64, |key, c| key.rotate_left(21) ^ c.to_bits());
            let mut rng = Rng::new(2, key);
            let stay = (0..TRIALS).filter(|_| throw(corner, &mut rng).is_some()).count();
            (stay > 0).then_some((corner, stay as u32))
        })
        .collect();
    found.into_iter().unzip()
}

/// Lets a random point of a cube fall onto the surface. Returns where it lands and the normal there; `None` if it
/// leaves the cube or if too few photographs show the place.
fn throw(corner: DVec3, rng: &mut Rng) -> Option<(DVec3, DVec3)> {
    let mut p = corner + CUBE_M * DVec3::new(rng.unit(), rng.unit(), rng.unit());
    let shown = rng.unit();
    // Points that cannot stay anyway need not fall.
    if shown > statue::most_coverage(corner.z + CUBE_M) || statue::distance(p).abs() > CUBE_M {
        return None;
    }
    let slope = statue::gradient(p);
    for _ in 0..2 {
        p -= statue::distance(p) * slope / slope.length_squared().max(0.1);
    }
    let normal = statue::gradient(p).normalize_or(DVec3::Z);
    let inside = p.cmpge(corner).all() && p.cmplt(corner + CUBE_M).all();
    (inside && shown < statue::coverage(p, normal)).then_some((p, normal))
}

impl MeasuringDevice for Reconstruction {
    fn layout(&self) -> WrittenLayout {
        WrittenLayout {
            format: WrittenFormat::Rgb2,
            grid: Grid { scale: DVec3::splat(0.0001), offset: DVec3::ZERO },
        }
    }

    fn plan(&self) -> &LinePlan {
        &self.plan
    }

    fn measure(&self, line: u64, num_points: u64, rng: &mut Rng, out: &mut Vec<WrittenRecord>) {
        let corner = self.cubes[line as usize];
        let grid = self.layout().grid;
        let mut found = 0;
        // This ends, since points stayed in this cube when it was tried.
        while found < num_points {
            let Some((p, normal)) = throw(corner, rng) else { continue };
            found += 1;
            let bump = 0.003 * fractal(9.0 * p + DVec3::splat(50.0), 2);
            let wrong = if rng.unit() < OUTLIERS { rng.between(-0.02, 0.09) } else { 0.0 };
            let measured = p + (bump + wrong + NOISE_M * rng.normal()) * normal + 0.0005 * rng.direction();
            let color = statue::color(p, normal) * (1.0 + 0.03 * rng.normal());
            out.push(WrittenRecord {
                xyz: WrittenRecord::snap(&grid, measured),
                intensity: 0,
                return_number: 1,
                num_returns: 1,
                class: 0,
                forward: false,
                scan_angle_deg: 0.0,
                source: 0,
                gps_time: 0.0,
                rgb: color.to_array().map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u16),
            });
        }
    }
}
