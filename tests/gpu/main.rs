//! Stages and frames on whatever Vulkan driver there is, compared with the CPU references.

mod access;
mod arrival;
mod bench;
mod border;
mod defects;
mod dilate;
mod drawn_part;
mod frame;
mod fuzzy;
mod holes;
mod layered;
mod mesh;
mod methods;
mod overlay;
mod popping;
mod precision;
mod scenery;
mod second_driver;
mod shaders;
mod spt;

/// The program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_scanwalk");
