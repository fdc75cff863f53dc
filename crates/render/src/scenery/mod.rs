//! The stage `scenery`: what is seen beside the scan. The surround fills pixels without a point; shapes stand in the
//! stage, cards, rays, rings, hands; the vignette darkens the edge of sight. It is drawn over the finished images, so that
//! nothing of it is in a picture of the scan. docs/FRAME.md §11 has its rules.

mod shapes;

pub use shapes::{MOST_CORNERS, ShapeCorner, Shapes};

use crate::bindings::{OfScenery, ScenerySet};
use crate::gpu::drawing::Drawing;
use crate::gpu::stage::{Bindings, ShaderError};
use crate::gpu::{Gpu, QueueGuard};
use crate::layout::{SceneryUniform, Variant, image_pitch_px};
use crate::renderer::Setup;
use crate::shaders;
use crate::targets::Targets;
use base::space::{Eye, Pose};
use base::srgb::linear_of_step;
use glam::{DMat3, DMat4, DVec3, DVec4};
use wgpu::util::DrawIndirectArgs;

/// Places are told to the GPU within this many meters of the grid's origin: a whole number of its widest cells.
const GRID_PERIOD_M: f64 = 1000.0;

/// How the surround looks. Colors are sRGB.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Surround {
    /// Color straight up.
    pub sky: [u8; 3],
    /// Color of the horizon.
    pub horizon: [u8; 3],
    /// Color straight down.
    pub ground: [u8; 3],
    /// Color of the grid's lines; `None`: there is no grid.
    pub grid: Option<[u8; 3]>,
}

/// From where a frame's scenery is seen.
#[derive(Clone, Copy, Debug)]
pub struct SceneryView<'a> {
    /// The eyes in the stage: their `world_from_view` is the stage's, in meters, y up.
    pub eyes: &'a [Eye],
    /// Depth of the near plane, meters.
    pub near_m: f64,
    /// World units a meter.
    pub units_per_m: f64,
    /// The grid in the stage: its floor is at y = 0, and it may be turned about the vertical.
    pub stage_from_grid: Pose,
    /// How much of the edge of sight is dark, 0 to 1.
    pub vignette: f32,
}

/// What the stage draws with, and what it draws next.
#[derive(Debug)]
pub(super) struct Scenery {
    surround: Option<Surround>,
    over_all: [SceneryPass; 2],
    shape: SceneryPass,
    uniforms: [wgpu::Buffer; 2],
    corners: wgpu::Buffer,
    /// [`DrawIndirectArgs`] of the surround, the shapes and the vignette.
    draws: wgpu::Buffer,
    card_sampler: wgpu::Sampler,
    card: wgpu::TextureView,
    /// Bind groups of the surround, the shapes and the vignette, an eye each; made anew with `binding`.
    groups: Vec<[wgpu::BindGroup; 3]>,
    binding: Option<u64>,
}

/// A pipeline, and what it binds.
#[derive(Debug)]
struct SceneryPass {
    pipeline: wgpu::RenderPipeline,
    bindings: Bindings<ScenerySet>,
}

