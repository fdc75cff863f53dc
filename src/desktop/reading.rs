//! The part of the panel that tells how the scan was understood, and has it read in another way: files lie about their
//! units, and models lie on their side.

use super::{Widgets, widget};
use crate::walk::action::{Action, Stance};
use crate::walk::filling::ScanRequest;
use crate::walk::link::LoadState;
use egui::{Grid, Ui};
use std::sync::Arc;

/// Draws the choices; returns the action that the user asked for in them.
pub(super) fn show(
    ui: &mut Ui,
    load: &LoadState,
    stance: Option<&Stance>,
    widgets: &Widgets,
) -> Option<Action> {
    let request = load.scan.as_ref()?;
    let mut read = request.read.clone();
    Grid::new("reading").num_columns(2).spacing([12.0, 5.0]).show(ui, |ui| {
        widget::row(ui, widgets, "cloud.up", read.up, |up| read.up = up);
        widget::row(ui, widgets, "cloud.unit", read.unit, |unit| read.unit = unit);
    });
    // What the user has said of the scan stays said.
    let kind = stance.and_then(|stance| stance.said).or(request.kind);
    let is_another = read != request.read;
    is_another.then(|| Action::Open(Arc::new(ScanRequest { files: request.files.clone(), read, kind })))
}
