//! The program that the tests run inside the runtime: a frame loop as the walk has it, with a test pattern.

use base::space::Pose;
use kit::program::{command, this_program};
use kit::xr::poses::{Packet, Remote};
use kit::xr::{Finished, Running, TestRuntime};
use render::gpu::Gpu;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::time::Duration;
use xr::hidden_area::HiddenArea;
use xr::{self, Connection, XrHeadset, XrOptions};
use xr::{EyeImages, FrameState, HandInput, HandJoints, Headset, Joint, StageEye};

/// Environment variable that carries the [`Job`] to the child.
pub const JOB: &str = "SCANWALK_XR_PROBE";

/// What the probe is to do.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Job {
    /// Asks for the end after this many drawn frames; 0: never.
    pub exit_after: u64,
    /// Writes what it submitted to `$XR_RUN/left.rgba` and `right.rgba` with this drawn frame; 0: never.
    pub dump_frame: u64,
    /// Factor on the recommended size; 0 means 1.
    pub resolution_scale: f64,
    /// Another thread submits as fast as it can.
    pub busy_thread: bool,
    /// Nearest depth; 0: as the settings have it.
    pub near_m: f64,
    /// Uses neither depth layer nor visibility mask.
    pub plain: bool,
    /// Writes the pixels that the left eye's lens hides to `$XR_RUN/hidden.bits` when it is told, as
    /// [`HiddenArea::rasterize`] makes them.
    pub dump_hidden: bool,
    /// Does not follow bare hands.
    pub no_hands: bool,
    /// Reports the joints of bare hands.
    pub joints: bool,
    /// Shakes the right controller with every drawn frame from this one on; 0: never.
    pub vibrate_from: u64,
    /// A deliberate error: see `validation.rs`.
    pub misuse: String,
}

impl Job {
    /// Starts the probe in a runtime.
    pub fn start(&self, runtime: &TestRuntime) -> Running {
        let job = serde_json::to_string(self).unwrap();
        runtime.clone().variable(JOB, job).start(&this_program(), &PROBE_ARGS)
    }

    /// Runs the probe in a runtime until its end.
    pub fn run(&self, runtime: &TestRuntime) -> Finished {
        self.start(runtime).finish()
    }

    /// A command that runs the probe as it is, without a runtime of ours.
    pub fn bare(&self) -> Command {
        let mut command = command(this_program());
        command.args(PROBE_ARGS).env(JOB, serde_json::to_string(self).unwrap());
        command
    }
}

/// This test binary's arguments that run the probe alone.
pub const PROBE_ARGS: [&str; 6] =
    ["probe::probe", "--exact", "--ignored", "--nocapture", "--test-threads", "1"];

/// The last value of `key` among a program's lines.
pub fn last(lines: &[String], key: &str) -> Option<Value> {
    lines.iter().rev().find_map(|line| Some(serde_json::from_str::<Value>(line).ok()?.get(key)?.clone()))
}

/// A frame as the probe reported it.
#[derive(Clone, Debug, Deserialize)]
pub struct ProbeFrame {
    pub frame: u64,
    pub state: String,
    /// Position, orientation x, y, z, w, tangents left, right, up, down; left eye, then right.
    pub eyes: [([f64; 3], [f64; 4], [f64; 4]); 2],
    /// Left hand, right hand.
    pub hands: [ProbeHand; 2],
}

/// Position and orientation x, y, z, w in the stage.
pub type StagePose = ([f64; 3], [f64; 4]);

/// A hand as the probe reported it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct ProbeHand {
    pub aim: Option<StagePose>,
    pub grip: Option<StagePose>,
    pub stick: [f32; 2],
    pub has_stick: bool,
    pub select: bool,
    pub grab: bool,
    pub menu: bool,
    pub reset: bool,
    /// Poses and radii, if the job asks for them.
    pub joints: Option<Vec<(StagePose, f64)>>,
}

