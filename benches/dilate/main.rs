//! Times `dilate`, which goes by rows and columns through workgroup memory, against the same rule over the whole 7×7
//! window straight from global memory. Both fill the same surface in the same submission, as often as there are runs;
//! `docs/bench/dilate` keeps a run. Before anything is timed, both must have found the same depths.

mod scene;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use kit::timed::{Spread, TimedArgs};
use render::bindings::{EyeSet, OfEye};
use render::gpu::stage::Stage;
use render::gpu::timer::Timer;
use render::gpu::{Gpu, readback};
use render::layout::{self, DilateUniform, ResolveUniform, Variant};
use render::{shaders, tiles};
use std::io::{self, Write};
use wgpu::BufferUsages;
use wgpu::util::DeviceExt;

/// Submissions that do not count.
const WARM_UP_RUNS: usize = 2;
/// Pixels of a workgroup of `direct.wgsl`.
const DIRECT_TILE_PX: [u32; 2] = [16, 16];
/// The contestants, in the order of their passes.
const NAMES: [&str; 2] = ["separable", "direct"];

/// Times the two ways to dilate an eye's image.
#[derive(Debug, Parser)]
struct DilateArgs {
    #[command(flatten)]
    timed: TimedArgs,
    /// Pixels of the image
    #[arg(long, value_names = ["WIDTH", "HEIGHT"], num_args = 2, default_values_t = [1440, 1600])]
    size: Vec<u32>,
    /// Shares of pixels that no point has reached, percent
    #[arg(long, value_name = "P,P,…", value_delimiter = ',', default_value = "0,35,70,95")]
    empty: Vec<u32>,
}

fn main() -> Result<()> {
    let mut args = DilateArgs::parse();
    if args.timed.is_quick() {
        (args.size, args.timed.runs) = (vec![143, 161], 3);
    }
    let gpu = args.timed.gpu()?;

    let mut out = io::stdout().lock();
    let mut csv = args.timed.csv()?;
    if let Some(csv) = &mut csv {
        writeln!(csv, "empty_percent,run,{}_ms,{}_ms", NAMES[0], NAMES[1])?;
    }
    let size_px = [args.size[0], args.size[1]];
    writeln!(
        out,
        "{}, {}; {}×{} pixels, {} runs",
        gpu.name(),
        gpu.driver(),
        size_px[0],
        size_px[1],
        args.timed.runs
    )?;
    for &empty_percent in &args.empty {
        let samples = measure(&gpu, size_px, empty_percent, args.timed.runs)?;
        let of = |value: fn(&[f64; 2]) -> f64| Spread::of(samples.iter().map(value));
        writeln!(
            out,
            "{empty_percent:>3} % empty: {} ms {:.3}, {} ms {:.3}, ratio {:.3}",
            NAMES[0],
            of(|s| s[0]),
            NAMES[1],
            of(|s| s[1]),
            of(|s| s[0] / s[1])
        )?;
        if let Some(csv) = &mut csv {
            for (run, [separable, direct]) in samples.iter().enumerate() {
                writeln!(csv, "{empty_percent},{run},{separable:.3},{direct:.3}")?;
            }
            csv.flush()?;
        }
    }
    Ok(())
}

/// Text of the direct form: the pieces in front of `dilate`, then its own file.
fn direct_source() -> String {
    let shared = [
        include_str!("../../shaders/layout.inc.wgsl"),
        include_str!("../../shaders/rings.inc.wgsl"),
        include_str!("../../shaders/dilation.inc.wgsl"),
        include_str!("../../shaders/kept_surface.inc.wgsl"),
        include_str!("../../shaders/image.inc.wgsl"),
    ];
    format!("{}{}{}", layout::prelude(Variant::eyes(1)), shared.concat(), include_str!("direct.wgsl"))
}

