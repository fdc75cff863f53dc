//! All code of scanwalk that the compiler cannot check: each block says why it is sound. All other rooms forbid
//! `unsafe`.

pub mod environment;
pub mod trusted;

#[cfg(feature = "openxr")]
pub mod depth_layer;
#[cfg(feature = "openxr")]
pub mod device;
#[cfg(feature = "openxr")]
pub mod frame;
#[cfg(feature = "openxr")]
pub mod image;
