//! Both hands' input: the actions, their bindings on every kind of controller, and what they read; and the eyes' gaze.

use super::fault::FailedCall;
use super::gaze::Gaze;
use super::gestures::{self, Pinch};
use super::pose;
use crate::controllers::{Control, Profile};
use crate::{ControllerInput, HandInput, HandJoints};
use base::space::Pose;
use glam::DVec3;
use openxr as xr;

/// The path of each hand, left then right.
const HANDS: [&str; 2] = ["/user/hand/left", "/user/hand/right"];

/// The actions, one a [`Control`], for both hands each.
struct Actions {
    aim: xr::Action<xr::Posef>,
    grip: xr::Action<xr::Posef>,
    stick: xr::Action<xr::Vector2f>,
    press: xr::Action<bool>,
    select: xr::Action<bool>,
    grab: xr::Action<bool>,
    squeeze: xr::Action<f32>,
    pinch: xr::Action<bool>,
    menu: xr::Action<bool>,
    reset: xr::Action<bool>,
    vibration: xr::Action<xr::Haptic>,
}

impl Actions {
    /// Creates the actions; users find these names where a runtime lets them choose their own bindings.
    fn new(set: &xr::ActionSet, hands: &[xr::Path]) -> xr::Result<Self> {
        Ok(Self {
            aim: set.create_action("aim", "Point", hands)?,
            grip: set.create_action("grip", "Hold", hands)?,
            stick: set.create_action("move", "Move and turn", hands)?,
            press: set.create_action("press", "Press the trackpad to move", hands)?,
            select: set.create_action("select", "Select", hands)?,
            grab: set.create_action("grab", "Grab", hands)?,
            squeeze: set.create_action("squeeze", "Grab by squeezing", hands)?,
            pinch: set.create_action("pinch", "Pinch with bare fingers", hands)?,
            menu: set.create_action("menu", "Menu", hands)?,
            reset: set.create_action("reset", "Back to the start", hands)?,
            vibration: set.create_action("vibration", "Vibration", hands)?,
        })
    }

    fn bind(&self, control: Control, path: xr::Path) -> xr::Binding<'_> {
        match control {
            Control::Aim => xr::Binding::new(&self.aim, path),
            Control::Grip => xr::Binding::new(&self.grip, path),
            Control::Move => xr::Binding::new(&self.stick, path),
            Control::Press => xr::Binding::new(&self.press, path),
            Control::Select => xr::Binding::new(&self.select, path),
            Control::Grab => xr::Binding::new(&self.grab, path),
            Control::Squeeze => xr::Binding::new(&self.squeeze, path),
            Control::Pinch => xr::Binding::new(&self.pinch, path),
            Control::Menu => xr::Binding::new(&self.menu, path),
            Control::Reset => xr::Binding::new(&self.reset, path),
            Control::Vibration => xr::Binding::new(&self.vibration, path),
        }
    }

    fn suggest(&self, xr: &xr::Instance, profile: &Profile) -> xr::Result<()> {
        let mut bindings = Vec::new();
        for part in profile.bindings() {
            for (_, user) in HANDS.iter().enumerate().filter(|(hand, _)| part.hands.contain(*hand)) {
                let path = xr.string_to_path(&format!("{user}/{}", part.path))?;
                bindings.push(self.bind(part.control, path));
            }
        }
        xr.suggest_interaction_profile_bindings(xr.string_to_path(profile.path)?, &bindings)
    }
}

/// What input is read for.
pub(super) struct Moment<'a> {
    pub session: &'a xr::Session<xr::Vulkan>,
    /// The space in which hands are located.
    pub stage: &'a xr::Space,
    /// The frame's predicted display time.
    pub display_time: xr::Time,
    /// The head as last located.
    pub stage_from_head: Pose,
    /// True if the user's input is meant for us.
    pub has_focus: bool,
}

