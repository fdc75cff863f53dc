//! What several tests share: clouds made of nothing, and a frame drawn on the GPU and read back.
#![allow(dead_code, reason = "each test file uses a part")]

use glam::DVec3;
use scanwalk::cloud::{Cloud, Order, build};
use scanwalk::gpu::{Gpu, readback};
use scanwalk::progress::Progress;
use scanwalk::render::{CloudBuffers, FrameTimes, Renderer};
use scanwalk::scan::{ColorSource, Lattice, Points, Scan, ScanFile};
use scanwalk::space::{Bounds, View};
use std::sync::{Arc, OnceLock};

/// The GPU, opened once a test program.
pub fn gpu() -> Arc<Gpu> {
    static GPU: OnceLock<Arc<Gpu>> = OnceLock::new();
    GPU.get_or_init(|| Arc::new(Gpu::open(None).expect("tests need a Vulkan driver: run scripts/test")))
        .clone()
}

/// splitmix64: reproducible numbers without a dependency.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Points in a box of `edge` world units, in steps of a millimetre.
pub fn random_points(count: usize, edge: f64, seed: u64) -> Vec<[i32; 3]> {
    let mut random = Random(seed);
    let mut axis = || (random.unit() * edge * 1000.0) as i32;
    (0..count).map(|_| [axis(), axis(), axis()]).collect()
}

/// A scan of lattice points; the colour of point i is made from i.
pub fn scan_of(xyz: &[[i32; 3]], scale: f64, offset: DVec3) -> Scan {
    let lattice = Lattice { scale: DVec3::splat(scale), offset };
    let bounds = xyz.iter().fold(Bounds::EMPTY, |b, &p| b.with(lattice.p_in_world(p)));
    let rgb =
        (0..xyz.len()).map(|i| [i as u16 & 255, (i >> 8) as u16 & 255, (i >> 16) as u16 & 255]).collect();
    let points = Points { xyz: xyz.to_vec(), rgb, intensity: vec![] };
    let file = ScanFile {
        path: "made-up".into(),
        format: "made up".into(),
        lattice,
        points,
        color: ColorSource::Rgb8,
        bounds,
    };
    Scan { files: vec![file], ..Scan::default() }
}

pub fn cloud_of(xyz: &[[i32; 3]], scale: f64, offset: DVec3, order: Order) -> Cloud {
    build(scan_of(xyz, scale, offset), order, &Progress::hidden()).expect("a cloud")
}

/// A frame, read back.
pub struct Drawn {
    pub depth: Vec<Vec<u64>>,
    pub images: Vec<Vec<u32>>,
    pub times: FrameTimes,
    pub visible: Vec<u8>,
    pub counters: Vec<u8>,
    pub num_chunks: usize,
}

/// Draws one frame of `cloud` on the GPU, background (1, 2, 3).
pub fn draw(cloud: &Cloud, view: &View, full_precision: bool, chunk_limit: u64) -> Drawn {
    let gpu = gpu();
    let buffers = CloudBuffers::upload(&gpu, cloud, chunk_limit, &Progress::hidden()).expect("upload");
    let num_chunks = buffers.num_chunks();
    let sizes: Vec<[u32; 2]> = view.eyes.iter().map(|e| e.size_px).collect();
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let mut renderer = Renderer::new(&gpu, &sizes, format).expect("renderer");
    renderer.set_cloud(buffers);
    renderer.set_full_precision(full_precision);
    renderer.set_background([1, 2, 3]);
    let images: Vec<wgpu::Texture> = sizes.iter().map(|&s| image(&gpu, s, format)).collect();
    let views: Vec<_> = images.iter().map(|i| i.create_view(&Default::default())).collect();
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    renderer.record(&mut encoder, 7, &views.iter().collect::<Vec<_>>());
    {
        let queue = gpu.queue.lock();
        renderer.set_view(&queue, view);
        queue.submit([encoder.finish()]);
    }
    renderer.submitted();
    let read = |b: &wgpu::Buffer| readback::read_buffer(&gpu, b).expect("readback");
    let words = |bytes: Vec<u8>| -> Vec<u64> { bytemuck::pod_collect_to_vec(&bytes) };
    let depth = sizes.iter().enumerate().map(|(eye, s)| {
        let mut pixels = words(read(&renderer.targets().depth[eye]));
        pixels.truncate((s[0] * s[1]) as usize);
        pixels
    });
    let depth = depth.collect();
    let pixels =
        |t: &wgpu::Texture| bytemuck::pod_collect_to_vec(&readback::read_texture(&gpu, t).expect("image"));
    let images = images.iter().map(pixels).collect();
    let (visible, counters) = renderer.cull_results();
    let (visible, counters) = (read(visible[0]), read(counters));
    let times = renderer.collect_times().expect("the frame is done: everything was read back");
    Drawn { depth, images, times, visible, counters, num_chunks }
}

pub fn image(gpu: &Gpu, size_px: [u32; 2], format: wgpu::TextureFormat) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
    gpu.texture("image", size_px, format, usage)
}
