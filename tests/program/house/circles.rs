//! Modules of `src` do not name each other in a circle: what one of them needs can be read without the others.

use super::{File, code, sources};
use std::collections::{BTreeMap, BTreeSet};

/// The top-level module that a file belongs to: `walk` for `src/walk/run.rs`, `draw` for `src/draw.rs`.
fn module_of(file: &File) -> Option<&str> {
    let name = file.path.strip_prefix("src/")?.split('/').next()?;
    let name = name.strip_suffix(".rs").unwrap_or(name);
    // The library's and the program's own files name all modules.
    (!["lib", "main"].contains(&name)).then_some(name)
}

/// The top-level modules that a text names: `crate::walk::run`, `crate::{draw, walk::{link, state}}`.
fn named_modules(text: &str) -> BTreeSet<String> {
    let text: String = code(text).flat_map(|(_, line)| [line, "\n"]).collect();
    let mut named = BTreeSet::new();
    for behind in text.split("crate::").skip(1) {
        let first_word = |path: &str| {
            path.trim().split(|c: char| !c.is_alphanumeric() && c != '_').next().map(str::to_owned)
        };
        named.extend(group(behind).into_iter().filter_map(first_word).filter(|name| !name.is_empty()));
    }
    named
}

/// The paths of a group in braces; a path without braces is a group of its own.
fn group(paths: &str) -> Vec<&str> {
    let step = |c: char| i32::from(c == '{') - i32::from(c == '}');
    let Some(inside) = paths.strip_prefix('{') else { return vec![paths] };
    let mut depth = 1;
    let end = inside.find(|c| {
        depth += step(c);
        depth == 0
    });
    let mut depth = 0;
    let between = inside[..end.unwrap_or(inside.len())].split(|c| {
        depth += step(c);
        depth == 0 && c == ','
    });
    between.collect()
}

/// Modules each of which names the next, and the last one the first.
fn circle(files: &[File]) -> Option<Vec<String>> {
    let mut names: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for file in files {
        if let Some(module) = module_of(file) {
            let others = named_modules(&file.text).into_iter().filter(|name| name != module);
            names.entry(module.to_owned()).or_default().extend(others);
        }
    }
    // A module that names none of those that are left is in no circle.
    loop {
        let left: BTreeSet<String> = names.keys().cloned().collect();
        names.retain(|_, others| !others.is_disjoint(&left));
        if names.len() == left.len() {
            break;
        }
    }
    // From each of the others a way leads on, until it comes round.
    let mut way = vec![names.keys().next()?.clone()];
    loop {
        let next = names[way.last()?].iter().find(|name| names.contains_key(*name))?;
        if let Some(at) = way.iter().position(|name| name == next) {
            return Some(way.split_off(at));
        }
        way.push(next.clone());
    }
}

#[test]
fn modules_name_each_other_in_no_circle() {
    assert_eq!(circle(&sources()), None);
    let found = |texts: &[(&str, &str)]| {
        let file = |&(path, text): &(&str, &str)| File { path: path.into(), text: text.into() };
        circle(&texts.iter().map(file).collect::<Vec<_>>())
    };
    let texts = [
        ("src/lib.rs", "pub mod walk; use crate::cli::main;"),
        ("src/cli/mod.rs", "use crate::walk::Walk;"),
        (
            "src/walk/mod.rs",
            "use crate::{config, walk::{link, state}};\nuse crate::draw::Plan; // crate::cli",
        ),
        ("src/draw.rs", "fn of(scene: &crate::scene::Scene) {}"),
    ];
    assert_eq!(found(&texts), None);
    let closed = |path, text| found(&[&texts[..], &[(path, text)]].concat());
    let round = |names: &[&str]| Some(names.iter().map(ToString::to_string).collect::<Vec<_>>());
    assert_eq!(closed("src/scene.rs", "use crate::walk::{self, link};"), round(&["walk", "draw", "scene"]));
    assert_eq!(
        closed("src/config/table.rs", "use crate::{\n    nodes::Lod,\n    walk::link,\n};"),
        round(&["walk", "config"])
    );
    assert_eq!(closed("src/scene.rs", "use crate::nodes::walk;"), None);
}
