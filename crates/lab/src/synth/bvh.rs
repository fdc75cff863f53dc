//! A bounding volume hierarchy: shapes in a tree of boxes, so that a ray is tested against few of them.

use super::shape::Shape;
use super::span::{Hit, Ray};
use base::space::Bounds;
use glam::DVec3;

/// Shapes in a leaf at most, if boxes can tell them apart.
const LEAF_SHAPES: usize = 4;

/// A tree of boxes; the children of a node are nodes `first` and `first + 1`.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<BvhNode>,
    shapes: Vec<Shape>,
    /// Number of each of `shapes` in the caller's list.
    order: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct BvhNode {
    bounds: Bounds,
    /// First shape of a leaf, first child otherwise.
    first: u32,
    /// Shapes of a leaf; 0 for inner nodes.
    num_shapes: u32,
}

impl Bvh {
    /// Builds the tree; the same for the same shapes.
    pub fn new(shapes: &[Shape]) -> Self {
        let bounds: Vec<Bounds> = shapes.iter().map(Shape::bounds).collect();
        let mut order: Vec<u32> = (0..shapes.len() as u32).collect();
        let mut nodes = vec![BvhNode { bounds: Bounds::EMPTY, first: 0, num_shapes: 0 }];
        let mut open = vec![(0, 0, shapes.len())];
        while let Some((node, first, end)) = open.pop() {
            let part = &mut order[first..end];
            let around = part.iter().fold(Bounds::EMPTY, |b, &i| b.union(bounds[i as usize]));
            let cut = if part.len() > LEAF_SHAPES { split(part, &bounds) } else { None };
            let Some(cut) = cut else {
                let num_shapes = (end - first) as u32;
                nodes[node] = BvhNode { bounds: around, first: first as u32, num_shapes };
                continue;
            };
            let child = nodes.len();
            nodes[node] = BvhNode { bounds: around, first: child as u32, num_shapes: 0 };
            nodes.resize(child + 2, nodes[node]);
            open.push((child, first, first + cut));
            open.push((child + 1, first + cut, end));
        }
        Self { nodes, shapes: order.iter().map(|&i| shapes[i as usize]).collect(), order }
    }

    /// The nearest surface within `reach`, and which of the shapes has it.
    pub fn nearest(&self, ray: &Ray, reach: f64) -> Option<(Hit, usize)> {
        let mut best: Option<(Hit, usize)> = None;
        self.walk(ray, reach, |shape, limit| {
            let hit = self.shapes[shape].intersect(ray).filter(|hit| hit.t < limit)?;
            best = Some((hit, self.order[shape] as usize));
            Some(hit.t)
        });
        best
    }

    /// True if something lies within `reach`.
    pub fn blocked(&self, ray: &Ray, reach: f64) -> bool {
        let mut blocked = false;
        self.walk(ray, reach, |shape, limit| {
            let hit = self.shapes[shape].intersect(ray).filter(|hit| hit.t < limit)?;
            blocked = true;
            // Nothing lies nearer than this limit, so the walk ends.
            Some(hit.t.min(f64::NEG_INFINITY))
        });
        blocked
    }

    /// True if `p` is inside a solid.
    pub fn contains(&self, p: DVec3) -> bool {
        let mut open = vec![0];
        while let Some(node) = open.pop() {
            let node = &self.nodes[node as usize];
            if p.cmplt(node.bounds.min).any() || p.cmpgt(node.bounds.max).any() {
                continue;
            }
            if node.num_shapes == 0 {
                open.extend([node.first, node.first + 1]);
            }
            let shapes = node.first as usize..(node.first + node.num_shapes) as usize;
            if node.num_shapes > 0 && self.shapes[shapes].iter().any(|s| s.contains(p)) {
                return true;
            }
        }
        false
    }

    /// Visits the shapes whose boxes the ray meets before its limit, nearer boxes first; `visit` may lower
    /// the limit.
    fn walk(&self, ray: &Ray, reach: f64, mut visit: impl FnMut(usize, f64) -> Option<f64>) {
        let inverse = ray.direction.recip();
        let mut limit = reach;
        // The stack suffices: a tree as deep as this would hold more shapes than memory does.
        let mut open = [(0_u32, 0.0_f64); 64];
        let mut num_open = 1;
        while num_open > 0 {
            num_open -= 1;
            let (node, enter) = open[num_open];
            if enter > limit {
                continue;
            }
            let node = self.nodes[node as usize];
            for shape in node.first..node.first + node.num_shapes {
                limit = visit(shape as usize, limit).unwrap_or(limit);
            }
            if node.num_shapes > 0 {
                continue;
            }
            let enter = [node.first, node.first + 1]
                .map(|i| (i, entry(&self.nodes[i as usize].bounds, ray.origin, inverse)));
            let [near, far] = if enter[0].1 <= enter[1].1 { enter } else { [enter[1], enter[0]] };
            for child in [far, near] {
                if child.1 <= limit && num_open < open.len() {
                    open[num_open] = child;
                    num_open += 1;
                }
            }
        }
    }
}

