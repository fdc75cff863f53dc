//! What files know of their points' surfaces: normals with a side, and the triangles of meshes [SPT §3.8].
//!
//! A triangle is drawn where its longest side is longer than the tolerance. There, discs of its corners are not
//! needed: the *onset* of a point is the longest side of the smallest triangle at it (0 if there is none), that of a
//! disc the least onset of the points below it, and a disc is drawn only where the tolerance has reached its onset.
//!
//! Nothing is lost: where a triangle is not drawn, the tolerance has reached its longest side, which no onset above
//! its corners exceeds, so that none of their discs is suppressed. Nor is much drawn twice: below a disc's onset all
//! triangles at all of its points are drawn. The tolerance differs from place to place, which `first_step` allows
//! for.

use super::neighbors::OVERLAP;
use super::steps::StepScale;
use super::tree::{Leaf, NO_SIDE, PointTree, rounded_up};
use super::{SortedPoints, normals};
use glam::{DVec3, Vec3};
use points::{Scan, ScanFile};

/// A disc at a corner reaches over the triangles there, up to this many times the longest side of the smallest one: a
/// wider disc would be many pixels large where that one has just vanished. Between the corners of longer triangles a
/// gap as wide as the allowed error may show, once they are as small as that.
const MAX_SIDE_RATIO: f32 = 2.0;

/// A triangle of a mesh, not degenerate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Numbers of the nodes of its corners, which are leaves; counter-clockwise where it is seen from.
    pub corners: [u32; 3],
    /// Its longest side, world units.
    pub side: f32,
}

/// A triangle as its file has it.
struct FileTriangle {
    /// Running numbers of points, as in [`super::Index`].
    corners: [u32; 3],
    /// Normal whose length is twice the triangle's area.
    normal: DVec3,
    /// Longest side, world units.
    side: f32,
}

/// Normals and sizes of the triangles at a point.
#[derive(Clone, Copy)]
struct MeshCorner {
    /// Sum of their normals, each as long as twice the area.
    normal: DVec3,
    /// Longest side of the smallest triangle, and of the largest.
    sides: [f32; 2],
}

/// True if the scan has triangles.
pub(super) fn is_mesh(scan: &Scan) -> bool {
    scan.files.iter().any(|file| !file.triangles.is_empty())
}

/// All triangles that are not degenerate.
fn faces(scan: &Scan) -> impl Iterator<Item = FileTriangle> + '_ {
    let firsts = scan.files.iter().scan(0, |next: &mut usize, file| {
        let first = *next;
        *next += file.points.xyz.len();
        Some(first as u32)
    });
    scan.files.iter().zip(firsts).flat_map(|(file, first)| {
        file.triangles.iter().filter_map(move |&corners| face(file, first, corners))
    })
}

/// A triangle of a file whose points begin with number `first`; `None` if its corners lie on a line, which the grid's
/// whole numbers tell exactly.
fn face(file: &ScanFile, first: u32, corners: [u32; 3]) -> Option<FileTriangle> {
    let xyz = |corner: u32| file.points.xyz.get(corner as usize).map(|p| p.map(i64::from));
    let (a, b, c) = (xyz(corners[0])?, xyz(corners[1])?, xyz(corners[2])?);
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    let turn = |i: usize, j: usize| i128::from(u[i]) * i128::from(v[j]) - i128::from(u[j]) * i128::from(v[i]);
    if [turn(1, 2), turn(2, 0), turn(0, 1)] == [0; 3] {
        return None;
    }
    let [u, v] = [u, v].map(|d| file.grid.scale * DVec3::from_array(d.map(|v| v as f64)));
    let side = u.length().max(v.length()).max((v - u).length());
    Some(FileTriangle { corners: corners.map(|c| first + c), normal: u.cross(v), side: rounded_up(side) })
}

