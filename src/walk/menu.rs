//! The menu in the headset: it opens by the wrist, stays where it opened, and takes what hands point at or touch. And the
//! label between two hands that says how large they make the scan.

use super::link::WalkEnd;
use super::scenery::SeenHands;
use base::space::Pose;
use glam::DVec3;
use xr::{HandInput, HandJoints, Panel, joint};

/// Width, height of the menu, meters.
pub const SIZE_M: [f64; 2] = [0.2625, 0.42];
/// Width, height of the label, meters.
const LABEL_M: [f64; 2] = [0.18, 0.06];
/// Height of the label above the hands, meters.
const LABEL_ABOVE_M: f64 = 0.08;
/// Height of its middle above the hand that opens it, meters.
const ABOVE_M: f64 = 0.235;
/// Distance before the head at which it opens when nobody knows where the hand is, meters.
const BEFORE_M: f64 = 0.5;
/// Longest ray that points at it, meters.
const REACH_M: f64 = 3.0;
/// A fingertip nearer than this points at it, meters.
const NEAR_M: f64 = 0.05;
/// A fingertip nearer than this presses, meters.
const TOUCH_M: f64 = 0.008;

/// What the picture shows that is painted for the headset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaintedPanel {
    /// The menu.
    Menu,
    /// The label that says how large two hands make the scan.
    Scale,
    /// The labels of both controllers' buttons, side by side.
    Buttons,
}

/// What hands do to the menu.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MenuInput {
    /// The place that is pointed at: fractions of the width from the left and of the height from the top.
    pub at: Option<[f64; 2]>,
    /// True while it is pressed.
    pub is_pressed: bool,
}

/// The menu of a walk, from one frame to the next.
#[derive(Debug, Default)]
pub(super) struct MenuOfWalk {
    /// Where it stands while it is open.
    stage_from_menu: Option<Pose>,
    /// What was painted last.
    picture: Option<(PaintedPanel, wgpu::Texture)>,
    /// What was last told to whoever paints it.
    told: MenuInput,
    /// The hand that points at it, and the place in the stage.
    pub pointing: Option<(usize, DVec3)>,
}

impl MenuOfWalk {
    /// Opens or closes it as the state says (`opened_by` is the hand), and takes in what hands do to it. Returns the hands as
    /// all else is to have them: the one that points at the menu presses nothing besides.
    pub fn advance(
        &mut self,
        opened_by: Option<usize>,
        hands: &SeenHands,
        stage_from_head: &Pose,
        link: &WalkEnd,
    ) -> SeenHands {
        let mut rest = *hands;
        self.pointing = None;
        let Some(hand) = opened_by else {
            self.stage_from_menu = None;
            return rest;
        };
        let open = || opening(hands.controllers.hands.get(hand), stage_from_head);
        let stage_from_menu = *self.stage_from_menu.get_or_insert_with(open);
        // The hand that has opened it points last: it is near the menu by itself.
        let found = [1 - hand.min(1), hand.min(1)].into_iter().find_map(|hand| {
            let (controller, joints) = (&hands.controllers.hands[hand], hands.joints[hand].as_ref());
            pointing(&stage_from_menu, controller, joints).map(|input| (hand, input))
        });
        let mut input = MenuInput::default();
        if let Some((hand, (at, is_pressed))) = found {
            input = MenuInput { at: Some(at), is_pressed };
            self.pointing = Some((hand, place(&stage_from_menu, at)));
            rest.controllers.hands[hand].select = false;
        }
        // What cannot be told without waiting is told with the next frame.
        if input != self.told && link.try_point(input) {
            self.told = input;
        }
        rest
    }

    /// True while it is open.
    pub fn is_open(&self) -> bool {
        self.stage_from_menu.is_some()
    }

    /// What is to be shown, once it is painted: the menu, or the label of the scale where `stage_from_label` is; never waits
    /// for whoever paints it.
    pub fn panel(&mut self, link: &WalkEnd, stage_from_label: Option<Pose>) -> Option<Panel> {
        let menu = self.stage_from_menu.map(|menu| (PaintedPanel::Menu, menu, SIZE_M));
        let label = stage_from_label.map(|label| (PaintedPanel::Scale, label, LABEL_M));
        let (kind, stage_from_panel, size_m) = menu.or(label)?;
        Some(Panel { picture: self.painted(link, kind)?, stage_from_panel, size_m })
    }

    /// The labels of the controllers' buttons, once they are painted; they are not seen beside the menu.
    pub fn button_labels(&mut self, link: &WalkEnd) -> Option<wgpu::Texture> {
        if self.is_open() { None } else { self.painted(link, PaintedPanel::Buttons) }
    }

