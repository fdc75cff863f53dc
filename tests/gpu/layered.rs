//! Layered clouds and high-quality shading: GPU stages against their CPU references, in every tier, bit for bit.

use base::space::{Eye, Fov, Pose};
use base::task::Progress;
use cloud::Cloud;
use cloud::octree::Octree;
use glam::DVec3;
use kit::frames::{
    Canvas, Drawn, SAMPLE_DETAIL, cloud_of, gpu, hqs, inside, num_differing, octree_of, plain, scan_of,
    sizes, stereo, tiers,
};
use lab::order::Order;
use lab::reference::{self, ReferenceCloud, ReferenceFrame};
use lab::synth::{self, SynthKind};
use points::Scan;
use proptest::prelude::*;
use render::Access;
use render::gpu::Atomics;
use render::layout::{ALL_PLANES, DRAWN_WHOLE, Detail, PROTECTED_MASK, VISIBLE_FILL, ViewUniform};
use render::options::{Dilate, Quality};
use render::{DrawOptions, RINGS_REACH_PX};
use std::sync::OnceLock;

/// A made-up courtyard.
fn courtyard() -> &'static (Scan, Octree) {
    static COURTYARD: OnceLock<(Scan, Octree)> = OnceLock::new();
    COURTYARD.get_or_init(|| {
        let scan = kit::frames::courtyard();
        let octree = octree_of(&scan);
        (scan, octree)
    })
}

fn assert_same(what: &str, drawn: &Drawn, want: &ReferenceFrame) {
    assert!(drawn.states == want.states, "{what}: states");
    assert!(drawn.visible == want.visible, "{what}: visible batches");
    assert_eq!(drawn.times.visible_nodes, want.visible_nodes, "{what}: visible nodes");
    for eye in 0..want.pixels.len() {
        let differing = num_differing(&drawn.pixels[eye], &want.pixels[eye]);
        assert_eq!(differing, 0, "{what}: eye {eye}: pixels that differ from the CPU reference's");
        assert!(drawn.images[eye] == want.images[eye], "{what}: eye {eye}: image");
    }
}

#[test]
fn layered_frames_equal_their_reference_in_every_tier() {
    let (_, octree) = courtyard();
    let view = inside([401, 399]);
    let scene = ReferenceCloud::layered(octree);
    let plain = SAMPLE_DETAIL;
    let details = [
        ("plain", plain),
        ("fade", Detail { fade: true, ..plain }),
        ("smooth, fine", Detail { smooth: true, threshold_px: [50.0, 80.0, 120.0], ..plain }),
        ("fill", Detail { fade: true, fill_reach_px: Some([1.0; 3]), ..plain }),
    ];
    for (name, detail) in details {
        for (quality, dilate) in
            [(Quality::Closest, Dilate::Off), (Quality::Hqs, Dilate::Off), (Quality::Hqs, Dilate::Rings)]
        {
            // Points are drawn together, as on a GPU.
            let access = Access { together: Some(true), ..Access::default() };
            let options = DrawOptions { quality, dilate, access, ..hqs(detail) };
            let want = reference::frame(&scene, &view, &options, None);
            let num_visible = want.visible.iter().filter(|batch| batch.is_first_slice()).count();
            assert!(num_visible > 20 && num_visible < scene.batches.len(), "some are culled");
            let is_sliced = num_visible < want.visible.len();
            assert_eq!(is_sliced, name == "fill", "wide points have several workgroups");
            if name == "fade" {
                assert!(want.states.iter().any(|&s| s != 0 && s != DRAWN_WHOLE), "some nodes are fading");
            }
            if name == "fill" {
                assert!(want.visible.iter().any(|v| v.flags & VISIBLE_FILL != 0), "some points are large");
            }
            for tier in tiers() {
                let drawn = Canvas::layered(octree, &view, options, tier, 0).draw(&view);
                assert_same(&format!("{name}, {quality:?}, {dilate:?}, {tier:?}"), &drawn, &want);
            }
        }
    }
}

