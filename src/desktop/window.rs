//! winit's side of the window: passes events to [`Controls`], looks for news sixty times a second, and draws a
//! picture if there is any.

use super::controls::{Controls, WindowState};
use super::history::History;
use super::keys::WindowInput;
use super::open::{self, DialogOutcome, OpenDialog};
use super::painter::{EguiPicture, Painter};
use super::placement::{panes, seen_at};
use super::recent::{self, Recent};
use super::screen::WindowSurface;
use super::{DesktopError, QUEUE_PATIENCE, WindowOptions, help, notice, panel, server, style, title};
use crate::walk::action::Action;
use crate::walk::link::{HeadsetState, LoadState, ViewerEnd};
use crate::walk::state::Snapshot;
use base::task::CancelToken;
use render::gpu::Gpu;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::TryRecvError;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::error::OsError;
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::keyboard::PhysicalKey;
use winit::window::{Fullscreen, Window, WindowId};

/// Time between two looks at rows and `stop`, and so between two pictures.
const TICK: Duration = Duration::from_micros(16_667);
/// Longest time between two pictures without anything new: the last mirror image may be newer than its row.
const IDLE_REDRAW: Duration = Duration::from_millis(200);
/// Pixels of a touchpad's scrolling that count as a line of the wheel.
const PX_PER_LINE: f32 = 40.0;

/// The window's program.
pub(super) struct App {
    viewer: ViewerEnd,
    options: WindowOptions,
    stop: CancelToken,
    controls: Controls,
    history: History,
    load: LoadState,
    headset: HeadsetState,
    /// The state when it was last looked at.
    state: Snapshot,
    shown: Option<OpenWindow>,
    failure: Option<DesktopError>,
    /// Files that were dropped on the window since the last look at it.
    dropped: Vec<PathBuf>,
    recent: Recent,
    /// The files that were last added to it.
    remembered: Vec<PathBuf>,
    /// The dialog in which another scan is chosen, while it is open.
    dialog: Option<OpenDialog>,
    next_tick: Instant,
}

/// What exists while the window does.
struct OpenWindow {
    /// What draws, which is dropped before the window.
    canvas: WindowGpu,
    window: Arc<Window>,
    occluded: bool,
    full_screen: bool,
    /// True if something has changed since the last picture.
    stale: bool,
    /// True while nothing can be drawn, because somebody keeps the GPU's queue.
    is_starved: bool,
    drawn_at: Option<Instant>,
}

/// What draws into the window, on one GPU.
struct WindowGpu {
    gpu: Arc<Gpu>,
    screen: WindowSurface,
    painter: Painter,
    egui: egui_winit::State,
}

impl WindowGpu {
    /// A canvas whose panels are as `memory` has them.
    fn new(gpu: &Arc<Gpu>, window: &Arc<Window>, memory: egui::Memory) -> Result<Self, DesktopError> {
        let screen = WindowSurface::new(Arc::clone(gpu), Arc::clone(window))?;
        let painter = Painter::with_mirror(&gpu.device, screen.format())?;
        // The context of another GPU has uploaded its textures there.
        let context = egui::Context::default();
        context.memory_mut(|own| *own = memory);
        style::apply(&context);
        let egui = egui_winit::State::new(
            context,
            egui::ViewportId::ROOT,
            window,
            Some(window.scale_factor() as f32),
            Some(winit::window::Theme::Dark),
            Some(gpu.device.limits().max_texture_dimension_2d as usize),
        );
        Ok(Self { gpu: Arc::clone(gpu), screen, painter, egui })
    }
}

impl OpenWindow {
    /// Draws on this GPU from now on.
    fn move_to(&mut self, gpu: &Arc<Gpu>) -> Result<(), DesktopError> {
        let memory = self.canvas.egui.egui_ctx().memory(Clone::clone);
        // A window has one surface at a time.
        self.canvas.screen.release();
        self.canvas = WindowGpu::new(gpu, &self.window, memory)?;
        self.stale = true;
        Ok(())
    }

    /// True if egui has a widget's drag under way or something of its own at `at_px`. egui's answer to the event
    /// tells where the pointer was in the last pass; it may have moved since.
    fn on_panel(&self, at_px: [f64; 2]) -> bool {
        let context = self.canvas.egui.egui_ctx();
        let at = egui::Pos2::from(at_px.map(|px| px as f32)) / context.pixels_per_point();
        context.egui_is_using_pointer()
            || context.layer_id_at(at).is_some_and(|layer| layer.order != egui::Order::Background)
    }
}

