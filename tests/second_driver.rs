//! A Vulkan driver that is not Mesa's, where `SCANWALK_SECOND_DRIVER` names its manifest (`scripts/second-driver`
//! fetches SwiftShader, `scripts/test` sets the variable): scanwalk is not tied to one driver. SwiftShader has no
//! 64-bit integers in shaders and binds ten storage buffers a stage, the least that a driver of this kind may have.

use scanwalk::progress::Stop;
use scanwalk::synth::{self, Kind, SynthOptions, Viewpoint};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// The second driver's manifest; `None`, and a line that says so, where there is none.
fn second_driver() -> Option<PathBuf> {
    let manifest = std::env::var_os("SCANWALK_SECOND_DRIVER").map(PathBuf::from);
    match &manifest {
        Some(manifest) => assert!(manifest.is_file(), "{}: there is no such driver", manifest.display()),
        None => eprintln!("skipped: SCANWALK_SECOND_DRIVER names no Vulkan driver; scripts/test fetches one"),
    }
    manifest
}

/// A courtyard of few points.
fn courtyard(folder: &Path) -> PathBuf {
    let out = folder.join("courtyard.las");
    let options = SynthOptions { kind: Kind::Terrestrial, out: out.clone(), points: 50_000, seed: 3 };
    synth::write(&options, &Stop::default()).expect("a courtyard");
    out
}

/// `scanwalk render` to `out`, on the given driver or on those that the machine has.
fn render(driver: Option<&Path>, scan: &Path, place: &Viewpoint, out: &Path, more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_scanwalk"));
    let point = |p: glam::DVec3| format!("{},{},{}", p.x, p.y, p.z);
    command.arg("render").arg(scan).arg("-o").arg(out).args(["--size", "401x299"]);
    command.args(["--eye", &point(place.eye), "--target", &point(place.target)]).args(more);
    command.env_remove("RUST_LOG").stdin(Stdio::null());
    if let Some(driver) = driver {
        // The second name is for loaders from before 2022.
        command.env("VK_DRIVER_FILES", driver).env("VK_ICD_FILENAMES", driver);
    }
    command.output().expect("scanwalk starts")
}

/// The last line on stderr: drivers may say something before.
fn last_words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).lines().next_back().unwrap_or_default().to_owned()
}

#[test]
fn a_driver_without_what_is_asked_for_is_refused_in_one_sentence() {
    let Some(driver) = second_driver() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (scan, out) = (courtyard(folder.path()), folder.path().join("out.png"));
    let place = &synth::viewpoints(Kind::Terrestrial)[0];
    let refused = render(Some(&driver), &scan, place, &out, &["--set", "gpu.tier=int64"]);
    let words = last_words(&refused);
    assert_eq!(refused.status.code(), Some(1), "{words}");
    assert!(words.contains("'SwiftShader") && words.contains("has no int64; its best is int32"), "{words}");
    assert!(!out.exists());
    // The sentence is about this driver: the machine's own draws the same picture.
    let drawn = render(None, &scan, place, &out, &["--set", "gpu.tier=int64"]);
    assert!(drawn.status.success() && out.exists(), "{}", last_words(&drawn));
}

/// The picture and the name of the GPU that drew it.
fn drawn(
    driver: Option<&Path>,
    scan: &Path,
    place: &Viewpoint,
    quality: &str,
    folder: &Path,
) -> (Vec<u8>, String) {
    let (out, metrics) = (folder.join("out.png"), folder.join("metrics.json"));
    let metrics_path = metrics.to_str().expect("a path of ours");
    let more = ["--set", "gpu.tier=int32", "--quality", quality, "--metrics", metrics_path];
    let output = render(driver, scan, place, &out, &more);
    assert!(output.status.success(), "{}", last_words(&output));
    let file = std::io::BufReader::new(std::fs::File::open(&out).expect("the picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a small picture")];
    reader.next_frame(&mut pixels).expect("a whole PNG");
    let metrics = std::fs::read(&metrics).expect("the figures");
    let metrics: serde_json::Value = serde_json::from_slice(&metrics).expect("JSON");
    (pixels, metrics["device"].as_str().expect("a name").to_owned())
}

#[test]
fn both_drivers_draw_the_same_picture() {
    let Some(driver) = second_driver() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scan = courtyard(folder.path());
    let places = synth::viewpoints(Kind::Terrestrial);
    let views = [(&places[0], "closest"), (&places[1], "closest"), (&places[1], "hqs")];
    let pictures = views.map(|(place, quality)| {
        let (own, own_name) = drawn(None, &scan, place, quality, folder.path());
        let (second, second_name) = drawn(Some(&driver), &scan, place, quality, folder.path());
        assert!(second_name.contains("SwiftShader") && !own_name.contains("SwiftShader"));
        assert!(own == second, "{}, {quality}: {own_name} and {second_name} differ", place.name);
        second
    });
    // The comparison can fail: places and qualities differ.
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2]);
}