impl Scenery {
    pub fn new(gpu: &Gpu, setup: &Setup, surround: Option<Surround>) -> Result<Self, ShaderError> {
        let wgsl = shaders::SCENERY.source(Variant::eyes(2));
        let pass = |entries, buffers: &[Option<wgpu::VertexBufferLayout>]| {
            SceneryPass::new(gpu, setup, &wgsl, entries, buffers)
        };
        let usage = |other| wgpu::BufferUsages::COPY_DST | other;
        let uniform =
            |_| gpu.buffer("scenery", size_of::<SceneryUniform>() as u64, usage(wgpu::BufferUsages::UNIFORM));
        let num_bytes = (MOST_CORNERS * size_of::<ShapeCorner>()) as u64;
        Ok(Self {
            surround,
            over_all: [pass(["whole", "surround"], &[])?, pass(["whole", "vignette"], &[])?],
            shape: pass(["corner", "shape"], &[Some(ShapeCorner::layout())])?,
            uniforms: [0, 1].map(uniform),
            corners: gpu.buffer("corners", num_bytes, usage(wgpu::BufferUsages::VERTEX)),
            draws: gpu.buffer(
                "draws",
                3 * size_of::<DrawIndirectArgs>() as u64,
                usage(wgpu::BufferUsages::INDIRECT),
            ),
            card_sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("card"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            card: no_card(gpu),
            groups: vec![],
            binding: None,
        })
    }

    /// Sets what is seen where no point is, from the next frame on.
    pub fn set_surround(&mut self, surround: Option<Surround>) {
        self.surround = surround;
    }

    /// Sets the picture of the card, which shapes with places on it show; `None`: there is none.
    pub fn set_card(&mut self, gpu: &Gpu, card: Option<&wgpu::Texture>) {
        self.card = card.map_or_else(|| no_card(gpu), |card| card.create_view(&Default::default()));
        self.binding = None;
    }

    /// Makes bind groups anew where the renderer's buffers have changed.
    pub fn bind(&mut self, gpu: &Gpu, targets: &Targets, binding: u64) {
        if self.binding == Some(binding) {
            return;
        }
        let eye = |eye: usize| {
            let resources = OfScenery {
                scenery: self.uniforms[eye].as_entire_binding(),
                image_depth: targets.image_depth[eye].as_entire_binding(),
                card: wgpu::BindingResource::TextureView(&self.card),
                card_sampler: wgpu::BindingResource::Sampler(&self.card_sampler),
            };
            self.passes().map(|pass| pass.bind(gpu, &resources))
        };
        self.groups = (0..targets.sizes_px.len()).map(eye).collect();
        self.binding = Some(binding);
    }

    /// The passes, in the order in which they draw.
    fn passes(&self) -> [&SceneryPass; 3] {
        [&self.over_all[0], &self.shape, &self.over_all[1]]
    }

    /// Tells what the frame shows that is submitted next through the same guard. Shapes are in meters of the stage.
    pub fn set(&self, queue: &QueueGuard, view: &SceneryView, shapes: &Shapes, has_points: bool) {
        for (eye, uniform) in view.eyes.iter().zip(&self.uniforms) {
            queue.write_buffer(
                uniform,
                0,
                bytemuck::bytes_of(&uniform_of(view, eye, self.surround, has_points)),
            );
        }
        let corners = shapes.corners();
        if !corners.is_empty() {
            queue.write_buffer(&self.corners, 0, bytemuck::cast_slice(corners));
        }
        let draw = |num: usize| DrawIndirectArgs {
            vertex_count: num as u32,
            instance_count: 1,
            ..Default::default()
        };
        let over_all = |is_drawn: bool| draw(if is_drawn { 3 } else { 0 });
        let draws = [over_all(self.surround.is_some()), draw(corners.len()), over_all(view.vignette > 0.0)];
        queue.write_buffer(&self.draws, 0, bytemuck::cast_slice(&draws));
    }

    /// Draws an eye's part over its image.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, eye: usize) {
        pass.set_vertex_buffer(0, self.corners.slice(..));
        for (number, (drawn, group)) in self.passes().iter().zip(&self.groups[eye]).enumerate() {
            pass.set_pipeline(&drawn.pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.draw_indirect(&self.draws, (number * size_of::<DrawIndirectArgs>()) as u64);
        }
    }
}

impl SceneryPass {
    fn new(
        gpu: &Gpu,
        setup: &Setup,
        wgsl: &str,
        entries: [&str; 2],
        buffers: &[Option<wgpu::VertexBufferLayout>],
    ) -> Result<Self, ShaderError> {
        let target = wgpu::ColorTargetState {
            format: setup.color_format,
            blend: Some(wgpu::BlendState::ALPHA_BLENDING),
            write_mask: wgpu::ColorWrites::COLOR,
        };
        let [vertex, fragment] = entries;
        let name = "scenery";
        let bindings = Bindings::of(name, wgsl, vertex, &[])?.with(Bindings::of(name, wgsl, fragment, &[])?);
        let pipeline =
            Drawing { name, wgsl, entries, buffers, target: Some(target), depth_format: None }.pipeline(gpu);
        Ok(Self { pipeline, bindings })
    }

