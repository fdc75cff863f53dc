//! The frame as a contents list.

use super::groups;
use super::pipelines::Depth;
use super::point_list::PointList;
use super::renderer::Renderer;
use crate::config::Quality;
use crate::gpu::QueueGuard;
use crate::gpu::stage::Stage;
use crate::layout::{COUNTERS_STRIDE, CullCounters, Detail, ViewUniform, WORKGROUP_SIZE};
use crate::space::View;
use crate::timing::{STAGES, StageMs};

/// Where each stage's times stand in [`STAGES`].
const CLEAR: usize = 0;
const LOD: usize = 1;
const CULL: usize = 2;
const DEPTH: usize = 3;
const COLOR: usize = 4;
const RESOLVE: usize = 5;

/// What the GPU tells of a frame, some frames late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTimes {
    /// The frame's number.
    pub frame: u64,
    /// GPU time of each stage.
    pub stage_ms: StageMs,
    /// GPU time of them all.
    pub gpu_ms: f32,
    /// Nodes of which `depth` drew something: an octree's cubes, a point tree's runs; a flat cloud is one.
    pub visible_nodes: u32,
    /// Their batches that it drew.
    pub visible_batches: u32,
    /// Points in them.
    pub points_read: u64,
}

/// An eye's image to draw to.
#[derive(Clone, Copy, Debug)]
pub struct EyeImage<'a> {
    /// Where the colours go.
    pub color: &'a wgpu::TextureView,
    /// Where [`View::near`] / w goes, 0 where nothing is; given if [`super::Setup::depth_format`] is.
    pub depth: Option<&'a wgpu::TextureView>,
}

impl Renderer {
    /// Records frame number `frame` into `images`, one an eye; to be submitted before the next is recorded. Poses are
    /// not needed yet: see [`Self::set_view`].
    pub fn record(&mut self, encoder: &mut wgpu::CommandEncoder, frame: u64, images: &[EyeImage]) {
        self.timer.begin(encoder, frame);
        self.record_clear(encoder);
        self.record_lod(encoder);
        self.record_cull(encoder);
        self.record_depth(encoder);
        self.record_color(encoder);
        self.record_resolve(encoder, images);
        self.timer.end(encoder, &self.counters);
        self.targets_are_clear = self.groups.clear_counters.is_some() && self.cloud.is_some();
    }

    /// Sets the eyes of the frame that is submitted next through the same guard.
    ///
    /// # Panics
    /// If the eyes' images are not as large as what is drawn: shaders trust in that.
    pub fn set_view(&mut self, queue: &QueueGuard, view: &View) {
        let sizes_px = view.eyes.iter().map(|eye| eye.size_px).take(self.targets.drawn_px.len());
        assert!(sizes_px.eq(self.targets.drawn_px.iter().copied()), "eyes as large as what is drawn");
        if let Some(cloud) = &self.cloud {
            let threshold_px = self.look.detail.threshold_px.map(|px| px * self.lod_scale);
            let error_px = self.look.detail.error_px.map(|px| px * self.lod_scale);
            let detail = Detail { threshold_px, error_px, ..self.look.detail };
            let uniform = ViewUniform::new(view, &cloud.split, &detail);
            let uniform = ViewUniform { step_base: cloud.step_base, ..uniform };
            queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
        }
    }

    /// To be called after the frame's submit.
    pub fn submitted(&mut self) {
        self.timer.submitted();
    }

    /// Times of the oldest frame that has come back, if any; never waits.
    pub fn collect_times(&mut self) -> Option<FrameTimes> {
        let drawn = self.cloud.is_some();
        self.timer.collect(&self.gpu, |times| {
            let mut stage_ms = [f32::NAN; STAGES.len()];
            stage_ms.copy_from_slice(times.stage_ms);
            let (mut visible_nodes, mut visible_batches, mut points_read) = (0, 0, 0);
            for chunk in times.extra.chunks_exact(COUNTERS_STRIDE as usize).filter(|_| drawn) {
                let counters: CullCounters =
                    bytemuck::pod_read_unaligned(&chunk[..size_of::<CullCounters>()]);
                visible_nodes += counters.num_nodes;
                visible_batches += counters.num_batches();
                points_read += u64::from(counters.num_points);
            }
            FrameTimes {
                frame: times.frame,
                stage_ms,
                gpu_ms: times.total_ms,
                visible_nodes,
                visible_batches,
                points_read,
            }
        })
    }

    fn record_clear(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = self.compute_pass(encoder, CLEAR);
        let limit = self.gpu.device.limits().max_compute_workgroups_per_dimension;
        let counters = self.groups.clear_counters.as_ref().filter(|_| self.targets_are_clear);
        for (group, num_words) in counters.map_or(&self.groups.clear[..], std::slice::from_ref) {
            let num_groups = num_words.div_ceil(WORKGROUP_SIZE).min(limit);
            self.pipelines.clear.dispatch(&mut pass, group, num_groups);
        }
    }

