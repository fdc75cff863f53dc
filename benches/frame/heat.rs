//! The heats: which ways to draw take turns, and which ratios are told of them.

use lab::technique::{EarlyZLoad, LabTechnique, Method};
use render::Access;
use render::DrawOptions;
use render::gpu::Atomics;
use render::options::{Dilate, Quality};
use scanwalk::resolve;

/// Points of the largest cloud that hardware points draw, since above they take seconds a frame.
pub const MAX_HARDWARE_POINTS: u64 = 16_000_000;

/// Contestants that take turns on the same cloud from the same places.
pub struct Heat {
    /// Name in lower case.
    pub name: &'static str,
    /// Points of the largest cloud that takes part.
    pub max_points: u64,
    /// Entries by name.
    pub entries: Vec<(&'static str, HeatEntry)>,
    /// Pairs that draw the same picture bit for bit.
    pub same: Vec<[&'static str; 2]>,
    /// Pairs whose depths agree on nearly all pixels.
    pub alike: Vec<[&'static str; 2]>,
    /// Ratios that are told beside the times.
    pub ratios: Vec<Ratio>,
}

/// A way to draw.
#[derive(Clone, Copy, Debug)]
pub enum HeatEntry {
    /// The compute frame.
    Compute(ComputePlan),
    /// Hardware points, for clouds up to [`MAX_HARDWARE_POINTS`].
    Hardware,
}

/// How the compute frame draws.
#[derive(Clone, Copy, Debug)]
pub struct ComputePlan {
    /// True: the octree is drawn rather than every point.
    pub layered: bool,
    /// True: one eye is drawn after the other, each by a renderer for one eye.
    pub singles: bool,
    /// Tier of atomics; `None`: the GPU's best.
    pub atomics: Option<Atomics>,
    /// Draw options of the frame.
    pub options: DrawOptions,
    /// Technique by which it is drawn.
    pub technique: LabTechnique,
}

/// Part of a frame that is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FramePart {
    /// The stage `depth`.
    Depth,
    /// The stage `color`.
    Color,
    /// Both stages, which every point goes through.
    Geometry,
    /// The whole frame.
    Frame,
}

/// One contestant's time divided by another's.
#[derive(Clone, Copy, Debug)]
pub struct Ratio {
    /// Contestant above the line.
    pub of: &'static str,
    /// Contestant below the line.
    pub to: &'static str,
    /// Parts of the frame whose times are divided.
    pub parts: &'static [FramePart],
}

use FramePart::{Color, Depth, Frame, Geometry};

/// All heats, in the order in which they are run.
pub fn heats() -> [Heat; 5] {
    [eyes(), tiers(), octree(), parts(), access()]
}

/// Both eyes in one dispatch a stage, and in two; high-quality shading; hardware points.
fn eyes() -> Heat {
    let pairs = [
        (["closest-flat", "closest-flat-singles"], flat(closest()), &[Depth, Frame][..]),
        (["hqs-flat", "hqs-flat-singles"], flat(hqs(false)), &[Depth, Color, Frame]),
        (["hqs-lod", "hqs-lod-singles"], layered(hqs(false)), &[Depth, Color, Frame]),
    ];
    let singles = |plan| HeatEntry::Compute(ComputePlan { singles: true, ..plan });
    let mut entries: Vec<_> =
        pairs.iter().flat_map(|&([a, b], p, _)| [(a, HeatEntry::Compute(p)), (b, singles(p))]).collect();
    entries.push(("point-list", HeatEntry::Hardware));
    let mut ratios: Vec<_> = pairs.iter().map(|&([of, to], _, parts)| Ratio { of, to, parts }).collect();
    ratios.push(Ratio { of: "hqs-flat", to: "closest-flat", parts: &[Geometry, Frame] });
    ratios.push(Ratio { of: "point-list", to: "closest-flat", parts: &[Frame] });
    ratios.push(Ratio { of: "point-list", to: "hqs-flat", parts: &[Frame] });
    // Which nodes of an octree are drawn depends on the eyes that there are, so its pictures may differ.
    let same = vec![pairs[0].0, pairs[1].0];
    let alike = vec![["point-list", "closest-flat"]];
    Heat { name: "eyes", max_points: 16_000_000, entries, same, alike, ratios }
}

/// The tiers of atomics that the GPU has.
fn tiers() -> Heat {
    let tier =
        |options, atomics| HeatEntry::Compute(ComputePlan { atomics: Some(atomics), ..layered(options) });
    let names = [
        ["closest-int64", "closest-int64-minmax", "closest-int32"],
        ["hqs-int64", "hqs-int64-minmax", "hqs-int32"],
    ];
    let (mut entries, mut same, mut ratios) = (vec![], vec![], vec![]);
    for (names, options) in names.into_iter().zip([closest(), hqs(false)]) {
        let best = names[0];
        entries.push((best, tier(options, Atomics::Int64)));
        for (name, atomics) in names.into_iter().zip([Atomics::Int64, Atomics::Int64Minmax, Atomics::Int32]) {
            if name != best {
                entries.push((name, tier(options, atomics)));
                same.push([name, best]);
                ratios.push(Ratio { of: name, to: best, parts: &[Geometry, Frame] });
            }
        }
    }
    ratios.push(Ratio { of: "hqs-int64", to: "closest-int64", parts: &[Geometry, Frame] });
    Heat { name: "tiers", alike: vec![], max_points: 16_000_000, entries, same, ratios }
}

/// Level of detail against every point: bare, and in the whole frame.
fn octree() -> Heat {
    let entries = vec![
        ("hqs-flat", HeatEntry::Compute(flat(hqs(false)))),
        ("hqs-lod", HeatEntry::Compute(layered(hqs(false)))),
        ("hqs-lod-fade", HeatEntry::Compute(layered(hqs(true)))),
        ("whole-flat", HeatEntry::Compute(flat(whole()))),
        ("whole-lod-no-fill", HeatEntry::Compute(layered(no_fill()))),
        ("whole-lod", HeatEntry::Compute(layered(whole()))),
    ];
    let pairs = [
        ("hqs-lod", "hqs-flat"),
        ("hqs-lod-fade", "hqs-flat"),
        // A flat cloud does not know its spacing, so nothing is filled there.
        ("whole-lod-no-fill", "whole-flat"),
        ("whole-lod", "whole-flat"),
    ];
    let ratios = pairs.map(|(of, to)| Ratio { of, to, parts: &[Geometry, Frame] }).to_vec();
    Heat { name: "octree", alike: vec![], max_points: u64::MAX, entries, same: vec![], ratios }
}

/// What each part of the whole frame costs: frames without it.
fn parts() -> Heat {
    let whole = whole();
    let mut without = [("no-dilation", whole), ("no-fill", no_fill()), ("no-fade", whole)];
    // The reach of the kernels stays, or `fill` would have more to do.
    without[0].1.dilate = Dilate::Off;
    without[2].1.detail.fade = false;
    let entry = |(name, options)| (name, HeatEntry::Compute(layered(options)));
    let ratios = without.map(|(to, _)| Ratio { of: "whole", to, parts: &[Frame] }).to_vec();
    let entries = [("whole", whole)].into_iter().chain(without).map(entry).collect();
    Heat { name: "parts", alike: vec![], max_points: 16_000_000, entries, same: vec![], ratios }
}

/// How shaders reach memory: early-z's look by an atomic load and by a plain one, every index checked and none.
fn access() -> Heat {
    let early_z = |early_z_load| LabTechnique { early_z_load, ..LabTechnique::method(Method::EarlyZ) };
    let [atomic, plain] = [EarlyZLoad::Atomic, EarlyZLoad::Plain].map(early_z);
    let checks = |checked| DrawOptions { access: Access { checked, ..Access::default() }, ..whole() };
    let entries = vec![
        ("early-z-atomic-flat", HeatEntry::Compute(ComputePlan { technique: atomic, ..flat(closest()) })),
        ("early-z-plain-flat", HeatEntry::Compute(ComputePlan { technique: plain, ..flat(closest()) })),
        ("early-z-atomic-lod", HeatEntry::Compute(ComputePlan { technique: atomic, ..layered(closest()) })),
        ("early-z-plain-lod", HeatEntry::Compute(ComputePlan { technique: plain, ..layered(closest()) })),
        ("whole-lod-checked", HeatEntry::Compute(layered(checks(true)))),
        ("whole-lod-trusted", HeatEntry::Compute(layered(checks(false)))),
        ("whole-flat-checked", HeatEntry::Compute(flat(checks(true)))),
        ("whole-flat-trusted", HeatEntry::Compute(flat(checks(false)))),
    ];
    let pairs: Vec<_> = entries.chunks_exact(2).map(|pair| [pair[1].0, pair[0].0]).collect();
    let ratios = pairs.iter().map(|&[of, to]| Ratio { of, to, parts: &[Geometry, Frame] }).collect();
    Heat { name: "access", alike: vec![], max_points: 16_000_000, entries, same: pairs, ratios }
}

fn flat(options: DrawOptions) -> ComputePlan {
    ComputePlan { layered: false, singles: false, atomics: None, options, technique: LabTechnique::OWN }
}

fn layered(options: DrawOptions) -> ComputePlan {
    ComputePlan { layered: true, ..flat(options) }
}

/// Draw options for the nearest point, nothing filled.
fn closest() -> DrawOptions {
    DrawOptions { quality: Quality::Closest, ..hqs(false) }
}

/// Draw options of high-quality shading, nothing filled.
fn hqs(fade: bool) -> DrawOptions {
    let mut options = DrawOptions { quality: Quality::Hqs, dilate: Dilate::Off, ..no_fill() };
    options.detail.fade = fade;
    options
}

/// Draw options of the program unless told otherwise.
fn whole() -> DrawOptions {
    resolve::Plan::default().draw.options
}

/// That look without `fill`, which makes points larger.
fn no_fill() -> DrawOptions {
    let mut options = whole();
    options.detail.fill_reach_px = None;
    options
}
