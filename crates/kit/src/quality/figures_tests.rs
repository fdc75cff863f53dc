//! The way from pictures to a table.

use super::figures::*;
use super::metrics_tests::slope;
use super::motion::{tremor, walk};
use super::motion_tests::view;
use super::picture::EyePicture;
use base::space::View;
use glam::DVec3;
use std::convert::Infallible;

/// Draws `slope`, brighter by `steps` a frame.
fn brightening(steps: u8) -> impl FnMut(&View, f32) -> Result<EyePicture, Infallible> {
    let mut brighter = 0;
    move |_, _| {
        let mut picture = slope();
        picture.rgb.as_flattened_mut().iter_mut().for_each(|value| *value += brighter);
        brighter += steps;
        Ok(picture)
    }
}

fn recording(steps: u8) -> ContestantRecording {
    let (tremor, walk) = (tremor(&view(), 3), walk(&view(), DVec3::ZERO, 4));
    let motion = Motion { tremor: &tremor, walk: &walk, approach: &[0.9, 0.8] };
    ContestantRecording::new(motion, brightening(steps)).unwrap()
}

#[test]
fn frames_are_compared_with_the_one_before() {
    let (recorded, truth) = (recording(2), recording(0));
    assert_eq!(recorded.still(), &slope());
    // The walk starts at the first picture, and two frames of tremor were drawn in between.
    assert_eq!(recorded.pops, [6.0, 2.0, 2.0]);
    // The approach starts there too; three steps of the walk have come between.
    assert_eq!(recorded.lod_pops, [12.0, 2.0]);
    let figures = QualityFigures::new(&view(), &recorded, &truth);
    assert_eq!((figures.flicker, figures.own_flicker), (2.0, 2.0));
    assert_eq!((figures.largest_pop, figures.median_pop), (6.0, 2.0));
    assert_eq!(figures.largest_lod_pop, 12.0);
    assert_eq!(figures.psnr_db, f64::INFINITY);
    let still = QualityFigures::new(&view(), &truth, &truth);
    assert_eq!((still.flicker, still.own_flicker, still.largest_pop), (0.0, 0.0, 0.0));
    let changing_truth = QualityFigures::new(&view(), &recorded, &recorded);
    assert_eq!((changing_truth.flicker, changing_truth.own_flicker), (2.0, 0.0));
}

/// Pixels that the truth does not know are not counted against anybody.
#[test]
fn only_what_the_truth_covers_counts() {
    let (mut drawn, mut truth) = (recording(0), recording(0));
    drawn.tremor[0].rgb[5] = [255; 3];
    let figures =
        |drawn: &ContestantRecording, truth: &ContestantRecording| QualityFigures::new(&view(), drawn, truth);
    assert!(figures(&drawn, &truth).psnr_db < 50.0 && figures(&drawn, &truth).own_flicker > 0.0);
    truth.tremor[0].depth[5] = f32::INFINITY;
    assert_eq!(figures(&drawn, &truth).psnr_db, f64::INFINITY);
    assert_eq!(figures(&drawn, &truth).own_flicker, 0.0);
}

#[test]
fn a_row_has_the_columns_of_the_header() {
    let figures = QualityFigures::new(&view(), &recording(2), &recording(0));
    let rows = vec![("truth", figures), ("point-list", figures)];
    let table = QualityTable { scan: "yard", viewpoint: "hall", num_points: 1, num_true_points: 8, rows };
    let mut csv = Vec::new();
    QualityTable::csv_header(&mut csv).unwrap();
    table.csv_rows(&mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let num_columns: Vec<usize> = csv.lines().map(|line| line.split(',').count()).collect();
    assert_eq!(num_columns, [16; 3], "{csv}");
    let mut text = Vec::new();
    table.print(&mut text).unwrap();
    assert!(String::from_utf8(text).unwrap().contains("2.00 (×1.00)"));
}
