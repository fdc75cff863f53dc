//! Reading of files to points, and building of octrees from points, on the CPU.

mod attributes;
mod bytes;
mod colors;
mod ept;
mod many_files;
mod octree;
mod placing;
mod ply;
mod potree;
mod scan_broken;
mod scan_formats;
mod scan_real;
mod scene;
mod starts;
mod stations;
mod synth;
mod tables;
mod tally;
mod up;

/// The program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_scanwalk");
