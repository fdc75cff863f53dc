//! An OpenXR API layer for tests: it stands between the loader and the runtime, makes things go wrong, and tells what
//! passes.
//!
//! `XRFAULT=WHAT:N:M` chooses what happens after N calls of xrEndFrame, for M calls (30 and 1 if left out); commas stand
//! between several:
//! - the name of a fault in [`plan::FAILURES`]: a call fails, without being made;
//! - `discard`: xrBeginFrame says that it discards a frame;
//! - `exit`: the runtime ends the session (as if the user had closed it in the headset's menu);
//! - `losspending`, `exiting`: an event of that state;
//! - `instloss`: an event that the instance will be lost;
//! - `norender`: xrWaitFrame says that nobody would see the frame;
//! - `hang`: xrWaitFrame does not return; `hangbegin`: xrBeginFrame does not;
//! - `devicelost`: the GPU is lost, where the library is a Vulkan layer too ([`gpu`]);
//! - `watch`: one xrEndFrame's views are written to stderr (see [`tell_views`]);
//! - `badpose`: xrLocateViews says that a place without end is valid, as a runtime does that hands out memory that it
//!   never wrote;
//! - `newmask`: an event that an eye's visibility mask has changed;
//! - `random:SEED:EVERY`: one of these after another, chosen at random, each time that EVERY frames have passed;
//!
//! If `XRFAULT_WAITS` is set, frames are counted from the time at which there is a file `fault` in the folder `XR_RUN`;
//!
//! and without waiting for frames:
//! - `noheadset`: xrGetSystem finds none;
//! - `nosession`: xrCreateSession fails with ERROR_LIMIT_REACHED;
//! - `noimages`: the second xrCreateSwapchain fails with ERROR_OUT_OF_MEMORY;
//! - `bigsizes`: images of 3840 × 3744 pixels are recommended; `hugesizes`: of 20 000 × 20 000;
//! - `period:N`: xrWaitFrame predicts a display period of N microseconds;
//! - `nodepth`: xrCreateSwapchain fails for images of depth, with ERROR_FEATURE_UNSUPPORTED;
//! - `nomask`: xrGetVisibilityMaskKHR fails with ERROR_RUNTIME_FAILURE;
//! - `gaze`: the action space that belongs to no hand is active, turned by [`actions::GAZE_TURN`] in any base space;
//! - `nogaze`: it is active, and xrLocateSpace fails for it with ERROR_RUNTIME_FAILURE;
//! - `bare`: the poses of both hands' controllers are not active;
//! - `no-NAME`: no kind of controller is known whose path ends with this name.
//!
//! Besides, it tells on stderr of an image that is released before a wait for it has come to its end, of suggested
//! bindings, and of vibrations. The layer serves one instance and one session at a time, and others after them.

mod actions;
mod gpu;
mod plan;

use actions::{
    apply_haptic_feedback, create_action_space, get_action_state_pose, locate_hand_joints, locate_space,
    suggest_bindings,
};
use openxr_sys as xr;
use plan::{count_frame, failure, fires, hang, number, planned};
use std::collections::HashSet;
use std::ffi::{CStr, c_char};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{LazyLock, Mutex};
use xr::{Handle as _, pfn};

/// The next layer's or the runtime's xrGetInstanceProcAddr.
static NEXT: Mutex<Option<pfn::GetInstanceProcAddr>> = Mutex::new(None);
/// Swapchains with an image that was waited for.
static WAITED: LazyLock<Mutex<HashSet<u64>>> = LazyLock::new(Mutex::default);
static INSTANCE: AtomicU64 = AtomicU64::new(0);
static SESSION: AtomicU64 = AtomicU64::new(0);

/// The function `name` of the layer below.
///
/// # Safety
/// `F` must be the function's type.
unsafe fn next<F: Copy>(name: &CStr) -> F {
    let get = NEXT.lock().expect("no panic").expect("the layer was asked before it was created");
    let mut function = None;
    unsafe {
        get(xr::Instance::from_raw(INSTANCE.load(Ordering::SeqCst)), name.as_ptr(), &mut function);
        let function = function.expect("the layer below has every core function");
        std::mem::transmute_copy(&function)
    }
}

