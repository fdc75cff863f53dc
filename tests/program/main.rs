//! The program's commands, settings and reports, and the house's own rules.

mod cli;
mod config;
mod controllers;
mod house;
mod logs;
mod outputs;
mod pages;
mod report;
mod strangers;
mod timing;

/// The program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_scanwalk");