/// Sends a state and waits for a frame that shows it.
pub fn settle(
    run: &mut Running,
    remote: &mut Remote,
    packet: &Packet,
    shown: impl Fn(&ProbeFrame) -> bool,
) -> ProbeFrame {
    remote.send(packet);
    run.wait_for("frame with the state sent", |line| frame(line).filter(|frame| shown(frame)))
}

/// A line as a frame, if it is one.
pub fn frame(line: &str) -> Option<ProbeFrame> {
    serde_json::from_str(line).ok()
}

/// This is not a test of its own but the program of the others.
#[test]
#[ignore = "runs inside a child process of the other tests"]
fn probe() {
    let Ok(job) = std::env::var(JOB) else { return };
    println!();
    let job: Job = serde_json::from_str(&job).unwrap();
    // Warnings go to stderr, as the program's do.
    let log = tracing_subscriber::fmt().with_max_level(tracing::Level::WARN).with_ansi(false);
    log.with_writer(std::io::stderr).init();
    if job.misuse == "openxr" {
        return crate::validation::misuse_openxr();
    }
    let asked_or = |asked: f64, otherwise: f64| if asked > 0.0 { asked } else { otherwise };
    let options = XrOptions {
        resolution_scale: asked_or(job.resolution_scale, 1.0),
        refresh_hz: None,
        depth_layer: !job.plain,
        visibility_mask: !job.plain,
        hands: !job.no_hands,
        near_m: asked_or(job.near_m, 0.05),
    };
    let headset = match Connection::new().and_then(|connection| connection.open(&options)) {
        Ok(headset) => headset,
        Err(missing) => return report(&json!({ "missing": missing.to_string() })),
    };
    let gpu = Arc::clone(headset.gpu());
    if job.misuse == "vulkan" {
        crate::validation::misuse_vulkan(&gpu);
    }
    report(&json!({
        "runtime": headset.runtime(),
        "headset": headset.name(),
        "sizes": headset.eye_sizes(),
        "hz": headset.refresh_hz(),
        "format": format!("{:?}", headset.image_format()),
        "offers_depth": headset.offers().depth_layer,
        "offers_mask": headset.offers().visibility_mask,
        "offers_hands": headset.offers().hand_tracking,
        "depth_format": headset.depth_format().map(|format| format!("{format:?}")),
    }));
    let mut looper =
        Loop { pattern: Pattern::new(&gpu, headset.image_format()), gpu: &gpu, headset, drawn: 0, job };
    let stop = std::sync::atomic::AtomicBool::new(false);
    let end = std::thread::scope(|scope| {
        if looper.job.busy_thread {
            scope.spawn(|| keep_busy(&gpu, &stop));
        }
        let end = looper.run();
        // The other thread still submits here: the session must be able to go at any time.
        drop(looper);
        stop.store(true, std::sync::atomic::Ordering::Release);
        end
    });
    match end {
        Ok((reason, focused)) => report(&json!({ "ended": reason.to_string(), "reached_focus": focused })),
        Err(error) => report(&json!({ "error": format!("{error:#}") })),
    }
}

fn report(value: &Value) {
    println!("{value}");
}

/// Submits until told to stop, as a window's thread would.
fn keep_busy(gpu: &Gpu, stop: &std::sync::atomic::AtomicBool) {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("busy"),
        size: 1 << 16,
        usage: wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut num_submits = 0_u64;
    while !stop.load(std::sync::atomic::Ordering::Acquire) {
        let mut commands = gpu.device.create_command_encoder(&Default::default());
        commands.clear_buffer(&buffer, 0, None);
        gpu.queue.lock().submit([commands.finish()]);
        num_submits += 1;
        let _ = gpu.poll(wgpu::PollType::Poll);
        std::thread::sleep(Duration::from_micros(200));
    }
    report(&json!({ "busy_submits": num_submits }));
}

/// The frame loop.
struct Loop<'a> {
    headset: XrHeadset,
    pattern: Pattern,
    gpu: &'a Gpu,
    drawn: u64,
    job: Job,
}

