//! Keeps libraries from writing to stderr by themselves, and from waiting for others: what is wrong is for us to say, in a
//! sentence.
//!
//! The loaders of Vulkan and OpenXR print what they stumble over while they look for drivers and runtimes. Mesa's layer that
//! chooses a GPU asks the display server for its own: it prints an error where there is none, and waits for ever where one
//! keeps silent. Each of them documents a variable of the environment that turns this off, and has no other way; each reads
//! it when it is loaded. What the user has set stays, and `-vv` lets the loaders speak.

use std::env;
use std::ffi::OsStr;

/// The loaders speak from this verbosity on.
const VERBOSE: u8 = 2;

/// Silences the libraries. It is to be called first in the program: variables of the environment may be set while the
/// process has one thread.
pub(super) fn libraries(verbose: u8) {
    for (name, value) in wanted(verbose, |name| env::var_os(name).is_some_and(|value| !value.is_empty())) {
        raw::environment::set(OsStr::new(name), OsStr::new(value));
    }
}

/// Returns the variables to set, with their values; `is_set` tells which ones the user has set already.
fn wanted(verbose: u8, is_set: impl Fn(&str) -> bool) -> Vec<(&'static str, &'static str)> {
    let mut wanted = Vec::new();
    if verbose < VERBOSE {
        wanted.extend([("VK_LOADER_DEBUG", "none"), ("XR_LOADER_DEBUG", "none")]);
    }
    // scanwalk chooses a GPU by kind and name; the layer is left to users who choose by these variables.
    if !["MESA_VK_DEVICE_SELECT", "DRI_PRIME"].into_iter().any(&is_set) {
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
        let names = |verbose, set: &[&str]| -> Vec<_> {
            wanted(verbose, |name| set.contains(&name)).into_iter().map(|(name, _)| name).collect()
        };
        assert_eq!(names(0, &[]), ["VK_LOADER_DEBUG", "XR_LOADER_DEBUG", "NODEVICE_SELECT"]);
        assert_eq!(names(1, &["VK_LOADER_DEBUG", "NODEVICE_SELECT"]), ["XR_LOADER_DEBUG"]);
        assert_eq!(names(0, &["XR_LOADER_DEBUG", "DRI_PRIME"]), ["VK_LOADER_DEBUG"]);
        assert_eq!(names(2, &[]), ["NODEVICE_SELECT"]);
    }
}
