//! Dilation on the GPU of surfaces, or of depths and sums, without a renderer.

use kit::frames::gpu;
use lab::reference::color::Sum;
use render::bindings::{EyeSet, OfEye};
use render::gpu::readback;
use render::gpu::stage::Stage;
use render::layout::{
    DilateUniform, GUARD_PX, PACKED_BLUE_SHIFT, PACKED_GREEN_SHIFT, PACKED_RED_SHIFT, Pixel, ResolveUniform,
    Sums, Variant, ViewUniform, guarded, image_pitch_px, mask_words_per_row, of_image,
};
use render::{shaders, tiles};
use wgpu::util::DeviceExt;

/// The GPU's image of a surface.
pub fn on_gpu(view: &ViewUniform, eye: usize, surface: &[Pixel]) -> Vec<Pixel> {
    run("dilate", Variant::eyes(2), (view, eye), &[("surface", bytemuck::cast_slice(surface))])
}

/// The GPU's image of depths and sums, which stand in four words or in one.
pub fn blended_on_gpu(view: &ViewUniform, eye: usize, depth: &[u32], sums: &[Sum]) -> [Vec<Pixel>; 2] {
    let packed: Vec<u64> = sums.iter().map(|&[r, g, b, n]| pack([n, r, g, b])).collect();
    let inputs: [(&str, &[u8]); 3] = [
        ("depth", bytemuck::cast_slice(depth)),
        ("sums", bytemuck::cast_slice(&packed)),
        ("wide", bytemuck::cast_slice(sums)),
    ];
    [Sums::Packed, Sums::Wide]
        .map(|sums| run("blend-dilate", Variant { sums, ..Variant::eyes(2) }, (view, eye), &inputs))
}

/// Packs 10 bits of a count and 18 of each channel.
fn pack(words: [u32; 4]) -> u64 {
    let shifts = [0, PACKED_RED_SHIFT, PACKED_GREEN_SHIFT, PACKED_BLUE_SHIFT];
    words.iter().zip(shifts).fold(0, |sum, (&word, shift)| sum | u64::from(word) << shift)
}

/// What lenses hide, and how the image holds the other pixels.
#[derive(Default)]
pub struct ShownAs {
    /// A bit for each pixel, in rows of [`mask_words_per_row`]; empty if no pixel is hidden.
    pub hidden: Vec<u32>,
    /// The background as the image holds it.
    pub background: u32,
    pub is_bgra: bool,
}

/// The GPU's image: see [`run_shown`].
fn run(
    shader: &'static str,
    variant: Variant,
    of: (&ViewUniform, usize),
    inputs: &[(&'static str, &[u8])],
) -> Vec<Pixel> {
    run_shown(shader, variant, of, inputs, &ShownAs::default())
}

/// The GPU's image of inputs that have no guard band: it is empty round them, as the CPU reference sees it. The
/// buffers hold something else before, so that no pixel can be left out unseen.
pub fn run_shown(
    shader: &'static str,
    variant: Variant,
    (view, eye): (&ViewUniform, usize),
    inputs: &[(&'static str, &[u8])],
    shown: &ShownAs,
) -> Vec<Pixel> {
    let gpu = gpu();
    let stage: Stage<EyeSet> = Stage::new(&gpu, shader, &shaders::source(shader, variant)).expect("a stage");
    let buffer = |label, contents: &[u8], usage| {
        let contents = wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage };
        gpu.device.create_buffer_init(&contents)
    };
    let (uniform, storage) = (wgpu::BufferUsages::UNIFORM, wgpu::BufferUsages::STORAGE);
    let size_px = [view.eyes[eye].width, view.eyes[eye].height];
    let dilate = DilateUniform { eye: eye as u32 };
    let mut view = *view;
    for eye in &mut view.eyes {
        eye.first_px = eye.first_px.map(|px| px - GUARD_PX as f32);
        eye.end_px = eye.end_px.map(|px| px + GUARD_PX as f32);
        [eye.width, eye.height] = guarded(size_px);
    }
    let no_mask = vec![0; (mask_words_per_row(size_px[0]) * size_px[1]) as usize];
    let hidden = if shown.hidden.is_empty() { &no_mask } else { &shown.hidden };
    let tiles = tiles(size_px, hidden);
    let resolve = ResolveUniform { size_px, background: shown.background, is_bgra: shown.is_bgra.into() };
    let poison = vec![0xab; (4 * image_pitch_px(size_px[0]) * size_px[1]) as usize];
    let read = storage | wgpu::BufferUsages::COPY_SRC;
    let mut buffers = vec![
        ("image_depth", buffer("image_depth", &poison, read)),
        ("image_color", buffer("image_color", &poison, read)),
        ("view", buffer("view", bytemuck::bytes_of(&view), uniform)),
        ("dilate", buffer("dilate", bytemuck::bytes_of(&dilate), uniform)),
        ("resolve", buffer("resolve", bytemuck::bytes_of(&resolve), uniform)),
        ("hidden", buffer("hidden", bytemuck::cast_slice(hidden), storage)),
        ("tiles", buffer("tiles", bytemuck::cast_slice(&tiles), storage)),
    ];
    let inputs =
        inputs.iter().map(|&(name, bytes)| (name, buffer(name, &with_guard(bytes, size_px), storage)));
    buffers.extend(inputs);
    let unused = buffer("unused", &[0; 16], storage);
    let of_name = |name| buffers.iter().find(|(of, _)| *of == name).map_or(&unused, |(_, buffer)| buffer);
    let group = stage.bind(&gpu, &OfEye::by_name(|name| of_name(name).as_entire_binding()));
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    stage.dispatch(&mut encoder.begin_compute_pass(&Default::default()), &group, tiles.len() as u32);
    gpu.queue.lock().submit([encoder.finish()]);
    let [depth, color] = [0, 1].map(|number: usize| -> Vec<u32> {
        let bytes = readback::read_buffer(&gpu, &buffers[number].1).expect("an image");
        of_image(&bytemuck::pod_collect_to_vec(&bytes), size_px)
    });
    depth.into_iter().zip(color).map(|(depth, color)| [depth, color]).collect()
}

/// Adds an empty guard band to pixels.
fn with_guard(pixels: &[u8], size_px: [u32; 2]) -> Vec<u8> {
    let bytes = pixels.len() / (size_px[0] * size_px[1]) as usize;
    let [columns, rows] = guarded(size_px).map(|size| size as usize);
    let (guard, row) = (GUARD_PX as usize, size_px[0] as usize * bytes);
    // These bytes are empty pixels if they are depths.
    let mut guarded = vec![0xff; columns * rows * bytes];
    for (from, to) in pixels.chunks_exact(row).zip(guarded.chunks_exact_mut(columns * bytes).skip(guard)) {
        to[guard * bytes..][..row].copy_from_slice(from);
    }
    guarded
}
