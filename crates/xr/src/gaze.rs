//! Where the user looks (XR_EXT_eye_gaze_interaction): a pose action, active while the eyes are tracked.

use glam::{DQuat, DVec3};
use openxr as xr;

const PROFILE: &str = "/interaction_profiles/ext/eye_gaze_interaction";
const POSE: &str = "/user/eyes_ext/input/gaze_ext/pose";

/// The action, and the space whose −z axis is the gaze.
pub(super) struct Gaze {
    action: xr::Action<xr::Posef>,
    space: xr::Space,
}

impl Gaze {
    /// Adds the action to a set that is not attached yet.
    ///
    /// # Errors
    /// What the runtime says: it may know the extension and have no tracker.
    pub fn new(
        xr: &xr::Instance,
        session: &xr::Session<xr::Vulkan>,
        set: &xr::ActionSet,
    ) -> xr::Result<Self> {
        let action = set.create_action("gaze", "Where you look", &[])?;
        let binding = xr::Binding::new(&action, xr.string_to_path(POSE)?);
        xr.suggest_interaction_profile_bindings(xr.string_to_path(PROFILE)?, &[binding])?;
        let space = action.create_space(session, xr::Path::NULL, xr::Posef::IDENTITY)?;
        Ok(Self { action, space })
    }

    /// Direction of the gaze in `stage`, unit length. `None` while nobody knows it, as behind closed lids.
    ///
    /// # Errors
    /// What the runtime says.
    pub fn in_stage(
        &self,
        session: &xr::Session<xr::Vulkan>,
        stage: &xr::Space,
        display_time: xr::Time,
    ) -> xr::Result<Option<DVec3>> {
        if !self.action.is_active(session, xr::Path::NULL)? {
            return Ok(None);
        }
        let location = self.space.locate(stage, display_time)?;
        let valid = location.location_flags.contains(xr::SpaceLocationFlags::ORIENTATION_VALID);
        Ok(valid.then(|| forward(location.pose.orientation)).flatten())
    }
}

/// The −z axis of a rotation; `None` if `q` is no rotation.
fn forward(q: xr::Quaternionf) -> Option<DVec3> {
    let q = DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into());
    // The specification demands unit length within 1%.
    ((q.length_squared() - 1.0).abs() < 0.02).then(|| q.normalize() * DVec3::NEG_Z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gaze_is_the_negative_z_axis() {
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let to_the_left = forward(xr::Quaternionf { x: 0.0, y: half, z: 0.0, w: half }).unwrap();
        assert!((to_the_left - DVec3::NEG_X).length() < 1e-6, "{to_the_left}");
        assert_eq!(forward(xr::Quaternionf { x: 0.0, y: 0.0, z: 0.0, w: 0.0 }), None);
        assert_eq!(forward(xr::Quaternionf { x: f32::NAN, y: 0.0, z: 0.0, w: 1.0 }), None);
    }
}
