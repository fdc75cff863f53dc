//! Two frame logs side by side: is B really slower than A, and in which stage?

use super::bootstrap::{Interval, compare_medians};
use super::histogram::histogram;
use super::page::{self, Page};
use super::summary::{NO_GPU_TIMES, Summary};
use super::table::{TextTable, in_order, ms, percent};
use base::percentile::{REPORTED_PER_MILLE, Sorted};
use std::fmt;
use timing::{FrameLogFile, LoggedFrame};

/// The differences of two logs; its `Display` is the text for people.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Names of the logs.
    pub names: [String; 2],
    /// Figures of each log.
    pub summaries: [Summary; 2],
    /// GPU time of the frame, then of each stage that either log has.
    pub differences: Vec<TimeDifference>,
}

/// GPU milliseconds of the frame, or of one stage, in two logs.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeDifference {
    /// `GPU`, or the name of a stage.
    pub name: String,
    /// Medians of A and B; `None` where a log has no such time.
    pub medians_ms: [Option<f64>; 2],
    /// 95 % interval of the medians' difference B − A, by a block bootstrap; `None` below a hundred frames.
    pub difference_ms: Option<Interval>,
    /// 95 % interval of the medians' ratio B / A; `None` also where A's median may be 0.
    pub ratio: Option<Interval>,
}

impl TimeDifference {
    fn of(name: &str, times_ms: [Vec<f64>; 2], medians_ms: [Option<f64>; 2]) -> Self {
        let intervals = compare_medians(&times_ms[0], &times_ms[1]);
        let (difference_ms, ratio) =
            intervals.map_or((None, None), |(difference, ratio)| (Some(difference), ratio));
        Self { name: name.into(), medians_ms, difference_ms, ratio }
    }

    /// True if chance alone hardly explains the difference: its interval does not contain 0.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.difference_ms.is_some_and(|[low, high]| low > 0.0 || high < 0.0)
    }

    /// The difference in words, for the table.
    fn in_words(&self) -> &'static str {
        match self.difference_ms {
            None if self.medians_ms.contains(&None) => "-",
            None => "too few frames",
            Some([low, _]) if low > 0.0 => "B slower",
            Some([_, high]) if high < 0.0 => "B faster",
            Some(_) => "no clear difference",
        }
    }
}

impl Comparison {
    /// Compares two logs, each with a name for people.
    #[must_use]
    pub fn of(names: [String; 2], logs: [&FrameLogFile; 2]) -> Self {
        let summaries = logs.map(Summary::of);
        let median = |which: usize, stage: Option<&str>| {
            let Summary { gpu_ms, stages_ms, .. } = &summaries[which];
            let times = match stage {
                None => Some(gpu_ms),
                Some(stage) => stages_ms.iter().find(|(name, _)| name == stage).map(|(_, times)| times),
            };
            times.and_then(Sorted::median)
        };
        let difference = |name: &str, stage: Option<&str>| {
            let times = logs.map(|log| times_ms(log, stage));
            TimeDifference::of(name, times, [0, 1].map(|which| median(which, stage)))
        };
        let stages = in_order(logs.iter().flat_map(|log| &log.stages)).into_iter();
        let frame = std::iter::once(difference("GPU", None));
        let differences = frame.chain(stages.map(|stage| difference(stage, Some(stage)))).collect();
        Self { names, summaries, differences }
    }

    /// Facts that the two runs do not share: name, A's value, B's value. Such a fact is what is compared, or what
    /// spoils the comparison.
    #[must_use]
    pub fn differing_facts(&self) -> Vec<(&str, [&str; 2])> {
        let value = |which: usize, wanted: &str| {
            let fact = self.summaries[which].facts.iter().find(|(name, _)| name == wanted);
            fact.map_or("-", |(_, value)| value.as_str())
        };
        let facts = self.summaries.iter().flat_map(|summary| &summary.facts);
        let names = in_order(facts.map(|(name, _)| name.as_str())).into_iter();
        let both = names.map(|name| (name, [0, 1].map(|which| value(which, name))));
        both.filter(|(_, [a, b])| a != b).collect()
    }

    /// Table of the facts that differ.
    fn facts_table(&self) -> Option<TextTable> {
        let mut table = TextTable::new(["differ in", "A", "B"]);
        let differing = self.differing_facts();
        for (name, values) in &differing {
            table.row(*name, values.map(str::to_owned));
        }
        (!differing.is_empty()).then_some(table)
    }

