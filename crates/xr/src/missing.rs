//! Why there is no headset: one plain sentence for each thing that can be missing, with what to do.

use raw::device::DeviceError;
use render::gpu::GpuError;

/// What keeps [`super::open`] from opening a headset.
///
/// Whether that ends the program or only means "use the desktop" is for the caller to decide.
#[derive(Debug, thiserror::Error)]
pub enum XrMissing {
    /// `libopenxr_loader.so.1` is not installed.
    #[error(
        "no OpenXR loader found: install it (on Debian and Ubuntu: `apt install libopenxr-loader1`) ({reason})"
    )]
    NoLoader {
        /// The dynamic linker's words.
        reason: String,
    },
    /// The loader knows of no runtime.
    #[error(
        "no OpenXR runtime is set up: start your headset's software once (SteamVR, Monado, WiVRn, …) and make \
         it the active OpenXR runtime, or point XR_RUNTIME_JSON at the runtime's .json file"
    )]
    NoRuntime,
    /// A runtime is set up but does not answer, or gave up on a call.
    #[error(
        "the OpenXR runtime does not work ({call}: {result:?}): start or restart it (SteamVR; for Monado: \
         monado-service) and try again"
    )]
    RuntimeFailed {
        /// The OpenXR call that failed.
        call: &'static str,
        /// Its result.
        result: openxr::sys::Result,
    },
    /// The runtime cannot share a Vulkan device in the way that we need.
    #[error(
        "the OpenXR runtime '{runtime}' lacks the extension XR_KHR_vulkan_enable2: update it or choose another"
    )]
    NoVulkan {
        /// Name and version of the runtime.
        runtime: String,
    },
    /// The runtime works; no headset is connected to it.
    #[error("the OpenXR runtime '{runtime}' finds no headset: connect it, switch it on, and try again")]
    NoHeadset {
        /// Name and version of the runtime.
        runtime: String,
    },
    /// The connected device does not show one image an eye.
    #[error("'{headset}' is not a stereo headset: scanwalk needs one image for each of two eyes")]
    NotStereo {
        /// Name of the device, as the runtime gives it.
        headset: String,
    },
    /// The GPU that the runtime wants cannot run the frame.
    #[error(
        "the headset is driven by the GPU '{name}', which scanwalk cannot use: {reason}; connect the headset to \
         another GPU, or update the driver"
    )]
    GpuUnusable {
        /// The GPU, or "unknown" before it told its name.
        name: String,
        /// What it lacks, or the driver's words.
        reason: String,
    },
    /// The runtime does not let us in.
    #[error(
        "the OpenXR runtime '{runtime}' refused the session ({call}: {result:?}): end other programs that use the \
         headset, and try again"
    )]
    SessionRefused {
        /// Name and version of the runtime.
        runtime: String,
        /// The OpenXR call that failed.
        call: &'static str,
        /// Its result.
        result: openxr::sys::Result,
    },
    /// The runtime has no 8-bit sRGB image format.
    #[error("the OpenXR runtime '{runtime}' offers no 8-bit sRGB image format: update it or choose another")]
    NoImageFormat {
        /// Name and version of the runtime.
        runtime: String,
    },
}

impl XrMissing {
    /// For `map_err`: the runtime gave up on `call`.
    pub(super) fn runtime_failed(call: &'static str) -> impl FnOnce(openxr::sys::Result) -> Self {
        move |result| Self::RuntimeFailed { call, result }
    }
}

impl From<DeviceError> for XrMissing {
    fn from(error: DeviceError) -> Self {
        match error {
            DeviceError::Runtime { call, result } => Self::RuntimeFailed { call, result },
            DeviceError::Gpu { name, reason } => Self::GpuUnusable { name, reason },
        }
    }
}

/// What the GPU lacks that every frame needs, without its name.
pub(super) fn lacking(error: GpuError) -> String {
    match error {
        GpuError::Lacking { missing, .. } => format!("it lacks {missing}"),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sentence_names_the_thing_and_what_to_do() {
        let runtime = || "Monado 25.0.0".to_string();
        let result = openxr::sys::Result::ERROR_RUNTIME_FAILURE;
        let lacking = GpuError::Lacking { name: "Old".into(), missing: "64-bit integers".into() };
        let cases = [
            (XrMissing::NoLoader { reason: "not found".into() }, ["OpenXR loader", "install"]),
            (XrMissing::NoRuntime, ["runtime", "XR_RUNTIME_JSON"]),
            (XrMissing::runtime_failed("xrCreateInstance")(result), ["xrCreateInstance", "restart"]),
            (XrMissing::NoVulkan { runtime: runtime() }, ["XR_KHR_vulkan_enable2", "update"]),
            (XrMissing::NoHeadset { runtime: runtime() }, ["no headset", "connect"]),
            (XrMissing::NotStereo { headset: "Phone".into() }, ["Phone", "two eyes"]),
            (
                XrMissing::GpuUnusable { name: "Old".into(), reason: super::lacking(lacking) },
                ["lacks 64-bit integers", "another GPU"],
            ),
            (
                XrMissing::SessionRefused { runtime: runtime(), call: "xrCreateSession", result },
                ["refused", "end other programs"],
            ),
            (XrMissing::NoImageFormat { runtime: runtime() }, ["sRGB", "update"]),
        ];
        for (missing, words) in cases {
            let sentence = missing.to_string();
            for word in words {
                assert!(sentence.contains(word), "'{sentence}' should contain '{word}'");
            }
            assert!(!sentence.contains("  ") && !sentence.contains('\n'), "one line: {sentence:?}");
        }
    }
}
