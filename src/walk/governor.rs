//! The governor: trades quality for time, so that the GPU keeps to its share of the display period.
//!
//! The governor trades along a ladder of settings: at the top what the frame is to look like, then coarser level of
//! detail, then fewer pixels, then `closest`. It goes down at once, and as far as the overload asks for; it comes
//! back a rung at a time, when there has been room for a while. Between too slow and room to spare lies the dead band
//! in which nothing happens. A step up that had to be undone is tried again much later, and later each time.
//!
//! Giving up quality must gain something. If even the cheapest rung shows each image for more than three displays, no
//! rung makes the images look like motion (on a slow integrated GPU or a software driver). The governor then goes
//! back to the last rung whose picture is still good, and stays there until the load changes. It has to try first,
//! because how much a rung saves is not known before.
//!
//! Only frames of the walk count: see [`timing::Phase`].
//!
//! Pure arithmetic on times that others measured; it allocates when made and when a walk begins, never in between.

mod ladder;

pub use ladder::Settings;

use ladder::{NEW_LOAD, Rung, good_rung, ladder, later};
use render::DrawOptions;
use render::options::Quality;
use std::fmt;
use timing::Phase;

/// Number of last frames that are looked back on.
const WINDOW: usize = 9;
/// Frames that must be known before anything is concluded.
const ENOUGH: usize = 5;
/// The slowest frames that are passed over: the next slowest counts, which is the median of [`ENOUGH`] frames and the
/// upper quartile of [`WINDOW`]. Two slow frames alone thus change nothing.
const OUTLIERS: usize = 2;

/// Share of the target that the frame after a step up is expected to leave free.
const MARGIN: f32 = 0.1;
/// Most displays that an image may stay for if quality is given up: at 72 to 120 Hz this is 24 to 40 images a second,
/// the least that looks like motion (film has 24).
const MOST_PERIODS: f32 = 3.0;

/// Whether and for what quality is given up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GovernorOptions {
    /// True if quality is given up at all.
    pub enabled: bool,
    /// Share of the display period that the GPU may use.
    pub budget: f32,
}

#[cfg(test)]
impl GovernorOptions {
    /// Options for tests.
    pub(crate) const fn sample() -> Self {
        Self { enabled: true, budget: 0.8 }
    }
}

/// A change of settings, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RungChange {
    /// Settings before.
    pub from: Settings,
    /// Settings from the next frame on.
    pub to: Settings,
    /// The GPU time that caused it, milliseconds.
    pub gpu_ms: f32,
    /// The time that was aimed at.
    pub target_ms: f32,
    /// Why the settings change.
    pub why: Why,
}

/// Why settings change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// Frames take too long: quality is given up.
    TooSlow,
    /// There is room: quality is given back.
    Room,
    /// Frames take far too long even with the cheapest settings: quality is given back, as giving it up has gained
    /// nothing.
    Hopeless,
}

impl RungChange {
    /// True if quality was given up, false if it was given back.
    #[must_use]
    pub fn is_down(&self) -> bool {
        self.why == Why::TooSlow
    }
}

impl fmt::Display for RungChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { from, to, gpu_ms, target_ms, why } = self;
        let why = match why {
            Why::TooSlow => "more than",
            Why::Room => "with room to spare in",
            Why::Hopeless => "even with the cheapest settings, far more than",
        };
        write!(f, "frames take {gpu_ms:.2} ms of the GPU, {why} the {target_ms:.2} ms aimed at:")?;
        if from.lod_scale != to.lod_scale {
            write!(f, " LOD scale {} → {}", from.lod_scale, to.lod_scale)?;
        }
        if from.resolution_scale != to.resolution_scale {
            write!(f, " resolution scale {} → {}", from.resolution_scale, to.resolution_scale)?;
        }
        if from.quality != to.quality {
            write!(f, " quality {} → {}", from.quality.name(), to.quality.name())?;
        }
        Ok(())
    }
}

