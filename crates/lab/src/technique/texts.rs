//! The shader texts of the laboratory's techniques: the pieces that differ from the frame's, and nothing else.

use super::fixed40;
use super::tree::{
    RUN_ONE_SIDED, RUN_TRIANGLES, SLICE_PIXELS, TRIANGLE_SLACK_PX, VISIBLE_DISCS, VISIBLE_TRIANGLES,
};
use super::{EarlyZLoad, LabTechnique, Method};
use cloud::format::{
    CORNER_MASK, DIAMETER_SHIFT, ENDLESS_STEP, SECOND_CORNER_SHIFT, SIDE_SHIFT, STEP_MASK, STEP_SHIFT,
    THIRD_CORNER_SHIFT, UNTIL_SHIFT,
};
use render::layout::Variant;
use render::technique::{Pieces, Texts};
use std::sync::LazyLock;

macro_rules! text {
    ($file:literal) => {
        include_str!(concat!("../../../../shaders/", $file, ".wgsl"))
    };
}
pub(super) use text;

/// Bit at which the second number of a pair begins in a word of [`Method::Hqs`].
const PAIR_SHIFT: u32 = 32;

/// WGSL lines that declare the constants of these names.
macro_rules! constants {
    ($($type:ident $suffix:literal: $($name:ident)+;)+) => {
        [$($(format!(concat!("const {}: ", stringify!($type), " = {:?}", $suffix, ";\n"), stringify!($name), $name),)+)+]
            .concat()
    };
}

static TREE_CONSTANTS: LazyLock<String> = LazyLock::new(|| {
    constants! {
        u32 "u": CORNER_MASK DIAMETER_SHIFT ENDLESS_STEP RUN_ONE_SIDED RUN_TRIANGLES SECOND_CORNER_SHIFT SIDE_SHIFT
            SLICE_PIXELS STEP_MASK STEP_SHIFT THIRD_CORNER_SHIFT UNTIL_SHIFT VISIBLE_DISCS VISIBLE_TRIANGLES;
        f32 "": TRIANGLE_SLACK_PX;
    }
});
static PAIR_CONSTANTS: LazyLock<String> = LazyLock::new(|| constants! { u32 "u": PAIR_SHIFT; });

/// Pieces that all stages of a point tree need.
static TREE: LazyLock<[&str; 3]> =
    LazyLock::new(|| [&TREE_CONSTANTS, text!("spt/layout.inc"), text!("spt/tree.inc")]);
static PAIRS: LazyLock<[&str; 2]> = LazyLock::new(|| [&PAIR_CONSTANTS, text!("methods/color_pairs")]);

const IS_CONVERGED: &str = "const CONVERGED: bool = true;\n";
const IS_NOT_CONVERGED: &str = "const CONVERGED: bool = false;\n";

/// The texts of a technique, with counters or without, on a GPU with or without subgroup operations.
#[must_use]
pub fn texts(technique: &LabTechnique, counts: bool, has_subgroups: bool) -> Texts {
    let LabTechnique { method, early_z_load, keep_unseen, error_px } = *technique;
    let is_plain = early_z_load == EarlyZLoad::Plain;
    let all = Texts {
        name: method.name(),
        turn: if method.is_basic() { &[text!("methods/basic.inc")] } else { Texts::FRAME.turn },
        put: put(method),
        seen: if keep_unseen { &[text!("methods/unculled.inc")] } else { Texts::FRAME.seen },
        wide: if method.is_converged() { |_| &[text!("methods/converged.inc")] } else { Texts::wide },
        main: if method == Method::Fixed40 { &[text!("methods/main.inc")] } else { Texts::FRAME.main },
        depth: depth(method, is_plain, error_px.is_some(), has_subgroups),
        hqs_depth: if is_plain { plain_depths } else { Texts::FRAME.hqs_depth },
        color32: if method == Method::Hqs { &*PAIRS } else { Texts::FRAME.color32 },
        amend: if counts { counted } else { Texts::FRAME.amend },
        ..Texts::FRAME
    };
    if error_px.is_some() { of_tree(all, method) } else { all }
}

/// A shader's text that counts: each function of `counted.inc.wgsl` takes the place of the one of its name, if there is
/// one.
fn counted(text: String) -> String {
    let functions = text!("methods/counted.inc").split("\n\n").filter_map(|function| {
        let (name, _) = function.strip_prefix("fn ")?.split_once('(')?;
        Some((name, function))
    });
    let counted = functions.fold(text.clone(), |text, (name, function)| {
        let (own, other) = (format!("fn {name}("), format!("fn uncounted_{name}("));
        if text.contains(&own) { text.replace(&own, &other) + "\n" + function + "\n" } else { text }
    });
    if counted == text { text } else { counted + text!("methods/counts.inc") }
}

