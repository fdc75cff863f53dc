//! The walls between rooms: which one may name which, and where code may be unsafe.

use std::path::Path;

/// The rooms from the bottom up. Each may name the rooms that stand beside it here, which come before it, and no
/// other. Cargo refuses circles and what a manifest does not list; this table keeps the manifests.
const ROOMS: [(&str, &[&str]); 10] = [
    ("base", &[]),
    ("raw", &[]),
    ("timing", &["base"]),
    ("points", &["base"]),
    ("cloud", &["base", "points"]),
    ("render", &["base", "cloud", "raw", "timing"]),
    ("xr", &["base", "raw", "render", "timing"]),
    ("lab", &["base", "cloud", "points", "render", "timing"]),
    ("kit", &["base", "cloud", "lab", "points", "render"]),
    ("", &["base", "cloud", "lab", "points", "raw", "render", "timing", "xr"]),
];
/// Libraries that a room must not have: the GPU is unknown to files and clouds; the renderer knows no headset, no window and no
/// settings file; windows and the command line are the program's matter.
const NOT_IN: [(&str, &[&str]); 9] = [
    ("clap", &["base", "timing", "points", "cloud", "raw", "render", "lab", "xr"]),
    ("wgpu", &["base", "timing", "points", "cloud"]),
    ("ash", &["base", "timing", "points", "cloud", "render", "lab"]),
    ("openxr", &["base", "timing", "points", "cloud", "render", "lab"]),
    ("wgpu-hal", &["base", "timing", "points", "cloud", "render", "lab", "xr"]),
    ("winit", &["base", "timing", "points", "cloud", "raw", "render", "lab", "xr"]),
    ("egui", &["base", "timing", "points", "cloud", "raw", "render", "lab", "xr"]),
    ("toml", &["base", "timing", "cloud", "raw", "render", "lab", "xr"]),
    ("las", &["base", "timing", "cloud", "raw", "render", "xr"]),
];

/// The parts of `crates/raw` that each room may name. Cargo gives a crate one set of features in a build, so that a build
/// of everything lets each room that has `raw` see what `xr` asks for.
const RAW: [(&str, &[&str]); 3] =
    [("render", &["trusted"]), ("xr", &["depth_layer", "device", "frame", "image"]), ("", &["environment"])];

/// Parts of `crates/raw` that `code` names although it is in `room`.
fn forbidden_parts_of_raw(room: &str, code: &str) -> Vec<String> {
    let may_name = RAW.iter().find(|(name, _)| *name == room).map_or(&[][..], |(_, parts)| *parts);
    let named = code.match_indices("raw::").filter_map(|(at, _)| {
        // `las::raw` is another crate's, and formats have a module of that name.
        let is_crate = !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == ':' || c == '_');
        let name = || code[at + 5..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        is_crate.then(name)
    });
    named.filter(|part: &String| !may_name.contains(&part.as_str())).collect()
}

#[test]
fn rooms_name_their_own_parts_of_the_unsafe_room() {
    for file in super::sources() {
        let room = file.path.strip_prefix("crates/").and_then(|path| path.split('/').next()).unwrap_or("");
        // Other rooms have no `raw` in their manifests.
        if RAW.iter().any(|(name, _)| *name == room) {
            let code: Vec<&str> = super::code(&file.text).map(|(_, line)| line).collect();
            assert_eq!(forbidden_parts_of_raw(room, &code.join("\n")), [""; 0], "{}", file.path);
        }
    }
    assert_eq!(forbidden_parts_of_raw("render", "use raw::device::RuntimeGpu;"), ["device"]);
    assert_eq!(forbidden_parts_of_raw("", "let _ = raw::trusted::shader_module;"), ["trusted"]);
    assert_eq!(forbidden_parts_of_raw("render", "las::raw::Header; raw::trusted::f"), [""; 0]);
}

/// Names below `[dependencies]` of a room's manifest.
fn dependencies(manifest: &str) -> Vec<String> {
    let table: toml::Table = manifest.parse().expect("a manifest is TOML");
    let of = |name: &str| table.get(name).and_then(toml::Value::as_table);
    of("dependencies").into_iter().flat_map(|names| names.keys().cloned()).collect()
}

/// Dependencies in the manifest of `room` that it may not have.
fn forbidden_dependencies(room: &str, manifest: &str) -> Vec<String> {
    let may_name = ROOMS.iter().find(|(name, _)| *name == room).map_or(&[][..], |(_, below)| *below);
    let names = dependencies(manifest);
    let is_forbidden = |name: &&String| {
        let is_room = ROOMS.iter().any(|(room, _)| room == name);
        let is_kept_out = NOT_IN.iter().any(|(library, rooms)| library == name && rooms.contains(&room));
        is_room && !may_name.contains(&name.as_str()) || is_kept_out
    };
    names.iter().filter(is_forbidden).map(|name| format!("{room} depends on {name}")).collect()
}

/// The manifest of a room; the program's own room is "".
fn manifest(room: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = if room.is_empty() { root.to_owned() } else { root.join("crates").join(room) };
    std::fs::read_to_string(folder.join("Cargo.toml")).unwrap()
}

#[test]
fn dependencies_point_one_way() {
    let rooms = ROOMS.map(|(room, _)| room);
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    for entry in std::fs::read_dir(crates).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(rooms.contains(&name.as_str()), "crates/{name} is in no table");
    }
    for (at, (room, below)) in ROOMS.iter().enumerate() {
        assert!(below.iter().all(|name| rooms[..at].contains(name)), "{room}: from the bottom up");
        assert_eq!(forbidden_dependencies(room, &manifest(room)), [""; 0]);
    }
    let sample = |room: &str, name: &str| {
        forbidden_dependencies(room, &format!("[dependencies]\n{name}.workspace = true\n")).len()
    };
    assert_eq!(sample("cloud", "wgpu"), 1);
    assert_eq!(sample("render", "xr"), 1);
    assert_eq!(sample("points", "cloud"), 1);
    assert_eq!(sample("cloud", "points") + sample("xr", "openxr"), 0);
}

/// Whether a room's code cannot be unsafe, whatever its files allow.
fn forbids_unsafe(room: &str, manifest: &str, lib: &str) -> bool {
    if room.is_empty() {
        return lib.contains("\n#![forbid(unsafe_code)]\n");
    }
    manifest.contains("\n[lints]\nworkspace = true\n")
}

#[test]
fn unsafe_stands_in_one_room() {
    assert!(manifest("").contains("[workspace.lints.rust]\nunsafe_code = \"forbid\"\n"));
    let lib = concat!(include_str!("../../../src/lib.rs"), include_str!("../../../src/main.rs"));
    assert_eq!(lib.matches("\n#![forbid(unsafe_code)]\n").count(), 2);
    let open: Vec<&str> = ROOMS
        .map(|(room, _)| room)
        .into_iter()
        .filter(|room| !forbids_unsafe(room, &manifest(room), lib))
        .collect();
    assert_eq!(open, ["raw"]);
    assert!(!forbids_unsafe("xr", "[package]\n", ""));
    assert!(!forbids_unsafe("", "", "//! x\n"));
}