/// Milliseconds of each contestant, run by run.
fn measure(gpu: &Gpu, size_px: [u32; 2], empty_percent: u32, num_runs: usize) -> Result<Vec<[f64; 2]>> {
    let buffer = |label: &str, contents: &[u8], usage| {
        let contents = wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage };
        gpu.device.create_buffer_init(&contents)
    };
    let pixels = scene::two_layers(layout::guarded(size_px), empty_percent);
    let surface = buffer("surface", bytemuck::cast_slice(&pixels), BufferUsages::STORAGE);
    let view = buffer("view", bytemuck::bytes_of(&scene::view(size_px)), BufferUsages::UNIFORM);
    let dilate = buffer("dilate", bytemuck::bytes_of(&DilateUniform::default()), BufferUsages::UNIFORM);
    let nothing_hidden = vec![0; (layout::mask_words_per_row(size_px[0]) * size_px[1]) as usize];
    let tile_list = tiles(size_px, &nothing_hidden);
    let resolve = ResolveUniform { size_px, background: 0, is_bgra: 0 };
    let resolve = buffer("resolve", bytemuck::bytes_of(&resolve), BufferUsages::UNIFORM);
    let hidden = buffer("hidden", bytemuck::cast_slice(&nothing_hidden), BufferUsages::STORAGE);
    let tiles = buffer("tiles", bytemuck::cast_slice(&tile_list), BufferUsages::STORAGE);
    let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
    let size = u64::from(4 * layout::image_pitch_px(size_px[0]) * size_px[1]);
    let images = NAMES.map(|name| gpu.buffer(name, size, usage));
    let depths = NAMES.map(|name| gpu.buffer(name, size, usage));
    let unused = gpu.buffer("unused", 16, BufferUsages::STORAGE);
    let stages: [Stage<EyeSet>; 2] = [
        Stage::new(gpu, "dilate", &shaders::source("dilate", Variant::eyes(1)))?,
        Stage::new(gpu, "direct", &direct_source())?,
    ];
    let groups: Vec<wgpu::BindGroup> = stages
        .iter()
        .zip(images.iter().zip(&depths))
        .map(|(stage, (image, depth))| {
            let of_name = |name| match name {
                "view" => &view,
                "dilate" => &dilate,
                "tiles" => &tiles,
                "surface" => &surface,
                "resolve" => &resolve,
                "hidden" => &hidden,
                "image_color" => image,
                "image_depth" => depth,
                _ => &unused,
            };
            stage.bind(gpu, &OfEye::by_name(|name| of_name(name).as_entire_binding()))
        })
        .collect();

    let guarded_px = layout::guarded(size_px);
    let num_groups =
        [[tile_list.len() as u32, 1], [0, 1].map(|axis| guarded_px[axis].div_ceil(DIRECT_TILE_PX[axis]))];
    let mut timer = Timer::new(gpu, NAMES.len(), 8);
    let mut samples = Vec::new();
    for run in 0..WARM_UP_RUNS + num_runs {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        timer.begin(&mut encoder, run as u64);
        for (number, (stage, group)) in stages.iter().zip(&groups).enumerate() {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(NAMES[number]),
                timestamp_writes: timer.compute(number, true, true),
            });
            stage.dispatch_2d(&mut pass, group, num_groups[number]);
        }
        timer.end(&mut encoder, &images[0]);
        gpu.queue.lock().submit([encoder.finish()]);
        timer.submitted();
        gpu.poll(wgpu::PollType::wait_indefinitely())?;
        let times = timer.collect(gpu, |times| [0, 1].map(|stage| f64::from(times.stage_ms[stage])));
        let times = times.context("the device gave no times")?;
        if run == 0 {
            check(gpu, &depths, size_px, &pixels)?;
        }
        if run >= WARM_UP_RUNS {
            samples.push(times);
        }
    }
    Ok(samples)
}

/// Checks that both fill the same pixels with the same depths, and fill some unless none was empty.
fn check(gpu: &Gpu, depths: &[wgpu::Buffer; 2], size_px: [u32; 2], surface: &[[u32; 2]]) -> Result<()> {
    let read = |buffer| -> Result<Vec<u32>> {
        Ok(layout::of_image(&bytemuck::pod_collect_to_vec(&readback::read_buffer(gpu, buffer)?), size_px))
    };
    let (separable, direct) = (read(&depths[0])?, read(&depths[1])?);
    ensure!(separable == direct, "the two forms found different depths");
    let num_empty =
        |depths: &mut dyn Iterator<Item = u32>| depths.filter(|&d| d == layout::EMPTY_DEPTH).count();
    let before = num_empty(&mut layout::without_guard(surface, size_px).iter().map(|p| p[0]));
    let after = num_empty(&mut separable.into_iter());
    ensure!(after < before || before == 0, "nothing was filled: {before} pixels empty before, {after} after");
    Ok(())
}
