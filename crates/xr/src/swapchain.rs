//! The eyes' images: a swapchain of color an eye, and one of depth where the runtime takes it, wrapped as wgpu
//! textures; and the picture of a panel, which is one more.
//!
//! Two things that no validation layer notices are made impossible here. The runtime's queue use in
//! xrAcquireSwapchainImage and xrReleaseSwapchainImage needs the queue's guard. And an image can only be
//! released through [`ClosedFrame`], which has it in the layout that the runtime expects, whatever the frame last did
//! with it.

use crate::EyeImages;
use ash::vk;
use openxr as xr;
use raw::image::ImageKind;
use render::IMAGE_USAGES;
use render::gpu::{Gpu, Queue, QueueGuard};
use std::time::Duration;

/// 8-bit sRGB formats, best first: OpenXR's (Vulkan's) number and wgpu's name.
const COLOR_FORMATS: [(vk::Format, wgpu::TextureFormat); 2] = [
    (vk::Format::R8G8B8A8_SRGB, wgpu::TextureFormat::Rgba8UnormSrgb),
    (vk::Format::B8G8R8A8_SRGB, wgpu::TextureFormat::Bgra8UnormSrgb),
];

/// Depth formats, best first: a float is fine far away too, where reversed depth is close to 0. Those with a
/// stencil would only waste memory, and wgpu's `Depth24Plus` is not the same Vulkan format on every driver.
const DEPTH_FORMATS: [(vk::Format, wgpu::TextureFormat); 2] = [
    (vk::Format::D32_SFLOAT, wgpu::TextureFormat::Depth32Float),
    (vk::Format::D16_UNORM, wgpu::TextureFormat::Depth16Unorm),
];

/// An image format that the runtime and wgpu both know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ImageFormat {
    vulkan: vk::Format,
    pub wgpu: wgpu::TextureFormat,
}

impl ImageFormat {
    /// The best of the formats that the runtime offers; `None` if it has no 8-bit sRGB.
    pub fn color(offered: &[u32]) -> Option<Self> {
        Self::choose(&COLOR_FORMATS, offered)
    }

    /// The best of the depth formats that the runtime offers, if there is one that wgpu knows.
    pub fn depth(offered: &[u32]) -> Option<Self> {
        Self::choose(&DEPTH_FORMATS, offered)
    }

    fn choose(known: &[(vk::Format, wgpu::TextureFormat)], offered: &[u32]) -> Option<Self> {
        let is_offered = |format: vk::Format| offered.iter().any(|&raw| raw as i32 == format.as_raw());
        let &(vulkan, wgpu) = known.iter().find(|&&(vulkan, _)| is_offered(vulkan))?;
        Some(Self { vulkan, wgpu })
    }

    fn is_depth(self) -> bool {
        self.wgpu.has_depth_aspect()
    }

    /// The kind of image that the swapchain is created with.
    fn image_kind(self, size_px: [u32; 2]) -> ImageKind {
        let (uses, usages) = if self.is_depth() {
            (
                wgpu::TextureUses::DEPTH_STENCIL_WRITE | wgpu::TextureUses::DEPTH_STENCIL_READ,
                wgpu::TextureUsages::RENDER_ATTACHMENT,
            )
        } else {
            (
                wgpu::TextureUses::COLOR_TARGET
                    | wgpu::TextureUses::RESOURCE
                    | wgpu::TextureUses::COPY_SRC
                    | wgpu::TextureUses::COPY_DST,
                IMAGE_USAGES | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
            )
        };
        ImageKind { size_px, format: self.wgpu, uses, usages, handover: self.handover() }
    }

    /// The use in whose layout runtimes hand images out and expect them back: COLOR_ATTACHMENT_OPTIMAL or
    /// DEPTH_STENCIL_ATTACHMENT_OPTIMAL.
    fn handover(self) -> wgpu::TextureUses {
        if self.is_depth() { wgpu::TextureUses::DEPTH_STENCIL_WRITE } else { wgpu::TextureUses::COLOR_TARGET }
    }
}

