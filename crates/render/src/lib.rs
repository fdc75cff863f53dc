//! The frame: from a cloud on the GPU and two eyes to two images. Knows no headset and no window: desktop,
//! pictures and headsets share this path. docs/FRAME.md §1 lists the stages.

pub mod bindings;
mod cloud_buffers;
mod draw_options;
mod drawn_part;
mod frame;
pub mod gpu;
mod groups;
pub mod layout;
mod nearest;
pub mod options;
mod overlay;
mod pipelines;
mod pool;
mod renderer;
pub mod scenery;
pub mod shaders;
mod targets;
pub mod technique;
mod tier;
mod upload;

pub use cloud_buffers::CloudBuffers;
pub use draw_options::{Access, DrawOptions, NO_REACH_PX, RINGS_REACH_PX};
pub use drawn_part::tiles;
pub use frame::{EyeImage, FrameTimes, IMAGE_USAGES};
pub use groups::Parts;
pub use overlay::Overlays;
pub use renderer::{Renderer, RendererError, Setup};
pub use targets::{TargetTooLarge, Targets, fitting_px};
pub use tier::{NoSuchTier, tier};
pub use upload::{CloudUpload, UploadError, Whole};