#[test]
fn chunks_change_nothing() {
    let (_, octree) = courtyard();
    let view = inside([257, 129]);
    for quality in [Quality::Closest, Quality::Hqs] {
        let options = DrawOptions { quality, ..hqs(Detail { fade: true, ..SAMPLE_DETAIL }) };
        let draw = |limit| Canvas::layered(octree, &view, options, gpu().atomics(), limit).draw(&view);
        let (whole, cut) = (draw(0), draw(4 * 50_000));
        assert!(whole.pixels == cut.pixels, "{quality:?}");
        assert_eq!(whole.times.points_read, cut.times.points_read);
        // A node that two chunks share counts as one node, however many batches it has.
        assert_eq!(whole.times.visible_nodes, cut.times.visible_nodes);
        assert!(whole.times.visible_nodes < whole.times.visible_batches, "{:?}", whole.times);
    }
}

/// The comparison can fail: it sees a filtered color, a state, a point's place.
#[test]
fn the_comparison_notices_what_is_wrong() {
    let (_, octree) = courtyard();
    let view = inside([201, 199]);
    let options = hqs(SAMPLE_DETAIL);
    let drawn = Canvas::layered(octree, &view, options, gpu().atomics(), 0).draw(&view);
    let mut wrong = octree.clone();
    wrong.filtered_colors.iter_mut().for_each(|c| *c ^= 8);
    let want = reference::frame(&ReferenceCloud::layered(&wrong), &view, &options, None);
    assert!(drawn.states == want.states && drawn.pixels != want.pixels, "filtered colors are looked at");
    let mut wrong = octree.clone();
    wrong.cloud.colors.iter_mut().for_each(|c| *c ^= 8);
    assert!(
        drawn.pixels != reference::frame(&ReferenceCloud::layered(&wrong), &view, &options, None).pixels,
        "and own ones"
    );
    let other = hqs(Detail { threshold_px: [120.0, 200.0, 300.0], ..SAMPLE_DETAIL });
    assert!(drawn.states != reference::frame(&ReferenceCloud::layered(octree), &view, &other, None).states);
}

/// 100 000 points lie in one pixel: more than 18 bits of red hold, and more than 16 bits count.
#[test]
fn a_hundred_thousand_points_in_one_pixel() {
    let view = stereo(DVec3::new(0.0, -50.0, 0.0), DVec3::ZERO, [64, 64]);
    let crowd: Vec<[i32; 3]> = (0..100_000).map(|i| [i % 7, i % 5, i % 3]).collect();
    let mut scan = scan_of(&crowd, 0.001, DVec3::ZERO);
    // 60 000 points are white, the rest are black except for the last.
    for (i, rgb) in scan.files[0].points.rgb.iter_mut().enumerate() {
        *rgb = if i < 60_000 { [255; 3] } else { [0, 0, 0] };
    }
    let flat = cloud::build(&scan, &Progress::hidden()).expect("a cloud");
    let octree = octree_of(&scan);
    assert!(octree.is_crowded());
    let options = hqs(SAMPLE_DETAIL);
    for tier in tiers() {
        let drawn = Canvas::layered(&octree, &view, options, tier, 0).draw(&view);
        assert_same(
            "layered",
            &drawn,
            &reference::frame(&ReferenceCloud::layered(&octree), &view, &options, None),
        );
        let mut canvas = Canvas::new(&sizes(&view), options, tier);
        let buffers = render::CloudBuffers::upload(&gpu(), &flat, 0, &Progress::hidden());
        canvas.renderer.set_cloud(buffers.expect("upload")).expect("room");
        let drawn = canvas.draw(&view);
        let want = reference::frame(&ReferenceCloud::flat(&flat), &view, &options, None);
        assert_same("flat", &drawn, &want);
        let fullest = want.sums[0].iter().max_by_key(|sum| sum[3]).expect("pixels");
        assert!(fullest[3] > 60_000, "{fullest:?}");
        let hit = drawn.pixels[0].iter().find(|p| p[0] != u32::MAX).expect("a pixel");
        assert_eq!(hit[1] & 255, 153, "255 · 60 000 / 100 000");
        if tier == Atomics::Int64 {
            let counts: Vec<u64> =
                drawn.keys[0].iter().map(|sum| sum & u64::from(PROTECTED_MASK)).filter(|&c| c > 0).collect();
            assert!(counts.contains(&255), "the first 255 are in the packed sums: {counts:?}");
        }
    }
}