impl Moment<'_> {
    /// The state of a button; `None` if the hand has none.
    fn button(&self, action: &xr::Action<bool>, hand: xr::Path) -> Result<Option<bool>, FailedCall> {
        let state = action.state(self.session, hand).map_err(FailedCall::of("xrGetActionStateBoolean"))?;
        Ok(state.is_active.then_some(state.current_state))
    }

    /// Where a space is that is active.
    fn locate(&self, space: &xr::Space) -> Result<Option<Pose>, FailedCall> {
        let located = space.locate(self.stage, self.display_time).map_err(FailedCall::of("xrLocateSpace"))?;
        Ok(pose::located(located.location_flags, &located.pose))
    }

    fn is_active(&self, action: &xr::Action<xr::Posef>, hand: xr::Path) -> Result<bool, FailedCall> {
        action.is_active(self.session, hand).map_err(FailedCall::of("xrGetActionStatePose"))
    }
}

/// One hand.
struct HandActions {
    /// 0 left, 1 right.
    number: usize,
    path: xr::Path,
    aim: xr::Space,
    grip: xr::Space,
    was: Before,
    /// The kind of controller in it.
    profile: Option<&'static Profile>,
}

/// What a hand did in the frame before, where that counts.
#[derive(Clone, Copy, Default)]
struct Before {
    squeezed: bool,
    pinched: bool,
    fist: bool,
    pinch: Option<Pinch>,
}

impl HandActions {
    fn new(
        xr: &xr::Instance,
        session: &xr::Session<xr::Vulkan>,
        actions: &Actions,
        number: usize,
    ) -> xr::Result<Self> {
        let path = xr.string_to_path(HANDS[number])?;
        let space = |action: &xr::Action<xr::Posef>| action.create_space(session, path, xr::Posef::IDENTITY);
        let (aim, grip) = (space(&actions.aim)?, space(&actions.grip)?);
        Ok(Self { number, path, aim, grip, was: Before::default(), profile: None })
    }

