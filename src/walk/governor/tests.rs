//! The governor against scripted loads: frames that take as long as a model says, with noise, whose times come
//! back three frames late.

use super::ladder::RESOLUTION_SCALES;
use super::*;
use kit::frames::sample_options;
use render::options::Quality;
use std::collections::VecDeque;

const PERIOD_MS: f32 = 1000.0 / 90.0;
const TARGET_MS: f32 = 0.8 * PERIOD_MS;
/// Largest load, in times of the target, that the cheapest rung still bears, if not within the target.
const BEARABLE: f32 = 14.0;
/// Frames until a frame's time is known.
const LATENCY: usize = 3;

/// What a frame costs: milliseconds at full quality.
#[derive(Clone, Copy, Debug)]
struct ScriptedLoad {
    base: f32,
    points: f32,
    pixels: f32,
    /// Share of the time of points and pixels that `hqs` adds.
    hqs: f32,
}

impl ScriptedLoad {
    /// A load with the usual shares, `times` as large as the target.
    fn of(times: f32) -> Self {
        let whole = times * TARGET_MS;
        Self { base: 0.1 * whole, points: 0.4 * whole, pixels: 0.2 * whole, hqs: 0.5 }
    }

    fn ms(&self, settings: &Settings) -> f32 {
        let points = self.points / settings.lod_scale.powi(2);
        let pixels = self.pixels * settings.resolution_scale.powi(2);
        let shading = if settings.quality == Quality::Hqs { 1.0 + self.hqs } else { 1.0 };
        self.base + (points + pixels) * shading
    }
}

/// A governor that decides about settings, be it naive.
trait Decides {
    fn begin(&mut self, frame: u64) -> Settings;
    fn observe(&mut self, frame: u64, phase: Phase, gpu_ms: f32, budget_ms: f32) -> Option<RungChange>;
}

impl Decides for Governor {
    fn begin(&mut self, frame: u64) -> Settings {
        self.begin(frame)
    }
    fn observe(&mut self, frame: u64, phase: Phase, gpu_ms: f32, budget_ms: f32) -> Option<RungChange> {
        self.observe(frame, phase, gpu_ms, budget_ms)
    }
}

/// A governor without dead band, patience or memory, whatever a frame shows: it goes down a rung when too slow, and
/// up when not.
struct Naive(Governor);

impl Decides for Naive {
    fn begin(&mut self, _frame: u64) -> Settings {
        self.0.settings()
    }
    fn observe(&mut self, _frame: u64, _phase: Phase, gpu_ms: f32, budget_ms: f32) -> Option<RungChange> {
        let Self(Governor { at, ladder, options, .. }) = self;
        let target_ms = options.budget * budget_ms;
        let from = ladder[*at].settings;
        *at = if gpu_ms > target_ms { (*at + 1).min(ladder.len() - 1) } else { at.saturating_sub(1) };
        let to = ladder[*at].settings;
        let why = if gpu_ms > target_ms { Why::TooSlow } else { Why::Room };
        (from != to).then_some(RungChange { from, to, gpu_ms, target_ms, why })
    }
}

/// A walk: frames go by, their times come back late.
struct ScriptedWalk<D> {
    governor: D,
    frame: u64,
    /// What frames show from now on.
    phase: Phase,
    in_flight: VecDeque<(u64, Phase, f32)>,
    /// Steps, each with the frame at which it happened.
    steps: Vec<(u64, RungChange)>,
    random: u64,
    /// Share by which a frame's time is off.
    noise: f32,
}

impl<D: Decides> ScriptedWalk<D> {
    fn new(governor: D, noise: f32, seed: u64) -> Self {
        let random = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let phase = Phase::Walking;
        Self { governor, frame: 0, phase, in_flight: VecDeque::new(), steps: Vec::new(), random, noise }
    }

    /// A random number from −1 to 1.
    fn random(&mut self) -> f32 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    /// Draws one frame, which takes what `ms` makes of its settings and number; returns its true time.
    fn frame(&mut self, ms: impl FnOnce(&Settings, u64) -> f32) -> f32 {
        let settings = self.governor.begin(self.frame);
        let true_ms = ms(&settings, self.frame);
        let measured_ms = true_ms * (1.0 + self.noise * self.random());
        self.in_flight.push_back((self.frame, self.phase, measured_ms));
        if self.in_flight.len() > LATENCY
            && let Some((frame, phase, gpu_ms)) = self.in_flight.pop_front()
            && let Some(step) = self.governor.observe(frame, phase, gpu_ms, PERIOD_MS)
        {
            self.steps.push((self.frame, step));
        }
        self.frame += 1;
        true_ms
    }

