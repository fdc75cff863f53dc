//! Settings: the default file is the defaults, and every mistake is named with its place and the way out.

use scanwalk::config::{Config, ConfigError, Mirror, Precision, load};
use std::path::PathBuf;

const DEFAULT_TOML: &str = include_str!("../config/default.toml");

fn sets(sets: &[&str]) -> Result<Config, ConfigError> {
    load(None, &sets.iter().map(|set| (*set).to_owned()).collect::<Vec<_>>())
}

/// Loads `text` as the file `walk.toml`; the complaint has the folder cut off.
fn complaint(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.toml");
    std::fs::write(&path, text).unwrap();
    let error = load(Some(&path), &[]).expect_err("this must be refused").to_string();
    error.replace(&format!("{}/", folder.path().display()), "")
}

/// Keys that `default.toml` assigns, dotted; with their comment lines counted.
fn keys_in(text: &str) -> Vec<String> {
    let table: toml::Table = text.parse().unwrap();
    let mut keys = Vec::new();
    for (section, values) in &table {
        keys.extend(values.as_table().unwrap().keys().map(|key| format!("{section}.{key}")));
    }
    keys
}

#[test]
fn the_default_file_is_the_defaults() {
    let parsed: Config = toml::from_str(DEFAULT_TOML).unwrap();
    assert_eq!(parsed, Config::default());
    assert_eq!(keys_in(DEFAULT_TOML), Config::keys(), "every key appears, and no other");
    // The comparison can fail.
    let shorter: String = DEFAULT_TOML
        .lines()
        .filter(|line| !line.starts_with("snap_deg"))
        .fold(String::new(), |text, line| text + line + "\n");
    assert_ne!(keys_in(&shorter), Config::keys());
    let other: Config = toml::from_str(&DEFAULT_TOML.replace("near_m = 0.05", "near_m = 0.06")).unwrap();
    assert_ne!(other, Config::default());
}

#[test]
fn every_default_has_a_comment() {
    let lines: Vec<&str> = DEFAULT_TOML.lines().collect();
    for (above, line) in lines.iter().zip(&lines[1..]) {
        assert!(!line.contains(" = ") || line.starts_with('#') || above.starts_with("# "), "{line}");
    }
}

#[test]
fn the_command_line_wins_over_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.toml");
    std::fs::write(&path, "frame.near_m = 0.2\n[window]\nmirror = \"both\"\n").unwrap();
    let config = load(Some(&path), &["frame.near_m=0.3".into(), "frame.near_m=0.4".into()]).unwrap();
    assert_eq!((config.frame.near_m, config.window.mirror), (0.4, Mirror::Both));
    assert_eq!(config.simulated, Config::default().simulated, "the rest stays");
}

#[test]
fn values_on_the_command_line_are_toml_or_text() {
    let config = sets(&[
        "gpu.adapter=AMD Radeon (navi21)",
        "frame.background=[1, 2, 3]",
        "frame.precision=full",
        "simulated.refresh_hz = 72",
        "window.panel=false",
    ])
    .unwrap();
    assert_eq!(config.gpu.adapter, "AMD Radeon (navi21)");
    assert_eq!(config.frame.background, [1, 2, 3]);
    assert_eq!(config.frame.precision, Precision::Full);
    assert_eq!(config.simulated.refresh_hz, 72.0);
    assert!(!config.window.panel);
}

#[test]
fn unknown_keys_name_line_and_nearest_key() {
    for (text, expected) in [
        (
            "[frame]\nnear_m = 1.0\nnaer_m = 1.0\n",
            "walk.toml, line 3: there is no setting 'frame.naer_m'; did you mean 'frame.near_m'?",
        ),
        (
            "\n[fram]\nnear_m = 1.0\n",
            "walk.toml, line 3: there is no setting 'fram.near_m'; did you mean 'frame.near_m'?",
        ),
        ("near_m = 1.0\n", "walk.toml, line 1: there is no setting 'near_m'; did you mean 'frame.near_m'?"),
        (
            "frame.near_m.x = 1\n",
            "walk.toml, line 1: frame.near_m must be a number, not the section { x = 1 }",
        ),
        ("[windows]\n", "walk.toml, line 1: there is no setting 'windows'; did you mean 'window.size'?"),
    ] {
        assert_eq!(complaint(text), expected);
    }
    let error = sets(&["frame.nearm=1"]).unwrap_err();
    assert!(error.is_usage());
    assert_eq!(
        error.to_string(),
        "--set frame.nearm=1: there is no setting 'frame.nearm'; did you mean 'frame.near_m'?"
    );
    assert!(sets(&["frame=1"]).is_err(), "a section is no key");
    assert!(sets(&["frame.near_m"]).unwrap_err().to_string().contains("KEY=VALUE"));
}

