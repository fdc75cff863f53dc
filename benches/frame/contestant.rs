//! The ways to draw both eyes that are compared: each draws whole frames of the same view and tells its times.

use crate::heat::{ComputePlan, HeatEntry};
use anyhow::{Context, Result};
use base::space::View;
use base::task::Progress;
use cloud::Cloud;
use kit::quality::scene::DrawnScan;
use lab::bench::point_list::{self, VertexList};
use render::DrawOptions;
use render::gpu::Gpu;
use render::layout::{ALL_PLANES, Pixel};
use render::{CloudBuffers, EyeImage, FrameTimes, IMAGE_USAGES, Renderer, Setup};
use std::sync::Arc;
use std::time::Instant;
use timing::STAGES;

/// Format of the images: sRGB, as headsets have it.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Times of one frame of both eyes, milliseconds; NaN where a contestant has no such stage.
#[derive(Clone, Copy, Debug)]
pub struct FrameSample {
    /// GPU time of each of [`STAGES`]; of two renderers, the sum.
    pub stage_ms: [f64; STAGES.len()],
    /// GPU time of the whole frame.
    pub gpu_ms: f64,
    /// Time from submission until the CPU knows that the GPU is done.
    pub wall_ms: f64,
    /// Points that were loaded; of two renderers or draws, the sum.
    pub points_read: u64,
    /// Batches that were drawn; of two renderers, the sum.
    pub visible_batches: u64,
}

/// One way to draw both eyes.
pub trait StereoContestant {
    /// Draws a frame and waits for it.
    fn draw(&mut self, view: &View) -> Result<FrameSample>;

    /// Both eyes' pixels of a frame that is drawn from all coordinate bits. A renderer for one eye may need fewer bits
    /// than one for both, and hardware points have all.
    fn pixels(&mut self, view: &View) -> Result<[Vec<Pixel>; 2]>;
}

/// Makes the contestant of an entry.
///
/// # Errors
/// If it does not fit the GPU.
pub fn make(
    gpu: &Arc<Gpu>,
    scene: &DrawnScan,
    size_px: [u32; 2],
    entry: HeatEntry,
) -> Result<Box<dyn StereoContestant>> {
    Ok(match entry {
        HeatEntry::Compute(plan) => Box::new(StereoCompute::new(gpu, scene, size_px, plan)?),
        HeatEntry::Hardware => Box::new(StereoHardware::new(gpu, &scene.cloud, size_px)?),
    })
}

/// The compute frame: one renderer for both eyes, or a renderer for each.
struct StereoCompute {
    gpu: Arc<Gpu>,
    options: DrawOptions,
    renderers: Vec<(Renderer, Vec<wgpu::Texture>)>,
    frame: u64,
}

impl StereoCompute {
    fn new(gpu: &Arc<Gpu>, scene: &DrawnScan, size_px: [u32; 2], plan: ComputePlan) -> Result<Self> {
        let atomics = plan.atomics.unwrap_or(gpu.atomics());
        let renderer = |sizes_px: &[[u32; 2]]| {
            let setup =
                Setup { sizes_px: sizes_px.to_vec(), color_format: FORMAT, depth_format: None, atomics };
            let technique = plan.technique.open(gpu);
            let mut renderer = Renderer::with_technique(gpu, setup, plan.options, technique)?;
            renderer.set_cloud(if plan.layered {
                CloudBuffers::upload_layered(gpu, &scene.octree, 0, &Progress::hidden())?
            } else {
                CloudBuffers::upload(gpu, &scene.cloud, 0, &Progress::hidden())?
            })?;
            anyhow::Ok((renderer, sizes_px.iter().map(|&size| image(gpu, size, FORMAT)).collect()))
        };
        let renderers = if plan.singles {
            vec![renderer(&[size_px])?, renderer(&[size_px])?]
        } else {
            vec![renderer(&[size_px; 2])?]
        };
        Ok(Self { gpu: Arc::clone(gpu), options: plan.options, renderers, frame: 0 })
    }

    fn set_options(&mut self, options: DrawOptions) -> Result<()> {
        for (renderer, _) in &mut self.renderers {
            renderer.set_options(options)?;
        }
        Ok(())
    }
}

