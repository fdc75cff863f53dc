//! The eyes' images for the window. They are the images themselves if these outlast the frame and nothing is drawn
//! over them, else copies; overlays go over copies only.

use super::link::{MirrorImages, WalkEnd};
use render::gpu::Gpu;
use render::gpu::stage::ShaderError;
use render::options::Overlay;
use render::{Overlays, Renderer};

/// What the window shows of the frames.
#[derive(Debug)]
pub(super) struct Mirror {
    overlays: Overlays,
    /// Copies, made once they are needed.
    copies: Option<Copies>,
    /// Images that the window has been told of.
    shown: Option<MirrorImages>,
}

/// Textures and their views, left then right.
#[derive(Debug)]
struct Copies {
    textures: [wgpu::Texture; 2],
    views: [wgpu::TextureView; 2],
}

impl Mirror {
    /// A mirror of the images that `renderer` draws.
    ///
    /// # Errors
    /// If a shader of the overlays cannot be used.
    pub fn new(renderer: &Renderer) -> Result<Self, ShaderError> {
        Ok(Self { overlays: Overlays::new(renderer)?, copies: None, shown: None })
    }

    /// The images that the window shows, once there is a frame.
    pub fn shown(&self) -> Option<&MirrorImages> {
        self.shown.as_ref()
    }

    /// Lets go of what the overlay before kept: an overlay that is not drawn must not keep a cloud's memory.
    pub fn overlay_changed(&mut self) {
        self.overlays.release();
    }

    /// Records the mirror's part of a frame; to be called after the renderer has recorded the frame into `images`.
    /// The overlay is drawn over them. `images_last` is true if the images are still there when the window draws.
    #[expect(clippy::too_many_arguments, reason = "what a frame has at hand, used once")]
    pub fn record(
        &mut self,
        gpu: &Gpu,
        link: &WalkEnd,
        renderer: &Renderer,
        encoder: &mut wgpu::CommandEncoder,
        images: &[wgpu::Texture; 2],
        images_last: bool,
        overlay: Overlay,
    ) {
        let drawn = &renderer.targets().drawn_px;
        let drawn_px = [drawn[0], drawn[1]];
        let textures = if images_last && overlay == Overlay::None {
            images.clone()
        } else {
            let copies = self.copies.get_or_insert_with(|| Copies::new(gpu, images));
            copy(encoder, images, &copies.textures, drawn_px);
            self.overlays.record(renderer, encoder, overlay, &copies.views.each_ref());
            copies.textures.clone()
        };
        let shown = MirrorImages { textures, drawn_px };
        if self.shown.as_ref() != Some(&shown) {
            // The window may show the frame before with the new size, but only once, and only on the desktop.
            link.set_mirror(shown.clone());
            self.shown = Some(shown);
        }
    }
}

impl Copies {
    fn new(gpu: &Gpu, images: &[wgpu::Texture; 2]) -> Self {
        let usage = wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC;
        let textures = images
            .each_ref()
            .map(|image| gpu.texture("mirror", [image.width(), image.height()], image.format(), usage));
        let views = textures.each_ref().map(|texture| texture.create_view(&Default::default()));
        Self { textures, views }
    }
}

/// Records copies of the drawn part of each image.
pub(super) fn copy(
    encoder: &mut wgpu::CommandEncoder,
    images: &[wgpu::Texture; 2],
    copies: &[wgpu::Texture; 2],
    drawn_px: [[u32; 2]; 2],
) {
    for ((image, copy), [width, height]) in images.iter().zip(copies).zip(drawn_px) {
        let drawn = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        encoder.copy_texture_to_texture(image.as_image_copy(), copy.as_image_copy(), drawn);
    }
}
