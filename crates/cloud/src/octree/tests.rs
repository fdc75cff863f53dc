//! Tests of what does not show outside: that every point counts once for the samples, and that samples keep apart.

use super::keys::{CodeFrame, Cube, Root, SortKey, sorted};
use super::sample::{Sample, Sampled, Sampler};
use super::tree::{Draft, OctreeBuilder};
use super::*;
use crate::made_up::{motley, scan_of};
use proptest::prelude::*;

/// The root, and each point of the scan as a candidate in the root's frame.
fn candidates(scan: &Scan) -> (Root, Vec<Sample>) {
    let root = Root::new(&scan.bounds());
    let keys = sorted(&Index::new(scan), &root);
    (root, keys.iter().enumerate().map(|(number, key)| Sample::of(key, number)).collect())
}

fn sample(root: &Root, candidates: &[Sample], limit: usize) -> Sampled {
    let frame = CodeFrame::new(root, Cube::ROOT);
    Sampler::new().sample(frame.bits_below(0), limit, |offer| candidates.iter().for_each(|c| offer(0, c)))
}

/// Number of points and sums of red, green, blue.
fn totals(samples: &[Sample]) -> (u64, [u64; 3]) {
    samples.iter().fold((0, [0; 3]), |(count, rgb), s| {
        (count + u64::from(s.num_points), std::array::from_fn(|c| rgb[c] + s.rgb[c]))
    })
}

/// A wavy sheet with noise.
fn sheet(num_points: usize, seed: u32) -> Vec<[i32; 3]> {
    let mut state = seed;
    let mut noise = move |range: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) % range
    };
    let point = |_| {
        let (x, y) = (noise(40_000), noise(40_000));
        let wave = 3000.0 * (f64::from(x) / 5000.0).sin() * (f64::from(y) / 9000.0).cos();
        [x as i32, y as i32, wave as i32 + noise(60) as i32]
    };
    (0..num_points).map(point).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn every_point_counts_once_for_the_samples(num_points in 1usize..4000, edge in 1i32..3000, seed: u32) {
        let mut xyz = sheet(num_points, seed);
        xyz.iter_mut().flatten().for_each(|v| *v %= edge);
        let (root, all) = candidates(&scan_of(xyz, motley));
        let sampled = sample(&root, &all, MAX_NODE_POINTS);
        prop_assert_eq!(totals(&sampled.samples), totals(&all));
        prop_assert_eq!(sampled.num_taken.iter().sum::<u32>() as usize, sampled.samples.len());
    }

    #[test]
    fn a_limit_is_kept_and_loses_nothing(limit in 1usize..3000, seed: u32) {
        let (root, all) = candidates(&scan_of(sheet(4000, seed), motley));
        let unlimited = sample(&root, &all, usize::MAX).samples.len();
        let sampled = sample(&root, &all, limit);
        prop_assert_eq!(sampled.samples.len(), limit.min(unlimited));
        prop_assert_eq!(sampled.num_taken[0] as usize, sampled.samples.len());
        prop_assert_eq!(totals(&sampled.samples), totals(&all));
    }
}

#[test]
fn a_lost_point_shows_in_the_totals() {
    let (_, all) = candidates(&scan_of(sheet(100, 1), motley));
    assert_ne!(totals(&all[1..]), totals(&all));
    assert_ne!(totals(&[&all[..], &all[..1]].concat()), totals(&all));
}

/// Sums of the own colors of the keys in a range, looked up by point.
fn own_totals(index: &Index, keys: &[SortKey]) -> (u64, [u64; 3]) {
    let own: Vec<Sample> = keys
        .iter()
        .map(|key| Sample::of(&SortKey { color: index.color(key.point as usize), ..*key }, 0))
        .collect();
    totals(&own)
}

/// Largest part of one 8-bit step by which a node's filtered colors, weighted by what they stand for, may
/// leave the true average: each is rounded to half a step.
const HALF_STEP: f64 = 0.5;