/// Puts into the leaves what files know better than neighbors tell: normals, sides if `with_sides`, and how far
/// the triangles at a point reach.
pub(super) fn inform(leaves: &mut [Leaf], sorted: &SortedPoints, scan: &Scan, with_sides: bool) {
    let corners = corners(scan);
    for (leaf, key) in leaves.iter_mut().zip(&sorted.keys) {
        let corner = corners.get(key.1 as usize);
        let of_triangles = corner.map_or(DVec3::ZERO, |corner| corner.normal);
        let of_file = sorted.index.normal(key.1 as usize).and_then(direction);
        let known = of_file.or_else(|| of_triangles.try_normalize());
        if let Some(normal) = known {
            leaf.normal = normals::pack(normal);
            leaf.spread = if with_sides { 0.0 } else { NO_SIDE };
        }
        if let Some(&MeshCorner { sides: [shortest, longest], .. }) =
            corner.filter(|corner| corner.sides[1] > 0.0)
        {
            leaf.diameter = OVERLAP * longest.min(MAX_SIDE_RATIO * shortest);
        }
    }
}

/// The triangles at each point; empty if there is no triangle. Memory: 32 B a point.
fn corners(scan: &Scan) -> Vec<MeshCorner> {
    if !is_mesh(scan) {
        return Vec::new();
    }
    let nothing = MeshCorner { normal: DVec3::ZERO, sides: [f32::INFINITY, 0.0] };
    let mut corners = vec![nothing; scan.num_points()];
    for face in faces(scan) {
        for corner in face.corners {
            let MeshCorner { normal, sides: [shortest, longest] } = &mut corners[corner as usize];
            *normal += face.normal;
            (*shortest, *longest) = (shortest.min(face.side), longest.max(face.side));
        }
    }
    corners
}

/// The triangles between a tree's leaves, in the files' order. Memory: 4 B a point meanwhile, 16 B a triangle.
pub(super) fn triangles(scan: &Scan, sorted: &SortedPoints, tree: &PointTree) -> Vec<Triangle> {
    if !is_mesh(scan) {
        return Vec::new();
    }
    // Leaves stand in the tree as points do among the keys.
    let leaves = (0..).zip(&tree.nodes).filter(|(_, node)| node.num_points == 1);
    let mut node_of = vec![0; sorted.keys.len()];
    for (key, (node, _)) in sorted.keys.iter().zip(leaves) {
        node_of[key.1 as usize] = node;
    }
    let of_face =
        |face: FileTriangle| Triangle { corners: face.corners.map(|c| node_of[c as usize]), side: face.side };
    faces(scan).map(of_face).collect()
}

/// The onset of each node as a step, 0 for those with a point below that no triangle stands for; empty if there is no
/// triangle.
pub(super) fn onsets(tree: &PointTree, scale: &StepScale) -> Vec<u8> {
    if tree.triangles.is_empty() {
        return Vec::new();
    }
    let mut onsets = vec![u8::MAX; tree.nodes.len()];
    for triangle in &tree.triangles {
        let step = scale.step(triangle.side);
        for corner in triangle.corners {
            let onset = &mut onsets[corner as usize];
            *onset = step.min(*onset);
        }
    }
    for number in 0..tree.nodes.len() {
        if tree.nodes[number].num_points == 1 && onsets[number] == u8::MAX {
            onsets[number] = 0;
        }
        // Children come before their parents.
        if let Some(parent) = tree.parent(number) {
            onsets[parent] = onsets[parent].min(onsets[number]);
        }
    }
    onsets
}

/// The first step of tolerance at which a disc with an onset is drawn: that of the onset, less what the tolerance may
/// grow on the way from the disc's center to any of its points, which are within `radius`. It is one step less because
/// the GPU has corners and discs on different grids of cells.
pub(super) fn first_step(scale: &StepScale, onset: u8, radius: f64, max_slope: f64) -> u8 {
    let length = f64::from(scale.length(onset)) - max_slope * radius;
    scale.step_below(length.max(0.0) as f32).saturating_sub(1)
}

/// A file's normal at unit length; `None` if it has no direction, as NaN and 0 have none.
fn direction(normal: [f32; 3]) -> Option<DVec3> {
    Vec3::from_array(normal).as_dvec3().try_normalize()
}
