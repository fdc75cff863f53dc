//! Runs decoders that may panic on broken input, and turns the panic into a reason.
//!
//! The `laz` crate panics on corrupt data, by indexing and by assertions. Such a panic is one lost chunk, not a crash,
//! and it must not print a backtrace over a progress bar: while a guarded closure runs, the panic hook of its thread is
//! silent. The guard needs unwinding panics (the default; `panic = "abort"` would undo it).

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Returns what `run` returns, or the words of its panic.
///
/// Whatever `run` changed through references is in an unknown state after a panic: callers drop it.
pub(crate) fn catch<T>(run: impl FnOnce() -> T) -> Result<T, String> {
    static INSTALL: Once = Once::new();
    INSTALL.call_once(|| {
        let previous = take_hook();
        set_hook(Box::new(move |info| {
            // `try_with`: a panic while the thread ends must not panic again.
            if !GUARDED.try_with(Cell::get).unwrap_or(false) {
                previous(info);
            }
        }));
    });
    let outer = GUARDED.replace(true);
    let result = catch_unwind(AssertUnwindSafe(run));
    GUARDED.set(outer);
    result.map_err(|payload| {
        let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
        text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_else(|| "unknown reason".into())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_its_words() {
        assert_eq!(catch(|| 7), Ok(7));
        let index = [1, 2, 3].len();
        assert!(catch(|| [1, 2, 3][index]).unwrap_err().contains("out of bounds"));
        assert_eq!(catch(|| -> u8 { panic!("no table") }), Err("no table".into()));
    }
}
