//! The papers' methods draw the same picture; orders change only which of equal depths is drawn.

use base::space::{Eye, View};
use base::task::Progress;
use cloud::Cloud;
use cloud::octree::Octree;
use glam::DVec3;
use kit::frames::{
    Canvas, Drawn, SAMPLE_DETAIL, cloud_of, gpu, octree_of, random_points, sample_options, scan_of, stereo,
    tiers,
};
use lab::order::{GROUP_POINTS, Order};
use lab::reference::{clear, fixed40, points};
use lab::technique::{LabTechnique, Method};
use render::CloudBuffers;
use render::DrawOptions;
use render::gpu::{Atomics, Gpu};
use render::layout::{Detail, REACH_MASK, ViewUniform, VisibleBatch, guarded, without_guard};
use render::options::{Dilate, Quality};
use std::sync::Arc;
use std::task::{Context, Poll, Waker};

const SIZE_PX: [u32; 2] = [97, 83];

/// A box of points before the eyes: many a pixel where they are far, none in places where they are near.
fn scattered() -> Vec<[i32; 3]> {
    random_points(60_000, 3.0, 11)
}

fn view() -> View {
    stereo(DVec3::new(1.0, -1.5, 1.2), DVec3::new(1.6, 2.0, 1.5), SIZE_PX)
}

fn options(method: Method, quality: Quality) -> DrawOptions {
    let quality = method.quality().unwrap_or(quality);
    DrawOptions { quality, background: [1, 2, 3], ..sample_options() }
}

fn draw(method: Method, quality: Quality, order: Order) -> Drawn {
    let (view, cloud) = (view(), cloud_of(&scattered(), 0.001, DVec3::ZERO, order));
    flat(method, &cloud, &view, options(method, quality)).draw(&view)
}

fn flat(method: Method, cloud: &Cloud, view: &View, options: DrawOptions) -> Canvas {
    Canvas::flat_by(LabTechnique::method(method), cloud, view, options, 0)
}

fn layered(
    method: Method,
    octree: &Octree,
    view: &View,
    options: DrawOptions,
    atomics: Atomics,
    chunk_limit: u64,
) -> Canvas {
    Canvas::layered_by(LabTechnique::method(method), octree, view, options, atomics, chunk_limit)
}

fn same(a: &Drawn, b: &Drawn) -> bool {
    a.pixels == b.pixels && a.images == b.images
}

/// `fixed40` rounds depths in its own way: its images are compared, and its depths with its CPU reference.
fn same_as(method: Method, drawn: &Drawn, reference: &Drawn) -> bool {
    if method == Method::Fixed40 { drawn.images == reference.images } else { same(drawn, reference) }
}

/// The methods of a quality.
fn methods(quality: Quality) -> impl Iterator<Item = Method> {
    Method::ALL.into_iter().filter(move |method| method.quality().is_none_or(|q| q == quality))
}

#[test]
fn all_methods_but_just_set_draw_the_same_picture() {
    for order in [Order::Original, Order::Morton, Order::Shuffled, Order::ShuffledMorton] {
        for quality in [Quality::Closest, Quality::Hqs] {
            let reference = draw(Method::Prefetch, quality, order);
            assert!(reference.pixels[0].iter().any(|pixel| pixel[0] != u32::MAX), "something is seen");
            for method in methods(quality).filter(|method| !method.shows_the_last()) {
                let drawn = draw(method, quality, order);
                assert!(same_as(method, &drawn, &reference), "{} {order:?} {quality:?}", method.name());
            }
        }
    }
}

/// Opens the adapter again, as one without subgroup operations.
fn without_subgroups() -> Arc<Gpu> {
    let gpu = Gpu::open(None).expect("it was opened before");
    let descriptor = wgpu::DeviceDescriptor {
        required_features: gpu.device.features() - wgpu::Features::SUBGROUP,
        required_limits: gpu.device.limits(),
        ..Default::default()
    };
    let opening = std::pin::pin!(gpu.adapter.request_device(&descriptor));
    let mut context = Context::from_waker(Waker::noop());
    // Vulkan opens devices at once, so one poll is enough.
    let Poll::Ready(Ok((device, queue))) = opening.poll(&mut context) else { panic!("no device") };
    Arc::new(Gpu::new(gpu.instance, gpu.adapter, device, queue))
}