unsafe extern "system" fn get_system(
    instance: xr::Instance,
    info: *const xr::SystemGetInfo,
    system: *mut xr::SystemId,
) -> xr::Result {
    if planned("noheadset") {
        return xr::Result::ERROR_FORM_FACTOR_UNAVAILABLE;
    }
    unsafe { next::<pfn::GetSystem>(c"xrGetSystem")(instance, info, system) }
}

unsafe extern "system" fn enumerate_views(
    instance: xr::Instance,
    system: xr::SystemId,
    kind: xr::ViewConfigurationType,
    capacity: u32,
    count: *mut u32,
    views: *mut xr::ViewConfigurationView,
) -> xr::Result {
    let below = unsafe { next::<pfn::EnumerateViewConfigurationViews>(c"xrEnumerateViewConfigurationViews") };
    let result = unsafe { below(instance, system, kind, capacity, count, views) };
    let size = if planned("bigsizes") {
        [3840, 3744]
    } else if planned("hugesizes") {
        [20_000, 20_000]
    } else {
        return result;
    };
    if capacity > 0 && result == xr::Result::SUCCESS {
        for view in unsafe { std::slice::from_raw_parts_mut(views, *count as usize) } {
            [view.recommended_image_rect_width, view.recommended_image_rect_height] = size;
            [view.max_image_rect_width, view.max_image_rect_height] = [32_768; 2];
        }
    }
    result
}

unsafe extern "system" fn create_session(
    instance: xr::Instance,
    info: *const xr::SessionCreateInfo,
    session: *mut xr::Session,
) -> xr::Result {
    if planned("nosession") {
        return xr::Result::ERROR_LIMIT_REACHED;
    }
    unsafe { next::<pfn::CreateSession>(c"xrCreateSession")(instance, info, session) }
}

unsafe extern "system" fn create_swapchain(
    session: xr::Session,
    info: *const xr::SwapchainCreateInfo,
    swapchain: *mut xr::Swapchain,
) -> xr::Result {
    static CREATED: AtomicU64 = AtomicU64::new(0);
    if planned("noimages") && CREATED.fetch_add(1, Ordering::SeqCst) == 1 {
        return xr::Result::ERROR_OUT_OF_MEMORY;
    }
    let is_depth =
        |usage: xr::SwapchainUsageFlags| usage.contains(xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT);
    if planned("nodepth") && is_depth(unsafe { (*info).usage_flags }) {
        return xr::Result::ERROR_FEATURE_UNSUPPORTED;
    }
    unsafe { next::<pfn::CreateSwapchain>(c"xrCreateSwapchain")(session, info, swapchain) }
}

unsafe extern "system" fn get_visibility_mask(
    session: xr::Session,
    views: xr::ViewConfigurationType,
    view: u32,
    kind: xr::VisibilityMaskTypeKHR,
    mask: *mut xr::VisibilityMaskKHR,
) -> xr::Result {
    if planned("nomask") {
        return xr::Result::ERROR_RUNTIME_FAILURE;
    }
    let below = unsafe { next::<pfn::GetVisibilityMaskKHR>(c"xrGetVisibilityMaskKHR") };
    unsafe { below(session, views, view, kind, mask) }
}

/// Writes a line for each view of each projection layer: `view` and the size of its image, and if depth is chained to
/// it `depth`, the size, and minDepth, maxDepth, nearZ, farZ.
///
/// # Safety
/// `info` keeps to the specification.
unsafe fn tell_views(info: &xr::FrameEndInfo) {
    let size = |image: &xr::SwapchainSubImage| {
        let xr::Extent2Di { width, height } = image.image_rect.extent;
        format!("{width}x{height}")
    };
    for layer in unsafe { std::slice::from_raw_parts(info.layers, info.layer_count as usize) } {
        if unsafe { (**layer).ty } != xr::CompositionLayerProjection::TYPE {
            continue;
        }
        let layer = unsafe { &*layer.cast::<xr::CompositionLayerProjection>() };
        for view in unsafe { std::slice::from_raw_parts(layer.views, layer.view_count as usize) } {
            let mut line = format!("faultlayer: view {}", size(&view.sub_image));
            let depth = view.next.cast::<xr::CompositionLayerDepthInfoKHR>();
            // All chained structs begin with their type.
            if !depth.is_null() && unsafe { (*depth).ty } == xr::CompositionLayerDepthInfoKHR::TYPE {
                let d = unsafe { &*depth };
                let size = size(&d.sub_image);
                line += &format!(" depth {size} {} {} {:e} {}", d.min_depth, d.max_depth, d.near_z, d.far_z);
            }
            eprintln!("{line}");
        }
    }
}

