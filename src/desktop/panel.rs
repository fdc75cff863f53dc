//! The panel: the scan, how one moves, a few choices; and, on a tab of its own, how the frames go.

use super::controls::{PanelTab, WindowState};
use super::history::{History, TimeSummary};
use super::parts::{fact, fold, section};
use super::recent::RecentScan;
use super::style::{self, BAD, FAINT, GOOD, STAGE_COLORS, WARN, caption};
use super::{Widgets, appearance, numbers, open, plot, reading, stance, widget};
use crate::walk::action::Action;
use crate::walk::filling::names;
use crate::walk::link::{HeadsetState, LoadState};
use crate::walk::state::Snapshot;
use egui::{Align, Area, Button, Color32, Grid, Id, Layout, Rect, RichText, ScrollArea, Sense, Ui, vec2};
use render::options::{Overlay, Quality};
use std::time::Instant;
use timing::{FrameRow, STAGES};

/// Width of what is in the panel, points.
const WIDTH: f32 = 264.0;
/// Distance from the window's corner, points.
const MARGIN: f32 = 12.0;

/// Least width beside the panel, points, in which something is said.
const LEAST_BESIDE: f32 = 320.0;

/// Windows narrower than this, in points, begin with the panel as a button: it would cover half of the picture.
const FOLDED_BELOW: f32 = 700.0;

/// Everything that the panel tells.
pub(super) struct Contents<'a> {
    /// The last seconds of frames.
    pub history: &'a History,
    /// What loading has come to.
    pub load: &'a LoadState,
    /// Which headset the walk has.
    pub headset: &'a HeadsetState,
    /// Scans that were opened last.
    pub recent: &'a [RecentScan],
    /// What the user can choose.
    pub widgets: &'a Widgets,
    /// What there is to show of the application's state.
    pub state: Snapshot,
    /// Pixels of an eye's image.
    pub eye_px: Option<[u32; 2]>,
    /// The present moment.
    pub now: Instant,
}

/// Draws the panel if the view wants it; returns the actions that the user asked for in it.
pub(super) fn show(ui: &mut Ui, contents: &Contents, view: &mut WindowState) -> Vec<Action> {
    if !view.panel {
        return Vec::new();
    }
    let mut asked = Vec::new();
    let screen = ui.ctx().content_rect();
    let height = screen.height() - 2.0 * MARGIN - 26.0;
    let area = Area::new(Id::unique("panel")).fixed_pos([MARGIN, MARGIN]);
    if view.folded.unwrap_or(screen.width() < FOLDED_BELOW) {
        let button =
            area.show(ui.ctx(), |ui| ui.button("Panel").on_hover_text("Scan, picture, moving, timing"));
        if button.inner.clicked() {
            view.folded = Some(false);
        }
        return asked;
    }
    area.show(ui.ctx(), |ui| {
        style::card().show(ui, |ui| {
            ui.set_width(WIDTH);
            // An area remembers its first size; the panel grows with its contents and with the window.
            let height = height.max(40.0);
            let scroll = ScrollArea::vertical().max_height(height).min_scrolled_height(height);
            scroll.auto_shrink([false, true]).show(ui, |ui| {
                ui.set_max_width(WIDTH);
                tabs(ui, view);
                match view.tab {
                    PanelTab::Scan => {
                        asked.extend(opening(ui, contents, view));
                        asked.extend(sought(ui, contents.headset));
                        asked.extend(scan(ui, contents));
                        asked.extend(appearance::show(ui, &contents.state, contents.widgets));
                        let stance = contents.state.stance.as_ref();
                        asked.extend(stance.and_then(|stance| stance::show(ui, stance, contents.widgets)));
                        section(ui);
                        asked.extend(choices(ui, contents, view));
                    }
                    PanelTab::Timing => {
                        frames(ui, contents);
                        section(ui);
                        points(ui, contents.history.newest());
                        machine(ui, contents);
                    }
                }
            });
        });
    });
    asked
}

/// The part of the window that the panel leaves free; all of it if that would be too narrow for words.
pub(super) fn beside(ui: &Ui, view: &WindowState) -> Rect {
    let screen = ui.ctx().content_rect();
    let panel = ui.ctx().memory(|memory| memory.area_rect(Id::unique("panel")));
    let Some(panel) = panel.filter(|_| view.panel) else { return screen };
    let free = screen.with_min_x(panel.right());
    if free.width() < LEAST_BESIDE { screen } else { free }
}

