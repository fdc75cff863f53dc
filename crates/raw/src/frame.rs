//! Calls of a frame whose success has several kinds, which the openxr crate takes for one.

use openxr as xr;
use std::ptr;
use std::time::Duration;

/// What became of a frame that was begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begun {
    /// It is the only one.
    Anew,
    /// The frame before it was never ended, and is discarded (XR_FRAME_DISCARDED).
    Discarding,
}

/// Begins a frame (xrBeginFrame). Runtimes may use the device's queue in this call.
///
/// # Errors
/// What the runtime says.
pub fn begin(session: &xr::Session<xr::Vulkan>) -> xr::Result<Begun> {
    // SAFETY: the session is alive, and the call allows a null pointer for what it is told.
    match unsafe { (session.instance().fp().begin_frame)(session.as_raw(), ptr::null()) } {
        xr::sys::Result::FRAME_DISCARDED => Ok(Begun::Discarding),
        result => checked(result).map(|()| Begun::Anew),
    }
}

/// Waits until the compositor has finished reading the oldest acquired image (xrWaitSwapchainImage); false if it has not
/// in this time (XR_TIMEOUT_EXPIRED): the image is to be waited for again, and not to be released before.
///
/// # Errors
/// What the runtime says.
pub fn wait_image(swapchain: &xr::Swapchain<xr::Vulkan>, timeout: Duration) -> xr::Result<bool> {
    let info = xr::sys::SwapchainImageWaitInfo {
        ty: xr::sys::SwapchainImageWaitInfo::TYPE,
        next: ptr::null(),
        timeout: xr::Duration::from_nanos(i64::try_from(timeout.as_nanos()).unwrap_or(i64::MAX)),
    };
    // SAFETY: the swapchain is alive, and so is what the call is told until it returns.
    match unsafe { (swapchain.instance().fp().wait_swapchain_image)(swapchain.as_raw(), &info) } {
        xr::sys::Result::TIMEOUT_EXPIRED => Ok(false),
        result => checked(result).map(|()| true),
    }
}

/// Releases the oldest image that was waited for (xrReleaseSwapchainImage). Runtimes may use the device's queue in this
/// call.
///
/// # Errors
/// What the runtime says; the image is then still to be released.
pub fn release_image(swapchain: &xr::Swapchain<xr::Vulkan>) -> xr::Result<()> {
    // SAFETY: the swapchain is alive, and the call allows a null pointer for what it is told.
    checked(unsafe { (swapchain.instance().fp().release_swapchain_image)(swapchain.as_raw(), ptr::null()) })
}

fn checked(result: xr::sys::Result) -> xr::Result<()> {
    if result.into_raw() < 0 { Err(result) } else { Ok(()) }
}
