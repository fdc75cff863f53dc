//! Hardware points as the papers draw them: vertices of 16 bytes, a depth buffer and one draw an eye, straight into the
//! image. The points and their order are those of the compute frame. `bench` compares with this renderer rather than
//! with the frame's own method `point-list`, since it is faster: opponents are shown at their best.

use crate::hardware::{self, DEPTH_FORMAT, PointPipeline};
use crate::reference::points::cells;
use anyhow::Result;
use base::space::{Eye, Split, View};
use bytemuck::{Pod, Zeroable};
use cloud::{Batch, Cloud};
use glam::{DVec3, DVec4, Mat4};
use render::gpu::stage::{Bindings, shader_module};
use render::gpu::timer::Timer;
use render::gpu::{Gpu, QueueGuard, readback};
use render::layout::{ALL_PLANES, BATCH_POINTS, Variant};
use render::shaders::ShaderOfSet;
use std::mem::offset_of;
use std::time::Instant;
use wgpu::util::DeviceExt;

/// Colors are stored sRGB-encoded and go to the image as they are: no stage converts them.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Batches whose vertices are made and sent at once: 4 MB.
const PIECE_BATCHES: usize = 25;

render::sets! {
    /// What an eye's points are drawn with.
    Vertices, OfVertices {
        /// Matrix from positions in the cloud to clip space.
        clip_from_cloud,
    }
}

/// The pass that draws vertices.
pub const VERTEX_LIST: ShaderOfSet<Vertices> =
    ShaderOfSet::new("vertex-list", &[], |_| &[include_str!("../../../../shaders/methods/vertex_list.wgsl")]);

/// A point as the vertex stage reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct PointVertex {
    /// Position along the world axes, relative to the cloud's origin.
    p_in_cloud: [f32; 3],
    /// Red, green, blue, 255; sRGB as stored.
    color: [u8; 4],
}

/// Draws the eyes of a cloud with hardware points.
#[derive(Debug)]
pub struct VertexList {
    split: Split,
    pipeline: wgpu::RenderPipeline,
    eyes: Vec<EyeTarget>,
    /// Buffers of consecutive points, with their numbers of points; one buffer unless the device's buffers are small.
    points: Vec<(wgpu::Buffer, u32)>,
    /// Points per draw call.
    draw_points: u32,
    timer: Timer,
}

#[derive(Debug)]
struct EyeTarget {
    /// Uniform that holds the matrix `clip_from_cloud`.
    matrix: wgpu::Buffer,
    group: wgpu::BindGroup,
    depth: wgpu::Texture,
}

impl VertexList {
    /// Sends a cloud's points to the GPU and makes a depth buffer for each eye, at least one, of these sizes.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn new(gpu: &Gpu, cloud: &Cloud, sizes_px: &[[u32; 2]]) -> Result<Self> {
        let wgsl = VERTEX_LIST.source(Variant::eyes(1));
        let pipeline = pipeline(gpu, &wgsl);
        let bindings = Bindings::of(VERTEX_LIST.name(), &wgsl, "vertex", &[])?;
        let eye = |&size_px: &[u32; 2]| EyeTarget::new(gpu, &pipeline, &bindings, size_px);
        let eyes: Vec<_> = sizes_px.iter().map(eye).collect();
        let timer = Timer::new(gpu, 1, eyes[0].matrix.size());
        let points = upload(gpu, cloud)?;
        Ok(Self { split: cloud.split, pipeline, eyes, points, draw_points: u32::MAX, timer })
    }

    /// Draws this many points per draw call from now on, as a node of an octree would be drawn; at least one.
    pub fn set_draw_points(&mut self, draw_points: u32) {
        self.draw_points = draw_points.max(1);
    }

    /// Records a frame into `images` of [`FORMAT`], one an eye.
    fn record(&mut self, encoder: &mut wgpu::CommandEncoder, frame: u64, images: &[wgpu::TextureView]) {
        self.timer.begin(encoder, frame);
        for (number, (eye, image)) in self.eyes.iter().zip(images).enumerate() {
            let depth = eye.depth.create_view(&wgpu::TextureViewDescriptor::default());
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("point-list"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: image,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &depth,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(0.0),
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                timestamp_writes: self.timer.render(0, number == 0, number + 1 == images.len()),
                ..Default::default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &eye.group, &[]);
            for (vertices, num_points) in &self.points {
                pass.set_vertex_buffer(0, vertices.slice(..));
                for first in (0..*num_points).step_by(self.draw_points as usize) {
                    pass.draw(first..first.saturating_add(self.draw_points).min(*num_points), 0..1);
                }
            }
        }
        self.timer.end(encoder, &self.eyes[0].matrix);
    }

    /// Sets the eyes of the frame that is submitted next through the same guard.
    fn set_view(&self, queue: &QueueGuard, view: &View) {
        for (target, eye) in self.eyes.iter().zip(&view.eyes) {
            let matrix = clip_from_cloud(eye, self.split.origin, view.near);
            queue.write_buffer(&target.matrix, 0, bytemuck::bytes_of(&matrix));
        }
    }

    /// Draws frame number `frame` into `images` of [`FORMAT`], one an eye, without waiting for it. Returns the time
    /// just before its submission.
    pub fn draw(&mut self, gpu: &Gpu, frame: u64, images: &[wgpu::TextureView], view: &View) -> Instant {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.record(&mut encoder, frame, images);
        let began = Instant::now();
        {
            let queue = gpu.queue.lock();
            self.set_view(&queue, view);
            queue.submit([encoder.finish()]);
        }
        self.timer.submitted();
        began
    }

    /// GPU time in milliseconds of a frame that is done.
    pub fn collect_ms(&mut self, gpu: &Gpu) -> Option<f32> {
        self.timer.collect(gpu, |times| times.total_ms)
    }

    /// Linear depth of an eye's pixels; infinite where there is no point.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn depths(&self, gpu: &Gpu, eye: usize, near: f64) -> Result<Vec<f32>> {
        let bytes = readback::read_texture(gpu, &self.eyes[eye].depth)?;
        let stored: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
        // A stored depth of 0 means no point, for which near / 0 is the infinity that is wanted.
        Ok(stored.iter().map(|depth| near as f32 / depth).collect())
    }
}

