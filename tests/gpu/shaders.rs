//! Shaders without a GPU: naga parses and validates each; what they share with the host is the host's.

mod bindings;
mod numbers;
mod structs;

use naga::valid::{Capabilities, ValidationFlags, Validator};
use render::gpu::Atomics;
use render::layout::{self, Sums, Variant};
use render::shaders::{SHADERS, Shader, source};
use std::collections::BTreeSet;
use std::sync::LazyLock;

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

/// Names of bindings and their numbers.
type Numbers = &'static [(&'static str, u32)];

/// Shaders that the host has outside of [`SHADERS`], and what they bind, with the numbers that stand in their host code.
const OUTSIDE: [(&str, &str, Numbers); 3] = [
    (
        "mirror",
        include_str!("../../shaders/mirror.wgsl"),
        &[("image", 0), ("image_sampler", 1), ("drawn", 2)],
    ),
    ("waiting", include_str!("../../shaders/waiting.wgsl"), &[]),
    ("vertex_list", include_str!("../../shaders/methods/vertex_list.wgsl"), &[("clip_from_cloud", 0)]),
];

const TIERS: [Atomics; 3] = [Atomics::Int32, Atomics::Int64Minmax, Atomics::Int64];

/// A shader in a variant.
struct Text {
    shader: Shader,
    name: String,
    wgsl: String,
}

/// What the tests want to know of a text, which is parsed once for all of them.
struct Seen {
    shader: Shader,
    name: String,
    /// Why naga refuses it.
    error: Option<String>,
    /// Its entry points.
    entries: Vec<String>,
    /// Names and groups of its resources.
    declared: Vec<(String, u32)>,
    /// Structs in its buffers.
    structs: BTreeSet<String>,
    /// What is wrong with those.
    faults: Vec<String>,
}

/// All texts of all tiers.
static SEEN: LazyLock<Vec<Seen>> = LazyLock::new(|| {
    let hosts = structs::host_structs();
    let see = &|atomics: Atomics, Text { shader, name, wgsl }: Text| {
        let module = parse(&name, &wgsl);
        let mut validator = Validator::new(ValidationFlags::all(), capabilities(atomics));
        Seen {
            error: validator.validate(&module).err().map(|e| e.emit_to_string(&wgsl)),
            entries: module.entry_points.iter().map(|entry| entry.name.clone()).collect(),
            declared: bindings::declared(&module),
            structs: structs::shared_structs(&module),
            faults: structs::faults(&module, &hosts),
            name: format!("{atomics:?} {name}"),
            shader,
        }
    };
    let all = &|tier| texts(tier).into_iter().map(|text| see(tier, text)).collect::<Vec<_>>();
    std::thread::scope(|scope| {
        let tiers = TIERS.map(|tier| scope.spawn(move || all(tier)));
        tiers.into_iter().flat_map(|tier| tier.join().expect("a tier's texts")).collect()
    })
});

/// Every text that a tier's renderers hand to the driver.
fn texts(atomics: Atomics) -> Vec<Text> {
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
    for shader in SHADERS.into_iter().filter(|s| !unused.contains(&s.name)) {
        let name = shader.name;
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
                        let name = format!("{name} {variant:?}");
                        texts.push(Text { shader, name, wgsl: shader.source(variant) });
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
    for Seen { name, error, .. } in SEEN.iter() {
        assert!(error.is_none(), "{name}: {}", error.as_deref().unwrap_or_default());
    }
}

/// Entry points of shaders that draw; the others have one, `main`.
const DRAWN: [(&str, &[&str]); 4] = [
    ("depth-image", &["vertex", "fragment"]),
    ("overlay", &["whole", "rings", "depth", "overdraw"]),
    ("boxes", &["node_box", "batch_box", "line"]),
    ("point-list", &["left", "right", "fragment"]),
];

#[test]
fn shaders_have_the_entry_points_that_the_host_names() {
    for Seen { shader, name, entries, .. } in SEEN.iter() {
        let drawn = DRAWN.iter().find(|(drawn, _)| *drawn == shader.name);
        assert_eq!(entries, drawn.map_or(&["main"][..], |(_, entries)| entries), "{name}");
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

#[test]
fn the_prelude_states_every_constant_once() {
    let prelude = layout::prelude(Variant::eyes(2));
    for line in prelude.lines() {
        let name = line.split_whitespace().nth(1).expect("const NAME: …").trim_end_matches(':');
        assert_eq!(prelude.matches(&format!("const {name}:")).count(), 1, "{name}");
    }
}
