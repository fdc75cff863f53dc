//! Helpers of several tests: made-up clouds, and a frame drawn on the GPU and read back.

use cloud::Cloud;
use cloud::octree::{Octree, build_octree};
use cloud::spt::{SequentialCloud, build_spt};
use glam::{DQuat, DVec3};
use lab::order::Order;
use render::gpu::{Atomics, Gpu, QueueGuard, readback};
use render::options::{Dilate, Quality};

use base::random::mix;
use base::space::{Eye, Fov, Pose, View};
use base::task::Progress;
use lab::reference::ReferenceFrame;
use lab::reference::resolve::EMPTY;
use lab::synth::{self, SynthKind};
use lab::technique::{LabTechnique, tree};
use points::{Grid, Scan, ScanBuilder};
use render::layout::{ALL_PLANES, CullCounters, Detail, EMPTY_DEPTH, Pixel, VisibleBatch, without_guard};
use render::{Access, DrawOptions};
use render::{CloudBuffers, EyeImage, FrameTimes, IMAGE_USAGES, Renderer, Setup, Targets, UploadError};
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// The GPU, opened once a test program.
pub fn gpu() -> Arc<Gpu> {
    static GPU: OnceLock<Arc<Gpu>> = OnceLock::new();
    GPU.get_or_init(|| Arc::new(Gpu::open(None).expect("tests need a Vulkan driver: run scripts/test")))
        .clone()
}

/// splitmix64: reproducible numbers without a dependency.
pub struct SplitMix(pub u64);

impl SplitMix {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A whole number in [0, `end`).
    pub fn below(&mut self, end: i32) -> i32 {
        (self.bits() % end as u64) as i32
    }
}

/// A courtyard as a scanner sees it, made up: 600 000 points.
pub fn courtyard() -> Scan {
    made_up(SynthKind::Terrestrial, 600_000)
}

/// A made-up scan of this kind and number of points.
pub fn made_up(kind: SynthKind, points: u64) -> Scan {
    crate::made_up::scan(kind, points, 7).expect("a scan")
}

/// Points in a box of `edge` world units, in steps of a millimeter.
pub fn random_points(count: usize, edge: f64, seed: u64) -> Vec<[i32; 3]> {
    let mut random = SplitMix(seed);
    let mut axis = || (random.unit() * edge * 1000.0) as i32;
    (0..count).map(|_| [axis(), axis(), axis()]).collect()
}

/// A scan of grid points; the color of point i is made from i.
pub fn scan_of(xyz: &[[i32; 3]], scale: f64, offset: DVec3) -> Scan {
    let grid = Grid { scale: DVec3::splat(scale), offset };
    let rgb =
        (0..xyz.len()).map(|i| [i as u16 & 255, (i >> 8) as u16 & 255, (i >> 16) as u16 & 255]).collect();
    ScanBuilder::new(grid, xyz.to_vec()).rgb(rgb).scan()
}

pub fn cloud_of(xyz: &[[i32; 3]], scale: f64, offset: DVec3, order: Order) -> Cloud {
    order.build(&scan_of(xyz, scale, offset), &Progress::hidden()).expect("a cloud")
}

/// Detail for tests: a point is always one pixel, and those of a node come all at once.
pub const SAMPLE_DETAIL: Detail = Detail {
    forced_planes: 0,
    threshold_px: [100.0, 200.0, 300.0],
    ring_rad: [20.0 * PI / 180.0, 38.0 * PI / 180.0],
    smooth: false,
    fade: false,
    fill_reach_px: None,
};

/// Draw options for tests: `closest` quality, nothing dilated.
pub fn sample_options() -> DrawOptions {
    let (quality, dilate, access) = (Quality::Closest, Dilate::Off, Access::default());
    DrawOptions { quality, dilate, background: [0; 3], detail: SAMPLE_DETAIL, access }
}

/// Draw options of `closest` quality, one pixel a point, background (1, 2, 3).
pub fn plain(full_precision: bool) -> DrawOptions {
    let detail = Detail { forced_planes: if full_precision { ALL_PLANES } else { 0 }, ..SAMPLE_DETAIL };
    DrawOptions { background: [1, 2, 3], detail, ..sample_options() }
}

