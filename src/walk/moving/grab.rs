//! Holding the world: with one hand it moves along, with two it turns about the vertical and grows, so that what was grabbed
//! stays under the hands. The horizon stays level: hands that tilt against each other tilt nothing.

use super::guides::Event;
use super::place::StagePlace;
use glam::{DVec2, DVec3};

/// Horizontal distance of the hands, meters, below which they do not say how the world is turned.
const LEAST_APART_M: f64 = 0.08;
/// The scale is caught at life size when it comes within this part of it.
const CATCH: f64 = 0.03;
/// It stays there until the hands are further off than this part.
const LET_GO: f64 = 0.06;

/// Hands that hold the world, or do not.
#[derive(Clone, Copy, Debug, Default)]
pub struct Grab {
    /// What each hand holds, in world space.
    held_in_world: [Option<DVec3>; 2],
    catch: Catch,
}

/// Whether the scale is held at life size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Catch {
    /// It may be caught.
    #[default]
    Free,
    /// It is as large as life.
    Caught,
    /// It has been let go, and has to come further away before it is caught again.
    Left,
}

impl Grab {
    /// Moves the stage so that what hands hold stays under them. `hands_in_stage` are those that grab, and whose place is
    /// known; `limits` are the least and the greatest scale. Returns what the hands feel.
    pub fn advance(
        &mut self,
        place: &mut StagePlace,
        hands_in_stage: [Option<DVec3>; 2],
        limits: [f64; 2],
    ) -> Option<Event> {
        let is_same = [0, 1]
            .iter()
            .all(|&hand: &usize| hands_in_stage[hand].is_some() == self.held_in_world[hand].is_some());
        if !is_same {
            let more = [0, 1]
                .iter()
                .any(|&hand: &usize| hands_in_stage[hand].is_some() && self.held_in_world[hand].is_none());
            self.hold(place, hands_in_stage);
            self.catch = if place.scale == 1.0 { Catch::Caught } else { Catch::Free };
            return more.then_some(Event::Hold);
        }
        match (hands_in_stage, self.held_in_world) {
            ([Some(left), Some(right)], [Some(held_left), Some(held_right)]) => {
                self.with_two(place, [left, right], [held_left, held_right], limits)
            }
            ([Some(hand), None], [Some(held), None]) | ([None, Some(hand)], [None, Some(held)]) => {
                place.bring(hand, held);
                None
            }
            _ => None,
        }
    }

    /// True while both hands hold the world, and may change the scale.
    #[must_use]
    pub fn is_scaling(&self) -> bool {
        self.held_in_world.iter().all(Option::is_some)
    }

    /// True while a hand holds the world.
    #[must_use]
    pub fn is_holding(&self) -> bool {
        self.held_in_world.iter().any(Option::is_some)
    }

    fn hold(&mut self, place: &StagePlace, hands_in_stage: [Option<DVec3>; 2]) {
        self.held_in_world = hands_in_stage.map(|hand| hand.map(|hand| place.p_in_world(hand)));
    }

