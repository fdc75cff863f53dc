//! The governor's ladder: what there is to trade, from what was asked for down to the cheapest, and what was learned of
//! each rung.

use render::options::Quality;

/// LOD scales of the rungs below the top, whose scale is 1: each draws a fourth fewer points, where points lie on
/// surfaces.
const LOD_SCALES: [f32; 8] = [1.15, 1.32, 1.51, 1.73, 1.99, 2.28, 2.62, 3.0];
/// Resolution scales of the rungs below the top, whose scale is 1: each draws a sixth to a fourth fewer pixels.
pub(super) const RESOLUTION_SCALES: [f32; 5] = [0.92, 0.84, 0.76, 0.68, 0.6];
/// `hqs` costs at most this many times what `closest` does.
const MOST_SAVED_BY_CLOSEST: f32 = 2.0;
/// The coarsest LOD scale whose picture is still sharp. Points of a node then lie `threshold_px` / 128 times this
/// apart: 1.6, 3.1 and 4.7 pixels in the three rings, half of the reach of dilation by rings or little more
/// ([`render::RINGS_REACH_PX`]). At coarser scales splats close the gaps, and blur.
const GOOD_LOD_SCALE: f32 = 1.99;

/// Frames with room before a step up: half a second at 90 Hz.
const PATIENCE: u32 = 45;
/// After a step up that failed, the next one to that rung waits this many times longer; so does a step up that is
/// likely to fail.
const LATER: u32 = 4;
/// Most frames that waiting may grow to: half a minute.
const MOST_PATIENCE: u32 = 64 * PATIENCE;
/// A step up has failed if the next step is down and comes within this many times its waiting time, or within
/// [`MOST_PATIENCE`] if that is less.
const HELD: u32 = 16;
/// A load below this share of the one that a step up failed at is new: the failure does not count for it.
pub(super) const NEW_LOAD: f32 = 0.85;

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
    /// The part of an image of `full_px` that is drawn: the whole image at scale 1, else even numbers of pixels.
    #[must_use]
    pub fn drawn_px(&self, full_px: [u32; 2]) -> [u32; 2] {
        if self.resolution_scale >= 1.0 {
            return full_px;
        }
        let even = |full: u32| 2 * (0.5 * full as f32 * self.resolution_scale).round() as u32;
        full_px.map(|full| even(full).clamp(full.min(2), full))
    }

    /// How many times faster a frame can become at most by going from here to `cheaper`: as if all of its time went
    /// to points and pixels.
    pub(super) fn most_saved_by(&self, cheaper: &Self) -> f32 {
        let points = cheaper.lod_scale / self.lod_scale;
        let pixels = self.resolution_scale / cheaper.resolution_scale;
        let shading = if self.quality == cheaper.quality { 1.0 } else { MOST_SAVED_BY_CLOSEST };
        points * points * pixels * pixels * shading
    }
}

/// A place on the ladder, and what was learned of getting there from the one below.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rung {
    pub(super) settings: Settings,
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
    pub(super) fn patience(&self, gpu_ms: f32) -> u32 {
        if gpu_ms < NEW_LOAD * self.failed_at_ms { PATIENCE } else { self.patience }
    }

    /// Judges the step up to here, taken at `raised_at_ms`: quality has to be given up again `since_step` frames
    /// later.
    pub(super) fn judge(&mut self, since_step: u32, raised_at_ms: f32) {
        if since_step > (HELD * self.patience).min(MOST_PATIENCE) {
            *self = Self::new(self.settings);
        } else {
            self.failed_at_ms = raised_at_ms;
            self.patience = later(self.patience);
        }
    }
}

/// Returns a longer wait.
pub(super) fn later(patience: u32) -> u32 {
    (LATER * patience).min(MOST_PATIENCE)
}

/// Returns the rungs, dearest first: `quality` is what was asked for. `has_detail` is true if the cloud that is shown
/// can be drawn with fewer points.
pub(super) fn ladder(quality: Quality, has_detail: bool) -> Vec<Rung> {
    let mut now = Settings { lod_scale: 1.0, resolution_scale: 1.0, quality };
    let mut ladder = vec![Rung::new(now)];
    if has_detail {
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

/// Index of the last rung whose picture is still good: sharp, blended as asked for, without gaps.
pub(super) fn good_rung(ladder: &[Rung]) -> usize {
    let top = &ladder[0].settings;
    let is_good = |rung: &Rung| {
        let Settings { lod_scale, resolution_scale, quality } = rung.settings;
        lod_scale <= GOOD_LOD_SCALE && resolution_scale == 1.0 && quality == top.quality
    };
    ladder.iter().take_while(|rung| is_good(rung)).count() - 1
}