impl EyeTarget {
    fn new(
        gpu: &Gpu,
        pipeline: &wgpu::RenderPipeline,
        bindings: &Bindings<Vertices>,
        size_px: [u32; 2],
    ) -> Self {
        let matrix = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("clip_from_cloud"),
            contents: bytemuck::bytes_of(&Mat4::IDENTITY),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
        });
        let resources = OfVertices { clip_from_cloud: matrix.as_entire_binding() };
        let group = bindings.bind(&gpu.device, &pipeline.get_bind_group_layout(0), &resources);
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let depth = gpu.texture("point-list depth", size_px, DEPTH_FORMAT, usage);
        Self { matrix, group, depth }
    }
}

fn pipeline(gpu: &Gpu, wgsl: &str) -> wgpu::RenderPipeline {
    let module = shader_module(&gpu.device, VERTEX_LIST.name(), wgsl);
    let attributes = [
        wgpu::VertexAttribute {
            format: wgpu::VertexFormat::Float32x3,
            offset: offset_of!(PointVertex, p_in_cloud) as u64,
            shader_location: 0,
        },
        wgpu::VertexAttribute {
            format: wgpu::VertexFormat::Unorm8x4,
            offset: offset_of!(PointVertex, color) as u64,
            shader_location: 1,
        },
    ];
    let buffer = wgpu::VertexBufferLayout {
        array_stride: size_of::<PointVertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    };
    hardware::pipeline(
        gpu,
        PointPipeline {
            module: &module,
            vertex: "vertex",
            buffers: &[Some(buffer)],
            format: FORMAT,
            nearer: wgpu::CompareFunction::Greater,
        },
    )
}

/// Matrix from positions relative to `origin` to clip space: the pixel rows of the compute frame, with pixels scaled to
/// −1…1 and near / w as depth.
fn clip_from_cloud(eye: &Eye, origin: DVec3, near: f64) -> Mat4 {
    let [x, y, w] = eye.pixel_from_head(origin).map(DVec4::from_array);
    let [width, height] = eye.size_px.map(f64::from);
    let rows = [2.0 / width * x - w, w - 2.0 / height * y, DVec4::W * near, w];
    Mat4::from_cols_array_2d(&rows.map(|row| row.as_vec4().to_array())).transpose()
}

fn upload(gpu: &Gpu, cloud: &Cloud) -> Result<Vec<(wgpu::Buffer, u32)>> {
    let vertex_bytes = size_of::<PointVertex>() as u64;
    let batch_bytes = u64::from(BATCH_POINTS) * vertex_bytes;
    let buffer_batches = (gpu.device.limits().max_buffer_size / batch_bytes).max(1);
    let mut buffers = Vec::new();
    for batches in cloud.batches.chunks(buffer_batches as usize) {
        let num_points: u32 = batches.iter().map(|batch| batch.num_points).sum();
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("points"),
            size: u64::from(num_points) * vertex_bytes,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut offset = 0;
        for piece in batches.chunks(PIECE_BATCHES) {
            let vertices: Vec<PointVertex> = piece.iter().flat_map(|batch| vertices(cloud, batch)).collect();
            {
                let queue = gpu.queue.lock();
                queue.write_buffer(&buffer, offset, bytemuck::cast_slice(&vertices));
                queue.submit([]);
            }
            offset += vertices.len() as u64 * vertex_bytes;
            gpu.poll(wgpu::PollType::wait_indefinitely())?;
        }
        buffers.push((buffer, num_points));
    }
    Ok(buffers)
}

/// A batch's points at the centers of their 30-bit cells, which is where the compute frame draws them.
fn vertices(cloud: &Cloud, batch: &Batch) -> impl Iterator<Item = PointVertex> {
    let min_in_cloud = batch.min - cloud.split.origin;
    let cell = DVec3::from_array(batch.cell.map(f64::from));
    (batch.first_point..batch.first_point + batch.num_points).map(move |point| {
        let words = [0, 1, 2].map(|plane: usize| cloud.planes[plane][point as usize]);
        let steps = DVec3::from_array(cells(ALL_PLANES, words).map(f64::from)) + 0.5;
        PointVertex {
            p_in_cloud: (min_in_cloud + steps * cell).as_vec3().to_array(),
            color: cloud.colors[point as usize].to_le_bytes(),
        }
    })
}