    /// Reads what the hand does, after the actions were synchronized.
    fn read(
        &mut self,
        actions: &Actions,
        profiles: &[(xr::Path, &'static Profile)],
        now: &Moment<'_>,
        joints: Option<&HandJoints>,
    ) -> Result<HandInput, FailedCall> {
        // Without focus nothing is active, and joints mean nothing.
        if !now.has_focus {
            self.was = Before::default();
            return Ok(HandInput::default());
        }
        if now.is_active(&actions.aim, self.path)? {
            // A hand takes another controller only after it has let go of the one before.
            if self.profile.is_none() {
                self.profile = self.find_profile(profiles, now.session);
            }
            let input = self.read_actions(actions, now)?;
            return Ok(HandInput { profile: self.profile, ..input });
        }
        self.profile = None;
        let Some(joints) = joints else {
            self.was = Before::default();
            return Ok(HandInput::default());
        };
        Ok(self.read_joints(joints, &now.stage_from_head))
    }

    /// The kind of controller that the runtime says is in the hand. A runtime that does not say costs a label, no more.
    fn find_profile(
        &self,
        profiles: &[(xr::Path, &'static Profile)],
        session: &xr::Session<xr::Vulkan>,
    ) -> Option<&'static Profile> {
        let path = session.current_interaction_profile(self.path).ok()?;
        profiles.iter().find(|(known, _)| *known == path).map(|(_, profile)| *profile)
    }

    /// Input of a controller, or of a bare hand whose gestures the runtime knows.
    fn read_actions(&mut self, actions: &Actions, now: &Moment<'_>) -> Result<HandInput, FailedCall> {
        let hand = self.path;
        let stage_from_aim = now.locate(&self.aim)?;
        let holds = now.is_active(&actions.grip, hand)?;
        let stage_from_grip = if holds { now.locate(&self.grip)? } else { None };

        let moved =
            actions.stick.state(now.session, hand).map_err(FailedCall::of("xrGetActionStateVector2f"))?;
        let counts = moved.is_active && now.button(&actions.press, hand)?.unwrap_or(true);
        let squeeze =
            actions.squeeze.state(now.session, hand).map_err(FailedCall::of("xrGetActionStateFloat"))?;
        self.was.squeezed = squeeze.is_active && gestures::squeezed(self.was.squeezed, squeeze.current_state);

        let is_pinched = now.button(&actions.pinch, hand)?.unwrap_or(false);
        let faces_head =
            stage_from_grip.is_some_and(|grip| gestures::faces(&grip, &now.stage_from_head, self.number));
        self.was.pinch = Pinch::next(self.was.pinch, is_pinched, faces_head);
        let held = |action: &xr::Action<bool>| Ok(now.button(action, hand)?.unwrap_or(false));
        Ok(HandInput {
            stage_from_aim,
            stage_from_grip,
            stick: if counts { stick(moved.current_state) } else { [0.0; 2] },
            has_stick: moved.is_active,
            profile: None,
            select: held(&actions.select)? || self.was.pinch == Some(Pinch::Select),
            grab: held(&actions.grab)? || self.was.squeezed,
            menu: held(&actions.menu)? || self.was.pinch == Some(Pinch::Menu),
            reset: held(&actions.reset)?,
        })
    }

    /// Input of a bare hand, by its joints.
    fn read_joints(&mut self, joints: &HandJoints, stage_from_head: &Pose) -> HandInput {
        let stage_from_grip = gestures::grip(joints, self.number);
        let was = &mut self.was;
        was.fist = gestures::fist(was.fist, joints);
        was.pinched = gestures::pinched(was.pinched, joints);
        let faces_head = gestures::faces(&stage_from_grip, stage_from_head, self.number);
        // The thumb of a fist may lie on the tip of the index finger.
        was.pinch = Pinch::next(was.pinch, was.pinched && !was.fist, faces_head);
        HandInput {
            stage_from_aim: Some(gestures::aim(joints, stage_from_head, self.number)),
            stage_from_grip: Some(stage_from_grip),
            select: was.pinch == Some(Pinch::Select),
            grab: was.fist,
            menu: was.pinch == Some(Pinch::Menu),
            ..HandInput::default()
        }
    }
}

/// The actions, and what they read.
pub(super) struct Input {
    set: xr::ActionSet,
    actions: Actions,
    hands: [HandActions; 2],
    /// The kinds of controllers, by the runtime's numbers for their paths.
    profiles: Vec<(xr::Path, &'static Profile)>,
    gaze: Option<Gaze>,
}

impl Input {
    /// Creates the actions, suggests bindings for these kinds of controllers, and with `eye_gaze` for the eyes, and
    /// attaches them to the session.
    ///
    /// # Errors
    /// What the runtime says; a kind of controller that it does not know is no error.
    pub fn new(
        xr: &xr::Instance,
        session: &xr::Session<xr::Vulkan>,
        profiles: &[&'static Profile],
        eye_gaze: bool,
    ) -> xr::Result<Self> {
        let set = xr.create_action_set("walk", "Walk", 0)?;
        let actions = Actions::new(&set, &[xr.string_to_path(HANDS[0])?, xr.string_to_path(HANDS[1])?])?;
        for profile in profiles {
            match actions.suggest(xr, profile) {
                Err(xr::sys::Result::ERROR_PATH_UNSUPPORTED) => {
                    tracing::debug!("the runtime does not know {}", profile.path);
                }
                result => result?,
            }
        }
        let hands =
            [HandActions::new(xr, session, &actions, 0)?, HandActions::new(xr, session, &actions, 1)?];
        let gaze = if eye_gaze { without_on_failure(Gaze::new(xr, session, &set)) } else { None };
        session.attach_action_sets(&[&set])?;
        let of_path = |profile: &&'static Profile| Ok((xr.string_to_path(profile.path)?, *profile));
        let profiles = profiles.iter().map(of_path).collect::<xr::Result<_>>()?;
        Ok(Self { set, actions, hands, profiles, gaze })
    }

    /// Direction of the gaze in `stage`, unit length, if it is tracked.
    pub fn gaze(
        &mut self,
        session: &xr::Session<xr::Vulkan>,
        stage: &xr::Space,
        display_time: xr::Time,
    ) -> Option<DVec3> {
        let located = self.gaze.as_ref()?.in_stage(session, stage, display_time);
        if located.is_err() {
            self.gaze = None;
        }
        without_on_failure(located)?
    }

    /// Reads both hands; they are at rest while the session is not in focus, and a hand is while it is away. A hand without
    /// a controller is read by its joints, if there are any.
    ///
    /// # Errors
    /// The call that failed, and what the runtime said.
    pub fn read(
        &mut self,
        now: &Moment<'_>,
        joints: &[Option<HandJoints>; 2],
    ) -> Result<ControllerInput, FailedCall> {
        let sets = [xr::ActiveActionSet::new(&self.set)];
        now.session.sync_actions(&sets).map_err(FailedCall::of("xrSyncActions"))?;
        let mut input = ControllerInput::default();
        for ((hand, joints), read) in self.hands.iter_mut().zip(joints).zip(&mut input.hands) {
            *read = hand.read(&self.actions, &self.profiles, now, joints.as_ref())?;
        }
        Ok(input)
    }

    /// Shakes a controller; see [`crate::Headset::vibrate`].
    ///
    /// # Errors
    /// What the runtime says.
    pub fn vibrate(
        &self,
        session: &xr::Session<xr::Vulkan>,
        hand: usize,
        strength: f32,
        seconds: f32,
    ) -> xr::Result<()> {
        let (Some(hand), Some((amplitude, duration))) = (self.hands.get(hand), vibration(strength, seconds))
        else {
            return Ok(());
        };
        let event = xr::HapticVibration::new()
            .amplitude(amplitude)
            .duration(duration)
            .frequency(xr::FREQUENCY_UNSPECIFIED);
        self.actions.vibration.apply_feedback(session, hand.path, &event)
    }
}

/// Amplitude and duration of a vibration that somebody would feel, as OpenXR wants them.
fn vibration(strength: f32, seconds: f32) -> Option<(f32, xr::Duration)> {
    let is_felt = strength > 0.0 && seconds > 0.0;
    // `as` saturates, so a duration without end is a very long one.
    let duration = xr::Duration::from_nanos((f64::from(seconds) * 1e9).round() as i64);
    is_felt.then(|| (strength.min(1.0), duration))
}

/// Eyes that are not tracked are no failure: the gaze is straight ahead then.
fn without_on_failure<T>(result: xr::Result<T>) -> Option<T> {
    result.inspect_err(|result| tracing::info!("the eyes are not tracked: {result:?}")).ok()
}

/// A stick's axes within −1 to 1; a controller that reports nonsense rests.
fn stick(state: xr::Vector2f) -> [f32; 2] {
    [state.x, state.y].map(|axis| if axis.is_finite() { axis.clamp(-1.0, 1.0) } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sticks_stay_within_bounds() {
        assert_eq!(stick(xr::Vector2f { x: 0.25, y: -1.5 }), [0.25, -1.0]);
        assert_eq!(stick(xr::Vector2f { x: f32::NAN, y: f32::INFINITY }), [0.0, 0.0]);
    }

    #[test]
    fn vibrations_are_what_openxr_takes() {
        assert_eq!(vibration(0.5, 0.25), Some((0.5, xr::Duration::from_nanos(250_000_000))));
        assert_eq!(vibration(7.0, 1e30), Some((1.0, xr::Duration::from_nanos(i64::MAX))));
        for (strength, seconds) in [(0.0, 1.0), (-1.0, 1.0), (f32::NAN, 1.0), (1.0, 0.0), (1.0, f32::NAN)] {
            assert_eq!(vibration(strength, seconds), None, "{strength}, {seconds}");
        }
    }
}
