//! What a frame is to look like: the settings that the stages, on the GPU and as CPU references, go by.

use crate::layout::Detail;
use crate::options::{Dilate, Quality};

/// [`Detail::fill_reach_px`] beside dilation: the kernels' widths.
pub const RINGS_REACH_PX: [f32; 3] = [3.0, 5.0, 7.0];
/// [`Detail::fill_reach_px`] without dilation: a pixel's own width.
pub const NO_REACH_PX: [f32; 3] = [1.0; 3];

/// How shaders reach memory. The picture is the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Access {
    /// True if shaders check every index.
    pub checked: bool,
    /// True if all threads of a workgroup draw wide points together. `None`: true unless the device is software, which
    /// runs threads in turns and pays dearly for their waiting for each other.
    pub together: Option<bool>,
}

impl Default for Access {
    /// Indices are checked in debug builds, and so in tests.
    fn default() -> Self {
        Self { checked: cfg!(debug_assertions), together: None }
    }
}

/// What a frame is to look like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawOptions {
    /// What a pixel shows of the points in it.
    pub quality: Quality,
    /// How gaps between points are filled.
    pub dilate: Dilate,
    /// Color where no point is, as stored.
    pub background: [u8; 3],
    /// How much of the cloud is drawn.
    pub detail: Detail,
    /// How shaders reach memory, on which the picture does not depend.
    pub access: Access,
}

impl DrawOptions {
    /// The background as the stages have it: r | g≪8 | b≪16 | 255≪24.
    #[must_use]
    pub fn background_word(&self) -> u32 {
        let [r, g, b] = self.background;
        u32::from_le_bytes([r, g, b, 255])
    }
}
