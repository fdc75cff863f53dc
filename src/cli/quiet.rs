//! Keeps libraries from writing to stderr by themselves: what is wrong is for us to say, in a sentence.
//!
//! The loaders of Vulkan and OpenXR print what they stumble over while they look for drivers and runtimes, and Mesa's
//! layer that chooses a GPU asks a Wayland compositor for its own, which prints an error where there is none. Each of
//! them documents a variable of the environment that turns this off, and has no other way; each reads it when it is
//! loaded. What the user has set stays, and `-vv` lets them speak.

#![allow(unsafe_code, reason = "the environment is set before there are threads")]

use std::env;
use std::ffi::OsStr;

/// From this on, libraries speak.
const VERBOSE: u8 = 2;

/// To be called first in the program: variables of the environment may be set while it has one thread.
pub(super) fn libraries(verbose: u8) {
    if verbose >= VERBOSE {
        return;
    }
    for (name, value) in wanted(|name| env::var_os(name).is_some_and(|value| !value.is_empty())) {
        // SAFETY: `cli::main` is the program's first act, so no other thread can read the environment meanwhile.
        unsafe { env::set_var(OsStr::new(name), OsStr::new(value)) };
    }
}

/// What to set where these variables are set already.
fn wanted(is_set: impl Fn(&str) -> bool) -> Vec<(&'static str, &'static str)> {
    let mut wanted = vec![("VK_LOADER_DEBUG", "none"), ("XR_LOADER_DEBUG", "none")];
    // Mesa's layer is of use where a compositor answers, or where the user chooses a GPU by it. We choose by kind and
    // name.
    let chooses = ["MESA_VK_DEVICE_SELECT", "DRI_PRIME"].into_iter().any(&is_set);
    if !is_set("XDG_RUNTIME_DIR") && !chooses {
        wanted.push(("NODEVICE_SELECT", "1"));
    }
    wanted.retain(|(name, _)| !is_set(name));
    wanted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_user_has_set_stays() {
        let names = |set: &[&str]| -> Vec<_> {
            wanted(|name| set.contains(&name)).into_iter().map(|(name, _)| name).collect()
        };
        assert_eq!(names(&[]), ["VK_LOADER_DEBUG", "XR_LOADER_DEBUG", "NODEVICE_SELECT"]);
        assert_eq!(names(&["XDG_RUNTIME_DIR", "VK_LOADER_DEBUG"]), ["XR_LOADER_DEBUG"]);
        assert_eq!(names(&["XR_LOADER_DEBUG", "DRI_PRIME"]), ["VK_LOADER_DEBUG"]);
    }
}
