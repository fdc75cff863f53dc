//! The test kit: code that several test programs and benchmarks share. Nothing of it is in the program.
#![allow(missing_docs, reason = "tests are its only readers, and stand beside it")]

pub mod damage;
pub mod frames;
pub mod las_files;
pub mod quality;
pub mod real_scans;
pub mod rows;
pub mod screen;
pub mod steps;
pub mod timed;
pub mod xr;
pub mod xwd;
