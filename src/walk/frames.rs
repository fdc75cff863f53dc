//! Frames for one headset: what lives on its GPU, and what a frame does.

use super::action::Action;
use super::appearance::Appearance;
use super::governor::{Governor, Settings};
use super::locomotion::{Locomotion, head_of};
use super::masks::Masks;
use super::menu::{self, MenuOfWalk};
use super::mirror::Mirror;
use super::rows::pass_on;
use super::run::{Walk, WalkError};
use super::scenery::{SceneryOfWalk, SeenHands, Stand};
use super::views::Views;
use super::walker::Walker;
use base::space::Pose;
use render::gpu::Gpu;
use render::{EyeImage, Renderer, RendererError, Setup};
use std::sync::Arc;
use std::time::{Duration, Instant};
use timing::{CallTimes, FrameRow, Phase, STAGES, ms};
use xr::{End, FrameState, Headset, Panel, StageEye};

/// How long the end of a walk waits for the GPU.
const LAST_FRAMES_WAIT: Duration = Duration::from_secs(1);

/// What came of a step.
pub(super) enum Step {
    /// A frame, or none just now.
    Went,
    /// The headset's session is over.
    Ended(End),
}

/// What goes from one frame to the next, for one headset.
pub(super) struct Frames {
    gpu: Arc<Gpu>,
    renderer: Renderer,
    /// The mirror, if a window shows it.
    mirror: Option<Mirror>,
    views: Views,
    /// `None` until the headset tells that something is hidden.
    masks: Option<Masks>,
    governor: Governor,
    /// Width, height of each eye's image.
    sizes_px: [[u32; 2]; 2],
    /// Pixels of each eye's image that are drawn, from the top left corner.
    drawn_px: [[u32; 2]; 2],
    scenery: SceneryOfWalk,
    hands: SeenHands,
    menu: MenuOfWalk,
    /// The menu, if it is drawn into the eyes' images.
    drawn_panel: Option<Panel>,
    /// The labels of the controllers' buttons, while they are seen.
    button_labels: Option<wgpu::Texture>,
    /// State of the session, as the window was told.
    session: &'static str,
    /// True once the governor knows of all of the scan.
    has_begun: bool,
}

/// When a frame is shown, as the headset predicts it.
#[derive(Clone, Copy)]
struct DisplayTime {
    predicted_ns: i64,
    period_ns: i64,
}

impl DisplayTime {
    /// Time from one display to the next. Some runtimes tell no period; then the refresh rate has it.
    fn budget_ms(self, refresh_hz: f64) -> f32 {
        if self.period_ns > 0 { self.period_ns as f32 * 1e-6 } else { (1000.0 / refresh_hz) as f32 }
    }
}

impl Frames {
    /// Frames for `headset`, whose images live on `gpu`, of the scan as far as it has come there.
    pub fn new(
        walk: &Walk,
        walker: &mut Walker,
        gpu: &Arc<Gpu>,
        headset: &dyn Headset,
    ) -> Result<Self, WalkError> {
        let sizes_px = headset.eye_sizes();
        let setup = Setup {
            sizes_px: sizes_px.to_vec(),
            color_format: headset.image_format(),
            depth_format: headset.depth_format(),
            atomics: walk.draw.atomics(gpu)?,
        };
        let appearance = walker.state.appearance();
        let governor = Governor::new(appearance.governor, &appearance.draw);
        let technique = walk.draw.technique.open(gpu);
        let mut renderer = Renderer::with_technique(gpu, setup, appearance.draw, technique)?;
        renderer.show_scenery(appearance.shown_surround()).map_err(RendererError::from)?;
        if let Some(cloud) = &walker.cloud {
            renderer.set_cloud(cloud.clone())?;
        }
        let mirror =
            walk.mirrored.then(|| Mirror::new(&renderer)).transpose().map_err(RendererError::from)?;
        walker.rows.restart(gpu.queue.written_bytes());
        Ok(Self {
            gpu: Arc::clone(gpu),
            renderer,
            mirror,
            views: Views::default(),
            masks: None,
            governor,
            sizes_px,
            drawn_px: sizes_px,
            scenery: SceneryOfWalk::default(),
            hands: SeenHands::default(),
            menu: MenuOfWalk::default(),
            drawn_panel: None,
            button_labels: None,
            session: "",
            has_begun: false,
        })
    }