/// A workgroup's memory stands in where there are no subgroups.
#[test]
fn methods_draw_the_same_without_subgroups() {
    let gpu = without_subgroups();
    assert!(!gpu.has_subgroups());
    let (view, cloud) = (view(), cloud_of(&scattered(), 0.001, DVec3::ZERO, Order::Morton));
    let reference = draw(Method::Prefetch, Quality::Closest, Order::Morton);
    for method in [Method::Reduce, Method::ReduceEarlyZ, Method::Dedup] {
        let options = options(method, Quality::Closest);
        let mut canvas =
            Canvas::on(gpu.clone(), &[SIZE_PX; 2], options, gpu.atomics(), LabTechnique::method(method));
        let buffers = CloudBuffers::upload(&gpu, &cloud, 0, &Progress::hidden()).expect("upload");
        canvas.renderer.set_cloud(buffers).expect("room");
        assert!(same(&canvas.draw(&view), &reference), "{}", method.name());
    }
}

/// The picture of just-set has a point in each pixel that has one, but not the nearest everywhere: so `same` can
/// fail.
#[test]
fn just_set_fills_the_same_pixels_wrongly() {
    let reference = draw(Method::Prefetch, Quality::Closest, Order::Original);
    let set = draw(Method::JustSet, Quality::Closest, Order::Original);
    assert!(!same(&set, &reference));
    for (set, nearest) in set.pixels.iter().flatten().zip(reference.pixels.iter().flatten()) {
        assert!(set[0] >= nearest[0] && (set[0] == u32::MAX) == (nearest[0] == u32::MAX));
    }
}

#[test]
fn methods_draw_octrees_too() {
    let octree = octree_of(&scan_of(&scattered(), 0.001, DVec3::ZERO));
    let view = view();
    let detail = Detail { fade: true, threshold_px: [60.0; 3], ..SAMPLE_DETAIL };
    for quality in [Quality::Closest, Quality::Hqs] {
        let draw = |method| {
            let options = DrawOptions { detail, ..options(method, quality) };
            layered(method, &octree, &view, options, gpu().atomics(), 0).draw(&view)
        };
        let reference = draw(Method::Prefetch);
        for method in methods(quality).filter(|method| !method.shows_the_last()) {
            assert!(same_as(method, &draw(method), &reference), "{} {quality:?}", method.name());
        }
    }
}

/// Most methods exist in every tier; several chunks and a part of the image change nothing.
#[test]
fn methods_of_every_tier_draw_the_same_in_each() {
    let octree = octree_of(&scan_of(&scattered(), 0.001, DVec3::ZERO));
    let view = stereo(DVec3::new(1.0, -1.5, 1.2), DVec3::new(1.6, 2.0, 1.5), [61, 48]);
    let draw = |method, atomics, chunk_limit| {
        let options = options(method, Quality::Closest);
        let mut canvas = layered(method, &octree, &larger(&view), options, atomics, chunk_limit);
        canvas.renderer.set_drawn(&[[61, 48]; 2]);
        canvas.draw(&view)
    };
    let reference = draw(Method::Prefetch, gpu().atomics(), 0);
    for atomics in tiers() {
        for method in methods(Quality::Closest).filter(|method| !method.needs_int64()) {
            let drawn = draw(method, atomics, 40_000);
            assert!(same(&drawn, &reference), "{} {}", method.name(), atomics.name());
        }
    }
    let other = stereo(DVec3::new(1.0, -1.5, 1.2), DVec3::new(1.6, 2.0, 1.6), [61, 48]);
    let options = options(Method::PointList, Quality::Closest);
    let mut canvas = layered(Method::PointList, &octree, &larger(&view), options, Atomics::Int32, 0);
    canvas.renderer.set_drawn(&[[61, 48]; 2]);
    assert!(!same(&canvas.draw(&other), &reference), "another view is another picture");
}

/// The same eyes with larger images, of which only a part is drawn.
fn larger(view: &View) -> View {
    let eyes = view.eyes.iter().map(|eye| Eye { size_px: SIZE_PX, ..*eye }).collect();
    View { eyes, ..*view }
}

/// Each pixel's depth is that of a point which the CPU reference puts there, and no other point's is nearer.
#[test]
fn fixed40_equals_its_reference() {
    let view = view();
    let cloud = cloud_of(&scattered(), 0.001, DVec3::new(5e5, 4e6, 100.0), Order::Morton);
    let view = View {
        eyes: view
            .eyes
            .iter()
            .map(|eye| {
                let mut eye = *eye;
                eye.world_from_view.position += DVec3::new(5e5, 4e6, 100.0);
                eye
            })
            .collect(),
        ..view
    };
    let options = options(Method::Fixed40, Quality::Closest);
    let drawn = flat(Method::Fixed40, &cloud, &view, options).draw(&view);
    let want = reference_depths(&cloud, &view, &drawn.visible);
    let mut num_points = 0;
    for (pixel, &depth40) in drawn.pixels.iter().flatten().zip(want.iter().flatten()) {
        let depth = if depth40 == fixed40::EMPTY {
            u32::MAX
        } else {
            num_points += 1;
            (fixed40::depth_of(depth40) as f32).to_bits() & !REACH_MASK
        };
        assert_eq!(pixel[0], depth);
    }
    assert!(num_points > 1000, "{num_points} pixels show something");
}

