//! What a frame is to look like: the settings that the stages, on the GPU and as twins, go by.

use crate::config::{Config, Dilate, EarlyZLoad, LodMethod, Precision, Quality};
use crate::layout::Detail;
use crate::method::{Access, Method};

/// [`Detail::fill_reach_px`] beside dilation: the kernels' widths.
pub const RINGS_REACH_PX: [f32; 3] = [3.0, 5.0, 7.0];
/// The same for discs of a sequential point tree, which have the sizes that close a surface. Kernels bridge two, four and
/// six empty pixels; discs lie unevenly, and where the gap comes near that there are pinholes.
const DISCS_REACH_PX: [f32; 3] = [2.0, 3.5, 5.0];
/// Without dilation.
const NO_REACH_PX: [f32; 3] = [1.0; 3];

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
    /// As the settings say. A method that is of one quality decides it: nobody else reads `frame.quality`.
    #[must_use]
    pub fn of(config: &Config) -> Self {
        let frame = &config.frame;
        // Discs have their sizes, and are drawn so.
        let discs = config.lod.enabled && config.lod.method == LodMethod::Spt;
        let reach_px = match frame.dilate {
            Dilate::Off => NO_REACH_PX,
            Dilate::Rings if discs => DISCS_REACH_PX,
            Dilate::Rings => RINGS_REACH_PX,
        };
        let detail = Detail {
            forced_planes: if frame.precision == Precision::Full { 3 } else { 0 },
            threshold_px: config.lod.threshold_px.map(|px| px as f32),
            ring_rad: config.fovea.ring_deg.map(f64::to_radians),
            smooth: config.fovea.smooth,
            fade: config.lod.fade,
            fill_reach_px: ((frame.fill || discs) && !frame.method.draws_pixels()).then_some(reach_px),
            error_px: discs.then_some(config.lod.error_px as f32),
            keep_unseen: !frame.cull,
        };
        let quality = frame.method.quality().unwrap_or(frame.quality);
        let access = Access {
            plain_looks: config.gpu.early_z_load == EarlyZLoad::Plain,
            checked: config.gpu.bounds_checks || Access::default().checked,
            ..Access::default()
        };
        Self {
            method: frame.method,
            quality,
            dilate: frame.dilate,
            background: frame.background,
            detail,
            access,
        }
    }

    /// The background as the stages have it: r | g≪8 | b≪16 | 255≪24.
    #[must_use]
    pub fn background_word(&self) -> u32 {
        let [r, g, b] = self.background;
        u32::from_le_bytes([r, g, b, 255])
    }
}