/// A load that is too much even for the cheapest rung.
#[derive(Clone, Copy, Debug)]
struct Hopeless {
    /// Milliseconds of the cheapest rung's frames.
    cheapest_ms: f32,
    /// `cheapest_ms` as a share of the good rung's time; `None` until that is known.
    share: Option<f32>,
}

/// Keeps frames within their time. [`Governor::begin`] is called for every frame when it is recorded, and
/// [`Governor::observe`] for every frame of the walk when its time has come back.
#[derive(Clone, Debug)]
pub struct Governor {
    options: GovernorOptions,
    /// Rungs from what was asked for to the cheapest; at least one.
    ladder: Vec<Rung>,
    /// Index of the present rung.
    at: usize,
    /// The frame that was last recorded.
    newest_frame: u64,
    /// Frames before this one were drawn with other settings.
    first_frame: u64,
    times: RecentTimes,
    /// Frames in a row with room for a step up.
    calm: u32,
    /// The frame time that the last step was taken at, if it was a step up.
    raised_at_ms: Option<f32>,
    /// Set while nothing is given up because that would gain nothing.
    hopeless: Option<Hopeless>,
}

impl Governor {
    /// A governor at the top of the ladder, which is what `draw` asks for.
    #[must_use]
    pub fn new(options: GovernorOptions, draw: &DrawOptions) -> Self {
        Self::at_top(options, ladder(draw.quality, true))
    }

    fn at_top(options: GovernorOptions, ladder: Vec<Rung>) -> Self {
        Self {
            options,
            ladder,
            at: 0,
            newest_frame: 0,
            first_frame: 0,
            times: RecentTimes::default(),
            calm: 0,
            raised_at_ms: None,
            hopeless: None,
        }
    }

    /// Forgets all that was learned: the walk's own cloud is shown from the next frame on. `has_detail` is true if it
    /// can be drawn with fewer points.
    pub fn restart(&mut self, has_detail: bool) {
        self.aim_at(self.options, self.ladder[0].settings.quality, has_detail);
    }

    /// Aims at this quality from the next frame on, and forgets all that was learned of another.
    pub fn aim_at(&mut self, options: GovernorOptions, quality: Quality, has_detail: bool) {
        let newest_frame = self.newest_frame;
        let anew = Self::at_top(options, ladder(quality, has_detail));
        *self = Self { newest_frame, first_frame: newest_frame + 1, ..anew };
    }

    /// The settings in force.
    #[must_use]
    pub fn settings(&self) -> Settings {
        self.ladder[self.at].settings
    }

    /// Notes that frame number `frame` is recorded now, with the settings returned.
    pub fn begin(&mut self, frame: u64) -> Settings {
        self.newest_frame = frame;
        self.settings()
    }

    /// Notes that frame number `frame` took `gpu_ms` of a display period of `budget_ms`. A time says nothing if it is
    /// not known (NaN), belongs to other settings, or is not of the walk: while a scan is read, built and sent,
    /// others use the same GPU, and frames without a scan cost nothing.
    pub fn observe(&mut self, frame: u64, phase: Phase, gpu_ms: f32, budget_ms: f32) -> Option<RungChange> {
        let target_ms = self.options.budget * budget_ms;
        let known = gpu_ms.is_finite() && target_ms.is_finite() && target_ms > 0.0;
        if !known || phase != Phase::Walking || frame < self.first_frame || !self.options.enabled {
            return None;
        }
        self.times.push(gpu_ms);
        let gpu_ms = self.times.typical()?;
        if gpu_ms <= target_ms {
            self.hopeless = None;
            return self.step_up(gpu_ms, target_ms);
        }
        self.calm = 0;
        let most_ms = MOST_PERIODS * budget_ms;
        if self.is_hopeless(gpu_ms, most_ms) {
            return None;
        }
        self.step_down(gpu_ms, target_ms).or_else(|| self.give_back(gpu_ms, target_ms, most_ms))
    }

