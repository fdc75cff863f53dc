//! A way to draw, ready to draw: a renderer of its own, and the cloud that it is lent.

use super::point_list::{self, PointList};
use super::way::Way;
use crate::cloud::Cloud;
use crate::config::{Config, Quality};
use crate::gpu::{Gpu, readback};
use crate::layout::{COUNTERS_STRIDE, VisibleBatch, without_guard};
use crate::look::Look;
use crate::method::Method;
use crate::render::{CloudBuffers, EyeImage, FrameTimes, Renderer, Setup, tier};
use crate::space::View;
use crate::timing::STAGES;
use anyhow::{Context, Result};
use std::sync::Arc;

/// sRGB, as headsets have it.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// GPU milliseconds of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Of all of it.
    pub gpu_ms: f64,
    /// Of each of [`STAGES`]; NaN for hardware points.
    pub stage_ms: [f64; STAGES.len()],
}

/// What a frame reads and draws, all eyes together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Load {
    /// Batches of the cloud.
    pub num_batches: u64,
    /// Batches that were drawn.
    pub num_batches_drawn: u64,
    /// Points whose coordinates were loaded.
    pub points_read: u64,
    /// Points that asked for their pixel: in the picture and, when they came, the nearest.
    pub points_drawn: u64,
    /// Bytes of coordinates that one geometry stage loads.
    pub plane_bytes: u64,
}

/// A renderer of one way.
pub struct Compute {
    gpu: Arc<Gpu>,
    renderer: Renderer,
    images: Vec<wgpu::Texture>,
    frame: u64,
}

impl Compute {
    /// To draw eyes of these sizes.
    ///
    /// # Errors
    /// If they do not fit the GPU.
    pub fn new(gpu: &Arc<Gpu>, sizes_px: &[[u32; 2]], way: &Way) -> Result<Self> {
        Self::with_look(gpu, sizes_px, way.look())
    }

    /// The same with a look that is no way's.
    ///
    /// # Errors
    /// If the sizes do not fit the GPU.
    pub fn with_look(gpu: &Arc<Gpu>, sizes_px: &[[u32; 2]], look: Look) -> Result<Self> {
        let mut config = Config::default();
        config.frame.method = look.method;
        let setup = Setup {
            sizes_px: sizes_px.to_vec(),
            color_format: FORMAT,
            depth_format: None,
            atomics: tier(gpu, &config)?,
        };
        let renderer = Renderer::new(gpu, setup, look)?;
        let images = sizes_px.iter().map(|&size| image(gpu, size, FORMAT)).collect();
        Ok(Self { gpu: Arc::clone(gpu), renderer, images, frame: 0 })
    }

    /// Draws so many frames of a cloud, of which the last one counts.
    ///
    /// # Errors
    /// If the device is lost, or the cloud does not fit.
    pub fn draw(&mut self, cloud: &mut Option<CloudBuffers>, view: &View, num_frames: u32) -> Result<Sample> {
        self.renderer.set_cloud(cloud.take().context("no cloud to draw")?)?;
        let times = (0..num_frames).map(|_| self.frame(view)).last();
        *cloud = self.renderer.take_cloud();
        let times = times.context("no frame to draw")??;
        Ok(Sample { gpu_ms: times.gpu_ms.into(), stage_ms: times.stage_ms.map(f64::from) })
    }

    fn frame(&mut self, view: &View) -> Result<FrameTimes> {
        self.frame += 1;
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let views: Vec<_> = self.images.iter().map(|i| i.create_view(&Default::default())).collect();
        let eyes: Vec<EyeImage> = views.iter().map(|color| EyeImage { color, depth: None }).collect();
        self.renderer.record(&mut encoder, self.frame, &eyes);
        let commands = encoder.finish();
        {
            let queue = self.gpu.queue.lock();
            self.renderer.set_view(&queue, view);
            queue.submit([commands]);
        }
        self.renderer.submitted();
        wait(&self.gpu)?;
        self.renderer.collect_times().context("the GPU gave no frame back")
    }