impl Loop<'_> {
    /// Draws frames until the end; returns the reason, and whether the session was ever in focus.
    fn run(&mut self) -> anyhow::Result<(xr::End, bool)> {
        loop {
            match self.headset.wait() {
                FrameState::Ended(reason) => return Ok((reason, self.headset.reached_focus())),
                FrameState::Idle => std::thread::sleep(self.headset.idle_pause()),
                FrameState::Frame { should_render, .. } => self.frame(should_render)?,
            }
        }
    }

    fn frame(&mut self, should_render: bool) -> anyhow::Result<()> {
        let input = self.headset.input();
        let joints = self.headset.hands();
        if !should_render {
            report(&json!({ "hidden_frame": format!("{:?}", self.headset.state()) }));
            self.headset.submit(None);
            return Ok(());
        }
        let Some(images) = self.headset.acquire() else {
            report(&json!({ "no_images": true }));
            self.headset.submit(None);
            return Ok(());
        };
        let EyeImages { color, depth } = &images;
        self.drawn += 1;
        let mut commands = self.gpu.device.create_command_encoder(&Default::default());
        self.pattern.draw(&mut commands, color);
        depth.iter().flatten().for_each(|image| clear_depth(&mut commands, image));
        let dump = (self.drawn == self.job.dump_frame)
            .then(|| color.each_ref().map(|image| Readback::record(self.gpu, &mut commands, image)));
        let eyes = self.headset.locate();
        if let Some(areas) = self.headset.hidden_area() {
            self.report_hidden(&areas, &eyes)?;
        }
        self.headset.submit(Some(commands));
        if self.job.vibrate_from > 0 && self.drawn >= self.job.vibrate_from {
            self.headset.vibrate(1, 0.5, 0.02);
        }
        let hands = [0, 1].map(|hand: usize| {
            let joints = joints[hand].filter(|_| self.job.joints);
            hand_json(&input.hands[hand], joints.as_ref())
        });
        report(&json!({
            "frame": self.drawn,
            "state": format!("{:?}", self.headset.state()),
            "eyes": eyes.map(eye_json),
            "hands": hands,
            "gaze": eyes.map(|eye| eye.gaze_in_view.map(|gaze| gaze.to_array())),
        }));
        if let Some([left, right]) = dump {
            let folder = PathBuf::from(std::env::var_os("XR_RUN").unwrap());
            left.write(self.gpu, &folder.join("left.rgba"))?;
            right.write(self.gpu, &folder.join("right.rgba"))?;
            report(&json!({ "dumped": true }));
        }
        if self.drawn == self.job.exit_after {
            self.headset.request_exit();
        }
        Ok(())
    }

    fn report_hidden(&self, areas: &[HiddenArea; 2], eyes: &[StageEye; 2]) -> anyhow::Result<()> {
        if self.job.dump_hidden {
            let pixels = areas[0].rasterize(&eyes[0].fov, self.headset.eye_sizes()[0]);
            let folder = PathBuf::from(std::env::var_os("XR_RUN").unwrap());
            std::fs::write(folder.join("hidden.bits"), bytemuck::cast_slice(&pixels))?;
        }
        let triangles = areas.each_ref().map(|area| area.triangles.len());
        report(&json!({
            "hidden_triangles": triangles,
            "hidden_at_frame": self.drawn,
        }));
        Ok(())
    }
}

/// Clears depth so that everything is at the same depth.
fn clear_depth(commands: &mut wgpu::CommandEncoder, image: &wgpu::Texture) {
    let clear = wgpu::Operations { load: wgpu::LoadOp::Clear(0.25), store: wgpu::StoreOp::Store };
    commands.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("depth"),
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &image.create_view(&Default::default()),
            depth_ops: Some(clear),
            stencil_ops: None,
        }),
        ..Default::default()
    });
}

fn eye_json(eye: StageEye) -> Value {
    let StageEye { stage_from_view: pose, fov, .. } = eye;
    json!([pose.position.to_array(), pose.orientation.to_array(), [fov.left, fov.right, fov.up, fov.down]])
}

