//! Structs that host and shaders share are the same ones, both ways: fields, offsets and sizes.

use super::{PARSED, parse};
use lab::technique::{counts, tree};
use naga::{AddressSpace, Handle, Module, Type, TypeInner};
use render::layout::{self, CullCounters, Variant};
use render::shaders::source;
use scanwalk::desktop;
use std::collections::BTreeSet;
use std::mem::offset_of;

/// Name, size and (field, offset) of a host struct.
pub type HostStruct = (&'static str, usize, Vec<(&'static str, usize)>);

macro_rules! host {
    ($of:ident::$name:ident: $($field:ident),+) => {{
        // A field that is not named here is a build error.
        let _ = |$of::$name { $($field: _),+ }: $of::$name| ();
        (stringify!($name), size_of::<$of::$name>(),
         vec![$((stringify!($field), offset_of!($of::$name, $field))),+])
    }};
}

/// The host's side.
pub fn host_structs() -> Vec<HostStruct> {
    vec![
        host!(layout::GpuBatch: min_hi, first_point, min_lo, num_points, cell, node, steps_per_unit, reserved),
        host!(layout::GpuNode: min_hi, edge, min_lo, flags, spacing, children, level, sample_spacing, spacing_step, reserved),
        host!(layout::EyeUniform: row_x, row_y, row_w, eye_in_head, pixels_per_radian, gaze_in_head, widest_cos,
            gaze_in_view, reserved, tangent_origin, tangent_per_px, first_px, end_px, width, height,
            reserved_end),
        host!(layout::ViewUniform: head_hi, near, head_lo, forced_planes, threshold_px, flags, ring_cos, ring_sin,
            fill_reach_px, margin_px, undivided_px, reserved, eyes),
        host!(layout::VisibleBatch: head_cell, first_point, offset, num_points, cell, flags, spacing, own, drawn,
            spacing_step, sample_spacing, reserved, reserved_end),
        host!(layout::ChunkUniform: first_index, num_points, reserved),
        host!(layout::ClearUniform: value, num_left, num_right, reserved),
        host!(layout::ResolveUniform: size_px, background, is_bgra),
        host!(layout::DilateUniform: eye),
        host!(layout::SceneryUniform: clip_from_stage, ray, has_points, ray_right, units_per_m, ray_down, vignette,
            ahead, pitch_px, eye_in_grid, has_surround, sky, has_grid, horizon, reserved, ground, reserved_ground,
            line, reserved_end),
        host!(layout::CullCounters: num_visible, workgroups_y, workgroups_z, num_points, num_nodes, num_extra, reserved),
        host!(tree::Run: behind, flags, reserved, reserved_end),
        host!(tree::DiscBatch: min_hi, first_point, min_lo, num_points, cell, run, steps_per_unit, interval),
        host!(tree::TreeUniform: tolerance_rad, tolerance_growth, step_base, reserved, reserved_end),
        host!(counts::Counts: num_drawn, num_asked, num_reads, num_colors, num_chosen, reserved),
        host!(desktop::DrawnUniform: size, last),
    ]
}

/// The structs that a shader's buffers hold, those within others too.
pub fn shared_structs(module: &Module) -> BTreeSet<String> {
    fn add(module: &Module, of: Handle<Type>, names: &mut BTreeSet<String>) {
        match &module.types[of].inner {
            TypeInner::Struct { members, .. } => {
                names.insert(module.types[of].name.clone().expect("structs of WGSL have names"));
                members.iter().for_each(|member| add(module, member.ty, names));
            }
            TypeInner::Array { base, .. } => add(module, *base, names),
            _ => {}
        }
    }
    let mut names = BTreeSet::new();
    for (_, variable) in module.global_variables.iter() {
        if matches!(variable.space, AddressSpace::Uniform | AddressSpace::Storage { .. }) {
            add(module, variable.ty, &mut names);
        }
    }
    names
}

