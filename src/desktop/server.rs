//! Which display server windows open on. winit takes Wayland wherever the environment names it, can be asked once a
//! process, and waits for as long as a server keeps silent. So a server that does not answer (a session that has
//! ended or hangs, a container that inherited its name) is found before winit is asked.

use super::DesktopError;
use base::task::CancelToken;
use std::env;
use std::io;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};
use winit::error::{EventLoopError, OsError};
use winit::event_loop::EventLoop;

/// How long a server may take to answer.
const PATIENCE: Duration = Duration::from_secs(3);
/// Time between two looks at whether the user still waits.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// A display server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Server {
    /// A Wayland compositor answers.
    Wayland(String),
    /// The environment names an X server that is not silent. Wayland does not answer where it is named too.
    X11 {
        /// Name of the display: ":0".
        name: String,
        /// Why Wayland does not answer, in words.
        no_wayland: Option<String>,
    },
    /// The system has a display server of its own (Windows, macOS).
    System,
}

/// False if the environment names no display server; true promises nothing.
#[must_use]
pub fn is_named() -> bool {
    !cfg!(target_os = "linux")
        || ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].into_iter().any(|name| variable(name).is_some())
}

/// Finds the server that windows open on. Silent servers are given up after some seconds, or at once when `stop` is
/// requested.
///
/// # Errors
/// Why there is none, in words.
pub fn server(stop: &CancelToken) -> Result<Server, String> {
    if !cfg!(target_os = "linux") {
        return Ok(Server::System);
    }
    choose(
        variable("WAYLAND_DISPLAY"),
        variable("WAYLAND_SOCKET"),
        variable("DISPLAY"),
        |name| wayland_answers(name, PATIENCE, stop),
        |name| x11_answers(name, PATIENCE, stop),
    )
}

fn choose(
    wayland: Option<String>,
    wayland_socket: Option<String>,
    x11: Option<String>,
    wayland_answers: impl FnOnce(&str) -> Result<(), String>,
    x11_answers: impl FnOnce(&str) -> Result<(), String>,
) -> Result<Server, String> {
    // A connection that stands already can be used only once, so it is not tried.
    if wayland_socket.is_some() {
        return Ok(Server::Wayland("a socket that was handed over".into()));
    }
    let no_wayland = match wayland {
        None => None,
        Some(name) => match wayland_answers(&name) {
            Ok(()) => return Ok(Server::Wayland(name)),
            Err(reason) => Some(format!("WAYLAND_DISPLAY names {name}, {reason}")),
        },
    };
    match (x11, no_wayland) {
        (Some(name), no_wayland) => match (x11_answers(&name), no_wayland) {
            (Ok(()), no_wayland) => Ok(Server::X11 { name, no_wayland }),
            (Err(reason), None) => Err(format!("DISPLAY names {name}, {reason}")),
            (Err(reason), Some(no_wayland)) => {
                Err(format!("{no_wayland}, and DISPLAY names {name}, {reason}"))
            }
        },
        (None, Some(reason)) => Err(format!("{reason}, and DISPLAY is not set")),
        (None, None) => Err("there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)".into()),
    }
}

/// Value of a variable that is set and not empty.
fn variable(name: &str) -> Option<String> {
    env::var(name).ok().filter(|value| !value.is_empty())
}

/// Whether a compositor answers at a Wayland socket: a path, or a name in XDG_RUNTIME_DIR.
#[cfg(unix)]
fn wayland_answers(name: &str, patience: Duration, stop: &CancelToken) -> Result<(), String> {
    let mut socket = std::path::PathBuf::from(name);
    if socket.is_relative() {
        let folder = variable("XDG_RUNTIME_DIR").ok_or("but XDG_RUNTIME_DIR is not set")?;
        socket = std::path::PathBuf::from(folder).join(socket);
    }
    let answer = within(patience, stop, move || {
        use std::io::{Read, Write};
        let mut stream = std::os::unix::net::UnixStream::connect(&socket)?;
        // "When all before this is done, say so to object 2": the display's (object 1) request sync (0), of 12 bytes.
        let sync = [1u32, 12 << 16, 2].map(u32::to_ne_bytes);
        stream.write_all(sync.as_flattened())?;
        stream.read_exact(&mut [0])
    });
    match answer {
        Some(Ok(())) => Ok(()),
        Some(Err(error)) => Err(format!("where no compositor answers ({error})")),
        None => Err("where a compositor listens, but does not answer".into()),
    }
}

#[cfg(not(unix))]
fn wayland_answers(_: &str, _: Duration, _: &CancelToken) -> Result<(), String> {
    Ok(())
}

/// Whether an X server is not silent. winit reports a server that is not there, or refuses: it knows more ways to
/// one.
#[cfg(target_os = "linux")]
fn x11_answers(name: &str, patience: Duration, stop: &CancelToken) -> Result<(), String> {
    let name = name.to_owned();
    let answer =
        within(patience, stop, move || x11rb::connect(Some(&name)).map(drop).map_err(io::Error::other));
    answer.map(drop).ok_or_else(|| "where an X server listens, but does not answer".into())
}

#[cfg(not(target_os = "linux"))]
fn x11_answers(_: &str, _: Duration, _: &CancelToken) -> Result<(), String> {
    Ok(())
}