    /// Draws `frames` frames under one load; returns the last frame's true time.
    fn under(&mut self, load: ScriptedLoad, frames: usize) -> f32 {
        (0..frames).map(|_| self.frame(|settings, _| load.ms(settings))).last().unwrap()
    }

    fn steps_since(&self, frame: u64) -> usize {
        self.steps.iter().filter(|(at, _)| *at >= frame).count()
    }
}

const OPTIONS: GovernorOptions = GovernorOptions::sample();

fn governor() -> Governor {
    governor_of(Quality::Hqs)
}

/// A governor that is asked for `quality`.
fn governor_of(quality: Quality) -> Governor {
    Governor::new(OPTIONS, &drawn_in(quality))
}

fn drawn_in(quality: Quality) -> DrawOptions {
    DrawOptions { quality, ..sample_options() }
}

/// A governor of a cloud that has no level of detail.
fn flat() -> Governor {
    let mut governor = governor();
    governor.restart(false);
    governor
}

fn calm(governor: Governor) -> ScriptedWalk<Governor> {
    ScriptedWalk::new(governor, 0.0, 1)
}

fn noisy(seed: u64) -> ScriptedWalk<Governor> {
    ScriptedWalk::new(governor(), 0.1, seed)
}

const BEST: Settings = Settings { lod_scale: 1.0, resolution_scale: 1.0, quality: Quality::Hqs };
const GOOD: Settings = Settings { lod_scale: 1.99, ..BEST };
const CHEAPEST: Settings = Settings { lod_scale: 3.0, resolution_scale: 0.6, quality: Quality::Closest };

#[test]
fn half_the_load_costs_nothing() {
    let mut run = noisy(1);
    run.under(ScriptedLoad::of(0.5), 3000);
    assert!(run.steps.is_empty());
    assert_eq!(run.governor.settings(), BEST);
}

#[test]
fn overload_is_gone_within_a_second() {
    for times in [1.5, 3.0] {
        for seed in 1..=8 {
            let mut run = noisy(seed);
            run.under(ScriptedLoad::of(times), 90);
            let ms = run.under(ScriptedLoad::of(times), 1);
            assert!(ms <= TARGET_MS, "{times}: {ms} ms, {:?}", run.steps);
            // The first step came at once: after some frames for the times to return, and some to be sure.
            assert!(run.steps[0].0 < 10, "{:?}", run.steps);
            assert!(run.steps.iter().take_while(|(_, step)| step.is_down()).count() <= 6);
        }
    }
    // More overload leads to bigger steps.
    let first = |times| {
        let mut run = calm(governor());
        run.under(ScriptedLoad::of(times), 20);
        run.steps[0].1.to.lod_scale
    };
    assert!(first(1.1) < first(1.5) && first(1.5) < first(3.0));
}

#[test]
fn overload_beyond_the_target_ends_at_the_cheapest() {
    let mut run = noisy(3);
    run.under(ScriptedLoad::of(BEARABLE), 3000);
    assert_eq!(run.governor.settings(), CHEAPEST);
    assert!(run.steps.len() <= 8, "{:?}", run.steps);
}

/// If even the cheapest rung makes a slide show, its slides are to be good ones.
#[test]
fn hopeless_overload_leaves_a_good_picture() {
    for times in [20.0, 30.0, 100.0, 1000.0] {
        let mut run = noisy(3);
        run.under(ScriptedLoad::of(times), 3000);
        assert_eq!(run.governor.settings(), GOOD, "{times}: {:?}", run.steps);
        assert!(run.steps.len() <= 8, "{times}: {:?}", run.steps);
        let last = run.steps.last().unwrap();
        assert_eq!(last.1.why, Why::Hopeless);
        assert!(last.0 < 100, "{times}: settled at frame {}", last.0);
        let mut naive = ScriptedWalk::new(Naive(governor()), 0.1, 3);
        naive.under(ScriptedLoad::of(times), 3000);
        assert_eq!(naive.governor.0.settings(), CHEAPEST, "the comparison can fail");
    }
    let mut flat = calm(flat());
    flat.under(ScriptedLoad::of(100.0), 1000);
    assert_eq!(flat.governor.settings(), BEST, "every rung below blurs");
}