/// What differs between a host struct and the shaders' struct of that name.
fn difference(module: &Module, (name, size, fields): &HostStruct) -> Option<String> {
    let Some((_, ty)) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)) else {
        return Some(format!("the shaders have no struct {name}"));
    };
    let TypeInner::Struct { members, span } = &ty.inner else {
        return Some(format!("{name} is no struct"));
    };
    let theirs: Vec<(&str, usize)> =
        members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
    (theirs != *fields || *span as usize != *size)
        .then(|| format!("{name}: shader {theirs:?} of {span} bytes, host {fields:?} of {size}"))
}

/// What is wrong with the structs of a shader's buffers.
pub fn faults(module: &Module, hosts: &[HostStruct]) -> Vec<String> {
    let fault = |name: &String| match hosts.iter().find(|(host, ..)| host == name) {
        Some(host) => difference(module, host),
        None => Some(format!("the host has no struct {name}")),
    };
    shared_structs(module).iter().filter_map(fault).collect()
}

#[test]
fn shared_structs_are_the_same_in_host_and_shaders() {
    let hosts = host_structs();
    let mut used = BTreeSet::new();
    for seen in PARSED.iter() {
        assert_eq!(seen.faults, [""; 0], "{}", seen.name);
        used.extend(seen.structs.clone());
    }
    let names: BTreeSet<_> = hosts.iter().map(|(name, ..)| *name).collect();
    assert!(used.iter().map(String::as_str).eq(names), "no shader lacks one: {used:?}");
}

#[test]
fn every_struct_of_the_layout_is_compared() {
    let hosts = host_structs();
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    let folder = root.join("render/src/layout");
    let entries = std::fs::read_dir(&folder).expect("the layout's folder");
    let layout: Vec<_> = entries.map(|entry| entry.expect("a file").path()).collect();
    let of_lab = ["tree.rs", "counts.rs"].map(|file| root.join("lab/src/technique").join(file));
    let mut num_found = 0;
    let of_window = root.with_file_name("src").join("desktop/mirror.rs");
    for path in layout.into_iter().chain(of_lab).chain([of_window]) {
        let text = std::fs::read_to_string(path).expect("a source file");
        for of_c in text.split("#[repr(C)]").skip(1) {
            let name = of_c.split("pub struct ").nth(1).and_then(|s| s.split_whitespace().next());
            let name = name.expect("a struct");
            assert!(hosts.iter().any(|(host, ..)| *host == name), "{name}");
            num_found += 1;
        }
    }
    assert_eq!(num_found, hosts.len());
}

/// `clear` writes counters as words, `boxes` reads the first.
#[test]
fn counters_are_cleared_as_the_struct_has_them() {
    let cleared = CullCounters { workgroups_y: 1, workgroups_z: 1, ..CullCounters::default() };
    assert_eq!(bytemuck::cast::<_, [u32; 8]>(cleared), [0, 1, 1, 0, 0, 0, 0, 0]);
    let text = source("clear", Variant::eyes(2));
    assert!(text.contains("vec4<u32>(0u, 1u, 1u, 0u)"), "the shader's first four words");
    assert_eq!(offset_of!(CullCounters, num_visible), 0, "what `boxes` reads");
}

#[test]
fn the_comparison_of_structs_can_fail() {
    let text = source("depth", Variant::eyes(2));
    let broken = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        faults(&parse("broken", &text.replace(from, to)), &host_structs())
    };
    assert!(broken("struct DilateUniform", "struct DilateUniform").is_empty());
    // The samples have fields in another order, one field too few, and a struct that the host does not know.
    assert_eq!(
        broken(
            "own: vec2<u32>,\n    drawn: u32,\n    spacing_step: f32,",
            "drawn: u32,\n    spacing_step: f32,\n    own: vec2<u32>,"
        )
        .len(),
        1
    );
    assert_eq!(broken("num_points: u32,\n    reserved: vec2<u32>,\n}", "num_points: u32,\n}").len(), 1);
    assert_eq!(broken("ChunkUniform", "Piece"), ["the host has no struct Piece"]);
    // A struct within another is checked too.
    assert_eq!(broken("EyeUniform", "Eye"), ["the host has no struct Eye"]);
}
