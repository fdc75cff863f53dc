//! What shaders bind is in the table of `render::bindings`, and all of the table is bound. So no shader can ask for a
//! resource that its stage is not given: stages take whole sets, of which host code cannot leave out a part.
//! Techniques of the laboratory bind what they name besides.

use super::{OUTSIDE, PARSED, ParsedText, parse};
use lab::technique::NAMES;
use naga::Module;
use render::bindings::{AGAIN, Chunk, Clear, Cloud, Eye, Overlay, Pixels, Set};
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
    let is_lacking = |(name, group): &&(String, u32)| {
        let own = name.strip_suffix(AGAIN).unwrap_or(name);
        *group != 0 || !names.contains(&own)
    };
    declared.iter().filter(is_lacking).map(|(name, _)| name.as_str()).collect()
}

#[test]
fn every_shader_binds_only_what_there_is() {
    for seen in PARSED.iter() {
        let names = [&(seen.shader.names)()[..], seen.besides].concat();
        assert_eq!(lacking(&seen.declared, &names), [""; 0], "{}", seen.name);
    }
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
    let sets =
        [Clear::names(), Cloud::names(), Chunk::names(), Pixels::names(), Eye::names(), Overlay::names()];
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
    let besides: BTreeSet<_> =
        PARSED.iter().flat_map(|seen| &seen.declared).map(|(name, _)| &**name).collect();
    assert!(NAMES.iter().all(|name| besides.contains(name)), "nobody binds one of {NAMES:?}");
    for (set, bound) in sets.iter().zip(&bound) {
        let idle: Vec<_> = set.iter().filter(|name| !bound.contains(**name)).collect();
        assert!(idle.is_empty(), "nobody binds {idle:?}");
    }
}

/// The list of a set's resources is in the order of its names: each resource lands at its own name.
#[test]
fn resources_come_in_the_order_of_their_names() {
    let names = <(Chunk, Eye)>::names();
    assert_eq!(names.len(), Chunk::names().len() + Eye::names().len());
    assert_eq!((names[0], names[Chunk::names().len()]), (Chunk::names()[0], Eye::names()[0]));
}

#[test]
fn shaders_outside_the_table_bind_what_their_host_code_says() {
    for (name, wgsl, want) in OUTSIDE {
        let module = parse(name, wgsl);
        let number =
            |(_, v): (_, &naga::GlobalVariable)| Some((v.name.clone()?, v.binding.as_ref()?.binding));
        let bound: Vec<_> = module.global_variables.iter().filter_map(number).collect();
        let want: Vec<_> = want.iter().map(|&(name, number)| (name.to_owned(), number)).collect();
        assert_eq!(bound, want, "{name}");
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
