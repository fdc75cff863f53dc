//! Every shader, as the host assembles it, goes through the compiler of real GPUs: AMD's RDNA 2 and RDNA 3 in Mesa's
//! RADV, whose null device compiles without the GPU. Nothing may spill registers or need scratch memory.
//!
//! People compare the statistics, not this test: `SCANWALK_BLESS=1` writes them to
//! `docs/bench/gpu-compiler/stats.csv`. They are no times: memory and atomics are not in them.

mod radv;
mod wgsl;

use kit::program::{self, this_program};
use lab::technique::{EarlyZLoad, LabTechnique, Method, POINT_LIST, SHADE_POINTS, SHADE40, texts};
use render::layout::{Sums, Variant};
use render::shaders::{COLOR, COLOR32, CULL, DEPTH, DEPTH32, LOD, SHADERS};
use scanwalk::desktop::MIRROR;
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The GPU families compiled for, RDNA 2 and RDNA 3, each with the names that RADV's versions know it by.
const FAMILIES: [&[&str]; 2] = [&["navi21"], &["navi31", "gfx1100"]];
/// Environment variable that tells the child process where its job is; the answer goes beside it.
const JOB: &str = "SCANWALK_GPU_COMPILER_JOB";
/// Statistics shown, as RADV calls them.
const SHOWN: [&str; 9] = [
    "Instructions",
    "Code size",
    "SGPRs",
    "VGPRs",
    "Spilled SGPRs",
    "Spilled VGPRs",
    "Scratch size",
    "Subgroups per SIMD",
    "Inverse Throughput",
];
/// Statistics that must be 0.
const FORBIDDEN: [&str; 3] = ["Spilled SGPRs", "Spilled VGPRs", "Scratch size"];

/// A shader's whole text.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct WholeShader {
    name: String,
    text: String,
    /// True with wgpu's checks of every index and loop.
    checked: bool,
}

/// What the compiler says of one executable: a compute stage, or the vertex or fragment half of a pass.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Executable {
    shader: String,
    entry: String,
    /// Name and value, in the compiler's order.
    stats: Vec<(String, u64)>,
}

impl Executable {
    fn stat(&self, wanted: &str) -> Option<u64> {
        self.stats.iter().find(|(name, _)| name == wanted).map(|(_, value)| *value)
    }

    /// Finds spills and scratch, which must not be. A statistic that is missing is an error, not a zero.
    fn faults(&self) -> Vec<String> {
        let fault = |name: &&str| match self.stat(name) {
            Some(0) => None,
            Some(value) => Some(format!("{} {}: {name} = {value}", self.shader, self.entry)),
            None => Some(format!("{} {}: the compiler tells no '{name}'", self.shader, self.entry)),
        };
        FORBIDDEN.iter().filter_map(fault).collect()
    }
}

/// The project's shaders for pictures (one eye) and headsets (two), in the forms that matter.
fn our_shaders() -> Vec<WholeShader> {
    let mirror = MIRROR.source(Variant::eyes(1));
    let mut shaders = vec![WholeShader { name: "mirror".into(), text: mirror, checked: true }];
    let mut add = |name: String, text: String| {
        // Drivers get these from a release build; of a debug build the shaders that meet every point are compiled
        // too.
        let shader = WholeShader { name, text, checked: false };
        if ["depth32-2-fill", "color-2-fill"].contains(&&*shader.name) {
            shaders.push(WholeShader {
                name: format!("{}-checked", shader.name),
                checked: true,
                ..shader.clone()
            });
        }
        shaders.push(shader);
    };
    for shader in SHADERS {
        for num_eyes in eyes_of(shader) {
            let plain = Variant { keys: shader.name != "ids", ..Variant::eyes(num_eyes) };
            add(format!("{}-{num_eyes}", shader.name), shader.source(plain));
            if ["depth", "depth32", "color"].contains(&shader.name) {
                let fill = Variant { fill: true, ..plain };
                add(format!("{}-{num_eyes}-fill", shader.name), shader.source(fill));
            }
            if ["color", "blend", "blend-dilate"].contains(&shader.name) {
                let protected = Variant { sums: Sums::Protected, ..plain };
                add(format!("{}-{num_eyes}-protected", shader.name), shader.source(protected));
            }
        }
    }
    laboratory(&mut add);
    shaders
}

