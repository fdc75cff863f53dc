//! What an octree promises, for clouds of every odd shape: nothing lost, nothing twice, nodes inside their
//! parents, points inside their nodes and apart from each other, the same result on any number of threads.

use base::space::{Eye, Fov, Pose, View};
use base::task::{CancelToken, Cancelled, Progress};
use cloud::octree::{LEAF_POINTS, MAX_LEVEL, MAX_NODE_POINTS, Node, Octree, build_nodes, build_octree};
use cloud::{BuildError, Cloud, quantize};
use glam::DVec3;
use kit::frames::{SAMPLE_DETAIL, SplitMix, octree_of, sample_options, scan_of};
use lab::reference::{self, ReferenceCloud};
use points::Scan;
use proptest::prelude::*;
use render::DrawOptions;
use render::layout::{
    ALL_PLANES, BATCH_POINTS, COORDINATE_BITS, Detail, POINTS_PER_LOAD, SPACING_EXPONENT_SHIFT,
};
use std::ops::Range;

/// Far from the origin, where coordinates have digits to lose.
const FAR: DVec3 = DVec3::new(5e5, 4e6, 100.0);

/// Shapes whose octrees are unlike each other, each large enough for several levels.
fn shapes() -> Vec<(&'static str, Vec<[i32; 3]>)> {
    let mut random = SplitMix(1);
    let mut many = |count: usize, f: &dyn Fn(&mut SplitMix) -> [i32; 3]| -> Vec<[i32; 3]> {
        (0..count).map(|_| f(&mut random)).collect()
    };
    let ground = |r: &mut SplitMix| [r.below(50_000), r.below(50_000), r.below(40)];
    let cube = |r: &mut SplitMix| [r.below(4096), r.below(4096), r.below(4096)];
    let mut max_faces = many(60_000, &ground);
    max_faces.extend(many(20_000, &|r| [r.below(50_000), 49_999, r.below(50_000)]));
    max_faces.push([49_999; 3]);
    let mut outlier = many(80_000, &ground);
    outlier.push([2_000_000_000; 3]);
    let mut two_outliers = many(80_000, &|r| [r.below(300), r.below(300), r.below(2)]);
    two_outliers.extend([[-2_000_000_000, 5, 5], [2_000_000_000, 0, 0]]);
    let mut duplicates = vec![[12_345, 23_456, 789]; 100_000];
    duplicates.extend(many(50_000, &ground));
    vec![
        ("ground", many(200_000, &ground)),
        ("cube", many(150_000, &cube)),
        ("max faces", max_faces),
        ("line", many(70_000, &|r| [r.below(1 << 30), 7, 7])),
        ("diagonal", (0..70_000).map(|i| [i * 3; 3]).collect()),
        ("flat", many(90_000, &|r| [r.below(9000), 4, r.below(9000)])),
        ("outlier", outlier),
        ("two outliers", two_outliers),
        ("duplicates", duplicates),
        ("one place", vec![[1, 2, 3]; 100_000]),
        ("tiny", vec![[0, 0, 0], [5, 0, 0], [0, 9, 1]]),
        ("one point", vec![[7, 7, 7]]),
    ]
}

fn planes_at(octree: &Octree, at: usize) -> [u32; 3] {
    [0, 1, 2].map(|plane| octree.cloud.planes[plane][at])
}

/// Places of a node's points in the planes.
fn slots(node: &Node) -> Range<usize> {
    node.first_point as usize..(node.first_point + node.num_points) as usize
}

/// Position of the point at a place of the planes, as batch `batch` decodes it.
fn decoded(octree: &Octree, batch: usize, at: usize) -> DVec3 {
    let batch = &octree.cloud.batches[batch];
    let cells = quantize::Cells { min: batch.min, cell: batch.cell };
    cells.center(quantize::cells_of(planes_at(octree, at)))
}

