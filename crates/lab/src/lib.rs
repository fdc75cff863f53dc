//! The laboratory: what measures, compares and proves, and no walk needs. Made-up scans, the stages on the CPU, the papers'
//! methods and tables, sequential point trees, and reports of what was measured.

pub mod bench;
mod hardware;
pub mod reference;
pub mod report;
pub mod synth;
pub mod technique;
