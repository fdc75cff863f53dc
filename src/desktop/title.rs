//! What the window's title says: it can be told even while nothing can be drawn.

use crate::walk::link::LoadState;

/// Title of a window in which nothing can be drawn.
const STARVED: &str =
    "The headset's software or the GPU's driver does not answer; Esc, twice, leaves – scanwalk";

/// Title of a window that shows this, or nothing, because somebody keeps the GPU's queue.
pub(super) fn of(load: &LoadState, is_starved: bool) -> String {
    match load.names().as_str() {
        _ if is_starved => STARVED.to_string(),
        "" => "scanwalk".to_string(),
        scan => format!("{scan} – scanwalk"),
    }
}
