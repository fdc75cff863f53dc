//! The governor: trades quality for time, so that the GPU keeps to its share of the display period.
//!
//! What it can trade is a ladder of settings: at the top what the configuration asks for, then coarser level of
//! detail, then fewer pixels, then `closest`. It goes down at once, and as far as the overload asks for; it comes
//! back a rung at a time, when there has been room for a while. Between too slow and room to spare lies the dead
//! band in which nothing happens. A step up that had to be undone is tried again much later, and later each time.
//!
//! Pure arithmetic on times that others measured; it allocates when made and never again.

use crate::config::{Config, Quality};
use std::fmt;

/// LOD scales of the ladder below 1: a fourth fewer points each, where points lie on surfaces.
const LOD_SCALES: [f32; 8] = [1.15, 1.32, 1.51, 1.73, 1.99, 2.28, 2.62, 3.0];
/// Resolution scales of the ladder below 1: a sixth to a fourth fewer pixels each.
const RESOLUTION_SCALES: [f32; 5] = [0.92, 0.84, 0.76, 0.68, 0.6];
/// `hqs` costs at most so many times what `closest` does.
const MOST_SAVED_BY_CLOSEST: f32 = 2.0;

/// Frames that are looked back on.
const WINDOW: usize = 9;
/// Frames that must be known before anything is concluded.
const ENOUGH: usize = 5;
/// The frame that counts is the slowest but so many: the median of [`ENOUGH`] frames, the upper quartile of
/// [`WINDOW`]. So two slow frames alone do nothing.
const OUTLIERS: usize = 2;

/// Share of the target that the frame after a step up is expected to leave free.
const MARGIN: f32 = 0.1;
/// Frames with room before a step up: half a second at 90 Hz.
const PATIENCE: u32 = 45;
/// After a step up that failed, the next one to that rung waits so many times longer; so does a step up that is
/// likely to fail.
const LATER: u32 = 4;
/// What waiting may grow to: half a minute.
const MOST_PATIENCE: u32 = 64 * PATIENCE;
/// A step up has failed if the next step is down and comes within so many times its waiting time, but at most
/// [`MOST_PATIENCE`].
const HELD: u32 = 16;
/// A load below this share of the one that a step up failed at is a new one, and nothing is known against it.
const NEW_LOAD: f32 = 0.85;

/// What a frame is drawn with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Factor on the LOD thresholds, 1 to 3.
    pub lod_scale: f32,
    /// Factor on the images' width and height, 0.6 to 1.
    pub resolution_scale: f32,
    /// What a pixel shows.
    pub quality: Quality,
}

impl Settings {
    /// The part of an image of `full_px` that is drawn: even numbers, but the whole of it at scale 1.
    #[must_use]
    pub fn drawn_px(&self, full_px: [u32; 2]) -> [u32; 2] {
        if self.resolution_scale >= 1.0 {
            return full_px;
        }
        let even = |full: u32| 2 * (0.5 * full as f32 * self.resolution_scale).round() as u32;
        full_px.map(|full| even(full).clamp(full.min(2), full))
    }

    /// How many times faster a frame can become at most by going from here to `cheaper`: if all of its time goes
    /// to points, or to pixels.
    fn most_saved_by(&self, cheaper: &Self) -> f32 {
        let points = cheaper.lod_scale / self.lod_scale;
        let pixels = self.resolution_scale / cheaper.resolution_scale;
        let shading = if self.quality == cheaper.quality { 1.0 } else { MOST_SAVED_BY_CLOSEST };
        points * points * pixels * pixels * shading
    }
}

/// A change of settings, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Settings before.
    pub from: Settings,
    /// Settings from the next frame on.
    pub to: Settings,
    /// The GPU time that caused it, milliseconds.
    pub gpu_ms: f32,
    /// The time that was aimed at.
    pub target_ms: f32,
}

