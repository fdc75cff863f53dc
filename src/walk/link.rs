//! The link between the frame thread and the desktop window. Neither end ever makes the frame thread wait:
//! rows that nobody takes are dropped, actions queue up, the mirror's textures change hands only at start
//! and when their size changes.

use super::action::Action;
use super::filling::ScanRequest;
use super::menu::{MenuInput, PaintedPanel};
use super::state::Snapshot;
use base::task::{Count, Done};
use render::gpu::Gpu;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
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
    /// The scan that is loading, or has been loaded.
    pub scan: Option<Arc<ScanRequest>>,
}

impl LoadState {
    /// Names of the scan's files.
    #[must_use]
    pub fn names(&self) -> String {
        self.scan.as_ref().map(|scan| scan.names()).unwrap_or_default()
    }
}

/// Which headset the walk has, for the window.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeadsetState {
    /// Its OpenXR runtime, or "simulated".
    pub runtime: String,
    /// The GPU's name.
    pub device: String,
    /// State of its session: "FOCUSED", "simulated".
    pub session: &'static str,
    /// True while the walk has none and looks for one.
    pub is_sought: bool,
    /// Why the walk waits for a real headset that it had: the sentence for people.
    pub waiting_because: Option<String>,
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

/// What both ends hold.
#[derive(Debug)]
struct Shared(Mutex<Rest>);

/// State that changes rarely, read by the window once a frame of its own.
#[derive(Debug)]
struct Rest {
    /// The GPU that `mirror` lives on.
    gpu: Option<Arc<Gpu>>,
    mirror: Option<MirrorImages>,
    headset: HeadsetState,
    /// What loading has come to, except for [`LoadState::doing`], which stays empty.
    load: LoadState,
    /// The work that goes on.
    doing: Option<Arc<Count>>,
    notice: Option<(Instant, String)>,
    snapshot: Snapshot,
    /// The card that is seen in the headset, on `gpu`.
    card: Option<wgpu::Texture>,
    /// The menu or the labels that are seen in the headset, on `gpu`.
    panel: Option<(PaintedPanel, wgpu::Texture)>,
    /// What hands do to the menu.
    menu_input: MenuInput,
}

/// The frame thread's (and the loader's) end.
#[derive(Clone, Debug)]
pub struct WalkEnd {
    rows: SyncSender<FrameRow>,
    shared: Arc<Shared>,
}

/// The window's end.
#[derive(Debug)]
pub struct ViewerEnd {
    /// Finished rows of the frame log, oldest first.
    pub rows: Receiver<FrameRow>,
    /// Actions for the frame thread.
    pub actions: Sender<Action>,
    shared: Arc<Shared>,
}

/// The end of whoever paints the card and the menu that are seen in the headset.
#[derive(Clone, Debug)]
pub struct PaintEnd {
    shared: Arc<Shared>,
}

/// Makes the two ends, and the receiver of actions for the frame thread, whose state at start is `snapshot`.
#[must_use]
pub fn link(snapshot: Snapshot) -> (WalkEnd, Receiver<Action>, ViewerEnd) {
    let (row_sender, rows) = sync_channel(512);
    let (actions, action_receiver) = channel();
    let (load, headset) = (LoadState::default(), HeadsetState::default());
    let rest = Mutex::new(Rest {
        gpu: None,
        mirror: None,
        headset,
        load,
        doing: None,
        notice: None,
        snapshot,
        card: None,
        panel: None,
        menu_input: MenuInput::default(),
    });
    let shared = Arc::new(Shared(rest));
    let walk = WalkEnd { rows: row_sender, shared: Arc::clone(&shared) };
    (walk, action_receiver, ViewerEnd { rows, actions, shared })
}

impl Shared {
    fn rest(&self) -> MutexGuard<'_, Rest> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn load(&self) -> LoadState {
        let rest = self.rest();
        LoadState { doing: rest.doing.as_ref().map(|count| count.now()), ..rest.load.clone() }
    }
}

impl WalkEnd {
    /// Offers a row, which is dropped if the window does not keep up.
    pub fn offer_row(&self, row: FrameRow) {
        let _ = self.rows.try_send(row);
    }

    /// Has the window draw on this GPU from now on; true if it is another one.
    pub fn set_gpu(&self, gpu: &Arc<Gpu>) -> bool {
        let mut rest = self.shared.rest();
        let is_new = !rest.gpu.as_ref().is_some_and(|known| Arc::ptr_eq(known, gpu));
        if is_new {
            (rest.gpu, rest.mirror) = (Some(Arc::clone(gpu)), None);
            (rest.card, rest.panel) = (None, None);
            rest.headset.device = gpu.name();
        }
        is_new
    }

    /// Changes what the window says of the headset.
    pub fn update_headset(&self, change: impl FnOnce(&mut HeadsetState)) {
        change(&mut self.shared.rest().headset);
    }

    /// Sets new mirror textures, or another part of them: at start and when the eyes' sizes change.
    pub fn set_mirror(&self, images: MirrorImages) {
        self.shared.rest().mirror = Some(images);
    }

    /// Publishes what has changed of the state, unless somebody would have to be waited for; true if it is done.
    #[must_use]
    pub fn try_publish(&self, snapshot: Snapshot) -> bool {
        self.shared.0.try_lock().map(|mut rest| rest.snapshot = snapshot).is_ok()
    }

