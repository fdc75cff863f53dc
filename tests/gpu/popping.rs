//! Points of a node that level of detail adds appear one by one: no patch of the picture changes at once, as it
//! does without fading.
//!
//! The head stands still, and level of detail goes on as if the head walked, so that all changes are by level of
//! detail. (On a walk, points that come from behind others change more than that; `benches/quality` has both.)

use cloud::octree::Octree;
use kit::frames::{Canvas, SAMPLE_DETAIL, courtyard, gpu, mono, octree_of, sample_options};
use kit::quality::metrics::largest_patch_change;
use kit::quality::picture::EyePicture;
use lab::synth::{self, SynthKind};
use render::layout::Detail;
use render::options::{Dilate, Quality};
use render::{DrawOptions, RINGS_REACH_PX};

const SIZE_PX: u32 = 256;
/// Thresholds at which nodes of this scan come up while they fall.
const THRESHOLD_PX: [f32; 3] = [120.0, 240.0, 360.0];
const NUM_STEPS: u32 = 80;
/// Share of the way to what is seen that a frame takes: at 90 frames a second and 5 m, a walk of 1.1 m/s.
const STEP_SHARE: f32 = 0.0025;

/// The largest change from one frame to the next while thresholds fall step by step.
fn largest_pop(octree: &Octree, options: DrawOptions) -> f64 {
    let place = synth::viewpoints(SynthKind::Terrestrial)[0];
    let view = mono(place.eye, place.target, 0.7, [SIZE_PX; 2]);
    let mut canvas = Canvas::layered(octree, &view, options, gpu().atomics(), 0);
    let picture =
        |canvas: &mut Canvas| EyePicture::of_colors([SIZE_PX; 2], canvas.draw(&view).images.remove(0));
    let mut before = picture(&mut canvas);
    let mut largest = 0.0;
    for step in 1..=NUM_STEPS {
        canvas.renderer.set_lod_scale(1.0 / (1.0 + STEP_SHARE * step as f32));
        let now = picture(&mut canvas);
        largest = f64::max(largest, largest_patch_change(&before, &now));
        before = now;
    }
    largest
}

#[test]
fn fading_keeps_patches_from_popping() {
    let octree = octree_of(&courtyard());
    let pop = |fade, dilate, fill_reach_px| {
        let detail = Detail { fade, fill_reach_px, threshold_px: THRESHOLD_PX, ..SAMPLE_DETAIL };
        let options =
            DrawOptions { quality: Quality::Hqs, dilate, background: [0; 3], detail, ..sample_options() };
        largest_pop(&octree, options)
    };
    let [popped, faded] = [false, true].map(|fade| pop(fade, Dilate::Off, None));
    println!("points alone: largest change {popped:.2} without fading, {faded:.2} with");
    // The picture must pop without fading, or the test shows nothing.
    assert!(popped > 3.0, "{popped}");
    assert!(faded < 0.1 * popped, "{faded} with fading, {popped} without");
    // The sizes of points follow the thresholds, which a walk leaves alone and this test changes: they grow and shrink by
    // whole pixels here, which fading does not help.
    let whole = pop(true, Dilate::Rings, Some(RINGS_REACH_PX));
    println!("whole frame: largest change {whole:.2}");
    assert!(whole < 0.2 * popped, "{whole} in the whole frame, {popped} of points alone");
}

#[test]
fn a_patch_that_changes_is_found() {
    let mut colors = vec![0; (SIZE_PX * SIZE_PX) as usize];
    let picture = |colors: &[u32]| EyePicture::of_colors([SIZE_PX; 2], colors.iter().copied());
    let before = picture(&colors);
    assert_eq!(largest_patch_change(&before, &before), 0.0);
    colors[(SIZE_PX * 17 + 40) as usize] = 0x00ff_ffff;
    assert_eq!(largest_patch_change(&before, &picture(&colors)), 255.0 / (16 * 16) as f64);
}
