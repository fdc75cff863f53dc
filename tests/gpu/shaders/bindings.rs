//! What shaders bind is in the table of `render::bindings`, and all of the table is bound. So no shader can ask for a
//! resource that its stage is not given: stages take whole sets, of which host code cannot leave out a part. A technique
//! of the laboratory names what its texts bind besides, and stages that have a place for that may bind it.

use super::{PARSED, ParsedText, parse};
use naga::Module;
use render::bindings::{ChunkSet, ClearSet, CloudSet, EyeSet, OverlaySet, PixelSet, ScenerySet, Set};
use render::gpu::stage::used;
use render::layout::Variant;
use render::shaders::{SHADERS, source};
use std::collections::BTreeSet;

/// Names and groups of all resources that a text declares.
pub fn declared(module: &Module) -> Vec<(String, u32)> {
    let bound = |(_, v): (_, &naga::GlobalVariable)| Some((v.name.clone()?, v.binding.as_ref()?.group));
    module.global_variables.iter().filter_map(bound).collect()
}

/// Names that a text declares and its set lacks.
fn lacking<'a>(declared: &'a [(String, u32)], names: &[&str]) -> Vec<&'a str> {
    let is_lacking = |(name, group): &&(String, u32)| *group != 0 || !names.contains(&name.as_str());
    declared.iter().filter(is_lacking).map(|(name, _)| name.as_str()).collect()
}

#[test]
fn every_shader_binds_only_what_there_is() {
    for seen in PARSED.iter() {
        let others = if seen.shader.has_others { &seen.others[..] } else { &[] };
        let names = [&(seen.shader.names)()[..], others].concat();
        assert_eq!(lacking(&seen.declared, &names), [""; 0], "{}", seen.name);
    }
}

#[test]
fn all_that_techniques_name_is_bound() {
    let named: BTreeSet<&str> = PARSED.iter().flat_map(|seen| &seen.others).copied().collect();
    assert!(named.len() > 6, "{named:?}");
    let is_bound = |name: &&&str| {
        let naming = PARSED.iter().filter(|seen| seen.others.contains(*name));
        naming.flat_map(|seen| &seen.declared).any(|(declared, _)| declared == **name)
    };
    let idle: Vec<_> = named.iter().filter(|name| !is_bound(name)).collect();
    assert!(idle.is_empty(), "nobody binds {idle:?}");
}

#[test]
fn stages_over_batches_have_a_place_for_others() {
    let have: Vec<_> = SHADERS.iter().filter(|shader| shader.has_others).map(|shader| shader.name).collect();
    assert_eq!(have, ["cull", "depth", "depth32", "ids", "color", "color32"]);
}

#[test]
fn a_name_that_no_set_has_is_noticed() {
    let shader = SHADERS.iter().find(|shader| shader.name == "lod").expect("a shader");
    let text = source("lod", Variant::eyes(2));
    let assert_lacking = |text: &str, want: &[&str]| {
        assert_eq!(lacking(&declared(&parse("lod", text)), &(shader.names)()), want);
    };
    assert_lacking(&text, &[]);
    assert_lacking(&text.replace("counted", "numbered"), &["numbered"]);
    assert_lacking(&text.replace("@group(0) @binding(3)", "@group(1) @binding(3)"), &["counted"]);
}

#[test]
fn all_that_a_set_has_is_bound_by_a_shader_that_it_is_for() {
    let sets = [
        ClearSet::names(),
        CloudSet::names(),
        ChunkSet::names(),
        PixelSet::names(),
        EyeSet::names(),
        OverlaySet::names(),
        ScenerySet::names(),
    ];
    let mut bound = vec![BTreeSet::new(); sets.len()];
    for ParsedText { shader, name, declared, .. } in PARSED.iter() {
        let names = (shader.names)();
        let distinct: BTreeSet<_> = names.iter().collect();
        assert_eq!(distinct.len(), names.len(), "{name}: no name stands for two resources");
        for (set, bound) in sets.iter().zip(&mut bound) {
            if set.iter().all(|name| names.contains(name)) {
                let of_set = declared.iter().filter(|(name, _)| set.contains(&name.as_str()));
                bound.extend(of_set.map(|(name, _)| name.clone()));
            }
        }
    }
    for (set, bound) in sets.iter().zip(&bound) {
        let idle: Vec<_> = set.iter().filter(|name| !bound.contains(**name)).collect();
        assert!(idle.is_empty(), "nobody binds {idle:?}");
    }
}

/// A pipeline asks for what its entry point uses, not for what the text declares.
#[test]
fn entry_points_bind_what_they_use() {
    let of = |shader, entry| {
        let used = used(&source(shader, Variant::eyes(2)), entry).expect("a valid text");
        used.into_iter().map(|(name, _)| name).collect::<BTreeSet<_>>()
    };
    assert!(of("depth-image", "vertex").is_empty());
    assert!(of("depth-image", "fragment").contains("image_depth"));
    assert!(used(&source("lod", Variant::eyes(2)), "vertex").is_err(), "there is none");
    assert!(used("fn main(", "main").is_err());
}