#[test]
fn a_load_that_was_hopeless_is_tried_again_when_it_is_less() {
    for seed in 1..=4 {
        let mut run = noisy(seed);
        run.under(ScriptedLoad::of(50.0), 1000);
        run.under(ScriptedLoad::of(BEARABLE), 500);
        assert_eq!(run.governor.settings(), CHEAPEST, "{:?}", run.steps);
        run.under(ScriptedLoad::of(50.0), 500);
        assert_eq!(run.governor.settings(), GOOD, "{:?}", run.steps);
        run.under(ScriptedLoad::of(3.0), 500);
        assert!(
            run.governor.settings() != GOOD && run.under(ScriptedLoad::of(3.0), 1) <= TARGET_MS,
            "{:?}",
            run.steps
        );
        run.under(ScriptedLoad::of(80.0), 500);
        run.under(ScriptedLoad::of(0.3), 1500);
        assert_eq!(run.governor.settings(), BEST, "{:?}", run.steps);
    }
}

/// A start as a software driver has it: slow frames without a scan while it is read, slower ones while its octree is
/// built on the same processor, then the walk.
#[test]
fn frames_before_the_walk_do_not_count() {
    fn started<D: Decides>(mut run: ScriptedWalk<D>) -> ScriptedWalk<D> {
        for (phase, times, frames) in [(Phase::Waiting, 5.0, 200), (Phase::Arriving, 30.0, 300)] {
            run.phase = phase;
            run.under(ScriptedLoad::of(times), frames);
        }
        run.phase = Phase::Walking;
        run
    }
    let mut run = started(noisy(1));
    assert!(run.steps.is_empty() && run.governor.settings() == BEST, "{:?}", run.steps);
    run.governor.restart(true);
    run.under(ScriptedLoad::of(0.6), 1000);
    assert!(run.steps.is_empty(), "{:?}", run.steps);
    assert_eq!(started(ScriptedWalk::new(Naive(governor()), 0.1, 1)).governor.0.settings(), CHEAPEST);
    // The governor acts from then on.
    run.under(ScriptedLoad::of(3.0), 200);
    assert!(!run.steps.is_empty());
}

/// If there is no room for the octree, the flat cloud stays, which has no detail to give up.
#[test]
fn a_cloud_without_detail_has_fewer_rungs() {
    let mut run = calm(governor());
    run.under(ScriptedLoad::of(BEARABLE), 100);
    assert_eq!(run.governor.settings(), CHEAPEST);
    run.governor.restart(false);
    assert_eq!(run.governor.settings(), BEST, "what another cloud made it give up is back");
    let steps_before = run.steps.len();
    run.under(ScriptedLoad::of(1.5), 300);
    let steps = &run.steps[steps_before..];
    assert!(steps[0].1.to.resolution_scale < 1.0, "{steps:?}");
    assert!(steps.iter().all(|(_, step)| step.to.lod_scale == 1.0), "{steps:?}");
}

/// Most steps in 2000 frames that do not count as oscillation.
const STEADY: usize = 8;

/// Steps in the 2000 frames after the first 1000.
fn steps_when_settled<D: Decides>(mut run: ScriptedWalk<D>, load: ScriptedLoad) -> usize {
    run.under(load, 1000);
    run.under(load, 2000);
    run.steps_since(1000)
}

#[test]
fn a_steady_load_is_left_alone() {
    let usual = (5..60).map(|tenths| 0.1 * tenths as f32);
    for times in usual.chain([8.0, 10.0, 12.0, 14.0, 16.0, 17.0, 18.0, 19.0, 20.0, 25.0, 50.0, 200.0]) {
        for seed in 1..=4 {
            let steps = steps_when_settled(noisy(seed), ScriptedLoad::of(times));
            assert!(steps <= STEADY, "{times} times the target: {steps} steps");
        }
    }
    // A governor without dead band is noticed.
    for tenths in [11, 15, 30] {
        let naive = ScriptedWalk::new(Naive(governor()), 0.1, 1);
        let steps = steps_when_settled(naive, ScriptedLoad::of(0.1 * tenths as f32));
        assert!(steps > 10 * STEADY, "{steps}");
    }
}

