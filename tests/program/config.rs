//! Settings: the table yields the files that show them, and every mistake is named with its place and the way out.

use render::options::Precision;
use scanwalk::config::{
    Config, ConfigError, FILES, NearClip, PRESETS, Preset, Setting, ValueKind, file, load, page,
};
use scanwalk::desktop::MirroredEyes;
use scanwalk::draw::{NEAR, NEAR_SHARE};
use std::path::{Path, PathBuf};

fn sets(sets: &[&str]) -> Result<Config, ConfigError> {
    load(&[], None, &sets.iter().map(|set| (*set).to_owned()).collect::<Vec<_>>())
}

/// Loads `text` as the file `walk.toml`; returns the complaint with the folder cut off.
fn complaint(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.toml");
    std::fs::write(&path, text).unwrap();
    let error = load(&[], Some(&path), &[]).expect_err("this must be refused").to_string();
    error.replace(&format!("{}/", folder.path().display()), "")
}

/// Keys that a file assigns, dotted.
fn keys_in(text: &str) -> Vec<String> {
    let table: toml::Table = text.parse().unwrap();
    let mut keys = Vec::new();
    for (section, values) in &table {
        keys.extend(values.as_table().unwrap().keys().map(|key| format!("{section}.{key}")));
    }
    keys
}

/// A file below `config/`.
fn path_of(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("config").join(name)
}

/// The test writes the files anew with `SCANWALK_BLESS=1`.
#[test]
fn the_files_are_what_the_table_yields() {
    for (name, audience, about) in FILES {
        let text = file(audience, about);
        if std::env::var_os("SCANWALK_BLESS").is_some() {
            std::fs::write(path_of(name), &text).unwrap();
        }
        let written = std::fs::read_to_string(path_of(name)).unwrap();
        assert!(
            written == text,
            "config/{name} is not what the table says: `SCANWALK_BLESS=1 cargo test --test program config` writes it anew"
        );
        assert!(text.lines().all(|line| line.chars().count() <= 120));
    }
}

#[test]
fn the_files_are_the_defaults_and_all_of_them() {
    let texts = FILES.map(|(_, audience, about)| file(audience, about));
    let mut keys = Vec::new();
    for text in &texts {
        let parsed: Config = toml::from_str(text).unwrap();
        assert_eq!(parsed, Config::default());
        keys.extend(keys_in(text));
    }
    let mut all: Vec<&str> = Setting::all().map(|setting| setting.key).collect();
    all.sort_unstable();
    keys.sort_unstable();
    assert_eq!(keys, all, "every key once");
    // The comparison can fail.
    let other: Config = toml::from_str(&texts[0].replace("near_m = \"auto\"", "near_m = 0.05")).unwrap();
    assert_ne!(other, Config::default());
}

/// The names in quotes that a text has.
fn quoted(text: &str) -> Vec<&str> {
    text.split('"').skip(1).step_by(2).collect()
}

#[test]
fn the_meaning_of_a_choice_names_all_that_there_are() {
    let mut num_choices = 0;
    for setting in Setting::all() {
        let ValueKind::Choice(names, _) = setting.kind() else { continue };
        num_choices += 1;
        let help = setting.help();
        let mut told = quoted(&help);
        let mut names = names.to_vec();
        told.sort_unstable();
        names.sort_unstable();
        assert_eq!(told, names, "{}: {help}", setting.key);
    }
    assert!(num_choices > 8, "{num_choices}");
    assert_eq!(quoted("\"a\" or \"b\""), ["a", "b"]);
}

/// An entry of the table that lacks something is seen where people read it.
#[test]
fn meanings_are_sentences_and_numbers_have_limits() {
    for setting in Setting::all() {
        let (key, help) = (setting.key, setting.help());
        assert!(help.ends_with('.') && help.split_whitespace().count() > 2, "{key}: {help}");
        let is_number = |kind: &ValueKind| *kind == ValueKind::Number;
        let kind = setting.kind();
        let is_free = is_number(&kind) || matches!(&kind, ValueKind::List(items, _) if is_number(items));
        assert!(!is_free || setting.range.is_some(), "{key} has no range");
        let has_unit = ["_m", "_deg", "_px", "_mib", "_hz"].iter().any(|end| key.ends_with(end));
        assert!(!has_unit || !setting.unit.is_empty(), "{key} has no unit");
    }
}