fn plain_depths(_: Variant) -> Pieces {
    &[text!("depths.inc"), text!("methods/early_z_plain_depths.inc"), text!("depth")]
}

fn put(method: Method) -> Pieces {
    match (method.is_basic(), method.is_converged()) {
        (false, _) => Texts::FRAME.put,
        (true, false) => &[text!("put_seen.inc"), text!("methods/put_one.inc")],
        (true, true) => &[text!("methods/put_converged.inc"), text!("methods/put_one.inc")],
    }
}

/// Puts the texts for a tree's discs and triangles in place of those for points.
fn of_tree(texts: Texts, method: Method) -> Texts {
    Texts {
        besides: &*TREE,
        lod: &[text!("spt/lod")],
        cull: &[text!("spt/steps.inc"), text!("spt/cull")],
        choice: match (method.is_basic(), method.is_converged()) {
            (false, _) => &[
                IS_NOT_CONVERGED,
                text!("spt/steps.inc"),
                text!("spt/shapes.inc"),
                text!("spt/discs.inc"),
                text!("spt/triangles.inc"),
            ],
            (true, false) => &[
                IS_NOT_CONVERGED,
                text!("spt/steps.inc"),
                text!("spt/shapes_one.inc"),
                text!("spt/discs.inc"),
                text!("spt/triangles.inc"),
            ],
            (true, true) => &[
                IS_CONVERGED,
                text!("spt/steps.inc"),
                text!("spt/shapes_one.inc"),
                text!("spt/discs.inc"),
                text!("spt/triangles.inc"),
            ],
        },
        main: &[text!("spt/main.inc")],
        colors: &[text!("spt/colors.inc")],
        ..texts
    }
}

/// Pieces of `depth`: the reading of the pixel for early-z, atomic or plain, then these pieces, which may call it.
macro_rules! with_early_z {
    ($is_plain:expr, $($piece:expr),+) => {
        if $is_plain {
            |variant: Variant| -> Pieces {
                match variant.keys {
                    true => &[text!("keys.inc"), text!("methods/early_z_plain_keys.inc"), $($piece),+],
                    false => &[text!("depths.inc"), text!("methods/early_z_plain_depths.inc"), $($piece),+],
                }
            }
        } else {
            |variant: Variant| -> Pieces {
                match variant.keys {
                    true => &[text!("keys.inc"), text!("early_z_atomic.inc"), $($piece),+],
                    false => &[text!("depths.inc"), text!("early_z_atomic.inc"), $($piece),+],
                }
            }
        }
    };
}

const READS_FIRST: &str = "const EARLY_Z: bool = true;\n";
const READS_NEVER: &str = "const EARLY_Z: bool = false;\n";

/// Pieces of `depth` for a method.
fn depth(method: Method, is_plain: bool, is_tree: bool, has_subgroups: bool) -> fn(Variant) -> Pieces {
    match (method, has_subgroups) {
        (Method::JustSet | Method::PrefetchJustSet, _) => |_| &[text!("keys.inc"), text!("methods/just_set")],
        (Method::BusyLoop, _) => |_| &[text!("methods/busy_loop")],
        (Method::ExchangeLoop, _) => |_| &[text!("keys.inc"), text!("methods/exchange_loop")],
        (Method::AtomicMin, _) => with_early_z!(is_plain, text!("methods/atomic_min")),
        (Method::Reduce, true) => {
            with_early_z!(is_plain, READS_NEVER, text!("methods/subgroup.inc"), text!("methods/reduce"))
        }
        (Method::Reduce, false) => {
            with_early_z!(
                is_plain,
                READS_NEVER,
                text!("methods/subgroup_emulated.inc"),
                text!("methods/reduce")
            )
        }
        (Method::ReduceEarlyZ, true) => {
            with_early_z!(is_plain, READS_FIRST, text!("methods/subgroup.inc"), text!("methods/reduce"))
        }
        (Method::ReduceEarlyZ, false) => {
            with_early_z!(
                is_plain,
                READS_FIRST,
                text!("methods/subgroup_emulated.inc"),
                text!("methods/reduce")
            )
        }
        (Method::Dedup, true) => {
            with_early_z!(is_plain, text!("methods/subgroup.inc"), text!("methods/dedup"))
        }
        (Method::Dedup, false) => {
            with_early_z!(is_plain, text!("methods/subgroup_emulated.inc"), text!("methods/dedup"))
        }
        (Method::Fixed40, _) => fixed40::depth(is_tree),
        // Methods of high-quality shading have it too, since the governor may ask for `closest`.
        _ => with_early_z!(is_plain, text!("depth")),
    }
}
