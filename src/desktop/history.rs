//! The last seconds of frames: what the panel's plot and figures are made of.

use base::percentile::Sorted;
use std::collections::VecDeque;
use std::time::Instant;
use timing::{FrameRow, Phase};

/// Seconds of frames kept.
pub(super) const HISTORY_S: f64 = 5.0;
/// Seconds that the frame rate is counted over.
const RATE_S: f64 = 1.0;
/// Least number of frames that the rate is counted over: slow frames come in bursts, as many at once as may be under
/// way.
const RATE_FRAMES: usize = 8;
/// Most rows kept, whatever their times say: 5 s at 800 Hz.
const MAX_ROWS: usize = 4096;
/// Seconds without a row after which the frames count as stopped, unless [`STALLED_FRAMES`] is longer.
const STALLED_S: f64 = 3.0;
/// Frame times without a row after which the frames count as stopped, unless [`STALLED_S`] is longer.
const STALLED_FRAMES: f64 = 3.0;

/// Rows of the last [`HISTORY_S`], and those before that the frame rate needs; oldest first.
#[derive(Debug, Default)]
pub(super) struct History {
    rows: VecDeque<FrameRow>,
    num_missed: u64,
    last_push: Option<Instant>,
}

/// A time now and over the history, milliseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TimeSummary {
    /// Time of the newest frame.
    pub now_ms: f32,
    /// Median: half of the frames took no longer.
    pub median_ms: f32,
    /// 99th percentile: all frames except one in a hundred took no longer.
    pub p99_ms: f32,
}

impl History {
    /// Takes in a row that arrived at `now`. Frames that were not drawn tell nothing.
    pub(super) fn push(&mut self, row: FrameRow, now: Instant) {
        if row.phase == Phase::Unseen {
            return;
        }
        // A row that is older than the newest one is of another run.
        if self.rows.back().is_some_and(|newest| row.time_s < newest.time_s) {
            self.rows.clear();
        }
        self.num_missed += u64::from(row.missed_periods);
        self.last_push = Some(now);
        self.rows.push_back(row);
        let is_old = |oldest: &FrameRow| row.time_s - oldest.time_s > HISTORY_S;
        while self.rows.len() > MAX_ROWS
            || self.rows.len() > RATE_FRAMES + 1 && self.rows.front().is_some_and(is_old)
        {
            self.rows.pop_front();
        }
    }

    /// The newest row.
    pub(super) fn newest(&self) -> Option<&FrameRow> {
        self.rows.back()
    }

    /// Rows with their age: seconds before the newest one, −[`HISTORY_S`] to 0, oldest first.
    pub(super) fn aged(&self) -> impl DoubleEndedIterator<Item = (f64, &FrameRow)> {
        let newest_s = self.newest().map_or(0.0, |row| row.time_s);
        let aged = self.rows.iter().map(move |row| (row.time_s - newest_s, row));
        aged.filter(|(age_s, _)| *age_s >= -HISTORY_S)
    }

    /// Frames of the scan a second, counted over the last second, or over the last few frames if they take longer.
    /// `None` before there are two frames and once they have stopped.
    pub(super) fn frames_per_second(&self, now: Instant) -> Option<f64> {
        let waited = now.saturating_duration_since(self.last_push?);
        let newest_s = self.newest()?.time_s;
        let is_recent = |row: &FrameRow| newest_s - row.time_s + waited.as_secs_f64() <= RATE_S;
        let of_scan = || self.rows.iter().rev().take_while(|row| row.phase != Phase::Waiting);
        // The time of the counted frames begins with the frame before them, so the first frame of all is not counted.
        let num_frames = of_scan().take_while(|row| is_recent(row)).count().max(RATE_FRAMES);
        let num_frames = num_frames.min(of_scan().count().checked_sub(1)?);
        let took_s = newest_s - of_scan().nth(num_frames)?.time_s;
        let frame_s = took_s / num_frames as f64;
        // A single frame gives NaN.
        if frame_s.is_nan()
            || frame_s <= 0.0
            || waited.as_secs_f64() > STALLED_S.max(STALLED_FRAMES * frame_s)
        {
            return None;
        }
        // The frame that is being drawn counts once it takes longer than the others.
        let with_next = (num_frames + 1) as f64 / (took_s + waited.as_secs_f64());
        Some(frame_s.recip().min(with_next))
    }