impl StereoContestant for StereoCompute {
    fn draw(&mut self, view: &View) -> Result<FrameSample> {
        self.frame += 1;
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        for (renderer, images) in &mut self.renderers {
            let views: Vec<_> = images.iter().map(|i| i.create_view(&Default::default())).collect();
            let eyes: Vec<EyeImage> = views.iter().map(|color| EyeImage { color, depth: None }).collect();
            renderer.record(&mut encoder, self.frame, &eyes);
        }
        let began = Instant::now();
        {
            let queue = self.gpu.queue.lock();
            let first_eyes = [view.clone(), swapped(view)];
            for ((renderer, _), view) in self.renderers.iter_mut().zip(&first_eyes) {
                renderer.set_view(&queue, view);
            }
            queue.submit([encoder.finish()]);
        }
        self.renderers.iter_mut().for_each(|(renderer, _)| renderer.submitted());
        let wall_ms = wait(&self.gpu, began)?;
        let times = self.renderers.iter_mut().map(|(renderer, _)| renderer.collect_times());
        let times: Vec<FrameTimes> = times.collect::<Option<_>>().context("the GPU gave no frame back")?;
        let sum = |value: &dyn Fn(&FrameTimes) -> f32| times.iter().map(|t| f64::from(value(t))).sum();
        Ok(FrameSample {
            stage_ms: std::array::from_fn(|stage| sum(&|t| t.stage_ms[stage])),
            gpu_ms: sum(&|t| t.gpu_ms),
            wall_ms,
            points_read: times.iter().map(|t| t.points_read).sum(),
            visible_batches: times.iter().map(|t| u64::from(t.visible_batches)).sum(),
        })
    }

    fn pixels(&mut self, view: &View) -> Result<[Vec<Pixel>; 2]> {
        let mut options = self.options;
        options.detail.forced_planes = ALL_PLANES;
        self.set_options(options)?;
        self.draw(view)?;
        let mut eyes = Vec::new();
        for (renderer, images) in &self.renderers {
            for eye in 0..images.len() {
                eyes.push(renderer.read_pixels(eye)?);
            }
        }
        self.set_options(self.options)?;
        eyes.try_into().map_err(|_| anyhow::anyhow!("not two eyes"))
    }
}

/// The view with the right eye first. A renderer for one eye draws the first. It is told of both, so that it has the
/// same head, to which all its numbers are relative, and rounds as the stereo renderer does.
fn swapped(view: &View) -> View {
    View { eyes: view.eyes.iter().rev().copied().collect(), near: view.near }
}

/// Hardware points.
struct StereoHardware {
    gpu: Arc<Gpu>,
    num_points: u64,
    point_list: VertexList,
    images: [wgpu::Texture; 2],
    frame: u64,
}

impl StereoHardware {
    /// Makes hardware points that take a draw per eye.
    fn new(gpu: &Arc<Gpu>, cloud: &Cloud, size_px: [u32; 2]) -> Result<Self> {
        let point_list = VertexList::new(gpu, cloud, &[size_px; 2])?;
        let images = [size_px; 2].map(|size| image(gpu, size, point_list::FORMAT));
        Ok(Self { gpu: Arc::clone(gpu), num_points: cloud.num_points, point_list, images, frame: 0 })
    }
}

impl StereoContestant for StereoHardware {
    fn draw(&mut self, view: &View) -> Result<FrameSample> {
        self.frame += 1;
        let views = [0, 1].map(|eye: usize| self.images[eye].create_view(&Default::default()));
        let began = self.point_list.draw(&self.gpu, self.frame, &views, view);
        let wall_ms = wait(&self.gpu, began)?;
        let gpu_ms = self.point_list.collect_ms(&self.gpu).context("the GPU gave no frame back")?;
        Ok(FrameSample {
            stage_ms: [f64::NAN; STAGES.len()],
            gpu_ms: gpu_ms.into(),
            wall_ms,
            points_read: 2 * self.num_points,
            visible_batches: 0,
        })
    }

    /// The pixels have depths only, since hardware computes colors otherwise.
    fn pixels(&mut self, view: &View) -> Result<[Vec<Pixel>; 2]> {
        self.draw(view)?;
        let eye = |eye| {
            let depths = self.point_list.depths(&self.gpu, eye, view.near)?;
            anyhow::Ok(depths.into_iter().map(|depth| [depth.to_bits(), 0]).collect())
        };
        Ok([eye(0)?, eye(1)?])
    }
}

/// Waits until the GPU has done everything; returns milliseconds since `began`.
fn wait(gpu: &Gpu, began: Instant) -> Result<f64> {
    gpu.poll(wgpu::PollType::wait_indefinitely()).context("the GPU stopped answering")?;
    Ok(1e3 * began.elapsed().as_secs_f64())
}

fn image(gpu: &Gpu, size_px: [u32; 2], format: wgpu::TextureFormat) -> wgpu::Texture {
    gpu.texture("image", size_px, format, IMAGE_USAGES)
}