    fn bind(&self, gpu: &Gpu, resources: &OfScenery) -> wgpu::BindGroup {
        self.bindings.bind(&gpu.device, &self.pipeline.get_bind_group_layout(0), resources)
    }
}

/// A card of one pixel, for a binding cannot be empty.
fn no_card(gpu: &Gpu) -> wgpu::TextureView {
    let card = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("no card"),
        size: wgpu::Extent3d::default(),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8UnormSrgb,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    card.create_view(&Default::default())
}

/// What the shader is told of an eye.
#[must_use]
pub fn uniform_of(
    view: &SceneryView,
    eye: &Eye,
    surround: Option<Surround>,
    has_points: bool,
) -> SceneryUniform {
    let grid_from_view = view.stage_from_grid.inverse().then(&eye.world_from_view);
    let axes = DMat3::from_quat(grid_from_view.orientation);
    let [width, height] = eye.size_px.map(f64::from);
    let fov = eye.fov;
    let of = |x: f64, y: f64, z: f64| (axes * DVec3::new(x, y, z)).as_vec3().to_array();
    let p = grid_from_view.position;
    let within = |at: f64| at.rem_euclid(GRID_PERIOD_M);
    let colors = surround.unwrap_or_default();
    let linear = |rgb: [u8; 3]| rgb.map(|c| linear_of_step(c) as f32);
    SceneryUniform {
        clip_from_stage: clip_from_stage(eye, view.near_m),
        ray: of(fov.left, fov.up, -1.0),
        has_points: has_points.into(),
        ray_right: of((fov.right - fov.left) / width, 0.0, 0.0),
        units_per_m: view.units_per_m as f32,
        ray_down: of(0.0, (fov.down - fov.up) / height, 0.0),
        vignette: view.vignette.clamp(0.0, 1.0),
        ahead: of(0.0, 0.0, -1.0),
        pitch_px: image_pitch_px(eye.size_px[0]),
        eye_in_grid: [within(p.x), p.y, within(p.z)].map(|at| at as f32),
        has_surround: surround.is_some().into(),
        sky: linear(colors.sky),
        has_grid: colors.grid.is_some().into(),
        horizon: linear(colors.horizon),
        reserved: 0,
        ground: linear(colors.ground),
        reserved_ground: 0,
        line: linear(colors.grid.unwrap_or_default()),
        reserved_end: 0,
    }
}

/// [`Eye::clip_from_world`] as a matrix, column by column, for an eye in the stage.
fn clip_from_stage(eye: &Eye, near_m: f64) -> [[f32; 4]; 4] {
    let fov = eye.fov;
    let (width, height) = (fov.right - fov.left, fov.up - fov.down);
    let clip_from_view = DMat4::from_cols(
        DVec4::new(2.0 / width, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 2.0 / height, 0.0, 0.0),
        DVec4::new((fov.left + fov.right) / width, (fov.up + fov.down) / height, 0.0, -1.0),
        DVec4::new(0.0, 0.0, near_m, 0.0),
    );
    let clip_from_stage = clip_from_view * eye.world_from_view.inverse().matrix();
    clip_from_stage.as_mat4().to_cols_array_2d()
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::space::Fov;
    use glam::{DQuat, Mat4, Vec4};

    fn eye() -> Eye {
        Eye {
            world_from_view: Pose {
                position: DVec3::new(1.0, 1.7, -2.0),
                orientation: DQuat::from_rotation_y(0.7) * DQuat::from_rotation_x(-0.3),
            },
            fov: Fov { left: -1.1, right: 0.9, up: 0.8, down: -1.2 },
            size_px: [200, 100],
            gaze_in_view: Eye::AHEAD,
        }
    }

    fn view(eyes: &[Eye]) -> SceneryView<'_> {
        SceneryView { eyes, near_m: 0.05, units_per_m: 1.0, stage_from_grid: Pose::IDENTITY, vignette: 0.0 }
    }

    #[test]
    fn shapes_are_drawn_where_points_are() {
        let (eye, p) = (eye(), DVec3::new(0.2, 1.0, -4.0));
        let matrix = Mat4::from_cols_array_2d(&clip_from_stage(&eye, 0.05));
        let got = matrix * Vec4::from((p.as_vec3(), 1.0));
        let want = Vec4::from(eye.clip_from_world(p, 0.05));
        assert!((got - want).length() < 1e-5, "{got} {want}");
    }

    #[test]
    fn rays_go_through_their_pixels() {
        let eye = eye();
        let uniform = uniform_of(&view(&[eye]), &eye, None, true);
        let [ray, right, down, ahead] =
            [uniform.ray, uniform.ray_right, uniform.ray_down, uniform.ahead].map(glam::Vec3::from);
        let at = (ray + 120.5 * right + 30.5 * down).as_dvec3();
        let rows = eye.pixel_from_head(eye.world_from_view.position);
        let along = |row: [f64; 4]| DVec3::new(row[0], row[1], row[2]).dot(at);
        let w = along(rows[2]);
        assert!((w - 1.0).abs() < 1e-6, "{w}");
        assert!((along(rows[0]) - 120.5).abs() < 1e-3 && (along(rows[1]) - 30.5).abs() < 1e-3);
        assert!((ahead.as_dvec3() - eye.world_from_view.orientation * DVec3::NEG_Z).length() < 1e-6);
    }

    #[test]
    fn the_grid_stays_exact_far_from_its_origin() {
        let far = Pose { position: DVec3::new(-4e6 - 0.25, -3.0, 5e5), orientation: DQuat::IDENTITY };
        let eye = eye();
        let uniform = uniform_of(&SceneryView { stage_from_grid: far, ..view(&[eye]) }, &eye, None, true);
        let want = [1.25, 4.7, 998.0];
        assert!(
            uniform.eye_in_grid.iter().zip(want).all(|(got, want)| (got - want).abs() < 1e-4),
            "{uniform:?}"
        );
    }
}
