//! The walk as it goes on from one headset to the next: state, place, rows, and the scan as far as it has come.

use super::action::Action;
use super::filling::{Loaded, ScanRequest};
use super::locomotion::Locomotion;
use super::rows::{PendingRows, pass_on};
use super::run::{Walk, WalkSummary};
use super::screenshot::Screenshots;
use super::state::{AppState, Snapshot};
use base::space::{Pose, View};
use render::CloudBuffers;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError};
use std::time::{Duration, Instant};
use timing::Phase;
use xr::End;

/// What a walk keeps when its headset, or its GPU, is replaced.
pub(super) struct Walker {
    pub state: AppState,
    /// What surfaces have got of the state.
    published: Option<Snapshot>,
    pub screenshots: Screenshots,
    pub rows: PendingRows,
    /// The scan on the current GPU, as far as it has come.
    pub cloud: Option<CloudBuffers>,
    /// The scan on its way to the current GPU; `None` once all of it has come.
    loaded: Option<Receiver<Loaded>>,
    in_vain_since: Option<Instant>,
    /// True if the user wants a headset looked for at once.
    pub looks_for_headset: bool,
    /// The scan that the user wants opened.
    pub wanted: Option<Arc<ScanRequest>>,
    pub stage_from_head: Pose,
    /// True once a headset has told where the head is.
    is_located: bool,
    pub last_view: Option<View>,
}

impl Walker {
    pub fn new(walk: &Walk) -> Self {
        Self {
            state: walk.options.state_at_start(walk.draw.options),
            published: None,
            screenshots: Screenshots::default(),
            rows: PendingRows::new(),
            cloud: None,
            loaded: None,
            in_vain_since: None,
            looks_for_headset: false,
            wanted: None,
            stage_from_head: Pose::IDENTITY,
            is_located: false,
            last_view: None,
        }
    }

    /// Takes in that the scan comes to another GPU.
    pub fn await_scan(&mut self, loaded: Receiver<Loaded>) {
        (self.cloud, self.loaded) = (None, Some(loaded));
    }

    /// Takes in where the head is. A walk that has begun before anybody knew begins there.
    pub fn locate_head(&mut self, stage_from_head: Pose) {
        self.stage_from_head = stage_from_head;
        if !std::mem::replace(&mut self.is_located, true)
            && let Some(locomotion) = &mut self.state.locomotion
        {
            locomotion.begin_with(&stage_from_head);
        }
    }

    /// Lets go of the scan, for another is wanted.
    pub fn leave_scan(&mut self) {
        (self.cloud, self.loaded, self.in_vain_since) = (None, None, None);
        (self.state.locomotion, self.last_view) = (None, None);
    }

    /// Takes the scan if it has become ready; true if it has. The viewer stays where they are if they have been in it
    /// before.
    pub fn take_loaded(&mut self, walk: &Walk) -> bool {
        let mut has_come = false;
        while let Some(loaded) = &self.loaded {
            match loaded.try_recv() {
                Ok(Loaded { cloud, start, starts, floors, stations }) => {
                    self.cloud = Some(cloud);
                    let head = &self.stage_from_head;
                    self.state.locomotion.get_or_insert_with(|| {
                        Locomotion::new(walk.options.locomotion, start, starts, floors, stations, head)
                    });
                    has_come = true;
                }
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => self.loaded = None,
            }
        }
        has_come
    }

    /// True until all of the scan has come.
    pub fn is_arriving(&self) -> bool {
        self.loaded.is_some()
    }

    /// How long it is known that the loader is done and has brought no scan.
    pub fn in_vain_for(&mut self) -> Option<Duration> {
        let is_in_vain = self.loaded.is_none() && self.cloud.is_none();
        is_in_vain.then(|| self.in_vain_since.get_or_insert_with(Instant::now).elapsed())
    }

    /// What the frame shows.
    pub fn phase(&self) -> Phase {
        match self.cloud {
            None => Phase::Waiting,
            Some(_) if self.is_arriving() => Phase::Arriving,
            Some(_) => Phase::Walking,
        }
    }

    /// Applies the actions that were asked for, and publishes what has changed since; returns true if one of them ends the
    /// walk.
    pub fn take_actions(&mut self, walk: &Walk) -> bool {
        while let Ok(action) = walk.actions.try_recv() {
            match action {
                Action::Quit => return true,
                Action::Screenshot => self.screenshots.ask(),
                Action::LookForHeadset => self.looks_for_headset = true,
                Action::Open(scan) => self.wanted = Some(scan),
                Action::GoToSeen { eye, at } => {
                    if !self.go_to_seen(eye, at) {
                        walk.link.set_notice("There is no floor to stand on there".into());
                    }
                }
                action => {
                    let keeps = action == Action::SavePlace;
                    self.state.apply(action);
                    if keeps {
                        walk.link
                            .set_notice("This place is kept: N and Page Up lead to those that are".into());
                    }
                }
            }
        }
        let now = Some(self.state.snapshot());
        // What a surface keeps from being published is published with the next frame.
        if let Some(snapshot) = now.filter(|_| now != self.published)
            && walk.link.try_publish(snapshot)
        {
            self.published = now;
        }
        false
    }

    /// Goes to the floor that a place of an eye's last image shows; false if it shows none.
    fn go_to_seen(&mut self, eye: usize, at: [f64; 2]) -> bool {
        let eye = self.last_view.as_ref().and_then(|view| view.eyes.get(eye));
        let ray = eye.map(|eye| (eye.world_from_view.position, eye.along_in_world(at)));
        let (Some((from, along)), Some(locomotion)) = (ray, &mut self.state.locomotion) else { return false };
        locomotion.go_where_pointed(from, along)
    }

    /// Passes on all rows, whether or not their times have come.
    pub fn give_up_rows(&mut self, walk: &Walk) {
        self.rows.give_up(true, &mut |row| pass_on(walk.log.as_deref(), &walk.link, row));
    }

    /// Waits for the last screenshot, and tells what has come of the walk.
    pub fn finish(mut self, ended: End) -> WalkSummary {
        self.screenshots.finish();
        let PendingRows { frame, scan_frames, .. } = self.rows;
        WalkSummary { frames: frame, scan_frames, ended, last_view: self.last_view }
    }
}