/// What `auto` comes to is no value of the table.
#[test]
fn the_meaning_of_the_near_clip_says_what_auto_comes_to() {
    let help = Setting::find("frame.near_m").unwrap().help();
    let words = format!(
        "\"auto\" is {NEAR}, and less in pictures of scenes smaller than {} units",
        NEAR / NEAR_SHARE
    );
    assert!(help.contains(&words), "{help}");
}

/// Lines that assign something and have no comment above.
fn without_comment(text: &str) -> Vec<&str> {
    let lines: Vec<&str> = text.lines().collect();
    let pairs = lines.iter().zip(&lines[1..]);
    let bare = pairs
        .filter(|(above, line)| line.contains(" = ") && !line.starts_with('#') && !above.starts_with("# "));
    bare.map(|(_, line)| *line).collect()
}

#[test]
fn every_key_has_a_comment() {
    assert_eq!(without_comment(&page(&Config::default(), |_| true)), [""; 0]);
    for Preset { name, text } in PRESETS {
        assert_eq!(without_comment(text), [""; 0], "{name}");
    }
    assert_eq!(without_comment("[a]\n# yes\nb = 1\nc = 2"), ["c = 2"]);
}

fn preset(names: &[&str]) -> Result<Config, ConfigError> {
    load(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>(), None, &[])
}

#[test]
fn every_preset_is_a_configuration() {
    for Preset { name, text } in PRESETS {
        let config = preset(&[name]).unwrap_or_else(|error| panic!("{name}: {error}"));
        let keys = keys_in(text);
        assert!(keys.iter().all(|key| Setting::find(key).is_some()), "{name}: {keys:?}");
        // The preset does what its text says, and nothing else.
        let (default, table) = (Config::default().to_table(), config.to_table());
        let said: toml::Table = text.parse().unwrap();
        for Setting { section, name: word, key, .. } in Setting::all() {
            let expected = said.get(*section).and_then(|section| section.get(*word));
            assert_eq!(
                &table[*section][*word],
                expected.unwrap_or(&default[*section][*word]),
                "{name}: {key}"
            );
        }
        assert_eq!(std::fs::read_to_string(path_of(&format!("{name}.toml"))).unwrap(), text, "{name}");
    }
}

/// Presets of one kind set the same keys, so that the last one given is the one that counts.
#[test]
fn presets_of_a_kind_set_the_same_keys() {
    let keys = |name: &str| keys_in(PRESETS.iter().find(|preset| preset.name == name).unwrap().text);
    for name in ["balanced", "performance"] {
        assert_eq!(keys(name), keys("quality"));
    }
    for name in ["meta-quest-3", "bigscreen-beyond-2"] {
        assert_eq!(keys(name), keys("valve-index"));
    }
    assert_ne!(keys("valve-index"), keys("quality"));
}

