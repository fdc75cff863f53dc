//! Shaders without a GPU: naga parses and validates each, and the host's structs have the shaders' offsets.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use render::gpu::Atomics;
use render::layout::{self, Sums, Variant};
use render::shaders::{SHADERS, Shader, source};
use std::mem::offset_of;

/// What each tier's adapters offer beyond plain WGSL.
fn capabilities(atomics: Atomics) -> Capabilities {
    // Vulkan has always had the first; of methods not every GPU can do the second, whatever its tier.
    let plain = Capabilities::SHADER_FLOAT16_IN_FLOAT32 | Capabilities::SUBGROUP;
    let minmax = plain | Capabilities::SHADER_INT64 | Capabilities::SHADER_INT64_ATOMIC_MIN_MAX;
    match atomics {
        Atomics::Int32 => plain,
        Atomics::Int64Minmax => minmax,
        Atomics::Int64 => {
            let all = minmax | Capabilities::SHADER_INT64_ATOMIC_ALL_OPS;
            // Of a method that not every GPU of the tier can do.
            all | Capabilities::FLOAT64
        }
    }
}

/// One point a thread, all threads together, a look first.
const LOOPS: [(bool, bool, bool); 4] =
    [(false, false, true), (true, false, true), (true, true, true), (true, true, false)];

/// Every text that a tier's renderers hand to the driver.
fn texts(atomics: Atomics) -> Vec<(String, String)> {
    let keys = atomics >= Atomics::Int64Minmax;
    let forms: &[Sums] =
        if atomics == Atomics::Int64 { &[Sums::Packed, Sums::Protected, Sums::Pairs] } else { &[Sums::Wide] };
    let mut unused = match atomics {
        Atomics::Int32 => vec!["color"],
        Atomics::Int64Minmax => vec!["ids", "color"],
        Atomics::Int64 => vec!["ids", "color32"],
    };
    if atomics != Atomics::Int64 {
        let methods = ["just-set", "fixed40", "shade40", "busy-loop", "exchange-loop", "color-pairs"];
        unused.extend(methods);
    }
    let mut texts = Vec::new();
    for Shader { name, .. } in SHADERS.iter().filter(|s| !unused.contains(&s.name)) {
        for (&sums, num_eyes) in forms.iter().flat_map(|s| [(s, 1), (s, 2)]) {
            for (fill, discs) in [(false, false), (true, false), (true, true)] {
                let fixed40 = name.contains("40");
                for (basic, converged, early_z) in LOOPS {
                    let fill = fill && !converged;
                    for plain_looks in [false, true] {
                        let variant = Variant {
                            num_eyes,
                            fill,
                            discs,
                            sums,
                            keys,
                            basic,
                            converged,
                            early_z,
                            plain_looks,
                            together: !plain_looks,
                            fixed40,
                            counts: num_eyes == 1 && !plain_looks,
                        };
                        texts.push((format!("{name} {variant:?}"), source(name, variant)));
                    }
                }
            }
        }
    }
    texts
}

fn parse(name: &str, wgsl: &str) -> naga::Module {
    naga::front::wgsl::parse_str(wgsl).unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(wgsl)))
}

#[test]
fn every_shader_is_valid_in_every_tier() {
    for atomics in [Atomics::Int32, Atomics::Int64Minmax, Atomics::Int64] {
        for (name, wgsl) in texts(atomics) {
            let module = parse(&name, &wgsl);
            let mut validator = Validator::new(ValidationFlags::all(), capabilities(atomics));
            if let Err(e) = validator.validate(&module) {
                panic!("{atomics:?} {name}: {}", e.emit_to_string(&wgsl));
            }
            assert!(!module.entry_points.is_empty(), "{name} has an entry point");
        }
    }
}

#[test]
fn the_validator_refuses_what_the_tier_lacks() {
    for (name, lacking) in [("color", Atomics::Int64Minmax), ("depth", Atomics::Int32)] {
        let wgsl = source(name, Variant::eyes(2));
        let mut validator = Validator::new(ValidationFlags::all(), capabilities(lacking));
        assert!(validator.validate(&parse(name, &wgsl)).is_err(), "{name} in {lacking:?}");
    }
}

/// Name, size and (field, offset) of a host struct.
type HostStruct = (&'static str, usize, Vec<(&'static str, usize)>);

macro_rules! host {
    ($name:ident: $($field:ident),+) => {
        (stringify!($name), size_of::<layout::$name>(),
         vec![$((stringify!($field), offset_of!(layout::$name, $field))),+])
    };
}

fn host_structs() -> Vec<HostStruct> {
    vec![
        host!(Batch: min_hi, first_point, min_lo, num_points, cell, node, steps_per_unit, interval),
        host!(Node: min_hi, edge, min_lo, flags, spacing, children, level,
            sample_spacing, spacing_step),
        host!(EyeUniform: row_x, row_y, row_w, eye_in_head, pixels_per_radian, gaze_in_head, tolerance_rad,
            gaze_in_view, widest_cos, tangent_origin, tangent_per_px, first_px, end_px, width, height,
            tolerance_growth, reserved_end),
        host!(ViewUniform: head_hi, near, head_lo, forced_planes, threshold_px, flags, ring_cos, ring_sin,
            fill_reach_px, step_base, undivided_px, margin_px, eyes),
        host!(VisibleBatch: head_cell, first_point, offset, num_points, cell, flags, spacing, own, drawn, batch,
            reserved, spacing_step, sample_spacing),
        host!(ChunkUniform: first_index, num_points, reserved),
        host!(ClearUniform: value, num_left, num_right, reserved),
        host!(ResolveUniform: size_px, background, is_bgra),
        host!(DilateUniform: eye, radius_px, reserved),
    ]
}

/// What differs between a host struct and the shaders' struct of that name.
fn difference(module: &naga::Module, (name, size, fields): &HostStruct) -> Option<String> {
    let Some((_, ty)) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)) else {
        return Some(format!("the shaders have no struct {name}"));
    };
    let naga::TypeInner::Struct { members, span } = &ty.inner else {
        return Some(format!("{name} is no struct"));
    };
    let theirs: Vec<(&str, usize)> =
        members.iter().map(|m| (m.name.as_deref().unwrap_or(""), m.offset as usize)).collect();
    (theirs != *fields || *span as usize != *size)
        .then(|| format!("{name}: shader {theirs:?} of {span} bytes, host {fields:?} of {size}"))
}

#[test]
fn host_structs_have_the_shaders_offsets() {
    let module = parse("layout", &source("depth", Variant::eyes(2)));
    for host in host_structs() {
        assert_eq!(difference(&module, &host), None);
    }
    let counters = parse("cull", &source("cull", Variant::eyes(2)));
    let mut host = host!(CullCounters: num_visible, workgroups_y, workgroups_z, num_points, num_nodes, num_extra, reserved);
    host.0 = "Counters";
    assert_eq!(difference(&counters, &host), None);
}

#[test]
fn the_offset_comparison_can_fail() {
    let wgsl = source("depth", Variant::eyes(2))
        .replace("min_lo: vec3<f32>,\n    num_points: u32,", "num_points: u32,\n    min_lo: vec3<f32>,");
    assert!(difference(&parse("swapped", &wgsl), &host_structs()[0]).is_some());
}

#[test]
fn the_prelude_states_every_constant_once() {
    let prelude = layout::prelude(Variant::eyes(2));
    for line in prelude.lines() {
        let name = line.split_whitespace().nth(1).expect("const NAME: …").trim_end_matches(':');
        assert_eq!(prelude.matches(&format!("const {name}:")).count(), 1, "{name}");
    }
}