/// The root keeps all its samples: its filtered colors tell the average of the whole cloud.
#[test]
fn the_roots_filtered_colors_average_the_cloud() {
    let scan = scan_of(sheet(120_000, 7), motley);
    let index = Index::new(&scan);
    let root = Root::new(&scan.bounds());
    let mut keys = sorted(&index, &root);
    let truth = own_totals(&index, &keys);
    let mut levels = vec![0; keys.len()];
    let draft =
        OctreeBuilder { index: &index, root, progress: &Progress::hidden() }.build(&mut keys, &mut levels);
    assert!(draft.children.iter().any(|child| !child.children.is_empty()), "two inner levels at least");

    // The root's samples are computed once more, from the tree's own leaves up, with their weights.
    let samples = resampled(&CodeFrame::new(&root, Cube::ROOT), &index, &draft, &keys);
    assert_eq!(totals(&samples), truth, "every point counts once through all levels");
    assert_eq!(samples.len(), draft.num_points as usize);
    let mut weighted = [0.0; 3];
    for sample in &samples {
        let color = keys[sample.key as usize].color;
        assert_eq!(color, sample.color(), "the filtered color is the average of what the sample stands for");
        assert_eq!(levels[sample.key as usize], 0);
        for (channel, sum) in weighted.iter_mut().enumerate() {
            *sum += f64::from(sample.num_points) * f64::from(color >> (8 * channel) & 255);
        }
    }
    for (sum, true_sum) in weighted.iter().zip(truth.1) {
        assert!((sum - true_sum as f64).abs() <= HALF_STEP * truth.0 as f64);
    }
}

/// Samples that a subtree's root takes, computed without threads and without taking anything away.
fn resampled(frame: &CodeFrame, index: &Index, draft: &Draft, keys: &[SortKey]) -> Vec<Sample> {
    let own = |number: usize| {
        Sample::of(&SortKey { color: index.color(keys[number].point as usize), ..keys[number] }, number)
    };
    if draft.children.is_empty() {
        return draft.keys.clone().map(own).collect();
    }
    // Children that were taken whole are gone from the draft; their points are offered as they are.
    let mut offered = Vec::new();
    let mut next = draft.keys.start;
    for child in &draft.children {
        offered.extend((next..child.keys.start).map(own));
        offered.extend(resampled(frame, index, child, keys));
        next = child.keys.end;
    }
    offered.extend((next..draft.keys.end).map(own));
    let feed = |offer: &mut dyn FnMut(usize, &Sample)| offered.iter().for_each(|s| offer(0, s));
    Sampler::new().sample(frame.bits_below(draft.cube.level), MAX_NODE_POINTS, feed).samples
}

#[test]
fn of_equal_candidates_the_first_is_taken_and_stands_for_all() {
    let scan = scan_of([vec![[0, 0, 0]; 5], vec![[1000, 1000, 1000]]].concat(), motley);
    let (root, all) = candidates(&scan);
    let sampled = sample(&root, &all, MAX_NODE_POINTS);
    let counts: Vec<(u32, u32)> = sampled.samples.iter().map(|s| (s.key, s.num_points)).collect();
    assert_eq!(counts, [(0, 5), (5, 1)]);
}

/// Points strewn over the faces of a box, and one far off.
fn room_and_outlier(num_points: usize, edge: i32) -> Vec<[i32; 3]> {
    let mut state = 5u32;
    let mut noise = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as i32 % edge
    };
    let mut xyz = vec![[2 * edge; 3]];
    for number in 0..num_points {
        let mut p = [noise(), noise(), noise()];
        p[number % 3] = if number % 2 == 0 { 0 } else { edge - 1 };
        xyz.push(p);
    }
    xyz
}

/// The root samples the box with 64³ cells, its child with 128³, and takes more than a node may have: were the child
/// given the root's cells instead, nothing would be left to it, and a level of detail would be missing.
#[test]
fn a_crowded_level_keeps_points_of_its_own() {
    let scan = scan_of(room_and_outlier(400_000, 20_000), motley);
    let octree = build_octree(&scan, &Progress::hidden()).unwrap();
    let inner = |node: &&Node| !node.children.is_empty();
    let level_1 = octree.nodes.iter().filter(inner).find(|node| node.level == 1).expect("the box");
    assert!(level_1.num_points > 20_000, "{} points", level_1.num_points);
    assert!(octree.nodes.iter().filter(inner).all(|node| node.num_points as usize <= MAX_NODE_POINTS));
}
