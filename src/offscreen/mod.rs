//! Pictures: the frame drawn once, without a window, and written to disk. `docs/PICTURE.md` says which pixel a
//! point falls on.

mod options;

pub use options::{PictureError, PictureFov, PictureOptions};

use crate::draw::DrawPlan;
use crate::nodes::{self, CloudOptions};
use crate::overview::{self, Lens};
use crate::picture_files::{RgbImage, write_npy, write_png, write_with};
use crate::resolve::Plan;
use base::output::{Output, OutputFile};
use base::percentile::Sorted;
use base::space::{Eye, Pose, View};
use base::task::{Cancelled, Task};
use glam::DVec3;
use options::NO_DIRECTION;
use points::{self, Scan, Scene};
use render::gpu::Gpu;
use render::gpu::readback::ReadbackError;
use render::layout::depth_of;
use render::{CloudBuffers, EyeImage, FrameTimes, IMAGE_USAGES, Renderer, Setup};
use std::io::Write;
use std::sync::Arc;
use std::time::Instant;
use timing::STAGES;

/// Frames that are drawn to measure one; the first warms up.
const MEASURED_FRAMES: usize = 6;
/// Direction that one looks from unless the user chooses another: from the south-east, 25 degrees up.
const FROM: DVec3 = DVec3::new(0.55, -0.72, 0.42);
/// Format of the images: sRGB, so that the stored colors are read back.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Draws the picture and writes all files that were asked for.
///
/// # Errors
/// See [`PictureError`].
pub fn run(options: &PictureOptions, plan: &Plan, task: &Task) -> Result<(), PictureError> {
    options.check()?;
    let gpu = Arc::new(Gpu::open(Some(&plan.adapter))?);
    let load_began = Instant::now();
    let scan = points::read(&options.scans, &plan.read, task)?;
    for warning in &scan.warnings {
        eprintln!("scanwalk: warning: {warning}");
    }
    let options = &options.in_world(&scan);
    let (buffers, scene) = upload(&gpu, scan, &plan.cloud, task)?;
    let num_points = buffers.num_points;
    let load_s = load_began.elapsed().as_secs_f64();

    let view = view(options, &scene, plan.draw.near_in(&scene))?;
    let mut offscreen = Offscreen::new(&gpu, &view, &plan.draw)?;
    offscreen.renderer.set_cloud(buffers)?;
    let num_frames = if options.metrics.is_some() { MEASURED_FRAMES } else { 1 };
    let times: Vec<FrameTimes> =
        (0..num_frames).map(|frame| offscreen.draw(frame as u64, &view)).collect::<Result<_, _>>()?;

    if !offscreen.shows_points(&view)? {
        eprintln!("scanwalk: warning: {}", overview::out_of_view(&scene, &view));
    }
    // All files are written before the first gets its name, so that a failure leaves what was there before.
    let mut written: Vec<(&Output, OutputFile)> = Vec::new();
    for (output, image) in options.out.iter().zip(&offscreen.images) {
        written.push((output, write_png(output, &RgbImage::read(&gpu, image)?)?));
    }
    for (eye, output) in options.depth.iter().enumerate() {
        let depths: Vec<f32> = offscreen.depths(eye)?.collect();
        written.push((output, write_npy(output, options.size_px, &depths)?));
    }
    if let Some(output) = &options.metrics {
        let text = metrics(&mut offscreen, &times, num_points, load_s)?;
        written.push((output, write_with(output, |file| file.write_all(text.as_bytes()))?));
    }
    if task.cancel_token().is_cancelled() {
        return Err(Cancelled.into());
    }
    for (output, file) in written {
        output.keep(file)?;
    }
    Ok(())
}

/// Sends the scan to the GPU, as the settings want it; returns it with its scene.
fn upload(
    gpu: &Gpu,
    scan: Scan,
    options: &CloudOptions,
    task: &Task,
) -> Result<(CloudBuffers, Scene), PictureError> {
    let mut sent = None;
    nodes::send::<PictureError>(gpu, scan, options, task, |cloud, scene| {
        sent = Some((cloud, scene.clone()))
    })?;
    // What was sent has come.
    Ok(sent.expect("a cloud"))
}

