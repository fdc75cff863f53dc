//! Renderers that take part in a comparison: each draws in its own way a cloud that it is lent.

use super::point_list::{self, VertexList};
use crate::report::BytesRead;
use crate::technique::counts::Counts;
use crate::technique::tree::VISIBLE_DISCS;
use crate::technique::{LabTechnique, Method};
use anyhow::{Context, Result};
use base::space::View;
use cloud::Cloud;
use render::DrawOptions;
use render::gpu::{Gpu, readback};
use render::layout::{COUNTERS_STRIDE, VISIBLE_PLANES, VisibleBatch};
use render::options::Quality;
use render::technique::Technique;
use render::{CloudBuffers, EyeImage, FrameTimes, IMAGE_USAGES, Renderer, Setup, tier};
use std::sync::Arc;
use std::time::Instant;
use timing::STAGES;

/// Format of the images: sRGB, as headsets have it.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Milliseconds that one frame took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameMs {
    /// GPU time of the whole frame.
    pub gpu_ms: f64,
    /// GPU time of each of [`STAGES`]; NaN for hardware points.
    pub stage_ms: [f64; STAGES.len()],
    /// Time in which the CPU records and sends the frame; NaN for hardware points.
    pub cpu_ms: f64,
}

/// Counts of what a frame reads and draws, all eyes together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameCounts {
    /// Batches of the cloud.
    pub num_batches: u64,
    /// Batches that were drawn.
    pub num_batches_drawn: u64,
    /// Points whose coordinates were loaded.
    pub points_read: u64,
    /// Points or discs that asked for a pixel: those in the picture, and in methods that look first only those that
    /// were the nearest when they came.
    pub points_drawn: u64,
    /// Pixels that these points asked for, or wrote without asking.
    pub pixels_asked: u64,
    /// Discs of a point tree that the tolerance draws, in the picture or not.
    pub discs_chosen: u64,
    /// Bytes that the geometry stages load.
    pub bytes: BytesRead,
}

/// A renderer for one way to draw.
pub struct Compute {
    gpu: Arc<Gpu>,
    renderer: Renderer,
    images: Vec<wgpu::Texture>,
    frame: u64,
    /// CPU milliseconds of the last frame.
    cpu_ms: f64,
}

/// A renderer that counts what a way does.
pub struct Counter {
    compute: Compute,
    method: Method,
    /// Bins of [`Counts`].
    bins: wgpu::Buffer,
}

impl Compute {
    /// Makes a renderer of eyes of these sizes.
    ///
    /// # Errors
    /// If they do not fit the GPU.
    pub fn new(
        gpu: &Arc<Gpu>,
        sizes_px: &[[u32; 2]],
        options: DrawOptions,
        technique: LabTechnique,
    ) -> Result<Self> {
        Self::of(gpu, sizes_px, options, (technique, technique.open(gpu)))
    }

    fn of(
        gpu: &Arc<Gpu>,
        sizes_px: &[[u32; 2]],
        options: DrawOptions,
        (technique, open): (LabTechnique, Box<dyn Technique>),
    ) -> Result<Self> {
        let atomics = tier(gpu, None)?;
        technique.check(gpu, atomics)?;
        let setup = Setup { sizes_px: sizes_px.to_vec(), color_format: FORMAT, depth_format: None, atomics };
        let renderer = Renderer::with_technique(gpu, setup, options, open)?;
        let images = sizes_px.iter().map(|&size| image(gpu, size, FORMAT)).collect();
        Ok(Self { gpu: Arc::clone(gpu), renderer, images, frame: 0, cpu_ms: f64::NAN })
    }

    /// Draws `num_frames` frames of a cloud; only the last one counts.
    ///
    /// # Errors
    /// If the device is lost, or the cloud does not fit.
    pub fn draw(
        &mut self,
        cloud: &mut Option<CloudBuffers>,
        view: &View,
        num_frames: u32,
    ) -> Result<FrameMs> {
        self.renderer.set_cloud(cloud.take().context("no cloud to draw")?)?;
        let times = (0..num_frames).map(|_| self.frame(view)).last();
        *cloud = self.renderer.take_cloud();
        let times = times.context("no frame to draw")??;
        let stage_ms = times.stage_ms.map(f64::from);
        Ok(FrameMs { gpu_ms: times.gpu_ms.into(), stage_ms, cpu_ms: self.cpu_ms })
    }

    fn frame(&mut self, view: &View) -> Result<FrameTimes> {
        self.frame += 1;
        let began = Instant::now();
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
        self.cpu_ms = 1e3 * began.elapsed().as_secs_f64();
        wait(&self.gpu)?;
        self.renderer.collect_times().context("the GPU gave no frame back")
    }
}

impl Counter {
    /// Makes a counter of frames with these draw options, with eyes of these sizes.
    ///
    /// # Errors
    /// If they do not fit the GPU.
    pub fn new(
        gpu: &Arc<Gpu>,
        sizes_px: &[[u32; 2]],
        options: DrawOptions,
        technique: LabTechnique,
    ) -> Result<Self> {
        let (open, bins) = technique.counting(gpu);
        let compute = Compute::of(gpu, sizes_px, options, (technique, open))?;
        Ok(Self { compute, method: technique.method, bins })
    }

