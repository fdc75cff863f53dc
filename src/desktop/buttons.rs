//! The labels beside the controllers: what each button does, for the kinds of controllers that are in the hands. Both hands' are
//! painted side by side, the left hand's at the left.

use super::style::{self, FAINT};
use crate::walk::buttons::ButtonLabels;
use egui::{CentralPanel, Frame, Margin, RichText, Ui, vec2};
use xr::controllers::{Control, Profile};

/// Size of the labels' texture, pixels: a square for each hand.
pub(super) const SIZE_PX: [u32; 2] = [1056, 528];

/// What the buttons of a hand's controller do: the part's name, and the rest of a line.
fn lines(profile: &'static Profile, hand: usize, moves: bool) -> Vec<(&'static str, &'static str)> {
    let does = |control| match control {
        Control::Move if moves => Some("move"),
        Control::Move => Some("turn; forward: teleport"),
        Control::Select => Some("choose; hold: aim"),
        Control::Grab | Control::Squeeze => Some("hold the scan"),
        Control::Menu => Some("menu"),
        Control::Reset => Some("hold: to the start"),
        Control::Pinch => Some("palm to you: menu"),
        Control::Aim | Control::Grip | Control::Press | Control::Vibration => None,
    };
    let parts = profile.bindings().filter(|part| part.hands.contain(hand));
    parts.filter_map(|part| Some((part.name()?, does(part.control)?))).collect()
}

/// Draws the labels of both hands.
pub(super) fn contents(ui: &mut Ui, labels: &ButtonLabels) {
    let frame = Frame::new().fill(style::card().fill.to_opaque());
    CentralPanel::default().frame(frame).show(ui, |ui| {
        ui.columns_const(|columns: &mut [Ui; 2]| {
            for (hand, ui) in columns.iter_mut().enumerate() {
                Frame::new().inner_margin(Margin::same(8)).show(ui, |ui| {
                    ui.spacing_mut().item_spacing = vec2(6.0, 3.0);
                    let moves = labels.moving_hand.index() == hand;
                    let profile = labels.profiles[hand];
                    for (part, does) in profile.map(|profile| lines(profile, hand, moves)).unwrap_or_default()
                    {
                        ui.label(RichText::new(part).small().color(FAINT));
                        ui.label(does);
                    }
                });
            }
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use xr::controllers::PROFILES;

    #[test]
    fn each_button_says_what_it_does() {
        let left = lines(&PROFILES[1], 0, true);
        for line in
            [("Stick", "move"), ("Grip", "hold the scan"), ("Y", "menu"), ("Trigger", "choose; hold: aim")]
        {
            assert!(left.contains(&line), "{line:?}: {left:?}");
        }
        let right = lines(&PROFILES[1], 1, false);
        for line in [("Stick", "turn; forward: teleport"), ("B", "menu"), ("A", "hold: to the start")] {
            assert!(right.contains(&line), "{line:?}: {right:?}");
        }
        assert!(!left.iter().any(|(part, _)| *part == "A"), "that hand has none");
        // All of them fit: two lines of text each, in a square.
        let points = SIZE_PX[1] as f32 / super::super::easel::PIXELS_PER_POINT;
        for profile in &PROFILES {
            for hand in [0, 1] {
                let num = lines(profile, hand, hand == 0).len();
                assert!(num > 0 && num as f32 * 27.0 < points, "{}: {num} lines", profile.name);
            }
        }
    }
}
