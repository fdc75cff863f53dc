//! Every tier of atomics draws the same picture in every mode, and Vulkan's validation layer, with synchronization
//! validation, has nothing to say.

use crate::PROGRAM;
use crate::scene::ViewedScans;
use kit::xr::TestRuntime;
use lab::technique::Method;
use render::options::Quality;
use std::path::Path;

/// Options of pictures that go through different shaders.
const MODES: [(&str, &[&str]); 3] = [
    ("closest, layered, rings", &["--quality", "closest", "--lod", "on", "--dilate", "rings"]),
    ("hqs, layered", &["--quality", "hqs", "--lod", "on"]),
    ("the whole frame", &["--preset", "quality"]),
];

/// Both eyes' pictures of the courtyard, as files, under validation.
fn draw(runtime: &TestRuntime, scene: &ViewedScans, options: &[&str]) -> [Vec<u8>; 2] {
    let scan = scene.courtyard.to_str().expect("UTF-8");
    let out = scene.file(&format!("{}.png", options.concat().replace(['=', '/'], "-")));
    let place = ["--stereo", "--size", "301x203", "--eye", "499994.8,3999998.5,101.75"];
    let to = ["--target", "500004,4000002,102.3"];
    let args = [&["render", scan, "-o", out.to_str().expect("UTF-8")], &place[..], &to, options].concat();
    let done = runtime.clone().validate().timeout_s(120).run(Path::new(PROGRAM), &args);
    done.assert_ok();
    assert_eq!(done.vulkan_complaints(), Vec::<String>::new(), "{options:?}");
    ["left", "right"].map(|side| std::fs::read(out.with_extension(format!("{side}.png"))).expect("a picture"))
}

/// The papers' methods draw the same too. So do point trees among themselves, whose picture is another.
#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn methods_draw_the_same_picture_and_validation_is_silent() {
    let runtime = TestRuntime::drivers();
    let scene = ViewedScans::get();
    let plain = ["--preset", "plain", "--method"];
    let [nearest, blended] =
        ["closest", "hqs"].map(|quality| draw(&runtime, scene, &["--preset", "plain", "--quality", quality]));
    assert!(nearest != blended, "the comparison can fail");
    for method in Method::ALL {
        let drawn = draw(&runtime, scene, &[&plain[..], &[method.name()]].concat());
        let want = if method.quality() == Some(Quality::Hqs) { &blended } else { &nearest };
        // A pixel near the scanner gets more points than hqs1 can count, and points that are equally far away for
        // fixed40.
        let is_exact = !method.shows_the_last() && !matches!(method, Method::Hqs1 | Method::Fixed40);
        assert!(!is_exact || drawn == *want, "{}", method.name());
    }
    for quality in ["closest", "hqs"] {
        let discs = draw(&runtime, scene, &["--lod", "spt", "--quality", quality]);
        assert!(discs != nearest && discs != blended);
    }
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn tiers_draw_the_same_picture_and_validation_is_silent() {
    let runtime = TestRuntime::drivers();
    let scene = ViewedScans::get();
    let mut pictures = Vec::new();
    for (mode, options) in MODES {
        let drawn = ["int64", "int64-minmax", "int32"].map(|tier| {
            let tier_setting = format!("gpu.tier={tier}");
            draw(&runtime, scene, &[&["--set", &tier_setting], options].concat())
        });
        assert!(drawn[0] == drawn[1] && drawn[0] == drawn[2], "{mode}: the tiers' pictures differ");
        pictures.push(drawn.into_iter().next());
    }
    // The comparison can fail: no two modes draw the same.
    for (i, picture) in pictures.iter().enumerate() {
        assert!(!pictures[..i].contains(picture), "{} draws what another mode draws", MODES[i].0);
    }
}
