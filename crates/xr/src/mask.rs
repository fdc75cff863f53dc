//! What the lenses hide (XR_KHR_visibility_mask): asked for with the first frame and after each change.

use super::runtime::STEREO;
use crate::hidden_area::HiddenArea;
use openxr as xr;

/// Tells when to ask for the mask.
pub(super) struct VisibilityMask {
    is_new: bool,
}

impl Default for VisibilityMask {
    fn default() -> Self {
        Self { is_new: true }
    }
}

impl VisibilityMask {
    /// Takes in that the runtime has another mask, which it says once an eye.
    pub fn changed(&mut self) {
        self.is_new = true;
    }

    /// Both eyes' masks, if they are new. If the runtime fails here, nothing is hidden: the frame looks the same and
    /// takes longer.
    pub fn take_new(&mut self, session: &xr::Session<xr::Vulkan>) -> Option<[HiddenArea; 2]> {
        if !std::mem::take(&mut self.is_new) {
            return None;
        }
        match (hidden_area(session, 0), hidden_area(session, 1)) {
            (Ok(left), Ok(right)) => {
                let num = [&left, &right].map(|area| area.triangles.len());
                tracing::info!("triangles of the eyes' images that the lenses hide: {num:?}");
                Some([left, right])
            }
            (Err(result), _) | (_, Err(result)) => {
                tracing::warn!("the headset does not tell what its lenses hide: {result:?}");
                None
            }
        }
    }
}

fn hidden_area(session: &xr::Session<xr::Vulkan>, eye: u32) -> xr::Result<HiddenArea> {
    let kind = xr::VisibilityMaskTypeKHR::HIDDEN_TRIANGLE_MESH;
    let mesh = session.get_visibility_mask_khr(STEREO, eye, kind)?;
    let vertices: Vec<[f32; 2]> = mesh.vertices.iter().map(|vertex| [vertex.x, vertex.y]).collect();
    Ok(HiddenArea::from_mesh(&vertices, &mesh.indices))
}
