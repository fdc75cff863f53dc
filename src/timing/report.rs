//! What a frame log says: percentiles, frames over budget, missed periods, the stage that costs.

use super::percentile::{REPORTED_PER_MILLE, Sorted};
use super::read::{FrameLogFile, LoggedFrame};
use std::fmt;

/// A summary of a frame log; its `Display` is the text for people.
#[derive(Clone, Debug)]
pub struct Report {
    /// The log's facts, name and value.
    pub facts: Vec<(String, String)>,
    /// Rows in the log.
    pub num_frames: usize,
    /// From the first row to the last.
    pub duration_s: f64,
    /// Smallest and largest budget: they differ where the refresh rate changed.
    pub budget_ms: (f64, f64),
    /// Rows whose GPU time exceeded their budget.
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
}

impl Report {
    /// Summarises a log.
    #[must_use]
    pub fn of(log: &FrameLogFile) -> Self {
        let frames = &log.frames;
        let sorted = |value: &dyn Fn(&LoggedFrame) -> f64| Sorted::new(frames.iter().map(value));
        let budgets = sorted(&|frame| frame.budget_ms);
        let time = |frame: Option<&LoggedFrame>| frame.map_or(0.0, |frame| frame.time_s);
        let stages = log.stages.iter().enumerate();
        Self {
            facts: log.facts.clone(),
            num_frames: frames.len(),
            duration_s: time(frames.last()) - time(frames.first()),
            budget_ms: (
                budgets.percentile(0).unwrap_or_default(),
                budgets.percentile(1000).unwrap_or_default(),
            ),
            num_over_budget: frames.iter().filter(|frame| frame.over_budget).count(),
            missed_periods: frames.iter().fold(0, |sum, frame| frame.missed_periods.saturating_add(sum)),
            num_dropped: log.num_dropped,
            cut_off: log.cut_off,
            gpu_ms: sorted(&|frame| frame.gpu_ms),
            stages_ms: stages.map(|(at, name)| (name.clone(), sorted(&|frame| frame.stage_ms[at]))).collect(),
            cpu_ms: [
                ("wait", sorted(&|frame| frame.cpu_ms[0])),
                ("record", sorted(&|frame| frame.cpu_ms[1])),
                ("submit", sorted(&|frame| frame.cpu_ms[2])),
            ],
        }
    }

    /// The stage that took most GPU time in all, and its part of all stages' time, 0 to 1.
    #[must_use]
    pub fn costliest(&self) -> Option<(&str, f64)> {
        let total: f64 = self.stages_ms.iter().map(|(_, times)| times.sum()).sum();
        let costliest = self.stages_ms.iter().max_by(|(_, a), (_, b)| a.sum().total_cmp(&b.sum()))?;
        (total > 0.0).then(|| (costliest.0.as_str(), costliest.1.sum() / total))
    }

    fn write_counts(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { num_frames, duration_s, budget_ms: (low, high), .. } = *self;
        write!(f, "frames      {num_frames} in {duration_s:.1} s")?;
        if duration_s > 0.0 {
            write!(f, ", {:.1} a second", (num_frames.saturating_sub(1)) as f64 / duration_s)?;
        }
        writeln!(f)?;
        if self.num_dropped > 0 {
            writeln!(f, "dropped     {} more rows: the disk did not keep up", self.num_dropped)?;
        }
        if self.cut_off {
            writeln!(f, "cut off     the last line, which is left out")?;
        }
        if num_frames == 0 {
            return Ok(());
        }
        if low == high {
            writeln!(f, "budget      {low:.2} ms")?;
        } else {
            writeln!(f, "budget      {low:.2} to {high:.2} ms")?;
        }
        let percent = 100.0 * self.num_over_budget as f64 / num_frames as f64;
        writeln!(f, "over        {} frames, {percent:.2} %", self.num_over_budget)?;
        writeln!(f, "missed      {} display periods", self.missed_periods)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, value) in &self.facts {
            writeln!(f, "{name:<11} {value}")?;
        }
        self.write_counts(f)?;
        if self.num_frames == 0 {
            return Ok(());
        }
        writeln!(f, "\n{:<12}{:>9}{:>9}{:>9}{:>9}{:>9}", "ms", "50 %", "90 %", "99 %", "99.9 %", "max")?;
        write_times(f, "GPU", &self.gpu_ms)?;
        for (stage, times) in &self.stages_ms {
            write_times(f, &format!("  {stage}"), times)?;
        }
        for (step, times) in &self.cpu_ms {
            write_times(f, &format!("CPU {step}"), times)?;
        }
        match self.costliest() {
            Some((stage, part)) => {
                writeln!(f, "\ncostliest   {stage}, {:.0} % of the stages' GPU time", 100.0 * part)
            }
            None => writeln!(f, "\nThe log has no GPU times: the device gave no timestamps."),
        }
    }
}

/// A line of percentiles; a dash where nothing was measured.
fn write_times(f: &mut fmt::Formatter<'_>, name: &str, times: &Sorted) -> fmt::Result {
    write!(f, "{name:<12}")?;
    for per_mille in REPORTED_PER_MILLE {
        match times.percentile(per_mille) {
            Some(ms) => write!(f, "{ms:>9.3}")?,
            None => write!(f, "{:>9}", "-")?,
        }
    }
    writeln!(f)
}