    /// What a frame of this way has to do with a cloud, counted rather than timed.
    ///
    /// # Errors
    /// Those of [`Self::draw`].
    pub fn load(gpu: &Arc<Gpu>, way: &Way, cloud: &mut Option<CloudBuffers>, view: &View) -> Result<Load> {
        let sizes_px: Vec<[u32; 2]> = view.eyes.iter().map(|eye| eye.size_px).collect();
        let look = way.look();
        let quality = Quality::Closest;
        let mut counter = Self::with_look(gpu, &sizes_px, Look { method: Method::Count, quality, ..look })?;
        counter.renderer.set_cloud(cloud.take().context("no cloud to draw")?)?;
        let times = counter.frame(view);
        let load = times.and_then(|times| counter.counted(&times, sizes_px.len()));
        *cloud = counter.renderer.take_cloud();
        load
    }

    fn counted(&self, times: &FrameTimes, num_eyes: usize) -> Result<Load> {
        let mut points_drawn = 0;
        let targets = self.renderer.targets();
        for (buffer, size_px) in targets.depth[..num_eyes].iter().zip(&targets.sizes_px) {
            let asked: Vec<u32> = bytemuck::pod_collect_to_vec(&readback::read_buffer(&self.gpu, buffer)?);
            points_drawn += without_guard(&asked, *size_px)
                .iter()
                .map(|&count| u64::from(count.wrapping_add(1)))
                .sum::<u64>();
        }
        let (visible, counters, _) = self.renderer.cull_results();
        let counters = readback::read_buffer(&self.gpu, counters)?;
        let stride = COUNTERS_STRIDE as usize;
        let (mut plane_bytes, mut num_batches) = (0, 0);
        for (number, list) in visible.into_iter().enumerate() {
            let count: u32 = bytemuck::pod_read_unaligned(&counters[number * stride..number * stride + 4]);
            let batches: Vec<VisibleBatch> =
                bytemuck::pod_collect_to_vec(&readback::read_buffer(&self.gpu, list)?);
            num_batches += batches.len() as u64;
            let bytes = |batch: &VisibleBatch| 4 * u64::from(batch.flags & 3) * u64::from(batch.num_points);
            plane_bytes += batches.iter().take(count as usize).map(bytes).sum::<u64>();
        }
        Ok(Load {
            num_batches,
            num_batches_drawn: times.visible_nodes.into(),
            points_read: times.points_read,
            points_drawn,
            plane_bytes,
        })
    }
}

/// Hardware points of one eye.
pub struct Hardware {
    gpu: Arc<Gpu>,
    point_list: PointList,
    image: wgpu::Texture,
    frame: u64,
}

impl Hardware {
    /// With points of its own: 16 bytes each.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn new(gpu: &Arc<Gpu>, cloud: &Cloud, size_px: [u32; 2]) -> Result<Self> {
        let point_list = PointList::new(gpu, cloud, &[size_px])?;
        let image = image(gpu, size_px, point_list::FORMAT);
        Ok(Self { gpu: Arc::clone(gpu), point_list, image, frame: 0 })
    }

    /// Draws so many frames, of which the last one counts.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn draw(&mut self, view: &View, num_frames: u32) -> Result<Sample> {
        let mut gpu_ms = f64::NAN;
        for _ in 0..num_frames {
            self.frame += 1;
            let image = self.image.create_view(&Default::default());
            self.point_list.draw(&self.gpu, self.frame, &[image], view);
            wait(&self.gpu)?;
            gpu_ms = self.point_list.collect_ms(&self.gpu).context("the GPU gave no frame back")?.into();
        }
        Ok(Sample { gpu_ms, stage_ms: [f64::NAN; STAGES.len()] })
    }
}

fn wait(gpu: &Gpu) -> Result<()> {
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).context("the GPU stopped answering")?;
    Ok(())
}

fn image(gpu: &Gpu, size_px: [u32; 2], format: wgpu::TextureFormat) -> wgpu::Texture {
    gpu.texture("image", size_px, format, wgpu::TextureUsages::RENDER_ATTACHMENT)
}
