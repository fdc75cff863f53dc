//! Views of the headset's few images, each made once.

/// Views of all images so far.
#[derive(Debug, Default)]
pub(super) struct Views(Vec<(wgpu::Texture, wgpu::TextureView)>);

impl Views {
    /// The view of an image.
    pub fn of(&mut self, image: &wgpu::Texture) -> wgpu::TextureView {
        if let Some((_, view)) = self.0.iter().find(|(texture, _)| texture == image) {
            return view.clone();
        }
        let view = image.create_view(&wgpu::TextureViewDescriptor::default());
        self.0.push((image.clone(), view.clone()));
        view
    }
}
