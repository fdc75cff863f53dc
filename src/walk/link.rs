//! The link between the frame thread and the desktop window. Neither end ever makes the frame thread wait:
//! rows that nobody takes are dropped, actions queue up, the mirror's textures change hands only at start
//! and when their size changes.

use super::state::{Action, AppState, Snapshot};
use base::task::{Count, Done};
use render::options::Overlay;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use timing::FrameRow;

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

/// What the headset shows, for the window. Textures are reference-counted, so a clone is cheap.
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
#[derive(Debug)]
struct Shared {
    mirror: Option<MirrorImages>,
    load: LoadState,
    /// What [`LoadState::doing`] is read from.
    doing: Option<Arc<Count>>,
    notice: Option<(Instant, String)>,
    snapshot: Snapshot,
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
    /// Actions for the frame thread.
    pub actions: Sender<Action>,
    shared: Arc<Mutex<Shared>>,
}

/// Makes the two ends, and the receiver of actions for the frame thread.
#[must_use]
pub fn link() -> (WalkEnd, Receiver<Action>, ViewerEnd) {
    let (row_sender, rows) = sync_channel(512);
    let (actions, action_receiver) = channel();
    let shared = Shared {
        mirror: None,
        load: LoadState::default(),
        doing: None,
        notice: None,
        snapshot: AppState::new(Overlay::None),
    };
    let shared = Arc::new(Mutex::new(shared));
    let walk = WalkEnd { rows: row_sender, shared: Arc::clone(&shared) };
    (walk, action_receiver, ViewerEnd { rows, actions, shared })
}

impl WalkEnd {
    /// Offers a row, which is dropped if the window does not keep up.
    pub fn offer_row(&self, row: FrameRow) {
        let _ = self.rows.try_send(row);
    }

    /// Sets new mirror textures, or another part of them: at start and when the eyes' sizes change.
    pub fn set_mirror(&self, images: MirrorImages) {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).mirror = Some(images);
    }

    /// Publishes the state, which has changed.
    pub fn publish(&self, snapshot: Snapshot) {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).snapshot = snapshot;
    }

    /// Tells the user something, once.
    pub fn set_notice(&self, text: String) {
        let notice = Some((Instant::now(), text));
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).notice = notice;
    }

    /// Has the window look at this work from now on; `None` if there is none any more.
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

    /// The state as it was when it last changed.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner).snapshot
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
