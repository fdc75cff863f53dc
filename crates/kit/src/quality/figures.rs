//! Makes figures, a table and CSV rows of pictures.

use super::metrics::{Holes, largest_patch_change, mean_change, mean_own_change, psnr_db, ssim, within_ring};
use super::picture::{EyePicture, only_eye};
use base::percentile::Sorted;
use base::space::View;
use std::io::{self, Write};

/// Radius of the center ring, degrees from the gaze.
const CENTER_DEG: f64 = 20.0;

/// Pictures and changes that are kept of all that one contestant drew from one viewpoint.
#[derive(Clone, Debug)]
pub struct ContestantRecording {
    /// All frames of the tremor; the first one is the picture that is looked at.
    pub tremor: Vec<EyePicture>,
    /// Change of the patch that changes most, in each step of the walk, 0 to 255.
    pub pops: Vec<f64>,
    /// Change of the patch that changes most, where the head stands still and only the level of detail goes on as if it
    /// walked.
    pub lod_pops: Vec<f64>,
}

/// Frames that contestants draw.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Views of the tremor, at least two.
    pub tremor: &'a [View],
    /// Views of the walk, at least two; both motions start at the same one.
    pub walk: &'a [View],
    /// Factors on the thresholds of level of detail, at least one; before them stands 1.
    pub approach: &'a [f32],
}

impl ContestantRecording {
    /// Draws all frames; `draw` gets a view and the factor on the thresholds of level of detail.
    ///
    /// # Errors
    /// Those of `draw`.
    pub fn new<E>(
        motion: Motion,
        mut draw: impl FnMut(&View, f32) -> Result<EyePicture, E>,
    ) -> Result<Self, E> {
        let tremor =
            motion.tremor.iter().map(|view| draw(view, 1.0)).collect::<Result<Vec<EyePicture>, E>>()?;
        let mut pops = |frames: &mut dyn Iterator<Item = (&View, f32)>| {
            let (mut before, mut pops) = (tremor[0].clone(), Vec::new());
            for (view, lod_scale) in frames {
                let now = draw(view, lod_scale)?;
                pops.push(largest_patch_change(&before, &now));
                before = now;
            }
            Ok(pops)
        };
        let walk_pops = pops(&mut motion.walk[1..].iter().map(|view| (view, 1.0)))?;
        let still = &motion.tremor[0];
        let lod_pops = pops(&mut motion.approach.iter().map(|&scale| (still, scale)))?;
        Ok(Self { tremor, pops: walk_pops, lod_pops })
    }

    /// The picture that is looked at.
    pub fn still(&self) -> &EyePicture {
        &self.tremor[0]
    }

    /// Pairs of consecutive frames of the tremor.
    fn steps(&self) -> impl Iterator<Item = [&EyePicture; 2]> {
        self.tremor.windows(2).map(|pair| [&pair[0], &pair[1]])
    }
}

/// Figures of one contestant from one viewpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QualityFigures {
    /// PSNR over the pixels that the truth covers.
    pub psnr_db: f64,
    /// PSNR over the pixels of the center ring that the truth covers.
    pub center_psnr_db: f64,
    /// SSIM of the whole picture.
    pub ssim: f64,
    /// Pixels that lack a surface.
    pub holes: Holes,
    /// Mean change from frame to frame under the tremor, 0 to 255.
    pub flicker: f64,
    /// The part of the flicker that the truth does not have: see [`mean_own_change`].
    pub own_flicker: f64,
    /// Largest of [`ContestantRecording::pops`].
    pub largest_pop: f64,
    /// Median of [`ContestantRecording::pops`].
    pub median_pop: f64,
    /// Largest of [`ContestantRecording::lod_pops`].
    pub largest_lod_pop: f64,
}