/// Returns the eyes of the picture; `near` is in world units.
///
/// # Errors
/// Eye and target at one place, an upward direction of no length, or a field of view or a size that shows nothing.
pub fn view(options: &PictureOptions, scene: &Scene, near: f64) -> Result<View, PictureError> {
    options.check()?;
    let fov = options.fov.left(options.size_px);
    let half = 0.5 * options.ipd;
    let lenses = if options.stereo {
        vec![Lens { sideways: -half, fov }, Lens { sideways: half, fov: fov.mirrored() }]
    } else {
        vec![Lens { sideways: 0.0, fov }]
    };
    let up = options.up.unwrap_or(DVec3::Z);
    let center = match (options.eye, options.target) {
        (None, target) => {
            let orientation = Pose::look_at(FROM, DVec3::ZERO, up).orientation;
            Pose { position: overview::place(scene, orientation, &lenses, target), orientation }
        }
        (Some(eye), target) => {
            let target = target.unwrap_or(scene.bounds.center());
            if eye == target {
                return Err(PictureError::Usage(NO_DIRECTION.into()));
            }
            Pose::look_at(eye, target, up)
        }
    };
    let at = |&Lens { sideways, fov }: &Lens| {
        let position = center.position + center.orientation * DVec3::X * sideways;
        Eye {
            world_from_view: Pose { position, ..center },
            fov,
            size_px: options.size_px,
            gaze_in_view: Eye::AHEAD,
        }
    };
    Ok(View { eyes: lenses.iter().map(at).collect(), near })
}

/// A renderer with images of its own.
struct Offscreen {
    gpu: Arc<Gpu>,
    renderer: Renderer,
    images: Vec<wgpu::Texture>,
}

impl Offscreen {
    fn new(gpu: &Arc<Gpu>, view: &View, options: &DrawPlan) -> Result<Self, PictureError> {
        let sizes_px: Vec<[u32; 2]> = view.eyes.iter().map(|e| e.size_px).collect();
        let most = gpu.device.limits().max_texture_dimension_2d;
        if let Some(&[width, height]) =
            sizes_px.iter().find(|size_px| size_px.iter().any(|&edge| edge > most))
        {
            return Err(PictureError::Size { width, height, most });
        }
        let usage = IMAGE_USAGES | wgpu::TextureUsages::COPY_SRC;
        let images = sizes_px.iter().map(|&size_px| gpu.texture("picture", size_px, FORMAT, usage));
        let images = images.collect();
        let atomics = options.atomics(gpu)?;
        let setup = Setup { sizes_px, color_format: FORMAT, depth_format: None, atomics };
        let renderer = Renderer::with_technique(gpu, setup, options.options, options.technique.open(gpu))?;
        Ok(Self { gpu: Arc::clone(gpu), renderer, images })
    }

