//! The tree of discs: down by bisection, up by averaging [SPT §3.1].

use super::cubes::CubeKeys;
use super::error::{self, Disc};
use super::mesh::Triangle;
use super::{SortedPoints, normals};
use crate::format::{BLUE_SHIFT, CHANNEL_MASK, GREEN_SHIFT, OPAQUE};
use base::space::Bounds;
use base::task::Progress;
use glam::DVec3;
use points::Scene;
use rayon::prelude::*;

/// Subtrees with at most this many points are built by one thread.
const PART_POINTS: usize = 1 << 14;
/// Grid steps along the longest edge of the cloud.
const GRID_STEPS: f64 = u32::MAX as f64;

/// Spread of a normal without a side, which may as well point the other way, radians.
pub(super) const NO_SIDE: f32 = std::f32::consts::PI;

/// Normal and diameter of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leaf {
    /// Normal, packed ([`normals::pack`]).
    pub normal: u32,
    /// Diameter of its disc, world units.
    pub diameter: f32,
    /// Spread of its normal: 0, or [`NO_SIDE`].
    pub spread: f32,
}

/// A node of the tree, drawn as a disc: a point, or the mean of several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointTreeNode {
    /// Mean of its points' positions, on the tree's grid; see [`PointTree::position`].
    pub position: [u32; 3],
    /// Mean of its points' normals, packed ([`normals::pack`]).
    pub normal: u32,
    /// Mean of its points' colors: r | g≪8 | b≪16 | 255≪24.
    pub color: u32,
    /// Diameter of the disc, and of a sphere round its center that holds the children's spheres, world units.
    pub diameter: f32,
    /// How far the disc is from what it stands for, world units: 0 for a point, else not less than any child's.
    pub error: f32,
    /// Upper bound of the angle between its normal and those of its points, radians; π if one of these has no side.
    pub spread: f32,
    /// Points that it stands for; 1 for a leaf.
    pub num_points: u32,
    /// Its parent's number less its own; 0 for the root.
    pub up: u32,
}

/// A tree of discs over all points of a scan.
#[derive(Clone, Debug)]
pub struct PointTree {
    /// Children before their parents, a subtree in one run, in Morton order; the root is the last.
    pub nodes: Vec<PointTreeNode>,
    /// True box of the points, world space.
    pub bounds: Bounds,
    /// The scan's scene.
    pub scene: Scene,
    /// A step of the grid that positions lie on, world units: the longest edge, cut into 2³² steps, which is finer than
    /// any batch's cells.
    pub step: f64,
    /// Triangles of meshes, without degenerate ones.
    pub triangles: Vec<Triangle>,
}

impl PointTree {
    /// Center of a node, world space.
    #[must_use]
    pub fn position(&self, number: usize) -> DVec3 {
        self.bounds.min + self.offset(&self.nodes[number])
    }

    /// Number of a node's parent; `None` for the root.
    #[must_use]
    pub fn parent(&self, number: usize) -> Option<usize> {
        match self.nodes[number].up {
            0 => None,
            up => Some(number + up as usize),
        }
    }

    /// Center of a node, relative to the box's smallest corner.
    fn offset(&self, node: &PointTreeNode) -> DVec3 {
        DVec3::from_array(node.position.map(f64::from)) * self.step
    }

    fn disc(&self, node: &PointTreeNode) -> Disc {
        let (center, normal) = (self.offset(node), normals::unpack(node.normal));
        Disc { center, normal, radius: 0.5 * f64::from(node.diameter) }
    }
}

/// Sums over the points of a subtree, which parents must know exactly.
#[derive(Clone, Copy, Debug, Default)]
struct SubtreeSums {
    /// Sum of positions, relative to the box's smallest corner.
    position: DVec3,
    rgb: [u64; 3],
}

/// A subtree whose place in the list is still open.
struct Subtree {
    nodes: Vec<PointTreeNode>,
    sums: SubtreeSums,
}