    /// Waits for the headset, and draws a frame if it wants one.
    pub fn step(
        &mut self,
        walk: &Walk,
        walker: &mut Walker,
        headset: &mut dyn Headset,
    ) -> Result<Step, WalkError> {
        self.take_loaded(walk, walker)?;
        if headset.session() != self.session {
            self.session = headset.session();
            walk.link.update_headset(|shown| shown.session = headset.session());
        }
        let waited = Instant::now();
        match headset.wait() {
            FrameState::Ended(end) => return Ok(Step::Ended(end)),
            FrameState::Idle => std::thread::sleep(headset.idle_pause()),
            FrameState::Frame { predicted_display_ns, period_ns, should_render } => {
                let display = DisplayTime { predicted_ns: predicted_display_ns, period_ns };
                let wait_ms = ms(waited.elapsed());
                if should_render {
                    self.draw(walk, walker, headset, display, wait_ms)?;
                } else {
                    self.leave_out(walker, headset, display, wait_ms);
                }
            }
        }
        self.collect(walk, walker);
        Ok(Step::Went)
    }

    /// Lets go of the scan, for another is wanted.
    pub fn leave_scan(&mut self) {
        self.renderer.take_cloud();
        self.has_begun = false;
    }

    /// Takes the scan if it has become ready.
    fn take_loaded(&mut self, walk: &Walk, walker: &mut Walker) -> Result<(), WalkError> {
        let began = Instant::now();
        if walker.take_loaded(walk)
            && let Some(cloud) = &walker.cloud
        {
            self.renderer.set_cloud(cloud.clone())?;
        }
        if !walker.is_arriving() && !self.has_begun {
            self.has_begun = true;
            self.governor.restart(self.renderer.has_detail());
        }
        walker.rows.add_load(began.elapsed());
        Ok(())
    }

    /// Draws one frame: input, images, commands, eyes as late as possible, submit.
    fn draw(
        &mut self,
        walk: &Walk,
        walker: &mut Walker,
        headset: &mut dyn Headset,
        display: DisplayTime,
        wait_ms: f32,
    ) -> Result<(), WalkError> {
        let record_began = Instant::now();
        let seconds = walker.rows.since_display_s(display.predicted_ns);
        let input = headset.input();
        self.hands = SeenHands { controllers: input, joints: headset.hands() };
        let head = &walker.stage_from_head;
        let free = self.menu.advance(walker.state.menu, &self.hands, head, &walk.link);
        let speed = walker.state.speed();
        let mut pressed = None;
        if let Some(locomotion) = &mut walker.state.locomotion {
            pressed = locomotion.advance(seconds, speed, &free.controllers, head);
            walker.state.buttons.advance(seconds, &self.hands);
            for (hand, event) in locomotion.guides().events.into_iter().enumerate() {
                if let Some(event) = event {
                    let (strength, seconds) = event.tick();
                    headset.vibrate(hand, strength, seconds);
                }
            }
        }
        if let Some(hand) = pressed {
            walker.state.apply(Action::ToggleMenu(hand));
        }
        self.follow_appearance(walk, walker);
        let settings = self.settle(walker.rows.frame, headset)?;
        let is_scaling = walker.state.locomotion.as_ref().is_some_and(|user| user.guides().scale.is_some());
        let label = is_scaling.then(|| menu::label(&self.hands, &walker.stage_from_head)).flatten();
        let panel = self.menu.panel(&walk.link, label);
        let is_labeled = panel.is_none() && walker.state.buttons.shown().is_some();
        self.button_labels = is_labeled.then(|| self.menu.button_labels(&walk.link)).flatten();
        // What the headset cannot show by itself is drawn into the eyes' images.
        self.drawn_panel = panel.filter(|panel| !headset.show_panel(Some(panel)));
        if self.drawn_panel.is_none() && !self.menu.is_open() && label.is_none() {
            headset.show_panel(None);
        }
        let Some(images) = headset.acquire() else {
            headset.submit(None);
            return Ok(());
        };
        let mut encoder =
            self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        let color = images.color.each_ref().map(|image| self.views.of(image));
        let depth = images.depth.as_ref().map(|images| images.each_ref().map(|image| self.views.of(image)));
        let eyes = [0, 1].map(|eye: usize| EyeImage {
            color: &color[eye],
            depth: depth.as_ref().map(|views| &views[eye]),
        });
        self.renderer.record(&mut encoder, walker.rows.frame, &eyes);
        self.record_copies(walk, walker, headset, &mut encoder, &images.color);
        let record_ms = ms(record_began.elapsed()) + walker.rows.take_load_ms();

        let submit_began = Instant::now();
        let eyes = headset.locate();
        walker.locate_head(head_of(&eyes));
        self.mask(headset, &eyes);
        let world_from_head = self.show(walk, walker, &eyes, headset.is_simulated());
        headset.submit(Some(encoder));
        self.renderer.submitted();
        walker.screenshots.submitted(&self.gpu, &walk.link);

        let row = FrameRow {
            wait_ms,
            record_ms,
            submit_ms: ms(submit_began.elapsed()),
            world_from_head,
            phase: walker.phase(),
            calls: headset.call_times(),
            ..self.row(walker, headset, display, &settings, record_began)
        };
        walker.rows.note(row, walker.cloud.is_some());
        Ok(())
    }