/// A frame, read back; pixels have an entry per eye.
pub struct Drawn {
    pub keys: Vec<Vec<u64>>,
    pub depth: Vec<Vec<u32>>,
    pub wide: Vec<Vec<[u32; 4]>>,
    pub surface: Vec<Vec<Pixel>>,
    pub pixels: Vec<Vec<Pixel>>,
    pub images: Vec<Vec<u32>>,
    pub times: FrameTimes,
    /// Visible batches of the first chunk, in batch order.
    pub visible: Vec<VisibleBatch>,
    pub states: Vec<u32>,
}

/// A renderer with images of its own.
pub struct Canvas {
    pub gpu: Arc<Gpu>,
    pub renderer: Renderer,
    images: Vec<wgpu::Texture>,
    frame: u64,
}

impl Canvas {
    pub fn new(sizes_px: &[[u32; 2]], options: DrawOptions, atomics: Atomics) -> Self {
        Self::on(gpu(), sizes_px, options, atomics, LabTechnique::OWN)
    }

    /// A canvas on any device, by any technique.
    pub fn on(
        gpu: Arc<Gpu>,
        sizes_px: &[[u32; 2]],
        options: DrawOptions,
        atomics: Atomics,
        technique: LabTechnique,
    ) -> Self {
        let color_format = wgpu::TextureFormat::Rgba8UnormSrgb;
        let setup = Setup { sizes_px: sizes_px.to_vec(), color_format, depth_format: None, atomics };
        let technique = technique.open(&gpu);
        let renderer = Renderer::with_technique(&gpu, setup, options, technique).expect("renderer");
        let images = sizes_px.iter().map(|&s| image(&gpu, s, color_format)).collect();
        Self { gpu, renderer, images, frame: 0 }
    }

    /// A canvas for a view, with a flat cloud.
    pub fn flat(cloud: &Cloud, view: &View, options: DrawOptions, chunk_limit: u64) -> Self {
        Self::flat_by(LabTechnique::OWN, cloud, view, options, chunk_limit)
    }

    /// A canvas for a view, with a flat cloud, by any technique.
    pub fn flat_by(
        technique: LabTechnique,
        cloud: &Cloud,
        view: &View,
        options: DrawOptions,
        chunk_limit: u64,
    ) -> Self {
        Self::showing(technique, view, options, gpu().atomics(), |gpu, progress| {
            CloudBuffers::upload(gpu, cloud, chunk_limit, progress)
        })
    }

    /// A canvas for a view, with a layered cloud.
    pub fn layered(
        octree: &Octree,
        view: &View,
        options: DrawOptions,
        atomics: Atomics,
        chunk_limit: u64,
    ) -> Self {
        Self::layered_by(LabTechnique::OWN, octree, view, options, atomics, chunk_limit)
    }

    /// A canvas for a view, with a layered cloud, by any technique.
    pub fn layered_by(
        technique: LabTechnique,
        octree: &Octree,
        view: &View,
        options: DrawOptions,
        atomics: Atomics,
        chunk_limit: u64,
    ) -> Self {
        Self::showing(technique, view, options, atomics, |gpu, progress| {
            CloudBuffers::upload_layered(gpu, octree, chunk_limit, progress)
        })
    }

    /// A canvas for a view, with a layered cloud, by any technique, which counts; with the bins of its counts.
    pub fn counting(
        octree: &Octree,
        view: &View,
        options: DrawOptions,
        technique: LabTechnique,
    ) -> (Self, wgpu::Buffer) {
        let mut canvas = Self::layered(octree, view, options, gpu().atomics(), 0);
        let setup = Setup {
            sizes_px: sizes(view),
            color_format: wgpu::TextureFormat::Rgba8UnormSrgb,
            depth_format: None,
            atomics: gpu().atomics(),
        };
        let cloud = canvas.renderer.take_cloud().expect("a cloud");
        let (technique, bins) = technique.counting(&canvas.gpu);
        canvas.renderer = Renderer::with_technique(&canvas.gpu, setup, options, technique).expect("renderer");
        canvas.renderer.set_cloud(cloud).expect("room");
        (canvas, bins)
    }