/// The tree over sorted points, at least one. The result is worthless if `progress` is cancelled.
pub(super) fn build(
    sorted: &SortedPoints,
    leaves: &[Leaf],
    bounds: Bounds,
    scene: Scene,
    progress: &Progress,
) -> PointTree {
    let step = bounds.size().max_element() / GRID_STEPS;
    // The scene is put in last, since each part begins as a copy of this tree.
    let tree = PointTree { nodes: Vec::new(), bounds, scene: Scene::default(), step, triangles: Vec::new() };
    let mut cubes = Vec::new();
    let root = CubeKeys::root(&sorted.keys);
    small_cubes(sorted, &root, &mut |cube| cubes.push(cube));
    let of_cube = |cube: &CubeKeys| {
        if progress.is_cancelled() {
            return Subtree { nodes: Vec::new(), sums: SubtreeSums::default() };
        }
        let mut builder =
            PointTreeBuilder { sorted, leaves, tree: PointTree { ..tree.clone() }, parts: None };
        let sums = builder.subtree(cube);
        progress.add(cube.keys.len() as u64);
        Subtree { nodes: builder.tree.nodes, sums }
    };
    let parts: Vec<Subtree> = cubes.par_iter().map(of_cube).collect();
    if progress.is_cancelled() {
        return tree;
    }
    let num_nodes = parts.iter().map(|part| part.nodes.len() + 1).sum();
    let nodes = Vec::with_capacity(num_nodes);
    let tree = PointTree { nodes, scene, ..tree };
    let mut builder = PointTreeBuilder { sorted, leaves, tree, parts: Some(parts.into_iter()) };
    builder.subtree(&root);
    builder.tree
}

/// The largest subtrees of at most [`PART_POINTS`], in order; larger ones only if nothing divides their points.
fn small_cubes(sorted: &SortedPoints, cube: &CubeKeys, each: &mut dyn FnMut(CubeKeys)) {
    let octants = if cube.keys.len() <= PART_POINTS { Vec::new() } else { cube.octants(&sorted.keys) };
    if octants.is_empty() {
        return each(cube.clone());
    }
    octants.iter().for_each(|octant| small_cubes(sorted, octant, each));
}

/// Rounds up to f32, so that a sphere still holds all that it held.
pub(super) fn rounded_up(length: f64) -> f32 {
    let rounded = length as f32;
    if f64::from(rounded) < length { rounded.next_up() } else { rounded }
}

struct PointTreeBuilder<'a> {
    sorted: &'a SortedPoints<'a>,
    leaves: &'a [Leaf],
    tree: PointTree,
    /// The small subtrees, if these are built already.
    parts: Option<std::vec::IntoIter<Subtree>>,
}