/// The root is drawn in one cloud that is far away, with fewer points than a pixel's sums hold.
#[test]
fn a_far_root_is_drawn_thinly() {
    let (_, octree) = courtyard();
    let center = octree.cloud.bounds.center();
    let scene = ReferenceCloud::layered(octree);
    let options = hqs(SAMPLE_DETAIL);
    for distance in [2_000.0, 20_000.0, 200_000.0] {
        let view = stereo(center - DVec3::Y * distance, center, [128, 128]);
        let want = reference::frame(&scene, &view, &options, None);
        let most = want.sums.iter().flatten().map(|sum| sum[3]).max().expect("pixels");
        assert!(want.states[0] != 0 && (1..1000).contains(&most), "{distance}: {most} points in a pixel");
        assert_same("far", &Canvas::layered(octree, &view, options, gpu().atomics(), 0).draw(&view), &want);
    }
}

/// Every layered view of the courtyard stays well below what the packed sums hold.
#[test]
fn packed_sums_hold() {
    let (_, octree) = courtyard();
    assert!(!octree.is_crowded());
    let options = hqs(Detail { threshold_px: [50.0; 3], ..SAMPLE_DETAIL });
    for place in synth::viewpoints(SynthKind::Terrestrial) {
        let view = stereo(place.eye, place.target, [401, 399]);
        let want = reference::frame(&ReferenceCloud::layered(octree), &view, &options, None);
        let most = want.sums.iter().flatten().map(|sum| sum[3]).max().expect("pixels");
        assert!(most < 500, "{most}");
    }
}

#[test]
fn what_is_drawn_is_a_tree() {
    let (_, octree) = courtyard();
    let scene = ReferenceCloud::layered(octree);
    for detail in [
        SAMPLE_DETAIL,
        Detail { fade: true, ..SAMPLE_DETAIL },
        Detail { smooth: true, threshold_px: [60.0, 100.0, 300.0], ..SAMPLE_DETAIL },
    ] {
        for place in synth::viewpoints(SynthKind::Terrestrial) {
            let view = stereo(place.eye, place.target, [800, 800]);
            let uniform = ViewUniform::new(&view, &octree.cloud.split, &detail);
            let mut states = vec![0; scene.nodes.len()];
            reference::lod::lod(&uniform, 2, &scene.nodes, &mut states);
            for (node, &state) in octree.nodes.iter().zip(&states) {
                let parent = node.parent.map_or(DRAWN_WHOLE, |parent| states[parent as usize]);
                assert!(state <= parent, "a node of level {} is drawn more than its parent", node.level);
            }
            assert!(states.contains(&0), "not all are drawn");
        }
    }
}