impl App {
    /// A window that is not open yet: winit says when to open it.
    pub(super) fn new(viewer: ViewerEnd, options: WindowOptions, stop: CancelToken) -> Self {
        let controls = Controls::new(WindowState::new(&options));
        let (load, headset, state) = (viewer.load(), viewer.headset(), viewer.snapshot());
        let recent = Recent::new(if options.recent { recent::file_of_user() } else { None });
        Self {
            viewer,
            options,
            stop,
            controls,
            history: History::default(),
            load,
            headset,
            state,
            shown: None,
            failure: None,
            dropped: Vec::new(),
            recent,
            remembered: Vec::new(),
            dialog: None,
            next_tick: Instant::now(),
        }
    }

    /// Returns the outcome once the event loop has ended.
    pub(super) fn outcome(self) -> Result<(), DesktopError> {
        self.failure.map_or(Ok(()), Err)
    }

    fn open(&self, events: &ActiveEventLoop) -> Result<OpenWindow, DesktopError> {
        let [width, height] = self.options.size.map(|edge| edge.max(1));
        let attributes = Window::default_attributes()
            .with_title(title::of(&self.load, false))
            .with_inner_size(LogicalSize::new(width, height))
            .with_min_inner_size(LogicalSize::new(160, 120));
        let window = Arc::new(events.create_window(attributes).map_err(refused)?);
        let gpu = self.viewer.gpu().ok_or(DesktopError::NoGpu)?;
        Ok(OpenWindow {
            canvas: WindowGpu::new(&gpu, &window, egui::Memory::default())?,
            window,
            occluded: false,
            full_screen: false,
            stale: true,
            is_starved: false,
            drawn_at: None,
        })
    }

    /// Ends the window. The caller decides what becomes of the walk.
    fn fail(&mut self, events: &ActiveEventLoop, error: DesktopError) {
        self.failure = Some(error);
        events.exit();
    }

    /// Ends window and walk, because the user or the walk's end asks for it.
    fn leave(&mut self, events: &ActiveEventLoop) {
        self.send(Some(Action::Quit));
        self.stop.cancel();
        events.exit();
    }

    fn send(&self, action: Option<Action>) {
        // Sending fails if nobody listens: the walk has ended, and the window ends with the next look at the rows.
        let _ = action.map(|action| self.viewer.actions.send(action));
    }

    /// Takes in what the frame thread offered. Returns false once the walk is over and nothing is left to read.
    fn take_in(&mut self, now: Instant) -> bool {
        let mut news = false;
        let ended = loop {
            match self.viewer.rows.try_recv() {
                Ok(row) => self.history.push(row, now),
                Err(TryRecvError::Empty) => break false,
                Err(TryRecvError::Disconnected) => break true,
            }
            news = true;
        };
        let (load, headset, state) = (self.viewer.load(), self.viewer.headset(), self.viewer.snapshot());
        if load != self.load || headset != self.headset || state != self.state {
            let is_another = load.scan != self.load.scan;
            (self.load, self.headset, self.state) = (load, headset, state);
            news = true;
            if let Some(shown) = self.shown.as_ref().filter(|_| is_another) {
                shown.window.set_title(&title::of(&self.load, false));
            }
        }
        self.remember();
        news |= self.recent.take_in();
        if let Some(shown) = &mut self.shown {
            shown.stale |= news;
        }
        // A failure to load ends the walk, yet the user is to read why.
        !ended || self.load.error.is_some()
    }

    /// Adds a scan that could be read to those that were opened last.
    fn remember(&mut self) {
        let LoadState { scan: Some(scan), facts, .. } = &self.load else { return };
        if !facts.is_empty() && scan.files != self.remembered {
            self.remembered.clone_from(&scan.files);
            self.recent.add(&scan.files);
        }
    }

    /// Opens these files as one scan, if there are any.
    fn open_scan(&self, files: Vec<PathBuf>) {
        if let Some(before) = self.load.scan.as_ref().filter(|_| !files.is_empty()) {
            self.send(Some(open::open(files, before)));
        }
    }

    /// Opens the files that were dropped together.
    fn open_dropped(&mut self) {
        let files = std::mem::take(&mut self.dropped);
        self.open_scan(files);
    }

    fn keyboard(&mut self, event: &KeyEvent, synthetic: bool) {
        let PhysicalKey::Code(key) = event.physical_key else { return };
        let pressed = event.state == ElementState::Pressed;
        // winit makes up presses of keys that were held as the window got the keyboard.
        if pressed && (event.repeat || synthetic) {
            return;
        }
        let action = self.controls.key(key, pressed, Instant::now());
        self.send(action);
    }

    /// The action that goes to what is seen where the pointer is.
    fn go_to_clicked(&self) -> Option<Action> {
        let gpu = &self.shown.as_ref()?.canvas.gpu;
        let size = self.shown.as_ref()?.window.inner_size();
        let images_px = self.viewer.mirror(gpu)?.drawn_px;
        let longest_px = gpu.device.limits().max_texture_dimension_2d;
        let panes = panes(self.controls.view.mirror, images_px, [size.width, size.height], longest_px);
        let (eye, at) = seen_at(&panes, self.controls.pointer_px())?;
        Some(Action::GoToSeen { eye, at })
    }