/// Finds what is wrong with the octree of a scan: one sentence for each rule that it breaks.
fn faults(octree: &Octree, scan: &Scan) -> Vec<String> {
    let mut faults = lost_points(octree, scan);
    for (number, node) in octree.nodes.iter().enumerate() {
        let rules: [(&str, bool); 5] = [
            ("its batches hold its points", batches_hold(octree, node)),
            ("its parent stands before it and encloses it", is_enclosed(octree, number)),
            ("its size is within limits", has_good_size(node)),
            ("its points are apart", node.children.is_empty() || smallest_distance(octree, node) >= 0.5),
            ("it counts the points in its cube", counts_within(octree, number)),
        ];
        let broken = rules.iter().filter(|(_, holds)| !holds);
        faults.extend(broken.map(|(rule, _)| format!("node {number}: {rule}")));
    }
    faults
}

/// Every point of the scan must be in one batch, in its cell and with its color: colors are unique.
fn lost_points(octree: &Octree, scan: &Scan) -> Vec<String> {
    let file = &scan.files[0];
    let mut seen = vec![0u32; file.points.xyz.len()];
    let mut faults = Vec::new();
    for (number, batch) in octree.cloud.batches.iter().enumerate() {
        for at in batch.first_point as usize..(batch.first_point + batch.num_points) as usize {
            let point = (octree.cloud.colors[at] & 0xff_ffff) as usize;
            let Some(count) = seen.get_mut(point) else {
                faults.push(format!("no point has the color {point:x}"));
                continue;
            };
            *count += 1;
            let p = file.grid.p_in_world(file.points.xyz[point]);
            let off = (decoded(octree, number, at) - p).abs().max_element();
            // The tolerance is half a cell, and what f64 loses so far from the origin.
            if off > 0.500001 * f64::from(batch.cell[0]) + 4e-9 {
                faults.push(format!("point {point} is {off} off"));
            }
        }
    }
    let wrong = seen.iter().filter(|&&count| count != 1).count();
    if wrong > 0 || octree.cloud.num_points != seen.len() as u64 {
        faults.push(format!("{wrong} points are missing or there twice"));
    }
    faults
}

fn batches_hold(octree: &Octree, node: &Node) -> bool {
    let batches = &octree.cloud.batches[node.batches.start as usize..node.batches.end as usize];
    let mut next = node.first_point;
    for batch in batches {
        let share_box = batch.min == node.min && f64::from(batch.cell[0]) * f64::from(1 << 30) == node.edge;
        let is_aligned = batch.first_point % POINTS_PER_LOAD == 0 && batch.first_point == next;
        if !share_box || !is_aligned || batch.num_points == 0 || batch.num_points > BATCH_POINTS {
            return false;
        }
        next += batch.num_points;
    }
    next == node.first_point + node.num_points
}

fn is_enclosed(octree: &Octree, number: usize) -> bool {
    let node = &octree.nodes[number];
    let slack = 1e-9;
    let root = &octree.nodes[0];
    let at = root.min + DVec3::from_array(node.cube.map(f64::from)) * node.edge;
    if (at - node.min).abs().max_element() > slack || node.level > MAX_LEVEL {
        return false;
    }
    let Some(parent) = node.parent else { return number == 0 };
    let above = &octree.nodes[parent as usize];
    let levels = node.level.wrapping_sub(above.level);
    let siblings = above.children.start as usize..above.children.end as usize;
    (parent as usize) < number
        && (1..=MAX_LEVEL).contains(&levels)
        && siblings.contains(&number)
        && node.edge * f64::from(1 << levels) == above.edge
        && node.cube.map(|v| v >> levels) == above.cube
}

fn has_good_size(node: &Node) -> bool {
    let limit = if node.children.is_empty() { LEAF_POINTS.max(MAX_NODE_POINTS) } else { MAX_NODE_POINTS };
    // Points that even the deepest cube cannot tell apart stay together.
    node.num_points as usize <= limit || node.level == MAX_LEVEL || node.edge == 0.0
}

