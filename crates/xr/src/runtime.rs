//! The OpenXR runtime and the headset that is connected to it, before any GPU is touched.

use super::missing::XrMissing;
use crate::controllers::{PROFILES, Profile};
use openxr as xr;
use raw::device::load_loader;

/// Both eyes, one image each.
pub(super) const STEREO: xr::ViewConfigurationType = xr::ViewConfigurationType::PRIMARY_STEREO;

/// What the runtime offers beyond the needs of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Offers {
    /// True if it takes depth images beside the color images, for better reprojection.
    pub depth_layer: bool,
    /// True if it tells which pixels the lenses hide.
    pub visibility_mask: bool,
    /// True if it knows eye trackers; whether one is there shows only in use.
    pub eye_gaze: bool,
    /// True if it tells the display's refresh rate.
    pub refresh_rate: bool,
    /// True if it tells what time it is on its clock.
    pub clock: bool,
    /// True if it has a reference space at the user's place with its floor at 0.
    pub local_floor: bool,
    /// True if it tells where the joints of bare hands are.
    pub hand_tracking: bool,
}

/// A runtime with a headset.
pub(super) struct Runtime {
    pub xr: xr::Instance,
    pub system: xr::SystemId,
    /// Name and version: "Monado(XRT) 25.0.0".
    pub name: String,
    /// The headset, as the runtime calls it.
    pub headset: String,
    pub offers: Offers,
    /// The kinds of controllers whose paths may be named to it.
    pub profiles: Vec<&'static Profile>,
}

impl Runtime {
    /// Finds the active runtime and its headset.
    ///
    /// # Errors
    /// No loader, no runtime, one without Vulkan, no headset.
    pub fn connect() -> Result<Self, XrMissing> {
        let entry = load_loader().map_err(|reason| XrMissing::NoLoader { reason })?;
        let mut offered =
            entry.enumerate_extensions().map_err(no_runtime("xrEnumerateInstanceExtensionProperties"))?;
        let mut offers = Offers {
            depth_layer: offered.khr_composition_layer_depth,
            visibility_mask: offered.khr_visibility_mask,
            eye_gaze: offered.ext_eye_gaze_interaction,
            refresh_rate: offered.fb_display_refresh_rate,
            clock: offered.khr_convert_timespec_time,
            local_floor: offered.ext_local_floor,
            hand_tracking: offered.ext_hand_tracking,
        };
        let mut wanted = xr::ExtensionSet::default();
        wanted.khr_vulkan_enable2 = offered.khr_vulkan_enable2;
        wanted.khr_composition_layer_depth = offers.depth_layer;
        wanted.khr_visibility_mask = offers.visibility_mask;
        wanted.ext_eye_gaze_interaction = offers.eye_gaze;
        wanted.fb_display_refresh_rate = offers.refresh_rate;
        wanted.ext_local_floor = offers.local_floor;
        wanted.khr_convert_timespec_time = offers.clock;
        wanted.ext_debug_utils = offered.ext_debug_utils;
        wanted.ext_hand_tracking = offers.hand_tracking;
        let mut profiles: Vec<&'static Profile> = PROFILES.iter().collect();
        profiles.retain(|profile| {
            let Some(extension) = profile.extension else { return true };
            *(extension.flag)(&mut wanted) = *(extension.flag)(&mut offered);
            *(extension.flag)(&mut offered)
        });
        let application = xr::ApplicationInfo {
            application_name: "scanwalk",
            application_version: 1,
            engine_name: "scanwalk",
            engine_version: 1,
            // Nothing that is used here is newer, and every runtime has this version.
            api_version: xr::Version::new(1, 0, 0),
        };
        let xr =
            entry.create_instance(&application, &wanted, &[], &()).map_err(no_runtime("xrCreateInstance"))?;
        let properties = xr.properties().map_err(XrMissing::runtime_failed("xrGetInstanceProperties"))?;
        let name = format!("{} {}", properties.runtime_name, properties.runtime_version);
        if !offered.khr_vulkan_enable2 {
            return Err(XrMissing::NoVulkan { runtime: name });
        }
        let system = system(&xr, &name)?;
        // A runtime may know the extension and have a headset without cameras for it.
        offers.hand_tracking = offers.hand_tracking && xr.supports_hand_tracking(system).unwrap_or(false);
        let headset = xr
            .system_properties(system)
            .map_err(XrMissing::runtime_failed("xrGetSystemProperties"))?
            .system_name;
        let configurations = xr
            .enumerate_view_configurations(system)
            .map_err(XrMissing::runtime_failed("xrEnumerateViewConfigurations"))?;
        if !configurations.contains(&STEREO) {
            return Err(XrMissing::NotStereo { headset });
        }
        Ok(Self { xr, system, name, headset, offers, profiles })
    }