    /// True if any eye's picture has a point in it.
    fn shows_points(&self, view: &View) -> Result<bool, ReadbackError> {
        for eye in 0..view.eyes.len() {
            if self.depths(eye)?.any(f32::is_finite) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Draws one frame and waits for it.
    fn draw(&mut self, frame: u64, view: &View) -> Result<FrameTimes, PictureError> {
        let views: Vec<_> = self.images.iter().map(|i| i.create_view(&Default::default())).collect();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let images: Vec<EyeImage> = views.iter().map(|color| EyeImage { color, depth: None }).collect();
        self.renderer.record(&mut encoder, frame, &images);
        let commands = encoder.finish();
        {
            let queue = self.gpu.queue.lock();
            self.renderer.set_view(&queue, view);
            queue.submit([commands]);
        }
        self.renderer.submitted();
        self.gpu.poll(wgpu::PollType::wait_indefinitely()).map_err(ReadbackError::from)?;
        self.renderer.collect_times().ok_or(PictureError::NoFrame)
    }

    /// The depths of an eye's pixels, row by row; infinite where there is no point.
    fn depths(&self, eye: usize) -> Result<impl Iterator<Item = f32> + use<>, ReadbackError> {
        Ok(self.renderer.read_pixels(eye)?.into_iter().map(depth_of))
    }
}

/// Measures the figures of the picture, as JSON.
fn metrics(
    offscreen: &mut Offscreen,
    times: &[FrameTimes],
    points: u64,
    load_s: f64,
) -> Result<String, ReadbackError> {
    let measured = &times[1..];
    let median = |value: &dyn Fn(&FrameTimes) -> f32| {
        // A device without timestamps gives null.
        Sorted::new(measured.iter().map(|times| f64::from(value(times)))).median()
    };
    let mut gpu_ms = serde_json::Map::new();
    for (stage, name) in STAGES.iter().enumerate() {
        gpu_ms.insert((*name).to_string(), serde_json::json!(median(&|t| t.stage_ms[stage])));
    }
    gpu_ms.insert("total".to_string(), serde_json::json!(median(&|t| t.gpu_ms)));
    let mut drawn = 0;
    for eye in 0..offscreen.images.len() {
        drawn += offscreen.depths(eye)?.filter(|depth| depth.is_finite()).count();
    }
    let metrics = serde_json::json!({
        "points": points,
        "points_read": times[0].points_read,
        "points_drawn": drawn,
        "nodes": times[0].visible_nodes,
        "batches": times[0].visible_batches,
        "gpu_bytes": offscreen.renderer.resident().1,
        "load_s": load_s,
        "frames": measured.len(),
        "gpu_ms": gpu_ms,
        "device": offscreen.gpu.name(),
        "driver": offscreen.gpu.driver(),
    });
    Ok(format!("{metrics:#}\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use points::{Grid, ScanBuilder, UpAxis, WorldFromFile};

    #[test]
    fn places_are_those_of_the_file_and_eyes_are_apart_in_meters() {
        let options = PictureOptions {
            scans: Vec::new(),
            out: Vec::new(),
            eye: Some(DVec3::new(1.0, 2.0, 3.0)),
            target: None,
            up: Some(DVec3::Y),
            fov: PictureFov::Vertical(60.0),
            size_px: [1, 1],
            stereo: true,
            ipd: 0.063,
            depth: Vec::new(),
            metrics: None,
        };
        // The scan is in millimeters with y up, and its heights are in meters.
        let world_from_file = WorldFromFile::Axes { up: UpAxis::Y, across_scale: 1.0, height_scale: 1000.0 };
        let made = ScanBuilder::new(Grid::default(), Vec::new()).world_from_file(world_from_file);
        let mut scan = made.scan();
        scan.unit_m = Some(0.001);
        let in_world = options.in_world(&scan);
        assert_eq!(in_world.eye, Some(DVec3::new(1.0, -3.0, 2000.0)));
        assert_eq!((in_world.target, in_world.up), (None, Some(DVec3::Z)));
        assert!((in_world.ipd - 63.0).abs() < 1e-9);
        // A scan in meters as it is changes nothing.
        let same = options.in_world(&Scan::default());
        assert_eq!((same.eye, same.up, same.ipd), (options.eye, options.up, options.ipd));
    }

    #[test]
    fn cameras_without_a_direction_are_refused() {
        let eye = Some(DVec3::ONE);
        let options = |target, up| PictureOptions {
            scans: Vec::new(),
            out: Vec::new(),
            eye,
            target,
            up,
            fov: PictureFov::Vertical(60.0),
            size_px: [1, 1],
            stereo: false,
            ipd: 0.063,
            depth: Vec::new(),
            metrics: None,
        };
        let error = |target, up| {
            view(&options(target, up), &Scene::default(), 0.05).err().map(|error| error.to_string())
        };
        assert_eq!(error(Some(DVec3::ZERO), Some(DVec3::X)), None);
        assert!(error(eye, None).is_some_and(|error| error.contains("same place")));
        assert!(
            error(Some(DVec3::ZERO), Some(DVec3::ZERO)).is_some_and(|error| error.contains("--up 0,0,0"))
        );
    }
}