    fn with_two(
        &mut self,
        place: &mut StagePlace,
        hands: [DVec3; 2],
        held: [DVec3; 2],
        limits: [f64; 2],
    ) -> Option<Event> {
        let (apart, held_apart) = (hands[1] - hands[0], held[1] - held[0]);
        let across = DVec2::new(apart.x, -apart.z);
        if across.length() > LEAST_APART_M && held_apart.truncate().length() > 0.0 {
            // Stage axes and world axes are one if the yaw is 0.
            place.yaw = across.angle_to(held_apart.truncate());
        }
        let mut event = None;
        if held_apart.length() > 0.0 && apart.length() > 0.0 {
            let wanted =
                (place.life_units_per_m() * apart.length() / held_apart.length()).clamp(limits[0], limits[1]);
            let off = (wanted - 1.0).abs();
            self.catch = match self.catch {
                Catch::Free if off < CATCH => {
                    event = Some(Event::Catch);
                    Catch::Caught
                }
                Catch::Caught if off > LET_GO => Catch::Left,
                Catch::Left if off > LET_GO => Catch::Free,
                catch => catch,
            };
            match self.catch {
                Catch::Caught => place.scale = 1.0,
                // What the hands have come away from it does not count: the scale goes on from life size.
                Catch::Left if off > LET_GO => {}
                _ => place.scale = wanted,
            }
        }
        place.bring(0.5 * (hands[0] + hands[1]), 0.5 * (held[0] + held[1]));
        if self.catch == Catch::Left && place.scale == 1.0 {
            self.hold(place, hands.map(Some));
        }
        event
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use proptest::prelude::*;

    const UTM: DVec3 = DVec3::new(5e5, 4e6, 100.0);
    const LIMITS: [f64; 2] = [0.01, 50.0];

    fn vec(range: f64) -> impl Strategy<Value = DVec3> {
        [-range..range, -range..range, -range..range].prop_map(DVec3::from_array)
    }

    fn place(yaw: f64, scale: f64) -> StagePlace {
        let mut place = StagePlace::new(UTM, yaw, 1.0 / 0.3048);
        place.scale = scale;
        place
    }

    proptest! {
        #[test]
        fn what_one_hand_holds_stays_under_it(
            yaw in -3.0..3.0, scale in 0.05..5.0, from in vec(1.0), to in vec(1.0), number in 0usize..2
        ) {
            let (mut place, mut grab) = (place(yaw, scale), Grab::default());
            let hands = |p| { let mut hands = [None; 2]; hands[number] = Some(p); hands };
            let held = place.p_in_world(from);
            prop_assert_eq!(grab.advance(&mut place, hands(from), LIMITS), Some(Event::Hold));
            grab.advance(&mut place, hands(to), LIMITS);
            prop_assert!((place.p_in_world(to) - held).length() < 1e-7);
            prop_assert!(place.yaw == yaw && place.scale == scale && !grab.is_scaling());
        }

        /// Hands that move as one body does, upright and of any size, keep both places under them.
        #[test]
        fn what_two_hands_hold_stays_under_both(
            yaw in -3.0..3.0f64, scale in 0.1..0.9f64, left in vec(0.8), right in vec(0.8),
            moved in vec(1.0), turned in -3.0..3.0f64, grown in 0.5..0.99f64
        ) {
            let apart = right - left;
            prop_assume!(DVec2::new(apart.x, apart.z).length() * grown > 0.1);
            let (mut place, mut grab) = (place(yaw, scale), Grab::default());
            let held = [left, right].map(|hand| place.p_in_world(hand));
            grab.advance(&mut place, [Some(left), Some(right)], LIMITS);
            let to = [left, right].map(|hand| DQuat::from_rotation_y(turned) * hand * grown + moved);
            grab.advance(&mut place, to.map(Some), LIMITS);
            prop_assert!((place.scale - scale * grown).abs() < 1e-9, "{}", place.scale);
            for (hand, held) in to.into_iter().zip(held) {
                prop_assert!((place.p_in_world(hand) - held).length() < 1e-6);
            }
        }

        /// However hands tilt, the horizon stays level and the middle between them in place.
        #[test]
        fn tilted_hands_tilt_nothing(left in vec(0.8), right in vec(0.8), to_left in vec(0.8), to_right in vec(0.8)) {
            let (mut place, mut grab) = (place(0.3, 0.4), Grab::default());
            let middle = place.p_in_world(0.5 * (left + right));
            grab.advance(&mut place, [Some(left), Some(right)], LIMITS);
            grab.advance(&mut place, [Some(to_left), Some(to_right)], LIMITS);
            prop_assert!(place.yaw.is_finite() && place.scale >= LIMITS[0] && place.scale <= LIMITS[1]);
            let error = (place.p_in_world(0.5 * (to_left + to_right)) - middle).length();
            prop_assert!(error < 1e-6, "{error}");
        }
    }

    #[test]
    fn life_size_catches_and_lets_go_once() {
        let (mut place, mut grab) = (place(0.0, 0.5), Grab::default());
        let hands = |apart: f64| [-0.5, 0.5].map(|side| Some(DVec3::new(side * apart, 1.0, -0.3)));
        grab.advance(&mut place, hands(0.4), LIMITS);
        let mut events = Vec::new();
        let mut scales = Vec::new();
        // The hands go from 0.5 to 1.2 times life size, a hundredth each frame, and back.
        let sizes = (50..=120).chain((50..120).rev());
        for size in sizes {
            events.extend(
                grab.advance(&mut place, hands(0.008 * f64::from(size)), LIMITS).map(|event| (size, event)),
            );
            scales.push((size, place.scale));
        }
        let scale_at = |size| scales.iter().find(|(at, _)| *at == size).unwrap().1;
        assert!((scale_at(96) - 0.96).abs() < 1e-9);
        assert_eq!([98, 100, 103, 106].map(scale_at), [1.0; 4]);
        // It goes on from life size without a jump, and is caught again on the way back.
        assert!(scales.windows(2).all(|pair| (pair[1].1 - pair[0].1).abs() < 0.04), "{scales:?}");
        assert!(scale_at(120) > 1.08);
        assert_eq!(events.len(), 2, "{events:?}");
        assert!(events.iter().all(|(_, event)| *event == Event::Catch));
    }

    #[test]
    fn a_scan_as_large_as_life_stays_so_while_it_is_turned() {
        let (mut place, mut grab) = (place(0.0, 1.0), Grab::default());
        let hands = |apart: f64, turn: f64| {
            [-0.5, 0.5].map(|side| Some(DQuat::from_rotation_y(turn) * DVec3::new(side * apart, 1.0, 0.0)))
        };
        grab.advance(&mut place, hands(0.5, 0.0), LIMITS);
        for frame in 0..50 {
            let turn = 0.02 * f64::from(frame);
            assert_eq!(grab.advance(&mut place, hands(0.5 + 0.02 * turn.sin(), turn), LIMITS), None);
        }
        assert_eq!(place.scale, 1.0);
        assert!((place.yaw + 0.98).abs() < 1e-9, "the world turns with the hands: {}", place.yaw);
    }

    #[test]
    fn scales_have_limits() {
        let (mut place, mut grab) = (place(0.0, 0.2), Grab::default());
        let hands = |apart: f64| [-0.5, 0.5].map(|side| Some(DVec3::new(side * apart, 1.0, 0.0)));
        grab.advance(&mut place, hands(0.8), [0.15, 5.0]);
        grab.advance(&mut place, hands(0.1), [0.15, 5.0]);
        assert_eq!(place.scale, 0.15);
        grab.advance(&mut place, hands(1.6), [0.15, 0.3]);
        assert_eq!(place.scale, 0.3);
    }
}
