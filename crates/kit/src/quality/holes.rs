//! Holes by the angle from the gaze: the pixels that are empty although the frame without level of detail fills them,
//! for headsets, presets and steps of the governor.

use crate::frames::{SplitMix, image};
use anyhow::{Context, Result};
use base::space::{Eye, Fov, Pose, View};
use glam::DVec3;
use lab::synth::Viewpoint;
use points::{Grid, Scan, ScanBuilder};
use render::gpu::{Atomics, Gpu, readback};
use render::{self, CloudBuffers, DrawOptions, EyeImage, Renderer, Setup};
use std::sync::Arc;

/// Angles from the gaze at which the rings end, degrees; the last reaches to the image's corners.
pub const RINGS_DEG: [f64; 5] = [20.0, 38.0, 50.0, 55.0, 180.0];
/// Pixels from an empty pixel within which a filled one belongs to an outline: dilation takes a point this far beyond
/// the surface, with or without level of detail.
pub const OUTLINE_PX: usize = render::layout::DILATE_REACH_PX as usize;
/// Color of empty pixels, which no point has.
pub const EMPTY_RGB: [u8; 3] = [255, 0, 255];
/// The viewpoint in the middle of the sphere that [`sphere`] makes.
pub const INSIDE: Viewpoint =
    Viewpoint { name: "inside", eye: DVec3::ZERO, target: DVec3::new(3.0, 4.0, 0.5) };
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// Radius of the sphere that [`sphere`] makes, world units.
const SPHERE_RADIUS: f64 = 5.0;

/// A closed sphere round the origin, of points at random, equally likely everywhere on it.
pub fn sphere(num_points: u64) -> Scan {
    let mut random = SplitMix(0x5ca1_ab1e);
    let mut unit = || random.unit();
    let scale = 1e-5;
    let (mut xyz, mut rgb) = (Vec::new(), Vec::new());
    for _ in 0..num_points {
        let (z, turn) = (2.0 * unit() - 1.0, std::f64::consts::TAU * unit());
        let across = (1.0 - z * z).sqrt();
        let p = SPHERE_RADIUS * DVec3::new(across * turn.cos(), across * turn.sin(), z);
        xyz.push((p / scale).round().as_ivec3().to_array());
        // Stripes let one see something.
        let stripe = ((4.0 * p.x).floor() + (4.0 * p.y).floor() + (4.0 * p.z).floor()).rem_euclid(2.0);
        rgb.push([40 + 150 * stripe as u16, 90, 160]);
    }
    let grid = Grid { scale: DVec3::splat(scale), offset: DVec3::ZERO };
    ScanBuilder::new(grid, xyz).path("sphere").rgb(rgb).scan()
}

/// One eye at a place, which looks where a headset's left eye does, with `share` of the width and height `size_px`.
/// `near` is in world units.
pub fn left_eye(place: &Viewpoint, fov: Fov, (size_px, share): ([u32; 2], f64), near: f64) -> View {
    let world_from_view = Pose::look_at(place.eye, place.target, DVec3::Z);
    let size_px = size_px.map(|size| (share * f64::from(size)).round() as u32);
    View { eyes: vec![Eye { world_from_view, fov, size_px, gaze_in_view: Eye::AHEAD }], near }
}

/// The part of a frame that is needed to count holes.
#[derive(Clone, Debug)]
pub struct EyeFrame {
    /// Width, height.
    pub size_px: [u32; 2],
    /// Colors, sRGB as stored.
    pub rgb: Vec<[u8; 3]>,
    /// Points in the batches that were drawn.
    pub points_read: u64,
}

impl EyeFrame {
    fn is_empty(&self, pixel: usize) -> bool {
        self.rgb[pixel] == EMPTY_RGB
    }

    /// The picture, in which pixels that are empty and no hole are black.
    pub fn marked(&self, whole: Option<&Self>, outline_px: usize) -> Vec<[u8; 3]> {
        let is_hole = |pixel: usize| whole.is_none_or(|whole| whole.is_inside(pixel, outline_px));
        let color =
            |pixel: usize| if self.is_empty(pixel) && !is_hole(pixel) { [0; 3] } else { self.rgb[pixel] };
        (0..self.rgb.len()).map(color).collect()
    }

    /// True if all pixels within the width of an outline show something.
    fn is_inside(&self, pixel: usize, outline_px: usize) -> bool {
        let [width, height] = self.size_px.map(|size| size as usize);
        let around = |at: usize, size: usize| at.saturating_sub(outline_px)..size.min(at + outline_px + 1);
        let (mut rows, columns) = (around(pixel / width, height), around(pixel % width, width));
        rows.all(|y| columns.clone().all(|x| !self.is_empty(y * width + x)))
    }
}