/// Draws that no headset has answered yet, with a button to look for one at once.
fn sought(ui: &mut Ui, headset: &HeadsetState) -> Option<Action> {
    if !headset.is_sought || headset.waiting_because.is_some() {
        return None;
    }
    let shown = ui.horizontal(|ui| {
        ui.label(RichText::new("Headset").color(FAINT));
        ui.label("none answers")
            .on_hover_text("It is used as soon as one does; until then the window is all there is.");
        ui.button("Look now").clicked()
    });
    shown.inner.then_some(Action::LookForHeadset)
}

/// Draws the tabs.
fn tabs(ui: &mut Ui, view: &mut WindowState) {
    ui.horizontal(|ui| {
        for (title, tab) in [("Scan", PanelTab::Scan), ("Timing", PanelTab::Timing)] {
            ui.selectable_value(&mut view.tab, tab, title);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.small_button("–").on_hover_text("Make the panel a button").clicked() {
                view.folded = Some(true);
            }
        });
    });
    section(ui);
}

/// Draws frame rate, plot, stages, GPU and CPU times.
fn frames(ui: &mut Ui, contents: &Contents) {
    let history = contents.history;
    let newest = history.newest();
    ui.horizontal(|ui| {
        let rate = history.frames_per_second(contents.now);
        let text = rate.map_or("–".to_string(), |rate| format!("{rate:.*}", usize::from(rate < 9.95)));
        ui.label(RichText::new(text).size(26.0));
        ui.label(RichText::new("frames / s").color(FAINT));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let missed = history.num_missed();
            let color = if missed == 0 { FAINT } else { WARN };
            let text = RichText::new(format!("{} missed", numbers::count(missed))).color(color);
            ui.label(text).on_hover_text("Display periods without a new image, since the start");
        });
    });
    plot::show(ui, history);
    ui.add_space(5.0);
    let Some(row) = newest else {
        ui.label(RichText::new("No frame yet").color(FAINT));
        return;
    };
    ui.horizontal(|ui| {
        ui.label(caption(&format!("GPU, last {} s", super::history::HISTORY_S)));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(caption(&format!("budget {}", numbers::millis(row.budget_ms))));
        });
    });
    stages(ui, row);
    ui.add_space(2.0);
    match history.gpu() {
        Some(spread) => gpu(ui, &spread, row.budget_ms),
        None => {
            ui.label(RichText::new("This GPU tells no times.").color(FAINT));
        }
    }
    ui.label(caption(&format!(
        "CPU: wait {}, record {}, submit {}",
        numbers::millis(row.wait_ms),
        numbers::millis(row.record_ms),
        numbers::millis(row.submit_ms)
    )));
}

/// Draws the plot's legend, with each stage's newest time.
fn stages(ui: &mut Ui, row: &FrameRow) {
    Grid::new("stages").num_columns(4).spacing([12.0, 2.0]).show(ui, |ui| {
        for (i, name) in STAGES.iter().enumerate() {
            ui.horizontal(|ui| {
                ui.set_width(58.0);
                let (square, _) = ui.allocate_exact_size(vec2(9.0, 9.0), Sense::hover());
                ui.painter().rect_filled(square, 2.0, STAGE_COLORS[i]);
                ui.label(RichText::new(*name).color(FAINT));
            });
            figure(ui, &numbers::millis(row.stage_ms[i]), style::TEXT);
            if i % 2 == 1 {
                ui.end_row();
            }
        }
    });
}

fn gpu(ui: &mut Ui, spread: &TimeSummary, budget_ms: f32) {
    ui.columns_const(|columns: &mut [Ui; 3]| {
        let figures = [("now", spread.now_ms), ("median", spread.median_ms), ("99 %", spread.p99_ms)];
        for (ui, (name, ms)) in columns.iter_mut().zip(figures) {
            let color = if ms > budget_ms { BAD } else { GOOD };
            ui.label(caption(name));
            ui.label(RichText::new(numbers::millis(ms)).size(15.0).color(color));
        }
    });
}

/// Tells what the newest frame drew.
fn points(ui: &mut Ui, row: Option<&FrameRow>) {
    let text = |figure: fn(&FrameRow) -> String| row.map_or("–".to_string(), figure);
    let rows = [
        ("Points read", text(|row| numbers::count(row.points_read))),
        ("Points on the GPU", text(|row| numbers::count(row.points_resident))),
        ("Visible nodes", text(|row| numbers::count(row.visible_nodes.into()))),
        ("Batches", text(|row| numbers::count(row.visible_batches.into()))),
        ("Quality", text(|row| row.quality.to_string())),
    ];
    for (name, value) in rows {
        fact(ui, name, &value);
    }
    if let Some(row) = row.filter(|row| row.upload_bytes > 0) {
        fact(ui, "Upload a frame", &numbers::bytes(row.upload_bytes));
    }
    if let Some(row) = row.filter(|row| row.lod_scale != 1.0 || row.resolution_scale != 1.0) {
        let text = format!("LOD ×{:.2}, edge ×{:.2}", row.lod_scale, row.resolution_scale);
        fact(ui, "Reduced to", &text);
    }
}

