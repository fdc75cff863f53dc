//! `scanwalk doctor`: what this machine has and lacks, and what to install.

use crate::desktop::{self, Server};
use crate::failure::Failure;
use base::task::CancelToken;
use render::gpu::{Atomics, Gpu};
use serde::Serialize;
use std::io::{self, Write};
use xr::Connection;

/// One thing that a walk needs, or is better with.
#[derive(Debug, Serialize)]
struct Check {
    /// What was looked at.
    check: &'static str,
    /// True if nothing is to be done.
    ok: bool,
    /// What was found, in words.
    found: String,
    /// What to do; empty if all is well.
    advice: String,
}

impl Check {
    fn good(check: &'static str, found: impl Into<String>) -> Self {
        Self { check, ok: true, found: found.into(), advice: String::new() }
    }

    fn bad(check: &'static str, found: impl Into<String>, advice: impl Into<String>) -> Self {
        Self { check, ok: false, found: found.into(), advice: advice.into() }
    }
}

/// Checks this machine, with the GPU whose name contains `adapter`, and prints the checks: as JSON for programs, else
/// as lines. A lack that it finds is no failure.
pub(super) fn run(adapter: &str, json: bool, stop: &CancelToken) -> Result<(), Failure> {
    let mut checks = gpu(adapter);
    checks.push(display(stop));
    checks.push(headset());
    let mut out = io::stdout().lock();
    if json {
        writeln!(out, "{}", serde_json::to_string_pretty(&checks).map_err(io::Error::from)?)?;
        return Ok(());
    }
    for Check { check, ok, found, advice } in &checks {
        writeln!(out, "{} {check:<13} {found}", if *ok { "ok     " } else { "lacking" })?;
        if !advice.is_empty() {
            writeln!(out, "{:22}{advice}", "")?;
        }
    }
    Ok(())
}

/// Checks the GPU, its driver and its clock.
fn gpu(adapter: &str) -> Vec<Check> {
    let gpu = match Gpu::open(Some(adapter)) {
        Ok(gpu) => gpu,
        Err(error) => {
            let advice =
                "install a Vulkan driver for your GPU (for any machine, slowly: mesa-vulkan-drivers)";
            return vec![Check::bad("gpu", error.to_string(), advice)];
        }
    };
    let name = format!("{} ({})", gpu.name(), gpu.driver());
    let software = gpu.is_software();
    let kind = if software {
        Check::bad(
            "gpu",
            name,
            "this is software: pictures are right, but no walk is smooth; install your GPU's driver",
        )
    } else {
        Check::good("gpu", name)
    };
    let clock = if gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
        Check::good("gpu clock", "the stages of a frame can be timed")
    } else {
        Check::bad(
            "gpu clock",
            "no timestamps",
            "frame logs will lack GPU times; a newer driver may have them",
        )
    };
    let tier = gpu.atomics();
    let atomics = match tier {
        Atomics::Int64 => Check::good("gpu atomics", tier.name()),
        _ => Check::bad(
            "gpu atomics",
            tier.name(),
            "64-bit atomics in shaders are missing: pictures are the same, frames take longer; a newer driver may have them",
        ),
    };
    // No walk needs subgroups, so a GPU without them is no lack.
    let subgroups =
        if gpu.has_subgroups() { "yes" } else { "none: reduce and dedup are drawn by a stand-in" };
    vec![kind, atomics, Check::good("gpu subgroups", subgroups), clock]
}

/// Checks whether there is a display that a window can open on.
fn display(stop: &CancelToken) -> Check {
    match desktop::server(stop) {
        Ok(Server::Wayland(name)) => Check::good("display", format!("Wayland, {name}")),
        Ok(Server::X11 { name, no_wayland: None }) => Check::good("display", format!("X11, {name}")),
        Ok(Server::X11 { name, no_wayland: Some(reason) }) => {
            Check::good("display", format!("X11, {name} ({reason})"))
        }
        Ok(Server::System) => Check::good("display", "the system's own"),
        Err(reason) => {
            let advice = "for a window, start scanwalk from a graphical session";
            Check::bad("display", format!("none: {reason}"), advice)
        }
    }
}

/// Checks whether there is an OpenXR runtime with a headset.
fn headset() -> Check {
    match Connection::new() {
        Ok(connection) => {
            let (runtime, headset) = connection.names();
            Check::good("headset", format!("{headset}, by {runtime}"))
        }
        Err(missing) => Check::bad("headset", "none that answers", missing.to_string()),
    }
}
