//! The frame as a contents list.

use super::groups;
use super::renderer::Renderer;
use crate::draw_options::DrawOptions;
use crate::gpu::QueueGuard;
use crate::layout::{
    COUNTERS_STRIDE, CullCounters, Detail, IMAGE_PITCH_PX, ViewUniform, WORKGROUP_SIZE, image_pitch_px,
};
use crate::options::Quality;
use crate::scenery::{SceneryView, Shapes};
use base::space::View;
use base::srgb::linear_of_step;
use timing::{STAGES, StageMs};

/// Places of the stages in [`STAGES`], and of their times.
const CLEAR: usize = place_of("clear");
const LOD: usize = place_of("lod");
const CULL: usize = place_of("cull");
pub(super) const DEPTH: usize = place_of("depth");
const COLOR: usize = place_of("color");
const RESOLVE: usize = place_of("resolve");
const SCENERY: usize = place_of("scenery");

/// The place of a stage's name in [`STAGES`]; a name that is not there does not compile.
const fn place_of(name: &str) -> usize {
    let mut place = 0;
    while place < STAGES.len() {
        if is_same(STAGES[place].as_bytes(), name.as_bytes()) {
            return place;
        }
        place += 1;
    }
    panic!("no stage has this name")
}

const fn is_same(a: &[u8], b: &[u8]) -> bool {
    if a.len() != b.len() {
        return false;
    }
    let mut at = 0;
    while at < a.len() {
        if a[at] != b[at] {
            return false;
        }
        at += 1;
    }
    true
}

// Rows of finished pixels begin where copies need them to.
const _: () = assert!(4 * IMAGE_PITCH_PX == wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);

/// Times and counts of a frame, which the GPU tells some frames late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTimes {
    /// The frame's number.
    pub frame: u64,
    /// GPU time of each stage.
    pub stage_ms: StageMs,
    /// GPU time of all stages.
    pub gpu_ms: f32,
    /// Nodes of which `depth` drew something; a flat cloud is one.
    pub visible_nodes: u32,
    /// Batches that `depth` drew.
    pub visible_batches: u32,
    /// Points in the batches that `depth` drew.
    pub points_read: u64,
}

/// Usages that an eye's image must have.
pub const IMAGE_USAGES: wgpu::TextureUsages =
    wgpu::TextureUsages::RENDER_ATTACHMENT.union(wgpu::TextureUsages::COPY_DST);

