//! From samples to medians, ratios, a table and CSV rows.

use crate::contestant::Sample;
use scanwalk::timing::STAGES;
use std::fmt;
use std::io::{self, Write};

/// Median and range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    median: f64,
    min: f64,
    max: f64,
}

impl Spread {
    /// Of at least one value.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_unstable_by(f64::total_cmp);
        let middle = 0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2]);
        Self { median: middle, min: values[0], max: values[values.len() - 1] }
    }
}

impl fmt::Display for Spread {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let text = format!("{:.2} ({:.2}–{:.2})", self.median, self.min, self.max);
        f.pad(&text)
    }
}

/// All samples of one cloud from one viewpoint; `samples[contestant][run]`.
pub struct Figures {
    /// Points of the cloud.
    pub num_points: u64,
    /// Name of the viewpoint.
    pub viewpoint: &'static str,
    /// Names of the contestants.
    pub names: [&'static str; 3],
    /// In the order of `names`.
    pub samples: [Vec<Sample>; 3],
    /// Share of pixels on which compute and hardware agree.
    pub agreement: f64,
}

impl Figures {
    /// First line of the CSV.
    pub fn csv_header(out: &mut impl Write) -> io::Result<()> {
        let stages = STAGES.map(|stage| format!("{stage}_ms")).join(",");
        writeln!(out, "points,viewpoint,method,run,{stages},gpu_ms,wall_ms,points_read")
    }

    /// A row a sample.
    pub fn csv_rows(&self, out: &mut impl Write) -> io::Result<()> {
        for (name, samples) in self.names.iter().zip(&self.samples) {
            for (run, sample) in samples.iter().enumerate() {
                // What a method does not have stays empty.
                let stages =
                    sample.stage_ms.map(|ms| if ms.is_nan() { String::new() } else { format!("{ms:.3}") });
                let Sample { gpu_ms, wall_ms, points_read, .. } = sample;
                write!(out, "{},{},{name},{run},", self.num_points, self.viewpoint)?;
                writeln!(out, "{},{gpu_ms:.3},{wall_ms:.3},{points_read}", stages.join(","))?;
            }
        }
        Ok(())
    }

    /// The table's part: times of each contestant, then the ratios, taken run by run.
    pub fn print(&self, out: &mut impl Write) -> io::Result<()> {
        let millions = self.num_points as f64 / 1e6;
        let agreement = 100.0 * self.agreement;
        writeln!(out, "{millions} M points, {}; pictures agree on {agreement:.2} %", self.viewpoint)?;
        for (name, samples) in self.names.iter().zip(&self.samples) {
            let spread = |value: &dyn Fn(&Sample) -> f64| Spread::of(samples.iter().map(value));
            let read = samples[0].points_read as f64 / 1e6;
            writeln!(
                out,
                "  {name:<12} gpu ms {}, wall ms {}, {read:.2} M points read",
                spread(&|s| s.gpu_ms),
                spread(&|s| s.wall_ms)
            )?;
            if samples[0].stage_ms.iter().all(|ms| ms.is_finite()) {
                let stages: Vec<String> = (0..STAGES.len())
                    .map(|stage| format!("{} {}", STAGES[stage], spread(&|s| s.stage_ms[stage])))
                    .collect();
                writeln!(out, "  {:<12} {}", "", stages.join(", "))?;
            }
        }
        let [stereo, singles, hardware] = &self.samples;
        let depth = |s: &Sample| s.stage_ms[2];
        let frame = |s: &Sample| s.gpu_ms;
        writeln!(
            out,
            "  stereo / two-singles: depth {}, frame {}",
            ratio(stereo, singles, depth),
            ratio(stereo, singles, frame)
        )?;
        writeln!(out, "  point-list / stereo: frame {}", ratio(hardware, stereo, frame))
    }
}

/// Ratio of samples that were taken one after the other, so that drift meets both.
fn ratio(of: &[Sample], to: &[Sample], value: impl Fn(&Sample) -> f64) -> Spread {
    Spread::of(of.iter().zip(to).map(|(of, to)| value(of) / value(to)))
}