    /// Tells the user something, once.
    pub fn set_notice(&self, text: String) {
        let notice = Some((Instant::now(), text));
        self.shared.rest().notice = notice;
    }

    /// Has the window look at this work from now on; `None` if there is none any more.
    pub fn set_doing(&self, doing: Option<Arc<Count>>) {
        self.shared.rest().doing = doing;
    }

    /// The card that is to be seen in the headset, if there is one; `None` if it cannot be told without waiting.
    pub(super) fn try_card(&self) -> Option<Option<wgpu::Texture>> {
        Some(self.shared.0.try_lock().ok()?.card.clone())
    }

    /// The menu or the labels, if they are painted; `None` if it cannot be told without waiting.
    pub(super) fn try_panel(&self) -> Option<Option<(PaintedPanel, wgpu::Texture)>> {
        Some(self.shared.0.try_lock().ok()?.panel.clone())
    }

    /// Tells whoever paints the menu what hands do to it; false if somebody would have to be waited for.
    pub(super) fn try_point(&self, input: MenuInput) -> bool {
        self.shared.0.try_lock().map(|mut rest| rest.menu_input = input).is_ok()
    }

    /// The end of whoever paints what is seen in the headset.
    #[must_use]
    pub fn paint_end(&self) -> PaintEnd {
        PaintEnd { shared: Arc::clone(&self.shared) }
    }

    /// Changes what else the window says about loading; called by the loader's thread only.
    pub fn update_load(&self, change: impl FnOnce(&mut LoadState)) {
        change(&mut self.shared.rest().load);
    }
}

impl PaintEnd {
    /// The GPU to paint on, once there is one.
    #[must_use]
    pub fn gpu(&self) -> Option<Arc<Gpu>> {
        self.shared.rest().gpu.clone()
    }

    /// What loading has come to.
    #[must_use]
    pub fn load(&self) -> LoadState {
        self.shared.load()
    }

    /// The state as it was when it last changed.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        self.shared.rest().snapshot
    }

    /// What hands do to the menu.
    #[must_use]
    pub fn menu_input(&self) -> MenuInput {
        self.shared.rest().menu_input
    }

    /// Has the headset show this card from now on, if the walk is still on this GPU.
    pub fn set_card(&self, gpu: &Arc<Gpu>, card: Option<wgpu::Texture>) {
        self.on(gpu, |rest| rest.card = card);
    }

    /// Has the headset show this menu, or these labels, from now on, if the walk is still on this GPU.
    pub fn set_panel(&self, gpu: &Arc<Gpu>, panel: Option<(PaintedPanel, wgpu::Texture)>) {
        self.on(gpu, |rest| rest.panel = panel);
    }

    /// The runtime of the headset that the walk has.
    #[must_use]
    pub fn runtime(&self) -> String {
        self.shared.rest().headset.runtime.clone()
    }

    fn on(&self, gpu: &Arc<Gpu>, change: impl FnOnce(&mut Rest)) {
        let mut rest = self.shared.rest();
        if rest.gpu.as_ref().is_some_and(|known| Arc::ptr_eq(known, gpu)) {
            change(&mut rest);
        }
    }
}

impl ViewerEnd {
    /// The end of whoever paints what is seen in the headset.
    #[must_use]
    pub fn paint_end(&self) -> PaintEnd {
        PaintEnd { shared: Arc::clone(&self.shared) }
    }

    /// The GPU to draw on, once there is one.
    #[must_use]
    pub fn gpu(&self) -> Option<Arc<Gpu>> {
        self.shared.rest().gpu.clone()
    }

    /// The mirror textures, once there are any on this GPU.
    #[must_use]
    pub fn mirror(&self, gpu: &Arc<Gpu>) -> Option<MirrorImages> {
        let rest = self.shared.rest();
        rest.mirror.clone().filter(|_| rest.gpu.as_ref().is_some_and(|known| Arc::ptr_eq(known, gpu)))
    }

    /// Which headset the walk has.
    #[must_use]
    pub fn headset(&self) -> HeadsetState {
        self.shared.rest().headset.clone()
    }

    /// The state as it was when it last changed.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        self.shared.rest().snapshot
    }

    /// What the user was told last, and when.
    #[must_use]
    pub fn notice(&self) -> Option<(Instant, String)> {
        self.shared.rest().notice.clone()
    }

    /// What loading has come to.
    #[must_use]
    pub fn load(&self) -> LoadState {
        self.shared.load()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::task::{CancelToken, Task};

    #[test]
    fn the_frame_thread_waits_for_nobody() {
        let (walk, _actions, viewer) = link(Snapshot::sample());
        assert_eq!(walk.try_card(), Some(None));
        let loader = walk.clone();
        let task = Task::new(&CancelToken::default())
            .observed(move |count| loader.set_doing(Some(Arc::clone(count))));
        let reading = task.begin("reading", "points", 4);
        reading.add(1);
        assert_eq!(viewer.load().doing.map(|done| done.fraction()), Some(0.25));
        let snapshot = Snapshot { overlay: render::options::Overlay::Nodes, ..viewer.snapshot() };
        let looking = viewer.shared.rest();
        assert_eq!(walk.try_card(), None);
        assert!(!walk.try_publish(snapshot));
        drop(looking);
        assert!(walk.try_publish(snapshot));
        assert_eq!(viewer.snapshot(), snapshot);
    }
}
