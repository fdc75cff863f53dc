//! Parts that every room uses and no room owns: choices, spaces, sRGB, long work and its progress, words, random numbers,
//! percentiles, and the files that are written.

pub mod choice;
pub mod output;
pub mod percentile;
pub mod random;
pub mod space;
pub mod srgb;
pub mod task;
pub mod words;