impl Step {
    /// True if quality was given up, false if it was given back.
    #[must_use]
    pub fn is_down(&self) -> bool {
        self.gpu_ms > self.target_ms
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { from, to, gpu_ms, target_ms } = self;
        let why = if self.is_down() { "more than" } else { "with room to spare in" };
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

/// Keeps frames within their time. For every frame: [`Governor::begin`] when it is recorded, and
/// [`Governor::observe`] when its time has come back.
#[derive(Clone, Debug)]
pub struct Governor {
    /// Share of the display period to aim at.
    budget: f32,
    /// From what was asked for to the cheapest; at least one.
    ladder: Vec<Rung>,
    /// Where on the ladder.
    at: usize,
    /// The frame that was last recorded.
    newest_frame: u64,
    /// Frames before this one were drawn with other settings.
    first_frame: u64,
    times: Times,
    /// Frames in a row with room for a step up.
    calm: u32,
    /// The frame time that the last step was taken at, if it was a step up.
    raised_at_ms: Option<f32>,
}

impl Governor {
    /// At the top of the ladder: `frame.quality`, thresholds and resolution as configured.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        let ladder = ladder(config);
        Self {
            budget: config.governor.budget as f32,
            ladder,
            at: 0,
            newest_frame: 0,
            first_frame: 0,
            times: Times::default(),
            calm: 0,
            raised_at_ms: None,
        }
    }

    /// The settings in force.
    #[must_use]
    pub fn settings(&self) -> Settings {
        self.ladder[self.at].settings
    }

    /// Frame number `frame` is recorded now, with the settings returned.
    pub fn begin(&mut self, frame: u64) -> Settings {
        self.newest_frame = frame;
        self.settings()
    }

    /// Takes note that frame number `frame` took `gpu_ms` of a display period of `budget_ms`. A time that is not
    /// known (NaN) or that other settings led to says nothing.
    pub fn observe(&mut self, frame: u64, gpu_ms: f32, budget_ms: f32) -> Option<Step> {
        let target_ms = self.budget * budget_ms;
        let known = gpu_ms.is_finite() && target_ms.is_finite() && target_ms > 0.0;
        if !known || frame < self.first_frame || self.ladder.len() < 2 {
            return None;
        }
        self.times.push(gpu_ms);
        let gpu_ms = self.times.typical()?;
        if gpu_ms > target_ms {
            self.calm = 0;
            return self.step_down(gpu_ms, target_ms);
        }
        self.step_up(gpu_ms, target_ms)
    }

    /// Down by as many rungs as could do. A rung rarely saves the most that it can, so this falls short rather
    /// than too far; then the next frames go on.
    fn step_down(&mut self, gpu_ms: f32, target_ms: f32) -> Option<Step> {
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
        Some(self.step_to(self.at + rungs, gpu_ms, target_ms))
    }

    /// Up by one rung, if there has been room for it long enough.
    fn step_up(&mut self, gpu_ms: f32, target_ms: f32) -> Option<Step> {
        let above = self.at.checked_sub(1)?;
        let most = self.ladder[above].settings.most_saved_by(&self.settings());
        let room_ms = (1.0 - MARGIN) * target_ms;
        // As if half of the frame's time, in logarithms, went to what the rung changes.
        let likely = gpu_ms * most.sqrt() <= room_ms;
        // It may well fail, but even then no display is missed; and without trying nobody would ever know.
        let harmless = gpu_ms <= room_ms && gpu_ms * most <= target_ms / self.budget;
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
        Some(self.step_to(above, gpu_ms, target_ms))
    }

    fn step_to(&mut self, at: usize, gpu_ms: f32, target_ms: f32) -> Step {
        let from = self.settings();
        self.at = at;
        self.first_frame = self.newest_frame + 1;
        self.times = Times::default();
        self.calm = 0;
        Step { from, to: self.settings(), gpu_ms, target_ms }
    }
}

/// A place on the ladder, and what was learnt of getting there from the one below.
#[derive(Clone, Copy, Debug)]
struct Rung {
    settings: Settings,
    /// Frames that a step up to here waits for.
    patience: u32,
    /// The frame time, one rung below, that the last failed step up was taken at.
    failed_at_ms: f32,
}

impl Rung {
    fn new(settings: Settings) -> Self {
        Self { settings, patience: PATIENCE, failed_at_ms: f32::INFINITY }
    }

    /// Frames to wait before stepping up to here from the rung below, where frames take `gpu_ms`.
    fn patience(&self, gpu_ms: f32) -> u32 {
        if gpu_ms < NEW_LOAD * self.failed_at_ms { PATIENCE } else { self.patience }
    }

    /// Quality has to be given up `since_step` frames after the step up to here, taken at `raised_at_ms`.
    fn judge(&mut self, since_step: u32, raised_at_ms: f32) {
        if since_step > (HELD * self.patience).min(MOST_PATIENCE) {
            *self = Self::new(self.settings);
        } else {
            self.failed_at_ms = raised_at_ms;
            self.patience = later(self.patience);
        }
    }
}

fn later(patience: u32) -> u32 {
    (LATER * patience).min(MOST_PATIENCE)
}

/// What there is to trade, dearest first. Only what was asked for if the governor is off.
fn ladder(config: &Config) -> Vec<Rung> {
    let mut now = Settings { lod_scale: 1.0, resolution_scale: 1.0, quality: config.frame.quality };
    let mut ladder = vec![Rung::new(now)];
    if !config.governor.enabled {
        return ladder;
    }
    if config.lod.enabled {
        for lod_scale in LOD_SCALES {
            now.lod_scale = lod_scale;
            ladder.push(Rung::new(now));
        }
    }
    for resolution_scale in RESOLUTION_SCALES {
        now.resolution_scale = resolution_scale;
        ladder.push(Rung::new(now));
    }
    if now.quality == Quality::Hqs {
        now.quality = Quality::Closest;
        ladder.push(Rung::new(now));
    }
    ladder
}

/// The last frames' times since the last step.
#[derive(Clone, Copy, Debug, Default)]
struct Times {
    ms: [f32; WINDOW],
    /// Frames since the step.
    seen: u32,
}

impl Times {
    fn push(&mut self, ms: f32) {
        self.ms[self.seen as usize % WINDOW] = ms;
        self.seen = self.seen.saturating_add(1);
    }

    /// The slowest but [`OUTLIERS`]; `None` if too few are known.
    fn typical(&self) -> Option<f32> {
        let known = (self.seen as usize).min(WINDOW);
        let mut sorted = self.ms;
        sorted[..known].sort_unstable_by(f32::total_cmp);
        (known >= ENOUGH).then(|| sorted[known - 1 - OUTLIERS])
    }
}

#[cfg(test)]
mod tests;