    /// Handles mouse events and the rest; `ours` is true if the pointer is on the picture, not on the panel.
    fn other(&mut self, event: &WindowEvent, ours: bool) {
        if let WindowEvent::DroppedFile(path) = event {
            self.dropped.push(path.clone());
        }
        let action = match *event {
            WindowEvent::Focused(false) => self.controls.release_all(),
            WindowEvent::MouseInput {
                state,
                button: button @ (MouseButton::Left | MouseButton::Right),
                ..
            } => {
                let pressed = state == ElementState::Pressed;
                let drag =
                    if button == MouseButton::Left { WindowInput::Drag } else { WindowInput::RightDrag };
                let clicked = (ours || !pressed) && self.controls.button(pressed, drag);
                // The other button looks around only.
                (clicked && button == MouseButton::Left).then(|| self.go_to_clicked()).flatten()
            }
            WindowEvent::CursorMoved { position, .. } => self.controls.pointer([position.x, position.y]),
            WindowEvent::MouseWheel { delta, .. } if ours => self.controls.wheel(match delta {
                MouseScrollDelta::LineDelta(_, lines) => lines,
                MouseScrollDelta::PixelDelta(px) => px.y as f32 / PX_PER_LINE,
            }),
            _ => None,
        };
        self.send(action);
    }

    /// Brings the window to what the view wishes for.
    fn follow_view(&mut self, events: &ActiveEventLoop) {
        if self.controls.view.leave {
            return self.leave(events);
        }
        let Some(shown) = &mut self.shown else { return };
        let wished = self.controls.view.full_screen;
        if wished != shown.full_screen {
            shown.full_screen = wished;
            shown.window.set_fullscreen(wished.then_some(Fullscreen::Borderless(None)));
        }
    }

    /// Draws on the walk's GPU, unless that is lost: then the walk looks for another.
    fn draw(&mut self) -> Result<(), DesktopError> {
        let gpu = self.viewer.gpu();
        let Some(gpu) = gpu.or_else(|| self.shown.as_ref().map(|shown| Arc::clone(&shown.canvas.gpu))) else {
            return Ok(());
        };
        gpu.unless_lost(|| self.draw_on(&gpu)).unwrap_or(Ok(()))
    }

    fn draw_on(&mut self, gpu: &Arc<Gpu>) -> Result<(), DesktopError> {
        let Some(shown) = &mut self.shown else { return Ok(()) };
        if !Arc::ptr_eq(gpu, &shown.canvas.gpu) {
            shown.move_to(gpu)?;
        }
        let canvas = &mut shown.canvas;
        // While a runtime is stuck with the queue, the window takes keys and shows its last picture; its title tells.
        let now = Instant::now();
        let patience = if shown.is_starved { TICK } else { QUEUE_PATIENCE };
        let is_starved = canvas.gpu.queue.lock_within(patience).is_none();
        if is_starved != shown.is_starved && (!is_starved || self.history.is_stalled(now)) {
            shown.is_starved = is_starved;
            shown.window.set_title(&title::of(&self.load, is_starved));
        }
        if is_starved {
            return Ok(());
        }
        let Some(picture) = canvas.screen.begin()? else { return Ok(()) };
        let input = canvas.egui.take_egui_input(&shown.window);
        let context = canvas.egui.egui_ctx().clone();
        let images = self.viewer.mirror(&canvas.gpu);
        let contents = panel::Contents {
            history: &self.history,
            load: &self.load,
            recent: self.recent.scans(),
            headset: &self.headset,
            widgets: &self.options.widgets,
            state: self.state,
            eye_px: images.as_ref().map(|images| images.drawn_px[0]),
            now,
        };
        let dragging = self.controls.dragging();
        let view = &mut self.controls.view;
        let mut asked = Vec::new();
        let mut choice = None;
        let shown_files = self.load.scan.as_ref().map_or(&[][..], |scan| &scan.files);
        let is_empty = self.load.scan.is_some() && shown_files.is_empty();
        let mut output = context.run_ui(input, |ui| {
            asked.extend(panel::show(ui, &contents, view));
            let within = panel::beside(ui, view);
            notice::show(ui, within, &self.load, images.is_some(), view.leave_pending(now));
            asked.extend(notice::waiting(ui, &self.headset, self.history.is_stalled(now)));
            let told = self.viewer.notice().filter(|(_, text)| !notice::is_said(&self.headset, text));
            notice::told(ui, within, told.as_ref(), now);
            if is_empty && !view.opening {
                view.opening = open::welcome(ui, within);
            }
            if view.opening {
                let dialog = self.dialog.get_or_insert_with(|| OpenDialog::new(shown_files));
                choice = dialog.show(ui);
            }
            help::show(ui, view);
        });
        view.opening &= choice.is_none();
        self.dialog.take_if(|_| !view.opening);
        if dragging {
            output.platform_output.cursor_icon = egui::CursorIcon::Grabbing;
        }
        canvas.egui.handle_platform_output(&shown.window, std::mem::take(&mut output.platform_output));
        let repaint = output.viewport_output.get(&egui::ViewportId::ROOT).map(|v| v.repaint_delay);
        shown.stale = repaint.is_some_and(|delay| delay <= TICK);
        shown.drawn_at = Some(now);
        let ui = EguiPicture::new(&context, output);
        let mirror = images.as_ref().map(|images| (images, self.controls.view.mirror));
        let target = picture.texture.create_view(&Default::default());
        let size_px = [picture.texture.width(), picture.texture.height()];
        if let Some(commands) = canvas.painter.record(&canvas.gpu, &target, size_px, mirror, ui) {
            canvas.screen.present(commands, picture);
        }
        asked.into_iter().for_each(|action| self.send(Some(action)));
        if let Some(DialogOutcome::Open(files)) = choice {
            self.open_scan(files);
        }
        Ok(())
    }
}