/// An eye's image to draw to.
#[derive(Clone, Copy, Debug)]
pub struct EyeImage<'a> {
    /// Image for the colors: drawn to while there is no cloud, else copied to.
    pub color: &'a wgpu::TextureView,
    /// Image for [`View::near`] / w, or 0 without a point; given if [`super::Setup::depth_format`] is.
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
        self.record_scenery(encoder, images);
        self.timer.end(encoder, &self.counters);
        self.images_are_new = false;
    }

    /// Sets the eyes of the frame that is submitted next through the same guard.
    ///
    /// # Panics
    /// If the eyes' images are not as large as what is drawn: shaders trust in that.
    pub fn set_view(&mut self, queue: &QueueGuard, view: &View) {
        let sizes_px = view.eyes.iter().map(|eye| eye.size_px).take(self.targets.drawn_px.len());
        assert!(sizes_px.eq(self.targets.drawn_px.iter().copied()), "eyes as large as what is drawn");
        if let Some(cloud) = &self.cloud {
            let threshold_px = self.options.detail.threshold_px.map(|px| px * self.lod_scale);
            let detail = Detail { threshold_px, ..self.options.detail };
            let uniform = ViewUniform::new(view, &cloud.split, &detail);
            queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
            self.technique.set_view(queue, view, &detail, self.lod_scale, cloud);
        }
    }

    /// Sets what is seen beside the scan in the frame that is submitted next through the same guard. Nothing is without
    /// [`Self::show_scenery`].
    pub fn set_scenery(&self, queue: &QueueGuard, view: &SceneryView, shapes: &Shapes) {
        if let Some(scenery) = &self.scenery {
            scenery.set(queue, view, shapes, self.cloud.is_some());
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
        self.dispatch_clear(&mut pass, &self.groups.clear);
        // Tiles that nobody sees stay as they are from here on.
        if self.images_are_new {
            self.dispatch_clear(&mut pass, &self.groups.clear_images);
        }
    }

    fn dispatch_clear(&self, pass: &mut wgpu::ComputePass, groups: &[(wgpu::BindGroup, u32)]) {
        let limit = self.gpu.device.limits().max_compute_workgroups_per_dimension;
        for (group, num_words) in groups {
            let num_groups = num_words.div_ceil(WORKGROUP_SIZE).min(limit);
            self.pipelines.clear.dispatch(pass, group, num_groups);
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
        match self.options.quality {
            Quality::Closest => self.nearest.record_depth(encoder, &self.recording()),
            Quality::Hqs => {
                let depth = &groups::hqs(&self.pipelines, self.cloud.as_ref()).depth;
                let mut pass = self.compute_pass(encoder, DEPTH);
                depth.dispatch_visible(&mut pass, &self.groups.depth, &self.counters);
            }
        }
    }

    fn record_color(&self, encoder: &mut wgpu::CommandEncoder) {
        // wgpu puts a barrier between passes that write and read the same buffer.
        let mut pass = self.compute_pass(encoder, COLOR);
        let color = &groups::hqs(&self.pipelines, self.cloud.as_ref()).color;
        color.dispatch_visible(&mut pass, &self.groups.color, &self.counters);
    }

    fn record_resolve(&self, encoder: &mut wgpu::CommandEncoder, images: &[EyeImage]) {
        if self.cloud.is_none() {
            for (eye, image) in images.iter().enumerate() {
                self.record_empty(encoder, image, [eye == 0, eye + 1 == images.len()]);
            }
            return;
        }
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(STAGES[RESOLVE]),
                timestamp_writes: self.timer.compute(RESOLVE, true, false),
            });
            self.record_pixels(&mut pass);
        }
        for (eye, image) in images.iter().enumerate() {
            self.record_copy(encoder, eye, image);
        }
        for (eye, image) in images.iter().enumerate() {
            self.record_depth_image(encoder, eye, image);
        }
        // Copies have no timestamps: an empty pass says when they are done.
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("end"),
            timestamp_writes: self.timer.compute(RESOLVE, false, true),
        });
    }

    /// Records the steps from keys or sums to finished pixels.
    fn record_pixels(&self, pass: &mut wgpu::ComputePass) {
        let (pipelines, cloud) = (&self.pipelines, self.cloud.as_ref());
        let DrawOptions { quality, dilate, .. } = self.options;
        let image = groups::finishing(pipelines, cloud, quality, dilate);
        for (number, eye) in self.groups.eyes.iter().enumerate() {
            if quality == Quality::Closest {
                self.nearest.record_shade(pass, number, eye.num_tiles);
            }
            if let Some(group) = &eye.blend {
                groups::hqs(pipelines, cloud).blend.dispatch(pass, group, eye.num_tiles);
            }
            if let Some(group) = &eye.image {
                image.dispatch(pass, group, eye.num_tiles);
            }
        }
    }

    /// Copies finished colors into an eye's image. Both hold sRGB, so that nothing is decoded and encoded again.
    fn record_copy(&self, encoder: &mut wgpu::CommandEncoder, eye: usize, image: &EyeImage) {
        let [width, height] = self.targets.drawn_px[eye];
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * image_pitch_px(width)),
            rows_per_image: None,
        };
        encoder.copy_buffer_to_texture(
            wgpu::TexelCopyBufferInfo { buffer: &self.targets.image_color[eye], layout },
            image.color.texture().as_image_copy(),
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
    }

    fn record_depth_image(&self, encoder: &mut wgpu::CommandEncoder, eye: usize, image: &EyeImage) {
        let Some(((pass, group), view)) =
            self.pipelines.depth_image.as_ref().zip(self.groups.eyes[eye].depth.as_ref()).zip(image.depth)
        else {
            return;
        };
        let mut drawing = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("depth-image"),
            depth_stencil_attachment: Some(infinitely_far(view)),
            ..Default::default()
        });
        self.draw_to_drawn_part(&mut drawing, eye);
        drawing.set_pipeline(&pass.pipeline);
        drawing.set_bind_group(0, group, &[]);
        drawing.draw(0..3, 0..1);
    }

    /// Records an image without a point.
    fn record_empty(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        image: &EyeImage,
        [is_first, is_last]: [bool; 2],
    ) {
        let [r, g, b] = self.options.background.map(linear_of_step);
        let load = wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 });
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(STAGES[RESOLVE]),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: image.color,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: image.depth.map(infinitely_far),
            timestamp_writes: self.timer.render(RESOLVE, is_first, is_last),
            ..Default::default()
        });
    }

    /// Records what is seen beside the scan, over the images.
    fn record_scenery(&mut self, encoder: &mut wgpu::CommandEncoder, images: &[EyeImage]) {
        let Some(mut scenery) = self.scenery.take() else {
            // A stage that does nothing has its time all the same.
            drop(self.compute_pass(encoder, SCENERY));
            return;
        };
        scenery.bind(&self.gpu, &self.targets, self.binding());
        for (eye, image) in images.iter().enumerate() {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(STAGES[SCENERY]),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: image.color,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
                })],
                timestamp_writes: self.timer.render(SCENERY, eye == 0, eye + 1 == images.len()),
                ..Default::default()
            });
            self.draw_to_drawn_part(&mut pass, eye);
            scenery.draw(&mut pass, eye);
        }
        self.scenery = Some(scenery);
    }

    fn draw_to_drawn_part(&self, pass: &mut wgpu::RenderPass, eye: usize) {
        let [width, height] = self.targets.drawn_px[eye];
        pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(0, 0, width, height);
    }

    fn compute_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, stage: usize) -> wgpu::ComputePass<'e> {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(STAGES[stage]),
            timestamp_writes: self.timer.compute(stage, true, true),
        })
    }
}

/// Attaches a depth image that begins infinitely far everywhere.
fn infinitely_far(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store };
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops: Some(ops), stencil_ops: None }
}