fn pose_json(pose: &Pose) -> Value {
    json!([pose.position.to_array(), pose.orientation.to_array()])
}

fn hand_json(hand: &HandInput, joints: Option<&HandJoints>) -> Value {
    let joint_json = |joint: &Joint| json!([pose_json(&joint.stage_from_joint), joint.radius_m]);
    json!({
        "aim": hand.stage_from_aim.as_ref().map(pose_json),
        "grip": hand.stage_from_grip.as_ref().map(pose_json),
        "stick": hand.stick,
        "has_stick": hand.has_stick,
        "select": hand.select,
        "grab": hand.grab,
        "menu": hand.menu,
        "reset": hand.reset,
        "joints": joints.map(|joints| joints.iter().map(joint_json).collect::<Vec<_>>()),
    })
}

/// Draws a red picture for the left eye and a green one for the right: noise of its own in every pixel, and white top
/// left corners.
struct Pattern {
    pipelines: [wgpu::RenderPipeline; 2],
}

const PATTERN: &str = "
override EYE: u32;
@vertex fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32((i << 1u) & 2u) * 2.0 - 1.0, f32(i & 2u) * 2.0 - 1.0, 0.0, 1.0);
}
@fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(at.xy);
    if (pixel.x < 64u && pixel.y < 32u) { return vec4(1.0); }
    var noise = pixel.x * 1973u + pixel.y * 9277u + EYE * 26699u;
    noise = (noise ^ (noise >> 7u)) * 2654435761u;
    let bright = 0.5 + f32(noise >> 24u) / 512.0;
    let dark = f32((noise >> 16u) & 255u) / 1024.0;
    return select(vec4(dark, bright, dark, 1.0), vec4(bright, dark, dark, 1.0), EYE == 0u);
}
";

impl Pattern {
    fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("pattern"),
            source: wgpu::ShaderSource::Wgsl(PATTERN.into()),
        });
        let pipelines = [0.0, 1.0].map(|eye| {
            let constants = [("EYE", eye)];
            let compilation_options =
                wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
            gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("pattern"),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("vertex"),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: Default::default(),
                depth_stencil: None,
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("fragment"),
                    compilation_options,
                    targets: &[Some(format.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        });
        Self { pipelines }
    }

    fn draw(&self, commands: &mut wgpu::CommandEncoder, images: &[wgpu::Texture; 2]) {
        for (pipeline, image) in self.pipelines.iter().zip(images) {
            let view = image.create_view(&Default::default());
            let mut pass = commands.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("pattern"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            pass.set_pipeline(pipeline);
            pass.draw(0..3, 0..1);
        }
    }
}

/// A copy of an image on its way to the CPU. It leaves the image in another layout than the runtime wants, which the
/// headset has to put right.
struct Readback {
    buffer: wgpu::Buffer,
    row_bytes: u32,
    size: wgpu::Extent3d,
}

impl Readback {
    fn record(gpu: &Gpu, commands: &mut wgpu::CommandEncoder, image: &wgpu::Texture) -> Self {
        let size = image.size();
        let row_bytes = (4 * size.width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: u64::from(row_bytes) * u64::from(size.height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None };
        commands.copy_texture_to_buffer(
            image.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            size,
        );
        Self { buffer, row_bytes, size }
    }

    /// Writes red, green, blue, alpha, tightly packed.
    fn write(&self, gpu: &Gpu, path: &Path) -> anyhow::Result<()> {
        self.buffer.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        gpu.poll(wgpu::PollType::wait_indefinitely())?;
        let mapped = self.buffer.slice(..).get_mapped_range()?;
        let rows = mapped.chunks_exact(self.row_bytes as usize);
        let packed: Vec<u8> = rows.flat_map(|row| &row[..4 * self.size.width as usize]).copied().collect();
        std::fs::write(path, packed)?;
        Ok(())
    }
}