#[test]
fn wrong_types_name_what_is_wanted() {
    for (text, expected) in [
        (
            "[frame]\nnear_m = \"far\"\n",
            "walk.toml, line 2: frame.near_m must be a number, not the text \"far\"",
        ),
        ("gpu.adapter = 3", "walk.toml, line 1: gpu.adapter must be a text in quotes, not 3"),
        (
            "gpu.chunk_mib = -1",
            "walk.toml, line 1: gpu.chunk_mib must be a whole number from 0 to 4294967295, not -1",
        ),
        ("window.panel = 1", "walk.toml, line 1: window.panel must be true or false, not 1"),
        (
            "frame.background = [0, 0, 256]",
            "walk.toml, line 1: frame.background must be a list of 3 whole numbers from 0 to 255, not the list [0, 0, 256]",
        ),
        (
            "window.size = [1]",
            "walk.toml, line 1: window.size must be a list of 2 whole numbers from 0 to 4294967295, not the list [1]",
        ),
        (
            "window.mirror = \"middle\"",
            "walk.toml, line 1: window.mirror must be one of \"left\", \"right\", \"both\", not the text \"middle\"",
        ),
        (
            "cloud.order = \"hilbert\"",
            "walk.toml, line 1: cloud.order must be \"original\" or \"morton\", not the text \"hilbert\"",
        ),
    ] {
        assert_eq!(complaint(text), expected);
    }
}

#[test]
fn values_out_of_range_are_refused_with_their_place() {
    for set in [
        "frame.near_m=0",
        "frame.near_m=nan",
        "frame.near_m=inf",
        "headset.resolution_scale=-1",
        "simulated.size_px=[0, 10]",
        "simulated.size_px=[10, 100000]",
        "simulated.refresh_hz=0",
        "simulated.fov_deg=[45, 45, 45, 90]",
        "simulated.fov_deg=[-40, 40, 45, 45]",
        "simulated.eye_distance_m=-0.1",
        "simulated.cant_deg=1e9",
        "simulated.eye_height_m=inf",
        "locomotion.speed=-1",
        "locomotion.fast=0",
        "locomotion.snap_deg=0",
        "locomotion.look_deg_per_px=nan",
        "window.size=[0, 0]",
    ] {
        let error = sets(&[set]).expect_err(set);
        assert!(matches!(error, ConfigError::OutOfRange { .. }), "{set}: {error}");
        assert!(error.to_string().starts_with(&format!("--set {set}: {}", set.split('=').next().unwrap())));
    }
    assert!(complaint("\n\nframe.near_m = -1").starts_with("walk.toml, line 3: frame.near_m is -1, but"));
    // An asymmetric field of view, whose inner half looks outwards, is no mistake.
    assert!(sets(&["simulated.fov_deg=[60, -10, 45, 45]"]).is_ok());
}

#[test]
fn files_that_are_no_configuration() {
    assert!(complaint("[frame\nnear_m = 1").starts_with("walk.toml, line 1: this is not TOML: "));
    assert!(complaint("a = 1\na = 2").starts_with("walk.toml, line 2: this is not TOML: "));
    assert!(complaint(&"[".repeat(100_000)).contains("this is not TOML"));
    assert!(complaint(&format!("x = {}", "[".repeat(100_000))).contains("this is not TOML"));
    for path in ["no/such/file.toml", ".", "/dev/zero"] {
        let error = load(Some(&PathBuf::from(path)), &[]).expect_err(path);
        assert!(!error.is_usage(), "{path}: it could not be read, which is no misuse");
        assert!(error.to_string().contains(path), "{error}");
    }
}

#[test]
fn digests_tell_configurations_apart() {
    let digest = Config::default().digest();
    assert_eq!(digest.len(), 16);
    assert_eq!(digest, sets(&[]).unwrap().digest(), "the same settings, the same digest");
    assert_ne!(digest, sets(&["frame.near_m=0.051"]).unwrap().digest());
    assert_ne!(digest, sets(&["gpu.adapter=x"]).unwrap().digest());
}