    /// The picture of this kind, if it is the one that is painted.
    fn painted(&mut self, link: &WalkEnd, kind: PaintedPanel) -> Option<wgpu::Texture> {
        if let Some(picture) = link.try_panel() {
            self.picture = picture;
        }
        self.picture.as_ref().filter(|(painted, _)| *painted == kind).map(|(_, picture)| picture.clone())
    }
}

/// The pose by a hand, upright and facing the head.
fn opening(hand: Option<&HandInput>, stage_from_head: &Pose) -> Pose {
    let head = stage_from_head.position;
    let held = hand.and_then(|hand| hand.stage_from_grip.or(hand.stage_from_aim));
    let ahead = (stage_from_head.orientation * DVec3::NEG_Z).with_y(0.0).normalize_or(DVec3::NEG_Z);
    let position = held.map_or(head + BEFORE_M * ahead, |held| held.position + ABOVE_M * DVec3::Y);
    facing(position, head, ahead)
}

/// The pose of the label between two hands that change the scale.
pub(super) fn label(hands: &SeenHands, stage_from_head: &Pose) -> Option<Pose> {
    let [left, right] = hands.controllers.hands.map(|hand| hand.stage_from_grip.or(hand.stage_from_aim));
    let middle = 0.5 * (left?.position + right?.position) + LABEL_ABOVE_M * DVec3::Y;
    Some(label_pose(middle, stage_from_head))
}

/// The pose of a label at `position`, which faces the head.
pub(super) fn label_pose(position: DVec3, stage_from_head: &Pose) -> Pose {
    facing(position, stage_from_head.position, stage_from_head.orientation * DVec3::NEG_Z)
}

/// A pose at `position`, upright and facing the head, which looks `ahead`.
fn facing(position: DVec3, head: DVec3, ahead: DVec3) -> Pose {
    let away = position - head;
    // A menu right above or below the head would face nowhere.
    let away = if away.with_y(0.0).length() > 1e-3 { away } else { ahead };
    Pose::look_at(position, position + away, DVec3::Y)
}

/// The place in the stage of a place in the menu.
fn place(stage_from_menu: &Pose, [u, v]: [f64; 2]) -> DVec3 {
    let in_menu = DVec3::new((u - 0.5) * SIZE_M[0], (0.5 - v) * SIZE_M[1], 0.0);
    stage_from_menu.position + stage_from_menu.orientation * in_menu
}

/// Where a hand points in the menu, and whether it presses there: by a fingertip that is near, else by its ray.
fn pointing(
    stage_from_menu: &Pose,
    hand: &HandInput,
    joints: Option<&HandJoints>,
) -> Option<([f64; 2], bool)> {
    let menu_from_stage = stage_from_menu.orientation.inverse();
    let in_menu = |p: DVec3| menu_from_stage * (p - stage_from_menu.position);
    let within = |p: DVec3| {
        let at = [p.x / SIZE_M[0] + 0.5, 0.5 - p.y / SIZE_M[1]];
        at.iter().all(|part| (0.0..1.0).contains(part)).then_some(at)
    };
    let tip = joints.map(|joints| joints[joint::INDEX_TIP].stage_from_joint.position);
    let tip = tip.or(hand.stage_from_aim.map(|aim| aim.position)).map(in_menu);
    if let Some(tip) = tip.filter(|tip| tip.z.abs() < NEAR_M)
        && let Some(at) = within(tip)
    {
        return Some((at, tip.z < TOUCH_M));
    }
    let aim = hand.stage_from_aim?;
    let (from, along) = (in_menu(aim.position), menu_from_stage * (aim.orientation * DVec3::NEG_Z));
    // Only its front is pointed at.
    let away = (from.z > 0.0 && along.z < 0.0).then(|| -from.z / along.z).filter(|away| *away < REACH_M)?;
    Some((within(from + away * along)?, hand.select))
}

#[cfg(test)]
mod tests {
    use super::super::link;
    use super::*;
    use glam::DQuat;
    use xr::Joint;

    const HEAD: Pose = Pose { position: DVec3::new(0.1, 1.6, 0.2), orientation: DQuat::IDENTITY };

    fn at(position: DVec3) -> HandInput {
        let pose = Pose { position, orientation: DQuat::IDENTITY };
        HandInput { stage_from_aim: Some(pose), stage_from_grip: Some(pose), ..HandInput::default() }
    }