    fn record_lod(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = self.compute_pass(encoder, LOD);
        if let (Some(cloud), Some(group)) = (&self.cloud, &self.groups.lod) {
            self.pipelines.lod.dispatch(&mut pass, group, cloud.num_nodes.div_ceil(WORKGROUP_SIZE));
        }
    }

    fn record_cull(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = self.compute_pass(encoder, CULL);
        for (chunk, group) in self.chunks().iter().zip(&self.groups.cull) {
            self.pipelines.cull.dispatch(&mut pass, group, chunk.num_batches.div_ceil(WORKGROUP_SIZE));
        }
    }

    fn record_depth(&self, encoder: &mut wgpu::CommandEncoder) {
        let depth = match (self.look.quality, &self.pipelines.closest.depth) {
            (Quality::Closest, Depth::PointList(point_list)) => {
                return self.record_point_list(encoder, point_list);
            }
            (Quality::Closest, Depth::Compute(depth)) => depth,
            (Quality::Hqs, _) => &groups::hqs(&self.pipelines, self.cloud.as_ref()).depth,
        };
        let mut pass = self.compute_pass(encoder, DEPTH);
        self.dispatch_visible(&mut pass, depth, &self.groups.depth);
        if let Some(ids) = &self.pipelines.closest.ids {
            self.dispatch_visible(&mut pass, ids, &self.groups.ids);
        }
    }

    fn record_point_list(&self, encoder: &mut wgpu::CommandEncoder, point_list: &PointList) {
        let Some((images, draws)) = &self.points else { return };
        draws.record(encoder, &self.counters, self.chunks());
        let num_eyes = self.groups.point_list.len();
        for (eye, groups) in self.groups.point_list.iter().enumerate() {
            let times = self.timer.render(DEPTH, eye == 0, eye + 1 == num_eyes);
            let size_px = self.targets.drawn_px[eye];
            point_list.record(encoder, (eye, images), size_px, (groups, draws), times);
        }
    }

    fn record_color(&self, encoder: &mut wgpu::CommandEncoder) {
        // wgpu puts a barrier between passes that write and read the same buffer.
        let mut pass = self.compute_pass(encoder, COLOR);
        let color = &groups::hqs(&self.pipelines, self.cloud.as_ref()).color;
        self.dispatch_visible(&mut pass, color, &self.groups.color);
    }

    /// One dispatch a chunk, a workgroup a visible batch.
    fn dispatch_visible(&self, pass: &mut wgpu::ComputePass, stage: &Stage, groups: &[wgpu::BindGroup]) {
        for (number, group) in groups.iter().enumerate() {
            let arguments = number as u64 * u64::from(COUNTERS_STRIDE);
            stage.dispatch_indirect(pass, group, &self.counters, arguments);
        }
    }

    fn record_resolve(&self, encoder: &mut wgpu::CommandEncoder, images: &[EyeImage]) {
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("surface"),
                timestamp_writes: self.timer.compute(RESOLVE, true, false),
            });
            let (surface, dilate) = match self.look.quality {
                Quality::Closest => (&self.pipelines.closest.shade, &self.pipelines.closest.dilate),
                Quality::Hqs => {
                    let hqs = groups::hqs(&self.pipelines, self.cloud.as_ref());
                    (&hqs.blend, &hqs.blend_dilate)
                }
            };
            for eye in &self.groups.eyes {
                for group in &eye.surface {
                    surface.dispatch(&mut pass, group, eye.num_tiles);
                }
                if let Some(group) = &eye.dilate {
                    dilate.dispatch(&mut pass, group, eye.num_tiles);
                }
            }
        }
        for (eye, image) in images.iter().enumerate() {
            self.record_image(encoder, eye, image, eye + 1 == images.len());
        }
    }

    fn record_image(&self, encoder: &mut wgpu::CommandEncoder, eye: usize, image: &EyeImage, is_last: bool) {
        let [r, g, b] = self.look.background.map(linear_from_srgb);
        let store = wgpu::StoreOp::Store;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(STAGES[RESOLVE]),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: image.color,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }), store },
            })],
            depth_stencil_attachment: image.depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store }),
                stencil_ops: None,
            }),
            timestamp_writes: self.timer.render(RESOLVE, false, is_last),
            ..Default::default()
        });
        let [width, height] = self.targets.drawn_px[eye];
        pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(0, 0, width, height);
        if self.cloud.is_none() {
            self.waiting.draw(&mut pass, eye);
        } else {
            pass.set_pipeline(&self.pipelines.image.pipeline);
            pass.set_bind_group(0, &self.groups.eyes[eye].image, &[]);
            pass.draw(0..3, 0..1);
        }
    }

    fn compute_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, stage: usize) -> wgpu::ComputePass<'e> {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(STAGES[stage]),
            timestamp_writes: self.timer.compute(stage, true, true),
        })
    }
}

/// The value that an sRGB image encodes back to `c`.
fn linear_from_srgb(c: u8) -> f64 {
    let c = f64::from(c) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}
