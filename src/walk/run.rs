//! The frame thread's loop.

use super::action::Action;
use super::appearance::{Appearance, PresetOptions, QualityPreset};
use super::frames::{Frames, Step};
use super::governor::GovernorOptions;
use super::headsets::{CannotGoOn, Headsets};
use super::link::WalkEnd;
use super::locomotion::LocomotionOptions;
use super::state::{AppState, SpeedFactor};
use super::walker::Walker;
use crate::draw::{CannotDraw, DrawPlan};
use base::space::View;
use base::task::CancelToken;
use render::gpu::GpuLost;
use render::options::Overlay;
use render::scenery::Surround;
use render::{DrawOptions, RendererError};
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::Duration;
use timing::log::FrameLog;
use timing::pose_path::PosePath;
use xr::End;

/// What a walk goes by, besides what its frames are drawn with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkOptions {
    /// How the user moves.
    pub locomotion: LocomotionOptions,
    /// How frames are kept within their time.
    pub governor: GovernorOptions,
    /// What is drawn over the mirror at start.
    pub overlay: Overlay,
    /// How fast the user moves at start, and may move.
    pub speed: SpeedFactor,
    /// True if the controllers' buttons are labeled at first.
    pub labels: bool,
    /// What is seen where the scan has nothing.
    pub surround: Surround,
    /// False: the background of the draw options is seen there at start.
    pub shows_surround: bool,
    /// What [`QualityPreset::ALL`] come to.
    pub presets: [PresetOptions; QualityPreset::ALL.len()],
}

impl WalkOptions {
    /// The application's state at start, where frames are to look like this.
    #[must_use]
    pub fn state_at_start(&self, draw: DrawOptions) -> AppState {
        let &Self { governor, surround, shows_surround, .. } = self;
        let appearance = Appearance { draw, governor, surround, shows_surround };
        AppState::new(self.overlay, self.speed, appearance)
            .with_presets(self.presets)
            .labeling(self.locomotion.moving_hand, self.labels)
    }
}

/// What the loop needs besides headsets.
#[derive(Debug)]
pub struct Walk {
    /// What frames are drawn with.
    pub draw: DrawPlan,
    /// What the walk goes by.
    pub options: WalkOptions,
    /// Actions from those who show the walk.
    pub actions: Receiver<Action>,
    /// The link to the desktop.
    pub link: WalkEnd,
    /// True if a window shows the mirror.
    pub mirrored: bool,
    /// Log that rows are written to.
    pub log: Option<Arc<FrameLog>>,
    /// A head path to follow instead of the user.
    pub pose_path: Option<PosePath>,
    /// Stop after this many frames that showed a scan.
    pub max_frames: Option<u64>,
    /// Stop this long after the first frame that showed a scan.
    pub max_time: Option<Duration>,
    /// How long the walk goes on when the scan cannot be loaded: somebody is to read why.
    pub error_stays: Duration,
    /// Set from outside to end the walk.
    pub stop: CancelToken,
}

/// Why a walk cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum WalkError {
    /// The settings ask for what the GPU does not have.
    #[error(transparent)]
    Draw(#[from] CannotDraw),
    /// The headset's images are too large for the GPU, or what is to be drawn is not to be had.
    #[error(transparent)]
    Renderer(#[from] RendererError),
    /// The headset that is required, or the GPU, is gone.
    #[error(transparent)]
    Headset(#[from] CannotGoOn),
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

impl Walk {
    /// Draws frame after frame, for one headset after the other, until the user or a limit ends the walk, no scan is to
    /// come, or there is no headset to go on with.
    ///
    /// # Errors
    /// See [`WalkError`].
    pub fn run(self, headsets: &mut dyn Headsets) -> Result<WalkSummary, WalkError> {
        let mut walker = Walker::new(&self);
        loop {
            let end = self.with_current(&mut walker, headsets)?;
            if !headsets.replace(end.as_ref())? {
                return Ok(walker.finish(end.unwrap_or(End::ByUser)));
            }
        }
    }

    /// Draws frames for the current headset until it ends, or until another has come (`None`).
    fn with_current(
        &self,
        walker: &mut Walker,
        headsets: &mut dyn Headsets,
    ) -> Result<Option<End>, WalkError> {
        if let Some(loaded) = headsets.take_filling() {
            walker.await_scan(loaded);
        }
        let (gpu, headset) = headsets.current();
        let opened = gpu.unless_lost(|| Frames::new(self, walker, &gpu, headset));
        let mut frames = match opened {
            Ok(Ok(frames)) => frames,
            Err(GpuLost(reason)) => return Ok(Some(End::DeviceLost(reason))),
            // A walk that has gone well without this headset goes on without it.
            Ok(Err(error)) if walker.rows.frame > 0 && !headset.is_simulated() => {
                return Ok(Some(End::Unusable(error.to_string())));
            }
            Ok(Err(error)) => return Err(error),
        };
        let mut exit_requested = false;
        let end = loop {
            if !exit_requested && self.is_over(walker) {
                headsets.current().1.request_exit();
                exit_requested = true;
            }
            if headsets.has_another() && !exit_requested {
                break None;
            }
            let overlay = walker.state.overlay;
            if walker.take_actions(self) {
                self.stop.cancel();
            }
            if std::mem::take(&mut walker.looks_for_headset) {
                headsets.look_now();
            }
            if let Some(scan) = walker.wanted.take() {
                headsets.open_scan(scan);
                walker.leave_scan();
                frames.leave_scan();
                if let Some(loaded) = headsets.take_filling() {
                    walker.await_scan(loaded);
                }
            }
            if walker.state.overlay != overlay {
                frames.overlay_changed();
            }
            match gpu.unless_lost(|| frames.step(self, walker, headsets.current().1)) {
                Ok(step) => match step? {
                    Step::Ended(end) => break Some(end),
                    Step::Went => {}
                },
                Err(GpuLost(reason)) => break Some(End::DeviceLost(reason)),
            }
        };
        frames.close(self, walker);
        // Whoever is leaving anyway has no use for the reason why the headset left first.
        Ok(if exit_requested { Some(End::ByUser) } else { end })
    }

    /// True if the walk is to end.
    fn is_over(&self, walker: &mut Walker) -> bool {
        let in_vain = walker.in_vain_for().is_some_and(|time| time >= self.error_stays);
        let rows = &walker.rows;
        self.stop.is_cancelled()
            || in_vain
            || self.max_frames.is_some_and(|max| rows.scan_frames >= max)
            || self.max_time.zip(rows.scan_shown).is_some_and(|(max, since)| since.elapsed() >= max)
    }
}