/// True if a node has room for the points of all nodes below, its own, and at most as many from above as nodes above
/// have.
fn counts_within(octree: &Octree, number: usize) -> bool {
    let node = &octree.nodes[number];
    let below: u32 = node.children.clone().map(|c| octree.nodes[c as usize].num_points_within).sum();
    let num_above = above(octree, number).map(|n| octree.nodes[n].num_points).sum::<u32>();
    let least = node.num_points.max(below);
    (least..=below.saturating_add(node.num_points).saturating_add(num_above))
        .contains(&node.num_points_within)
}

fn above(octree: &Octree, number: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(octree.nodes[number].parent, |&n| octree.nodes[n as usize].parent)
        .map(|n| n as usize)
}

/// Smallest distance between two points of a node in units of its cell; half a cell of quantization is granted to
/// each point. Points are put into cells as wide as half the node's cell, so only neighboring cells matter.
fn smallest_distance(octree: &Octree, node: &Node) -> f64 {
    let mut cells = std::collections::HashMap::<[i64; 3], Vec<DVec3>>::new();
    let batch = node.batches.start as usize;
    let granted = 4.0 / f64::from(1 << 22);
    let mut smallest = f64::INFINITY;
    for at in slots(node) {
        let p = (decoded(octree, batch, at) - node.min) / node.cell();
        let cell = (p * 2.0).floor().to_array().map(|v| v as i64);
        for number in 0..27 {
            let near = [cell[0] + number % 3 - 1, cell[1] + number / 3 % 3 - 1, cell[2] + number / 9 - 1];
            let others = cells.get(&near).map_or(&[][..], |others| others);
            smallest = others.iter().fold(smallest, |least, other| least.min(other.distance(p)));
        }
        cells.entry(cell).or_default().push(p);
    }
    smallest + granted
}

#[test]
fn octrees_of_all_shapes_keep_every_promise() {
    for (name, xyz) in shapes() {
        let scan = scan_of(&xyz, 0.001, FAR);
        let octree = octree_of(&scan);
        let faults = faults(&octree, &scan);
        assert!(faults.is_empty(), "{name}: {:#?}", &faults[..faults.len().min(9)]);
    }
}

#[test]
fn broken_promises_are_seen() {
    let scan = scan_of(&shapes().swap_remove(0).1, 0.001, FAR);
    let whole = octree_of(&scan);
    assert!(faults(&whole, &scan).is_empty());
    let broken = |spoil: &dyn Fn(&mut Octree)| {
        let mut octree = whole.clone();
        spoil(&mut octree);
        faults(&octree, &scan).join("\n")
    };
    assert!(broken(&|o| o.cloud.colors[9] = o.cloud.colors[8]).contains("missing or there twice"));
    assert!(broken(&|o| o.cloud.batches[1].num_points -= 1).contains("batches hold"));
    assert!(broken(&|o| o.cloud.planes[1][5] ^= 1).contains("off"));
    assert!(broken(&|o| o.nodes[2].cube[0] ^= 1).contains("encloses"));
    assert!(broken(&|o| o.nodes[2].parent = Some(3)).contains("encloses"));
    assert!(broken(&|o| o.nodes[1].num_points_within = 1).contains("counts"));
    let twice = |o: &mut Octree| (0..3).for_each(|plane| o.cloud.planes[plane][4] = o.cloud.planes[plane][5]);
    assert!(broken(&twice).contains("apart"));
    let mut large = whole.nodes[0].clone();
    large.num_points = 50_001;
    assert!(!has_good_size(&large) && has_good_size(&whole.nodes[0]));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn octrees_of_random_clouds_keep_every_promise(
        num_points in 1usize..90_000, bits in prop::array::uniform3(0u32..31), seed: u64,
    ) {
        let mut random = SplitMix(seed);
        let xyz: Vec<_> = (0..num_points).map(|_| bits.map(|b| random.below(1 << b))).collect();
        let scan = scan_of(&xyz, 0.001, FAR);
        let faults = faults(&octree_of(&scan), &scan);
        prop_assert!(faults.is_empty(), "{:#?}", &faults[..faults.len().min(9)]);
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let scan = scan_of(&shapes().swap_remove(0).1, 0.001, FAR);
    let on = |num_threads: usize, scan: &Scan| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(num_threads).build().unwrap();
        let octree = pool.install(|| octree_of(scan));
        (octree.nodes, octree.cloud.batches, octree.cloud.planes, octree.cloud.colors, octree.filtered_colors)
    };
    let one = on(1, &scan);
    assert!(one == on(2, &scan));
    assert!(one == on(5, &scan));
    let mut other = scan.clone();
    other.files[0].points.xyz[77][0] += 3;
    assert!(one != on(2, &other), "a point moved by 3 mm must show");
}