    /// Asks for the headset again.
    ///
    /// # Errors
    /// The runtime fails, or has no headset any more.
    pub fn system(&self) -> Result<xr::SystemId, XrMissing> {
        system(&self.xr, &self.name)
    }

    /// What the runtime says about each eye's image, left then right.
    ///
    /// # Errors
    /// The runtime fails, or has not two eyes.
    pub fn eye_images(&self) -> Result<[xr::ViewConfigurationView; 2], XrMissing> {
        let views = self
            .xr
            .enumerate_view_configuration_views(self.system, STEREO)
            .map_err(XrMissing::runtime_failed("xrEnumerateViewConfigurationViews"))?;
        <[_; 2]>::try_from(views).map_err(|_| XrMissing::NotStereo { headset: self.headset.clone() })
    }

    /// How layers mix with the world behind: opaque, or the runtime's own choice where it has no opaque mode
    /// (see-through glasses).
    ///
    /// # Errors
    /// The runtime fails.
    pub fn blend_mode(&self) -> Result<xr::EnvironmentBlendMode, XrMissing> {
        let modes = self
            .xr
            .enumerate_environment_blend_modes(self.system, STEREO)
            .map_err(XrMissing::runtime_failed("xrEnumerateEnvironmentBlendModes"))?;
        let opaque = xr::EnvironmentBlendMode::OPAQUE;
        Ok(if modes.contains(&opaque) { opaque } else { modes.first().copied().unwrap_or(opaque) })
    }
}

/// The runtime's headset.
fn system(xr: &xr::Instance, runtime: &str) -> Result<xr::SystemId, XrMissing> {
    xr.system(xr::FormFactor::HEAD_MOUNTED_DISPLAY).map_err(|result| match result {
        xr::sys::Result::ERROR_FORM_FACTOR_UNAVAILABLE | xr::sys::Result::ERROR_FORM_FACTOR_UNSUPPORTED => {
            XrMissing::NoHeadset { runtime: runtime.to_owned() }
        }
        result => XrMissing::RuntimeFailed { call: "xrGetSystem", result },
    })
}

/// For `map_err` of the first calls: no runtime at all, or one that fails.
fn no_runtime(call: &'static str) -> impl FnOnce(xr::sys::Result) -> XrMissing {
    move |result| match result {
        // The runtime's manifest does not exist or cannot be read.
        xr::sys::Result::ERROR_RUNTIME_UNAVAILABLE | xr::sys::Result::ERROR_FILE_ACCESS_ERROR => {
            XrMissing::NoRuntime
        }
        result => XrMissing::RuntimeFailed { call, result },
    }
}

/// The eye's image size: the recommended one × `scale`, at least 1 and at most what the runtime takes.
pub(super) fn scaled_size(view: &xr::ViewConfigurationView, scale: f64) -> [u32; 2] {
    let scaled = |recommended: u32, max: u32| {
        // `as` saturates, so neither NaN nor a huge scale can escape the clamp.
        ((f64::from(recommended) * scale).round() as u32).clamp(1, max.max(1))
    };
    [
        scaled(view.recommended_image_rect_width, view.max_image_rect_width),
        scaled(view.recommended_image_rect_height, view.max_image_rect_height),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_stays_within_what_the_runtime_takes() {
        let view = xr::ViewConfigurationView {
            recommended_image_rect_width: 1000,
            max_image_rect_width: 2000,
            recommended_image_rect_height: 1201,
            max_image_rect_height: 1500,
            recommended_swapchain_sample_count: 1,
            max_swapchain_sample_count: 1,
        };
        assert_eq!(scaled_size(&view, 1.0), [1000, 1201]);
        assert_eq!(scaled_size(&view, 0.5), [500, 601]);
        assert_eq!(scaled_size(&view, 1.5), [1500, 1500]);
        for odd in [f64::INFINITY, 1e300] {
            assert_eq!(scaled_size(&view, odd), [2000, 1500]);
        }
        for odd in [0.0, -1.0, f64::NAN] {
            assert_eq!(scaled_size(&view, odd), [1, 1]);
        }
    }

    #[test]
    fn a_missing_runtime_is_told_from_a_broken_one() {
        let missing = no_runtime("x")(xr::sys::Result::ERROR_RUNTIME_UNAVAILABLE);
        assert!(matches!(missing, XrMissing::NoRuntime));
        let broken = no_runtime("x")(xr::sys::Result::ERROR_RUNTIME_FAILURE);
        assert!(matches!(broken, XrMissing::RuntimeFailed { call: "x", .. }));
    }
}
