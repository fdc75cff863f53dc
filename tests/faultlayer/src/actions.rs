//! Calls about hands and eyes: actions, the spaces that they move, joints and vibrations.

use crate::plan::{failure, planned};
use crate::{INSTANCE, next};
use openxr_sys as xr;
use std::ffi::CStr;
use std::sync::atomic::{AtomicU64, Ordering};
use xr::{Handle as _, pfn};

/// The action space that belongs to no hand.
static GAZE_SPACE: AtomicU64 = AtomicU64::new(0);
/// Angle of the gaze to the left, radians.
pub const GAZE_TURN: f32 = 0.3;

pub unsafe extern "system" fn create_action_space(
    session: xr::Session,
    info: *const xr::ActionSpaceCreateInfo,
    space: *mut xr::Space,
) -> xr::Result {
    unsafe {
        let result = next::<pfn::CreateActionSpace>(c"xrCreateActionSpace")(session, info, space);
        if result.into_raw() >= 0 && (*info).subaction_path == xr::Path::NULL {
            GAZE_SPACE.store((*space).into_raw(), Ordering::SeqCst);
        }
        result
    }
}

pub unsafe extern "system" fn get_action_state_pose(
    session: xr::Session,
    info: *const xr::ActionStateGetInfo,
    state: *mut xr::ActionStatePose,
) -> xr::Result {
    let result = unsafe { next::<pfn::GetActionStatePose>(c"xrGetActionStatePose")(session, info, state) };
    let is_gaze = unsafe { (*info).subaction_path } == xr::Path::NULL;
    if is_gaze && (planned("gaze") || planned("nogaze")) {
        unsafe { (*state).is_active = xr::TRUE };
    }
    if !is_gaze && planned("bare") {
        unsafe { (*state).is_active = xr::FALSE };
    }
    result
}

pub unsafe extern "system" fn locate_space(
    space: xr::Space,
    base: xr::Space,
    time: xr::Time,
    location: *mut xr::SpaceLocation,
) -> xr::Result {
    let is_gaze = space.into_raw() == GAZE_SPACE.load(Ordering::SeqCst);
    if !is_gaze && let Some(result) = failure("xrLocateSpace") {
        return result;
    }
    if is_gaze && planned("nogaze") {
        return xr::Result::ERROR_RUNTIME_FAILURE;
    }
    let result = unsafe { next::<pfn::LocateSpace>(c"xrLocateSpace")(space, base, time, location) };
    if is_gaze && planned("gaze") {
        let (sin, cos) = (0.5 * GAZE_TURN).sin_cos();
        unsafe {
            (*location).location_flags =
                xr::SpaceLocationFlags::ORIENTATION_VALID | xr::SpaceLocationFlags::ORIENTATION_TRACKED;
            (*location).pose.orientation = xr::Quaternionf { x: 0.0, y: sin, z: 0.0, w: cos };
        }
    }
    result
}

/// The text of a path.
fn text_of(path: xr::Path) -> String {
    let mut text = [0_u8; 256];
    let mut count = 0;
    let instance = xr::Instance::from_raw(INSTANCE.load(Ordering::SeqCst));
    // SAFETY: the runtime writes at most as many bytes as the buffer has.
    unsafe {
        let below = next::<pfn::PathToString>(c"xrPathToString");
        below(instance, path, text.len() as u32, &mut count, text.as_mut_ptr().cast());
    }
    CStr::from_bytes_until_nul(&text).unwrap_or_default().to_string_lossy().into_owned()
}

pub unsafe extern "system" fn suggest_bindings(
    instance: xr::Instance,
    info: *const xr::InteractionProfileSuggestedBinding,
) -> xr::Result {
    let profile = text_of(unsafe { (*info).interaction_profile });
    let name = profile.rsplit('/').next().unwrap_or_default();
    let result = if planned(&format!("no-{name}")) {
        xr::Result::ERROR_PATH_UNSUPPORTED
    } else {
        let below =
            unsafe { next::<pfn::SuggestInteractionProfileBindings>(c"xrSuggestInteractionProfileBindings") };
        unsafe { below(instance, info) }
    };
    eprintln!("faultlayer: bindings {profile} {result:?}");
    result
}

pub unsafe extern "system" fn apply_haptic_feedback(
    session: xr::Session,
    info: *const xr::HapticActionInfo,
    feedback: *const xr::HapticBaseHeader,
) -> xr::Result {
    if let Some(result) = failure("xrApplyHapticFeedback") {
        return result;
    }
    // All chained structs begin with their type.
    if unsafe { (*feedback).ty } == xr::HapticVibration::TYPE {
        let v = unsafe { &*feedback.cast::<xr::HapticVibration>() };
        let hand = text_of(unsafe { (*info).subaction_path });
        eprintln!("faultlayer: vibration {hand} {} {}", v.amplitude, v.duration.as_nanos());
    }
    unsafe { next::<pfn::ApplyHapticFeedback>(c"xrApplyHapticFeedback")(session, info, feedback) }
}

pub unsafe extern "system" fn locate_hand_joints(
    tracker: xr::HandTrackerEXT,
    info: *const xr::HandJointsLocateInfoEXT,
    locations: *mut xr::HandJointLocationsEXT,
) -> xr::Result {
    if let Some(result) = failure("xrLocateHandJointsEXT") {
        return result;
    }
    unsafe { next::<pfn::LocateHandJointsEXT>(c"xrLocateHandJointsEXT")(tracker, info, locations) }
}