/// Draws the choices: settings that a walk can change, a line each, and help.
fn choices(ui: &mut Ui, contents: &Contents, view: &mut WindowState) -> Option<Action> {
    let Contents { widgets, state, .. } = contents;
    // The user changes at most one thing from one picture to the next.
    let mut action = None;
    Grid::new("choices").num_columns(2).spacing([12.0, 5.0]).show(ui, |ui| {
        let mut act = |asked| action = Some(asked);
        widget::row(ui, widgets, "window.mirror", view.mirror, |mirror| view.mirror = mirror);
        widget::row(ui, widgets, "window.overlay", state.overlay, |overlay| act(Action::SetOverlay(overlay)));
        widget::row(ui, widgets, "locomotion.speed_factor", state.speed, |speed| {
            act(Action::SetSpeed(speed))
        });
    });
    let meaning = overlay_meaning(state.overlay, contents.history.newest());
    if !meaning.is_empty() {
        ui.label(caption(meaning));
        ui.label(caption("The GPU's times above are without it."));
    }
    ui.horizontal(|ui| {
        if ui.button("Keys (F1)").clicked() {
            view.help = !view.help;
        }
        if ui.button("Hide (Tab)").clicked() {
            view.panel = false;
        }
    });
    action
}

/// Tells what an overlay's colors mean. `row` is the newest frame's.
fn overlay_meaning(overlay: Overlay, row: Option<&FrameRow>) -> &'static str {
    let is_closest = row.is_some_and(|row| row.quality == Quality::Closest.name());
    match overlay {
        Overlay::None => "",
        Overlay::Rings => "Angle from the gaze: inner ring blue, middle green, outer orange.",
        Overlay::Nodes => "Cubes of the nodes that are drawn, a color a level; faint behind surfaces.",
        Overlay::Overdraw if is_closest => "Not in the quality 'closest', which counts no points.",
        Overlay::Overdraw => "Points that a pixel blends: 1 dark, 8 red, 64 and more white.",
        Overlay::Depth => "Near dark, far white, each color a factor of 7; black where nothing is.",
        Overlay::Precision => "Boxes of batches, by bits read: 10 blue, 20 green, 30 orange.",
    }
}

/// Draws what opens another scan; returns the action that opens one that was opened before.
fn opening(ui: &mut Ui, contents: &Contents, view: &mut WindowState) -> Option<Action> {
    let before = contents.load.scan.as_ref()?;
    let mut asked = None;
    ui.horizontal(|ui| {
        view.opening |= ui.button("Open…").on_hover_text("Open another scan (Ctrl+O)").clicked();
        if contents.recent.is_empty() {
            return;
        }
        ui.menu_button("Recent", |ui| {
            for scan in contents.recent {
                let paths: Vec<String> = scan.files.iter().map(|file| file.display().to_string()).collect();
                let paths = paths.join("\n");
                let gone = format!("{paths}\nThe file is gone.");
                let button = ui.add_enabled(scan.is_there, Button::new(names(&scan.files)));
                if button.on_hover_text(paths).on_disabled_hover_text(gone).clicked() {
                    asked = Some(open::open(scan.files.clone(), before));
                }
            }
        });
    });
    asked
}

/// Tells what the readers found; returns the action that the user asked for.
fn scan(ui: &mut Ui, contents: &Contents) -> Option<Action> {
    let Contents { load, state, widgets, .. } = contents;
    let mut action = None;
    if !load.facts.is_empty() || load.error.is_some() {
        fold(ui, "Scan", true, |ui| {
            for (name, value) in &load.facts {
                fact(ui, name, value);
            }
            action = reading::show(ui, load, state.stance.as_ref(), widgets);
        });
    }
    if !load.warnings.is_empty() {
        let title = format!("Warnings ({})", load.warnings.len());
        fold(ui, &title, true, |ui| {
            for warning in &load.warnings {
                ui.label(RichText::new(warning).small().color(WARN));
            }
        });
    }
    action
}

/// Tells what the walk runs on.
fn machine(ui: &mut Ui, contents: &Contents) {
    fold(ui, "Machine", true, |ui| {
        fact(ui, "GPU", &contents.headset.device);
        fact(ui, "Headset", &contents.headset.runtime);
        fact(ui, "Session", contents.headset.session);
        if let Some([width, height]) = contents.eye_px {
            fact(ui, "An eye", &format!("{width} × {height} px"));
        }
    });
}

fn figure(ui: &mut Ui, text: &str, color: Color32) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.set_width(50.0);
        ui.label(RichText::new(text).color(color));
    });
}
