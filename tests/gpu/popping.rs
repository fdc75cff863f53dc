//! Points of a node that level of detail adds appear one by one: no patch of the picture changes at once, as it
//! does without fading.
//!
//! The head stands still, and level of detail goes on as if the head walked, so that all changes are by level of
//! detail. (On a walk, points that come from behind others change more than that; `benches/quality` has both.)

use base::space::{Eye, Fov, Pose, View};
use base::task::Progress;
use cloud::octree::{Octree, build_octree};
use kit::frames::{Canvas, gpu};
use lab::synth::{self, SynthKind, Viewpoint};
use render::layout::Detail;
use render::options::{Dilate, Quality};
use render::{DrawOptions, RINGS_REACH_PX};

const SIZE_PX: u32 = 256;
/// Thresholds at which nodes of this scan come up while they fall.
const THRESHOLD_PX: [f32; 3] = [120.0, 240.0, 360.0];
/// Edge of the patches that are compared from frame to frame.
const PATCH_PX: usize = 16;
const NUM_STEPS: u32 = 80;
/// Share of the way to what is seen that a frame takes: at 90 frames a second and 5 m, a walk of 1.1 m/s.
const STEP_SHARE: f32 = 0.0025;

fn courtyard() -> Octree {
    build_octree(&kit::frames::courtyard(), &Progress::hidden()).expect("an octree")
}

fn view(place: &Viewpoint) -> View {
    let fov = Fov { left: -0.7, right: 0.7, up: 0.7, down: -0.7 };
    let world_from_view = Pose::look_at(place.eye, place.target, glam::DVec3::Z);
    let eye = Eye { world_from_view, fov, size_px: [SIZE_PX; 2], gaze_in_view: Eye::AHEAD };
    View { eyes: vec![eye], near: 0.05 }
}

/// Mean change of a channel in the patch that changes most, 0 to 255.
fn largest_patch_change(before: &[u32], now: &[u32]) -> f64 {
    let (width, patches) = (SIZE_PX as usize, SIZE_PX as usize / PATCH_PX);
    let mut sums = vec![0u32; patches * patches];
    for (number, (a, b)) in before.iter().zip(now).enumerate() {
        let change: u32 = (0..3).map(|c| (a >> (8 * c) & 255).abs_diff(b >> (8 * c) & 255)).sum();
        sums[number / width / PATCH_PX * patches + number % width / PATCH_PX] += change;
    }
    f64::from(sums.into_iter().max().unwrap_or(0)) / (3 * PATCH_PX * PATCH_PX) as f64
}

/// The largest change from one frame to the next while thresholds fall step by step.
fn largest_pop(octree: &Octree, options: DrawOptions) -> f64 {
    let view = view(&synth::viewpoints(SynthKind::Terrestrial)[0]);
    let mut canvas = Canvas::layered(octree, &view, options, gpu().atomics(), 0);
    let mut before = canvas.draw(&view).images.remove(0);
    let mut largest = 0.0;
    for step in 1..=NUM_STEPS {
        canvas.renderer.set_lod_scale(1.0 / (1.0 + STEP_SHARE * step as f32));
        let now = canvas.draw(&view).images.remove(0);
        largest = f64::max(largest, largest_patch_change(&before, &now));
        before = now;
    }
    largest
}

#[test]
fn fading_keeps_patches_from_popping() {
    let octree = courtyard();
    let pop = |fade, dilate, fill_reach_px| {
        let detail = Detail { fade, fill_reach_px, threshold_px: THRESHOLD_PX, ..Detail::default() };
        let options = DrawOptions {
            quality: Quality::Hqs,
            dilate,
            background: [0; 3],
            detail,
            ..DrawOptions::default()
        };
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
    let before = vec![0; (SIZE_PX * SIZE_PX) as usize];
    let mut now = before.clone();
    assert_eq!(largest_patch_change(&before, &now), 0.0);
    now[(SIZE_PX * 17 + 40) as usize] = 0x00ff_ffff;
    assert_eq!(largest_patch_change(&before, &now), 255.0 / (PATCH_PX * PATCH_PX) as f64);
}