    /// A canvas for a view, with a sequential point tree, whose discs may be wrong by `error_px` pixels.
    pub fn sequential(
        spt: &SequentialCloud,
        error_px: f32,
        view: &View,
        options: DrawOptions,
        atomics: Atomics,
        chunk_limit: u64,
    ) -> Self {
        Self::sequential_by(LabTechnique::tree(error_px), spt, view, options, atomics, chunk_limit)
    }

    /// A canvas for a view, with a sequential point tree, by any technique of trees.
    pub fn sequential_by(
        technique: LabTechnique,
        spt: &SequentialCloud,
        view: &View,
        options: DrawOptions,
        atomics: Atomics,
        chunk_limit: u64,
    ) -> Self {
        Self::showing(technique, view, options, atomics, |gpu, progress| {
            tree::upload(gpu, spt, chunk_limit, progress)
        })
    }

    /// A canvas for a view, with the cloud that `upload` sends.
    fn showing(
        technique: LabTechnique,
        view: &View,
        options: DrawOptions,
        atomics: Atomics,
        upload: impl FnOnce(&Gpu, &Progress) -> Result<CloudBuffers, UploadError>,
    ) -> Self {
        let mut canvas = Self::on(gpu(), &sizes(view), options, atomics, technique);
        let buffers = upload(&canvas.gpu, &Progress::hidden()).expect("upload");
        canvas.renderer.set_cloud(buffers).expect("room");
        canvas
    }

    /// Draws a frame and reads everything back.
    pub fn draw(&mut self, view: &View) -> Drawn {
        self.draw_with(view, |_, _| ())
    }

    /// Draws a frame; `tell` tells the renderer more of it before it is submitted.
    pub fn draw_with(&mut self, view: &View, tell: impl FnOnce(&Renderer, &QueueGuard)) -> Drawn {
        let views: Vec<_> = self.images.iter().map(|i| i.create_view(&Default::default())).collect();
        let eyes: Vec<EyeImage> = views.iter().map(|color| EyeImage { color, depth: None }).collect();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.renderer.record(&mut encoder, self.frame, &eyes);
        self.frame += 1;
        {
            let queue = self.gpu.queue.lock();
            self.renderer.set_view(&queue, view);
            tell(&self.renderer, &queue);
            queue.submit([encoder.finish()]);
        }
        self.renderer.submitted();
        let gpu = &self.gpu;
        let read = |b: &wgpu::Buffer| readback::read_buffer(gpu, b).expect("readback");
        let image = |t| bytemuck::pod_collect_to_vec(&readback::read_texture(gpu, t).expect("image"));
        let (visible, counters, states) = self.renderer.cull_results();
        let counters: CullCounters =
            bytemuck::pod_read_unaligned(&read(counters)[..size_of::<CullCounters>()]);
        let mut visible: Vec<VisibleBatch> = bytemuck::pod_collect_to_vec(&read(visible[0]));
        visible.truncate(counters.num_visible as usize);
        visible.sort_by_key(|v| (v.first_point, v.flags));
        let targets = self.renderer.targets();
        // The CPU reference has no color where there is no point.
        let of_reference = |[depth, color]: Pixel| if depth == EMPTY_DEPTH { EMPTY } else { [depth, color] };
        let finished = (0..view.eyes.len()).map(|eye| {
            let pixels = self.renderer.read_pixels(eye).expect("readback");
            pixels.into_iter().map(of_reference).collect()
        });
        Drawn {
            keys: of_eyes(targets, &targets.keys, &read),
            depth: of_eyes(targets, &targets.depth, &read),
            wide: if targets.has_wide() { of_eyes(targets, &targets.wide, &read) } else { vec![] },
            surface: of_eyes(targets, &targets.surface, &read),
            pixels: finished.collect(),
            images: self.images.iter().map(image).collect(),
            states: bytemuck::pod_collect_to_vec(&read(states.expect("a cloud"))),
            visible,
            times: self.renderer.collect_times().expect("the frame is done: everything was read back"),
        }
    }
}

/// Both eyes' pixels of a target, without their guard bands.
fn of_eyes<T: bytemuck::Pod>(
    targets: &Targets,
    pair: &[wgpu::Buffer; 2],
    read: &dyn Fn(&wgpu::Buffer) -> Vec<u8>,
) -> Vec<Vec<T>> {
    targets.drawn_px.iter().zip(pair).map(|(&size, buffer)| of_eye(&read(buffer), size)).collect()
}

