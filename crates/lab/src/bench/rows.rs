//! Makes rows of counts and times, beside the papers' figures.

use super::contestant::{FrameCounts, FrameMs};
use super::papers::{self, Paper};
use super::subject::{Model, Subject};
use crate::report::{BenchRow, BytesRead, GpuMs};
use base::percentile::Sorted;
use timing::STAGES;

/// Fields that the rows of one measurement have in common.
#[derive(Clone, Copy)]
pub struct RowGroup<'a> {
    pub table: &'a str,
    pub order: &'a str,
    pub subject: &'a Subject,
}

/// The frames that a row is made of.
pub struct TimedFrames {
    pub name: String,
    pub load: FrameCounts,
    pub samples: Vec<FrameMs>,
}

/// Load of hardware points, which read every point, 16 bytes each.
pub fn hardware_load(subject: &Subject, drawn: FrameCounts) -> FrameCounts {
    let points_read = subject.num_points();
    let bytes = BytesRead { planes: 16 * points_read, ..BytesRead::default() };
    FrameCounts { points_read, bytes, num_batches_drawn: drawn.num_batches, ..drawn }
}

/// Time of the stages that read points; NaN for hardware points.
fn geometry_ms(sample: &FrameMs) -> f64 {
    let of_points = |(stage, _): &(&&str, &f64)| matches!(**stage, "depth" | "color");
    STAGES.iter().zip(&sample.stage_ms).filter(of_points).map(|(_, ms)| ms).sum()
}

/// Median and range of the values.
pub fn gpu_ms(values: impl Iterator<Item = f64>) -> GpuMs {
    let sorted = Sorted::new(values);
    let [min, max] = [0, 1000].map(|per_mille| sorted.percentile(per_mille).unwrap_or(0.0));
    GpuMs { median: sorted.median().unwrap_or(0.0), min, max }
}

/// A row whose samples are of whole frames.
pub fn row_of_frames(of: RowGroup, viewpoint: &str, timed: &TimedFrames) -> BenchRow {
    let median = |value: fn(&FrameMs) -> f64| Sorted::new(timed.samples.iter().map(value)).median();
    let ms = gpu_ms(timed.samples.iter().map(|sample| sample.gpu_ms));
    let cpu_ms = median(|sample| sample.cpu_ms);
    let FrameCounts { discs_chosen, points_read, .. } = timed.load;
    let is_spt = discs_chosen > 0 && points_read > 0;
    BenchRow {
        geometry_ms: median(geometry_ms).filter(|ms| *ms > 0.0),
        cpu_share: cpu_ms.filter(|_| ms.median > 0.0).map(|cpu_ms| cpu_ms / ms.median),
        culled_share: is_spt.then(|| 1.0 - discs_chosen as f64 / points_read as f64),
        ..row(of, viewpoint, timed, ms)
    }
}

/// A row whose median is that of some part of the frame.
pub fn row(of: RowGroup, viewpoint: &str, timed: &TimedFrames, gpu_ms: GpuMs) -> BenchRow {
    let RowGroup { table, order, subject } = of;
    // Places of a user's scan are like the courtyard's.
    let model = if subject.model == Model::Scan { Model::Courtyard } else { subject.model };
    let Paper { ms, says } = papers::figures(table, model, &timed.name, order, viewpoint);
    let mut papers = ms.into_iter();
    let paper = papers.next();
    let per_s = |amount: u64| if gpu_ms.median > 0.0 { amount as f64 * 1e3 / gpu_ms.median } else { 0.0 };
    BenchRow {
        table: table.into(),
        model: subject.model.name().into(),
        method: timed.name.clone(),
        order: order.into(),
        viewpoint: viewpoint.into(),
        points: subject.num_points(),
        points_read: timed.load.points_read,
        points_drawn: timed.load.points_drawn,
        pixels_asked: Some(timed.load.pixels_asked),
        nodes: Some(timed.load.num_batches),
        nodes_drawn: Some(timed.load.num_batches_drawn),
        gpu_ms,
        m_points_per_s: per_s(timed.load.points_read) / 1e6,
        bytes_read: Some(timed.load.bytes),
        gb_per_s: Some(per_s(timed.load.bytes.total()) / 1e9),
        paper_ms: paper.as_ref().map(|paper| paper.ms),
        paper_device: paper.map(|paper| paper.device),
        other_papers: papers.collect(),
        paper_says: says,
        ..BenchRow::default()
    }
}