/// Points lie near the centers of the root's grid cells. No sample is then too near to another, and every filtered
/// color must be the plain average of its cell.
#[test]
fn filtered_colors_are_the_averages_of_cells() {
    let mut random = SplitMix(5);
    let mut point = |i: i32| {
        let mut near = |cell: i32| cell * 1024 + 512 + random.below(200) - 100;
        [near(i % 128), near(i / 128 % 128), near(0)]
    };
    // The corners fix the cube: 128 cells of 1024 steps.
    let mut xyz: Vec<[i32; 3]> = (0..128 * 128 * 4).map(&mut point).collect();
    xyz.extend([[0, 0, 0], [131_072, 131_072, 0]]);
    let scan = scan_of(&xyz, 0.001, FAR);
    let octree = octree_of(&scan);
    let root = &octree.nodes[0];
    assert!((root.edge - 131.072).abs() < 0.2, "rounded up to 12 bits");
    let file = &scan.files[0];
    let cell_of = |p: DVec3| ((p - root.min) / root.cell()).floor().to_array().map(|v| v as i64);
    let mut cells = std::collections::HashMap::<[i64; 3], [u64; 4]>::new();
    for (i, xyz) in file.points.xyz.iter().enumerate() {
        let sums = cells.entry(cell_of(file.grid.p_in_world(*xyz))).or_default();
        let rgb = file.points.rgb[i].map(u64::from);
        *sums = [sums[0] + rgb[0], sums[1] + rgb[1], sums[2] + rgb[2], sums[3] + 1];
    }
    let mut num_filtered = 0;
    for at in slots(root) {
        let [r, g, b, n] = cells[&cell_of(decoded(&octree, 0, at))];
        let average = [r, g, b].map(|sum| (2 * sum + n) / (2 * n));
        let stored = [0, 8, 16].map(|shift| u64::from(octree.filtered_colors[at] >> shift & 255));
        assert_eq!(stored, average);
        num_filtered += usize::from(octree.filtered_colors[at] != octree.cloud.colors[at]);
    }
    assert!(num_filtered > 10_000, "own and filtered colors differ, or this shows nothing");
    let leaves = octree.nodes.iter().filter(|node| node.children.is_empty());
    for node in leaves {
        assert_eq!(octree.filtered_colors[slots(node)], octree.cloud.colors[slots(node)]);
    }
}

/// Distances of a node's points from their neighbors, world units, as planes and node say, with the points' x in the
/// scan.
fn spacings<'o>(octree: &'o Octree, node: &'o Node) -> impl Iterator<Item = (f64, f64)> + 'o {
    slots(node).map(|at| {
        let words = planes_at(octree, at);
        let [x, y, z] = quantize::cells_of(words).map(|cell| (cell >> (COORDINATE_BITS - 1)) as usize);
        let least = f64::from(node.octant_spacing[x | y << 1 | z << 2]) * node.edge;
        let exponent = words[0] >> SPACING_EXPONENT_SHIFT;
        let spacing = least * f64::from(node.spacing_step).powi(exponent as i32);
        (decoded(octree, node.batches.start as usize, at).x - 5e5, spacing)
    })
}

