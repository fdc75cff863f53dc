//! The part of the panel that tells how the scan was understood, and has it read in another way: files lie about their
//! units, and models lie on their side.

use super::Widgets;
use super::parts::combo;
use crate::walk::action::{Action, Stance};
use crate::walk::filling::ScanRequest;
use crate::walk::link::LoadState;
use egui::Ui;
use points::{Unit, Up};
use std::sync::Arc;

/// Values of `cloud.up`.
const UPS: [(&str, Up); 4] = [("auto", Up::Auto), ("z", Up::Z), ("y", Up::Y), ("-y", Up::MinusY)];

/// Draws the choices; returns the action that the user asked for in them.
pub(super) fn show(
    ui: &mut Ui,
    load: &LoadState,
    stance: Option<&Stance>,
    widgets: &Widgets,
) -> Option<Action> {
    let request = load.scan.as_ref()?;
    let mut read = request.read.clone();
    combo(ui, widgets, "cloud.up", &mut read.up, &UPS);
    combo(ui, widgets, "cloud.unit", &mut read.unit, &Unit::choices());
    // What the user has said of the scan stays said.
    let kind = stance.and_then(|stance| stance.said).or(request.kind);
    let is_another = read != request.read;
    is_another.then(|| Action::Open(Arc::new(ScanRequest { files: request.files.clone(), read, kind })))
}
