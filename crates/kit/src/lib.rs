//! The test kit: code that several test programs and benchmarks share. Nothing of it is in the program.
#![allow(missing_docs, reason = "tests are its only readers, and stand beside it")]

pub mod damage;
pub mod frames;
pub mod las_files;
pub mod made_up;
pub mod picture;
pub mod program;
pub mod quality;
pub mod reading;
pub mod real_scans;
pub mod rows;
pub mod screen;
pub mod spread;
pub mod steps;
pub mod timed;
pub mod wait;
pub mod xr;
pub mod xwd;