/// Both eyes' swapchains, left then right.
pub(super) struct EyeSwapchains {
    color: [LayerSwapchain; 2],
    depth: Option<[LayerSwapchain; 2]>,
}

/// The swapchain of one image of a layer: an eye's color, an eye's depth, or a panel's picture.
pub(super) struct LayerSwapchain {
    /// Images, declared and so dropped before the swapchain that owns their memory.
    images: Vec<wgpu::Texture>,
    swapchain: xr::Swapchain<xr::Vulkan>,
    format: ImageFormat,
    size_px: [u32; 2],
    /// The part that layers show, from the top left corner.
    drawn_px: [u32; 2],
    held: Held,
}

/// The image of a swapchain that is ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Held {
    /// There is none.
    None,
    /// The image with this number, which the compositor may still read.
    Acquired(usize),
    /// The image with this number, to draw into.
    Ready(usize),
}

/// What came of a wish for images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Acquired {
    /// There is one of each swapchain.
    All,
    /// The compositor still reads one. It stays ours, and is waited for again with the next frame.
    TimedOut,
}

/// How long a frame waits for the compositor to finish reading an image: far longer than any display period, short
/// enough for a user who wants to leave.
const IMAGE_PATIENCE: Duration = Duration::from_millis(500);

/// A frame's commands, ending with all images in the layout that the runtime expects.
pub(super) struct ClosedFrame(wgpu::CommandBuffer);

impl EyeSwapchains {
    /// Creates both eyes' swapchains, at `sizes_px`, without depth.
    ///
    /// # Errors
    /// What the runtime says.
    pub fn new(
        session: &xr::Session<xr::Vulkan>,
        gpu: &Gpu,
        format: ImageFormat,
        sizes_px: [[u32; 2]; 2],
    ) -> xr::Result<Self> {
        let left = LayerSwapchain::new(session, gpu, format, sizes_px[0], "left eye")?;
        let right = LayerSwapchain::new(session, gpu, format, sizes_px[1], "right eye")?;
        Ok(Self { color: [left, right], depth: None })
    }

    /// Adds depth images of the same sizes.
    ///
    /// # Errors
    /// What the runtime says; all is then as before.
    pub fn add_depth(
        &mut self,
        session: &xr::Session<xr::Vulkan>,
        gpu: &Gpu,
        format: ImageFormat,
    ) -> xr::Result<()> {
        let [left_px, right_px] = self.sizes_px();
        let left = LayerSwapchain::new(session, gpu, format, left_px, "left eye's depth")?;
        let right = LayerSwapchain::new(session, gpu, format, right_px, "right eye's depth")?;
        self.depth = Some([left, right]);
        Ok(())
    }

    /// Width, height of each eye's image.
    pub fn sizes_px(&self) -> [[u32; 2]; 2] {
        [self.color[0].size_px, self.color[1].size_px]
    }

    /// Has layers show only this many pixels of each image from now on, from the top left corner.
    pub fn set_drawn_px(&mut self, drawn_px: [[u32; 2]; 2]) {
        for (eye, drawn_px) in self.all_mut().zip([drawn_px, drawn_px].concat()) {
            // Runtimes refuse a frame that reaches beyond the image.
            eye.drawn_px = [0, 1].map(|axis: usize| drawn_px[axis].clamp(1, eye.size_px[axis]));
        }
    }

    /// Format of the depth images, if there are any.
    pub fn depth_format(&self) -> Option<wgpu::TextureFormat> {
        self.depth.as_ref().map(|[left, _]| left.format.wgpu)
    }

    fn all(&self) -> impl Iterator<Item = &LayerSwapchain> {
        self.color.iter().chain(self.depth.iter().flatten())
    }

    fn all_mut(&mut self) -> impl Iterator<Item = &mut LayerSwapchain> {
        self.color.iter_mut().chain(self.depth.iter_mut().flatten())
    }