    /// Ends a frame that nobody would see.
    fn leave_out(
        &mut self,
        walker: &mut Walker,
        headset: &mut dyn Headset,
        display: DisplayTime,
        wait_ms: f32,
    ) {
        let began = Instant::now();
        headset.submit(None);
        let settings = self.governor.settings();
        let (submit_ms, phase) = (ms(began.elapsed()), Phase::Unseen);
        let row =
            FrameRow { wait_ms, submit_ms, phase, ..self.row(walker, headset, display, &settings, began) };
        walker.rows.note(row, false);
    }

    /// The row of a frame that began at `began`, without its times and without what the GPU tells later.
    fn row(
        &self,
        walker: &mut Walker,
        headset: &dyn Headset,
        display: DisplayTime,
        settings: &Settings,
        began: Instant,
    ) -> FrameRow {
        FrameRow {
            frame: walker.rows.frame,
            time_s: walker.rows.seconds(began),
            predicted_display_ns: display.predicted_ns,
            wait_ms: 0.0,
            record_ms: 0.0,
            submit_ms: 0.0,
            stage_ms: [f32::NAN; STAGES.len()],
            gpu_ms: f32::NAN,
            budget_ms: display.budget_ms(headset.refresh_hz()),
            missed_periods: walker.rows.missed_periods(display.predicted_ns, display.period_ns),
            visible_nodes: 0,
            points_read: 0,
            points_resident: self.renderer.resident().0,
            lod_scale: settings.lod_scale,
            resolution_scale: settings.resolution_scale,
            quality: settings.quality.name(),
            upload_bytes: walker.rows.uploaded(self.gpu.queue.written_bytes()),
            world_from_head: None,
            phase: walker.phase(),
            visible_batches: 0,
            calls: CallTimes::default(),
            session: headset.session(),
            place: walker.state.locomotion.as_ref().filter(|_| walker.cloud.is_some()).map(Locomotion::place),
        }
    }