/// The head walks and trembles: a node that appears stays, and one that vanishes stays away.
#[test]
fn hysteresis_keeps_nodes_from_flickering() {
    let (_, octree) = courtyard();
    let scene = ReferenceCloud::layered(octree);
    let place = synth::viewpoints(SynthKind::Terrestrial)[0];
    let lod = |step: u32, states: &mut Vec<u32>| {
        // The head moves by a centimeter a frame, and by more than that to and fro.
        let along = 0.01 * f64::from(step) + 0.015 * f64::from(step % 2);
        let eye = place.eye + DVec3::new(0.0, along, 0.0);
        let view = stereo(eye, place.target + eye - place.eye, [1000, 1000]);
        // All rings are alike: a node that comes into another ring does not tremble.
        let detail = Detail { threshold_px: [300.0; 3], ..SAMPLE_DETAIL };
        let uniform = ViewUniform::new(&view, &octree.cloud.split, &detail);
        reference::lod::lod(&uniform, 2, &scene.nodes, states);
    };
    // Counts nodes that change in two frames running.
    let flips = |keeps_states: bool| {
        let mut history = vec![vec![0; scene.nodes.len()]];
        let mut flips = 0;
        for step in 0..400 {
            let mut states = if keeps_states { history[0].clone() } else { vec![0; scene.nodes.len()] };
            lod(step, &mut states);
            history.insert(0, states);
            if let [now, before, earlier, ..] = &history[..] {
                let changes = now.iter().zip(before).zip(earlier);
                flips +=
                    changes.filter(|((now, before), earlier)| now != before && before != earlier).count();
            }
            history.truncate(3);
        }
        flips
    };
    let (with, without) = (flips(true), flips(false));
    assert!(without > 0, "the trembling crosses thresholds");
    assert_eq!(with, 0, "{without} without hysteresis");
}

/// All nodes on the way are drawn whole close up, and each point has the file's color.
#[test]
fn close_up_nothing_of_the_files_color_is_lost() {
    let (scan, octree) = courtyard();
    let p = octree.cloud.bounds.center();
    let mut view = stereo(p, p + DVec3::Y, [64, 64]);
    // The threshold is next to nothing wherever one looks.
    view.near = 1e-3;
    let options = DrawOptions {
        detail: Detail { threshold_px: [1e-3; 3], forced_planes: ALL_PLANES, ..SAMPLE_DETAIL },
        ..plain(true)
    };
    let frame = reference::frame(&ReferenceCloud::layered(octree), &view, &options, None);
    assert!(frame.states.iter().all(|&s| s == DRAWN_WHOLE));
    assert!(frame.visible.iter().all(|v| v.own == [u32::MAX; 2]), "own colors only");
    let of_file: std::collections::HashSet<u32> =
        (0..scan.num_points()).map(|i| scan.files[0].color(i)).collect();
    let seen = frame.pixels[0].iter().filter(|p| p[0] != u32::MAX);
    assert!(seen.clone().count() > 100 && seen.into_iter().all(|p| of_file.contains(&p[1])));
}

