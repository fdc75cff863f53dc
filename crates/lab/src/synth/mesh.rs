//! The statue's surface as triangles: where its distance function changes sign in a grid of cubes.
//!
//! A cube is six tetrahedra round its diagonal (Kuhn's division). They fit those of the next cube, and the surface in a
//! tetrahedron is one triangle or two, so the mesh has neither holes nor edges of more than two triangles. A vertex
//! lies on an edge of tetrahedra, which is named by its corner of the grid and one of seven directions.

use super::statue;
use base::random::Rng;
use base::task::{Cancelled, Progress};
use glam::{DVec3, IVec3};
use rayon::prelude::*;

/// Smallest corner of the grid, except for a shift by less than a cube. The grid's bottom cuts the ground open.
const START: DVec3 = DVec3::new(-3.6, -3.6, -0.3);
/// Least size of the grid.
const SIZE: DVec3 = DVec3::new(7.2, 7.2, 3.7);
/// Vertices × (edge of a cube)², in m²: about four vertices per cube of the flat ground, and those of what stands on
/// it.
const VERTICES_M2: f64 = 226.0;
/// Largest edge of a cube; larger cubes would miss the statue's arms.
const COARSEST_M: f64 = 0.1;
/// Cubes along the edge of a block. A block is a task of its own, and only blocks near the surface are looked into.
const BLOCK: u32 = 16;
/// Corners along a block's edge.
const CORNERS: u32 = BLOCK + 1;
/// Corners of a cube's tetrahedra, a bit per axis: each leads from the first corner to the opposite one, an axis at a
/// time.
const TETRAHEDRA: [[u32; 4]; 6] =
    [[0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 6, 7]];

/// A point of the surface.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Position in world space.
    pub p: DVec3,
    /// Normal of unit length, outwards.
    pub normal: DVec3,
    /// Display color, 0 to 255.
    pub rgb: [u8; 3],
}

/// Triangles, counter-clockwise from outside.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The vertices, each once.
    pub vertices: Vec<Vertex>,
    /// Numbers of each triangle's vertices.
    pub triangles: Vec<[u32; 3]>,
}

/// The surface with about `points` vertices, at least some 20 000; another seed lays the grid elsewhere.
///
/// # Errors
/// If the user asked to stop.
pub fn of_statue(points: u64, seed: u64, progress: &Progress) -> Result<Mesh, Cancelled> {
    let grid = CubeGrid::new(points, seed);
    let corners: Vec<[u64; 3]> =
        grid.blocks(progress).into_par_iter().flat_map_iter(|block| grid.cut(block, progress)).collect();
    let mut keys: Vec<u64> = corners.par_iter().copied().flatten_iter().collect();
    keys.par_sort_unstable();
    keys.dedup();
    let number = |key: u64| keys.binary_search(&key).map_or(0, |found| found as u32);
    let triangles = corners.par_iter().map(|keys| keys.map(number)).collect();
    let vertex = |&key: &u64| {
        progress.add(1);
        progress.check().map(|()| grid.vertex(key))
    };
    let vertices = keys.par_iter().map(vertex).collect::<Result<Vec<Vertex>, Cancelled>>()?;
    progress.check().map(|()| Mesh { vertices, triangles })
}

/// Cubes round the statue.
struct CubeGrid {
    start: DVec3,
    edge: f64,
}

impl CubeGrid {
    fn new(points: u64, seed: u64) -> Self {
        let edge = (VERTICES_M2 / points.max(1) as f64).sqrt().min(COARSEST_M);
        let mut rng = Rng::new(seed, 0);
        let shift = DVec3::new(rng.unit(), rng.unit(), rng.unit());
        Self { start: START - edge * shift, edge }
    }

    fn corner(&self, at: [u32; 3]) -> DVec3 {
        self.start + self.edge * DVec3::from_array(at.map(f64::from))
    }

