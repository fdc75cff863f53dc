//! What is promised of meshes: no place is lost between triangles and discs, and what files know is used.

use super::meshlets::meshlets;
use super::tests::{leaves, noise, path, shapes, tree_of};
use super::*;
use crate::made_up::{motley, scan_of};
use glam::DVec3;
use proptest::prelude::*;

/// A sheet of triangles, coarse at one side and fine at the other; some triangles between any of its points; some
/// degenerate ones; last, points of no triangle.
fn mesh(edge: i32, num_loose: usize, seed: u32) -> Scan {
    let mut noise = noise(seed);
    let at = |i: i32| i * i * 60;
    let mut xyz = Vec::new();
    for i in 0..edge * edge {
        let (x, y) = (i % edge, i / edge);
        xyz.push([at(x) + noise(20), at(y) + noise(20), noise(200)]);
    }
    xyz.extend((0..num_loose).map(|_| [noise(9000), noise(9000), noise(900)]));
    let corner = |x: i32, y: i32| (y * edge + x) as u32;
    let mut triangles = Vec::new();
    for (x, y) in (0..edge - 1).flat_map(|y| (0..edge - 1).map(move |x| (x, y))) {
        triangles.push([corner(x, y), corner(x + 1, y), corner(x + 1, y + 1)]);
        triangles.push([corner(x, y), corner(x + 1, y + 1), corner(x, y + 1)]);
    }
    let mut any = || noise(edge * edge) as u32;
    triangles.extend((0..edge).map(|_| [any(), any(), any()]));
    triangles.extend([[0, 0, 1], [2, 2, 2]]);
    let mut scan = scan_of(xyz, motley);
    scan.files[0].triangles = triangles;
    scan
}

/// Tells of each triangle whether it is drawn, where `tolerance` gives a node's tolerance.
fn are_drawn(tree: &PointTree, scale: &StepScale, tolerance: &dyn Fn(usize) -> f32) -> Vec<bool> {
    let is_drawn = |triangle: &Triangle| {
        let nearest = triangle.corners.map(|corner| tolerance(corner as usize)).into_iter().reduce(f32::min);
        scale.step_below(nearest.unwrap_or(0.0)) < scale.step(triangle.side)
    };
    tree.triangles.iter().map(is_drawn).collect()
}

/// Number of lost leaves: corners of triangles that are not drawn, and points of no triangle, that have no drawn disc
/// either.
fn num_lost(
    tree: &PointTree,
    sequence: &Sequence,
    shapes: &[DiscShape],
    tolerance: &dyn Fn(usize) -> f32,
) -> usize {
    let is_chosen = |node: usize| shapes[node].is_drawn(sequence.scale.step_below(tolerance(node)));
    let is_lost = |leaf: usize| !path(tree, leaf).any(is_chosen);
    let drawn = are_drawn(tree, &sequence.scale, tolerance);
    let missing = tree.triangles.iter().zip(&drawn).filter(|(_, drawn)| !**drawn);
    let mut needed: Vec<usize> = missing.flat_map(|(t, _)| t.corners.map(|c| c as usize)).collect();
    let mut has_triangle = vec![false; tree.nodes.len()];
    tree.triangles.iter().for_each(|t| t.corners.iter().for_each(|&c| has_triangle[c as usize] = true));
    needed.extend(leaves(tree).filter(|&leaf| !has_triangle[leaf]));
    needed.into_iter().filter(|&leaf| is_lost(leaf)).count()
}

/// The tolerance that an eye has at a node.
fn from_eye<'a>(tree: &'a PointTree, eye: DVec3, angle: f64) -> impl Fn(usize) -> f32 + 'a {
    let eye = tree.bounds.min + eye;
    move |node| (angle * (tree.position(node) - eye).length()) as f32
}