#[test]
fn presets_are_applied_in_order_before_the_file_and_the_command_line() {
    let both = preset(&["performance", "valve-index"]).unwrap();
    assert_eq!((both.headset.resolution_scale, both.simulated.size_px), (0.8, [2468, 2740]));
    assert_eq!(both, preset(&["valve-index", "performance"]).unwrap());
    assert_eq!(preset(&["performance", "quality"]).unwrap(), preset(&["quality"]).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.toml");
    std::fs::write(&path, "governor.budget = 0.5\nlod.fade = false\n").unwrap();
    let config = load(&["performance".into()], Some(&path), &["lod.fade=true".into()]).unwrap();
    assert_eq!((config.governor.budget, config.lod.fade), (0.5, true));
    assert_eq!(config.headset.resolution_scale, 0.8);
}

#[test]
fn unknown_presets_are_told_the_names() {
    let error = preset(&["balanced", "ultra"]).unwrap_err();
    assert!(error.is_usage());
    assert_eq!(
        error.to_string(),
        "--preset ultra: there is no such preset; choose one of plain, quality, balanced, performance, \
         valve-index, meta-quest-3, bigscreen-beyond-2"
    );
}

#[test]
fn the_command_line_wins_over_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.toml");
    std::fs::write(&path, "frame.near_m = 0.2\n[window]\nmirror = \"both\"\n").unwrap();
    let config = load(&[], Some(&path), &["frame.near_m=0.3".into(), "frame.near_m=0.4".into()]).unwrap();
    assert_eq!((config.frame.near_m, config.window.mirror), (NearClip::Meters(0.4), MirroredEyes::Both));
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
            "walk.toml, line 1: frame.near_m must be \"auto\" or a number, not the section { x = 1 }",
        ),
        (
            "[windows]\n",
            "walk.toml, line 1: there is no setting 'windows'; did you mean 'window.size', 'window.mirror' or 'window.panel'?",
        ),
        (
            "bogus = 1\n",
            "walk.toml, line 1: there is no setting 'bogus'; `scanwalk settings` lists those of users, `scanwalk settings \
             --laboratory` the others",
        ),
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
            "walk.toml, line 2: frame.near_m must be \"auto\" or a number, not the text \"far\"",
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
            "walk.toml, line 1: cloud.order must be one of \"original\", \"morton\", \"shuffled\", \"shuffled-morton\", not the text \"hilbert\"",
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
        "cloud.unit=0",
        "fovea.ring_deg=[10, 90]",
        "lod.threshold_px=[10, 100, 100]",
    ] {
        let error = sets(&[set]).expect_err(set);
        assert!(matches!(error, ConfigError::OutOfRange { .. }), "{set}: {error}");
        assert!(error.to_string().starts_with(&format!("--set {set}: {}", set.split('=').next().unwrap())));
    }
    for (text, expected) in [
        (
            "\n\nframe.near_m = -1",
            "walk.toml, line 3: frame.near_m is -1, but must be from 0.000001 to 1000000",
        ),
        (
            "window.size = [0, 9]",
            "walk.toml, line 1: window.size is [0, 9], but each must be from 1 to 16384",
        ),
        (
            "lod.threshold_px = [300, 200, 100]",
            "walk.toml, line 1: lod.threshold_px is [300.0, 200.0, 100.0], but no ring may want more detail than the one \
             inside it",
        ),
        (
            "fovea.ring_deg = [30, 20]",
            "walk.toml, line 1: fovea.ring_deg is [30.0, 20.0], but the inner ring must end first",
        ),
    ] {
        assert_eq!(complaint(text), expected);
    }
    // A field of view may be asymmetric, with an inner half that looks outwards.
    assert!(sets(&["simulated.fov_deg=[60, -10, 45, 45]"]).is_ok());
}

#[test]
fn files_that_are_no_configuration() {
    assert!(complaint("[frame\nnear_m = 1").starts_with("walk.toml, line 1: this is not TOML: "));
    assert!(complaint("a = 1\na = 2").starts_with("walk.toml, line 2: this is not TOML: "));
    assert!(complaint(&"[".repeat(100_000)).contains("this is not TOML"));
    assert!(complaint(&format!("x = {}", "[".repeat(100_000))).contains("this is not TOML"));
    for path in ["no/such/file.toml", ".", "/dev/zero"] {
        let error = load(&[], Some(&PathBuf::from(path)), &[]).expect_err(path);
        assert!(!error.is_usage(), "{path}: it could not be read, which is no misuse");
        assert!(error.to_string().contains(path), "{error}");
    }
}

#[test]
fn digests_tell_configurations_apart() {
    let digest = Config::default().digest();
    assert_eq!(digest.len(), 16);
    assert_eq!(digest, sets(&[]).unwrap().digest(), "the same settings, the same digest");
    assert_ne!(digest, sets(&["frame.near_m=0.05"]).unwrap().digest(), "a number that somebody chose");
    assert_ne!(digest, sets(&["gpu.adapter=x"]).unwrap().digest());
}