    /// First corners of the blocks that may hold surface.
    fn blocks(&self, progress: &Progress) -> Vec<[u32; 3]> {
        let block_edge = self.edge * f64::from(BLOCK);
        // One block more than the size needs makes room for the shift.
        let [nx, ny, nz] = (SIZE / block_edge).ceil().as_uvec3().to_array().map(|n| n + 1);
        let all = (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
        let all: Vec<[u32; 3]> = all.map(|block| block.map(|at| at * BLOCK)).collect();
        // A block's half diagonal is 0.87 of its edge; the rest is for distances that are too large.
        let near = |block: &[u32; 3]| {
            statue::distance(self.corner(*block) + 0.5 * block_edge).abs() < 1.5 * block_edge + 0.02
        };
        all.into_par_iter().filter(|block| !progress.is_cancelled() && near(block)).collect()
    }

    /// The triangles in a block, each of three vertices' keys.
    fn cut(&self, first: [u32; 3], progress: &Progress) -> Vec<[u64; 3]> {
        if progress.is_cancelled() {
            return Vec::new();
        }
        let place = |x, y, z| self.corner([first[0] + x, first[1] + y, first[2] + z]);
        let inside: Vec<bool> = (0..CORNERS.pow(3))
            .map(|i| statue::distance(place(i % CORNERS, i / CORNERS % CORNERS, i / CORNERS.pow(2))) < 0.0)
            .collect();
        let mut triangles = Vec::new();
        for cube in 0..BLOCK.pow(3) {
            let at = [cube % BLOCK, cube / BLOCK % BLOCK, cube / BLOCK.pow(2)];
            let inside_at = |corner: u32| {
                let [x, y, z] = [0, 1, 2].map(|axis| at[axis] + (corner >> axis & 1));
                inside[((z * CORNERS + y) * CORNERS + x) as usize]
            };
            let is_inside: [bool; 8] = [0, 1, 2, 3, 4, 5, 6, 7].map(inside_at);
            if is_inside.iter().any(|&inside| inside != is_inside[0]) {
                let cube = [0, 1, 2].map(|axis| first[axis] + at[axis]);
                TETRAHEDRA
                    .iter()
                    .for_each(|corners| cut_tetrahedron(cube, *corners, is_inside, &mut triangles));
            }
        }
        triangles
    }

    /// The vertex where the surface crosses an edge.
    fn vertex(&self, key: u64) -> Vertex {
        let (corner, direction) = ends(key);
        let (a, b) =
            (self.corner(corner), self.corner([0, 1, 2].map(|axis| corner[axis] + (direction >> axis & 1))));
        let (da, db) = (statue::distance(a), statue::distance(b));
        // The vertex keeps off the ends, where triangles would lose their area. The signs of the distances differ.
        let p = a + (b - a) * (da / (da - db)).clamp(0.02, 0.98);
        let normal = statue::gradient(p).normalize_or(DVec3::Z);
        let rgb = statue::color(p, normal).to_array().map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8);
        Vertex { p, normal, rgb }
    }
}

/// Appends the surface in a tetrahedron, which parts the corners inside from those outside.
fn cut_tetrahedron(cube: [u32; 3], corners: [u32; 4], is_inside: [bool; 8], out: &mut Vec<[u64; 3]>) {
    let (inside, outside): (Vec<u32>, Vec<u32>) =
        corners.into_iter().partition(|&corner| is_inside[corner as usize]);
    let edges = match (&inside[..], &outside[..]) {
        (&[a], &[b, c, d]) => vec![[a, b], [a, c], [a, d]],
        (&[a, b, c], &[d]) => vec![[a, d], [b, d], [c, d]],
        (&[a, b], &[c, d]) => vec![[a, c], [a, d], [b, d], [b, c]],
        _ => return,
    };
    let place = |corner: u32| IVec3::new(corner as i32 & 1, corner as i32 >> 1 & 1, corner as i32 >> 2);
    let sum = |corners: &[u32]| corners.iter().map(|&corner| place(corner)).sum::<IVec3>();
    // Vector from the middle of the corners inside to the middle of those outside, times both counts.
    let outwards = sum(&outside) * inside.len() as i32 - sum(&inside) * outside.len() as i32;
    let middles: Vec<IVec3> = edges.iter().map(|edge| sum(edge)).collect();
    let faces_out = (middles[1] - middles[0]).cross(middles[2] - middles[0]).dot(outwards) > 0;
    let keys: Vec<u64> = edges.iter().map(|[a, b]| key(cube, a & b, a ^ b)).collect();
    for i in 2..keys.len() {
        out.push(if faces_out { [keys[0], keys[i - 1], keys[i]] } else { [keys[0], keys[i], keys[i - 1]] });
    }
}