fn of_eye<T: bytemuck::Pod>(bytes: &[u8], size_px: [u32; 2]) -> Vec<T> {
    without_guard(&bytemuck::pod_collect_to_vec::<u8, T>(bytes), size_px)
}

pub fn sizes(view: &View) -> Vec<[u32; 2]> {
    view.eyes.iter().map(|e| e.size_px).collect()
}

/// Draws one frame of a flat cloud, [`plain`].
pub fn draw(cloud: &Cloud, view: &View, full_precision: bool, chunk_limit: u64) -> Drawn {
    Canvas::flat(cloud, view, plain(full_precision), chunk_limit).draw(view)
}

pub fn image(gpu: &Gpu, size_px: [u32; 2], format: wgpu::TextureFormat) -> wgpu::Texture {
    let usage = IMAGE_USAGES | wgpu::TextureUsages::COPY_SRC;
    gpu.texture("image", size_px, format, usage)
}

/// A stereo view with asymmetric, canted eyes.
pub fn stereo(eye: DVec3, target: DVec3, size_px: [u32; 2]) -> View {
    let head = Pose::look_at(eye, target, DVec3::Z);
    let side = |sign: f64| {
        let cant = Pose {
            position: DVec3::X * sign * 0.0315,
            orientation: DQuat::from_rotation_y(-sign * 5f64.to_radians()),
        };
        let (outer, inner) = (1.1, 0.8);
        let fov = if sign < 0.0 {
            Fov { left: -outer, right: inner, up: 1.0, down: -1.2 }
        } else {
            Fov { left: -inner, right: outer, up: 1.0, down: -1.2 }
        };
        Eye { world_from_view: head.then(&cant), fov, size_px, gaze_in_view: Eye::AHEAD }
    };
    View { eyes: vec![side(-1.0), side(1.0)], near: 0.05 }
}

/// A view of one eye that sees this far to each side, as a tangent.
pub fn mono(eye: DVec3, target: DVec3, tangent: f64, size_px: [u32; 2]) -> View {
    let world_from_view = Pose::look_at(eye, target, DVec3::Z);
    let fov = Fov { left: -tangent, right: tangent, up: tangent, down: -tangent };
    View { eyes: vec![Eye { world_from_view, fov, size_px, gaze_in_view: Eye::AHEAD }], near: 0.05 }
}

/// A view along the made-up courtyard from within: near and far nodes, all rings.
pub fn inside(size_px: [u32; 2]) -> View {
    let place = synth::viewpoints(SynthKind::Terrestrial)[1];
    stereo(place.eye, place.target, size_px)
}

pub fn octree_of(scan: &Scan) -> Octree {
    build_octree(scan, &Progress::hidden()).expect("an octree")
}

pub fn spt_of(scan: &Scan, cull_backfaces: bool) -> SequentialCloud {
    build_spt(scan, cull_backfaces, &Progress::hidden()).expect("a point tree")
}

/// Detail for discs, which have their own sizes.
pub fn discs() -> Detail {
    Detail { fill_reach_px: Some([1.0; 3]), ..SAMPLE_DETAIL }
}

pub fn hqs(detail: Detail) -> DrawOptions {
    DrawOptions { quality: Quality::Hqs, background: [1, 2, 3], detail, ..sample_options() }
}

/// Tiers that this machine's GPU has.
pub fn tiers() -> Vec<Atomics> {
    let all = [Atomics::Int32, Atomics::Int64Minmax, Atomics::Int64];
    all.into_iter().filter(|&tier| tier <= gpu().atomics()).collect()
}

/// Number of pixels that differ in two pictures of the same size.
pub fn num_differing<T: PartialEq>(a: &[T], b: &[T]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

/// Says what of a frame differs from the CPU reference's.
pub fn difference(drawn: &Drawn, want: &ReferenceFrame) -> Option<String> {
    if drawn.visible != want.visible {
        return Some(format!("{} visible batches, not {}", drawn.visible.len(), want.visible.len()));
    }
    for eye in 0..want.pixels.len() {
        let differing = num_differing(&drawn.pixels[eye], &want.pixels[eye]);
        if differing > 0 || drawn.images[eye] != want.images[eye] {
            return Some(format!("eye {eye}: {differing} pixels"));
        }
    }
    None
}
