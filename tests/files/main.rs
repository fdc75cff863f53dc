//! Reading of files to points, and building of octrees from points, on the CPU.

mod attributes;
mod bytes;
mod colors;
mod many_files;
mod octree;
mod placing;
mod ply;
mod scan_broken;
mod scan_formats;
mod scan_real;
mod scene;
mod starts;
mod synth;
mod tally;
mod up;

/// The program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_scanwalk");
