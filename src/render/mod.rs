//! The frame: from a cloud on the GPU and two eyes to two images. Knows no headset and no window: desktop,
//! pictures and headsets share this path. frame.md section 1 lists the stages.

mod cloud_buffers;
mod frame;
pub mod shaders;
mod targets;

pub use cloud_buffers::{CloudBuffers, UploadError};
pub use frame::{FrameTimes, Renderer};
pub use targets::Targets;
