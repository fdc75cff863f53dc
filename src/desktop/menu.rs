//! The menu that is seen in the headset: large buttons for a ray or a fingertip; and the label that says how large two hands
//! make the scan. egui paints them into a texture, on a thread of its own, whenever hands or what is shown have changed.

use super::easel::{Easel, PIXELS_PER_POINT};
use super::{Widget, buttons, numbers, style};
use crate::walk::action::{Action, Stance};
use crate::walk::appearance::QualityPreset;
use crate::walk::link::PaintEnd;
use crate::walk::menu::{MenuInput, PaintedPanel};
use crate::walk::moving::{Turn, VignetteOptions};
use crate::walk::state::Snapshot;
use base::task::CancelToken;
use egui::{Button, CentralPanel, Event, Frame, Margin, Modifiers, PointerButton, Pos2, RichText, Ui, vec2};
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::Duration;

/// Size of the menu's texture, pixels.
pub(super) const SIZE_PX: [u32; 2] = [900, 1440];
/// Size of the label's texture, pixels.
const LABEL_PX: [u32; 2] = [432, 144];
/// Pause between two looks at what hands do, while it is open.
const LOOK_EVERY: Duration = Duration::from_millis(12);
/// Pause between two looks whether it has been opened.
const LOOK_CLOSED_EVERY: Duration = Duration::from_millis(60);
/// Height of a button, points.
const BUTTON: f32 = 29.0;

/// Paints the menu of a walk until `stop` is requested, and sends what is chosen in it.
pub fn paint(walk: &PaintEnd, actions: &Sender<Action>, stop: &CancelToken) {
    let mut easel: Option<Easel> = None;
    let mut painted: Option<(Snapshot, MenuInput)> = None;
    while !stop.is_cancelled() {
        let snapshot = walk.snapshot();
        let gpu = walk.gpu().filter(|gpu| gpu.lost().is_none());
        let wanted = snapshot.stance.and_then(|stance| Some((wanted(&snapshot, &stance)?, stance)));
        let Some((gpu, (panel, stance))) = gpu.zip(wanted) else {
            if let Some(easel) = easel.take() {
                walk.set_panel(easel.gpu(), None);
            }
            painted = None;
            std::thread::sleep(LOOK_CLOSED_EVERY);
            continue;
        };
        let size_px = match panel {
            PaintedPanel::Menu => SIZE_PX,
            PaintedPanel::Scale => LABEL_PX,
            PaintedPanel::Buttons => buttons::SIZE_PX,
        };
        let is_fit = |easel: &Easel| Arc::ptr_eq(easel.gpu(), &gpu) && easel.size_px() == size_px;
        if !easel.as_ref().is_some_and(is_fit) {
            // The menu of another GPU cannot be shown on this one.
            (easel, painted) = (Easel::new(&gpu, size_px), None);
        }
        let input = walk.menu_input();
        if let Some(easel) = easel.as_mut().filter(|_| painted != Some((snapshot, input))) {
            let events = match panel {
                PaintedPanel::Menu => events(painted.map(|(_, before)| before).unwrap_or_default(), input),
                PaintedPanel::Scale | PaintedPanel::Buttons => Vec::new(),
            };
            let mut chosen = Vec::new();
            let runtime = walk.runtime();
            let picture = easel.paint(events, |ui| match (panel, &snapshot.buttons) {
                (PaintedPanel::Menu, _) => chosen.extend(contents(ui, &snapshot, &stance, &runtime)),
                (PaintedPanel::Buttons, Some(labels)) => buttons::contents(ui, labels),
                (PaintedPanel::Scale | PaintedPanel::Buttons, _) => label(ui, stance.scale),
            });
            if let Some(picture) = picture {
                walk.set_panel(&gpu, Some((panel, picture)));
                painted = Some((snapshot, input));
            }
            for action in chosen {
                // Sending fails if the walk has ended.
                let _ = actions.send(action);
            }
        }
        std::thread::sleep(LOOK_EVERY);
    }
}