/// The shaders of the laboratory's techniques that differ from the frame's.
fn laboratory(add: &mut dyn FnMut(String, String)) {
    let of = |technique: LabTechnique, has_subgroups, num_eyes| {
        let (fill, texts) = (technique.error_px.is_some(), texts(&technique, false, has_subgroups));
        Variant { fill, texts, ..Variant::eyes(num_eyes) }
    };
    let tree = LabTechnique::tree(1.0);
    let plain = LabTechnique { early_z_load: EarlyZLoad::Plain, ..LabTechnique::OWN };
    for num_eyes in 1..=2 {
        let of_tree = [LOD.shader(), CULL.shader(), DEPTH.shader(), DEPTH32.shader(), COLOR.shader()];
        for shader in of_tree {
            add(format!("{}-{num_eyes}-discs", shader.name), shader.source(of(tree, true, num_eyes)));
        }
        for shader in [DEPTH, DEPTH32] {
            add(
                format!("{}-{num_eyes}-plain-looks", shader.name()),
                shader.source(of(plain, true, num_eyes)),
            );
        }
        for (method, has_subgroups, name) in [
            (Method::Basic, true, "basic"),
            (Method::JustSet, true, "just-set"),
            (Method::BusyLoop, true, "busy-loop"),
            (Method::ExchangeLoop, true, "exchange-loop"),
            (Method::AtomicMin, true, "atomic-min"),
            (Method::Reduce, true, "reduce"),
            (Method::Reduce, false, "reduce-emulated"),
            (Method::Dedup, true, "dedup"),
            (Method::Dedup, false, "dedup-emulated"),
            (Method::Fixed40, true, "fixed40"),
        ] {
            let variant = of(LabTechnique::method(method), has_subgroups, num_eyes);
            add(format!("{name}-{num_eyes}"), DEPTH.source(variant));
        }
        let pairs = of(LabTechnique::method(Method::Hqs), true, num_eyes);
        let pairs = Variant { sums: Sums::Wide, ..pairs };
        add(format!("color-pairs-{num_eyes}"), COLOR32.source(pairs));
    }
    let of_method = |method| of(LabTechnique::method(method), true, 2);
    add("shade40-2".into(), SHADE40.source(of_method(Method::Fixed40)));
    add("point-list-2".into(), POINT_LIST.source(of_method(Method::PointList)));
    add("shade-points-2".into(), SHADE_POINTS.source(of_method(Method::PointList)));
}

/// Numbers of eyes to compile for. A shader that draws one eye a dispatch is the same for one eye and for two: only
/// the prelude names their number.
fn eyes_of(shader: render::shaders::Shader) -> std::ops::RangeInclusive<u32> {
    let knows_both = shader.source(Variant::eyes(2)).matches("NUM_EYES").count() > 1;
    if knows_both { 1..=2 } else { 2..=2 }
}

/// Shaders of this test's own, whose outcome is known.
fn samples() -> Vec<WholeShader> {
    let sample =
        |name: &str, text: &str| WholeShader { name: name.into(), text: text.into(), checked: false };
    vec![
        sample("lean", include_str!("shaders/lean.wgsl")),
        sample("pass", include_str!("shaders/pass.wgsl")),
        sample("scratch", include_str!("shaders/scratch.wgsl")),
    ]
}

/// Compiles for a family. `Err` says why it cannot be done on this machine.
fn compile(family: &[&str], shaders: &[WholeShader]) -> Result<Vec<Executable>, String> {
    let manifest = radv::manifest().ok_or("Mesa's driver for AMD GPUs (RADV) is not installed")?;
    let compiled = family.iter().find_map(|name| compile_for(name, &manifest, shaders).transpose());
    compiled.unwrap_or_else(|| Err(format!("this version of RADV is older than {}", family[0])))
}

/// Compiles in a child process, since driver and family are chosen by environment variables. `None` if RADV does not
/// know a family of that name.
fn compile_for(
    name: &str,
    manifest: &Path,
    shaders: &[WholeShader],
) -> Result<Option<Vec<Executable>>, String> {
    let folder = tempfile::tempdir().unwrap();
    let job = folder.path().join("job.json");
    std::fs::write(&job, serde_json::to_vec(shaders).unwrap()).unwrap();
    let mut command = program::command(this_program());
    command
        .args(["--exact", "compile_in_child", "--ignored", "--nocapture"])
        .env(JOB, &job)
        .env("RADV_FORCE_FAMILY", name)
        .env("VK_DRIVER_FILES", manifest)
        .env("VK_ICD_FILENAMES", manifest);
    let output = program::run(&mut command);
    let said = format!("{}{}", String::from_utf8_lossy(&output.out), output.err);
    if said.contains("Unknown family") {
        return Ok(None);
    }
    if let Some((_, reason)) = said.split_once(radv::NO_DEVICE) {
        return Err(reason.lines().next().unwrap_or_default().trim().to_owned());
    }
    let answer = std::fs::read(job.with_extension("answer"));
    let answer = answer.unwrap_or_else(|_| panic!("compiling for {name} failed:\n{said}"));
    Ok(Some(serde_json::from_slice(&answer).unwrap()))
}

