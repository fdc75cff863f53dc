//! What the tree and the list promise, each promise as a checker, and each checker shown a tree that breaks it.

use super::*;
use crate::made_up::{motley, scan_of};
use base::space::Bounds;
use base::task::{CancelToken, Cancelled};
use glam::DVec3;
use proptest::prelude::*;

/// Numbers below `range`, the same for the same seed.
pub(super) fn noise(seed: u32) -> impl FnMut(i32) -> i32 {
    let mut state = seed;
    move |range| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as i32 % range
    }
}

pub(super) fn tree_of(scan: &Scan) -> PointTree {
    build_point_tree(scan, false, &Progress::hidden()).expect("a tree")
}

/// A wavy sheet, with a heap of duplicates and a stray.
fn sheet(num_points: usize, seed: u32) -> Scan {
    let mut noise = noise(seed);
    let mut xyz: Vec<[i32; 3]> = (0..num_points)
        .map(|_| {
            let (x, y) = (noise(20_000), noise(20_000));
            let wave = 2000.0 * (f64::from(x) / 3000.0).sin() * (f64::from(y) / 5000.0).cos();
            [x, y, wave as i32 + noise(20)]
        })
        .collect();
    xyz.extend([[7000, 7000, 7]; 9]);
    xyz.push([60_000, 100, 90_000]);
    scan_of(xyz, motley)
}

/// An angle so wide that holes are many where there is no overlap.
const WIDE_RAD: f64 = 0.5;

/// The numbers from a leaf up to the root.
pub(super) fn path(tree: &PointTree, leaf: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(leaf), |&number| tree.parent(number))
}

pub(super) fn leaves(tree: &PointTree) -> impl Iterator<Item = usize> {
    (0..tree.nodes.len()).filter(|&number| tree.nodes[number].num_points == 1)
}

/// Shapes by node; nodes without an entry are never drawn.
pub(super) fn shapes(tree: &PointTree, sequence: &Sequence) -> Vec<DiscShape> {
    let mut shapes = vec![DiscShape { min: 255, max: 0, diameter: 0 }; tree.nodes.len()];
    for (&node, &shape) in sequence.nodes.iter().zip(&sequence.shapes) {
        shapes[node as usize] = shape;
    }
    shapes
}

/// The least and the most nodes drawn on a path from a leaf to the root, if the tolerance of node n is `step(n)`.
fn drawn_on_paths(tree: &PointTree, shapes: &[DiscShape], step: impl Fn(usize) -> u8) -> (usize, usize) {
    let is_drawn: Vec<bool> = shapes.iter().enumerate().map(|(n, shape)| shape.is_drawn(step(n))).collect();
    let counts = leaves(tree).map(|leaf| path(tree, leaf).filter(|&n| is_drawn[n]).count());
    counts.fold((usize::MAX, 0), |(least, most), count| (least.min(count), most.max(count)))
}

/// Checks that every leaf's sphere lies in the spheres of all nodes above it.
fn check_spheres(tree: &PointTree) -> Result<(), String> {
    for leaf in leaves(tree) {
        for above in path(tree, leaf) {
            let reach = (tree.position(leaf) - tree.position(above)).length()
                + 0.5 * f64::from(tree.nodes[leaf].diameter);
            // The slack is for the rounding of f64 coordinates of millions.
            if reach > 0.5 * f64::from(tree.nodes[above].diameter) + 1e-8 {
                return Err(format!("leaf {leaf} sticks out of {above} by {reach}"));
            }
        }
    }
    Ok(())
}

/// Checks that positions and colors are the leaves' means, and that points are counted.
fn check_means(tree: &PointTree) -> Result<(), String> {
    let mut sums = vec![(0u32, DVec3::ZERO, [0u64; 3]); tree.nodes.len()];
    for leaf in leaves(tree) {
        for above in path(tree, leaf) {
            let (count, position, rgb) = &mut sums[above];
            *count += 1;
            *position += tree.position(leaf) - tree.bounds.min;
            for (channel, sum) in rgb.iter_mut().enumerate() {
                *sum += u64::from(tree.nodes[leaf].color >> (8 * channel) & 255);
            }
        }
    }
    for (number, (node, (count, position, rgb))) in tree.nodes.iter().zip(sums).enumerate() {
        let off = (position / f64::from(count) - (tree.position(number) - tree.bounds.min)).length();
        let wrong_color = (0..3).any(|channel| {
            let mean = rgb[channel] as f64 / f64::from(count);
            (f64::from(node.color >> (8 * channel) & 255) - mean).abs() > 0.5
        });
        // The bound is a step of rounding for the leaves, one for the mean, and the rounding of f64 coordinates of
        // millions.
        if count != node.num_points || off > 2.0 * tree.step + 1e-8 || wrong_color {
            return Err(format!("node {number}: {node:?} stands for {count} points, {off} away"));
        }
    }
    Ok(())
}

