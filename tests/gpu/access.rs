//! How shaders reach memory changes no bit of the picture: early-z's look by a plain load, shaders without checks, and wide
//! points that threads draw together or alone.

use base::task::Progress;
use cloud::octree::{Octree, build_octree};
use kit::frames::{Canvas, gpu, made_up, stereo};
use lab::synth::{self, Kind};
use lab::twin::{self, Scene};
use render::bindings::Geometry;
use render::gpu::Atomics;
use render::gpu::readback;
use render::gpu::stage::Bindings;
use render::layout::{Counts, Detail, Variant};
use render::options::{Dilate, Quality};
use render::shaders::source;
use render::{Access, Method};
use render::{Look, RINGS_REACH_PX};

fn courtyard(num_points: u64) -> Octree {
    let scan = made_up(Kind::Terrestrial, num_points);
    build_octree(&scan, &Progress::hidden()).expect("an octree")
}

#[test]
fn all_ways_to_memory_draw_the_twins_picture() {
    let octree = courtyard(60_000);
    let place = synth::viewpoints(Kind::Terrestrial)[1];
    let view = stereo(place.eye, place.target, [203, 155]);
    let detail = Detail { fade: true, fill_reach_px: Some(RINGS_REACH_PX), ..Detail::default() };
    for quality in [Quality::Closest, Quality::Hqs] {
        let look = Look { quality, dilate: Dilate::Rings, detail, ..Look::default() };
        let want = twin::frame(&Scene::layered(&octree), &view, &look, None);
        assert_ne!(
            want.pixels[0], want.pixels[1],
            "the comparison can fail: the eyes see different pictures"
        );
        for atomics in [Atomics::Int32, Atomics::Int64Minmax, Atomics::Int64] {
            for (plain_looks, checked, together) in
                [(true, true, true), (false, false, true), (true, false, false), (false, true, true)]
            {
                if atomics > gpu().atomics() {
                    continue;
                }
                let access = Access { plain_looks, checked, together: Some(together) };
                let drawn = Canvas::layered(&octree, &view, Look { access, ..look }, atomics, 0).draw(&view);
                assert!(drawn.pixels == want.pixels, "{quality:?} {atomics:?} {access:?}: pixels");
                assert!(drawn.images == want.images, "{quality:?} {atomics:?} {access:?}: images");
            }
        }
    }
}

/// What is asked for and drawn is counted alike, whoever draws it: `bench` tells it.
#[test]
fn wide_points_are_counted_once_whoever_draws_them() {
    let octree = courtyard(60_000);
    let place = synth::viewpoints(Kind::Terrestrial)[1];
    let view = stereo(place.eye, place.target, [303, 255]);
    let detail = Detail { fade: true, fill_reach_px: Some(RINGS_REACH_PX), ..Detail::default() };
    // Without a look every pixel is asked for, in any order.
    let look = Look { method: Method::AtomicMin, detail, ..Look::default() };
    let counts = |together| {
        let access = Access { together: Some(together), ..Access::default() };
        let mut canvas = Canvas::counting(&octree, &view, Look { access, ..look });
        let drawn = canvas.draw(&view);
        assert!(drawn.times.visible_batches > 0);
        let buffer = canvas.renderer.counts().expect("a renderer that counts");
        let bins = readback::read_buffer(&canvas.gpu, buffer).expect("counts");
        let bins: Vec<Counts> = bytemuck::pod_collect_to_vec(&bins);
        bins.iter().fold((0, 0), |(drawn, asked), bin| (drawn + bin.num_drawn, asked + bin.num_asked))
    };
    let alone = counts(false);
    assert_eq!(counts(true), alone);
    assert!(alone.1 > 20 * alone.0, "discs are wide: {alone:?}");
}

/// Where many points meet in few pixels, what a look sees is out of date most often.
#[test]
fn plain_looks_lose_no_point_where_points_crowd() {
    let octree = courtyard(200_000);
    let place = synth::viewpoints(Kind::Terrestrial)[0];
    let view = stereo(place.eye, place.target, [23, 17]);
    // All of them, thirty layers thick.
    let detail = Detail { threshold_px: [0.01; 3], ..Detail::default() };
    for method in [Method::Prefetch, Method::EarlyZ, Method::ReduceEarlyZ] {
        let draw = |plain_looks| {
            let access = Access { plain_looks, ..Access::default() };
            let look = Look { method, detail, access, ..Look::default() };
            Canvas::layered(&octree, &view, look, gpu().atomics(), 0).draw(&view).keys
        };
        let atomic = draw(false);
        for _ in 0..3 {
            assert!(draw(true) == atomic, "{}", method.name());
        }
    }
}

/// The setting reaches the shader: with plain looks it binds the targets a second time.
#[test]
fn plain_looks_are_another_shader() {
    for shader in ["depth", "depth32", "reduce"] {
        let [atomic, plain] = [false, true].map(|plain_looks| {
            let text = source(shader, Variant { plain_looks, ..Variant::eyes(2) });
            (Bindings::<Geometry>::of(shader, &text, "main"), text)
        });
        assert_ne!(atomic.0, plain.0, "{shader}");
        assert!(plain.1.contains("seen_left") && !atomic.1.contains("seen_left"), "{shader}");
    }
}