impl PointTreeBuilder<'_> {
    /// Appends the nodes of a subtree, its root last.
    fn subtree(&mut self, cube: &CubeKeys) -> SubtreeSums {
        let keys = &self.sorted.keys;
        let octants = cube.octants(keys);
        if (cube.keys.len() <= PART_POINTS || octants.is_empty())
            && let Some(parts) = &mut self.parts
        {
            // There are as many parts as `small_cubes` found cubes, in its order.
            let part = parts.next().unwrap_or(Subtree { nodes: Vec::new(), sums: SubtreeSums::default() });
            self.tree.nodes.extend_from_slice(&part.nodes);
            return part.sums;
        }
        if cube.keys.len() == 1 {
            return self.leaf(cube.keys.start);
        }
        let mut sums = SubtreeSums::default();
        let mut children = Vec::with_capacity(8);
        let mut add = |builder: &mut Self, of_child: SubtreeSums| {
            children.push(builder.tree.nodes.len() - 1);
            sums.position += of_child.position;
            sums.rgb = std::array::from_fn(|c| sums.rgb[c] + of_child.rgb[c]);
        };
        for octant in &octants {
            let of_child = self.subtree(octant);
            add(self, of_child);
        }
        if octants.is_empty() {
            // Points that no code tells apart are all children of one node.
            for key in cube.keys.clone() {
                let of_child = self.leaf(key);
                add(self, of_child);
            }
        }
        self.inner(&children, &sums, cube.keys.len());
        sums
    }

    fn leaf(&mut self, key: usize) -> SubtreeSums {
        let (p_in_world, color) = self.sorted.index.point(self.sorted.keys[key].1 as usize);
        let Leaf { normal, diameter, spread } = self.leaves[key];
        let offset = p_in_world - self.tree.bounds.min;
        let position = self.on_grid(offset);
        let node =
            PointTreeNode { position, normal, color, diameter, error: 0.0, spread, num_points: 1, up: 0 };
        self.tree.nodes.push(node);
        SubtreeSums {
            position: offset,
            rgb: [0, GREEN_SHIFT, BLUE_SHIFT].map(|shift| u64::from(color >> shift & CHANNEL_MASK)),
        }
    }

    /// Appends the node that stands for these children.
    fn inner(&mut self, children: &[usize], sums: &SubtreeSums, num_points: usize) {
        let position = self.on_grid(sums.position / num_points as f64);
        let (normal, spread) = self.mean_normal(children);
        let count = num_points as u64;
        let [r, g, b] = sums.rgb.map(|sum| ((sum + count / 2) / count) as u32);
        let color = r | g << GREEN_SHIFT | b << BLUE_SHIFT | OPAQUE;
        let node = PointTreeNode {
            position,
            normal: normals::pack(normal),
            color,
            diameter: 0.0,
            error: 0.0,
            spread,
            num_points: num_points as u32,
            up: 0,
        };
        let tree = &self.tree;
        let discs: Vec<Disc> = children.iter().map(|&child| tree.disc(&tree.nodes[child])).collect();
        let mut disc = tree.disc(&node);
        disc.radius = error::bounding_radius(disc.center, &discs);
        let colors = children.iter().map(|&child| tree.nodes[child].color);
        let own = if error::is_colorful(color, colors) {
            2.0 * disc.radius
        } else {
            error::geometric(&disc, &discs)
        };
        let below = children.iter().map(|&child| tree.nodes[child].error).fold(0.0, f32::max);
        let diameter = rounded_up(2.0 * disc.radius);
        let node = PointTreeNode { diameter, error: (own as f32).max(below), ..node };
        let number = self.tree.nodes.len();
        self.tree.nodes.push(node);
        for &child in children {
            self.tree.nodes[child].up = (number - child) as u32;
        }
    }

    /// Mean of the children's normals, each counted by its points, and the largest angle to any point's. Normals
    /// without a side are first turned into the hemisphere of those before them.
    fn mean_normal(&self, children: &[usize]) -> (DVec3, f32) {
        let turned = |normal: DVec3, node: &PointTreeNode, to: DVec3| {
            if node.spread < NO_SIDE || normal.dot(to) >= 0.0 { normal } else { -normal }
        };
        let of_children = || {
            children.iter().map(|&child| {
                let node = &self.tree.nodes[child];
                (normals::unpack(node.normal), node)
            })
        };
        let mut sum = DVec3::ZERO;
        for (normal, node) in of_children() {
            sum += f64::from(node.num_points) * turned(normal, node, sum);
        }
        let Some(mean) = sum.try_normalize() else {
            // The normals cancel out: no direction is better than another, and no side is known.
            return (DVec3::Z, NO_SIDE);
        };
        let angle = |(normal, node): (DVec3, &PointTreeNode)| {
            let cos = turned(normal, node, mean).dot(mean).clamp(-1.0, 1.0);
            (libm::acos(cos) as f32 + node.spread).min(NO_SIDE)
        };
        (mean, of_children().map(angle).fold(0.0, f32::max))
    }

    fn on_grid(&self, offset: DVec3) -> [u32; 3] {
        // Casts from float saturate; a tree without extent has one position.
        let axis = |v: f64| if self.tree.step > 0.0 { (v / self.tree.step).round() as u32 } else { 0 };
        offset.to_array().map(axis)
    }
}