/// Checks that children stand before their parents and err no more.
fn check_errors(tree: &PointTree) -> Result<(), String> {
    for (number, node) in tree.nodes.iter().enumerate() {
        // Duplicates have no extent, and a disc over them is exact.
        let is_exact = node.num_points == 1 || node.diameter == 0.0;
        if is_exact != (node.error == 0.0) {
            return Err(format!("node {number}: an error of {} for {} points", node.error, node.num_points));
        }
        let Some(parent) = tree.parent(number) else { continue };
        let above = tree.nodes.get(parent).ok_or(format!("{number} has no parent"))?;
        if above.error < node.error || above.num_points <= node.num_points || above.error > above.diameter {
            return Err(format!("{number} {node:?} under {above:?}"));
        }
    }
    Ok(())
}

/// Checks that parts of a cluster are sorted, that none beyond a prefix is drawn at its step or a larger one, and that
/// each entry is in one part.
fn check_prefixes(sequence: &Sequence) -> Result<(), String> {
    let shapes = |part: &ListPart| &sequence.shapes[part.entries.clone()];
    let largest = |part: &ListPart| shapes(part).iter().map(|shape| sequence::octave(shape.max)).max();
    for parts in sequence.parts.chunk_by(|a, b| a.cluster == b.cluster) {
        for step in 0..255u8 {
            let reaches = |part: &ListPart| largest(part) >= Some(sequence::octave(step + 1));
            let prefix = parts.iter().take_while(|part| reaches(part)).count();
            let mut beyond = parts[prefix..].iter().flat_map(shapes);
            if let Some(shape) = beyond.find(|shape| (step..255).any(|step| shape.is_drawn(step))) {
                return Err(format!("{shape:?} is drawn from {step} on, beyond {prefix} parts"));
            }
        }
    }
    let mut entries: Vec<_> = sequence.parts.iter().map(|part| part.entries.clone()).collect();
    entries.sort_by_key(|entries| entries.start);
    let is_whole = entries.windows(2).all(|pair| pair[0].end == pair[1].start);
    let ends = entries.first().map(|e| e.start).zip(entries.last().map(|e| e.end));
    match is_whole && ends == Some((0, sequence.shapes.len())) {
        true => Ok(()),
        false => Err(format!("parts leave gaps: {entries:?}")),
    }
}

