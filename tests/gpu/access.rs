//! How shaders reach memory changes no bit of the picture: early-z's plain load, shaders without checks, and wide
//! points that threads draw together or alone.

use base::space::View;
use base::task::Progress;
use cloud::octree::Octree;
use kit::frames::{
    Canvas, Drawn, SAMPLE_DETAIL, gpu, inside, made_up, octree_of, sample_options, sizes, spt_of, stereo,
    tiers,
};
use lab::reference::{self, ReferenceCloud};
use lab::synth::{self, SynthKind};
use lab::technique::counts::Counts;
use lab::technique::{EarlyZLoad, LabTechnique, Method, texts, tree};
use render::Access;
use render::gpu::Atomics;
use render::gpu::readback;
use render::layout::{Detail, Variant};
use render::options::{Dilate, Quality};
use render::shaders::source;
use render::{CloudBuffers, DrawOptions, RINGS_REACH_PX};

fn courtyard(num_points: u64) -> Octree {
    octree_of(&made_up(SynthKind::Terrestrial, num_points))
}

fn draw(
    octree: &Octree,
    view: &View,
    options: DrawOptions,
    atomics: Atomics,
    technique: LabTechnique,
) -> Drawn {
    Canvas::layered_by(technique, octree, view, options, atomics, 0).draw(view)
}

#[test]
fn all_ways_to_memory_draw_the_references_picture() {
    let octree = courtyard(60_000);
    let view = inside([203, 155]);
    let detail = Detail { fade: true, fill_reach_px: Some(RINGS_REACH_PX), ..SAMPLE_DETAIL };
    for quality in [Quality::Closest, Quality::Hqs] {
        let options = DrawOptions { quality, dilate: Dilate::Rings, detail, ..sample_options() };
        let want = reference::frame(&ReferenceCloud::layered(&octree), &view, &options, None);
        assert_ne!(
            want.pixels[0], want.pixels[1],
            "the comparison can fail: the eyes see different pictures"
        );
        for atomics in tiers() {
            for (early_z_load, checked, together) in [
                (EarlyZLoad::Plain, true, true),
                (EarlyZLoad::Atomic, false, true),
                (EarlyZLoad::Plain, false, false),
                (EarlyZLoad::Atomic, true, true),
            ] {
                let access = Access { checked, together: Some(together) };
                let technique = LabTechnique { early_z_load, ..LabTechnique::OWN };
                let drawn = draw(&octree, &view, DrawOptions { access, ..options }, atomics, technique);
                assert!(
                    drawn.pixels == want.pixels,
                    "{quality:?} {atomics:?} {technique:?} {access:?}: pixels"
                );
                assert!(
                    drawn.images == want.images,
                    "{quality:?} {atomics:?} {technique:?} {access:?}: images"
                );
            }
        }
    }
}

/// The counts of points drawn and of pixels asked for, which `bench` tells, do not depend on whether threads draw
/// together or alone.
#[test]
fn wide_points_are_counted_once_whoever_draws_them() {
    let octree = courtyard(60_000);
    let view = inside([303, 255]);
    let detail = Detail { fade: true, fill_reach_px: Some(RINGS_REACH_PX), ..SAMPLE_DETAIL };
    // A method without a look asks for every pixel, in any order.
    let options = DrawOptions { detail, ..sample_options() };
    let counts = |together| {
        let access = Access { together: Some(together), ..Access::default() };
        let technique = LabTechnique::method(Method::AtomicMin);
        let (mut canvas, bins) =
            Canvas::counting(&octree, &view, DrawOptions { access, ..options }, technique);
        let drawn = canvas.draw(&view);
        assert!(drawn.times.visible_batches > 0);
        let bins = readback::read_buffer(&canvas.gpu, &bins).expect("counts");
        let bins: Vec<Counts> = bytemuck::pod_collect_to_vec(&bins);
        bins.iter().fold((0, 0), |(drawn, asked), bin| (drawn + bin.num_drawn, asked + bin.num_asked))
    };
    let alone = counts(false);
    assert_eq!(counts(true), alone);
    assert!(alone.1 > 20 * alone.0, "discs are wide: {alone:?}");
}

/// A look at a pixel is out of date most often where many points meet in few pixels.
#[test]
fn plain_loads_lose_no_point_where_points_crowd() {
    let octree = courtyard(200_000);
    let place = synth::viewpoints(SynthKind::Terrestrial)[0];
    let view = stereo(place.eye, place.target, [23, 17]);
    // All points are drawn, thirty layers thick.
    let detail = Detail { threshold_px: [0.01; 3], ..SAMPLE_DETAIL };
    for method in [Method::Prefetch, Method::EarlyZ, Method::ReduceEarlyZ] {
        let draw = |early_z_load| {
            let options = DrawOptions { detail, ..sample_options() };
            let technique = LabTechnique { early_z_load, ..LabTechnique::method(method) };
            draw(&octree, &view, options, gpu().atomics(), technique).keys
        };
        let atomic = draw(EarlyZLoad::Atomic);
        for _ in 0..3 {
            assert!(draw(EarlyZLoad::Plain) == atomic, "{}", method.name());
        }
    }
}

/// A technique of trees binds a tree's buffers, which an octree lacks: that is told before anything is drawn.
#[test]
fn a_cloud_that_lacks_what_a_technique_binds_is_refused() {
    let view = inside([23, 17]);
    let mut canvas =
        Canvas::on(gpu(), &sizes(&view), sample_options(), gpu().atomics(), LabTechnique::tree(1.0));
    let upload = |octree: &Octree| CloudBuffers::upload_layered(&gpu(), octree, 0, &Progress::hidden());
    let refused = canvas.renderer.set_cloud(upload(&courtyard(1000)).expect("room"));
    let words = refused.expect_err("an octree is no tree of discs").to_string();
    assert!(words.contains("it binds 'tree', which nobody has"), "{words}");
    let tree = spt_of(&made_up(SynthKind::Terrestrial, 1000), false);
    let buffers = tree::upload(&gpu(), &tree, 0, &Progress::hidden()).expect("room");
    assert!(canvas.renderer.set_cloud(buffers).is_ok());
}

/// The setting reaches the shader: with plain loads it binds the targets a second time.
#[test]
fn plain_loads_are_another_shader() {
    for (shader, method) in
        [("depth", Method::Prefetch), ("depth32", Method::Prefetch), ("depth", Method::Reduce)]
    {
        let [atomic, plain] = [EarlyZLoad::Atomic, EarlyZLoad::Plain].map(|early_z_load| {
            let technique = LabTechnique { early_z_load, ..LabTechnique::method(method) };
            let texts = texts(&technique, false, true);
            source(shader, Variant { texts, ..Variant::eyes(2) })
        });
        assert!(plain.contains("_left_again") && !atomic.contains("_left_again"), "{shader}");
    }
}
