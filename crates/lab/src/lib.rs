//! The laboratory: code that measures, compares and proves, and that no walk needs. It holds made-up scans, CPU
//! references of the stages, the papers' methods and tables, sequential point trees, and reports of measurements.

pub mod bench;
mod hardware;
mod options;
pub mod order;
pub mod reference;
pub mod report;
pub mod synth;
pub mod technique;

pub use options::{LabCloud, LabOptions, LodMethod};