/// A step up fails again and again where a rung saves more than expected, so it is tried ever more seldom.
#[test]
fn steps_up_that_fail_become_seldom() {
    // All of `cliff`'s time that can be saved is in the points, and its quality costs much more than expected.
    let cliff =
        ScriptedLoad { base: 0.2 * TARGET_MS, points: 4.0 * TARGET_MS, pixels: 0.1 * TARGET_MS, hqs: 6.0 };
    let points = ScriptedLoad { base: 0.0, points: 2.5 * TARGET_MS, pixels: 0.0, hqs: 0.0 };
    for load in [cliff, points] {
        let mut run = noisy(5);
        run.under(load, 10_000);
        let fails: Vec<u64> =
            run.steps.windows(2).filter(|w| !w[0].1.is_down() && w[1].1.is_down()).map(|w| w[1].0).collect();
        assert!(fails.len() <= 8, "{fails:?}");
        assert!(run.steps_since(5000) <= 8, "{:?}", run.steps);
    }
}

#[test]
fn all_is_given_back_when_the_load_is_gone_but_slower_than_it_was_taken() {
    for seed in 1..=4 {
        let mut run = noisy(seed);
        run.under(ScriptedLoad::of(BEARABLE), 500);
        let taken = run.steps.iter().rfind(|(_, step)| step.to == CHEAPEST).expect("it took all").0;
        run.under(ScriptedLoad::of(0.3), 1500);
        assert_eq!(run.governor.settings(), BEST, "{:?}", run.steps);
        let given_back = run.steps.last().unwrap().0 - 500;
        assert!(given_back > 4 * taken, "taken in {taken} frames, given back in {given_back}");
        let mut again = run.steps.iter().filter(|(at, _)| *at > 500);
        assert!(again.all(|(_, step)| !step.is_down()));
    }
}

/// As much as fits is given back, even where the rungs in between save next to nothing.
#[test]
fn what_saves_nothing_is_given_back() {
    let after = |base| ScriptedLoad { base, points: 0.02 * TARGET_MS, pixels: 0.02 * TARGET_MS, hqs: 0.1 };
    let mut run = calm(governor());
    run.under(ScriptedLoad::of(BEARABLE), 500);
    run.under(after(0.6 * TARGET_MS), 3000);
    assert_eq!(run.governor.settings(), BEST, "{:?}", run.steps.last());
    let mut run = calm(governor_of(Quality::Closest));
    run.under(ScriptedLoad::of(BEARABLE), 500);
    run.under(after(0.85 * TARGET_MS), 5000);
    assert_eq!(run.governor.settings(), Settings { quality: Quality::Closest, ..BEST }, "{:?}", run.steps);
}

#[test]
fn spikes_do_nothing() {
    let mut run = noisy(2);
    for _ in 0..2000 {
        run.frame(|settings, frame| {
            let usual = ScriptedLoad::of(0.85).ms(settings);
            if frame % 10 == 7 { 5.0 * usual } else { usual }
        });
    }
    assert!(run.steps.is_empty(), "{:?}", run.steps);
    // Spikes that are the rule count.
    for _ in 0..100 {
        run.frame(|settings, frame| {
            ScriptedLoad::of(0.85).ms(settings) * if frame % 2 == 1 { 5.0 } else { 1.0 }
        });
    }
    assert!(!run.steps.is_empty());
}

#[test]
fn times_that_are_not_known_do_nothing() {
    for unknown in [f32::NAN, f32::INFINITY] {
        let mut run = calm(governor());
        for _ in 0..500 {
            run.frame(|_, _| unknown);
        }
        assert!(run.steps.is_empty());
        // Unknown times between known ones are passed over.
        for _ in 0..100 {
            run.frame(
                |settings, frame| if frame % 2 == 0 { unknown } else { ScriptedLoad::of(3.0).ms(settings) },
            );
        }
        assert!(!run.steps.is_empty());
        assert!(run.steps.iter().all(|(_, step)| step.gpu_ms.is_finite()));
    }
    let mut governor = governor();
    for frame in 0..100 {
        governor.begin(frame);
        assert_eq!(governor.observe(frame, Phase::Walking, 50.0, f32::NAN), None);
        assert_eq!(governor.observe(frame, Phase::Walking, 50.0, 0.0), None);
    }
}

#[test]
fn frames_of_other_settings_do_not_count() {
    let mut governor = governor();
    let step = |governor: &mut Governor, frames: std::ops::Range<u64>| {
        frames.filter_map(|frame| governor.observe(frame, Phase::Walking, 20.0, PERIOD_MS)).count()
    };
    for frame in 0..20 {
        governor.begin(frame);
    }
    // Twenty frames are on their way when the times of the first come back: they lead to one step, not four.
    assert_eq!(step(&mut governor, 0..20), 1);
    governor.begin(20);
    assert_eq!(step(&mut governor, 20..20 + ENOUGH as u64), 1);
}

