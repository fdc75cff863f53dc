//! Labels beside the controllers that say what their buttons do: they are seen for the first half minute in which there are
//! controllers, and again when the user asks.

use super::menu::label_pose;
use super::moving::Hand;
use super::scenery::SeenHands;
use base::space::Pose;
use glam::DVec3;
use xr::controllers::Profile;

/// Seconds for which labels are seen.
const SEEN_S: f64 = 30.0;
/// Edge of a label, meters.
pub(super) const EDGE_M: f64 = 0.15;
/// Distance of a label's middle from its controller, outwards, meters.
const ASIDE_M: f64 = 0.13;

/// What labels are seen of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ButtonLabels {
    /// The kind of controller in each hand, if one is there.
    pub profiles: [Option<&'static Profile>; 2],
    /// The hand whose stick moves.
    pub moving_hand: Hand,
}

/// The labels, from one frame to the next.
#[derive(Clone, Debug)]
pub struct ButtonHelp {
    labels: ButtonLabels,
    /// Seconds for which they are still seen.
    left_s: f64,
}

impl ButtonHelp {
    /// Labels that are seen at first only if `begins`.
    #[must_use]
    pub fn new(moving_hand: Hand, begins: bool) -> Self {
        let labels = ButtonLabels { profiles: [None; 2], moving_hand };
        Self { labels, left_s: if begins { SEEN_S } else { 0.0 } }
    }

    /// Shows the labels anew, or no longer.
    pub fn toggle(&mut self) {
        self.left_s = if self.shown().is_some() { 0.0 } else { SEEN_S };
    }

    /// Takes in the hands of a frame that shows a scan. Time without controllers does not count.
    pub(super) fn advance(&mut self, seconds: f64, hands: &SeenHands) {
        self.labels.profiles = hands.controllers.hands.map(|hand| hand.profile);
        if self.shown().is_some() {
            self.left_s -= seconds;
        }
    }

    /// What labels are seen of, while they are.
    #[must_use]
    pub fn shown(&self) -> Option<ButtonLabels> {
        let is_shown = self.left_s > 0.0 && self.labels.profiles.iter().any(Option::is_some);
        is_shown.then_some(self.labels)
    }
}

/// The poses of the labels of both hands, for those that have a controller: outwards of it, upright, facing the head.
pub(super) fn poses(hands: &SeenHands, stage_from_head: &Pose) -> [Option<Pose>; 2] {
    let right = (stage_from_head.orientation * DVec3::X).with_y(0.0).normalize_or(DVec3::X);
    [-1.0, 1.0].map(|side: f64| {
        let hand = &hands.controllers.hands[usize::from(side > 0.0)];
        let grip = hand.profile.and(hand.stage_from_grip)?;
        Some(label_pose(grip.position + side * ASIDE_M * right, stage_from_head))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use xr::HandInput;
    use xr::controllers::PROFILES;

    fn hands(profiles: [Option<&'static Profile>; 2]) -> SeenHands {
        let mut hands = SeenHands::default();
        hands.controllers.hands = profiles.map(|profile| {
            let pose = Pose { position: DVec3::new(0.0, 1.1, -0.4), ..Pose::IDENTITY };
            HandInput { profile, stage_from_grip: Some(pose), ..HandInput::default() }
        });
        hands
    }

    #[test]
    fn labels_are_seen_for_half_a_minute_of_controllers_and_when_asked_for() {
        let (index, none) = (Some(&PROFILES[0]), hands([None; 2]));
        let held = hands([None, index]);
        let mut help = ButtonHelp::new(Hand::Left, true);
        help.advance(100.0, &none);
        assert_eq!(help.shown(), None, "there is nothing to label");
        help.advance(SEEN_S - 1.0, &held);
        assert_eq!(help.shown().map(|labels| labels.profiles), Some([None, index]));
        help.advance(2.0, &held);
        assert_eq!(help.shown(), None);
        help.toggle();
        assert!(help.shown().is_some());
        help.toggle();
        assert_eq!(help.shown(), None);
        let mut off = ButtonHelp::new(Hand::Left, false);
        off.advance(0.1, &held);
        assert_eq!(off.shown(), None);
    }

    #[test]
    fn labels_stand_outwards_of_their_controllers_and_face_the_head() {
        let head = Pose { position: DVec3::new(0.0, 1.7, 0.0), ..Pose::IDENTITY };
        let both = Some(&PROFILES[0]);
        let [Some(left), Some(right)] = poses(&hands([both; 2]), &head) else { panic!("two labels") };
        assert_eq!([left.position.x, right.position.x], [-ASIDE_M, ASIDE_M]);
        assert!(
            (right.orientation * DVec3::Z - (head.position - right.position).normalize()).length() < 1e-9
        );
        assert!(poses(&hands([None, both]), &head)[0].is_none(), "a bare hand has no buttons");
    }
}
