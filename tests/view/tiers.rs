//! Every tier of atomics draws the same picture in every mode, and Vulkan's validation layer, with synchronisation
//! validation, has nothing to say.

use crate::scene::Scene;
use crate::xr_support::Lab;
use std::path::Path;

/// Options of pictures that go through different shaders.
const MODES: [(&str, &[&str]); 5] = [
    ("closest, flat", &[]),
    ("hqs, flat", &["--quality", "hqs"]),
    ("closest, layered, rings", &["--quality", "closest", "--lod", "on", "--dilate", "rings"]),
    ("hqs, layered", &["--quality", "hqs", "--lod", "on"]),
    ("the whole frame", &["--preset", "quality"]),
];

#[test]
fn tiers_draw_the_same_picture_and_validation_is_silent() {
    let Some(lab) = Lab::enter() else { return };
    let scene = Scene::get();
    let scan = scene.courtyard.to_str().expect("UTF-8");
    let mut pictures = Vec::new();
    for (mode, options) in MODES {
        let drawn = ["int64", "int64-minmax", "int32"].map(|tier| {
            let out = scene.file(&format!("{tier}.png"));
            let tier_setting = format!("gpu.tier={tier}");
            let place = ["--stereo", "--size", "301x203", "--eye", "499994.8,3999998.5,101.75"];
            let to = ["--target", "500004,4000002,102.3", "--set", &tier_setting];
            let args =
                [&["render", scan, "-o", out.to_str().expect("UTF-8")], &place[..], &to, options].concat();
            let done =
                lab.runtime().validate().timeout_s(120).run(Path::new(env!("CARGO_BIN_EXE_scanwalk")), &args);
            done.assert_ok();
            assert_eq!(done.vulkan_complaints(), Vec::<String>::new(), "{mode}, {tier}");
            ["left", "right"]
                .map(|side| std::fs::read(out.with_extension(format!("{side}.png"))).expect("a picture"))
        });
        assert!(drawn[0] == drawn[1] && drawn[0] == drawn[2], "{mode}: the tiers' pictures differ");
        pictures.push(drawn.into_iter().next());
    }
    // The comparison can fail: no two modes draw the same.
    for (i, picture) in pictures.iter().enumerate() {
        assert!(!pictures[..i].contains(picture), "{} draws what another mode draws", MODES[i].0);
    }
}
