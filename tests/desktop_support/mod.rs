//! What the tests of the window stand on: a virtual screen, and the window's program as a child process.

pub mod child;
pub mod fault;
pub mod walk;
