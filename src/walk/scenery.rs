//! What the walk shows beside the scan: the surround with its grid, the card while there is no scan, the hands, and the
//! arc by which one of them aims.

use super::link::WalkEnd;
use super::locomotion::{Locomotion, head_of};
use super::{buttons, marks, shapes_of_hands};
use base::space::{Eye, Pose};
use glam::DVec3;
use render::Renderer;
use render::gpu::QueueGuard;
use render::scenery::{SceneryView, Shapes};
use xr::{ControllerInput, HandInput, HandJoints, Panel, StageEye};

/// Distance of the card before the viewer, meters.
const AWAY_M: f64 = 2.0;
/// Width of the card, meters: half a right angle's half, so that all of it is seen without turning one's head.
const CARD_WIDTH_M: f64 = 1.1;
/// The card comes before the viewer again when they have turned away from it by this angle, radians.
const FOLLOW_RAD: f64 = 1.0;

/// Width of the ray that points at the menu, meters.
const POINTER_M: f64 = 0.003;
/// Color of that ray, linear light and how much it covers.
const POINTER: [f32; 4] = [0.3, 0.6, 1.0, 0.8];

/// From where a frame is seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stand<'a> {
    /// The eyes in the stage.
    pub eyes: &'a [StageEye; 2],
    /// Pixels of each eye that are drawn.
    pub drawn_px: [[u32; 2]; 2],
    /// Depth of the near plane, meters.
    pub near_m: f64,
    /// Where the stage stands in the scan, if there is one.
    pub locomotion: Option<&'a Locomotion>,
    /// Hands as last known.
    pub hands: &'a SeenHands,
    /// The menu, if it is to be drawn.
    pub menu: Option<&'a Panel>,
    /// The labels of the controllers' buttons, if they are seen.
    pub buttons: Option<&'a wgpu::Texture>,
    /// The hand that points at the menu, and where in the stage.
    pub pointing: Option<(usize, DVec3)>,
}

/// Both hands of a frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SeenHands {
    /// What they hold down, and where controllers are.
    pub controllers: ControllerInput,
    /// Joints of hands that are tracked without a controller.
    pub joints: [Option<HandJoints>; 2],
}

/// What the picture of the card shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum ShownCard {
    /// What goes on while there is no scan.
    #[default]
    Loading,
    /// The menu, or the label of the scale.
    Menu,
    /// The labels of the controllers' buttons.
    Buttons,
}

/// The scenery, from one frame to the next.
#[derive(Debug, Default)]
pub(super) struct SceneryOfWalk {
    shapes: Shapes,
    /// The picture that the renderer has.
    card: Option<wgpu::Texture>,
    /// What it shows.
    shown: ShownCard,
    /// Chosen when the card is first shown, so that it stands still.
    stage_from_card: Option<Pose>,
}

impl SceneryOfWalk {
    /// Tells the renderer what to show; never waits for whoever paints the card.
    pub fn show(&mut self, renderer: &mut Renderer, queue: &QueueGuard, link: &WalkEnd, stand: Stand) {
        self.shapes.clear();
        let stage_from_head = head_of(stand.eyes);
        let head = stage_from_head.position;
        if let Some(locomotion) = stand.locomotion {
            marks::lay(&mut self.shapes, locomotion.guides(), locomotion.stage(), head);
        }
        shapes_of_hands::lay(&mut self.shapes, stand.hands, head);
        if let Some((hand, to)) = stand.pointing {
            lay_pointer(&mut self.shapes, &stand.hands.controllers.hands[hand], to, head);
        }
        // A scan is not hidden behind a card, though some of it may be still to come.
        match (self.shown, stand.menu) {
            (ShownCard::Menu, Some(menu)) => self.shapes.card(&menu.stage_from_panel, menu.size_m),
            (ShownCard::Buttons, None) if stand.buttons.is_some() => {
                let labels = buttons::poses(stand.hands, &stage_from_head);
                for (pose, part) in labels.iter().zip([[0.0, 0.5], [0.5, 1.0]]) {
                    pose.iter().for_each(|pose| self.shapes.card_part(pose, [buttons::EDGE_M; 2], part));
                }
            }
            (ShownCard::Loading, None) if stand.locomotion.is_none() => self.lay_card(&stage_from_head),
            _ => {}
        }
        let eyes = [0, 1].map(|eye: usize| Eye {
            world_from_view: stand.eyes[eye].stage_from_view,
            fov: stand.eyes[eye].fov,
            size_px: stand.drawn_px[eye],
            gaze_in_view: Eye::AHEAD,
        });
        let view = SceneryView {
            eyes: &eyes,
            near_m: stand.near_m,
            units_per_m: stand.locomotion.map_or(1.0, |locomotion| locomotion.stage().units_per_m()),
            stage_from_grid: stand.locomotion.map_or(Pose::IDENTITY, Locomotion::stage_from_start),
            vignette: stand.locomotion.map_or(0.0, |locomotion| locomotion.guides().vignette),
        };
        renderer.set_scenery(queue, &view, &self.shapes);
        // Another picture is seen from the next frame on: this one's commands are recorded.
        let (shown, wanted) = match (stand.menu, stand.buttons) {
            (Some(menu), _) => (ShownCard::Menu, Some(Some(menu.picture.clone()))),
            (None, Some(labels)) => (ShownCard::Buttons, Some(Some(labels.clone()))),
            (None, None) => (ShownCard::Loading, link.try_card()),
        };
        if let Some(card) = wanted.filter(|card| *card != self.card) {
            renderer.set_card(card.as_ref());
            (self.card, self.shown) = (card, shown);
        }
    }

