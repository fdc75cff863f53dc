//! The headset that stands in where there is none: the same stereo path with eye distance, field of view,
//! resolution and refresh rate from the configuration.

use crate::config::SimulatedConfig;
use base::space::{Fov, Pose};
use glam::{DQuat, DVec3};
use render::IMAGE_USAGES;
use render::gpu::Gpu;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};
use xr::{Beat, ControllerInput, End, EyeImages, Fault, Headset, StageEye};

/// Frames under way on the GPU before the next must wait, as a runtime's compositor would make it.
const MAX_IN_FLIGHT: usize = 2;
/// Format of the images; what most runtimes offer first.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// A headset without hardware. Its images stay valid, so the mirror shows them as they are.
#[derive(Debug)]
pub struct SimulatedHeadset {
    gpu: Arc<Gpu>,
    config: SimulatedConfig,
    images: [wgpu::Texture; 2],
    in_flight: VecDeque<wgpu::SubmissionIndex>,
    began: Instant,
    /// Display periods since `began` until the next frame.
    next_period: u64,
    exit_requested: bool,
}

impl SimulatedHeadset {
    /// One with images on `gpu`.
    #[must_use]
    pub fn new(gpu: &Arc<Gpu>, config: &SimulatedConfig) -> Self {
        let usage = IMAGE_USAGES | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let image = |label| gpu.texture(label, config.size_px, FORMAT, usage);
        Self {
            gpu: Arc::clone(gpu),
            config: config.clone(),
            images: [image("left eye"), image("right eye")],
            in_flight: VecDeque::with_capacity(MAX_IN_FLIGHT + 1),
            began: Instant::now(),
            next_period: 0,
            exit_requested: false,
        }
    }

    /// The eyes of a head at rest in the stage.
    #[must_use]
    pub fn eyes(config: &SimulatedConfig) -> [StageEye; 2] {
        let [outward, inward, up, down] = config.fov_deg.map(f64::to_radians);
        let left = Fov::from_angles(-outward, inward, up, -down);
        // sign: −1 left, +1 right. A positive turn about y (up) is to the left, which is outward for the left eye.
        [-1.0, 1.0].map(|sign: f64| StageEye {
            stage_from_view: Pose {
                position: DVec3::new(sign * 0.5 * config.eye_distance_m, config.eye_height_m, 0.0),
                orientation: DQuat::from_rotation_y(-sign * config.cant_deg.to_radians()),
            },
            fov: if sign < 0.0 { left } else { left.mirrored() },
            gaze_in_view: None,
        })
    }

    fn period(&self) -> Duration {
        Duration::from_secs_f64(1.0 / self.config.refresh_hz)
    }
}

impl Headset for SimulatedHeadset {
    fn runtime(&self) -> String {
        "simulated".to_string()
    }

    fn eye_sizes(&self) -> [[u32; 2]; 2] {
        [self.config.size_px; 2]
    }

    fn refresh_hz(&self) -> f64 {
        self.config.refresh_hz
    }

    fn image_format(&self) -> wgpu::TextureFormat {
        FORMAT
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn wait(&mut self) -> Result<Beat, Fault> {
        if self.exit_requested {
            return Ok(Beat::Ended(End::ByUser));
        }
        while self.in_flight.len() >= MAX_IN_FLIGHT {
            let submission_index = self.in_flight.pop_front();
            let wait = wgpu::PollType::Wait { submission_index, timeout: None };
            self.gpu.device.poll(wait).map_err(|error| Fault::DeviceLost(error.to_string()))?;
        }
        // The next display that can still be met; those that passed meanwhile are missed.
        let elapsed = self.began.elapsed();
        let passed = (elapsed.as_secs_f64() * self.config.refresh_hz) as u64;
        self.next_period = (self.next_period + 1).max(passed + 1);
        let period = self.period();
        let begin = period.mul_f64((self.next_period - 1) as f64);
        std::thread::sleep(begin.saturating_sub(elapsed));
        Ok(Beat::Frame {
            predicted_display_ns: period.mul_f64(self.next_period as f64).as_nanos() as i64,
            period_ns: period.as_nanos() as i64,
            should_render: true,
        })
    }

    fn input(&mut self) -> Result<ControllerInput, Fault> {
        Ok(ControllerInput::default())
    }

    fn acquire(&mut self) -> Result<EyeImages, Fault> {
        Ok(EyeImages { color: self.images.clone(), depth: None })
    }

    fn locate(&mut self) -> Result<[StageEye; 2], Fault> {
        Ok(Self::eyes(&self.config))
    }

    fn submit(&mut self, commands: Option<wgpu::CommandEncoder>) -> Result<(), Fault> {
        if let Some(commands) = commands {
            let commands = commands.finish();
            self.in_flight.push_back(self.gpu.queue.lock().submit([commands]));
        }
        Ok(())
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
        let config = SimulatedConfig {
            fov_deg: [50.0, 40.0, 45.0, 48.0],
            cant_deg: 5.0,
            ..SimulatedConfig::default()
        };
        let [left, right] = SimulatedHeadset::eyes(&config);
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
