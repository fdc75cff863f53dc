//! A Vulkan driver that is not Mesa's, where `SCANWALK_SECOND_DRIVER` names its manifest (`scripts/second-driver`
//! fetches SwiftShader, `scripts/test` sets the variable): scanwalk is not tied to one driver. SwiftShader has no
//! 64-bit integers in shaders and binds ten storage buffers a stage, the least that a driver of this kind may have.
//! That is enough for the whole frame, which comes out the same as Mesa's in every pixel.

use crate::PROGRAM;
use kit::frames::num_differing;
use kit::made_up;
use kit::picture::Picture;
use kit::program::{self, RunOutput};
use lab::synth::{self, SynthKind, Viewpoint};
use std::path::{Path, PathBuf};

/// The second driver's manifest. Tests that need it are ignored unless the feature `with-second-driver` says that
/// there is one.
fn second_driver() -> PathBuf {
    let manifest = std::env::var_os("SCANWALK_SECOND_DRIVER").map(PathBuf::from);
    let manifest = manifest.expect("SCANWALK_SECOND_DRIVER names a driver's manifest");
    assert!(manifest.is_file(), "{}: there is no such driver", manifest.display());
    manifest
}

/// A courtyard of few points.
fn courtyard(folder: &Path, points: u64) -> PathBuf {
    let out = folder.join("courtyard.las");
    made_up::file(&out, SynthKind::Terrestrial, points, 3).expect("a courtyard");
    out
}

/// `scanwalk render` to `out`, on the given driver or on those that the machine has.
fn render(driver: Option<&Path>, scan: &Path, place: &Viewpoint, out: &Path, more: &[&str]) -> RunOutput {
    let mut command = program::command(PROGRAM);
    let point = |p: glam::DVec3| format!("{},{},{}", p.x, p.y, p.z);
    command.arg("render").arg(scan).arg("-o").arg(out).args(["--size", "401x299"]);
    command.args(["--eye", &point(place.eye), "--target", &point(place.target)]).args(more);
    if let Some(driver) = driver {
        // The second name is for loaders from before 2022.
        command.env("VK_DRIVER_FILES", driver).env("VK_ICD_FILENAMES", driver);
    }
    program::run(&mut command)
}

/// The last line on stderr: drivers may say something before.
fn last_words(output: &RunOutput) -> &str {
    output.err.lines().next_back().unwrap_or_default()
}

#[test]
#[cfg_attr(
    not(feature = "with-second-driver"),
    ignore = "needs a second Vulkan driver, see scripts/second-driver"
)]
fn a_driver_without_what_is_asked_for_is_refused_in_one_sentence() {
    let driver = second_driver();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (scan, out) = (courtyard(folder.path(), 50_000), folder.path().join("out.png"));
    let place = &synth::viewpoints(SynthKind::Terrestrial)[0];
    let refused = render(Some(&driver), &scan, place, &out, &["--set", "gpu.tier=int64"]);
    let words = last_words(&refused);
    assert_eq!(refused.code, Some(1), "{words}");
    assert!(words.contains("'SwiftShader") && words.contains("has no int64; its best is int32"), "{words}");
    assert!(!out.exists());
    // The sentence is about this driver: the machine's own driver draws the same picture.
    let drawn = render(None, &scan, place, &out, &["--set", "gpu.tier=int64"]);
    assert!(drawn.code == Some(0) && out.exists(), "{}", last_words(&drawn));
}

/// What is compared: a place, and how it is drawn from there.
type Case<'a> = (&'a Viewpoint, &'a [&'a str]);

/// Both eyes' pixels and the name of the GPU that drew them, in the tier that each driver has.
fn drawn(driver: Option<&Path>, scan: &Path, (place, how): Case, folder: &Path) -> ([Picture; 2], String) {
    let (out, metrics) = (folder.join("out.png"), folder.join("metrics.json"));
    let metrics_path = metrics.to_str().expect("a path of ours");
    let more = [&["--stereo", "--set", "gpu.tier=int32", "--metrics", metrics_path][..], how].concat();
    let output = render(driver, scan, place, &out, &more);
    assert_eq!(output.code, Some(0), "{}", last_words(&output));
    let metrics = std::fs::read(&metrics).expect("the figures");
    let metrics: serde_json::Value = serde_json::from_slice(&metrics).expect("JSON");
    let read = |side: &str| Picture::read(&folder.join(format!("out.{side}.png"))).expect("a picture");
    (["left", "right"].map(read), metrics["device"].as_str().expect("a name").to_owned())
}

/// Number of pixels that differ, of both eyes.
fn num_different(a: &[Picture; 2], b: &[Picture; 2]) -> usize {
    a.iter().zip(b).map(|(a, b)| num_differing(&a.pixels, &b.pixels)).sum()
}

