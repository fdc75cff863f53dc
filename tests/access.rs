//! How shaders reach memory changes no bit of the picture: early-z's look by a plain load, and shaders without checks.

mod support;

use scanwalk::cloud::octree::build_octree;
use scanwalk::config::{Dilate, Quality};
use scanwalk::gpu::Atomics;
use scanwalk::gpu::stage::Bindings;
use scanwalk::layout::{Detail, Variant};
use scanwalk::look::{Look, RINGS_REACH_PX};
use scanwalk::method::{Access, Method};
use scanwalk::progress::Progress;
use scanwalk::render::shaders::source;
use scanwalk::synth::{self, Kind};
use scanwalk::twin::{self, Scene};
use support::{Canvas, gpu, made_up, stereo};

#[test]
fn plain_looks_and_unchecked_shaders_draw_the_twins_picture() {
    let octree = build_octree(&made_up(Kind::Terrestrial, 60_000), &Progress::hidden(), &mut |_, _| ());
    let octree = octree.expect("an octree");
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
            for (plain_looks, checked) in [(true, true), (false, false), (true, false)] {
                if atomics > gpu().atomics() {
                    continue;
                }
                let access = Access { plain_looks, checked };
                let drawn = Canvas::layered(&octree, &view, Look { access, ..look }, atomics, 0).draw(&view);
                assert!(drawn.pixels == want.pixels, "{quality:?} {atomics:?} {access:?}: pixels");
                assert!(drawn.images == want.images, "{quality:?} {atomics:?} {access:?}: images");
            }
        }
    }
}

/// Where many points meet in few pixels, what a look sees is out of date most often.
#[test]
fn plain_looks_lose_no_point_where_points_crowd() {
    let octree = build_octree(&made_up(Kind::Terrestrial, 200_000), &Progress::hidden(), &mut |_, _| ());
    let octree = octree.expect("an octree");
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
            (Bindings::of(shader, &text, "main"), text)
        });
        assert_ne!(atomic.0, plain.0, "{shader}");
        assert!(plain.1.contains("seen_left") && !atomic.1.contains("seen_left"), "{shader}");
    }
}