    /// True while giving up quality once more would gain nothing: frames of the cheapest rung would take more than
    /// `most_ms`, or nearly so. `gpu_ms` is what frames of the good rung take.
    fn is_hopeless(&mut self, gpu_ms: f32, most_ms: f32) -> bool {
        let Some(Hopeless { cheapest_ms, share }) = &mut self.hopeless else { return false };
        let is_hopeless = gpu_ms * *share.get_or_insert(*cheapest_ms / gpu_ms) > NEW_LOAD * most_ms;
        if !is_hopeless {
            self.hopeless = None;
        }
        is_hopeless
    }

    /// Steps from the cheapest rung back to a good picture, if giving that up has gained nothing.
    fn give_back(&mut self, gpu_ms: f32, target_ms: f32, most_ms: f32) -> Option<RungChange> {
        let good = good_rung(&self.ladder);
        if gpu_ms <= most_ms || good >= self.at {
            return None;
        }
        self.raised_at_ms = None;
        self.hopeless = Some(Hopeless { cheapest_ms: gpu_ms, share: None });
        Some(self.step_to(good, gpu_ms, target_ms, Why::Hopeless))
    }

    /// Steps down by as many rungs as could suffice. A rung rarely saves the most that it can, so this falls short
    /// rather than goes too far; the next frames then go on.
    fn step_down(&mut self, gpu_ms: f32, target_ms: f32) -> Option<RungChange> {
        let here = self.settings();
        let below = &self.ladder[self.at + 1..];
        let could_do = |rung: &Rung| gpu_ms / here.most_saved_by(&rung.settings) <= target_ms;
        let rungs = below.iter().position(could_do).map_or(below.len(), |position| position + 1);
        if rungs == 0 {
            return None;
        }
        let since_step = self.times.seen;
        if let Some(raised_at_ms) = self.raised_at_ms.take() {
            self.ladder[self.at].judge(since_step, raised_at_ms);
        }
        Some(self.step_to(self.at + rungs, gpu_ms, target_ms, Why::TooSlow))
    }

    /// Steps up by one rung, if there has been room for it long enough.
    fn step_up(&mut self, gpu_ms: f32, target_ms: f32) -> Option<RungChange> {
        let above = self.at.checked_sub(1)?;
        let most = self.ladder[above].settings.most_saved_by(&self.settings());
        let room_ms = (1.0 - MARGIN) * target_ms;
        // The square root assumes that half of the frame's time, in logarithms, goes to what the rung changes.
        let likely = gpu_ms * most.sqrt() <= room_ms;
        // Such a step may well fail, but even then no display is missed; and without trying nobody would ever know.
        let harmless = gpu_ms <= room_ms && gpu_ms * most <= target_ms / self.options.budget;
        if !(likely || harmless) {
            self.calm = 0;
            return None;
        }
        self.calm += 1;
        let patience = self.ladder[above].patience(gpu_ms);
        if self.calm < if likely { patience } else { later(patience) } {
            return None;
        }
        self.raised_at_ms = Some(gpu_ms);
        Some(self.step_to(above, gpu_ms, target_ms, Why::Room))
    }

    fn step_to(&mut self, at: usize, gpu_ms: f32, target_ms: f32, why: Why) -> RungChange {
        let from = self.settings();
        self.at = at;
        self.first_frame = self.newest_frame + 1;
        self.times = RecentTimes::default();
        self.calm = 0;
        RungChange { from, to: self.settings(), gpu_ms, target_ms, why }
    }
}

/// Times of the last frames since the last step.
#[derive(Clone, Copy, Debug, Default)]
struct RecentTimes {
    ms: [f32; WINDOW],
    /// Frames since the last step.
    seen: u32,
}

impl RecentTimes {
    fn push(&mut self, ms: f32) {
        self.ms[self.seen as usize % WINDOW] = ms;
        self.seen = self.seen.saturating_add(1);
    }

    /// The slowest time after the [`OUTLIERS`] slowest; `None` if too few are known.
    fn typical(&self) -> Option<f32> {
        let known = (self.seen as usize).min(WINDOW);
        let mut sorted = self.ms;
        sorted[..known].sort_unstable_by(f32::total_cmp);
        (known >= ENOUGH).then(|| sorted[known - 1 - OUTLIERS])
    }
}

#[cfg(test)]
mod tests;