    /// Table of how smooth each walk was.
    fn shares_table(&self) -> TextTable {
        let mut table = TextTable::new(["", "A", "B"]);
        let mut row = |name: &str, figure: &dyn Fn(&Summary) -> String| {
            table.row(name, self.summaries.each_ref().map(figure));
        };
        row("frames of", &|s| s.counted_phase.name().to_owned());
        row("frames", &|s| s.num_frames.to_string());
        row("not counted", &|s| {
            let others = s.phases.iter().filter(|figures| figures.phase != s.counted_phase);
            others.map(|figures| figures.num_frames).sum::<usize>().to_string()
        });
        row("seconds", &|s| format!("{:.1}", s.duration_s));
        row("over budget", &|s| percent(s.num_over_budget as f64, s.num_frames as f64));
        row("missed displays", &|s| {
            let missed = s.missed_periods as f64;
            percent(missed, missed + s.num_frames as f64)
        });
        for per_mille in REPORTED_PER_MILLE {
            let name =
                if per_mille == 1000 { "max".into() } else { format!("{} %", per_mille as f64 / 10.0) };
            row(&format!("GPU ms, {name}"), &|s| ms(s.gpu_ms.percentile(per_mille)));
        }
        table
    }

    /// Table of the medians and their differences.
    fn differences_table(&self) -> TextTable {
        let mut table = TextTable::new(["median ms", "A", "B", "B - A", "95 %", "B / A", "95 %", ""]);
        for difference in &self.differences {
            let TimeDifference { name, medians_ms: [a, b], difference_ms, ratio } = difference;
            let both = a.zip(*b);
            let interval = |interval: &Option<Interval>| {
                interval.map_or_else(|| "-".into(), |[low, high]| format!("{low:+.3} to {high:+.3}"))
            };
            let cells = [
                ms(*a),
                ms(*b),
                both.map_or_else(|| "-".into(), |(a, b)| format!("{:+.3}", b - a)),
                interval(difference_ms),
                both.filter(|(a, _)| *a > 0.0).map_or_else(|| "-".into(), |(a, b)| format!("{:.3}", b / a)),
                interval(ratio).replace('+', ""),
                difference.in_words().to_owned(),
            ];
            table.row(if name == "GPU" { name.clone() } else { format!("  {name}") }, cells);
        }
        table
    }

    /// The whole page as HTML.
    #[must_use]
    pub fn page(&self) -> String {
        let [a, b] = &self.names;
        let mut page = Page::new(&format!("A: {a}, B: {b}"));
        if let Some(facts) = self.facts_table() {
            page.section("What the runs differ in");
            page.add(facts.markup());
        }
        page.section("How smooth");
        page.add(self.shares_table().markup());
        page.section("Which is faster");
        page.add(page::figure(self.differences_table().markup(), METHOD));
        let [first, second] = &self.summaries;
        if first.gpu_ms.num() == 0 && second.gpu_ms.num() == 0 {
            page.add(page::note(NO_GPU_TIMES));
            return page.finish();
        }
        page.section("How long frames take");
        let top_ms = first.plotted_ms().max(second.plotted_ms());
        let (name_a, name_b) = (format!("A: {a}"), format!("B: {b}"));
        let mut budgets = vec![first.budget_ms.1, second.budget_ms.1];
        budgets.dedup();
        let both = [("a", name_a.as_str(), &first.gpu_ms), ("b", name_b.as_str(), &second.gpu_ms)];
        page.add(histogram(&both, top_ms, &budgets));
        page.finish()
    }
}

/// Explanation of the intervals, for people.
const METHOD: &str = "Median GPU milliseconds of a frame and of each stage. The 95 % intervals tell chance within a \
                      walk (block bootstrap: 2000 times, blocks of frames that follow each other are drawn again). \
                      An interval without 0 is a difference that chance hardly explains. Walks along different paths \
                      differ for that alone: compare logs that replay one pose path. Frames \
                      before the scan stood do not count.";

/// GPU times of the counted frames, or of one of their stages, in the log's order; empty if the log has no such stage.
fn times_ms(log: &FrameLogFile, stage: Option<&str>) -> Vec<f64> {
    let collect = |figure: &dyn Fn(&LoggedFrame) -> f64| log.counted().map(figure).collect();
    let Some(stage) = stage else { return collect(&|frame| frame.gpu_ms) };
    let at = log.stages.iter().position(|name| name == stage);
    at.map_or_else(Vec::new, |at| collect(&|frame| frame.stage_ms[at]))
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (letter, name) in ["A", "B"].into_iter().zip(&self.names) {
            writeln!(f, "{letter:<11} {name}")?;
        }
        if let Some(facts) = self.facts_table() {
            write!(f, "\n{facts}")?;
        }
        write!(f, "\n{}\n{}", self.shares_table(), self.differences_table())?;
        writeln!(f, "\nThe 95 % intervals tell chance within a walk. Compare logs that replay one pose path.")
    }
}