/// Ground with a point every 10 mm lies beside ground with one every 70 mm, which are more and fewer points than a
/// leaf has.
#[test]
fn samples_tell_how_far_apart_the_points_lie_that_they_stand_for() {
    let sheet = |num: i32, step: i32, first: i32| {
        (0..num * num).map(move |i| [first + i % num * step, i / num * step, i / 7 % 3])
    };
    let border_mm = 5000;
    let scan = scan_of(&sheet(500, 10, 0).chain(sheet(100, 70, border_mm)).collect::<Vec<_>>(), 0.001, FAR);
    let octree = octree_of(&scan);
    let inner = octree.nodes.iter().filter(|node| node.sample_spacing > 0.0);
    let told: Vec<(f64, f64)> = inner.clone().flat_map(|node| spacings(&octree, node)).collect();
    // Leaves and octants that the border goes through have some points of both.
    let apart = |&&(x, _): &&(f64, f64)| (x - 5.0).abs() > 1.0;
    let wrong = |least: f64, most: f64| {
        let ratio = |(x, spacing): (f64, f64)| spacing / if x < 5.0 { 0.01 } else { 0.07 };
        let is_wrong = |told: &&(f64, f64)| !(least..most).contains(&ratio(**told));
        told.iter().filter(apart).filter(is_wrong).count()
    };
    let num = told.iter().filter(apart).count();
    assert!(num > 10_000, "{num}");
    assert!(wrong(0.6, 2.5) * 50 < num, "{} of {num} are wrong", wrong(0.6, 2.5));
    // The root holds both kinds of ground: without exponents all of it would count as equally dense.
    let root = &octree.nodes[0];
    assert!(root.spacing_step > 1.5, "{}", root.spacing_step);
    let exponents: Vec<u32> =
        slots(root).map(|at| octree.cloud.planes[0][at] >> SPACING_EXPONENT_SHIFT).collect();
    assert!(exponents.contains(&0) && exponents.contains(&3), "both are told apart");
    // A leaf's points lie as far apart as their octant says.
    let leaves = octree.nodes.iter().filter(|node| node.sample_spacing == 0.0 && node.spacing_step == 1.0);
    let words = leaves.flat_map(slots).map(|at| octree.cloud.planes[0][at]);
    assert!(words.clone().count() > 10_000 && words.clone().all(|word| word >> SPACING_EXPONENT_SHIFT == 0));
}

#[test]
fn nodes_are_handed_over_from_the_root_down_once_each_and_whole() {
    let mut random = SplitMix(3);
    let xyz: Vec<_> =
        (0..2_500_000).map(|_| [random.below(90_000), random.below(90_000), random.below(30)]).collect();
    let scan = scan_of(&xyz, 0.001, FAR);
    let octree = octree_of(&scan);
    let mut seen: Vec<usize> = Vec::new();
    let mut runs: Vec<usize> = Vec::new();
    build_nodes(&scan, &Progress::hidden(), &mut |hierarchy, blocks| {
        assert!(hierarchy.nodes == octree.nodes && hierarchy.batches == octree.cloud.batches);
        runs.push(blocks.len());
        for block in blocks {
            let slots = slots(&octree.nodes[block.node]);
            let is_whole =
                block.planes.iter().zip(&octree.cloud.planes).all(|(b, o)| b[..] == o[slots.clone()]);
            assert!(is_whole && block.colors[..] == octree.cloud.colors[slots.clone()]);
            assert!(block.filtered_colors[..] == octree.filtered_colors[slots]);
            seen.push(block.node);
        }
        Ok::<(), BuildError>(())
    })
    .unwrap();
    assert!(seen.iter().copied().eq(0..octree.nodes.len()), "each once, in order");
    assert!(runs.len() > 2 && runs[0] == 1, "the root, and several runs: {runs:?}");
    // The one who takes nodes may end the building.
    let ended = build_nodes(&scan, &Progress::hidden(), &mut |_, _| Err(BuildError::Cancelled(Cancelled)))
        .unwrap_err();
    assert_eq!(ended, BuildError::Cancelled(Cancelled));
}

