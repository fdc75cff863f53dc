//! The desktop window: shows what the headset shows, says how the frames go, takes keys and mouse.
//!
//! The window and the frame thread share the GPU and a [`link`](crate::walk::link), nothing else, and the frame
//! thread never waits for the window: commands are recorded outside the queue lock, rows that come too fast are
//! dropped by the link, and the window begins a picture only when the GPU has finished its last one (`screen`).
//!
//! ```text
//! main thread                                        frame thread
//!   Display::run ── winit events ─▶ controls ──Action──▶ walk
//!        │                            │ WindowState         │
//!        ▼                            ▼                     │
//!     painter ◀── panel, help (egui) ◀── history ◀──rows────┤
//!        └── mirror ◀───────────────────────────mirror images┘
//! ```
//!
//! A program uses it on its main thread and once a process, both of which winit demands:
//!
//! ```no_run
//! # fn walk(_: scanwalk::walk::link::WalkEnd, _: std::sync::mpsc::Receiver<scanwalk::walk::action::Action>) {}
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use base::task::CancelToken;
//! use render::gpu::Gpu;
//! use scanwalk::{desktop, resolve::Plan, walk::link};
//! let (stop, plan) = (CancelToken::default(), Plan::default());
//! let (walk_end, actions, viewer) = link::link(plan.state_at_start().snapshot());
//! walk_end.set_gpu(&std::sync::Arc::new(Gpu::open(None)?));
//! let frames = std::thread::spawn(move || walk(walk_end, actions)); // its end cancels `stop`
//! match desktop::Display::open(&stop) {
//!     Ok(display) => display.run(viewer, plan.window, stop.clone())?,
//!     Err(_) => {} // `--window auto`: the walk goes on without
//! }
//! frames.join().ok();
//! # Ok(())
//! # }
//! ```
//!
//! The mirror images need `TEXTURE_BINDING`, an sRGB format, and the device of the link's GPU.

mod appearance;
mod buttons;
pub mod card;
mod controls;
mod easel;
mod help;
mod history;
mod keys;
pub mod menu;
mod mirror;
mod notice;
mod numbers;
mod open;
mod options;
mod painter;
#[cfg(test)]
mod painter_tests;
mod panel;
#[cfg(test)]
mod panel_tests;
mod parts;
mod placement;
mod plot;
mod reading;
mod recent;
mod screen;
mod server;
mod stance;
mod style;
mod title;
mod widget;
mod window;

pub use mirror::{DrawnUniform, MIRROR, Mirrored, OfMirrored};
pub use options::{MirroredEyes, Widget, Widgets, WindowOptions};
pub use server::{Server, is_named, server};

use crate::walk::link::ViewerEnd;
use base::task::CancelToken;
use std::time::Duration;
use winit::event_loop::EventLoop;

/// How long the window waits for the queue, which a runtime that is stuck may hold.
const QUEUE_PATIENCE: Duration = Duration::from_millis(500);

/// Why there is no window; each sentence says what to do.
#[derive(Debug, thiserror::Error)]
pub enum DesktopError {
    /// There is no display server, or it does not answer.
    #[error("no window can be opened: {reason}; run scanwalk on a desktop, or use --window off")]
    NoDisplay {
        /// Reason in words.
        reason: String,
    },
    /// winit's event loop failed.
    #[error("the window's event loop failed: {reason}")]
    EventLoop {
        /// Reason in words.
        reason: String,
    },
    /// The display server refused the window.
    #[error("the display server refused to open a window: {reason}")]
    Window {
        /// Reason in words.
        reason: String,
    },
    /// Vulkan refused the surface.
    #[error("the GPU's driver cannot draw into a window of this desktop: {0}; use --window off")]
    Surface(#[from] wgpu::CreateSurfaceError),
    /// A shader of the window's cannot be used.
    #[error(transparent)]
    Shader(#[from] render::gpu::stage::ShaderError),
    /// The walk has no GPU yet.
    #[error("the window has no GPU to draw on")]
    NoGpu,
    /// The GPU has no way to this display.
    #[error(
        "the GPU '{gpu}' cannot show pictures on this display; choose another with --adapter, or use --window off"
    )]
    CannotPresent {
        /// The GPU.
        gpu: String,
    },
}

/// A display that answered: windows can be opened on it.
#[derive(Debug)]
pub struct Display(EventLoop<()>);

impl Display {
    /// Connects to the display that the environment names: Wayland if a compositor answers there, else X11. A server
    /// that does not answer is given up after some seconds, or when `stop` is requested.
    ///
    /// # Errors
    /// [`DesktopError::NoDisplay`].
    ///
    /// # Panics
    /// On another thread than the main one, and when called again in a process after a success: winit's rules.
    pub fn open(stop: &CancelToken) -> Result<Self, DesktopError> {
        server::event_loop(stop).map(Self)
    }

    /// Shows the window until it is closed or `stop` is requested, on the main thread. Closing it sends
    /// [`Action::Quit`](crate::walk::action::Action::Quit) and requests `stop`; a failure does not, for a walk may go
    /// on without a window.
    ///
    /// # Errors
    /// A display that takes no window, or a GPU that cannot draw into it.
    pub fn run(
        self,
        viewer: ViewerEnd,
        options: WindowOptions,
        stop: CancelToken,
    ) -> Result<(), DesktopError> {
        let mut app = window::App::new(viewer, options, stop);
        self.0
            .run_app(&mut app)
            .map_err(|error| DesktopError::EventLoop { reason: server::event_loop_words(&error) })?;
        app.outcome()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_no_display_says_what_to_do() {
        let error = DesktopError::NoDisplay { reason: "there is no display".into() };
        assert_eq!(
            error.to_string(),
            "no window can be opened: there is no display; run scanwalk on a desktop, or use --window off"
        );
    }
}