/// An angle so wide that tolerances differ within a disc.
const WIDE_RAD: f64 = 0.5;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// From any place, with any angle that is allowed, each triangle is drawn, or each of its corners has a disc.
    #[test]
    fn triangles_or_discs_stand_for_each_point(
        edge in 2i32..14,
        num_loose in 0usize..30,
        seed: u32,
        eye in [-5.0f64..15.0, -5.0f64..15.0, -5.0f64..15.0],
        max_slope in prop::sample::select(vec![MAX_TOLERANCE_SLOPE, WIDE_RAD]),
        share in 0.001f64..=1.0,
    ) {
        let tree = tree_of(&mesh(edge, num_loose, seed));
        let sequence = Sequence::new(&tree, max_slope);
        let shapes = shapes(&tree, &sequence);
        let tolerance = from_eye(&tree, eye.into(), share * max_slope);
        prop_assert_eq!(num_lost(&tree, &sequence, &shapes, &tolerance), 0);
    }

    /// A disc is suppressed only if all triangles at any of its points are drawn.
    #[test]
    fn discs_give_way_to_triangles_only(
        edge in 2i32..10,
        num_loose in 0usize..9,
        seed: u32,
        eye in [-5.0f64..15.0, -5.0f64..15.0, -5.0f64..15.0],
        max_slope in prop::sample::select(vec![MAX_TOLERANCE_SLOPE, WIDE_RAD]),
        share in 0.001f64..=1.0,
    ) {
        let tree = tree_of(&mesh(edge, num_loose, seed));
        let with = Sequence::new(&tree, max_slope);
        let without = Sequence::new(&PointTree { triangles: vec![], ..tree.clone() }, max_slope);
        let tolerance = from_eye(&tree, eye.into(), share * max_slope);
        let drawn = are_drawn(&tree, &with.scale, &tolerance);
        let (with_shapes, without_shapes) = (shapes(&tree, &with), shapes(&tree, &without));
        for leaf in leaves(&tree) {
            for node in path(&tree, leaf) {
                let step = with.scale.step_below(tolerance(node));
                if without_shapes[node].is_drawn(step) && !with_shapes[node].is_drawn(step) {
                    let at_leaf = |t: &Triangle| t.corners.contains(&(leaf as u32));
                    let mut triangles = tree.triangles.iter().zip(&drawn).filter(|(t, _)| at_leaf(t)).peekable();
                    prop_assert!(triangles.peek().is_some(), "{} is no corner", leaf);
                    prop_assert!(triangles.all(|(_, drawn)| *drawn));
                }
            }
        }
    }

    #[test]
    fn each_triangle_is_in_one_batch(edge in 2i32..40, seed: u32) {
        let tree = tree_of(&mesh(edge, 3, seed));
        let scale = Sequence::new(&tree, 0.0).scale;
        let mut found = Vec::new();
        for meshlet in meshlets(&tree, &scale) {
            prop_assert!(meshlet.nodes.len() <= 256 && meshlet.words.len() == meshlet.nodes.len());
            let triangles: Vec<[u8; 4]> =
                meshlet.words.iter().map(|word| word.to_le_bytes()).take_while(|word| word[3] > 0).collect();
            prop_assert!((1..=128).contains(&triangles.len()));
            prop_assert!(meshlet.words[triangles.len()..].iter().all(|&word| word == 0));
            prop_assert_eq!(triangles.iter().map(|word| word[3]).max(), Some(meshlet.max));
            found.extend(triangles.iter().map(|word| {
                ([0, 1, 2].map(|i| meshlet.nodes[usize::from(word[i])]), word[3])
            }));
        }
        let mut want: Vec<([u32; 3], u8)> =
            tree.triangles.iter().map(|t| (t.corners, scale.step(t.side))).collect();
        found.sort_unstable();
        want.sort_unstable();
        prop_assert_eq!(found, want);
    }
}

/// Discs that begin where their onsets end leave holes, so the property above can fail.
#[test]
fn floors_need_their_overlap() {
    let tree = tree_of(&mesh(13, 0, 5));
    let lost = |with_overlap: bool| {
        let sequence = Sequence::new(&tree, WIDE_RAD);
        let mut shapes = shapes(&tree, &sequence);
        let onsets = mesh::onsets(&tree, &sequence.scale);
        if !with_overlap {
            shapes.iter_mut().zip(onsets).for_each(|(shape, onset)| shape.min = shape.min.max(onset));
        }
        let of_eye = |i: i32| {
            let tolerance = from_eye(&tree, DVec3::new(f64::from(i) * 0.2 - 10.0, 3.0, 1.0), WIDE_RAD);
            num_lost(&tree, &sequence, &shapes, &tolerance)
        };
        (0..100).map(of_eye).sum::<usize>()
    };
    assert!(lost(false) > 0);
    assert_eq!(lost(true), 0);
}

