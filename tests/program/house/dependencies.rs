//! What a manifest declares is used: some source file that it is for names each dependency.

use super::{File, code, files, names};

/// Kinds of dependencies, with the folders and files of a package that may name them.
const KINDS: [(&str, &[&str]); 3] = [
    ("dependencies", &["src/"]),
    ("dev-dependencies", &["src/", "tests/", "benches/", "examples/"]),
    ("build-dependencies", &["build.rs"]),
];

/// Whether code names a crate: in a path, or to bring it in. A file with a module of that name means the module, and so
/// does a path that leads there through another module.
fn names_crate(text: &str, name: &str) -> bool {
    let [module, import, path] = [format!("mod {name}"), format!("use {name}"), format!("{name}::")];
    let part_of_path = |c: char| c.is_alphanumeric() || c == '_';
    let begins_path = |line: &str| {
        line.match_indices(&path).any(|(at, _)| {
            let before = &line[..at];
            !before.strip_suffix("::").unwrap_or(before).ends_with(part_of_path)
        })
    };
    let has = |is_so: &dyn Fn(&str) -> bool| code(text).any(|(_, line)| is_so(line));
    !has(&|line| names(line, &module)) && has(&|line| names(line, &import) || begins_path(line))
}

/// Names below `[dependencies]` and the like, also those of one system alone.
fn declared(manifest: &toml::Table, kind: &str) -> Vec<String> {
    let targets = manifest.get("target").and_then(toml::Value::as_table);
    let targets = targets.into_iter().flat_map(toml::Table::values).filter_map(toml::Value::as_table);
    let tables = [manifest].into_iter().chain(targets);
    let tables = tables.filter_map(|table| table.get(kind).and_then(toml::Value::as_table));
    tables.flat_map(toml::Table::keys).cloned().collect()
}

/// Dependencies in the manifest of the package in `folder` that none of its files names.
fn unused(folder: &str, manifest: &str, files: &[File]) -> Vec<String> {
    let manifest: toml::Table = manifest.parse().expect("a manifest is TOML");
    let mut unused = Vec::new();
    for (kind, places) in KINDS {
        let is_for = |file: &&File| {
            let path = file.path.strip_prefix(folder);
            path.is_some_and(|path| places.iter().any(|place| path.starts_with(place)))
        };
        let texts: Vec<&str> = files.iter().filter(is_for).map(|file| file.text.as_str()).collect();
        let is_unused = |name: &String| !texts.iter().any(|text| names_crate(text, &name.replace('-', "_")));
        unused.extend(
            declared(&manifest, kind)
                .into_iter()
                .filter(is_unused)
                .map(|name| format!("{folder}Cargo.toml: no file names {name} of [{kind}]")),
        );
    }
    unused
}

#[test]
fn every_dependency_is_named() {
    let mut sources: Vec<File> = ["src", "crates", "tests", "benches"]
        .into_iter()
        .flat_map(|folder| files(folder, &[".rs"]))
        .collect();
    let mut manifests = files("crates", &["/Cargo.toml"]);
    manifests.extend(files("tests/faultlayer", &["/Cargo.toml"]));
    assert!(manifests.len() > 9, "the manifests were not found");
    for manifest in &manifests {
        let folder = manifest.path.trim_end_matches("Cargo.toml");
        assert_eq!(unused(folder, &manifest.text, &sources), [""; 0]);
    }
    // The layer is a package of its own.
    sources.retain(|file| !file.path.starts_with("tests/faultlayer/"));
    let root = include_str!("../../../Cargo.toml");
    assert_eq!(unused("", root, &sources), [""; 0]);
    let all: toml::Table = root.parse().unwrap();
    let shared = all["workspace"].as_table().unwrap();
    let users: String = manifests.iter().map(|manifest| manifest.text.as_str()).chain([root]).collect();
    for name in declared(shared, "dependencies") {
        let is_used = [format!("{name}.workspace = true"), format!("{name} = {{ workspace = true")];
        assert!(
            is_used.iter().any(|words| users.contains(words)),
            "no package takes {name} of the workspace"
        );
    }
}

#[test]
fn an_unused_dependency_is_found() {
    let file = |path: &str, text: &str| File { path: path.into(), text: text.into() };
    let files = [
        file(
            "crates/a/src/lib.rs",
            "use glam::Vec3;\nuse openxr as xr;\n// libm::sqrt is not used\nlet png = 1;",
        ),
        file("crates/b/src/lib.rs", "libm::sqrt(1.0) + wgpu_hal::Api"),
        file("crates/b/tests/t.rs", "proptest::proptest! {}"),
        file("crates/c/src/formats.rs", "pub(crate) mod las;\nmod lazy;\nlas::Reader; ::laz::Laz"),
        file("crates/c/src/lib.rs", "use super::las::Reader;\ncrate::formats::las::Reader; atlas::Page"),
    ];
    let found = |folder, names: &str, kind: &str| {
        let names: String = names.split(' ').map(|name| format!("{name} = \"1\"\n")).collect();
        unused(folder, &format!("[{kind}]\n{names}"), &files).len()
    };
    assert_eq!(found("crates/a/", "glam openxr", "dependencies"), 0);
    assert_eq!(found("crates/a/", "libm png glam", "dependencies"), 2);
    assert_eq!(found("crates/b/", "libm wgpu-hal", "target.'cfg(unix)'.dependencies"), 0);
    assert_eq!(found("crates/b/", "proptest", "dependencies"), 1, "only its tests name it");
    assert_eq!(found("crates/b/", "proptest", "dev-dependencies"), 0);
    assert_eq!(found("crates/b/", "libm", "build-dependencies"), 1, "it has no build.rs");
    assert_eq!(found("crates/c/", "las", "dependencies"), 1, "its own module has the name");
    assert_eq!(found("crates/c/", "laz", "dependencies"), 0, "no module has the name");
}