    #[test]
    fn it_opens_above_the_hand_and_faces_the_head() {
        let hand = at(DVec3::new(-0.2, 1.1, -0.3));
        let menu = opening(Some(&hand), &HEAD);
        assert!((menu.position - DVec3::new(-0.2, 1.1 + ABOVE_M, -0.3)).length() < 1e-9);
        let to_head = (HEAD.position - menu.position).normalize();
        assert!((menu.orientation * DVec3::Z - to_head).length() < 1e-9);
        // Without a hand it opens before the head, and above the head it faces somewhere.
        assert!((opening(None, &HEAD).position - (HEAD.position - DVec3::Z * BEFORE_M)).length() < 1e-9);
        let above = opening(Some(&at(HEAD.position + DVec3::Y * 0.3)), &HEAD);
        assert!(above.orientation.is_finite() && above.orientation.is_normalized());
    }

    #[test]
    fn the_label_is_between_the_hands_and_faces_the_head() {
        let mut hands = SeenHands::default();
        assert_eq!(label(&hands, &HEAD), None);
        hands.controllers.hands = [at(DVec3::new(-0.3, 1.2, -0.4)), at(DVec3::new(0.5, 1.4, -0.4))];
        let label = label(&hands, &HEAD).expect("a label");
        assert!((label.position - DVec3::new(0.1, 1.3 + LABEL_ABOVE_M, -0.4)).length() < 1e-9);
        assert!(
            (label.orientation * DVec3::Z - (HEAD.position - label.position).normalize()).length() < 1e-9
        );
    }

    #[test]
    fn rays_and_fingertips_point_at_it() {
        let menu = Pose { position: DVec3::new(0.0, 1.5, -0.5), orientation: DQuat::IDENTITY };
        let mut hand = at(DVec3::new(0.05, 1.5, 0.0));
        let [across, down] = [0.05 / SIZE_M[0] + 0.5, 0.5];
        let is_at = |found: Option<([f64; 2], bool)>, pressed: bool| {
            found.is_some_and(|([u, v], is)| {
                (u - across).abs() < 1e-9 && (v - down).abs() < 1e-9 && is == pressed
            })
        };
        assert!(is_at(pointing(&menu, &hand, None), false));
        hand.select = true;
        assert!(is_at(pointing(&menu, &hand, None), true));
        // Past its edge, from behind, and from too far away nothing is pointed at.
        for from in [DVec3::new(0.2, 1.5, 0.0), DVec3::new(0.0, 1.5, -1.0), DVec3::new(0.0, 1.5, 9.0)] {
            assert_eq!(pointing(&menu, &at(from), None), None, "{from}");
        }
        // A fingertip hovers, then touches.
        let mut joints: HandJoints = [Joint::default(); 26];
        let mut touch = |z: f64| {
            joints[joint::INDEX_TIP].stage_from_joint.position = DVec3::new(0.05, 1.5, z - 0.5);
            pointing(&menu, &HandInput::default(), Some(&joints))
        };
        assert!(is_at(touch(0.03), false) && is_at(touch(0.001), true) && is_at(touch(-0.02), true));
        assert_eq!(touch(0.2), None);
    }

    #[test]
    fn the_hand_that_points_at_it_does_nothing_else() {
        let (walk, _actions, viewer) = link::link(crate::walk::state::Snapshot::sample());
        let mut menu = MenuOfWalk::default();
        let mut hands = SeenHands::default();
        hands.controllers.hands = [at(DVec3::new(-0.2, 1.2, -0.3)), at(DVec3::new(0.3, 1.2, -0.1))];
        menu.advance(Some(0), &hands, &HEAD, &walk);
        let middle = menu.stage_from_menu.expect("it is open").position;
        let from = middle + (HEAD.position - middle) * 0.8;
        let aim = Pose::look_at(from, middle, DVec3::Y);
        hands.controllers.hands[1] =
            HandInput { stage_from_aim: Some(aim), select: true, ..HandInput::default() };
        let rest = menu.advance(Some(0), &hands, &HEAD, &walk);
        assert!(!rest.controllers.hands[1].select && menu.pointing.is_some_and(|(hand, _)| hand == 1));
        let MenuInput { at: Some(at), is_pressed: true } = viewer.paint_end().menu_input() else {
            panic!("it was told")
        };
        assert!(at.iter().all(|part| (part - 0.5).abs() < 1e-9), "{at:?}");
        // Closed, it takes nothing.
        let rest = menu.advance(None, &hands, &HEAD, &walk);
        assert!(rest.controllers.hands[1].select && menu.pointing.is_none());
        assert!(menu.panel(&walk, None).is_none());
    }
}