    /// Acquires an image of each swapchain, unless it holds one of a frame that came to nothing, and waits until the
    /// compositor has finished reading it; the lock is not held during the wait.
    ///
    /// # Errors
    /// What the runtime says. Images that are ours by then stay so.
    pub fn acquire(&mut self, queue: &Queue) -> xr::Result<Acquired> {
        let guard = queue.lock();
        for eye in self.all_mut() {
            eye.acquire(&guard)?;
        }
        drop(guard);
        for eye in self.all_mut() {
            if !eye.wait()? {
                return Ok(Acquired::TimedOut);
            }
        }
        Ok(Acquired::All)
    }

    /// The acquired images, to draw into.
    pub fn images(&self) -> EyeImages {
        let of = |eyes: &[LayerSwapchain; 2]| eyes.each_ref().map(|eye| eye.image().clone());
        EyeImages { color: of(&self.color), depth: self.depth.as_ref().map(of) }
    }

    /// Ends a frame's commands.
    pub fn close(&self, mut commands: wgpu::CommandEncoder) -> ClosedFrame {
        let transitions = self.all().map(|eye| wgpu::wgt::TextureTransition {
            texture: eye.image(),
            selector: None,
            state: eye.format.handover(),
        });
        commands.transition_resources(std::iter::empty(), transitions);
        ClosedFrame(commands.finish())
    }

    /// Submits a frame's commands and gives the images to the compositor.
    ///
    /// # Errors
    /// What the runtime says. Images that are not released stay ours, to draw into.
    pub fn release(&mut self, queue: &QueueGuard<'_>, frame: ClosedFrame) -> xr::Result<()> {
        queue.submit([frame.0]);
        for eye in self.all_mut() {
            if let Held::Ready(_) = eye.held {
                raw::frame::release_image(&eye.swapchain)?;
                eye.held = Held::None;
            }
        }
        Ok(())
    }

    /// The drawn part of an eye's image, for a layer.
    pub fn sub_image(&self, eye: usize) -> xr::SwapchainSubImage<'_, xr::Vulkan> {
        self.color[eye].sub_image()
    }

    /// The drawn part of an eye's depth image, if there is one.
    pub fn depth_sub_image(&self, eye: usize) -> Option<xr::SwapchainSubImage<'_, xr::Vulkan>> {
        self.depth.as_ref().map(|eyes| eyes[eye].sub_image())
    }
}

impl LayerSwapchain {
    /// Creates a swapchain.
    ///
    /// # Errors
    /// What the runtime says.
    pub fn new(
        session: &xr::Session<xr::Vulkan>,
        gpu: &Gpu,
        format: ImageFormat,
        size_px: [u32; 2],
        name: &str,
    ) -> xr::Result<Self> {
        let mut swapchain = session.create_swapchain(&xr::SwapchainCreateInfo {
            create_flags: xr::SwapchainCreateFlags::EMPTY,
            usage_flags: if format.is_depth() {
                xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT
            } else {
                xr::SwapchainUsageFlags::COLOR_ATTACHMENT
                    | xr::SwapchainUsageFlags::SAMPLED
                    | xr::SwapchainUsageFlags::TRANSFER_SRC
                    | xr::SwapchainUsageFlags::TRANSFER_DST
            },
            format: format.vulkan.as_raw() as u32,
            sample_count: 1,
            width: size_px[0],
            height: size_px[1],
            face_count: 1,
            array_size: 1,
            mip_count: 1,
        })?;
        // The name only helps debuggers: a runtime that refuses it is none the worse.
        let _ = swapchain.set_name(name);
        let images = raw::image::textures(&gpu.device, &swapchain, format.image_kind(size_px), name)?;
        Ok(Self { images, swapchain, format, size_px, drawn_px: size_px, held: Held::None })
    }