    /// True if frames have come, and none has for so long that something keeps them.
    pub(super) fn is_stalled(&self, now: Instant) -> bool {
        self.last_push.is_some_and(|at| now.saturating_duration_since(at).as_secs_f64() > STALLED_S)
    }

    /// Missed display periods since the start.
    pub(super) fn num_missed(&self) -> u64 {
        self.num_missed
    }

    /// GPU time of the whole frame; `None` if the device gives none.
    pub(super) fn gpu(&self) -> Option<TimeSummary> {
        let times = || self.aged().map(|(_, row)| row.gpu_ms).filter(|ms| ms.is_finite());
        let now_ms = times().next_back()?;
        let sorted = Sorted::new(times().map(f64::from));
        let [median_ms, p99_ms] = [sorted.median()?, sorted.percentile(990)?].map(|ms| ms as f32);
        Some(TimeSummary { now_ms, median_ms, p99_ms })
    }

    /// Top of the plot: a multiple of the budget in steps, so that it rests while the frames change little.
    pub(super) fn plot_top_ms(&self) -> f64 {
        let budget_ms = self.newest().map_or(0.0, |row| f64::from(row.budget_ms));
        let budget_ms = if budget_ms.is_finite() && budget_ms > 0.0 { budget_ms } else { 10.0 };
        let longest_ms =
            self.aged().map(|(_, row)| f64::from(row.gpu_ms)).filter(|ms| ms.is_finite()).fold(0.0, f64::max);
        let steps = [1.4, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];
        let wanted = longest_ms * 1.05;
        steps.iter().map(|step| step * budget_ms).find(|top| *top >= wanted).unwrap_or(wanted)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::time::Duration;

    /// A frame at `time_s` that took the GPU `gpu_ms`.
    pub(in crate::desktop) fn row(frame: u64, time_s: f64, gpu_ms: f32) -> FrameRow {
        let stage_ms = [0.05, 0.05, 0.05, 0.6, 0.1, 0.1, 0.05].map(|share| share * gpu_ms);
        FrameRow { frame, time_s, stage_ms, gpu_ms, budget_ms: 11.1, ..FrameRow::sample() }
    }

    fn filled(times_s: impl IntoIterator<Item = f64>) -> History {
        let mut history = History::default();
        for (i, time_s) in times_s.into_iter().enumerate() {
            history.push(row(i as u64, time_s, 5.0), Instant::now());
        }
        history
    }

    #[test]
    fn frames_that_stop_are_stalled() {
        let (mut history, now) = (History::default(), Instant::now());
        assert!(!history.is_stalled(now), "none has come yet");
        history.push(row(0, 0.0, 1.0), now);
        assert!(
            !history.is_stalled(now + Duration::from_secs(2))
                && history.is_stalled(now + Duration::from_secs(4))
        );
    }

    #[test]
    fn only_the_last_seconds_are_kept() {
        let history = filled((0..2000).map(|i| f64::from(i) / 90.0));
        let ages: Vec<f64> = history.aged().map(|(age, _)| age).collect();
        assert!(ages[0] >= -HISTORY_S && ages[0] < -HISTORY_S + 0.02);
        assert_eq!(ages.last(), Some(&0.0));
    }

    #[test]
    fn times_that_stand_still_cannot_fill_memory() {
        assert_eq!(filled(std::iter::repeat_n(1.0, 10_000)).rows.len(), MAX_ROWS);
        assert_eq!(filled(std::iter::repeat_n(f64::NAN, 10_000)).rows.len(), MAX_ROWS);
    }

    #[test]
    fn a_new_run_starts_over() {
        assert_eq!(filled([10.0, 10.1, 0.0]).rows.len(), 1);
    }

    #[test]
    fn the_frame_rate_is_counted_over_a_second() {
        let now = Instant::now();
        let rate = |history: &History| history.frames_per_second(now).unwrap_or(f64::NAN);
        assert!((rate(&filled((0..200).map(|i| f64::from(i) / 90.0))) - 90.0).abs() < 0.1);
        // Frames are slow for a while, then fast: only the last second counts.
        let slow_then_fast =
            (0..20).map(|i| f64::from(i) / 10.0).chain((0..200).map(|i| 2.0 + f64::from(i) / 50.0));
        assert!((rate(&filled(slow_then_fast)) - 50.0).abs() < 0.1);
        assert!((rate(&filled([0.0, 2.5])) - 0.4).abs() < 1e-9, "less than a frame a second");
        assert_eq!(filled([1.0]).frames_per_second(now), None);
        assert_eq!(filled([1.0, 1.0]).frames_per_second(now), None, "no division by zero");
        assert_eq!(filled([1.0, 1.1]).frames_per_second(now + Duration::from_secs(9)), None, "stopped");
    }

    /// Two frames are under way at once: both begin when the two before them have ended.
    #[test]
    fn frames_that_come_in_bursts_are_as_slow_as_they_are() {
        for (in_flight, burst_s) in [(1, 2.0), (2, 4.0), (2, 0.3), (3, 6.0), (2, 60.0)] {
            let times = (0..40).map(|i| f64::from(i / in_flight) * burst_s + 0.05 * f64::from(i % in_flight));
            let (times, truth): (Vec<f64>, _) = (times.collect(), f64::from(in_flight) / burst_s);
            for num in 20..40 {
                let history = filled(times[..num].iter().copied());
                let rate = history.frames_per_second(Instant::now()).expect("frames go on");
                let what = format!("{in_flight} in {burst_s} s: {rate}, after {num}");
                assert!((0.7 * truth..1.4 * truth).contains(&rate), "{what}");
                let ages: Vec<f64> = history.aged().map(|(age_s, _)| age_s).collect();
                assert!(ages.iter().all(|age_s| (-HISTORY_S..=0.0).contains(age_s)), "{what}");
            }
        }
    }

    #[test]
    fn the_frame_rate_is_the_scans_and_falls_while_a_frame_takes_long() {
        let mut history = History::default();
        let began = Instant::now();
        for i in 0..300 {
            let waiting = FrameRow { phase: Phase::Waiting, ..row(i, i as f64 / 60.0, 5.0) };
            history.push(waiting, began);
            assert_eq!(history.frames_per_second(began), None, "a bar is no scan");
        }
        for (i, time_s) in [5.0, 7.0, 9.0].into_iter().enumerate() {
            history.push(row(300 + i as u64, time_s, 2000.0), began);
        }
        assert_eq!(history.frames_per_second(began), Some(0.5));
        let history = filled((0..200).map(|i| f64::from(i) / 90.0));
        let after = |seconds: f64| {
            let now = history.last_push.expect("rows") + Duration::from_secs_f64(seconds);
            history.frames_per_second(now)
        };
        let rates = [0.005, 0.02, 0.5, 1.0, 2.9].map(|seconds| after(seconds).expect("not yet stopped"));
        assert!(rates.is_sorted_by(|a, b| a > b), "{rates:?}");
        assert!(rates[0] > 89.0 && (40.0..50.0).contains(&rates[2]) && rates[4] < 4.0, "{rates:?}");
        assert_eq!(after(3.1), None);
    }

    #[test]
    fn percentiles_are_of_the_frames_that_have_a_time() {
        let mut history = History::default();
        for i in 1..=200u32 {
            history.push(row(u64::from(i), f64::from(i) / 90.0, (i % 200) as f32), Instant::now());
        }
        history.push(row(201, 2.3, f32::NAN), Instant::now());
        let spread = history.gpu();
        assert_eq!(spread, Some(TimeSummary { now_ms: 0.0, median_ms: 99.5, p99_ms: 197.0 }));
        let mut silent = History::default();
        silent.push(row(0, 0.0, f32::NAN), Instant::now());
        assert_eq!(silent.gpu(), None);
    }

    #[test]
    fn the_plots_top_rests_on_steps_of_the_budget() {
        let top = |gpu_ms: f32| {
            let mut history = History::default();
            history.push(row(0, 0.0, gpu_ms), Instant::now());
            history.plot_top_ms() / f64::from(11.1f32)
        };
        for (gpu_ms, steps) in [(1.0, 1.4), (14.0, 1.4), (15.5, 2.0), (400.0, 50.0), (f32::NAN, 1.4)] {
            assert!((top(gpu_ms) - steps).abs() < 1e-6, "{gpu_ms}");
        }
        assert!(top(1e6) * 11.1 > 1e6);
    }

    #[test]
    fn misses_add_up() {
        let mut history = History::default();
        for missed_periods in [0, 2, 1] {
            history.push(FrameRow { missed_periods, ..row(0, 0.0, 1.0) }, Instant::now());
        }
        assert_eq!(history.num_missed(), 3);
    }
}