/// What is to be painted for the headset.
fn wanted(snapshot: &Snapshot, stance: &Stance) -> Option<PaintedPanel> {
    if snapshot.menu.is_some() {
        Some(PaintedPanel::Menu)
    } else if stance.is_scaling {
        Some(PaintedPanel::Scale)
    } else {
        snapshot.buttons.map(|_| PaintedPanel::Buttons)
    }
}

/// Draws the label.
pub(super) fn label(ui: &mut Ui, scale: f64) {
    let frame = Frame::new().inner_margin(Margin::same(6)).fill(style::card().fill.to_opaque());
    CentralPanel::default().frame(frame).show(ui, |ui| {
        ui.centered_and_justified(|ui| ui.label(RichText::new(numbers::scale(scale)).size(18.0)));
    });
}

/// What egui is told of a hand that did `before` and does `now`.
fn events(before: MenuInput, now: MenuInput) -> Vec<Event> {
    let place = |at: [f64; 2]| {
        Pos2::from([0, 1].map(|axis: usize| at[axis] as f32 * SIZE_PX[axis] as f32 / PIXELS_PER_POINT))
    };
    let button = |at: [f64; 2], pressed: bool| Event::PointerButton {
        pos: place(at),
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    match (before.at, now.at) {
        // A press that began elsewhere is none of a button.
        (None, Some(at)) if !now.is_pressed => vec![Event::PointerMoved(place(at))],
        (None, Some(_)) | (None, None) => Vec::new(),
        (Some(_), Some(at)) => {
            let mut events = vec![Event::PointerMoved(place(at))];
            if before.is_pressed != now.is_pressed {
                events.push(button(at, now.is_pressed));
            }
            events
        }
        (Some(_), None) => vec![Event::PointerGone],
    }
}

/// Draws the menu; returns the actions that were chosen.
pub(super) fn contents(ui: &mut Ui, snapshot: &Snapshot, stance: &Stance, runtime: &str) -> Vec<Action> {
    let mut chosen = Vec::new();
    let frame = Frame::new().inner_margin(Margin::same(12)).fill(style::card().fill.to_opaque());
    CentralPanel::default().frame(frame).show(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(6.0, 5.0);
        let hand = snapshot.menu.unwrap_or_default();
        row(ui, &mut chosen, &[("Back to the start", Action::Reset)]);
        let size = if stance.scale == 1.0 {
            ("As a model", Action::ShowModel)
        } else {
            ("As large as life", Action::LifeSize)
        };
        let way = if stance.is_walking { "Fly" } else { "Walk on floors" };
        row(ui, &mut chosen, &[size, (way, Action::ToggleWalking)]);
        title(ui, &format!("Places: {} kept", stance.num_places));
        row(
            ui,
            &mut chosen,
            &[("Keep", Action::SavePlace), ("Before", Action::PreviousPlace), ("Next", Action::NextPlace)],
        );
        title(ui, &format!("Speed {}", numbers::with_unit(snapshot.speed.into(), "times")));
        row(ui, &mut chosen, &[("Slower", Action::Faster(-2.0)), ("Faster", Action::Faster(2.0))]);
        title(ui, &format!("Height {:+.1} m", stance.raised_m));
        row(
            ui,
            &mut chosen,
            &[
                ("Lower", Action::Raise(-0.1)),
                ("Higher", Action::Raise(0.1)),
                ("Seated", Action::ToggleSeated),
            ],
        );
        title(ui, "Comfort");
        let turn = match stance.turn {
            Turn::Snap => ("Turns by steps", Action::SetTurn(Turn::Smooth)),
            Turn::Smooth => ("Turns smoothly", Action::SetTurn(Turn::Snap)),
        };
        row(ui, &mut chosen, &[turn, vignette(stance)]);
        title(
            ui,
            &match snapshot.preset {
                Some(preset) => format!("Picture: {}", preset.name()),
                None => "Picture: as set".into(),
            },
        );
        let presets =
            QualityPreset::ALL.map(|preset| (Widget::title_of(preset.name()), Action::SetPreset(preset)));
        let presets = presets.each_ref().map(|(name, action)| (name.as_str(), action.clone()));
        row(ui, &mut chosen, &presets);
        row(ui, &mut chosen, &[("What the buttons do", Action::ToggleButtons)]);
        ui.label(RichText::new(recenter_help(runtime)).small());
        row(ui, &mut chosen, &[("Close", Action::ToggleMenu(hand)), ("Leave scanwalk", Action::Quit)]);
    });
    chosen
}

