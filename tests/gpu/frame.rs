//! GPU stages against their CPU references: integer buffers match bit for bit.

use base::space::View;
use base::task::Progress;
use cloud::Cloud;
use glam::DVec3;
use kit::frames::{
    Drawn, SAMPLE_DETAIL, cloud_of, draw, gpu, made_up, num_differing, plain, random_points, stereo,
};
use kit::real_scans::{self, ROOM};
use lab::order::Order;
use lab::reference::{self, ReferenceCloud};
use lab::synth::{self, SynthKind};
use points::Scan;
use render::CloudBuffers;
use render::layout::{
    ALL_PLANES, DRAWN_WHOLE, GpuBatch, GpuNode, VISIBLE_PLANES, ViewUniform, VisibleBatch, guarded,
};

fn assert_reference(cloud: &Cloud, view: &View, full_precision: bool, chunk_limit: u64) -> Drawn {
    let drawn = draw(cloud, view, full_precision, chunk_limit);
    let want = reference::frame(&ReferenceCloud::flat(cloud), view, &plain(full_precision), None);
    for eye in 0..view.eyes.len() {
        let differing = num_differing(&drawn.keys[eye], &want.keys[eye]);
        assert_eq!(differing, 0, "eye {eye}: pixels whose depth or id differ from the CPU reference");
        assert!(drawn.pixels[eye] == want.pixels[eye], "eye {eye}: pixels");
        assert!(drawn.images[eye] == want.images[eye], "eye {eye}: image");
        assert!(want.keys[eye].iter().any(|&p| p != reference::clear::EMPTY), "eye {eye} sees something");
    }
    assert_eq!(drawn.times.visible_nodes, 1, "a flat cloud is one node");
    assert_eq!(drawn.times.visible_batches as usize, want.visible.len());
    assert_eq!(drawn.times.points_read, want.points_read());
    // Each stage lasts from the end of the one before to its own end; it is NaN where the device cannot time.
    let (sum, whole) = (drawn.times.stage_ms.iter().sum::<f32>(), drawn.times.gpu_ms);
    assert!(whole.is_nan() || (sum - whole).abs() <= 1e-3 * whole, "stages {sum} ms, frame {whole} ms");
    drawn
}

#[test]
fn stereo_frame_equals_its_reference() {
    let cloud = cloud_of(&random_points(60_001, 10.0, 1), 0.001, DVec3::new(5e5, 4e6, 100.0), Order::Morton);
    let center = cloud.bounds.center();
    for (distance, full) in [(30.0, false), (30.0, true), (0.3, false), (3000.0, false)] {
        let view = stereo(center - DVec3::new(distance, 0.4, 0.2), center, [333, 217]);
        let drawn = assert_reference(&cloud, &view, full, 0);
        assert_ne!(drawn.keys[0], drawn.keys[1], "the eyes see different pictures");
    }
}

