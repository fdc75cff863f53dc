//! The ways to draw that tables compare.

use crate::technique::{DEFAULT_ERROR_PX, LabTechnique, Method};
use render::layout::{ALL_PLANES, Detail};
use render::options::{Dilate, Precision, Quality};
use render::{Access, DrawOptions};

/// The forms in which a scan is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CloudForm {
    /// Every point.
    Flat,
    /// An octree: the nodes that level of detail chooses.
    Octree,
    /// A sequential point tree: the discs that the tolerance chooses.
    Spt,
}

/// A way to draw, by the name that its rows have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// Name of the rows, as in the papers.
    pub name: &'static str,
    /// The method; `None` for hardware points.
    pub method: Option<Method>,
    /// What a pixel shows.
    pub quality: Quality,
    /// Form in which the scan is drawn.
    pub form: CloudForm,
    /// True if batches that the eye does not see are left out.
    pub cull: bool,
    /// Coordinate bits that are read.
    pub precision: Precision,
}

impl Way {
    /// Hardware points.
    pub const POINT_LIST: Self = Self {
        name: "point-list",
        method: None,
        quality: Quality::Closest,
        form: CloudForm::Flat,
        cull: false,
        precision: Precision::Full,
    };

    /// The way of the 2021 paper: every point, all coordinate bits.
    #[must_use]
    pub fn paper_2021(method: Method) -> Self {
        let quality = method.quality().unwrap_or(Quality::Closest);
        Self { name: method.name(), method: Some(method), quality, ..Self::POINT_LIST }
    }

    /// The way of the 2022 paper: culled, with as many coordinate bits as each batch needs.
    #[must_use]
    pub fn paper_2022(name: &'static str, method: Method, quality: Quality, form: CloudForm) -> Self {
        Self { name, method: Some(method), quality, form, cull: true, precision: Precision::Auto }
    }

    /// Draw options of its frames, where level of detail has the rings and thresholds of `headset`.
    #[must_use]
    pub fn options(&self, headset: &Detail) -> DrawOptions {
        let forced_planes = if self.precision == Precision::Full { ALL_PLANES } else { 0 };
        let plain = Detail { forced_planes, smooth: false, fade: false, fill_reach_px: None, ..*headset };
        // Discs are drawn at their own width only with fill, which is on for that reason although nothing is dilated.
        let discs = Detail { fill_reach_px: Some([1.0; 3]), ..plain };
        DrawOptions {
            quality: self.quality,
            dilate: Dilate::Off,
            background: [0; 3],
            detail: if self.form == CloudForm::Spt { discs } else { plain },
            access: Access::default(),
        }
    }

    /// The technique that draws its frames.
    #[must_use]
    pub fn technique(&self) -> LabTechnique {
        LabTechnique {
            method: self.method.unwrap_or(Method::Prefetch),
            keep_unseen: !self.cull,
            error_px: (self.form == CloudForm::Spt).then_some(DEFAULT_ERROR_PX as f32),
            ..LabTechnique::OWN
        }
    }
}
