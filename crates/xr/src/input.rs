//! Controllers: two sticks and a reset button, on every kind of controller that OpenXR names; and the eyes' gaze.

use super::gaze::Gaze;
use crate::ControllerInput;
use glam::DVec3;
use openxr as xr;

/// Bindings of one kind of controller. A list is empty if the controller has nothing of the kind.
struct Profile {
    name: &'static str,
    left_stick: &'static [&'static str],
    right_stick: &'static [&'static str],
    reset: &'static [&'static str],
}

const LEFT_STICK: &[&str] = &["/user/hand/left/input/thumbstick"];
const RIGHT_STICK: &[&str] = &["/user/hand/right/input/thumbstick"];

/// Kinds of controllers; a runtime maps others to the one that is most like them.
const PROFILES: [Profile; 5] = [
    Profile {
        name: "/interaction_profiles/valve/index_controller",
        left_stick: LEFT_STICK,
        right_stick: RIGHT_STICK,
        reset: &["/user/hand/right/input/thumbstick/click", "/user/hand/right/input/a/click"],
    },
    Profile {
        name: "/interaction_profiles/oculus/touch_controller",
        left_stick: LEFT_STICK,
        right_stick: RIGHT_STICK,
        reset: &["/user/hand/right/input/thumbstick/click", "/user/hand/right/input/a/click"],
    },
    Profile {
        name: "/interaction_profiles/microsoft/motion_controller",
        left_stick: LEFT_STICK,
        right_stick: RIGHT_STICK,
        reset: &["/user/hand/right/input/thumbstick/click", "/user/hand/right/input/menu/click"],
    },
    Profile {
        name: "/interaction_profiles/htc/vive_controller",
        left_stick: &["/user/hand/left/input/trackpad"],
        right_stick: &["/user/hand/right/input/trackpad"],
        reset: &["/user/hand/right/input/menu/click"],
    },
    Profile {
        name: "/interaction_profiles/khr/simple_controller",
        left_stick: &[],
        right_stick: &[],
        reset: &["/user/hand/right/input/menu/click"],
    },
];

/// The actions, and what they read.
pub(super) struct Input {
    set: xr::ActionSet,
    left_stick: xr::Action<xr::Vector2f>,
    right_stick: xr::Action<xr::Vector2f>,
    reset: xr::Action<bool>,
    gaze: Option<Gaze>,
}

impl Input {
    /// Creates the actions, suggests bindings for every kind of controller, and with `eye_gaze` for the eyes, and
    /// attaches them to the session.
    ///
    /// # Errors
    /// What the runtime says; a kind of controller that it does not know is no error.
    pub fn new(xr: &xr::Instance, session: &xr::Session<xr::Vulkan>, eye_gaze: bool) -> xr::Result<Self> {
        let set = xr.create_action_set("walk", "Walk", 0)?;
        let input = Self {
            left_stick: set.create_action("fly", "Fly", &[])?,
            right_stick: set.create_action("turn", "Turn", &[])?,
            reset: set.create_action("reset", "Back to the start", &[])?,
            gaze: if eye_gaze { without_on_failure(Gaze::new(xr, session, &set)) } else { None },
            set,
        };
        for profile in &PROFILES {
            match input.suggest(xr, profile) {
                Err(xr::sys::Result::ERROR_PATH_UNSUPPORTED) => {
                    tracing::debug!("the runtime does not know {}", profile.name);
                }
                result => result?,
            }
        }
        session.attach_action_sets(&[&input.set])?;
        Ok(input)
    }

    fn suggest(&self, xr: &xr::Instance, profile: &Profile) -> xr::Result<()> {
        let mut bindings = Vec::new();
        for path in profile.left_stick {
            bindings.push(xr::Binding::new(&self.left_stick, xr.string_to_path(path)?));
        }
        for path in profile.right_stick {
            bindings.push(xr::Binding::new(&self.right_stick, xr.string_to_path(path)?));
        }
        for path in profile.reset {
            bindings.push(xr::Binding::new(&self.reset, xr.string_to_path(path)?));
        }
        xr.suggest_interaction_profile_bindings(xr.string_to_path(profile.name)?, &bindings)
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

    /// Reads the controllers as of now; they are at rest while the session is not in focus or a hand is away.
    ///
    /// # Errors
    /// What the runtime says.
    pub fn read(&self, session: &xr::Session<xr::Vulkan>) -> xr::Result<ControllerInput> {
        session.sync_actions(&[xr::ActiveActionSet::new(&self.set)])?;
        let stick = |action: &xr::Action<xr::Vector2f>| {
            let state = action.state(session, xr::Path::NULL)?;
            xr::Result::Ok(if state.is_active { stick(state.current_state) } else { [0.0; 2] })
        };
        let reset = self.reset.state(session, xr::Path::NULL)?;
        Ok(ControllerInput {
            left_stick: stick(&self.left_stick)?,
            right_stick: stick(&self.right_stick)?,
            reset: reset.is_active && reset.current_state && reset.changed_since_last_sync,
        })
    }
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
    fn every_kind_of_controller_can_reset() {
        for profile in &PROFILES {
            assert!(!profile.reset.is_empty(), "{}", profile.name);
            let paths = profile.left_stick.iter().chain(profile.right_stick).chain(profile.reset);
            assert!(paths.into_iter().all(|path| path.starts_with("/user/hand/")), "{}", profile.name);
        }
    }
}
