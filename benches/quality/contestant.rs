//! The ways to draw that are compared, and the truth that they are compared with.

use anyhow::{Context, Result};
use base::space::View;
use base::task::Progress;
use cloud::Cloud;
use kit::frames::{image, sample_options};
use kit::quality::picture::{EyePicture, only_eye};
use kit::quality::scene::DrawnScan;
use kit::quality::supersample::{self, FACTOR};
use lab::bench::point_list::{self, VertexList};
use render::DrawOptions;
use render::gpu::{Gpu, readback};
use render::layout::depth_of;
use render::options::{Dilate, Precision, Quality};
use render::{self, CloudBuffers, EyeImage, Renderer, Setup};
use scanwalk::config::{Config, FrameConfig};
use scanwalk::resolve::Plan;
use std::sync::Arc;

/// Color of pixels without points, in the truth and for all contestants.
const BACKGROUND: [u8; 3] = [0, 0, 0];
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// One way to draw an eye.
pub trait EyeContestant {
    /// Draws the view's one eye; `lod_scale` is a factor on the thresholds of level of detail, if it knows any.
    fn draw(&mut self, view: &View, lod_scale: f32) -> Result<EyePicture>;
}

/// Makes a contestant for a scene, to draw pictures of this size.
pub type MakeContestant = fn(&Arc<Gpu>, &DrawnScan, [u32; 2]) -> Result<Box<dyn EyeContestant>>;

/// All contestants by name; the others' holes and flicker are told as shares of the first one's.
pub const CONTESTANTS: [(&str, MakeContestant); 9] = [
    ("point-list", |gpu, scene, size_px| Ok(Box::new(EyeHardware::new(gpu, &scene.cloud, size_px)?))),
    ("closest-flat", |gpu, scene, size_px| flat(gpu, scene, size_px, sample_options())),
    ("hqs-flat", |gpu, scene, size_px| flat(gpu, scene, size_px, hqs(&|_| ()))),
    ("lod-hqs", |gpu, scene, size_px| layered(gpu, scene, size_px, hqs(&|_| ()))),
    ("lod-hqs-fade", |gpu, scene, size_px| layered(gpu, scene, size_px, hqs(&|c| c.lod.fade = true))),
    ("lod-hqs-fade-fill", |gpu, scene, size_px| {
        layered(gpu, scene, size_px, hqs(&|c| (c.lod.fade, c.frame.fill) = (true, true)))
    }),
    ("lod-hqs-fade-rings", |gpu, scene, size_px| {
        layered(gpu, scene, size_px, hqs(&|c| (c.lod.fade, c.frame.dilate) = (true, Dilate::Rings)))
    }),
    ("lod-hqs-fill-rings", |gpu, scene, size_px| {
        layered(gpu, scene, size_px, hqs(&|c| (c.frame.fill, c.frame.dilate) = (true, Dilate::Rings)))
    }),
    // The program draws with these options unless told otherwise.
    ("lod-hqs-fade-fill-rings", |gpu, scene, size_px| {
        layered(gpu, scene, size_px, Plan::default().draw.options)
    }),
];

/// Draw options of high-quality shading, with what else is switched on.
fn hqs(switch_on: &dyn Fn(&mut Config)) -> DrawOptions {
    let mut config =
        Config { frame: FrameConfig { background: BACKGROUND, ..Default::default() }, ..Default::default() };
    config.frame.quality = Quality::Hqs;
    (config.frame.dilate, config.frame.fill, config.lod.fade) = (Dilate::Off, false, false);
    switch_on(&mut config);
    Plan::of(&config).draw.options
}

fn flat(
    gpu: &Arc<Gpu>,
    scene: &DrawnScan,
    size_px: [u32; 2],
    options: DrawOptions,
) -> Result<Box<dyn EyeContestant>> {
    let cloud = CloudBuffers::upload(gpu, &scene.cloud, 0, &Progress::hidden())?;
    Ok(Box::new(EyeCompute::new(gpu, cloud, size_px, options)?))
}

fn layered(
    gpu: &Arc<Gpu>,
    scene: &DrawnScan,
    size_px: [u32; 2],
    options: DrawOptions,
) -> Result<Box<dyn EyeContestant>> {
    let cloud = CloudBuffers::upload_layered(gpu, &scene.octree, 0, &Progress::hidden())?;
    Ok(Box::new(EyeCompute::new(gpu, cloud, size_px, options)?))
}

