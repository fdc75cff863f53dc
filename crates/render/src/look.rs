//! What a frame is to look like: the settings that the stages, on the GPU and as twins, go by.

use crate::layout::Detail;
use crate::method::{Access, Method};
use crate::options::{Dilate, Quality};

/// Pixels by which a disc of a sequential point tree may be wrong, unless the settings say otherwise.
pub const DEFAULT_ERROR_PX: f64 = 1.0;
/// [`Detail::fill_reach_px`] beside dilation: the kernels' widths.
pub const RINGS_REACH_PX: [f32; 3] = [3.0, 5.0, 7.0];
/// The same for discs of a sequential point tree, which have the sizes that close a surface. Kernels bridge two, four and
/// six empty pixels; discs lie unevenly, and where the gap comes near that there are pinholes.
pub const DISCS_REACH_PX: [f32; 3] = [2.0, 3.5, 5.0];
/// The same without dilation.
pub const NO_REACH_PX: [f32; 3] = [1.0; 3];

/// What a frame is to look like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// How points get into pixels.
    pub method: Method,
    /// What a pixel shows of the points in it.
    pub quality: Quality,
    /// How gaps between points are filled.
    pub dilate: Dilate,
    /// Colour where no point is, as stored.
    pub background: [u8; 3],
    /// How much of the cloud is drawn.
    pub detail: Detail,
    /// How shaders reach memory: of this the picture does not depend.
    pub access: Access,
}

impl Look {
    /// Whether what is drawn is a sequential point tree's discs and triangles.
    #[must_use]
    pub fn draws_discs(&self) -> bool {
        self.detail.error_px.is_some()
    }

    /// The background as the stages have it: r | g≪8 | b≪16 | 255≪24.
    #[must_use]
    pub fn background_word(&self) -> u32 {
        let [r, g, b] = self.background;
        u32::from_le_bytes([r, g, b, 255])
    }
}