/// Checks that discs that are drawn at any nearness share no part with others that would have filled a workgroup, and
/// that parts with a cluster hold no discs of others.
fn check_parts(tree: &PointTree, sequence: &Sequence) -> Result<(), String> {
    for part in &sequence.parts {
        let shapes = &sequence.shapes[part.entries.clone()];
        let num_for_afar = shapes.iter().filter(|shape| shape.min > 0).count();
        if num_for_afar >= parts::MIN_APART && num_for_afar < shapes.len() {
            return Err(format!("{num_for_afar} of {} discs are read close up in vain", shapes.len()));
        }
        let is_of =
            |node: &u32| part.cluster == Some(clusters::cluster_of(tree.nodes[*node as usize].normal));
        if part.cluster.is_some() && !sequence.nodes[part.entries.clone()].iter().all(is_of) {
            return Err(format!("{part:?} holds discs of other clusters"));
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn trees_keep_their_promises(num_points in 1usize..3000, seed: u32) {
        let tree = tree_of(&sheet(num_points, seed));
        prop_assert_eq!(check_spheres(&tree), Ok(()));
        prop_assert_eq!(check_means(&tree), Ok(()));
        prop_assert_eq!(check_errors(&tree), Ok(()));
        prop_assert_eq!(leaves(&tree).count(), num_points + 10);
    }

    #[test]
    fn at_one_tolerance_exactly_one_disc_stands_for_each_point(num_points in 1usize..2000, seed: u32) {
        let tree = tree_of(&sheet(num_points, seed));
        let sequence = Sequence::new(&tree, 0.0);
        let shapes = shapes(&tree, &sequence);
        for step in 0..255 {
            prop_assert_eq!(drawn_on_paths(&tree, &shapes, |_| step), (1, 1), "step {}", step);
        }
        prop_assert_eq!(check_prefixes(&sequence), Ok(()));
    }

    /// From any place, with any angle that is allowed, every point has a disc.
    #[test]
    fn overlap_leaves_no_hole(
        num_points in 1usize..2000,
        seed: u32,
        eye in [-5.0f64..25.0, -5.0f64..25.0, -5.0f64..25.0],
        max_slope in prop::sample::select(vec![MAX_TOLERANCE_SLOPE, WIDE_RAD]),
        share in 0.01f64..=1.0,
    ) {
        let tree = tree_of(&sheet(num_points, seed));
        let sequence = Sequence::new(&tree, max_slope);
        let shapes = shapes(&tree, &sequence);
        let eye = tree.bounds.min + DVec3::from_array(eye);
        let step = |number: usize| {
            let tolerance = share * max_slope * (tree.position(number) - eye).length();
            sequence.scale.step_below(tolerance as f32)
        };
        prop_assert!(drawn_on_paths(&tree, &shapes, step).0 >= 1);
        prop_assert_eq!(check_prefixes(&sequence), Ok(()));
    }
}

/// Without overlap, distances that differ within a tree leave holes, so the test above can fail.
#[test]
fn without_overlap_there_are_holes() {
    let tree = tree_of(&sheet(2000, 5));
    let holes = |max_slope: f64| {
        let sequence = Sequence::new(&tree, max_slope);
        let shapes = shapes(&tree, &sequence);
        let has_hole = |i: &i32| {
            let eye = tree.bounds.min + DVec3::new(f64::from(*i) * 0.2 - 5.0, 3.0, 1.0);
            let tolerance = |n: usize| WIDE_RAD * (tree.position(n) - eye).length();
            drawn_on_paths(&tree, &shapes, |n| sequence.scale.step_below(tolerance(n) as f32)).0 == 0
        };
        (0..100).filter(has_hole).count()
    };
    assert!(holes(0.0) > 0);
    assert_eq!(holes(WIDE_RAD), 0);
}

#[test]
fn every_check_can_fail() {
    let tree = tree_of(&sheet(500, 3));
    let broken = |change: &dyn Fn(&mut PointTree)| {
        let mut broken = tree.clone();
        change(&mut broken);
        broken
    };
    let root = tree.nodes.len() - 1;
    let inner = (0..root).find(|&n| tree.nodes[n].num_points > 4).expect("an inner node");
    let leaf = leaves(&tree).next().expect("a leaf");
    assert!(check_spheres(&broken(&|t| t.nodes[root].diameter *= 0.9)).is_err());
    assert!(check_means(&broken(&|t| t.nodes[inner].color ^= 4)).is_err());
    assert!(check_means(&broken(&|t| t.nodes[inner].position[0] ^= 1 << 20)).is_err());
    assert!(check_means(&broken(&|t| t.nodes[inner].num_points += 1)).is_err());
    assert!(check_errors(&broken(&|t| t.nodes[inner].error = 1e3)).is_err());
    assert!(check_errors(&broken(&|t| t.nodes[leaf].error = 1e-3)).is_err());

    // A parent that errs less than its children is drawn beside them, and hides where it should not.
    let wrong = broken(&|t| t.nodes[root].error = 0.0);
    let sequence = Sequence::new(&wrong, 0.0);
    let most = (0..255).map(|step| drawn_on_paths(&wrong, &shapes(&wrong, &sequence), |_| step).1).max();
    assert_eq!(most, Some(2));

    let mut unsorted = Sequence::new(&tree, 0.0);
    unsorted.shapes.reverse();
    assert!(check_prefixes(&unsorted).is_err());
    let mut lost = Sequence::new(&tree, 0.0);
    lost.parts.pop();
    assert!(check_prefixes(&lost).is_err());
    let mut mixed = Sequence::new(&tree_of(&sheet(9000, 3)), 0.0);
    assert_eq!(check_parts(&tree_of(&sheet(9000, 3)), &mixed), Ok(()));
    mixed.parts = vec![ListPart { cluster: None, entries: 0..mixed.shapes.len() }];
    assert!(check_parts(&tree_of(&sheet(9000, 3)), &mixed).is_err());
}

/// A square grid of points a centimeter apart, on a plane that leans.
fn plane(color: impl Fn(usize) -> [u16; 3]) -> Scan {
    scan_of((0..64 * 64).map(|i| [i % 64 * 10, i / 64 * 10, i % 64 * 10]).collect(), color)
}

#[test]
fn a_plane_is_soon_drawn_by_few_large_discs() {
    let tree = tree_of(&plane(|_| [90; 3]));
    let normal = DVec3::new(-1.0, 0.0, 1.0).normalize();
    for (number, node) in tree.nodes.iter().enumerate() {
        let turned = normals::unpack(node.normal).dot(normal).abs();
        assert!(turned > 0.9999, "node {number}: {turned}");
        assert_eq!(node.spread, std::f32::consts::PI, "nobody knows its side");
    }
    let mut inner = tree.nodes.iter().filter(|n| n.num_points >= 64);
    // The only error of a plane is the rim of the disc.
    assert!(inner.all(|n| n.error < 0.45 * n.diameter), "flat: {:?}", tree.nodes.last());
    let mut leaves: Vec<f32> = leaves(&tree).map(|leaf| tree.nodes[leaf].diameter).collect();
    leaves.sort_by(f32::total_cmp);
    // The leaning axis has 1.41 cm between points, the other 1 cm: the fourth neighbor lies along the former, and at
    // the border further away.
    assert!((leaves[leaves.len() / 2] - 1.5 * 0.01414).abs() < 1e-4, "{}", leaves[leaves.len() / 2]);
    assert!(leaves[0] > 0.02 && leaves[leaves.len() - 1] < 0.031, "even");
}

/// A plane with two colors in stripes errs by its diameters until the stripes are averaged.
#[test]
fn colors_keep_discs_small() {
    let gray = tree_of(&plane(|_| [90; 3]));
    // Stripes four points wide: cubes of two are of one color, those of four points and more are not.
    let striped = tree_of(&plane(|i| if i / 4 % 2 == 0 { [60; 3] } else { [120; 3] }));
    let front = |tree: &PointTree, step_of: f32| {
        let sequence = Sequence::new(tree, 0.0);
        let step = sequence.scale.step_below(step_of);
        sequence.shapes.iter().filter(|shape| shape.is_drawn(step)).count()
    };
    let (few, many) = (front(&gray, 0.03), front(&striped, 0.03));
    assert!(many > 2 * few, "{many} discs with stripes, {few} without");
    let of_diameter = striped.nodes.iter().filter(|n| n.num_points > 1 && n.error == n.diameter).count();
    assert!(of_diameter > 0);
    assert!(gray.nodes.iter().all(|n| n.num_points == 1 || n.error < n.diameter));
}

/// Points on a sphere, with normals that point outwards if `with_normals`.
fn ball(num_points: usize, with_normals: bool) -> Scan {
    let direction = |i: usize| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / num_points as f64;
        let (sin, cos) = (2.399_963_229_728_653 * i as f64).sin_cos();
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cos, across * sin, z)
    };
    let directions: Vec<DVec3> = (0..num_points).map(direction).collect();
    let xyz = directions.iter().map(|d| (d * 5000.0).round().to_array().map(|v| v as i32)).collect();
    let mut scan = scan_of(xyz, motley);
    if with_normals {
        scan.files[0].points.normals = directions.iter().map(|d| d.as_vec3().to_array()).collect();
    }
    scan
}

