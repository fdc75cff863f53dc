//! Makes medians, ratios, a table and CSV rows of samples.

use crate::contestant::FrameSample;
use crate::heat::{FramePart, Ratio};
use kit::timed::Spread;
use std::io::{self, Write};
use timing::STAGES;

/// All samples of one heat from one viewpoint.
pub struct HeatSamples {
    /// Points of the cloud.
    pub num_points: u64,
    /// Name of the viewpoint.
    pub viewpoint: &'static str,
    /// Name of the heat.
    pub heat: &'static str,
    /// Samples of each contestant, in turn.
    pub samples: Vec<(&'static str, Vec<FrameSample>)>,
}

impl HeatSamples {
    /// Writes the first line of the CSV.
    pub fn csv_header(out: &mut impl Write) -> io::Result<()> {
        let stages = STAGES.map(|stage| format!("{stage}_ms")).join(",");
        writeln!(
            out,
            "points,viewpoint,heat,contestant,run,{stages},gpu_ms,wall_ms,points_read,visible_batches"
        )
    }

    /// Writes one row per sample.
    pub fn csv_rows(&self, out: &mut impl Write) -> io::Result<()> {
        for (name, samples) in &self.samples {
            for (run, sample) in samples.iter().enumerate() {
                // A stage that a contestant does not have stays empty.
                let stages =
                    sample.stage_ms.map(|ms| if ms.is_nan() { String::new() } else { format!("{ms:.3}") });
                let FrameSample { gpu_ms, wall_ms, points_read, visible_batches, .. } = sample;
                write!(out, "{},{},{},{name},{run},", self.num_points, self.viewpoint, self.heat)?;
                write!(out, "{},{gpu_ms:.3},{wall_ms:.3},", stages.join(","))?;
                writeln!(out, "{points_read},{visible_batches}")?;
            }
        }
        Ok(())
    }

    /// Prints times for people: medians of each contestant's stages, and of the frame with its range.
    pub fn print_times(&self, out: &mut impl Write) -> io::Result<()> {
        let millions = self.num_points as f64 / 1e6;
        writeln!(out, "{}: {millions} M points, {}", self.heat, self.viewpoint)?;
        let stages = STAGES.map(|stage| format!("{stage:>9}")).concat();
        writeln!(out, "  {:<21}{stages}{:>27}{:>9}{:>9}", "ms", "frame", "wall", "M points")?;
        for (name, samples) in &self.samples {
            let spread = |value: &dyn Fn(&FrameSample) -> f64| Spread::of(samples.iter().map(value));
            let stage = |stage| match spread(&|s| s.stage_ms[stage]).median {
                ms if ms.is_nan() => format!("{:>9}", "–"),
                ms => format!("{ms:>9.2}"),
            };
            let stages: String = (0..STAGES.len()).map(stage).collect();
            write!(out, "  {name:<21}{stages}{:>27}", spread(&|s| s.gpu_ms))?;
            let read = samples[0].points_read as f64 / 1e6;
            writeln!(out, "{:>9.2}{read:>9.2}", spread(&|s| s.wall_ms).median)?;
        }
        Ok(())
    }

    /// Prints a ratio for people, taken turn by turn, so that drift meets both; nothing if one of the two is missing.
    pub fn print_ratio(&self, out: &mut impl Write, ratio: &Ratio) -> io::Result<()> {
        let (Some(of), Some(to)) = (self.samples_of(ratio.of), self.samples_of(ratio.to)) else {
            return Ok(());
        };
        let spread = |part: &FramePart| {
            let ratios = of.iter().zip(to).map(|(of, to)| part.ms(of) / part.ms(to));
            format!("{} {}", part.name(), Spread::of(ratios))
        };
        let parts: Vec<String> = ratio.parts.iter().map(spread).collect();
        writeln!(out, "  {} / {}: {}", ratio.of, ratio.to, parts.join(", "))
    }

    fn samples_of(&self, contestant: &str) -> Option<&[FrameSample]> {
        self.samples.iter().find(|(name, _)| *name == contestant).map(|(_, samples)| &samples[..])
    }
}

impl FramePart {
    fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Color => "color",
            Self::Geometry => "geometry",
            Self::Frame => "frame",
        }
    }

    fn ms(self, sample: &FrameSample) -> f64 {
        let stage = |name| {
            STAGES.iter().zip(sample.stage_ms).filter(|(stage, _)| **stage == name).map(|(_, ms)| ms).sum()
        };
        match self {
            Self::Depth => stage("depth"),
            Self::Color => stage("color"),
            Self::Geometry => Self::Depth.ms(sample) + Self::Color.ms(sample),
            Self::Frame => sample.gpu_ms,
        }
    }
}

/// Prints for people how frames grow with the cloud: medians in turn, then the last cloud's divided by the first one's.
pub fn print_growth(out: &mut impl Write, all: &[HeatSamples]) -> io::Result<()> {
    for first in all.iter().filter(|f| f.num_points == all[0].num_points) {
        let same = |f: &&HeatSamples| (f.heat, f.viewpoint) == (first.heat, first.viewpoint);
        let group: Vec<&HeatSamples> = all.iter().filter(same).collect();
        let millions: Vec<String> = group.iter().map(|f| (f.num_points as f64 / 1e6).to_string()).collect();
        writeln!(out, "{}, {}: frame ms at {} M points", first.heat, first.viewpoint, millions.join(", "))?;
        for (name, _) in &first.samples {
            let frames = |f: &&HeatSamples| Some(Spread::of(f.samples_of(name)?.iter().map(|s| s.gpu_ms)));
            let spreads: Vec<Spread> = group.iter().filter_map(frames).collect();
            let texts: String = spreads.iter().map(|spread| format!("{spread:>27}")).collect();
            let growth = spreads[spreads.len() - 1].median / spreads[0].median;
            writeln!(out, "  {name:<21}{texts}; last / first {growth:.2}")?;
        }
    }
    Ok(())
}