impl QualityFigures {
    /// Figures of a contestant beside the truth of the same views, of which `view` is the first.
    pub fn new(view: &View, drawn: &ContestantRecording, truth: &ContestantRecording) -> Self {
        let (still, true_still) = (drawn.still(), truth.still());
        let center = within_ring(only_eye(view), CENTER_DEG);
        let covered = |pixel: usize| true_still.depth[pixel].is_finite();
        let pops = Sorted::new(drawn.pops.iter().copied());
        let own_changes =
            drawn.steps().zip(truth.steps()).map(|(drawn, truth)| mean_own_change(drawn, truth));
        Self {
            psnr_db: psnr_db(still, true_still, covered),
            center_psnr_db: psnr_db(still, true_still, |pixel| covered(pixel) && center[pixel]),
            ssim: ssim(still, true_still),
            holes: Holes::of(still, true_still),
            flicker: mean(drawn.steps().map(|[before, now]| mean_change(before, now))),
            own_flicker: mean(own_changes),
            largest_pop: pops.percentile(1000).unwrap_or(f64::NAN),
            median_pop: pops.median().unwrap_or(f64::NAN),
            largest_lod_pop: drawn.lod_pops.iter().copied().fold(0.0, f64::max),
        }
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count)
}

/// All figures from one viewpoint.
pub struct QualityTable {
    /// Name of the scan.
    pub scan: &'static str,
    /// Name of the viewpoint.
    pub viewpoint: &'static str,
    /// Points of the contestants' scan.
    pub num_points: u64,
    /// Points of the truth's scan.
    pub num_true_points: u64,
    /// The truth, then the contestants.
    pub rows: Vec<(&'static str, QualityFigures)>,
}

impl QualityTable {
    /// Writes the first line of the CSV.
    pub fn csv_header(out: &mut impl Write) -> io::Result<()> {
        writeln!(
            out,
            "scan,viewpoint,points,true_points,method,psnr_db,center_psnr_db,ssim,empty_px,behind_px,judged_px,\
             flicker,own_flicker,largest_pop,median_pop,largest_lod_pop"
        )
    }

    /// Writes one row per contestant.
    pub fn csv_rows(&self, out: &mut impl Write) -> io::Result<()> {
        for (name, f) in &self.rows {
            let Self { scan, viewpoint, num_points, num_true_points, .. } = self;
            write!(out, "{scan},{viewpoint},{num_points},{num_true_points},{name},")?;
            write!(out, "{:.3},{:.3},{:.5},", f.psnr_db, f.center_psnr_db, f.ssim)?;
            write!(out, "{},{},{},", f.holes.empty, f.holes.behind, f.holes.judged)?;
            write!(out, "{:.4},{:.4},", f.flicker, f.own_flicker)?;
            writeln!(out, "{:.3},{:.3},{:.3}", f.largest_pop, f.median_pop, f.largest_lod_pop)?;
        }
        Ok(())
    }

    /// Prints the table for people; the ratio to the first contestant's stands behind holes and flicker.
    pub fn print(&self, out: &mut impl Write) -> io::Result<()> {
        let [points, true_points] = [self.num_points, self.num_true_points].map(|n| n as f64 / 1e6);
        writeln!(
            out,
            "{} {}: {points:.2} M points, truth from {true_points:.2} M",
            self.scan, self.viewpoint
        )?;
        let titles = ["PSNR dB", "center dB", "SSIM"].map(|title| format!("{title:>11}")).concat();
        let ratios = ["holes %", "flicker", "own flicker"].map(|title| format!("{title:>16}")).concat();
        writeln!(out, "  {:<25}{titles}{ratios}{:>14}{:>9}", "", "pop (median)", "LOD pop")?;
        // The truth stands first.
        let first = self.rows[1].1;
        for (name, f) in &self.rows {
            let ratio = |value: f64, of: f64, digits: usize| format!("{value:.digits$} (×{:.2})", value / of);
            write!(out, "  {name:<25}{:>11.2}{:>11.2}{:>11.4}", f.psnr_db, f.center_psnr_db, f.ssim)?;
            write!(out, "{:>16}", ratio(100.0 * f.holes.share(), 100.0 * first.holes.share(), 2))?;
            write!(out, "{:>16}", ratio(f.flicker, first.flicker, 2))?;
            write!(out, "{:>16}", ratio(f.own_flicker, first.own_flicker, 2))?;
            let pop = format!("{:.1} ({:.1})", f.largest_pop, f.median_pop);
            writeln!(out, "{pop:>14}{:>9.2}", f.largest_lod_pop)?;
        }
        Ok(())
    }
}