/// Draws frames of one eye.
pub struct Drawer {
    gpu: Arc<Gpu>,
    renderer: Renderer,
    image: wgpu::Texture,
    frame: u64,
}

impl Drawer {
    /// Makes a drawer of a cloud, in pictures of this size; `options` say what pipelines are for.
    ///
    /// # Errors
    /// If the size does not fit the GPU.
    pub fn new(
        gpu: &Arc<Gpu>,
        cloud: CloudBuffers,
        atomics: Atomics,
        options: DrawOptions,
        size_px: [u32; 2],
    ) -> Result<Self> {
        let setup = Setup { sizes_px: vec![size_px], color_format: FORMAT, depth_format: None, atomics };
        let mut renderer = Renderer::new(gpu, setup, options)?;
        renderer.set_cloud(cloud)?;
        Ok(Self { gpu: Arc::clone(gpu), renderer, image: image(gpu, size_px, FORMAT), frame: 0 })
    }

    /// Gives the cloud back.
    pub fn finish(mut self) -> Option<CloudBuffers> {
        self.renderer.take_cloud()
    }

    /// Draws one frame, with thresholds multiplied as the governor does, in which empty pixels have a color of their own.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn draw(&mut self, options: DrawOptions, view: &View, lod_scale: f32) -> Result<EyeFrame> {
        self.renderer.set_options(DrawOptions { background: EMPTY_RGB, ..options })?;
        self.renderer.set_lod_scale(lod_scale);
        let color = &self.image.create_view(&wgpu::TextureViewDescriptor::default());
        self.frame += 1;
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.renderer.record(&mut encoder, self.frame, &[EyeImage { color, depth: None }]);
        {
            let queue = self.gpu.queue.lock();
            self.renderer.set_view(&queue, view);
            queue.submit([encoder.finish()]);
        }
        self.renderer.submitted();
        let rgba = readback::read_texture(&self.gpu, &self.image)?;
        let points_read = self.renderer.collect_times().context("the GPU gave no frame back")?.points_read;
        let size_px = view.eyes[0].size_px;
        Ok(EyeFrame { size_px, rgb: rgba.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect(), points_read })
    }
}

/// These options with every point drawn.
pub fn unreduced(mut options: DrawOptions) -> DrawOptions {
    options.detail.threshold_px = [1e-3; 3];
    options
}

/// Pixels that are judged, of a ring or of outlines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Judged {
    /// Number of these pixels that are empty.
    pub empty: u64,
    /// Number of these pixels.
    pub judged: u64,
}

impl Judged {
    /// Share that is empty, in percent; NaN where nothing is judged.
    pub fn percent(&self) -> f64 {
        100.0 * self.empty as f64 / self.judged as f64
    }
}

/// Empty pixels of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RingHoles {
    /// Pixels by the angle from the gaze: those all around which the frame that draws every point is filled, or all
    /// pixels if there is no such frame.
    pub rings: [Judged; RINGS_DEG.len()],
    /// Pixels that the frame that draws every point fills, at the edge of those that it leaves empty.
    pub outline: Judged,
}

/// Holes of a frame, beside the frame that draws every point, if there is one, whose outlines are `outline_px` wide.
pub fn holes(view: &View, drawn: &EyeFrame, whole: Option<&EyeFrame>, outline_px: usize) -> RingHoles {
    let eye = &view.eyes[0];
    let (fov, gaze) = (eye.fov, eye.gaze_in_view.normalize());
    let cosines = RINGS_DEG.map(|deg| deg.to_radians().cos());
    let [width, height] = drawn.size_px.map(|size| size as usize);
    let mut holes = RingHoles::default();
    for pixel in (0..width * height).filter(|&pixel| whole.is_none_or(|whole| !whole.is_empty(pixel))) {
        let share = |at: usize, size: usize| (at as f64 + 0.5) / size as f64;
        let right = fov.left + (fov.right - fov.left) * share(pixel % width, width);
        let up = fov.up + (fov.down - fov.up) * share(pixel / width, height);
        let along = DVec3::new(right, up, -1.0).normalize().dot(gaze);
        let number = cosines.iter().position(|&cos| along >= cos).unwrap_or(RINGS_DEG.len() - 1);
        let is_inside = whole.is_none_or(|whole| whole.is_inside(pixel, outline_px));
        let part = if is_inside { &mut holes.rings[number] } else { &mut holes.outline };
        part.judged += 1;
        part.empty += u64::from(drawn.is_empty(pixel));
    }
    holes
}