/// Says how dark the edge of sight becomes, and changes it: to what it was at start, the most, and the least.
fn vignette(stance: &Stance) -> (&'static str, Action) {
    let VignetteOptions { at_start, range: [least, most] } = stance.vignette_options;
    let words = match stance.vignette {
        part if part <= least => "Dark edge: none",
        part if part >= most => "Dark edge: strong",
        _ => "Dark edge: some",
    };
    let next = [at_start, most].into_iter().find(|part| *part > stance.vignette).unwrap_or(least);
    (words, Action::SetVignette(next))
}

/// How one turns and moves the stage to where one is, with this runtime.
fn recenter_help(runtime: &str) -> &'static str {
    let is = |names: &[&str]| names.iter().any(|name| runtime.to_lowercase().contains(name));
    if is(&["steamvr"]) {
        "To recenter: the system button, then “Reset seated position”, looking ahead."
    } else if is(&["oculus", "meta", "quest"]) {
        "To recenter: hold the Meta button of the right controller, looking ahead."
    } else if is(&["pico", "vive", "windows mixed reality"]) {
        "To recenter: hold the right controller's system button, looking ahead."
    } else {
        "To recenter: the headset's own button for it, held while you look ahead."
    }
}

fn title(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).color(style::FAINT));
}

/// Draws buttons side by side, which share the width.
fn row(ui: &mut Ui, chosen: &mut Vec<Action>, buttons: &[(&str, Action)]) {
    let gaps = ui.spacing().item_spacing.x * (buttons.len() - 1) as f32;
    let width = (ui.available_width() - gaps) / buttons.len() as f32;
    ui.horizontal(|ui| {
        // Three words share the width.
        ui.spacing_mut().button_padding.x = 3.0;
        for (text, action) in buttons {
            if ui.add_sized([width, BUTTON], Button::new(*text)).clicked() {
                chosen.push(action.clone());
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_press_counts_where_it_begins() {
        let at = |x: f64, is_pressed| MenuInput { at: Some([x, 0.5]), is_pressed };
        let away = MenuInput::default();
        let presses = |before, now| {
            let events = events(before, now);
            events.iter().filter(|event| matches!(event, Event::PointerButton { pressed: true, .. })).count()
        };
        assert_eq!(presses(at(0.5, false), at(0.5, true)), 1);
        assert_eq!(presses(away, at(0.5, true)), 0, "a trigger that was held before it pointed here");
        assert_eq!(presses(at(0.5, true), at(0.6, true)), 0, "it is held");
        assert!(events(at(0.5, true), away) == [Event::PointerGone]);
        let moved = events(away, at(0.5, false));
        assert!(moved == [Event::PointerMoved(Pos2::new(150.0, 240.0))], "{moved:?}");
    }

    #[test]
    fn the_dark_edge_goes_round_by_what_was_set() {
        let round = |at_start: f32| {
            let mut stance = Stance {
                vignette: at_start,
                vignette_options: VignetteOptions { at_start, ..VignetteOptions::sample() },
                ..Stance::sample()
            };
            [(); 3].map(|()| {
                let (words, Action::SetVignette(next)) = vignette(&stance) else { panic!("it darkens") };
                stance.vignette = next;
                (words.trim_start_matches("Dark edge: "), next)
            })
        };
        assert_eq!(round(0.3), [("some", 1.0), ("strong", 0.0), ("none", 0.3)]);
        assert_eq!(round(0.0), [("none", 1.0), ("strong", 0.0), ("none", 1.0)]);
        assert_eq!(round(1.0), [("strong", 0.0), ("none", 1.0), ("strong", 0.0)]);
    }
}