/// Draws each case on both drivers, which must agree in every pixel; gives the pictures.
fn assert_same(driver: &Path, scan: &Path, folder: &Path, cases: &[Case]) -> Vec<[Picture; 2]> {
    let compare = |&case: &Case| {
        let (own, own_name) = drawn(None, scan, case, folder);
        let (second, second_name) = drawn(Some(driver), scan, case, folder);
        assert!(second_name.contains("SwiftShader") && !own_name.contains("SwiftShader"));
        let different = num_different(&own, &second);
        eprintln!("{} {:?}: {own_name} and {second_name} differ in {different} pixels", case.0.name, case.1);
        assert_eq!(different, 0, "{} {:?}", case.0.name, case.1);
        second
    };
    cases.iter().map(compare).collect()
}

#[test]
#[cfg_attr(
    not(feature = "with-second-driver"),
    ignore = "needs a second Vulkan driver, see scripts/second-driver"
)]
fn both_drivers_draw_the_same_picture() {
    let driver = second_driver();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scan = courtyard(folder.path(), 50_000);
    let places = synth::viewpoints(SynthKind::Terrestrial);
    let [closest, hqs] = [["--quality", "closest"], ["--quality", "hqs"]];
    let cases = [(&places[0], &closest[..]), (&places[1], &hqs)];
    let pictures = assert_same(&driver, &scan, folder.path(), &cases);
    // The comparison can fail: places and qualities differ.
    for (pictured, other) in [(&pictures[0], (&places[0], &hqs[..])), (&pictures[1], (&places[0], &hqs))] {
        let (other, _) = drawn(None, &scan, other, folder.path());
        assert!(num_different(pictured, &other) > 1000);
    }
}

/// Whether `doctor` finds that a driver has subgroup operations.
fn has_subgroups(driver: &Path) -> bool {
    let mut doctor = program::command(PROGRAM);
    doctor.args(["doctor", "--json"]).env("VK_DRIVER_FILES", driver).env("VK_ICD_FILENAMES", driver);
    let checks = program::run(&mut doctor).json();
    let of = |name: &str| {
        checks.as_array().and_then(|all| all.iter().find(|check| check["check"] == name).cloned())
    };
    of("gpu subgroups").is_some_and(|check| check["found"] == "yes")
}

/// Both drivers have subgroup operations, perhaps of other sizes.
#[test]
#[cfg_attr(
    not(feature = "with-second-driver"),
    ignore = "needs a second Vulkan driver, see scripts/second-driver"
)]
fn both_drivers_draw_the_same_picture_by_every_method() {
    let driver = second_driver();
    assert!(has_subgroups(&driver));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scan = courtyard(folder.path(), 50_000);
    let place = &synth::viewpoints(SynthKind::Terrestrial)[1];
    // SwiftShader compiles a method's shaders for ten seconds. The methods that are left out are parts of these.
    let methods = ["prefetch", "reduce-early-z", "dedup", "point-list"];
    let ways = methods.map(|method| ["--preset", "plain", "--method", method]);
    let cases = ways.each_ref().map(|way| (place, &way[..]));
    let pictures = assert_same(&driver, &scan, folder.path(), &cases);
    for (picture, method) in pictures.iter().zip(methods) {
        assert_eq!(num_different(picture, &pictures[0]), 0, "{method}");
    }
    // The comparison can fail.
    let elsewhere = (&synth::viewpoints(SynthKind::Terrestrial)[0], &ways[0][..]);
    let (other, _) = drawn(None, &scan, elsewhere, folder.path());
    assert!(num_different(&other, &pictures[0]) > 1000);
}

/// Draws as a headset would get it: an octree's nodes by rings, points that fade in, splats and dilation that close
/// gaps.
#[test]
#[cfg_attr(
    not(feature = "with-second-driver"),
    ignore = "needs a second Vulkan driver, see scripts/second-driver"
)]
fn both_drivers_draw_the_same_whole_frame() {
    let driver = second_driver();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scan = courtyard(folder.path(), 400_000);
    let whole = ["--preset", "quality"];
    let closest = ["--preset", "quality", "--quality", "closest"];
    let places = synth::viewpoints(SynthKind::Terrestrial);
    let cases = [(&places[0], &whole[..]), (&places[1], &whole), (&places[1], &closest)];
    let pictures = assert_same(&driver, &scan, folder.path(), &cases);
    // Every part of the frame shows in the picture: another picture comes out without any of them.
    for without in [
        "lod.enabled=false",
        "lod.fade=false",
        "frame.fill=false",
        "frame.dilate=off",
        "frame.quality=closest",
    ] {
        let (other, _) =
            drawn(None, &scan, (&places[1], &[&whole[..], &["--set", without]].concat()), folder.path());
        let different = num_different(&pictures[1], &other);
        eprintln!("{without}: {different}");
        assert!(different > 100, "{without}: {different}");
    }
}