#[test]
fn estimated_normals_are_those_of_the_surface() {
    let tree = tree_of(&ball(5000, false));
    let center = tree.bounds.center();
    assert_eq!(leaves(&tree).count(), 5000);
    for leaf in leaves(&tree) {
        let outward = (tree.position(leaf) - center).normalize();
        let cos = normals::unpack(tree.nodes[leaf].normal).dot(outward).abs();
        assert!(cos > 0.99, "leaf {leaf}: {cos}");
    }
}

#[test]
fn parts_are_culled_only_where_normals_have_sides() {
    let with_sides = |scan: &Scan| build_point_tree(scan, true, &Progress::hidden()).expect("a tree");
    for tree in [with_sides(&ball(5000, false)), tree_of(&ball(5000, true))] {
        let unknown = Sequence::new(&tree, 0.0);
        assert!(unknown.parts.iter().all(|part| part.cluster.is_none()), "unknown, or not wanted");
    }
    let tree = with_sides(&ball(100_000, true));
    let sequence = Sequence::new(&tree, MAX_TOLERANCE_SLOPE);
    assert_eq!((check_prefixes(&sequence), check_parts(&tree, &sequence)), (Ok(()), Ok(())));
    let num_clusters = sequence.parts.chunk_by(|a, b| a.cluster == b.cluster).count();
    assert_eq!(num_clusters, clusters::NUM_CLUSTERS + 1, "every direction, and what is left over");
    assert!(sequence.parts.last().is_some_and(|part| part.cluster.is_none()));
    let eye = tree.bounds.center() + DVec3::new(40.0, 30.0, 20.0);
    let (mut culled, mut all) = (0, 0);
    for part in &sequence.parts {
        let entries = sequence.nodes[part.entries.clone()].iter().map(|&node| node as usize);
        let bounds = entries.clone().fold(Bounds::EMPTY, |b, n| b.with(tree.position(n)));
        let away = part.cluster.is_some_and(|cluster| {
            let behind = clusters::cone_of(cluster).behind(f64::from(sequence::MAX_SPREAD));
            behind.is_some_and(|behind| behind.holds(&bounds, eye))
        });
        all += part.entries.len();
        if away {
            culled += part.entries.len();
            for leaf in entries.filter(|&n| tree.nodes[n].num_points == 1) {
                let outward = tree.position(leaf) - tree.bounds.center();
                assert!(outward.dot(tree.position(leaf) - eye) > 0.0, "leaf {leaf} is seen");
            }
        }
    }
    assert!(culled * 5 > all, "{culled} of {all}");
}