    fn lay_card(&mut self, stage_from_head: &Pose) {
        let Some(card) = &self.card else {
            self.stage_from_card = None;
            return;
        };
        let height_m = CARD_WIDTH_M * f64::from(card.height()) / f64::from(card.width());
        let still = self.stage_from_card.filter(|pose| is_in_sight(pose, stage_from_head));
        let stage_from_card = still.unwrap_or_else(|| before(stage_from_head));
        self.stage_from_card = Some(stage_from_card);
        self.shapes.card(&stage_from_card, [CARD_WIDTH_M, height_m]);
    }
}

/// Lays out the ray of a hand that points at the menu.
fn lay_pointer(shapes: &mut Shapes, hand: &HandInput, to: DVec3, head: DVec3) {
    if let Some(aim) = hand.stage_from_aim {
        shapes.band([aim.position, to], POINTER_M, head, [POINTER, POINTER]);
    }
}

/// The horizontal direction in which a head looks.
fn ahead(stage_from_head: &Pose) -> DVec3 {
    let ahead = stage_from_head.orientation * DVec3::NEG_Z;
    ahead.with_y(0.0).normalize_or(DVec3::NEG_Z)
}

/// True if a head looks about where the card is.
fn is_in_sight(stage_from_card: &Pose, stage_from_head: &Pose) -> bool {
    let to_card = (stage_from_card.position - stage_from_head.position).with_y(0.0);
    to_card.length() < 2.0 * AWAY_M && ahead(stage_from_head).angle_between(to_card) < FOLLOW_RAD
}

/// A pose upright before a head, at its height, that faces it.
fn before(stage_from_head: &Pose) -> Pose {
    let ahead = ahead(stage_from_head);
    let position = stage_from_head.position + AWAY_M * ahead;
    Pose::look_at(position, position + ahead, DVec3::Y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn head(yaw: f64) -> Pose {
        let orientation = DQuat::from_rotation_y(yaw) * DQuat::from_rotation_x(-0.4);
        Pose { position: DVec3::new(0.3, 1.6, -0.2), orientation }
    }

    #[test]
    fn the_card_stands_upright_before_the_head_and_faces_it() {
        let card = before(&head(0.8));
        assert!(((card.position - head(0.8).position).length() - AWAY_M).abs() < 1e-9);
        assert!((card.orientation * DVec3::Y - DVec3::Y).length() < 1e-9);
        let to_head = (head(0.8).position - card.position).normalize();
        assert!((card.orientation * DVec3::Z - to_head).length() < 1e-9);
    }

    #[test]
    fn the_card_stands_still_until_the_viewer_turns_away() {
        let card = before(&head(0.0));
        assert!(is_in_sight(&card, &head(0.9)) && !is_in_sight(&card, &head(1.2)));
        let far = Pose { position: DVec3::new(0.0, 1.6, 9.0), orientation: DQuat::IDENTITY };
        assert!(!is_in_sight(&card, &far));
    }
}
