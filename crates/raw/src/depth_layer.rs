//! Depth beside a projection layer (XR_KHR_composition_layer_depth), which the openxr crate has raw only.
//!
//! The frame writes near ÷ w: 1 at the near plane, 0 infinitely far away. In the extension's words: the window depths 0
//! and 1 (minDepth, maxDepth) lie at the distances "infinitely far" (nearZ) and "near" (farZ), in meters; nearZ >
//! farZ says that depth is reversed. The specification allows an infinite nearZ; f32::MAX gives the same depths to
//! the last bit, keeps a runtime's own arithmetic free of ∞ − ∞, and is what runtimes are given most.

use openxr as xr;
use std::marker::PhantomData;
use std::ptr;

/// A depth image as a layer wants it.
pub struct DepthInfo<'a> {
    raw: xr::sys::CompositionLayerDepthInfoKHR,
    /// Keeps the borrow of the swapchain.
    _image: PhantomData<&'a xr::Swapchain<xr::Vulkan>>,
}

impl<'a> DepthInfo<'a> {
    /// The depth of an image that holds `near_m` ÷ w.
    #[must_use]
    pub fn new(image: xr::SwapchainSubImage<'a, xr::Vulkan>, near_m: f32) -> Self {
        let raw = xr::sys::CompositionLayerDepthInfoKHR {
            ty: xr::sys::CompositionLayerDepthInfoKHR::TYPE,
            next: ptr::null(),
            sub_image: image.into_raw(),
            min_depth: 0.0,
            max_depth: 1.0,
            near_z: f32::MAX,
            far_z: near_m,
        };
        Self { raw, _image: PhantomData }
    }

    /// The view, with this depth.
    #[must_use]
    pub fn chain(
        &'a self,
        view: xr::CompositionLayerProjectionView<'a, xr::Vulkan>,
    ) -> xr::CompositionLayerProjectionView<'a, xr::Vulkan> {
        let mut raw = view.into_raw();
        raw.next = ptr::from_ref(&self.raw).cast();
        // SAFETY: what `next` points to lives as long as the view, by the lifetimes above, and so does the swapchain
        // that it names; it is the struct that the extension puts there, and ends the chain.
        unsafe { xr::CompositionLayerProjectionView::from_raw(raw) }
    }
}
