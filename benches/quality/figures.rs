//! From pictures to figures, a table and CSV rows.

use super::metrics::{Holes, largest_patch_change, mean_change, psnr_db, ssim, within_ring};
use super::picture::{Picture, only_eye};
use scanwalk::space::View;
use std::io::{self, Write};

/// Radius of the centre ring, degrees from the gaze.
const CENTER_DEG: f64 = 20.0;

/// What is kept of all pictures that one contestant drew from one viewpoint.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The first picture.
    pub still: Picture,
    /// Mean change from frame to frame under the tremor, 0 to 255.
    pub flicker: f64,
    /// Of each step of the walk: the change of the patch that changes most, 0 to 255.
    pub pops: Vec<f64>,
}

impl Recording {
    /// Draws the frames of both motions; at least two of each, and both start at the same view.
    ///
    /// # Errors
    /// Those of `draw`.
    pub fn new<E>(
        tremor: &[View],
        walk: &[View],
        mut draw: impl FnMut(&View) -> Result<Picture, E>,
    ) -> Result<Self, E> {
        let still = draw(&tremor[0])?;
        let mut steps = |views: &[View], change: fn(&Picture, &Picture) -> f64| {
            let mut before = still.clone();
            let mut changes = Vec::new();
            for view in &views[1..] {
                let now = draw(view)?;
                changes.push(change(&before, &now));
                before = now;
            }
            Ok(changes)
        };
        let changes = steps(tremor, mean_change)?;
        let pops = steps(walk, largest_patch_change)?;
        Ok(Self { flicker: changes.iter().sum::<f64>() / changes.len() as f64, pops, still })
    }
}

/// Figures of one contestant from one viewpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Against the truth, the whole picture.
    pub psnr_db: f64,
    /// Against the truth, the centre ring.
    pub center_psnr_db: f64,
    /// Against the truth.
    pub ssim: f64,
    /// Against the truth.
    pub holes: Holes,
    /// See [`Recording`].
    pub flicker: f64,
    /// Of [`Recording::pops`] the largest.
    pub largest_pop: f64,
    /// Of [`Recording::pops`] the median.
    pub median_pop: f64,
}

impl Figures {
    /// Of a contestant beside the truth of the same view.
    pub fn new(view: &View, recording: &Recording, truth: &Picture) -> Self {
        let still = &recording.still;
        let center = within_ring(only_eye(view), CENTER_DEG);
        let mut pops = recording.pops.clone();
        pops.sort_unstable_by(f64::total_cmp);
        Self {
            psnr_db: psnr_db(still, truth, |_| true),
            center_psnr_db: psnr_db(still, truth, |pixel| center[pixel]),
            ssim: ssim(still, truth),
            holes: Holes::of(still, truth),
            flicker: recording.flicker,
            largest_pop: pops[pops.len() - 1],
            median_pop: pops[pops.len() / 2],
        }
    }
}

/// All figures from one viewpoint.
pub struct Table {
    /// Name of the scan.
    pub scan: &'static str,
    /// Name of the viewpoint.
    pub viewpoint: &'static str,
    /// Points of the contestants' scan.
    pub num_points: u64,
    /// Points of the truth's scan.
    pub num_true_points: u64,
    /// The truth, then the contestants.
    pub rows: Vec<(&'static str, Figures)>,
}

impl Table {
    /// First line of the CSV.
    pub fn csv_header(out: &mut impl Write) -> io::Result<()> {
        writeln!(
            out,
            "scan,viewpoint,points,true_points,method,psnr_db,center_psnr_db,ssim,empty_px,behind_px,judged_px,\
             flicker,largest_pop,median_pop"
        )
    }

    /// A row a contestant.
    pub fn csv_rows(&self, out: &mut impl Write) -> io::Result<()> {
        for (name, f) in &self.rows {
            let Self { scan, viewpoint, num_points, num_true_points, .. } = self;
            write!(out, "{scan},{viewpoint},{num_points},{num_true_points},{name},")?;
            write!(out, "{:.3},{:.3},{:.5},", f.psnr_db, f.center_psnr_db, f.ssim)?;
            write!(out, "{},{},{},", f.holes.empty, f.holes.behind, f.holes.judged)?;
            writeln!(out, "{:.4},{:.3},{:.3}", f.flicker, f.largest_pop, f.median_pop)?;
        }
        Ok(())
    }

    /// For people; behind the shares of holes and the flicker stands their ratio to the first contestant's.
    pub fn print(&self, out: &mut impl Write) -> io::Result<()> {
        let [points, true_points] = [self.num_points, self.num_true_points].map(|n| n as f64 / 1e6);
        writeln!(
            out,
            "{} {}: {points:.2} M points, truth from {true_points:.2} M",
            self.scan, self.viewpoint
        )?;
        writeln!(
            out,
            "  {:<18} {:>7} {:>9} {:>6} {:>15} {:>8} {:>8} {:>15} {:>11} {:>10}",
            "",
            "PSNR dB",
            "centre dB",
            "SSIM",
            "holes",
            "empty",
            "behind",
            "flicker",
            "largest pop",
            "median pop"
        )?;
        // The truth stands first.
        let first = self.rows[1].1;
        for (name, f) in &self.rows {
            let ratio = |value: f64, of: f64, digits: usize| format!("{value:.digits$} (×{:.2})", value / of);
            let percent = |count: usize| 100.0 * count as f64 / f.holes.judged as f64;
            writeln!(
                out,
                "  {name:<18} {:>7.2} {:>9.2} {:>6.4} {:>15} {:>6.2} % {:>6.2} % {:>15} {:>11.2} {:>10.2}",
                f.psnr_db,
                f.center_psnr_db,
                f.ssim,
                ratio(100.0 * f.holes.share(), 100.0 * first.holes.share(), 2),
                percent(f.holes.empty),
                percent(f.holes.behind),
                ratio(f.flicker, first.flicker, 3),
                f.largest_pop,
                f.median_pop
            )?;
        }
        Ok(())
    }
}