/// The truth: all points of a denser scan of the same place, at full precision, 4 × 4 samples a pixel.
pub struct Truth(EyeCompute);

impl Truth {
    /// Makes the truth, to draw pictures of this size.
    ///
    /// # Errors
    /// If the scan or the size does not fit the GPU.
    pub fn new(gpu: &Arc<Gpu>, dense: &Cloud, size_px: [u32; 2]) -> Result<Self> {
        let cloud = CloudBuffers::upload(gpu, dense, 0, &Progress::hidden())?;
        Ok(Self(EyeCompute::new(gpu, cloud, size_px, hqs(&|c| c.frame.precision = Precision::Full))?))
    }
}

impl EyeContestant for Truth {
    fn draw(&mut self, view: &View, lod_scale: f32) -> Result<EyePicture> {
        let places = (0..FACTOR * FACTOR).map(|i| [i % FACTOR, i / FACTOR]);
        let parts: Result<Vec<EyePicture>> =
            places.map(|place| self.0.draw(&supersample::part(view, place), lod_scale)).collect();
        Ok(supersample::filtered(&parts?, BACKGROUND))
    }
}

/// The program's own renderer.
struct EyeCompute {
    gpu: Arc<Gpu>,
    renderer: Renderer,
    image: wgpu::Texture,
    frame: u64,
}

impl EyeCompute {
    fn new(gpu: &Arc<Gpu>, cloud: CloudBuffers, size_px: [u32; 2], options: DrawOptions) -> Result<Self> {
        let atomics = render::tier(gpu, None)?;
        let setup = Setup { sizes_px: vec![size_px], color_format: FORMAT, depth_format: None, atomics };
        let mut renderer = Renderer::new(gpu, setup, options)?;
        renderer.set_cloud(cloud)?;
        Ok(Self { gpu: Arc::clone(gpu), renderer, image: image(gpu, size_px, FORMAT), frame: 0 })
    }

    fn depths(&self) -> Result<Vec<f32>> {
        Ok(self.renderer.read_pixels(0)?.into_iter().map(depth_of).collect())
    }
}

impl EyeContestant for EyeCompute {
    fn draw(&mut self, view: &View, lod_scale: f32) -> Result<EyePicture> {
        self.frame += 1;
        self.renderer.set_lod_scale(lod_scale);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let color = &self.image.create_view(&Default::default());
        self.renderer.record(&mut encoder, self.frame, &[EyeImage { color, depth: None }]);
        {
            let queue = self.gpu.queue.lock();
            self.renderer.set_view(&queue, view);
            queue.submit([encoder.finish()]);
        }
        self.renderer.submitted();
        let rgb = colors(&self.gpu, &self.image)?;
        self.renderer.collect_times().context("the GPU gave no frame back")?;
        let size_px = only_eye(view).size_px;
        Ok(EyePicture { size_px, rgb, depth: self.depths()? })
    }
}

/// Hardware points, one pixel each.
struct EyeHardware {
    gpu: Arc<Gpu>,
    point_list: VertexList,
    image: wgpu::Texture,
    frame: u64,
}

impl EyeHardware {
    fn new(gpu: &Arc<Gpu>, cloud: &Cloud, size_px: [u32; 2]) -> Result<Self> {
        let point_list = VertexList::new(gpu, cloud, &[size_px])?;
        let image = image(gpu, size_px, point_list::FORMAT);
        Ok(Self { gpu: Arc::clone(gpu), point_list, image, frame: 0 })
    }
}

impl EyeContestant for EyeHardware {
    fn draw(&mut self, view: &View, _lod_scale: f32) -> Result<EyePicture> {
        self.frame += 1;
        let image = self.image.create_view(&Default::default());
        self.point_list.draw(&self.gpu, self.frame, &[image], view);
        let rgb = colors(&self.gpu, &self.image)?;
        self.point_list.collect_ms(&self.gpu).context("the GPU gave no frame back")?;
        let depth = self.point_list.depths(&self.gpu, 0, view.near)?;
        Ok(EyePicture { size_px: only_eye(view).size_px, rgb, depth })
    }
}

/// The image's colors; waits until it is drawn.
fn colors(gpu: &Gpu, image: &wgpu::Texture) -> Result<Vec<[u8; 3]>> {
    let rgba = readback::read_texture(gpu, image)?;
    Ok(rgba.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect())
}
