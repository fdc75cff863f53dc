//! Which display server windows open on. winit takes Wayland wherever the environment names it, and can be asked once a
//! process; so a server that no longer answers (a session that has ended, a container that inherited its name) is found
//! before.

use super::DesktopError;
use std::env;
use std::path::PathBuf;
use winit::error::EventLoopError;
use winit::event_loop::EventLoop;

/// A display server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Server {
    /// A Wayland compositor answers.
    Wayland(String),
    /// The environment names an X server; Wayland, where it is named too, does not answer for this reason.
    X11 {
        /// ":0".
        name: String,
        /// In words.
        no_wayland: Option<String>,
    },
    /// The system has one of its own (Windows, macOS).
    System,
}

/// False if the environment names no display server; true promises nothing.
#[must_use]
pub fn is_named() -> bool {
    !cfg!(target_os = "linux")
        || ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].into_iter().any(|name| variable(name).is_some())
}

/// The server that windows open on.
///
/// # Errors
/// Why there is none, in words.
pub fn server() -> Result<Server, String> {
    if !cfg!(target_os = "linux") {
        return Ok(Server::System);
    }
    choose(variable("WAYLAND_DISPLAY"), variable("WAYLAND_SOCKET"), variable("DISPLAY"), wayland_answers)
}

fn choose(
    wayland: Option<String>,
    wayland_socket: Option<String>,
    x11: Option<String>,
    answers: impl FnOnce(&str) -> Result<(), String>,
) -> Result<Server, String> {
    // A connection that stands already: it can be used once, so it is not tried.
    if wayland_socket.is_some() {
        return Ok(Server::Wayland("a socket that was handed over".into()));
    }
    let no_wayland = match wayland {
        None => None,
        Some(name) => match answers(&name) {
            Ok(()) => return Ok(Server::Wayland(name)),
            Err(reason) => Some(format!("WAYLAND_DISPLAY names {name}, {reason}")),
        },
    };
    match (x11, no_wayland) {
        (Some(name), no_wayland) => Ok(Server::X11 { name, no_wayland }),
        (None, Some(reason)) => Err(format!("{reason}, and DISPLAY is not set")),
        (None, None) => Err("there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)".into()),
    }
}

/// A variable that is set and not empty.
fn variable(name: &str) -> Option<String> {
    env::var(name).ok().filter(|value| !value.is_empty())
}

/// Whether anything listens at a Wayland socket: a path, or a name in XDG_RUNTIME_DIR.
#[cfg(unix)]
fn wayland_answers(name: &str) -> Result<(), String> {
    let mut socket = PathBuf::from(name);
    if socket.is_relative() {
        let folder = variable("XDG_RUNTIME_DIR").ok_or("but XDG_RUNTIME_DIR is not set")?;
        socket = PathBuf::from(folder).join(socket);
    }
    match std::os::unix::net::UnixStream::connect(&socket) {
        Ok(_) => Ok(()),
        Err(error) => Err(format!("where no compositor answers ({error})")),
    }
}

#[cfg(not(unix))]
fn wayland_answers(_: &str) -> Result<(), String> {
    Ok(())
}

/// winit's connection to the server.
#[cfg(target_os = "linux")]
pub(super) fn event_loop() -> Result<EventLoop<()>, DesktopError> {
    use winit::platform::wayland::EventLoopBuilderExtWayland;
    use winit::platform::x11::EventLoopBuilderExtX11;
    let no_display = |reason: String| DesktopError::NoDisplay { reason };
    let mut builder = EventLoop::builder();
    let mut besides = String::new();
    match server().map_err(no_display)? {
        Server::X11 { no_wayland, .. } => {
            // winit panics without this library.
            if xkbcommon_dl::x11::xkbcommon_x11_option().is_none() {
                let reason = "the library libxkbcommon-x11 is missing (on Debian and Ubuntu: `apt install libxkbcommon-x11-0`)";
                return Err(no_display(reason.into()));
            }
            if let Some(reason) = no_wayland {
                tracing::info!("the window opens on X11: {reason}");
                besides = format!("; {reason}");
            }
            builder.with_x11();
        }
        Server::Wayland(_) | Server::System => {
            builder.with_wayland();
        }
    }
    builder.build().map_err(|error| match error {
        EventLoopError::Os(reason) => no_display(format!("the display does not answer ({reason}){besides}")),
        other => DesktopError::EventLoop(other),
    })
}

/// winit's connection to the server.
#[cfg(not(target_os = "linux"))]
pub(super) fn event_loop() -> Result<EventLoop<()>, DesktopError> {
    EventLoop::new().map_err(|error| match error {
        EventLoopError::Os(reason) => {
            DesktopError::NoDisplay { reason: format!("the display does not answer ({reason})") }
        }
        other => DesktopError::EventLoop(other),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wayland_is_taken_where_it_answers_and_x11_where_it_does_not() {
        let some = |name: &str| Some(name.to_string());
        let dead = |_: &str| Err("where no compositor answers (gone)".to_string());
        let x11 = |no_wayland: Option<&str>| {
            Ok(Server::X11 { name: ":0".into(), no_wayland: no_wayland.map(str::to_string) })
        };
        assert_eq!(choose(some("w"), None, some(":0"), |_| Ok(())), Ok(Server::Wayland("w".into())));
        assert_eq!(choose(None, None, some(":0"), dead), x11(None));
        let reason = "WAYLAND_DISPLAY names w, where no compositor answers (gone)";
        assert_eq!(choose(some("w"), None, some(":0"), dead), x11(Some(reason)));
        assert_eq!(choose(some("w"), None, None, dead), Err(format!("{reason}, and DISPLAY is not set")));
        assert!(choose(None, None, None, dead).unwrap_err().contains("neither"));
        assert!(matches!(choose(some("w"), some("3"), some(":0"), dead), Ok(Server::Wayland(_))));
    }

    #[test]
    #[cfg(unix)]
    fn a_socket_that_nobody_listens_at_does_not_answer() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).into_os_string().into_string().unwrap();
        let listener = std::os::unix::net::UnixListener::bind(path("alive")).unwrap();
        assert_eq!(wayland_answers(&path("alive")), Ok(()));
        drop(listener);
        std::fs::write(path("file"), "").unwrap();
        // The socket's file outlives its listener.
        for name in ["alive", "file", "missing"] {
            assert!(wayland_answers(&path(name)).is_err(), "{name}");
        }
    }
}