    /// Draws a frame of a cloud and counts what it reads and draws.
    ///
    /// # Errors
    /// Those of [`Compute::draw`].
    pub fn load(&mut self, cloud: &mut Option<CloudBuffers>, view: &View) -> Result<FrameCounts> {
        let before = self.counts()?;
        self.compute.renderer.set_cloud(cloud.take().context("no cloud to draw")?)?;
        let times = self.compute.frame(view);
        let load = times.and_then(|times| self.counted(&times, &before));
        *cloud = self.compute.renderer.take_cloud();
        load
    }

    fn counts(&self) -> Result<Vec<Counts>> {
        Ok(bytemuck::pod_collect_to_vec(&readback::read_buffer(&self.compute.gpu, &self.bins)?))
    }

    fn counted(&self, times: &FrameTimes, before: &[Counts]) -> Result<FrameCounts> {
        let after = self.counts()?;
        // The bins count on from frame to frame, and wrap.
        let sum = |of: fn(&Counts) -> u32| {
            let pairs = after.iter().zip(before);
            pairs.map(|(after, before)| u64::from(of(after).wrapping_sub(of(before)))).sum::<u64>()
        };
        let Compute { gpu, renderer, .. } = &self.compute;
        let options = renderer.options();
        // Every geometry stage loads all coordinates anew.
        let num_passes = if options.quality == Quality::Hqs { 2 } else { 1 };
        let (visible, counters, _) = renderer.cull_results();
        let counters = readback::read_buffer(gpu, counters)?;
        let stride = COUNTERS_STRIDE as usize;
        let (mut planes, mut shapes, mut num_batches) = (0, 0, 0);
        for (number, list) in visible.into_iter().enumerate() {
            let count: u32 = bytemuck::pod_read_unaligned(&counters[number * stride..number * stride + 4]);
            let batches: Vec<VisibleBatch> = bytemuck::pod_collect_to_vec(&readback::read_buffer(gpu, list)?);
            num_batches += renderer.num_batches(number);
            for batch in batches.iter().take(count as usize).filter(|batch| batch.is_first_slice()) {
                let words = 4 * num_passes * u64::from(batch.num_points);
                planes += words * u64::from(batch.flags & VISIBLE_PLANES);
                shapes += if batch.flags & VISIBLE_DISCS == 0 { 0 } else { words };
            }
        }
        let is_narrow = options.quality == Quality::Hqs || self.method == Method::BusyLoop;
        let pixels = sum(|bin| bin.num_reads) * if is_narrow { 4 } else { 8 };
        Ok(FrameCounts {
            num_batches,
            num_batches_drawn: times.visible_batches.into(),
            points_read: times.points_read,
            points_drawn: sum(|bin| bin.num_drawn),
            pixels_asked: sum(|bin| bin.num_asked),
            discs_chosen: sum(|bin| bin.num_chosen) / num_passes,
            bytes: BytesRead { planes, shapes, pixels, colors: 4 * sum(|bin| bin.num_colors) },
        })
    }
}

/// Hardware points of one eye.
pub struct Hardware {
    gpu: Arc<Gpu>,
    point_list: VertexList,
    image: wgpu::Texture,
    frame: u64,
}

impl Hardware {
    /// Uploads points of its own, 16 bytes each.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn new(gpu: &Arc<Gpu>, cloud: &Cloud, size_px: [u32; 2]) -> Result<Self> {
        let point_list = VertexList::new(gpu, cloud, &[size_px])?;
        let image = image(gpu, size_px, point_list::FORMAT);
        Ok(Self { gpu: Arc::clone(gpu), point_list, image, frame: 0 })
    }

    /// Draws this many points per draw call from now on.
    pub fn set_draw_points(&mut self, draw_points: u32) {
        self.point_list.set_draw_points(draw_points);
    }

    /// Draws `num_frames` frames; only the last one counts.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn draw(&mut self, view: &View, num_frames: u32) -> Result<FrameMs> {
        let mut gpu_ms = f64::NAN;
        for _ in 0..num_frames {
            self.frame += 1;
            let image = self.image.create_view(&Default::default());
            self.point_list.draw(&self.gpu, self.frame, &[image], view);
            wait(&self.gpu)?;
            gpu_ms = self.point_list.collect_ms(&self.gpu).context("the GPU gave no frame back")?.into();
        }
        Ok(FrameMs { gpu_ms, stage_ms: [f64::NAN; STAGES.len()], cpu_ms: f64::NAN })
    }
}

fn wait(gpu: &Gpu) -> Result<()> {
    gpu.poll(wgpu::PollType::wait_indefinitely()).context("the GPU stopped answering")?;
    Ok(())
}

fn image(gpu: &Gpu, size_px: [u32; 2], format: wgpu::TextureFormat) -> wgpu::Texture {
    gpu.texture("image", size_px, format, IMAGE_USAGES)
}