unsafe extern "system" fn wait_frame(
    session: xr::Session,
    info: *const xr::FrameWaitInfo,
    state: *mut xr::FrameState,
) -> xr::Result {
    if let Some(result) = failure("xrWaitFrame") {
        return result;
    }
    hang("hang");
    let result = unsafe { next::<pfn::WaitFrame>(c"xrWaitFrame")(session, info, state) };
    if result == xr::Result::SUCCESS && fires("norender") {
        unsafe { (*state).should_render = xr::FALSE };
    }
    if let Some(us) = number("period") {
        unsafe { (*state).predicted_display_period = xr::Duration::from_nanos(us as i64 * 1000) };
    }
    result
}

unsafe extern "system" fn begin_frame(session: xr::Session, info: *const xr::FrameBeginInfo) -> xr::Result {
    if let Some(result) = failure("xrBeginFrame") {
        return result;
    }
    hang("hangbegin");
    let result = unsafe { next::<pfn::BeginFrame>(c"xrBeginFrame")(session, info) };
    if result == xr::Result::SUCCESS && fires("discard") { xr::Result::FRAME_DISCARDED } else { result }
}

unsafe extern "system" fn acquire_image(
    swapchain: xr::Swapchain,
    info: *const xr::SwapchainImageAcquireInfo,
    index: *mut u32,
) -> xr::Result {
    if let Some(result) = failure("xrAcquireSwapchainImage") {
        return result;
    }
    unsafe { next::<pfn::AcquireSwapchainImage>(c"xrAcquireSwapchainImage")(swapchain, info, index) }
}

unsafe extern "system" fn wait_image(
    swapchain: xr::Swapchain,
    info: *const xr::SwapchainImageWaitInfo,
) -> xr::Result {
    if let Some(result) = failure("xrWaitSwapchainImage") {
        return result;
    }
    let result = unsafe { next::<pfn::WaitSwapchainImage>(c"xrWaitSwapchainImage")(swapchain, info) };
    if result == xr::Result::SUCCESS {
        WAITED.lock().expect("no panic").insert(swapchain.into_raw());
    }
    result
}

unsafe extern "system" fn release_image(
    swapchain: xr::Swapchain,
    info: *const xr::SwapchainImageReleaseInfo,
) -> xr::Result {
    if let Some(result) = failure("xrReleaseSwapchainImage") {
        return result;
    }
    if !WAITED.lock().expect("no panic").remove(&swapchain.into_raw()) {
        eprintln!("faultlayer: an image is released that was not waited for");
    }
    unsafe { next::<pfn::ReleaseSwapchainImage>(c"xrReleaseSwapchainImage")(swapchain, info) }
}

unsafe extern "system" fn locate_views(
    session: xr::Session,
    info: *const xr::ViewLocateInfo,
    state: *mut xr::ViewState,
    capacity: u32,
    count: *mut u32,
    views: *mut xr::View,
) -> xr::Result {
    if let Some(result) = failure("xrLocateViews") {
        return result;
    }
    let below = unsafe { next::<pfn::LocateViews>(c"xrLocateViews") };
    let result = unsafe { below(session, info, state, capacity, count, views) };
    if result == xr::Result::SUCCESS && capacity > 0 && fires("badpose") {
        unsafe { (*views).pose.position.x = 6e23 };
    }
    result
}