/// Key of an edge: 20 bits for each coordinate of its first corner, 3 for the direction. The first of two corners of a
/// tetrahedron has no bit that the other lacks.
fn key(cube: [u32; 3], corner: u32, direction: u32) -> u64 {
    let at = [0, 1, 2].map(|axis| u64::from(cube[axis] + (corner >> axis & 1)));
    u64::from(direction) << 60 | at[2] << 40 | at[1] << 20 | at[0]
}

/// First corner and direction of an edge.
fn ends(key: u64) -> ([u32; 3], u32) {
    ([0, 20, 40].map(|shift| (key >> shift) as u32 & 0xf_ffff), (key >> 60) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    /// How often each edge is passed from its first to its second corner.
    fn edges(triangles: &[[u32; 3]]) -> HashMap<[u32; 2], u32> {
        let mut edges = HashMap::new();
        for &[a, b, c] in triangles {
            for edge in [[a, b], [b, c], [c, a]] {
                *edges.entry(edge).or_default() += 1;
            }
        }
        edges
    }

    /// Counts edges that are passed twice in one direction, or that nothing lies beside although they are not at the
    /// bottom.
    fn faults(mesh: &Mesh) -> usize {
        let edges = edges(&mesh.triangles);
        let lowest = mesh.vertices.iter().map(|vertex| vertex.p.z).fold(f64::MAX, f64::min);
        let at_bottom = |i: u32| mesh.vertices[i as usize].p.z == lowest;
        let alone = |[a, b]: [u32; 2]| !(edges.contains_key(&[b, a]) || at_bottom(a) && at_bottom(b));
        edges.iter().filter(|(edge, count)| **count != 1 || alone(**edge)).count()
    }

    #[test]
    fn the_mesh_is_closed_and_faces_outwards() {
        let mesh = of_statue(30_000, 1, &Progress::hidden()).unwrap();
        assert!((27_000..33_000).contains(&mesh.vertices.len()), "{} vertices", mesh.vertices.len());
        assert_eq!(faults(&mesh), 0);
        let mut num_against = 0;
        for corners in &mesh.triangles {
            let [a, b, c] = corners.map(|i| mesh.vertices[i as usize]);
            let across = (b.p - a.p).cross(c.p - a.p);
            assert!(across.length() > 0.0);
            num_against += usize::from(across.dot(a.normal + b.normal + c.normal) <= 0.0);
        }
        // A triangle may stand across the surface where the statue is finer than the grid.
        assert!(num_against * 100 < mesh.triangles.len(), "{num_against} of {}", mesh.triangles.len());
    }

    #[test]
    fn a_hole_and_a_turned_triangle_are_faults() {
        let mut mesh = of_statue(1, 1, &Progress::hidden()).unwrap();
        let middle = mesh.triangles.len() / 2;
        mesh.triangles[middle].reverse();
        assert!(faults(&mesh) >= 3);
        mesh.triangles.swap_remove(middle);
        assert!(faults(&mesh) >= 3);
    }

    #[test]
    fn keys_name_edges() {
        assert_eq!(ends(key([5, 6, 7], 0b010, 0b101)), ([5, 7, 7], 0b101));
        let grid = CubeGrid::new(u64::from(u32::MAX), 1);
        assert!(SIZE.max_element() / grid.edge < f64::from(1 << 20));
    }
}