#[test]
fn the_smallest_clouds_have_trees() {
    for xyz in [vec![[1, 2, 3]], vec![[1, 2, 3]; 700], vec![[0, 0, 0], [9, 0, 0]]] {
        let (num_points, distinct) = (xyz.len(), xyz[0] != xyz[xyz.len() - 1]);
        let tree = tree_of(&scan_of(xyz, motley));
        assert_eq!(leaves(&tree).count(), num_points);
        assert_eq!((check_spheres(&tree), check_means(&tree), check_errors(&tree)), (Ok(()), Ok(()), Ok(())));
        let sequence = Sequence::new(&tree, MAX_TOLERANCE_SLOPE);
        assert!(sequence.shapes.iter().all(|shape| shape.min < shape.max), "others have no entry");
        let drawn = sequence.shapes.iter().filter(|shape| shape.is_drawn(0)).count();
        assert_eq!(drawn, if distinct { 2 } else { 1 }, "duplicates are one disc");
    }
}

#[test]
fn threads_change_nothing_and_a_stop_is_heard() {
    let scan = sheet(60_000, 11);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let (serial, parallel) = (one.install(|| tree_of(&scan)), tree_of(&scan));
    assert_eq!(serial.nodes, parallel.nodes);
    assert_eq!((check_spheres(&parallel), check_errors(&parallel)), (Ok(()), Ok(())));
    let stop = CancelToken::default();
    stop.cancel();
    let stopped = build_point_tree(&scan, false, &Progress::silent(&stop));
    assert_eq!(stopped.err(), Some(BuildError::Cancelled(Cancelled)));
}

#[test]
fn strays_are_no_larger_than_other_points() {
    let tree = tree_of(&sheet(3000, 2));
    let stray =
        leaves(&tree).max_by(|&a, &b| tree.position(a).z.total_cmp(&tree.position(b).z)).expect("one");
    assert!(tree.nodes[stray].diameter < 3.0, "{:?}", tree.nodes[stray]);
}