/// Returns the answer of `ask`, if it comes within `patience` and before `stop` is requested. Otherwise the thread
/// that asks goes on waiting, since nothing ends a wait inside a library.
fn within<T: Send + 'static>(
    patience: Duration,
    stop: &CancelToken,
    ask: impl FnOnce() -> io::Result<T> + Send + 'static,
) -> Option<io::Result<T>> {
    let (sender, answer) = channel();
    // Sending fails if nobody waits for the answer any more.
    let asking = move || drop(sender.send(ask()));
    if let Err(error) = std::thread::Builder::new().name("display".into()).spawn(asking) {
        return Some(Err(error));
    }
    let deadline = Instant::now() + patience;
    while !stop.is_cancelled() && Instant::now() < deadline {
        match answer.recv_timeout(LOOK_EVERY) {
            Ok(answer) => return Some(answer),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return None,
        }
    }
    None
}

/// winit's connection to the server.
#[cfg(target_os = "linux")]
pub(super) fn event_loop(stop: &CancelToken) -> Result<EventLoop<()>, DesktopError> {
    use winit::platform::wayland::EventLoopBuilderExtWayland;
    use winit::platform::x11::EventLoopBuilderExtX11;
    let no_display = |reason: String| DesktopError::NoDisplay { reason };
    let mut builder = EventLoop::builder();
    let mut besides = String::new();
    match server(stop).map_err(no_display)? {
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
        EventLoopError::Os(error) => {
            no_display(format!("the display does not answer ({}){besides}", words(&error)))
        }
        other => DesktopError::EventLoop { reason: event_loop_words(&other) },
    })
}

/// winit's connection to the server.
#[cfg(not(target_os = "linux"))]
pub(super) fn event_loop(_: &CancelToken) -> Result<EventLoop<()>, DesktopError> {
    EventLoop::new().map_err(|error| match error {
        EventLoopError::Os(error) => {
            DesktopError::NoDisplay { reason: format!("the display does not answer ({})", words(&error)) }
        }
        other => DesktopError::EventLoop { reason: event_loop_words(&other) },
    })
}

/// Tells what failed in the event loop.
pub(super) fn event_loop_words(error: &EventLoopError) -> String {
    match error {
        EventLoopError::Os(error) => words(error),
        other => other.to_string(),
    }
}

/// Returns the system's words, without the place in winit's source that winit puts before them.
pub(super) fn words(error: &OsError) -> String {
    without_place(&error.to_string()).to_owned()
}

/// Cuts "os error at FILE:LINE: WHY" down to WHY.
fn without_place(text: &str) -> &str {
    let place_and_reason = text.strip_prefix("os error at ").and_then(|rest| rest.split_once(": "));
    place_and_reason.map_or(text, |(_, reason)| reason)
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
        let alive = |_: &str| Ok(());
        let choose = |wayland, socket, x11| super::choose(wayland, socket, x11, dead, alive);
        let answering = super::choose(some("w"), None, some(":0"), alive, alive);
        assert_eq!(answering, Ok(Server::Wayland("w".into())));
        assert_eq!(choose(None, None, some(":0")), x11(None));
        let reason = "WAYLAND_DISPLAY names w, where no compositor answers (gone)";
        assert_eq!(choose(some("w"), None, some(":0")), x11(Some(reason)));
        assert_eq!(choose(some("w"), None, None), Err(format!("{reason}, and DISPLAY is not set")));
        assert!(choose(None, None, None).unwrap_err().contains("neither"));
        assert!(matches!(choose(some("w"), some("3"), some(":0")), Ok(Server::Wayland(_))));
        let silent = |_: &str| Err("but silent".to_string());
        let none = super::choose(some("w"), None, some(":0"), dead, silent);
        assert_eq!(none, Err(format!("{reason}, and DISPLAY names :0, but silent")));
        assert_eq!(
            super::choose(None, None, some(":0"), dead, silent),
            Err("DISPLAY names :0, but silent".into())
        );
    }

    #[test]
    #[cfg(unix)]
    fn a_socket_that_nobody_listens_at_does_not_answer() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).into_os_string().into_string().unwrap();
        let listener = std::os::unix::net::UnixListener::bind(path("alive")).unwrap();
        let (stop, soon) = (CancelToken::default(), Duration::from_millis(200));
        // The system takes the connection and the request; nobody reads them.
        let silent = wayland_answers(&path("alive"), soon, &stop).unwrap_err();
        assert!(silent.contains("does not answer"), "{silent}");
        let asked = CancelToken::default();
        asked.cancel();
        // A caller who asks it to stop is not made to wait: otherwise this test would never end.
        assert!(wayland_answers(&path("alive"), Duration::from_secs(3600), &asked).is_err());
        // Both callers above have left their connections; the third is served.
        let compositor = std::thread::spawn(move || {
            use std::io::{Read, Write};
            for _ in 0..3 {
                let (mut stream, _) = listener.accept().unwrap();
                let mut request = [0; 12];
                stream.read_exact(&mut request).unwrap();
                assert_eq!(request, *[1u32, 12 << 16, 2].map(u32::to_ne_bytes).as_flattened());
                let _ = stream.write_all(&[2, 0, 0, 0]);
            }
        });
        assert_eq!(wayland_answers(&path("alive"), Duration::from_secs(60), &stop), Ok(()));
        compositor.join().unwrap();
        std::fs::write(path("file"), "").unwrap();
        // The socket's file outlives its listener.
        for name in ["alive", "file", "missing"] {
            let reason = wayland_answers(&path(name), soon, &stop).unwrap_err();
            assert!(reason.contains("no compositor answers"), "{name}: {reason}");
        }
    }

    #[test]
    fn no_sentence_quotes_a_place_in_a_library() {
        let text = "os error at /x/registry/winit-0.30.13/src/linux/mod.rs:788: no server: gone";
        assert_eq!(without_place(text), "no server: gone");
        assert_eq!(without_place("something else: gone"), "something else: gone");
    }
}