/// The scans are a made-up courtyard from where people stand, and a real room where there is one.
#[test]
fn whole_scans_equal_their_reference() {
    let cloud = sorted(&made_up(SynthKind::Terrestrial, 300_000));
    for place in synth::viewpoints(SynthKind::Terrestrial) {
        assert_reference(&cloud, &stereo(place.eye, place.target, [401, 399]), false, 0);
    }
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn a_real_room_equals_its_reference() {
    let room = sorted(&real_scans::read_in(&real_scans::folder(), ROOM).expect("a scan"));
    let inside = stereo(DVec3::new(6.0, 5.0, 2.4), DVec3::new(9.0, 8.0, 2.2), [501, 503]);
    let drawn = assert_reference(&room, &inside, false, 0);
    assert!(drawn.times.points_read > 100_000);
}

fn sorted(scan: &Scan) -> Cloud {
    cloud::build(scan, &Progress::hidden()).expect("a cloud")
}

#[test]
fn one_eye_equals_its_reference_in_file_order() {
    let cloud = cloud_of(&random_points(30_000, 3.0, 2), 0.01, DVec3::ZERO, Order::Original);
    let center = cloud.bounds.center();
    let mut view = stereo(center - DVec3::Y * 5.0, center, [64, 65]);
    view.eyes.truncate(1);
    assert_reference(&cloud, &view, true, 0);
}

#[test]
fn chunks_change_nothing() {
    let cloud = cloud_of(&random_points(100_000, 10.0, 3), 0.001, DVec3::ZERO, Order::Morton);
    let center = cloud.bounds.center();
    let view = stereo(center - DVec3::X * 15.0, center, [257, 129]);
    let whole = assert_reference(&cloud, &view, false, 0);
    let cut = assert_reference(&cloud, &view, false, 4 * 25_000);
    let buffers = |limit| CloudBuffers::upload(&gpu(), &cloud, limit, &Progress::hidden()).expect("upload");
    assert!(buffers(4 * 25_000).num_chunks() > 3 && buffers(0).num_chunks() == 1);
    assert!(whole.keys == cut.keys);
}

#[test]
fn cull_equals_its_reference() {
    let cloud = cloud_of(&random_points(400_000, 50.0, 4), 0.001, DVec3::new(-2e5, 7e6, 0.0), Order::Morton);
    let center = cloud.bounds.center();
    let view = stereo(center + DVec3::new(20.0, 5.0, 1.0), center + DVec3::new(60.0, 40.0, 3.0), [640, 480]);
    let drawn = draw(&cloud, &view, false, 0);
    let uniform = ViewUniform::new(&view, &cloud.split, &SAMPLE_DETAIL);
    let scene = ReferenceCloud::flat(&cloud);
    let batches = &scene.batches;
    let cull = |view: &ViewUniform| reference::cull::cull(view, 2, batches, &scene.nodes, &[DRAWN_WHOLE]);
    let want = cull(&uniform);
    assert_eq!(drawn.visible, want, "visible batches, bit for bit");
    assert!(
        want.len() > 1 && want.len() < batches.len(),
        "some are culled: {} of {}",
        want.len(),
        batches.len()
    );
    let precisions: Vec<u32> = want.iter().map(|v| v.flags & VISIBLE_PLANES).collect();
    assert!(precisions.contains(&1) && precisions.contains(&2), "both precisions occur");
    // A batch that neither eye sees has no point that would be drawn.
    let everything: Vec<VisibleBatch> = batches.iter().map(|b| forced_visible(&uniform, b)).collect();
    let full = ViewUniform { forced_planes: ALL_PLANES, ..uniform };
    let keys = |visible: &[VisibleBatch]| {
        let mut keys = vec![reference::clear::pixels(guarded([640, 480]), reference::clear::EMPTY); 2];
        let planes = [&cloud.planes[0][..], &cloud.planes[1], &cloud.planes[2]];
        reference::points::points(&full, 2, visible, planes, None, false, &mut |put| {
            reference::depth::key(&mut keys, put)
        });
        keys
    };
    assert!(keys(&everything) == keys(&cull(&full)));
}

/// The batch as `cull` would pass it on if both eyes saw it: by a view that looks everywhere.
fn forced_visible(view: &ViewUniform, batch: &GpuBatch) -> VisibleBatch {
    let mut everywhere = ViewUniform { forced_planes: ALL_PLANES, ..*view };
    for eye in &mut everywhere.eyes {
        eye.row_x = [0.0, 0.0, 0.0, 1.0];
        eye.row_y = [0.0, 0.0, 0.0, 1.0];
        eye.row_w = [0.0, 0.0, 0.0, 1.0];
    }
    reference::cull::cull(&everywhere, 2, std::slice::from_ref(batch), &[GpuNode::FLAT], &[DRAWN_WHOLE])[0]
}

/// The comparison above can fail: one point moved by one cell in the deepest plane shows.
#[test]
fn the_comparison_notices_a_wrong_point() {
    let cloud = cloud_of(&random_points(20_000, 3.0, 5), 0.001, DVec3::ZERO, Order::Morton);
    let center = cloud.bounds.center();
    let view = stereo(center - DVec3::Y * 6.0, center, [128, 128]);
    let good = draw(&cloud, &view, true, 0);
    let mut wrong = cloud.clone();
    let index =
        good.keys[0].iter().find(|&&p| p != reference::clear::EMPTY).map(|&p| (p as u32 >> 1) as usize);
    let index = index.expect("something is drawn");
    wrong.planes[0][index] ^= 1 << 9;
    wrong.colors[index] ^= 1;
    let want = reference::frame(&ReferenceCloud::flat(&wrong), &view, &plain(true), None);
    assert_ne!(good.keys[0], want.keys[0]);
    assert_ne!(good.pixels[0], want.pixels[0]);
}
