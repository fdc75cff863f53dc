//! The frame log's text: header, column names and rows. The writer and the report share it.

use super::{FrameRow, Place, RunFacts, STAGES};
use base::space::Pose;
use glam::DVec3;
use std::io::{self, Write};

/// How the first line of every frame log starts.
pub const TITLE: &str = "# scanwalk frame log";
/// How the comment starts that counts the rows which the queue had no room for.
pub const DROPPED: &str = "# dropped rows: ";

/// Column names before the stages' own.
const BEFORE_STAGES: [&str; 6] =
    ["frame", "time_s", "predicted_display_ns", "wait_ms", "record_ms", "submit_ms"];
/// Column names after the stages' own. New ones go to the end, where older readers pass over them.
const AFTER_STAGES: [&str; 31] = [
    "gpu_ms",
    "budget_ms",
    "over_budget",
    "missed_periods",
    "visible_nodes",
    "points_read",
    "points_resident",
    "lod_scale",
    "resolution_scale",
    "quality",
    "upload_bytes",
    HEAD[0],
    HEAD[1],
    HEAD[2],
    HEAD[3],
    HEAD[4],
    HEAD[5],
    HEAD[6],
    "phase",
    "visible_batches",
    CALLS[0],
    CALLS[1],
    CALLS[2],
    CALLS[3],
    CALLS[4],
    "session",
    "place_x",
    "place_y",
    "place_z",
    "place_yaw_deg",
    "place_units_per_m",
];
/// Columns of [`super::CallTimes`], in the order of its names.
pub(super) const CALLS: [&str; 5] = ["image_ms", "locate_ms", "release_ms", "end_ms", "pose_age_ms"];
/// Columns of `world_from_head`: position, then quaternion, in the order and the spaces of a pose path.
pub(super) const HEAD: [&str; 7] = ["head_x", "head_y", "head_z", "head_qx", "head_qy", "head_qz", "head_qw"];

/// All column names, in order: one for each stage of [`STAGES`] in the middle, `clear_ms`, `cull_ms`, ….
#[must_use]
pub fn names() -> Vec<String> {
    let stages = STAGES.iter().map(|stage| format!("{stage}_ms"));
    let fixed = |names: &[&str]| names.iter().map(ToString::to_string).collect::<Vec<_>>();
    fixed(&BEFORE_STAGES).into_iter().chain(stages).chain(fixed(&AFTER_STAGES)).collect()
}

/// The `#` lines and the line of column names.
pub(super) fn write_header(out: &mut impl Write, facts: &RunFacts) -> io::Result<()> {
    writeln!(out, "{TITLE}, version {}", env!("CARGO_PKG_VERSION"))?;
    for (name, value) in [
        ("scan", &facts.scan),
        ("device", &facts.device),
        ("driver", &facts.driver),
        ("runtime", &facts.runtime),
        ("resolution", &facts.resolution),
        ("config", &facts.config_digest),
    ] {
        // A line break in a file's name must not end the comment.
        writeln!(out, "# {name}: {}", value.replace(['\n', '\r'], " "))?;
    }
    writeln!(out, "{}", names().join(","))
}

/// One row. A GPU time that the device did not give (NaN) is an empty cell.
pub(super) fn write_row(out: &mut impl Write, row: &FrameRow) -> io::Result<()> {
    write!(out, "{},{:.6},{}", row.frame, row.time_s, row.predicted_display_ns)?;
    for ms in [row.wait_ms, row.record_ms, row.submit_ms] {
        write_ms(out, ms)?;
    }
    for ms in row.stage_ms {
        write_ms(out, ms)?;
    }
    write_ms(out, row.gpu_ms)?;
    write_ms(out, row.budget_ms)?;
    write!(out, ",{},{}", u8::from(row.over_budget()), row.missed_periods)?;
    write!(out, ",{},{},{}", row.visible_nodes, row.points_read, row.points_resident)?;
    write!(out, ",{},{}", row.lod_scale, row.resolution_scale)?;
    write!(out, ",{},{}", row.quality, row.upload_bytes)?;
    write_head(out, row.world_from_head)?;
    write!(out, ",{},{}", row.phase.name(), row.visible_batches)?;
    for ms in row.calls.to_array() {
        write_ms(out, ms)?;
    }
    write!(out, ",{}", row.session)?;
    match row.place {
        Some(Place { floor_in_world: DVec3 { x, y, z }, yaw_deg, units_per_m }) => {
            writeln!(out, ",{x},{y},{z},{yaw_deg},{units_per_m}")
        }
        None => writeln!(out, ",,,,,"),
    }
}

/// The head's pose with all its digits, so that a replay draws the same picture; empty cells if there is none.
fn write_head(out: &mut impl Write, world_from_head: Option<Pose>) -> io::Result<()> {
    let Some(Pose { position, orientation }) = world_from_head else {
        return HEAD.iter().try_for_each(|_| out.write_all(b","));
    };
    let values = position.to_array().into_iter().chain(orientation.to_array());
    values.into_iter().try_for_each(|value| write!(out, ",{value}"))
}

/// A comma and milliseconds to a tenth of a microsecond.
fn write_ms(out: &mut impl Write, ms: f32) -> io::Result<()> {
    if ms.is_finite() { write!(out, ",{ms:.4}") } else { out.write_all(b",") }
}
