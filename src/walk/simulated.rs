//! The headset that stands in where there is none: the same stereo path with eye distance, field of view, resolution and
//! refresh rate of the user's choice.

use base::space::{Fov, Pose};
use glam::{DQuat, DVec3};
use render::IMAGE_USAGES;
use render::gpu::Gpu;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};
use xr::{ControllerInput, End, EyeImages, FrameState, Headset, StageEye};

/// What stands in for the name of a runtime.
pub const SIMULATED: &str = "simulated";

/// Frames under way on the GPU before the next must wait, as a runtime's compositor would make it.
const MAX_IN_FLIGHT: usize = 2;
/// Format of the images: the one that most runtimes offer first.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// What the simulated headset is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulatedOptions {
    /// Pixels of each eye's image: width, height.
    pub size_px: [u32; 2],
    /// What the left eye sees; the right eye mirrors it.
    pub left_fov: Fov,
    /// Distance between the eyes, meters.
    pub eye_distance_m: f64,
    /// Outward turn of each eye's display, radians.
    pub cant_rad: f64,
    /// Displays a second.
    pub refresh_hz: f64,
    /// Height of the eyes above the floor, meters.
    pub eye_height_m: f64,
}

/// A headset without hardware. Its images stay valid, so the mirror shows them as they are.
#[derive(Debug)]
pub struct SimulatedHeadset {
    gpu: Arc<Gpu>,
    options: SimulatedOptions,
    images: [wgpu::Texture; 2],
    in_flight: VecDeque<wgpu::SubmissionIndex>,
    began: Instant,
    /// Display periods since `began` until the next frame.
    next_period: u64,
    exit_requested: bool,
}

impl SimulatedHeadset {
    /// A simulated headset with images on `gpu`.
    #[must_use]
    pub fn new(gpu: &Arc<Gpu>, options: SimulatedOptions) -> Self {
        let usage = IMAGE_USAGES | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let image = |label| gpu.texture(label, options.size_px, FORMAT, usage);
        Self {
            gpu: Arc::clone(gpu),
            options,
            images: [image("left eye"), image("right eye")],
            in_flight: VecDeque::with_capacity(MAX_IN_FLIGHT + 1),
            began: Instant::now(),
            next_period: 0,
            exit_requested: false,
        }
    }

    /// The eyes of a head at rest in the stage.
    #[must_use]
    pub fn eyes(options: &SimulatedOptions) -> [StageEye; 2] {
        let SimulatedOptions { left_fov, eye_distance_m, eye_height_m, cant_rad, .. } = *options;
        // `sign` is −1 for the left eye and +1 for the right. A positive turn about y (up) is to the left, which is
        // outward for the left eye.
        [-1.0, 1.0].map(|sign: f64| StageEye {
            stage_from_view: Pose {
                position: DVec3::new(sign * 0.5 * eye_distance_m, eye_height_m, 0.0),
                orientation: DQuat::from_rotation_y(-sign * cant_rad),
            },
            fov: if sign < 0.0 { left_fov } else { left_fov.mirrored() },
            gaze_in_view: None,
        })
    }

    fn period(&self) -> Duration {
        Duration::from_secs_f64(1.0 / self.options.refresh_hz)
    }
}

impl Headset for SimulatedHeadset {
    fn runtime(&self) -> String {
        SIMULATED.to_string()
    }

    fn eye_sizes(&self) -> [[u32; 2]; 2] {
        [self.options.size_px; 2]
    }

    fn refresh_hz(&self) -> f64 {
        self.options.refresh_hz
    }

    fn image_format(&self) -> wgpu::TextureFormat {
        FORMAT
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn wait(&mut self) -> FrameState {
        if self.exit_requested {
            return FrameState::Ended(End::ByUser);
        }
        while self.in_flight.len() >= MAX_IN_FLIGHT {
            let submission_index = self.in_flight.pop_front();
            let wait = wgpu::PollType::Wait { submission_index, timeout: None };
            if let Err(error) = self.gpu.poll(wait) {
                return FrameState::Ended(End::DeviceLost(error.to_string()));
            }
        }
        // The frame is for the next display that can still be met; displays that passed meanwhile are missed.
        let elapsed = self.began.elapsed();
        let passed = (elapsed.as_secs_f64() * self.options.refresh_hz) as u64;
        self.next_period = (self.next_period + 1).max(passed + 1);
        let period = self.period();
        let begin = period.mul_f64((self.next_period - 1) as f64);
        std::thread::sleep(begin.saturating_sub(elapsed));
        FrameState::Frame {
            predicted_display_ns: period.mul_f64(self.next_period as f64).as_nanos() as i64,
            period_ns: period.as_nanos() as i64,
            should_render: true,
        }
    }

    fn input(&mut self) -> ControllerInput {
        ControllerInput::default()
    }

    fn acquire(&mut self) -> Option<EyeImages> {
        Some(EyeImages { color: self.images.clone(), depth: None })
    }

    fn locate(&mut self) -> [StageEye; 2] {
        Self::eyes(&self.options)
    }

    fn submit(&mut self, commands: Option<wgpu::CommandEncoder>) {
        if let Some(commands) = commands {
            let commands = commands.finish();
            self.in_flight.push_back(self.gpu.queue.lock().submit([commands]));
        }
    }

    fn request_exit(&mut self) {
        self.exit_requested = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eyes_mirror_each_other() {
        let options = SimulatedOptions {
            size_px: [960, 1080],
            left_fov: Fov::from_angles(-0.9, 0.7, 0.8, -0.85),
            eye_distance_m: 0.063,
            cant_rad: 0.1,
            refresh_hz: 90.0,
            eye_height_m: 1.7,
        };
        let [left, right] = SimulatedHeadset::eyes(&options);
        assert!(left.stage_from_view.position.x < 0.0 && right.stage_from_view.position.x > 0.0);
        assert!(
            (left.fov.left + right.fov.right).abs() < 1e-12
                && (left.fov.right + right.fov.left).abs() < 1e-12
        );
        assert!(left.fov.left.abs() > left.fov.right, "outward is wider");
        let forward = |e: &StageEye| e.stage_from_view.orientation * DVec3::NEG_Z;
        assert!(forward(&left).x < 0.0 && forward(&right).x > 0.0, "displays turn outward");
    }
}