unsafe extern "system" fn sync_actions(session: xr::Session, info: *const xr::ActionsSyncInfo) -> xr::Result {
    if let Some(result) = failure("xrSyncActions") {
        return result;
    }
    unsafe { next::<pfn::SyncActions>(c"xrSyncActions")(session, info) }
}

unsafe extern "system" fn end_frame(session: xr::Session, info: *const xr::FrameEndInfo) -> xr::Result {
    SESSION.store(session.into_raw(), Ordering::SeqCst);
    if let Some(result) = failure("xrEndFrame") {
        return result;
    }
    // A frame without an image is not watched.
    if unsafe { (*info).layer_count } > 0 && fires("watch") {
        unsafe { tell_views(&*info) };
    }
    let result = unsafe { next::<pfn::EndFrame>(c"xrEndFrame")(session, info) };
    count_frame();
    if fires("exit") {
        unsafe { next::<pfn::RequestExitSession>(c"xrRequestExitSession")(session) };
    }
    result
}

unsafe extern "system" fn poll_event(instance: xr::Instance, event: *mut xr::EventDataBuffer) -> xr::Result {
    let states = [("losspending", xr::SessionState::LOSS_PENDING), ("exiting", xr::SessionState::EXITING)];
    if let Some((_, state)) = states.into_iter().find(|(what, _)| fires(what)) {
        let lost = xr::EventDataSessionStateChanged {
            ty: xr::EventDataSessionStateChanged::TYPE,
            next: std::ptr::null(),
            session: xr::Session::from_raw(SESSION.load(Ordering::SeqCst)),
            state,
            time: xr::Time::from_nanos(1),
        };
        unsafe { event.cast::<xr::EventDataSessionStateChanged>().write(lost) };
        return xr::Result::SUCCESS;
    }
    if fires("instloss") {
        let lost = xr::EventDataInstanceLossPending {
            ty: xr::EventDataInstanceLossPending::TYPE,
            next: std::ptr::null(),
            loss_time: xr::Time::from_nanos(1),
        };
        unsafe { event.cast::<xr::EventDataInstanceLossPending>().write(lost) };
        return xr::Result::SUCCESS;
    }
    if fires("newmask") {
        let changed = xr::EventDataVisibilityMaskChangedKHR {
            ty: xr::EventDataVisibilityMaskChangedKHR::TYPE,
            next: std::ptr::null(),
            session: xr::Session::from_raw(SESSION.load(Ordering::SeqCst)),
            view_configuration_type: xr::ViewConfigurationType::PRIMARY_STEREO,
            view_index: 1,
        };
        unsafe { event.cast::<xr::EventDataVisibilityMaskChangedKHR>().write(changed) };
        return xr::Result::SUCCESS;
    }
    unsafe { next::<pfn::PollEvent>(c"xrPollEvent")(instance, event) }
}