#[test]
fn a_degenerate_triangle_is_none_and_its_points_stay() {
    let mut scan = scan_of(vec![[0, 0, 0], [1000, 0, 0], [2000, 0, 0], [0, 700, 0], [500, 500, 500]], motley);
    // One triangle is on a line, one has the same corner twice, one has a corner beyond the points, and one is valid.
    scan.files[0].triangles = vec![[0, 1, 2], [3, 3, 4], [0, 1, 99], [0, 3, 4]];
    let tree = tree_of(&scan);
    assert_eq!(tree.triangles.len(), 1);
    let sequence = Sequence::new(&tree, MAX_TOLERANCE_SLOPE);
    let onsets = mesh::onsets(&tree, &sequence.scale);
    let mut with_onset = leaves(&tree).filter(|&leaf| onsets[leaf] > 0).count();
    assert_eq!(with_onset, 3);
    scan.files[0].triangles.pop();
    let tree = tree_of(&scan);
    with_onset = mesh::onsets(&tree, &sequence.scale).len();
    assert!(tree.triangles.is_empty() && with_onset == 0);
}

#[test]
fn what_a_file_knows_best_is_a_points_normal() {
    let up = DVec3::Z;
    let mut scan = scan_of((0..400).map(|i| [i % 20 * 10, i / 20 * 10, 0]).collect(), motley);
    // Both triangles face down.
    scan.files[0].triangles = vec![[0, 20, 1], [0, 20, 1]];
    let mut normals = vec![[f32::NAN; 3]; 400];
    (normals[0], normals[399]) = ([0.6, 0.0, 0.8], [0.0; 3]);
    scan.files[0].points.normals = normals;
    let tree = build_point_tree(&scan, true, &Progress::hidden()).expect("a tree");
    let known: Vec<(DVec3, f32)> = leaves(&tree)
        .map(|leaf| (normals::unpack(tree.nodes[leaf].normal), tree.nodes[leaf].spread))
        .collect();
    let has = |normal: DVec3, spread: f32| {
        known.iter().filter(|(n, s)| (*n - normal).length() < 1e-3 && *s == spread).count()
    };
    assert_eq!(has(DVec3::new(0.6, 0.0, 0.8), 0.0), 1, "its own");
    assert_eq!(has(-up, 0.0), 2, "its triangles'");
    assert_eq!(has(up, std::f32::consts::PI), 397, "estimated: no side");
    assert!(tree.nodes.last().is_some_and(|root| root.spread == std::f32::consts::PI));
    // Normals are axes if sides are not wanted.
    let tree = tree_of(&scan);
    assert!(tree.nodes.iter().all(|node| node.spread == std::f32::consts::PI));
}

/// A mesh and points beside it: a disc over both is drawn for the points.
#[test]
fn files_with_and_without_triangles_mix() {
    let mut scan = mesh(9, 0, 3);
    scan.files.push(
        scan_of((0..300).map(|i| [i * 7 % 4000, i * 31 % 4000, 300]).collect(), motley).files.remove(0),
    );
    let (num_mesh, num_all) = (81, 381);
    let tree = tree_of(&scan);
    let sequence = Sequence::new(&tree, MAX_TOLERANCE_SLOPE);
    let onsets = mesh::onsets(&tree, &sequence.scale);
    assert_eq!(leaves(&tree).filter(|&leaf| onsets[leaf] > 0).count(), num_mesh);
    assert_eq!(leaves(&tree).count(), num_all);
    assert_eq!(onsets.last(), Some(&0));
    let shapes = shapes(&tree, &sequence);
    let near = |leaf: usize| path(&tree, leaf).any(|node| shapes[node].is_drawn(0));
    assert_eq!(
        leaves(&tree).filter(|&leaf| near(leaf)).count(),
        num_all - num_mesh,
        "near by, meshes are triangles"
    );
    let cloud = SequentialCloud::new(&tree, &sequence, &Progress::hidden()).expect("a cloud");
    assert_eq!(cloud.runs.len(), 2);
    assert!(!cloud.runs[0].has_triangles && cloud.runs[1].has_triangles);
    assert_eq!(cloud.num_points, num_all as u64);
    assert!(cloud.intervals[cloud.runs[1].batches.start as usize][0] == 0);
}