fn refused(error: OsError) -> DesktopError {
    DesktopError::Window { reason: server::words(&error) }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.shown.is_some() {
            return;
        }
        match self.open(events) {
            Ok(shown) => self.shown = Some(shown),
            Err(error) => self.fail(events, error),
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(shown) = &mut self.shown else { return };
        match &event {
            WindowEvent::CloseRequested => return self.leave(events),
            WindowEvent::RedrawRequested => {
                if let Err(error) = self.draw() {
                    self.fail(events, error);
                }
            }
            WindowEvent::KeyboardInput { event: key, is_synthetic, .. } => {
                shown.stale = true;
                // egui gets keys only while one of its widgets has asked for them (a number being typed), a list is unfolded, or a scan is
                // chosen;
                // releases always reach the controls, which may have seen the key go down.
                let context = shown.canvas.egui.egui_ctx();
                let typing = context.egui_wants_keyboard_input()
                    || egui::Popup::is_any_open(context)
                    || self.controls.view.opening;
                if typing {
                    let _ = shown.canvas.egui.on_window_event(&shown.window, &event);
                }
                if !typing || key.state == ElementState::Released {
                    self.keyboard(key, *is_synthetic);
                }
            }
            other => {
                if let WindowEvent::Occluded(occluded) = other {
                    shown.occluded = *occluded;
                }
                let response = shown.canvas.egui.on_window_event(&shown.window, other);
                let resized =
                    matches!(other, WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. });
                shown.stale |= response.repaint || resized;
                let ours = !shown.on_panel(self.controls.pointer_px());
                self.other(other, ours);
            }
        }
        self.follow_view(events);
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let now = Instant::now();
        if now >= self.next_tick {
            self.next_tick = now + TICK;
            if !self.take_in(now) {
                return self.leave(events);
            }
            if self.stop.is_cancelled() {
                return events.exit();
            }
            self.open_dropped();
            if let Some(shown) = &self.shown {
                let due = shown.drawn_at.is_none_or(|at| now.saturating_duration_since(at) > IDLE_REDRAW);
                if (shown.stale || due) && !shown.occluded {
                    shown.window.request_redraw();
                }
            }
        }
        events.set_control_flow(ControlFlow::WaitUntil(self.next_tick));
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        // The surface must go while the event loop's connection to the display still stands.
        self.shown = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::filling::ScanRequest;
    use crate::walk::link;
    use points::ReadOptions;

    /// Files that are dropped together come one by one, and are one scan.
    #[test]
    fn dropped_files_are_opened_as_the_scan_before_was_read() {
        let (walk, actions, viewer) = link::link(Snapshot::sample());
        let read = ReadOptions { strict: true, ..ReadOptions::AS_FILES_SAY };
        let before = ScanRequest { files: vec!["hall.laz".into()], read, kind: None };
        walk.update_load(|load| load.scan = Some(Arc::new(before.clone())));
        let mut app = App::new(viewer, WindowOptions::sample(), CancelToken::default());
        app.open_dropped();
        for name in ["a.las", "b.las"] {
            app.other(&WindowEvent::DroppedFile(name.into()), true);
        }
        app.open_dropped();
        app.open_dropped();
        let files = vec!["a.las".into(), "b.las".into()];
        let wanted = Action::Open(Arc::new(ScanRequest { files, ..before }));
        assert_eq!(actions.try_iter().collect::<Vec<_>>(), [wanted], "once, and nothing without files");
    }
}