/// The batches form a flat cloud: the stages that draw such clouds draw all of its points.
#[test]
fn all_batches_together_draw_the_whole_cloud() {
    let scan =
        scan_of(&(0..400 * 400).map(|i| [i % 400 * 10, 0, i / 400 * 10]).collect::<Vec<_>>(), 0.001, FAR);
    let octree = octree_of(&scan);
    let center = octree.cloud.bounds.center();
    let eye = Pose::look_at(center - DVec3::new(0.0, 4.0, 0.0), center, DVec3::Z);
    let fov = Fov::symmetric(std::f64::consts::FRAC_PI_2, 1.0);
    let eyes = vec![Eye { world_from_view: eye, fov, size_px: [2400, 2400], gaze_in_view: Eye::AHEAD }];
    let view = View { eyes, near: 0.05 };
    let num_drawn = |cloud: &Cloud| {
        let detail = Detail { forced_planes: ALL_PLANES, ..SAMPLE_DETAIL };
        let frame = reference::frame(
            &ReferenceCloud::flat(cloud),
            &view,
            &DrawOptions { detail, ..sample_options() },
            None,
        );
        assert_eq!(frame.points_read(), cloud.num_points);
        let colors = frame.images[0].iter().copied().filter(|&c| c != 0xff00_0000);
        let mut colors: Vec<u32> = colors.collect();
        colors.sort_unstable();
        colors.dedup();
        colors.len()
    };
    // Points are 3 pixels apart: each is seen. One is black like the background.
    assert_eq!(num_drawn(&octree.cloud), 400 * 400 - 1);
    let mut cut = octree.cloud.clone();
    let last = cut.batches.pop().unwrap();
    cut.num_points -= u64::from(last.num_points);
    assert_eq!(num_drawn(&cut), 400 * 400 - 1 - last.num_points as usize);
}

#[test]
fn small_and_impossible_clouds() {
    let tiny = octree_of(&scan_of(&[[0, 0, 0], [5, 0, 0], [0, 9, 1]], 0.001, FAR));
    assert_eq!((tiny.nodes.len(), tiny.cloud.batches.len()), (1, 1));
    let one_place = octree_of(&scan_of(&[[1, 2, 3]; 100_000], 0.001, FAR));
    assert_eq!((one_place.nodes.len(), one_place.cloud.batches.len()), (1, 10));
    assert_eq!(one_place.nodes[0].edge, 0.0);

    let build = |scan: &Scan, progress: &Progress| build_octree(scan, progress).unwrap_err();
    assert_eq!(build(&Scan::default(), &Progress::hidden()), BuildError::Empty);
    let stop = CancelToken::default();
    stop.cancel();
    let scan = scan_of(&[[1, 2, 3]; 5], 0.001, FAR);
    assert_eq!(build(&scan, &Progress::silent(&stop)), BuildError::Cancelled(Cancelled));
}

/// The points are at four places, thousands at each. Nodes of the first level stand right over the deepest ones,
/// whose codes are made in frames of their own.
#[test]
fn a_few_crowded_places_keep_every_promise() {
    let mut random = SplitMix(190_902_201_275);
    let xyz: Vec<_> = (0..28_720).map(|_| [0, 0, 2].map(|bits| random.below(1 << bits))).collect();
    let scan = scan_of(&xyz, 0.001, FAR);
    let faults = faults(&octree_of(&scan), &scan);
    assert!(faults.is_empty(), "{:#?}", &faults[..faults.len().min(9)]);
}
