//! The ways to draw both eyes that are compared: each draws whole frames of the same view and tells its times.

use crate::point_list::{self, PointList};
use anyhow::{Context, Result};
use scanwalk::cloud::Cloud;
use scanwalk::gpu::{Gpu, readback};
use scanwalk::layout::Detail;
use scanwalk::look::Look;
use scanwalk::progress::Progress;
use scanwalk::render::{CloudBuffers, EyeImage, FrameTimes, Renderer, Setup};
use scanwalk::space::View;
use scanwalk::timing::STAGES;
use std::sync::Arc;
use std::time::Instant;

/// sRGB, as headsets have it.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Times of one frame of both eyes, milliseconds; NaN where a contestant has no such stage.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// GPU time of each of [`STAGES`]; of two renderers, the sum.
    pub stage_ms: [f64; STAGES.len()],
    /// GPU time of the whole frame.
    pub gpu_ms: f64,
    /// From submit until the CPU knows that the GPU is done.
    pub wall_ms: f64,
    /// Points that were loaded; of two renderers or draws, the sum.
    pub points_read: u64,
}

/// One way to draw both eyes.
pub trait Contestant {
    /// In lower case with hyphens.
    fn name(&self) -> &'static str;

    /// Draws a frame and waits for it.
    fn draw(&mut self, view: &View) -> Result<Sample>;
}

/// The compute frame: one renderer for both eyes, or a renderer for each.
pub struct Compute {
    gpu: Arc<Gpu>,
    name: &'static str,
    renderers: Vec<(Renderer, Vec<wgpu::Texture>)>,
    frame: u64,
}

impl Compute {
    /// Both eyes in one `depth` dispatch.
    pub fn stereo(gpu: &Arc<Gpu>, cloud: &Cloud, size_px: [u32; 2]) -> Result<Self> {
        Self::new(gpu, cloud, "stereo", &[&[size_px; 2]])
    }

    /// An eye after the other, each by a renderer for one eye.
    pub fn two_singles(gpu: &Arc<Gpu>, cloud: &Cloud, size_px: [u32; 2]) -> Result<Self> {
        Self::new(gpu, cloud, "two-singles", &[&[size_px], &[size_px]])
    }

    fn new(gpu: &Arc<Gpu>, cloud: &Cloud, name: &'static str, sizes_px: &[&[[u32; 2]]]) -> Result<Self> {
        let renderer = |sizes_px: &&[[u32; 2]]| {
            let setup = Setup {
                sizes_px: sizes_px.to_vec(),
                color_format: FORMAT,
                depth_format: None,
                atomics: gpu.atomics(),
            };
            let mut renderer = Renderer::new(gpu, setup, Look::default())?;
            renderer.set_cloud(CloudBuffers::upload(gpu, cloud, 0, &Progress::hidden())?)?;
            anyhow::Ok((renderer, sizes_px.iter().map(|&size| image(gpu, size, FORMAT)).collect()))
        };
        let renderers = sizes_px.iter().map(renderer).collect::<Result<_>>()?;
        Ok(Self { gpu: Arc::clone(gpu), name, renderers, frame: 0 })
    }

    /// Reads all 30 coordinate bits always, or as many as the projected size asks for.
    pub fn set_full_precision(&mut self, full: bool) -> Result<()> {
        for (renderer, _) in &mut self.renderers {
            let detail = Detail { forced_planes: if full { 3 } else { 0 }, ..Detail::default() };
            renderer.set_look(Look { detail, ..Look::default() })?;
        }
        Ok(())
    }

    /// Both eyes' pixels: depth ≪ 32 | id.
    pub fn pixels(&self) -> Result<[Vec<u64>; 2]> {
        let mut eyes = Vec::new();
        for (renderer, images) in &self.renderers {
            for buffer in &renderer.targets().keys[..images.len()] {
                let bytes = readback::read_buffer(&self.gpu, buffer)?;
                let mut pixels: Vec<u64> = bytemuck::pod_collect_to_vec(&bytes);
                // The buffer's end may be padding.
                pixels.truncate((images[0].width() * images[0].height()) as usize);
                eyes.push(pixels);
            }
        }
        // Both constructors make two eyes.
        eyes.try_into().map_err(|_| anyhow::anyhow!("not two eyes"))
    }
}

impl Contestant for Compute {
    fn name(&self) -> &'static str {
        self.name
    }

    fn draw(&mut self, view: &View) -> Result<Sample> {
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
        Ok(Sample {
            stage_ms: std::array::from_fn(|stage| sum(&|t| t.stage_ms[stage])),
            gpu_ms: sum(&|t| t.gpu_ms),
            wall_ms,
            points_read: times.iter().map(|t| t.points_read).sum(),
        })
    }
}

/// The view with the right eye first. A renderer for one eye draws the first; that it is told of both gives
/// it the same head, to which all its numbers are relative, so that it rounds as the stereo renderer does.
fn swapped(view: &View) -> View {
    View { eyes: view.eyes.iter().rev().copied().collect(), near: view.near }
}

/// Hardware points.
pub struct Hardware {
    gpu: Arc<Gpu>,
    num_points: u64,
    point_list: PointList,
    images: [wgpu::Texture; 2],
    frame: u64,
}

impl Hardware {
    /// A draw an eye.
    pub fn new(gpu: &Arc<Gpu>, cloud: &Cloud, size_px: [u32; 2]) -> Result<Self> {
        let point_list = PointList::new(gpu, cloud, &[size_px; 2])?;
        let images = [size_px; 2].map(|size| image(gpu, size, point_list::FORMAT));
        Ok(Self { gpu: Arc::clone(gpu), num_points: cloud.num_points, point_list, images, frame: 0 })
    }

    /// Linear depth of an eye's pixels; infinite where no point is.
    pub fn depths(&self, eye: usize, near: f64) -> Result<Vec<f32>> {
        self.point_list.depths(&self.gpu, eye, near)
    }
}

impl Contestant for Hardware {
    fn name(&self) -> &'static str {
        "point-list"
    }

    fn draw(&mut self, view: &View) -> Result<Sample> {
        self.frame += 1;
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let views = [0, 1].map(|eye: usize| self.images[eye].create_view(&Default::default()));
        self.point_list.record(&mut encoder, self.frame, &views);
        let began = Instant::now();
        {
            let queue = self.gpu.queue.lock();
            self.point_list.set_view(&queue, view);
            queue.submit([encoder.finish()]);
        }
        self.point_list.submitted();
        let wall_ms = wait(&self.gpu, began)?;
        let gpu_ms = self.point_list.collect_ms(&self.gpu).context("the GPU gave no frame back")?;
        Ok(Sample {
            stage_ms: [f64::NAN; STAGES.len()],
            gpu_ms: gpu_ms.into(),
            wall_ms,
            points_read: 2 * self.num_points,
        })
    }
}

/// Waits until the GPU has done everything; milliseconds since `began`.
fn wait(gpu: &Gpu, began: Instant) -> Result<f64> {
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).context("the GPU stopped answering")?;
    Ok(1e3 * began.elapsed().as_secs_f64())
}

fn image(gpu: &Gpu, size_px: [u32; 2], format: wgpu::TextureFormat) -> wgpu::Texture {
    gpu.texture("image", size_px, format, wgpu::TextureUsages::RENDER_ATTACHMENT)
}
