//! The process: variables of its environment, which libraries read when they are loaded, and its end while threads still
//! run.

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

/// Ends the process with this exit code, at once. Nothing of it is run any more: no destructor of a library whose code
/// another thread is still in.
pub fn end_at_once(code: u8) -> ! {
    #[cfg(unix)]
    {
        unsafe extern "C" {
            fn _exit(code: std::ffi::c_int) -> !;
        }
        // SAFETY: POSIX has this function in every C library, and it takes any number.
        unsafe { _exit(code.into()) }
    }
    #[cfg(not(unix))]
    std::process::exit(code.into())
}

/// True if the process has one thread, by the list of threads that Linux has.
fn is_single_threaded() -> bool {
    std::fs::read_dir("/proc/self/task").is_ok_and(|threads| threads.count() == 1)
}
