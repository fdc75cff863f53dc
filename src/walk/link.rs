//! The link between the frame thread and the desktop window. Neither end ever makes the frame thread wait:
//! rows that nobody takes are dropped, commands queue up, the mirror's textures change hands only at start
//! and when their size changes.

use base::task::{Count, Done};
use render::options::Overlay;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use timing::FrameRow;

/// What the user asks of the walk from the desktop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// Keys now held: right, up, forward, each −1 to 1, in the viewer's own directions; and the fast key.
    Move {
        /// Right, up, forward.
        direction: [f32; 3],
        /// Fast key held.
        fast: bool,
    },
    /// Mouse moved while looking: pixels right, pixels down.
    Look {
        /// Pixels right, pixels down.
        delta_px: [f32; 2],
    },
    /// Faster (> 1) or slower (< 1) from now on: the mouse wheel.
    ScaleSpeed(f32),
    /// Turn by this many snap steps; right is positive.
    Snap(i32),
    /// Back to the starting place.
    Reset,
    /// Move back until the whole scan is in view.
    WholeView,
    /// Draw this over the mirror from now on.
    Overlay(Overlay),
    /// Save both eyes' images.
    Screenshot,
    /// End the walk.
    Quit,
}

/// What loading has come to, for the window's panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadState {
    /// The work that goes on, and how far it is; `None` before it begins and once all of it has ended.
    pub doing: Option<Done>,
    /// Set if loading failed: the sentence for people.
    pub error: Option<String>,
    /// Facts of the scan, name and value, once known.
    pub facts: Vec<(String, String)>,
    /// Warnings of the readers.
    pub warnings: Vec<String>,
}

/// What the headset shows, for the window. (Textures are reference-counted: a clone is cheap.)
#[derive(Clone, Debug, PartialEq)]
pub struct MirrorImages {
    /// Left and right; same format and size as the eyes' images.
    pub textures: [wgpu::Texture; 2],
    /// Pixels of each that are drawn, from the top left corner: width, height. The rest is stale.
    pub drawn_px: [[u32; 2]; 2],
}

impl MirrorImages {
    /// Textures that are drawn from edge to edge.
    #[must_use]
    pub fn whole(textures: [wgpu::Texture; 2]) -> Self {
        let drawn_px = [0, 1].map(|eye: usize| [textures[eye].width(), textures[eye].height()]);
        Self { textures, drawn_px }
    }
}

/// State that changes rarely, read by the window once a frame of its own.
#[derive(Debug, Default)]
struct Shared {
    mirror: Option<MirrorImages>,
    load: LoadState,
    /// What [`LoadState::doing`] is read from.
    doing: Option<Arc<Count>>,
    notice: Option<(Instant, String)>,
}

/// The frame thread's (and the loader's) end.
#[derive(Clone, Debug)]
pub struct WalkEnd {
    rows: SyncSender<FrameRow>,
    shared: Arc<Mutex<Shared>>,
}

/// The window's end.
#[derive(Debug)]
pub struct ViewerEnd {
    /// Finished rows of the frame log, oldest first.
    pub rows: Receiver<FrameRow>,
    /// To the frame thread.
    pub commands: Sender<Command>,
    shared: Arc<Mutex<Shared>>,
}

/// Makes the two ends, and the receiver of commands for the frame thread.
#[must_use]
pub fn link() -> (WalkEnd, Receiver<Command>, ViewerEnd) {
    let (row_sender, rows) = sync_channel(512);
    let (commands, command_receiver) = channel();
    let shared = Arc::new(Mutex::new(Shared::default()));
    let walk = WalkEnd { rows: row_sender, shared: Arc::clone(&shared) };
    (walk, command_receiver, ViewerEnd { rows, commands, shared })
}

impl WalkEnd {
    /// Offers a row; dropped if the window does not keep up.
    pub fn offer_row(&self, row: FrameRow) {
        let _ = self.rows.try_send(row);
    }

    /// New mirror textures, or another part of them: at start and when the eyes' sizes change.
    pub fn set_mirror(&self, images: MirrorImages) {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).mirror = Some(images);
    }

    /// Tells the user something, once.
    pub fn set_notice(&self, text: String) {
        let notice = Some((Instant::now(), text));
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).notice = notice;
    }

    /// The window looks at this work from now on; `None`: there is none any more.
    pub fn set_doing(&self, doing: Option<Arc<Count>>) {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).doing = doing;
    }

    /// The work that goes on; `None` if that cannot be told without waiting for somebody.
    pub(super) fn try_doing(&self) -> Option<Option<Done>> {
        let shared = self.shared.try_lock().ok()?;
        Some(shared.doing.as_ref().map(|count| count.now()))
    }

    /// Changes what else the window says about loading; called by the loader's thread only.
    pub fn update_load(&self, change: impl FnOnce(&mut LoadState)) {
        change(&mut self.shared.lock().unwrap_or_else(PoisonError::into_inner).load);
    }
}

impl ViewerEnd {
    /// The mirror textures, once there are any.
    #[must_use]
    pub fn mirror(&self) -> Option<MirrorImages> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).mirror.clone()
    }

    /// What the user was told last, and when.
    #[must_use]
    pub fn notice(&self) -> Option<(Instant, String)> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).notice.clone()
    }

    /// What loading has come to.
    #[must_use]
    pub fn load(&self) -> LoadState {
        let shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        LoadState { doing: shared.doing.as_ref().map(|count| count.now()), ..shared.load.clone() }
    }
}