unsafe extern "system" fn get_instance_proc_addr(
    instance: xr::Instance,
    name: *const c_char,
    function: *mut Option<pfn::VoidFunction>,
) -> xr::Result {
    let wanted = unsafe { CStr::from_ptr(name) };
    // SAFETY of the casts: OpenXR hands every function out as this one type.
    let ours: Option<pfn::VoidFunction> = unsafe {
        use std::mem::transmute;
        match wanted.to_bytes() {
            b"xrGetSystem" => Some(transmute::<pfn::GetSystem, pfn::VoidFunction>(get_system)),
            b"xrCreateSession" => Some(transmute::<pfn::CreateSession, pfn::VoidFunction>(create_session)),
            b"xrEnumerateViewConfigurationViews" => {
                Some(transmute::<pfn::EnumerateViewConfigurationViews, pfn::VoidFunction>(enumerate_views))
            }
            b"xrCreateSwapchain" => {
                Some(transmute::<pfn::CreateSwapchain, pfn::VoidFunction>(create_swapchain))
            }
            b"xrGetVisibilityMaskKHR" => {
                Some(transmute::<pfn::GetVisibilityMaskKHR, pfn::VoidFunction>(get_visibility_mask))
            }
            b"xrCreateActionSpace" => {
                Some(transmute::<pfn::CreateActionSpace, pfn::VoidFunction>(create_action_space))
            }
            b"xrGetActionStatePose" => {
                Some(transmute::<pfn::GetActionStatePose, pfn::VoidFunction>(get_action_state_pose))
            }
            b"xrSuggestInteractionProfileBindings" => {
                Some(transmute::<pfn::SuggestInteractionProfileBindings, pfn::VoidFunction>(suggest_bindings))
            }
            b"xrApplyHapticFeedback" => {
                Some(transmute::<pfn::ApplyHapticFeedback, pfn::VoidFunction>(apply_haptic_feedback))
            }
            b"xrLocateHandJointsEXT" => {
                Some(transmute::<pfn::LocateHandJointsEXT, pfn::VoidFunction>(locate_hand_joints))
            }
            b"xrLocateSpace" => Some(transmute::<pfn::LocateSpace, pfn::VoidFunction>(locate_space)),
            b"xrWaitFrame" => Some(transmute::<pfn::WaitFrame, pfn::VoidFunction>(wait_frame)),
            b"xrBeginFrame" => Some(transmute::<pfn::BeginFrame, pfn::VoidFunction>(begin_frame)),
            b"xrAcquireSwapchainImage" => {
                Some(transmute::<pfn::AcquireSwapchainImage, pfn::VoidFunction>(acquire_image))
            }
            b"xrWaitSwapchainImage" => {
                Some(transmute::<pfn::WaitSwapchainImage, pfn::VoidFunction>(wait_image))
            }
            b"xrReleaseSwapchainImage" => {
                Some(transmute::<pfn::ReleaseSwapchainImage, pfn::VoidFunction>(release_image))
            }
            b"xrLocateViews" => Some(transmute::<pfn::LocateViews, pfn::VoidFunction>(locate_views)),
            b"xrSyncActions" => Some(transmute::<pfn::SyncActions, pfn::VoidFunction>(sync_actions)),
            b"xrEndFrame" => Some(transmute::<pfn::EndFrame, pfn::VoidFunction>(end_frame)),
            b"xrPollEvent" => Some(transmute::<pfn::PollEvent, pfn::VoidFunction>(poll_event)),
            _ => None,
        }
    };
    if ours.is_some() {
        unsafe { *function = ours };
        return xr::Result::SUCCESS;
    }
    let next = *NEXT.lock().expect("no panic");
    match next {
        Some(get) => unsafe { get(instance, name, function) },
        None => xr::Result::ERROR_FUNCTION_UNSUPPORTED,
    }
}

unsafe extern "system" fn create_instance(
    info: *const xr::InstanceCreateInfo,
    layer: *const xr::ApiLayerCreateInfo,
    instance: *mut xr::Instance,
) -> xr::Result {
    unsafe {
        let below = &*(*layer).next_info;
        let (Some(get), Some(create)) =
            (below.next_get_instance_proc_addr, below.next_create_api_layer_instance)
        else {
            return xr::Result::ERROR_INITIALIZATION_FAILED;
        };
        *NEXT.lock().expect("no panic") = Some(get);
        let mut layer_below = *layer;
        layer_below.next_info = below.next;
        let result = create(info, &layer_below, instance);
        if result.into_raw() >= 0 {
            INSTANCE.store((*instance).into_raw(), Ordering::SeqCst);
        }
        result
    }
}

/// The loader's first call.
///
/// # Safety
/// Called by an OpenXR loader.
#[unsafe(no_mangle)]
#[allow(non_snake_case)]
pub unsafe extern "system" fn xrNegotiateLoaderApiLayerInterface(
    loader: *const xr::NegotiateLoaderInfo,
    _name: *const c_char,
    request: *mut xr::NegotiateApiLayerRequest,
) -> xr::Result {
    unsafe {
        (*request).layer_interface_version = 1;
        (*request).layer_api_version = xr::Version::new(1, 0, 0).max((*loader).min_api_version);
        (*request).get_instance_proc_addr = Some(get_instance_proc_addr);
        (*request).create_api_layer_instance = Some(create_instance);
    }
    xr::Result::SUCCESS
}
