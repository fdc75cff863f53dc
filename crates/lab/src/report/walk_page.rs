//! The page of one frame log.

use super::histogram::histogram;
use super::markup::Markup;
use super::page::{self, Page};
use super::stack::stack;
use super::steps::{governor, phases};
use super::summary::{NO_GPU_TIMES, Summary};
use super::table::{TextTable, ms};
use super::timeline::timeline;
use super::worst::{HOLD_S, dearest_stage, worst, worst_poses};
use glam::DVec3;
use timing::{FrameLogFile, LoggedFrame};

/// The whole page of a log, as HTML.
#[must_use]
pub fn walk_page(log: &FrameLogFile) -> String {
    let summary = Summary::of(log);
    let scan =
        summary.facts.iter().find(|(name, _)| name == "scan").map_or("a scan", |(_, scan)| scan.as_str());
    let mut page = Page::new(&format!("A walk through {scan}"));
    page.add(page::facts(summary.facts.iter().map(|(name, value)| (name.as_str(), value.as_str()))));
    page.section("Figures");
    let counts = summary.counts();
    page.add(page::facts(counts.iter().map(|(name, figure)| (*name, figure.as_str()))));
    if log.frames.is_empty() {
        page.add(page::note("The log has no frame: nothing was drawn, or it was cut off before the first."));
        return page.finish();
    }
    page.add(summary.times().markup());
    if let Some(words) = summary.costliest_in_words() {
        page.add(page::paragraph(&format!("Costliest: {words}.")));
    }
    if summary.gpu_ms.num() == 0 {
        page.add(page::note(NO_GPU_TIMES));
    }
    page.section("Frame by frame");
    page.add(timeline(log, &summary));
    if let Some(phases) = phases(log) {
        page.add(phases);
    }
    if summary.gpu_ms.num() > 0 {
        page.section("How long frames take");
        let (low, high) = summary.budget_ms;
        let budgets = if low == high { vec![low] } else { vec![low, high] };
        page.add(histogram(&[("good", "frames", &summary.gpu_ms)], summary.plotted_ms(), &budgets));
        page.section("Where the time goes");
        page.add(stack(log, summary.plotted_ms()));
    }
    if let Some(governor) = governor(log) {
        page.section("What the governor did");
        page.add(governor);
    }
    add_worst(&mut page, log);
    page.finish()
}

/// Adds the worst frames, and their poses to be replayed.
fn add_worst(page: &mut Page, log: &FrameLogFile) {
    let worst = worst(log);
    if worst.is_empty() {
        return;
    }
    page.section("The worst frames");
    let names = [
        "frame",
        "s",
        "GPU ms",
        "budget",
        "dearest stage",
        "its ms",
        "LOD",
        "resolution",
        "head at",
        "looks",
    ];
    let mut table = TextTable::new(names);
    for frame in &worst {
        let stage = dearest_stage(log, frame);
        let [head, looks] = head_in_words(frame);
        let cells = [
            format!("{:.2}", frame.time_s),
            ms(Some(frame.gpu_ms)),
            format!("{:.2}", frame.budget_ms),
            stage.map_or("-", |(name, _)| name).to_owned(),
            ms(stage.map(|(_, ms)| ms)),
            factor(frame.lod_scale),
            factor(frame.resolution_scale),
            head,
            looks,
        ];
        table.row(frame.frame.to_string(), cells);
    }
    page.add(page::figure(
        table.markup(),
        "The longest frames, each the longest within half a second. Head: scan coordinates, and the direction of view.",
    ));
    let Some(poses) = worst_poses(log) else {
        page.add(page::note(
            "The log has no head poses, so these frames cannot be replayed; logs of this version have them.",
        ));
        return;
    };
    let how = format!(
        "As a pose path, {HOLD_S} s at each, the worst first: save it as worst.poses (`scanwalk report --worst-poses` \
         writes it too) and see them again with `scanwalk view SCAN --pose-path worst.poses`"
    );
    let text = [Markup::element("summary", &[], how), Markup::element("pre", &[], poses.to_string())];
    page.add(Markup::element("details", &[], text));
}

fn factor(value: f64) -> String {
    if value.is_nan() { "-".into() } else { format!("{value:.2}") }
}

/// Where the head was, and where it looked.
fn head_in_words(frame: &LoggedFrame) -> [String; 2] {
    let Some(pose) = frame.world_from_head else { return ["-", "-"].map(String::from) };
    let in_words = |v: DVec3, digits: usize| format!("{:.digits$}, {:.digits$}, {:.digits$}", v.x, v.y, v.z);
    [in_words(pose.position, 2), in_words(pose.orientation * DVec3::NEG_Z, 2)]
}
