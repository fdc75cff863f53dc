//! Shaders without a GPU: naga parses and validates each; what they share with the host is the host's.

mod bindings;
mod numbers;
mod structs;

use lab::bench::point_list::VERTEX_LIST;
use lab::technique::{EarlyZLoad, LabTechnique, Method, POINT_LIST, SHADE_POINTS, SHADE40};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use render::gpu::Atomics;
use render::layout::{self, Sums, Variant};
use render::shaders::{COLOR32, SHADERS, Shader, source};
use scanwalk::desktop::MIRROR;
use std::collections::BTreeSet;
use std::sync::LazyLock;

/// What each tier's adapters offer beyond plain WGSL.
fn capabilities(atomics: Atomics) -> Capabilities {
    // Vulkan has always had the first. Methods need the second, which not every GPU can do, whatever its tier.
    let plain = Capabilities::SHADER_FLOAT16_IN_FLOAT32 | Capabilities::SUBGROUP;
    let minmax = plain | Capabilities::SHADER_INT64 | Capabilities::SHADER_INT64_ATOMIC_MIN_MAX;
    match atomics {
        Atomics::Int32 => plain,
        Atomics::Int64Minmax => minmax,
        Atomics::Int64 => {
            let all = minmax | Capabilities::SHADER_INT64_ATOMIC_ALL_OPS;
            // A method needs this, which not every GPU of the tier can do.
            all | Capabilities::FLOAT64
        }
    }
}

const TIERS: [Atomics; 3] = [Atomics::Int32, Atomics::Int64Minmax, Atomics::Int64];

/// A shader in a variant.
struct ShaderText {
    shader: Shader,
    name: String,
    wgsl: String,
    /// Resources that its technique binds besides.
    others: Vec<&'static str>,
}

/// What the tests want to know of a text, which is parsed once for all of them.
struct ParsedText {
    shader: Shader,
    name: String,
    /// Resources that its technique binds besides.
    others: Vec<&'static str>,
    /// Why naga refuses it.
    error: Option<String>,
    /// Its entry points.
    entries: Vec<String>,
    /// Names and groups of its resources.
    declared: Vec<(String, u32)>,
    /// Structs in its buffers.
    structs: BTreeSet<String>,
    /// What is wrong with those structs.
    faults: Vec<String>,
}

/// All texts of all tiers.
static PARSED: LazyLock<Vec<ParsedText>> = LazyLock::new(|| {
    let hosts = structs::host_structs();
    let see = &|atomics: Atomics, ShaderText { shader, name, wgsl, others }: ShaderText| {
        let module = parse(&name, &wgsl);
        let mut validator = Validator::new(ValidationFlags::all(), capabilities(atomics));
        ParsedText {
            error: validator.validate(&module).err().map(|e| e.emit_to_string(&wgsl)),
            entries: module.entry_points.iter().map(|entry| entry.name.clone()).collect(),
            declared: bindings::declared(&module),
            structs: structs::shared_structs(&module),
            faults: structs::faults(&module, &hosts),
            name: format!("{atomics:?} {name}"),
            shader,
            others,
        }
    };
    let all = &|tier| texts(tier).into_iter().map(|text| see(tier, text)).collect::<Vec<_>>();
    std::thread::scope(|scope| {
        let tiers = TIERS.map(|tier| scope.spawn(move || all(tier)));
        tiers.into_iter().flat_map(|tier| tier.join().expect("a tier's texts")).collect()
    })
});

/// Shaders whose texts techniques exchange parts of.
const EXCHANGED: [&str; 7] = ["lod", "cull", "depth", "depth32", "ids", "color", "color32"];