/// The child's part: compiles every shader of its job for the family in its environment.
#[test]
#[ignore = "runs inside a child process of the other tests"]
fn compile_in_child() {
    let Some(job) = std::env::var_os(JOB).map(PathBuf::from) else { return };
    let shaders: Vec<WholeShader> = serde_json::from_slice(&std::fs::read(&job).unwrap()).unwrap();
    let gpu = match radv::NullGpu::open() {
        Ok(gpu) => gpu,
        Err(reason) => return println!("{}{reason}", radv::NO_DEVICE),
    };
    let compile = |shader: &WholeShader| {
        let executables =
            wgsl::Parsed::new(&shader.text, shader.checked).and_then(|parsed| gpu.compile(&parsed));
        executables
            .unwrap_or_else(|error| panic!("{}: {error}", shader.name))
            .into_iter()
            .map(|(entry, stats)| Executable { shader: shader.name.clone(), entry, stats })
            .collect::<Vec<_>>()
    };
    let answer: Vec<Executable> = shaders.iter().flat_map(compile).collect();
    std::fs::write(job.with_extension("answer"), serde_json::to_vec(&answer).unwrap()).unwrap();
}

#[test]
#[cfg_attr(not(feature = "with-radv"), ignore = "needs Mesa's driver for AMD GPUs, RADV")]
fn no_shader_spills() {
    let shaders = our_shaders();
    assert!(!shaders.is_empty(), "there are shaders in shaders/");
    let mut csv = format!("family,shader,entry,{}\n", SHOWN.join(",").to_lowercase().replace(' ', "_"));
    // The compiler has one thread.
    let compiled = std::thread::scope(|scope| {
        let compiling = FAMILIES.map(|family| scope.spawn(|| compile(family, &shaders)));
        compiling.map(|family| family.join().expect("a compiler's answer"))
    });
    for (family, compiled) in FAMILIES.iter().zip(compiled) {
        let executables = compiled.expect("Mesa's driver for AMD GPUs");
        let faults: Vec<String> = executables.iter().flat_map(Executable::faults).collect();
        for executable in &executables {
            let values = SHOWN.map(|name| executable.stat(name).map_or(String::new(), |v| v.to_string()));
            writeln!(csv, "{},{},{},{}", family[0], executable.shader, executable.entry, values.join(","))
                .unwrap();
        }
        assert!(faults.is_empty(), "{family:?}: {faults:#?}");
        for shader in &shaders {
            assert!(executables.iter().any(|e| e.shader == shader.name), "{} was not compiled", shader.name);
        }
    }
    println!("{csv}");
    if std::env::var_os("SCANWALK_BLESS").is_some() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/bench/gpu-compiler");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("stats.csv"), csv).unwrap();
    }
}

/// The check can fail: a shader that indexes a large private array needs scratch memory, a lean one does not,
/// and neither does a pass with a vertex and a fragment half.
#[test]
#[cfg_attr(not(feature = "with-radv"), ignore = "needs Mesa's driver for AMD GPUs, RADV")]
fn scratch_memory_is_noticed() {
    for family in FAMILIES {
        let executables = compile(family, &samples()).expect("Mesa's driver for AMD GPUs");
        let faulty: Vec<&str> = executables
            .iter()
            .filter(|executable| !executable.faults().is_empty())
            .map(|executable| executable.shader.as_str())
            .collect();
        assert_eq!(faulty, ["scratch"], "{family:?}: {executables:#?}");
        let entries: Vec<String> = executables.iter().map(|e| format!("{} {}", e.shader, e.entry)).collect();
        assert_eq!(entries, ["lean main", "pass vertex", "pass fragment", "scratch main"]);
    }
}

/// A statistic that the compiler does not give counts as a fault, not as zero.
#[test]
fn untold_statistics_are_faults() {
    let executable = |stats: &[(&str, u64)]| Executable {
        shader: "s".into(),
        entry: "main".into(),
        stats: stats.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
    };
    assert!(executable(&FORBIDDEN.map(|name| (name, 0))).faults().is_empty());
    assert_eq!(executable(&[]).faults().len(), FORBIDDEN.len());
    assert_eq!(executable(&FORBIDDEN.map(|name| (name, 1))).faults().len(), FORBIDDEN.len());
}