    /// Acquires an image, unless one is held.
    ///
    /// # Errors
    /// What the runtime says.
    pub fn acquire(&mut self, _queue: &QueueGuard<'_>) -> xr::Result<()> {
        if self.held == Held::None {
            self.held = Held::Acquired(self.swapchain.acquire_image()? as usize);
        }
        Ok(())
    }

    /// Waits until the image can be drawn into; false if that takes too long.
    ///
    /// # Errors
    /// What the runtime says.
    pub fn wait(&mut self) -> xr::Result<bool> {
        if let Held::Acquired(image) = self.held
            && raw::frame::wait_image(&self.swapchain, IMAGE_PATIENCE)?
        {
            self.held = Held::Ready(image);
        }
        Ok(matches!(self.held, Held::Ready(_)))
    }

    /// The image to draw into, or the first if there is none.
    fn image(&self) -> &wgpu::Texture {
        match self.held {
            Held::None => &self.images[0],
            Held::Acquired(image) | Held::Ready(image) => &self.images[image],
        }
    }

    /// Copies a picture of the image's size and format into the image that is held, and gives that to the compositor. False if
    /// none is held.
    ///
    /// # Errors
    /// What the runtime says.
    pub fn fill(&mut self, gpu: &Gpu, queue: &QueueGuard<'_>, picture: &wgpu::Texture) -> xr::Result<bool> {
        if !matches!(self.held, Held::Ready(_)) {
            return Ok(false);
        }
        let mut commands =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("panel") });
        commands.copy_texture_to_texture(
            picture.as_image_copy(),
            self.image().as_image_copy(),
            picture.size(),
        );
        let handover = wgpu::wgt::TextureTransition {
            texture: self.image(),
            selector: None,
            state: self.format.handover(),
        };
        commands.transition_resources(std::iter::empty(), std::iter::once(handover));
        queue.submit([commands.finish()]);
        raw::frame::release_image(&self.swapchain)?;
        self.held = Held::None;
        Ok(true)
    }

    /// Width and height of the images.
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// The drawn part of the image that was released last, for a layer.
    pub fn sub_image(&self) -> xr::SwapchainSubImage<'_, xr::Vulkan> {
        let [width, height] = self.drawn_px.map(|size| size as i32);
        let extent = xr::Extent2Di { width, height };
        xr::SwapchainSubImage::new()
            .swapchain(&self.swapchain)
            .image_array_index(0)
            .image_rect(xr::Rect2Di { offset: xr::Offset2Di { x: 0, y: 0 }, extent })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rgba_srgb_is_preferred_and_linear_formats_are_refused() {
        let (rgba, bgra) =
            (vk::Format::R8G8B8A8_SRGB.as_raw() as u32, vk::Format::B8G8R8A8_SRGB.as_raw() as u32);
        let unorm = vk::Format::R8G8B8A8_UNORM.as_raw() as u32;
        let chosen = |offered: &[u32]| ImageFormat::color(offered).map(|format| format.wgpu);
        assert_eq!(chosen(&[unorm, bgra, rgba]), Some(wgpu::TextureFormat::Rgba8UnormSrgb));
        assert_eq!(chosen(&[unorm, bgra]), Some(wgpu::TextureFormat::Bgra8UnormSrgb));
        assert_eq!(chosen(&[unorm]), None);
    }

    #[test]
    fn float_depth_is_preferred_and_stencils_are_refused() {
        let [float, short, stencil] =
            [vk::Format::D32_SFLOAT, vk::Format::D16_UNORM, vk::Format::D24_UNORM_S8_UINT]
                .map(|format| format.as_raw() as u32);
        let chosen = |offered: &[u32]| ImageFormat::depth(offered).map(|format| format.wgpu);
        assert_eq!(chosen(&[stencil, short, float]), Some(wgpu::TextureFormat::Depth32Float));
        assert_eq!(chosen(&[stencil, short]), Some(wgpu::TextureFormat::Depth16Unorm));
        assert_eq!(chosen(&[stencil]), None);
        assert_eq!(ImageFormat::color(&[float, short, stencil]), None);
    }
}