/// The smallest 40-bit depth of each pixel of each eye.
fn reference_depths(cloud: &Cloud, view: &View, visible: &[VisibleBatch]) -> Vec<Vec<u64>> {
    let uniform = ViewUniform::new(view, &cloud.split, &SAMPLE_DETAIL);
    let mut depths = vec![clear::pixels(guarded(SIZE_PX), fixed40::EMPTY); view.eyes.len()];
    let planes = cloud.planes.each_ref().map(Vec::as_slice);
    for batch in visible {
        let one = std::slice::from_ref(batch);
        points::points(&uniform, view.eyes.len(), one, planes, None, false, &mut |put| {
            let words = planes.map(|plane| plane[(put.id >> 1) as usize]);
            let exact = fixed40::exact_depth(&uniform.eyes[put.eye], batch, words);
            let depth = &mut depths[put.eye][put.pixel];
            *depth = (*depth).min(fixed40::depth40_of(exact));
        });
    }
    depths.iter().map(|depths| without_guard(depths, SIZE_PX)).collect()
}

/// Keys are cleared before the first frame; from then on the shading step leaves them clear.
#[test]
fn fixed40_leaves_a_clear_target_to_the_next_frame() {
    let cloud = cloud_of(&scattered(), 0.001, DVec3::ZERO, Order::Morton);
    let aside = stereo(DVec3::new(1.0, -1.5, 1.2), DVec3::new(0.2, 2.0, 1.5), SIZE_PX);
    for dilate in [Dilate::Off, Dilate::Rings] {
        let options = DrawOptions { dilate, ..options(Method::Fixed40, Quality::Closest) };
        let fresh = flat(Method::Fixed40, &cloud, &aside, options).draw(&aside);
        let mut canvas = flat(Method::Fixed40, &cloud, &aside, options);
        let other = canvas.draw(&view());
        assert!(!same(&other, &fresh), "the heads look elsewhere");
        assert!(same(&canvas.draw(&aside), &fresh), "{dilate:?}");
        assert!(same(&canvas.draw(&aside), &fresh), "{dilate:?}");
    }
}

/// Every point is read without culling, and the picture is the same.
#[test]
fn what_is_not_seen_can_be_read_for_the_sake_of_measuring() {
    let seen = LabTechnique::method(Method::Basic);
    let all = LabTechnique { keep_unseen: true, ..seen };
    let options = options(Method::Basic, Quality::Closest);
    let aside = stereo(DVec3::new(1.0, -1.5, 1.2), DVec3::new(-6.0, -0.5, 1.5), SIZE_PX);
    let cloud = cloud_of(&scattered(), 0.001, DVec3::ZERO, Order::Morton);
    let draw = |technique, view: &View| Canvas::flat_by(technique, &cloud, view, options, 0).draw(view);
    let (culled, whole) = (draw(seen, &aside), draw(all, &aside));
    assert!(same(&culled, &whole));
    assert_eq!(whole.times.points_read, cloud.num_points);
    assert!(culled.times.points_read < cloud.num_points);
}

/// Nearly all steps between 128 neighbors in a shuffled Morton order are short; those from group to group are long.
#[test]
fn orders_are_what_they_say() {
    let xyz = random_points(128 * 50, 3.0, 3);
    let steps = |order| {
        let cloud = cloud_of(&xyz, 0.001, DVec3::ZERO, order);
        let at = |point: usize| {
            let batch = &cloud.batches[point / 10_240];
            let words = [0, 1, 2].map(|plane: usize| cloud.planes[plane][point]);
            let cells = lab::reference::points::cells(3, words).map(f64::from);
            batch.min + DVec3::from_array(cells) * DVec3::from_array(batch.cell.map(f64::from))
        };
        let length = |first: usize| (at(first) - at(first + 1)).length();
        let mean = |within: bool| {
            let is_within = |first: &usize| !(first + 1).is_multiple_of(GROUP_POINTS);
            let steps: Vec<f64> =
                (0..xyz.len() - 1).filter(|first| is_within(first) == within).map(length).collect();
            steps.iter().sum::<f64>() / steps.len() as f64
        };
        [mean(true), mean(false)]
    };
    let [morton, shuffled, groups] = [Order::Morton, Order::Shuffled, Order::ShuffledMorton].map(steps);
    assert!(morton[0] < 0.4 && morton[1] < 0.6, "{morton:?}");
    assert!(shuffled.iter().all(|&step| step > 1.5), "{shuffled:?}");
    assert!(groups[0] < 0.4 && groups[1] > 1.2, "{groups:?}");
}