#[test]
fn the_order_is_level_of_detail_then_resolution_then_closest_and_back() {
    let mut run = calm(governor());
    // The load grows slowly, so that every rung is seen, and shrinks again.
    for frame in 0..2700 {
        let times = 0.5 + 0.005 * frame as f32;
        run.frame(|settings, _| ScriptedLoad::of(times).ms(settings));
    }
    assert_eq!(run.governor.settings(), CHEAPEST);
    run.under(ScriptedLoad::of(0.1), 2000);
    assert_eq!(run.governor.settings(), BEST);
    let mut previous = BEST;
    for (_, RungChange { from, to, .. }) in &run.steps {
        assert_eq!(*from, previous);
        for settings in [from, to] {
            assert!(settings.resolution_scale == 1.0 || settings.lod_scale == 3.0, "{settings:?}");
            assert!(settings.quality == Quality::Hqs || settings.resolution_scale == 0.6, "{settings:?}");
        }
        previous = *to;
    }
    let resolutions: Vec<f32> = run.steps.iter().map(|(_, step)| step.to.resolution_scale).collect();
    assert!(RESOLUTION_SCALES.iter().all(|scale| resolutions.contains(scale)), "{resolutions:?}");
}

#[test]
fn what_is_off_is_skipped() {
    let mut flat = calm(flat());
    flat.under(ScriptedLoad::of(1.5), 300);
    assert!(flat.steps.iter().all(|(_, step)| step.to.lod_scale == 1.0) && !flat.steps.is_empty());
    assert!(flat.steps[0].1.to.resolution_scale < 1.0);
    let mut closest = calm(governor_of(Quality::Closest));
    closest.under(ScriptedLoad::of(BEARABLE), 1000);
    assert_eq!(closest.governor.settings(), CHEAPEST);
    assert!(closest.steps.iter().all(|(_, step)| step.from.quality == Quality::Closest));
    let mut off = calm(Governor::new(GovernorOptions { enabled: false, ..OPTIONS }, &drawn_in(Quality::Hqs)));
    off.under(ScriptedLoad::of(50.0), 1000);
    assert!(off.steps.is_empty() && off.governor.settings() == BEST);
}

/// The top is what the draw options ask for, and no rung below it may be dearer.
#[test]
fn the_top_is_what_is_drawn_and_no_rung_is_dearer() {
    for quality in [Quality::Closest, Quality::Hqs] {
        let mut run = calm(governor_of(quality));
        assert_eq!(run.governor.settings().quality, quality);
        run.under(ScriptedLoad::of(10.0), 500);
        assert!(!run.steps.is_empty());
        let dearer =
            |step: &RungChange| step.from.quality == Quality::Closest && step.to.quality == Quality::Hqs;
        assert!(!run.steps.iter().any(|(_, step)| dearer(step)), "{quality:?}: {:?}", run.steps);
        run.governor.restart(true);
        assert_eq!(run.governor.settings().quality, quality, "a new walk begins at the top too");
    }
}

#[test]
fn images_shrink_to_even_sizes() {
    let scaled = |resolution_scale| Settings { resolution_scale, ..BEST };
    assert_eq!(scaled(1.0).drawn_px([1441, 1601]), [1441, 1601], "all of it, odd or not");
    assert_eq!(scaled(0.6).drawn_px([1440, 1600]), [864, 960]);
    for scale in RESOLUTION_SCALES {
        for full in [[2468, 2740], [1441, 1601], [3, 2], [1, 1]] {
            let drawn = scaled(scale).drawn_px(full);
            for (drawn, full) in drawn.into_iter().zip(full) {
                assert!(drawn <= full && drawn >= 1 && (drawn % 2 == 0 || full == 1), "{drawn} of {full}");
            }
        }
    }
}

#[test]
fn steps_say_why() {
    let to = Settings { lod_scale: 1.32, ..BEST };
    let down = RungChange { from: BEST, to, gpu_ms: 13.2, target_ms: 8.889, why: Why::TooSlow };
    let sentence = "frames take 13.20 ms of the GPU, more than the 8.89 ms aimed at: LOD scale 1 → 1.32";
    assert_eq!(down.to_string(), sentence);
    let up = RungChange {
        from: CHEAPEST,
        to: Settings { quality: Quality::Hqs, ..CHEAPEST },
        gpu_ms: 3.0,
        why: Why::Room,
        ..down
    };
    assert!(up.to_string().ends_with("with room to spare in the 8.89 ms aimed at: quality closest → hqs"));
}
