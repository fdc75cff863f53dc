//! The frame thread's loop.

use super::governor::{Governor, GovernorOptions, Settings};
use super::link::WalkEnd;
use super::locomotion::{Locomotion, LocomotionOptions, Start, head_of};
use super::masks::Masks;
use super::mirror::Mirror;
use super::rows::{PendingRows, ms, pass_on};
use super::screenshot::Screenshots;
use super::state::{Action, AppState};
use super::views::Views;
use super::waiting::Waiting;
use crate::draw::{CannotDraw, DrawPlan};
use base::space::{Pose, View};
use base::task::CancelToken;
use render::gpu::Gpu;
use render::options::Overlay;
use render::{CloudBuffers, EyeImage, Renderer, Setup, TargetTooLarge};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::{Duration, Instant};
use timing::log::FrameLog;
use timing::pose_path::PosePath;
use timing::{FrameRow, Phase, STAGES};
use xr::{End, Fault, FrameState, Headset, StageEye};

/// How long the end of a walk waits for the GPU.
const LAST_FRAMES_WAIT: Duration = Duration::from_secs(2);

/// A scan, ready to be shown; sent by the loader's thread.
#[derive(Debug)]
pub struct Loaded {
    /// The scan on the GPU.
    pub cloud: CloudBuffers,
    /// Where to stand.
    pub start: Start,
}

/// What a walk goes by, besides what its frames are drawn with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkOptions {
    /// How the user moves.
    pub locomotion: LocomotionOptions,
    /// How frames are kept within their time.
    pub governor: GovernorOptions,
    /// What is drawn over the mirror at start.
    pub overlay: Overlay,
}

/// What the loop needs besides the headset.
#[derive(Debug)]
pub struct Walk<'a> {
    /// The device that the headset's images live on.
    pub gpu: Arc<Gpu>,
    /// What frames are drawn with.
    pub draw: DrawPlan,
    /// What the walk goes by.
    pub options: WalkOptions,
    /// The scan, as soon as something of it can be drawn; the loader lets go of the other end when all of it can.
    pub loaded: Receiver<Loaded>,
    /// Actions from those who show the walk.
    pub actions: Receiver<Action>,
    /// The link to the desktop.
    pub link: WalkEnd,
    /// True if a window shows the mirror.
    pub mirrored: bool,
    /// Log that rows are written to.
    pub log: Option<&'a FrameLog>,
    /// A head path to follow instead of the user.
    pub pose_path: Option<&'a PosePath>,
    /// Stop after this many frames that showed a scan.
    pub max_frames: Option<u64>,
    /// Stop this long after the first frame that showed a scan.
    pub max_time: Option<Duration>,
    /// Set from outside to end the walk.
    pub stop: CancelToken,
}