/// Every text that a tier's renderers hand to the driver.
fn texts(atomics: Atomics) -> Vec<ShaderText> {
    let keys = atomics >= Atomics::Int64Minmax;
    let unused = match atomics {
        Atomics::Int32 => &["color"][..],
        Atomics::Int64Minmax => &["ids", "color"],
        Atomics::Int64 => &["ids", "color32"],
    };
    let own: Vec<Shader> = SHADERS.into_iter().filter(|shader| !unused.contains(&shader.name)).collect();
    let forms: &[Sums] =
        if atomics == Atomics::Int64 { &[Sums::Packed, Sums::Protected] } else { &[Sums::Wide] };
    let mut texts = Vec::new();
    let mut add = |shader: Shader, technique: String, variant: Variant, others| {
        let name = format!("{} {technique} {variant:?}", shader.name);
        texts.push(ShaderText { shader, name, wgsl: shader.source(variant), others });
    };
    for shader in [MIRROR.shader(), VERTEX_LIST.shader()] {
        add(shader, "none".into(), Variant::eyes(1), vec![]);
    }
    for (&sums, num_eyes) in forms.iter().flat_map(|s| [(s, 1), (s, 2)]) {
        for (fill, together) in [(false, true), (true, true), (true, false)] {
            let variant = Variant { fill, together, sums, keys, ..Variant::eyes(num_eyes) };
            own.iter().for_each(|&shader| add(shader, "frame".into(), variant, vec![]));
        }
    }
    for (technique, has_subgroups) in techniques().filter(|(t, _)| keys_fit(t.method, atomics)) {
        let sums = technique.method.sums().unwrap_or(forms[0]);
        let is_tree = technique.error_px.is_some();
        let mut shaders: Vec<Shader> = match technique.method {
            Method::PointList => vec![POINT_LIST.shader(), SHADE_POINTS.shader()],
            Method::Fixed40 => vec![SHADE40.shader()],
            _ => vec![],
        };
        if technique.method == Method::Hqs {
            shaders.push(COLOR32.shader());
        }
        shaders.extend(own.iter().filter(|shader| EXCHANGED.contains(&shader.name)));
        for (num_eyes, counts) in [(1, true), (2, false)] {
            let texts = lab::technique::texts(&technique, counts, has_subgroups);
            let fill = is_tree && !technique.method.draws_pixels();
            let together = technique.early_z_load == EarlyZLoad::Atomic;
            let variant = Variant { fill, together, sums, keys, texts, ..Variant::eyes(num_eyes) };
            for &shader in &shaders {
                let others = technique.names(counts);
                add(shader, format!("{technique:?} {counts} {has_subgroups}"), variant, others);
            }
        }
    }
    texts
}

/// Every technique of the laboratory, with whether the GPU has operations of subgroups.
fn techniques() -> impl Iterator<Item = (LabTechnique, bool)> {
    let of_method = |method: Method| {
        [None, Some(1.0)].into_iter().flat_map(move |error_px| {
            let looks = [EarlyZLoad::Atomic, EarlyZLoad::Plain];
            looks.into_iter().map(move |early_z_load| LabTechnique {
                method,
                early_z_load,
                keep_unseen: early_z_load == EarlyZLoad::Plain,
                error_px,
            })
        })
    };
    let all = Method::ALL.into_iter().flat_map(of_method);
    // Hardware points draw no discs.
    let all = all.filter(|t| t.method != Method::PointList || t.error_px.is_none());
    all.flat_map(|t| [true, false].map(|has| (t, has))).filter(|(t, has)| *has || t.method.is_converged())
}

/// Whether a tier has the atomics of a method.
fn keys_fit(method: Method, atomics: Atomics) -> bool {
    atomics == Atomics::Int64 || !method.needs_int64()
}

fn parse(name: &str, wgsl: &str) -> naga::Module {
    naga::front::wgsl::parse_str(wgsl).unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(wgsl)))
}

#[test]
fn every_shader_is_valid_in_every_tier() {
    for ParsedText { name, error, .. } in PARSED.iter() {
        assert!(error.is_none(), "{name}: {}", error.as_deref().unwrap_or_default());
    }
}

/// Entry points of shaders that draw; the others have one, `main`.
const DRAWN: [(&str, &[&str]); 7] = [
    ("depth-image", &["vertex", "fragment"]),
    ("scenery", &["whole", "surround", "vignette", "corner", "shape"]),
    ("overlay", &["whole", "rings", "depth", "overdraw"]),
    ("boxes", &["node_box", "batch_box", "line"]),
    ("point-list", &["left", "right", "fragment"]),
    ("vertex-list", &["vertex", "fragment"]),
    ("mirror", &["corner", "pixel"]),
];

#[test]
fn shaders_have_the_entry_points_that_the_host_names() {
    for ParsedText { shader, name, entries, .. } in PARSED.iter() {
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

/// Functions that count stand in for others by name: of one that has another name now, nothing would be counted.
#[test]
fn every_function_that_counts_has_one_to_count() {
    let counted = include_str!("../../shaders/methods/counted.inc.wgsl");
    let texts: String = texts(Atomics::Int64).into_iter().map(|text| text.wgsl).collect();
    let names = counted.lines().filter_map(|line| Some(line.strip_prefix("fn ")?.split_once('(')?.0));
    let names: Vec<&str> = names.collect();
    assert!(names.len() > 10, "{names:?}");
    for name in names {
        assert!(texts.contains(&format!("fn uncounted_{name}(")), "{name}");
    }
}
