//! Figures of a frame log: percentiles, frames over budget, missed periods, the costliest stage.

use super::table::{TextTable, ms, percent};
use base::percentile::{REPORTED_PER_MILLE, Sorted};
use base::words::counted;
use std::fmt;
use timing::{CallTimes, FrameLogFile, LoggedFrame, Phase};

/// A frame log in figures; its `Display` is the text for people, and the page has the same.
#[derive(Clone, Debug)]
pub struct Summary {
    /// The log's facts, name and value.
    pub facts: Vec<(String, String)>,
    /// The phases that the log has, in order.
    pub phases: Vec<PhaseFigures>,
    /// The phase that all figures below are of; see [`FrameLogFile::counted_phase`].
    pub counted_phase: Phase,
    /// Frames of that phase.
    pub num_frames: usize,
    /// Seconds from the first of these frames to the last.
    pub duration_s: f64,
    /// Smallest and largest budget: they differ where the refresh rate changed.
    pub budget_ms: (f64, f64),
    /// Frames whose GPU time exceeded their budget.
    pub num_over_budget: usize,
    /// Display periods without a new image.
    pub missed_periods: u64,
    /// Rows that the writer had no room for.
    pub num_dropped: u64,
    /// The log's last line was cut off.
    pub cut_off: bool,
    /// GPU milliseconds of the whole frame.
    pub gpu_ms: Sorted,
    /// GPU milliseconds of each stage.
    pub stages_ms: Vec<(String, Sorted)>,
    /// CPU milliseconds: wait, record, submit.
    pub cpu_ms: [(&'static str, Sorted); 3],
    /// Milliseconds of the headset's calls, of those that the log has.
    pub calls_ms: Vec<(&'static str, Sorted)>,
}

/// Frames of one phase.
#[derive(Clone, Debug)]
pub struct PhaseFigures {
    /// The phase.
    pub phase: Phase,
    /// Number of its frames.
    pub num_frames: usize,
    /// Frames whose GPU time exceeded their budget.
    pub num_over_budget: usize,
    /// Display periods without a new image.
    pub missed_periods: u64,
}

impl PhaseFigures {
    /// Figures of a phase; `None` if the log has no frame of it.
    fn of(log: &FrameLogFile, phase: Phase) -> Option<Self> {
        let mut figures = Self { phase, num_frames: 0, num_over_budget: 0, missed_periods: 0 };
        for frame in log.frames.iter().filter(|frame| frame.phase == phase) {
            figures.num_frames += 1;
            figures.num_over_budget += usize::from(frame.over_budget);
            figures.missed_periods = figures.missed_periods.saturating_add(frame.missed_periods);
        }
        (figures.num_frames > 0).then_some(figures)
    }

    fn in_words(&self) -> String {
        let Self { phase, num_frames, num_over_budget, missed_periods } = self;
        let when = match phase {
            Phase::Unseen => {
                let frames = counted(num_frames, "frame");
                return format!(
                    "{frames} that the runtime wanted undrawn, since nobody would see them; not counted below"
                );
            }
            Phase::Waiting => "before the scan was shown",
            Phase::Arriving => "while the scan was being built beside them",
            Phase::Walking => "of the walk",
        };
        format!(
            "{} {when}: {num_over_budget} over budget, {} missed; not counted below",
            counted(num_frames, "frame"),
            counted(missed_periods, "display period")
        )
    }
}

impl Summary {
    /// Summarizes a log.
    #[must_use]
    pub fn of(log: &FrameLogFile) -> Self {
        let sorted = |value: &dyn Fn(&LoggedFrame) -> f64| Sorted::new(log.counted().map(value));
        let budgets = sorted(&|frame| frame.budget_ms);
        let time = |frame: Option<&LoggedFrame>| frame.map_or(0.0, |frame| frame.time_s);
        let phases: Vec<_> =
            Phase::ALL.into_iter().filter_map(|phase| PhaseFigures::of(log, phase)).collect();
        let counted_phase = log.counted_phase();
        let counted = phases.iter().find(|figures| figures.phase == counted_phase);
        let stages = log.stages.iter().enumerate();
        Self {
            facts: log.facts.clone(),
            counted_phase,
            num_frames: counted.map_or(0, |figures| figures.num_frames),
            duration_s: time(log.counted().last()) - time(log.counted().next()),
            budget_ms: (
                budgets.percentile(0).unwrap_or_default(),
                budgets.percentile(1000).unwrap_or_default(),
            ),
            num_over_budget: counted.map_or(0, |figures| figures.num_over_budget),
            missed_periods: counted.map_or(0, |figures| figures.missed_periods),
            phases,
            num_dropped: log.num_dropped,
            cut_off: log.cut_off,
            gpu_ms: sorted(&|frame| frame.gpu_ms),
            stages_ms: stages.map(|(at, name)| (name.clone(), sorted(&|frame| frame.stage_ms[at]))).collect(),
            cpu_ms: [
                ("wait", sorted(&|frame| frame.cpu_ms[0])),
                ("record", sorted(&|frame| frame.cpu_ms[1])),
                ("submit", sorted(&|frame| frame.cpu_ms[2])),
            ],
            calls_ms: calls_ms(log),
        }
    }

    /// The stage that took most GPU time in all, and its part of all stages' time, 0 to 1.
    #[must_use]
    pub fn costliest(&self) -> Option<(&str, f64)> {
        let total: f64 = self.stages_ms.iter().map(|(_, times)| times.sum()).sum();
        let costliest = self.stages_ms.iter().max_by(|(_, a), (_, b)| a.sum().total_cmp(&b.sum()))?;
        (total > 0.0).then(|| (costliest.0.as_str(), costliest.1.sum() / total))
    }

    /// Figures that are counted rather than timed, name and value.
    pub(super) fn counts(&self) -> Vec<(&'static str, String)> {
        let Self { num_frames, duration_s, budget_ms: (low, high), .. } = *self;
        let rate = match duration_s > 0.0 {
            true => format!(", {:.1} a second", (num_frames.saturating_sub(1)) as f64 / duration_s),
            false => String::new(),
        };
        let others = self.phases.iter().filter(|figures| figures.phase != self.counted_phase);
        let mut counts: Vec<_> = others.map(|figures| (figures.phase.name(), figures.in_words())).collect();
        let which = match self.counted_phase {
            Phase::Waiting => ": the log ends before a scan was shown",
            Phase::Arriving => ": the log ends while the scan was being built",
            Phase::Walking | Phase::Unseen => "",
        };
        counts.push(("frames", format!("{num_frames} in {duration_s:.1} s{rate}{which}")));
        if self.num_dropped > 0 {
            counts.push((
                "dropped",
                format!("{}: the disk did not keep up", counted(self.num_dropped, "more row")),
            ));
        }
        if self.cut_off {
            counts.push(("cut off", "the last line, which is left out".into()));
        }
        if num_frames > 0 {
            let most = if low == high { String::new() } else { format!(" to {high:.2}") };
            counts.push(("budget", format!("{low:.2}{most} ms")));
            let share = percent(self.num_over_budget as f64, num_frames as f64);
            counts.push(("over", format!("{}, {share}", counted(self.num_over_budget, "frame"))));
            counts.push(("missed", counted(self.missed_periods, "display period")));
        }
        counts
    }

    /// Table of the percentiles of all times.
    pub(super) fn times(&self) -> TextTable {
        let mut table = TextTable::new(["ms", "50 %", "90 %", "99 %", "99.9 %", "max"]);
        let mut row = |name: String, times: &Sorted| {
            table.row(name, REPORTED_PER_MILLE.map(|per_mille| ms(times.percentile(per_mille))));
        };
        row("GPU".into(), &self.gpu_ms);
        for (stage, times) in &self.stages_ms {
            row(format!("  {stage}"), times);
        }
        for (step, times) in &self.cpu_ms {
            row(format!("CPU {step}"), times);
        }
        for (call, times) in &self.calls_ms {
            row(format!("  {}", call.replace('_', " ")), times);
        }
        table
    }

    /// Where most of the GPU's time goes, in a sentence without its first word.
    pub(super) fn costliest_in_words(&self) -> Option<String> {
        let (stage, part) = self.costliest()?;
        Some(format!("{stage}, {:.0} % of the stages' GPU time", 100.0 * part))
    }

    /// Top of a plot of GPU times, in milliseconds: past the budget and past nearly all frames, so that a few very long
    /// ones (one in a hundred, in a short log) do not flatten all others.
    pub(super) fn plotted_ms(&self) -> f64 {
        let of = |per_mille| self.gpu_ms.percentile(per_mille).unwrap_or_default();
        let budget_ms = self.budget_ms.1;
        let nearly_all = (1.1 * of(999)).min(2.0 * of(900));
        nearly_all.max(1.5 * budget_ms).min((1.05 * of(1000)).max(1.2 * budget_ms))
    }
}

/// Times of the headset's calls, of those that a log has.
fn calls_ms(log: &FrameLogFile) -> Vec<(&'static str, Sorted)> {
    let times = |at: usize| log.counted().map(move |frame| frame.call_ms[at]).filter(|ms| ms.is_finite());
    let named = CallTimes::NAMES.into_iter().enumerate();
    named
        .filter(|(at, _)| times(*at).next().is_some())
        .map(|(at, name)| (name, Sorted::new(times(at))))
        .collect()
}

/// Sentence about a log without GPU times.
pub(super) const NO_GPU_TIMES: &str = "The log has no GPU times: the device gave no timestamps.";

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, value) in &self.facts {
            writeln!(f, "{name:<11} {value}")?;
        }
        for (name, figure) in self.counts() {
            writeln!(f, "{name:<11} {figure}")?;
        }
        if self.num_frames == 0 {
            return Ok(());
        }
        write!(f, "\n{}\n", self.times())?;
        match self.costliest_in_words() {
            Some(words) => writeln!(f, "costliest   {words}"),
            None => writeln!(f, "{NO_GPU_TIMES}"),
        }
    }
}
