//! Variables of the environment, which libraries read when they are loaded.

use std::ffi::OsStr;

/// Sets a variable of this process's environment, while the process has one thread. Otherwise, and where nobody can
/// tell, it does nothing: another thread may be reading the environment.
pub fn set(name: &OsStr, value: &OsStr) {
    if is_single_threaded() {
        // SAFETY: no other thread can read or write the environment meanwhile: there is none, and only this one could
        // start one.
        unsafe { std::env::set_var(name, value) };
    }
}

/// True if the process has one thread, by the list of threads that Linux has.
fn is_single_threaded() -> bool {
    std::fs::read_dir("/proc/self/task").is_ok_and(|threads| threads.count() == 1)
}