    /// Tells the renderer what the eyes see: the scan, from where the user or the pose path has the head, or how far the
    /// scan has come. Returns the head in the world, if there is a scan.
    fn show(
        &mut self,
        walk: &Walk,
        walker: &mut Walker,
        eyes: &[StageEye; 2],
        may_pitch: bool,
    ) -> Option<Pose> {
        let queue = self.gpu.queue.lock();
        let Some(locomotion) = walker.state.locomotion.as_mut().filter(|_| walker.cloud.is_some()) else {
            let stand = Stand {
                eyes,
                drawn_px: self.drawn_px,
                near_m: walk.draw.near,
                locomotion: None,
                hands: &self.hands,
                menu: None,
                buttons: None,
                pointing: None,
            };
            self.scenery.show(&mut self.renderer, &queue, &walk.link, stand);
            return None;
        };
        locomotion.set_may_pitch(may_pitch);
        let world_from_head = match &walk.pose_path {
            None => locomotion.world_from_head(&head_of(eyes)),
            Some(path) => path.at(walker.rows.scan_shown.map_or(0.0, |since| since.elapsed().as_secs_f64())),
        };
        let view = locomotion.stage().view(&world_from_head, eyes, self.drawn_px, walk.draw.near);
        self.renderer.set_view(&queue, &view);
        let stand = Stand {
            eyes: &locomotion.pitched(eyes),
            drawn_px: self.drawn_px,
            near_m: walk.draw.near,
            locomotion: Some(locomotion),
            hands: &self.hands,
            menu: self.drawn_panel.as_ref(),
            buttons: self.button_labels.as_ref(),
            pointing: self.menu.pointing,
        };
        self.scenery.show(&mut self.renderer, &queue, &walk.link, stand);
        walker.last_view = Some(view);
        Some(world_from_head)
    }

    /// Has frames look as users want it. What the GPU has no room for is not shown, and the state stays as it was.
    fn follow_appearance(&mut self, walk: &Walk, walker: &mut Walker) {
        let Some(wanted) = walker.state.take_wanted_appearance() else { return };
        let wanted = Appearance { draw: walk.draw.technique.amended(wanted.draw), ..wanted };
        if let Err(error) = self.renderer.set_options(wanted.draw) {
            walk.link.set_notice(error.to_string());
            return;
        }
        walker.state.set_appearance(wanted);
        self.renderer.set_surround(wanted.shown_surround());
        let has_detail = !self.has_begun || self.renderer.has_detail();
        self.governor.aim_at(wanted.governor, wanted.draw.quality, has_detail);
    }

    /// Draws the frame with the governor's settings, which it returns.
    fn settle(&mut self, frame: u64, headset: &mut dyn Headset) -> Result<Settings, WalkError> {
        let settings = self.governor.begin(frame);
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

    /// Takes in that another overlay is drawn from now on.
    pub fn overlay_changed(&mut self) {
        if let Some(mirror) = &mut self.mirror {
            mirror.overlay_changed();
        }
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
        walker: &mut Walker,
        headset: &dyn Headset,
        encoder: &mut wgpu::CommandEncoder,
        images: &[wgpu::Texture; 2],
    ) {
        let overlay = walker.state.overlay;
        if let Some(mirror) = &mut self.mirror {
            // A real headset's images go back to the runtime at submit.
            let images_last = headset.is_simulated();
            mirror.record(&self.gpu, &walk.link, &self.renderer, encoder, images, images_last, overlay);
        }
        let mirror = self.mirror.as_ref();
        walker.screenshots.record(&self.gpu, encoder, images, self.drawn_px, mirror, overlay);
    }

    /// Joins GPU times that came back with their rows, and passes the rows on in order; the governor sees each.
    fn collect(&mut self, walk: &Walk, walker: &mut Walker) {
        let (rows, log) = (&mut walker.rows, walk.log.as_deref());
        let frame = rows.frame;
        while let Some(times) = self.renderer.collect_times() {
            rows.join(&times, &mut |row| {
                if let Some(step) = self.governor.observe(row.frame, row.phase, row.gpu_ms, row.budget_ms) {
                    tracing::info!("frame {frame}: {step}");
                }
                pass_on(log, &walk.link, row);
            });
        }
        rows.give_up(false, &mut |row| pass_on(log, &walk.link, row));
    }

    /// Waits for the last frames' times, so that the log has them, and lets go of all that lives on the GPU.
    pub fn close(mut self, walk: &Walk, walker: &mut Walker) {
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(LAST_FRAMES_WAIT) };
        // If waiting fails, the rows go without times.
        let _ = self.gpu.poll(wait);
        self.collect(walk, walker);
        walker.give_up_rows(walk);
    }
}