/// Distance at which a ray enters a box: 0 if it starts inside, infinity if it misses.
fn entry(bounds: &Bounds, origin: DVec3, inverse: DVec3) -> f64 {
    let (a, b) = ((bounds.min - origin) * inverse, (bounds.max - origin) * inverse);
    // f64::min and max drop the NaN of 0 · ∞: a ray in a box's face counts as inside on that axis.
    let near = a.x.min(b.x).max(a.y.min(b.y)).max(a.z.min(b.z)).max(0.0);
    let far = a.x.max(b.x).min(a.y.max(b.y)).min(a.z.max(b.z));
    if near <= far { near } else { f64::INFINITY }
}

/// Sorts `part` along the best axis and returns where to cut it: where the two halves' surfaces, weighed by their
/// numbers of shapes, are smallest. `None` if no cut is better than no cut.
fn split(part: &mut [u32], bounds: &[Bounds]) -> Option<usize> {
    let area = |b: &Bounds| {
        let s = b.size();
        s.x * s.y + s.y * s.z + s.z * s.x
    };
    let sort = |part: &mut [u32], axis: usize| {
        let middle = |i: u32| bounds[i as usize].min[axis] + bounds[i as usize].max[axis];
        part.sort_unstable_by(|&a, &b| middle(a).total_cmp(&middle(b)).then(a.cmp(&b)));
    };
    let whole = part.iter().fold(Bounds::EMPTY, |b, &i| b.union(bounds[i as usize]));
    let mut best = (area(&whole) * part.len() as f64, 0, 0);
    let mut after = vec![0.0; part.len()];
    for axis in 0..3 {
        sort(part, axis);
        let mut rest = Bounds::EMPTY;
        for (k, &i) in part.iter().enumerate().rev() {
            rest = rest.union(bounds[i as usize]);
            after[k] = area(&rest) * (part.len() - k) as f64;
        }
        let mut before = Bounds::EMPTY;
        for k in 1..part.len() {
            before = before.union(bounds[part[k - 1] as usize]);
            let cost = area(&before) * k as f64 + after[k];
            if cost < best.0 {
                best = (cost, axis, k);
            }
        }
    }
    let (_, axis, cut) = best;
    sort(part, axis);
    (cut > 0).then_some(cut)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::random::Rng;

    fn crowd(rng: &mut Rng) -> Vec<Shape> {
        let shape = |i: usize, rng: &mut Rng| {
            let center = 5.0 * rng.unit() * rng.direction();
            let radius = rng.between(0.05, 0.4);
            match i % 3 {
                0 => Shape::Ball { center, radius },
                1 => Shape::Cuboid { min: center - radius, max: center + radius },
                _ => Shape::Disc { center, normal: rng.direction(), radius },
            }
        };
        (0..600).map(|i| shape(i, rng)).collect()
    }

    #[test]
    fn the_tree_finds_what_looking_at_every_shape_finds() {
        let mut rng = Rng::new(21, 0);
        let shapes = crowd(&mut rng);
        let bvh = Bvh::new(&shapes);
        let (mut num_hits, mut num_inside) = (0, 0);
        for i in 0..4000 {
            // Every other ray runs along an axis, where its inverse direction has infinities.
            let direction = if i % 2 == 0 { rng.direction() } else { DVec3::AXES[i / 2 % 3] };
            let ray = Ray { origin: 6.0 * rng.unit() * rng.direction(), direction };
            let reach = rng.between(1.0, 12.0);
            let all = shapes.iter().enumerate().filter_map(|(i, s)| Some((s.intersect(&ray)?, i)));
            let nearest = all.filter(|(hit, _)| hit.t < reach).min_by(|a, b| a.0.t.total_cmp(&b.0.t));
            assert_eq!(bvh.nearest(&ray, reach), nearest);
            assert_eq!(bvh.blocked(&ray, reach), nearest.is_some());
            let inside = shapes.iter().any(|s| s.contains(ray.origin));
            assert_eq!(bvh.contains(ray.origin), inside);
            num_hits += usize::from(nearest.is_some());
            num_inside += usize::from(inside);
        }
        assert!((1000..3900).contains(&num_hits) && num_inside > 50, "{num_hits} {num_inside}");
    }
}