/// Fading shows points one by one: the points that a state draws are among those of a larger state.
#[test]
fn fading_is_nested_and_even() {
    let drawn = |state: u32| (0..10_240u32).filter(move |i| i.reverse_bits() < state).count();
    for share in [0.1, 0.25, 0.5, 0.77] {
        let state = (share * f64::from(u32::MAX)) as u32;
        let got = drawn(state) as f64 / 10_240.0;
        assert!((got - share).abs() < 0.03, "{share}: {got}");
    }
    // A state of one half draws half of the points of every run of 64.
    for run in 0..160 {
        let half = (0..64u32).filter(|&i| (run * 64 + i).reverse_bits() < 1 << 31).count();
        assert_eq!(half, 32);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// CPU reference and GPU agree on max-face, duplicate and collinear points, whatever the mix.
    #[test]
    fn odd_clouds_equal_their_reference(
        points in prop::collection::vec([0i32..40, 0i32..40, -3i32..3], 1..3000),
        fade: bool,
    ) {
        let mut xyz = points;
        xyz.extend((0..500).map(|i| [i % 40, 7, 0]));
        xyz.extend(vec![[39, 39, 2]; 700]);
        let scan = scan_of(&xyz, 0.1, DVec3::new(5e5, 4e6, 0.0));
        let octree = octree_of(&scan);
        let center = octree.cloud.bounds.center();
        let view = stereo(center - DVec3::new(1.0, 6.0, -1.0), center, [97, 61]);
        let options = hqs(Detail { fade, fill_reach_px: Some([1.0, 3.0, 4.0]), ..SAMPLE_DETAIL });
        let drawn = Canvas::layered(&octree, &view, options, gpu().atomics(), 0).draw(&view);
        let want = reference::frame(&ReferenceCloud::layered(&octree), &view, &options, None);
        prop_assert!(drawn.pixels == want.pixels);
    }
}

/// A flat cloud has no levels: all of it is drawn, with its own colors, and added up safely.
#[test]
fn flat_clouds_blend_too() {
    let cloud: Cloud = cloud_of(
        &kit::frames::random_points(50_000, 3.0, 9),
        0.001,
        DVec3::new(5e5, 4e6, 100.0),
        Order::Morton,
    );
    let center = cloud.bounds.center();
    let view = stereo(center - DVec3::new(9.0, 0.4, 0.2), center, [133, 77]);
    for tier in tiers() {
        let mut canvas = Canvas::new(&sizes(&view), hqs(SAMPLE_DETAIL), tier);
        let buffers = render::CloudBuffers::upload(&gpu(), &cloud, 0, &Progress::hidden());
        canvas.renderer.set_cloud(buffers.expect("upload")).expect("room");
        let want = reference::frame(&ReferenceCloud::flat(&cloud), &view, &hqs(SAMPLE_DETAIL), None);
        assert_same(&format!("{tier:?}"), &canvas.draw(&view), &want);
        assert!(want.sums[0].iter().any(|sum| sum[3] > 1), "points are blended");
    }
}

/// The wall is at one meter, and its points lie two centimeters apart, give or take: eight pixels. Its surface is
/// closed, and its edge stays where it is.
#[test]
fn close_up_the_surface_is_closed_and_keeps_its_edge() {
    let mut random = kit::frames::SplitMix(3);
    let mut jitter = || (random.unit() * 60.0) as i32 - 30;
    // Lengths are in tenths of a millimeter: from −1 m to 0.2 m across, as high as the view.
    let grid = (-50..=10).flat_map(|x| (-50..=50).map(move |z| [200 * x, 0, 200 * z]));
    let wall: Vec<[i32; 3]> = grid.map(|[x, _, z]| [x + jitter(), jitter() / 10, z + jitter()]).collect();
    let octree = octree_of(&scan_of(&wall, 0.0001, DVec3::new(5e5, 4e6, 0.0)));
    let center = DVec3::new(5e5, 4e6, 0.0);
    let mut view = stereo(center - DVec3::Y, center, [800, 800]);
    view.eyes.truncate(1);
    let eye = Eye { fov: Fov::symmetric(std::f64::consts::FRAC_PI_2, 1.0), ..view.eyes[0] };
    view.eyes[0] = Eye { world_from_view: Pose::look_at(center - DVec3::Y, center, DVec3::Z), ..eye };
    let drawn = |fill_reach_px: Option<[f32; 3]>| {
        let detail = Detail { fill_reach_px, ..SAMPLE_DETAIL };
        let options = DrawOptions { dilate: Dilate::Rings, ..hqs(detail) };
        Canvas::layered(&octree, &view, options, gpu().atomics(), 0).draw(&view)
    };
    // The wall ends at 0.2 m, which is pixel 400 + 0.2 · 400; its edge is a point's half width further.
    let empty = |drawn: &Drawn, columns: std::ops::Range<usize>| {
        let pixels = drawn.pixels[0].iter().enumerate().filter(|(i, _)| columns.contains(&(i % 800)));
        let (all, empty) =
            pixels.fold((0, 0), |(all, empty), (_, p)| (all + 1, empty + u32::from(p[0] == u32::MAX)));
        f64::from(empty) / f64::from(all)
    };
    let (filled, bare) = (drawn(Some(RINGS_REACH_PX)), drawn(None));
    assert!(
        empty(&bare, 20..470) > 0.3,
        "without filling the wall is full of holes: {}",
        empty(&bare, 20..470)
    );
    assert!(empty(&filled, 20..470) < 0.002, "the wall is closed: {}", empty(&filled, 20..470));
    assert!(empty(&filled, 492..800) == 1.0, "beside it nothing is: {}", empty(&filled, 492..800));
}