/// Why a walk cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum WalkError {
    /// The settings ask for what the GPU does not have.
    #[error(transparent)]
    Draw(#[from] CannotDraw),
    /// The headset's images are too large for the GPU.
    #[error(transparent)]
    Target(#[from] TargetTooLarge),
    /// The headset, its runtime or the GPU fails.
    #[error(transparent)]
    Headset(#[from] Fault),
}

/// What has come of a walk.
#[derive(Clone, Debug, PartialEq)]
pub struct WalkSummary {
    /// Frames drawn, with or without a scan.
    pub frames: u64,
    /// Frames that showed a scan.
    pub scan_frames: u64,
    /// Why the walk ended.
    pub ended: End,
    /// The last frame's eyes, if a scan was shown.
    pub last_view: Option<View>,
}

impl Walk<'_> {
    /// Draws frame after frame until the headset, the user or a limit ends it, or no scan is to come.
    ///
    /// # Errors
    /// See [`WalkError`].
    pub fn run(self, headset: &mut dyn Headset) -> Result<WalkSummary, WalkError> {
        let mut frames = Frames::new(&self, headset)?;
        let mut exit_requested = false;
        loop {
            if !exit_requested
                && (self.stop.is_cancelled() || self.limit_reached(&frames) || frames.are_in_vain())
            {
                headset.request_exit();
                exit_requested = true;
            }
            if let Some(reason) = self.gpu.lost() {
                return Err(Fault::DeviceLost(reason.into()).into());
            }
            frames.take_loaded(&self)?;
            if frames.take_actions(&self) {
                self.stop.cancel();
            }
            let waited = Instant::now();
            match headset.wait()? {
                FrameState::Ended(ended) => return Ok(frames.finish(&self, ended)),
                FrameState::Idle => std::thread::sleep(headset.idle_pause()),
                FrameState::Frame { should_render: false, .. } => headset.submit(None)?,
                FrameState::Frame { predicted_display_ns, period_ns, .. } => {
                    let wait_ms = ms(waited.elapsed());
                    frames.draw(&self, headset, predicted_display_ns, period_ns, wait_ms)?;
                }
            }
            frames.collect(&self);
        }
    }

    fn limit_reached(&self, frames: &Frames) -> bool {
        self.max_frames.is_some_and(|max| frames.rows.scan_frames >= max)
            || self.max_time.zip(frames.rows.scan_shown).is_some_and(|(max, since)| since.elapsed() >= max)
    }
}

/// State from one frame to the next.
struct Frames {
    renderer: Renderer,
    state: AppState,
    locomotion: Option<Locomotion>,
    /// The mirror, if a window shows it.
    mirror: Option<Mirror>,
    screenshots: Screenshots,
    views: Views,
    /// `None` until the headset tells that something is hidden.
    masks: Option<Masks>,
    governor: Governor,
    /// Width, height of each eye's image.
    sizes_px: [[u32; 2]; 2],
    /// Pixels of each eye's image that are drawn, from the top left corner.
    drawn_px: [[u32; 2]; 2],
    may_pitch: bool,
    rows: PendingRows,
    /// True until the loader is done.
    arriving: bool,
    waiting: Waiting,
    stage_from_head: Pose,
    last_view: Option<View>,
}

impl Frames {
    fn new(walk: &Walk, headset: &dyn Headset) -> Result<Self, WalkError> {
        let sizes_px = headset.eye_sizes();
        let setup = Setup {
            sizes_px: sizes_px.to_vec(),
            color_format: headset.image_format(),
            depth_format: headset.depth_format(),
            atomics: walk.draw.atomics(&walk.gpu)?,
        };
        let governor = Governor::new(walk.options.governor, &walk.draw.options);
        let technique = walk.draw.technique.open(&walk.gpu);
        let renderer = Renderer::with_technique(&walk.gpu, setup, walk.draw.options, technique)?;
        let mirror = walk.mirrored.then(|| Mirror::new(&renderer));
        let state = AppState::new(walk.options.overlay);
        walk.link.publish(state);
        Ok(Self {
            renderer,
            state,
            locomotion: None,
            mirror,
            screenshots: Screenshots::default(),
            views: Views::default(),
            masks: None,
            governor,
            sizes_px,
            drawn_px: sizes_px,
            may_pitch: headset.is_simulated(),
            rows: PendingRows::new(walk.gpu.queue.written_bytes()),
            arriving: true,
            waiting: Waiting::default(),
            stage_from_head: Pose::IDENTITY,
            last_view: None,
        })
    }

    /// Takes the newest scan that has become ready, if any.
    fn take_loaded(&mut self, walk: &Walk) -> Result<(), WalkError> {
        let began = Instant::now();
        while self.arriving {
            let Loaded { cloud, start } = match walk.loaded.try_recv() {
                Ok(loaded) => loaded,
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => {
                    self.arriving = false;
                    self.governor.restart(self.renderer.has_detail());
                    break;
                }
            };
            self.renderer.set_cloud(cloud)?;
            match &mut self.locomotion {
                Some(locomotion) => locomotion.restart(start),
                None => {
                    self.locomotion = Some(Locomotion::new(walk.options.locomotion, start, self.may_pitch));
                }
            }
        }
        self.rows.add_load(began.elapsed());
        Ok(())
    }

    /// True if the loader is done and has brought no scan.
    fn are_in_vain(&self) -> bool {
        !self.arriving && self.locomotion.is_none()
    }

    /// Applies the actions that were asked for; returns true if one of them ends the walk.
    fn take_actions(&mut self, walk: &Walk) -> bool {
        let before = self.state;
        while let Ok(action) = walk.actions.try_recv() {
            match action {
                Action::Quit => return true,
                Action::Screenshot => self.screenshots.ask(),
                action => {
                    self.state.apply(action);
                    if let Some(locomotion) = &mut self.locomotion {
                        locomotion.apply(action);
                    }
                }
            }
        }
        if self.state != before {
            walk.link.publish(self.state);
        }
        if let Some(mirror) = &mut self.mirror
            && self.state.overlay != before.overlay
        {
            mirror.overlay_changed();
        }
        false
    }

    /// Draws one frame: input, images, commands, eyes as late as possible, submit.
    fn draw(
        &mut self,
        walk: &Walk,
        headset: &mut dyn Headset,
        predicted_display_ns: i64,
        period_ns: i64,
        wait_ms: f32,
    ) -> Result<(), WalkError> {
        let record_began = Instant::now();
        let seconds = self.rows.since_display_s(predicted_display_ns);
        let input = headset.input()?;
        if let Some(locomotion) = &mut self.locomotion {
            locomotion.advance(seconds, self.state.speed(), &input, &self.stage_from_head);
        }
        let settings = self.settle(headset)?;
        let images = headset.acquire()?;
        let mut encoder =
            walk.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        let color = images.color.each_ref().map(|image| self.views.of(image));
        let depth = images.depth.as_ref().map(|images| images.each_ref().map(|image| self.views.of(image)));
        let eyes = [0, 1].map(|eye: usize| EyeImage {
            color: &color[eye],
            depth: depth.as_ref().map(|views| &views[eye]),
        });
        self.renderer.record(&mut encoder, self.rows.frame, &eyes);
        self.record_copies(walk, headset, &mut encoder, &images.color);
        let record_ms = ms(record_began.elapsed()) + self.rows.take_load_ms();

        let submit_began = Instant::now();
        let eyes = headset.locate()?;
        self.stage_from_head = head_of(&eyes);
        self.mask(headset, &eyes);
        let world_from_head = self.world_from_head(walk, &eyes);
        if let Some((locomotion, pose)) = self.locomotion.as_ref().zip(world_from_head.as_ref()) {
            let view = locomotion.view(pose, &eyes, self.drawn_px, walk.draw.near);
            self.renderer.set_view(&walk.gpu.queue.lock(), &view);
            self.last_view = Some(view);
        } else {
            let (queue, near) = (walk.gpu.queue.lock(), walk.draw.near);
            self.waiting.show(&mut self.renderer, &queue, &walk.link, (&eyes, self.drawn_px, near));
        }
        headset.submit(Some(encoder))?;
        self.renderer.submitted();
        self.screenshots.submitted(&walk.gpu, &walk.link);

        let row = FrameRow {
            frame: self.rows.frame,
            time_s: self.rows.seconds(record_began),
            predicted_display_ns,
            wait_ms,
            record_ms,
            submit_ms: ms(submit_began.elapsed()),
            stage_ms: [f32::NAN; STAGES.len()],
            gpu_ms: f32::NAN,
            budget_ms: (1000.0 / headset.refresh_hz()) as f32,
            missed_periods: self.rows.missed_periods(predicted_display_ns, period_ns),
            visible_nodes: 0,
            points_read: 0,
            points_resident: self.renderer.resident().0,
            lod_scale: settings.lod_scale,
            resolution_scale: settings.resolution_scale,
            quality: settings.quality.name(),
            upload_bytes: self.rows.uploaded(walk.gpu.queue.written_bytes()),
            world_from_head,
            phase: self.phase(),
            visible_batches: 0,
        };
        self.rows.note(row, self.renderer.split().is_some());
        Ok(())
    }

    /// What the frame shows.
    fn phase(&self) -> Phase {
        match self.renderer.split() {
            None => Phase::Waiting,
            Some(_) if self.arriving => Phase::Arriving,
            Some(_) => Phase::Walking,
        }
    }

    /// Draws the frame with the governor's settings, which it returns.
    fn settle(&mut self, headset: &mut dyn Headset) -> Result<Settings, WalkError> {
        let settings = self.governor.begin(self.rows.frame);
        self.renderer.set_lod_scale(settings.lod_scale);
        self.renderer.set_quality(settings.quality)?;
        let drawn_px = self.sizes_px.map(|full_px| settings.drawn_px(full_px));
        if drawn_px != self.drawn_px {
            self.drawn_px = drawn_px;
            self.renderer.set_drawn(&drawn_px);
            headset.set_drawn_px(drawn_px);
        }
        Ok(settings)
    }

    /// The head, where the user or the pose path has it; `None` before a scan is shown.
    fn world_from_head(&self, walk: &Walk, eyes: &[StageEye; 2]) -> Option<Pose> {
        let locomotion = self.locomotion.as_ref()?;
        Some(match walk.pose_path {
            None => locomotion.world_from_head(&head_of(eyes)),
            Some(path) => path.at(self.rows.scan_shown.map_or(0.0, |since| since.elapsed().as_secs_f64())),
        })
    }

    /// Skips the pixels that the lenses hide, as soon as these are known.
    fn mask(&mut self, headset: &mut dyn Headset, eyes: &[StageEye; 2]) {
        if let Some(areas) = headset.hidden_area() {
            self.masks.get_or_insert_default().set_areas(areas);
        }
        if let Some(masks) = &mut self.masks {
            masks.ask([eyes[0].fov, eyes[1].fov], self.drawn_px);
            if let Some(hidden) = masks.take(self.drawn_px) {
                self.renderer.set_hidden(hidden.to_vec());
            }
        }
    }

    /// Records what the window and screenshots get of the frame.
    fn record_copies(
        &mut self,
        walk: &Walk,
        headset: &dyn Headset,
        encoder: &mut wgpu::CommandEncoder,
        images: &[wgpu::Texture; 2],
    ) {
        if let Some(mirror) = &mut self.mirror {
            // A real headset's images go back to the runtime at submit.
            let images_last = headset.is_simulated();
            mirror.record(
                &walk.gpu,
                &walk.link,
                &self.renderer,
                encoder,
                images,
                images_last,
                self.state.overlay,
            );
        }
        self.screenshots.record(
            &walk.gpu,
            encoder,
            images,
            self.drawn_px,
            self.mirror.as_ref(),
            self.state.overlay,
        );
    }

    /// Joins GPU times that came back with their rows, and passes the rows on in order; the governor sees each.
    fn collect(&mut self, walk: &Walk) {
        let Self { rows, governor, renderer, .. } = self;
        let frame = rows.frame;
        while let Some(times) = renderer.collect_times() {
            rows.join(&times, &mut |row| {
                if let Some(step) = governor.observe(row.frame, row.phase, row.gpu_ms, row.budget_ms) {
                    tracing::info!("frame {frame}: {step}");
                }
                pass_on(walk.log, &walk.link, row);
            });
        }
        rows.give_up(false, &mut |row| pass_on(walk.log, &walk.link, row));
    }

    /// Waits for the last frames' times, so that the log ends with the last frame.
    fn finish(mut self, walk: &Walk, ended: End) -> WalkSummary {
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(LAST_FRAMES_WAIT) };
        // If waiting fails, the rows go without times.
        let _ = walk.gpu.device.poll(wait);
        self.collect(walk);
        self.rows.give_up(true, &mut |row| pass_on(walk.log, &walk.link, row));
        self.screenshots.finish();
        let PendingRows { frame, scan_frames, .. } = self.rows;
        WalkSummary { frames: frame, scan_frames, ended, last_view: self.last_view }
    }
}
