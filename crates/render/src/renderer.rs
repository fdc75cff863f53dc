//! The renderer: its state from one frame to the next, and how that may change in between.

use super::cloud_buffers::{Chunk, CloudBuffers};
use super::drawn_part::DrawnPart;
use super::groups::{self, Groups, Parts};
use super::pipelines::{PipelineOptions, Pipelines};
use super::targets::{TargetTooLarge, Targets};
use crate::draw_options::DrawOptions;
use crate::gpu::readback::{self, ReadbackError};
use crate::gpu::stage::ShaderError;
use crate::gpu::timer::Timer;
use crate::gpu::{Atomics, Gpu};
use crate::layout::{COUNTERS_STRIDE, Pixel, Sums, ViewUniform, of_image};
use crate::nearest::{Nearest, Recording};
use crate::options::Quality;
use crate::scenery::{Scenery, Surround};
use crate::technique::{Own, Technique};
use base::space::Split;
use std::sync::Arc;
use timing::STAGES;

/// Chunks for which there are counters from the start; few clouds have more.
const NUM_COUNTERS: u64 = 16;

/// What a renderer draws to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setup {
    /// Width, height of each eye's image; one or two.
    pub sizes_px: Vec<[u32; 2]>,
    /// Format of the images, sRGB.
    pub color_format: wgpu::TextureFormat,
    /// Format of the depth images, if there are any.
    pub depth_format: Option<wgpu::TextureFormat>,
    /// The tier; see [`super::tier`].
    pub atomics: Atomics,
}

/// Draws frames of one or two eyes. Create once, give it a cloud, then for every frame: [`Renderer::record`],
/// [`Renderer::set_view`] as late as possible, submit, [`Renderer::submitted`].
#[derive(Debug)]
pub struct Renderer {
    pub(super) gpu: Arc<Gpu>,
    pub(super) setup: Setup,
    pub(super) options: DrawOptions,
    /// Factor on the thresholds of level of detail.
    pub(super) lod_scale: f32,
    pub(super) pipelines: Pipelines,
    pub(super) view: wgpu::Buffer,
    pub(super) cloud: Option<CloudBuffers>,
    pub(super) counters: wgpu::Buffer,
    pub(super) targets: Targets,
    pub(super) technique: Box<dyn Technique>,
    /// The way to the nearest points in `closest` quality: the technique's, if it has one, else the frame's.
    pub(super) nearest: Box<dyn Nearest>,
    /// Bits of the pixels that the lenses hide, an eye each.
    hidden: Vec<Vec<u32>>,
    /// What is seen beside the scan, if anything is.
    pub(super) scenery: Option<Scenery>,
    drawn: DrawnPart,
    pub(super) groups: Groups,
    /// True if the finished pixels are of another drawn part or cloud than the next frame's.
    pub(super) images_are_new: bool,
    /// See [`Self::binding`].
    binding: u64,
    pub(super) timer: Timer,
}

/// Why a renderer cannot be made, or cannot draw what it is told to.
#[derive(Debug, thiserror::Error)]
pub enum RendererError {
    /// The device has no room for its targets.
    #[error(transparent)]
    Target(#[from] TargetTooLarge),
    /// A shader binds what nobody has.
    #[error(transparent)]
    Shader(#[from] ShaderError),
}

impl Renderer {
    /// A renderer without a cloud.
    ///
    /// # Errors
    /// If the sizes do not fit the device, or a shader cannot be used.
    pub fn new(gpu: &Arc<Gpu>, setup: Setup, options: DrawOptions) -> Result<Self, RendererError> {
        Self::with_technique(gpu, setup, options, Box::new(Own))
    }

    /// A renderer that draws by another technique than the frame's own.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn with_technique(
        gpu: &Arc<Gpu>,
        setup: Setup,
        options: DrawOptions,
        technique: Box<dyn Technique>,
    ) -> Result<Self, RendererError> {
        let (pipelines, nearest) = Pipelines::new(gpu, &*technique, pipeline_options(&setup, &options))?;
        let view_usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let view = gpu.buffer("view", size_of::<ViewUniform>() as u64, view_usage);
        let has_wide = needs_wide(&pipelines, None, options.quality);
        let targets = Targets::new(gpu, &setup.sizes_px, has_wide)?;
        let drawn = DrawnPart::new(gpu, &targets, &[], (options.background_word(), setup.color_format));
        let counters = counters_buffer(gpu, NUM_COUNTERS);
        let timer = Timer::new(gpu, STAGES.len(), counters.size());
        let mut renderer = Self {
            gpu: Arc::clone(gpu),
            setup,
            options,
            lod_scale: 1.0,
            pipelines,
            view,
            cloud: None,
            counters,
            technique,
            nearest,
            targets,
            hidden: vec![],
            scenery: None,
            drawn,
            groups: Groups::default(),
            images_are_new: true,
            binding: 0,
            timer,
        };
        renderer.rebind();
        Ok(renderer)
    }

    /// Has frames show what is seen beside the scan, from the next one on: walks do, and pictures of a scan do not.
    /// `None`: nothing is seen where no point is.
    ///
    /// # Errors
    /// If its shader cannot be used.
    pub fn show_scenery(&mut self, surround: Option<Surround>) -> Result<(), ShaderError> {
        self.scenery = Some(Scenery::new(&self.gpu, &self.setup, surround)?);
        Ok(())
    }

    /// Sets what frames with scenery show where no point is, from the next one on. It is quick.
    pub fn set_surround(&mut self, surround: Option<Surround>) {
        if let Some(scenery) = &mut self.scenery {
            scenery.set_surround(surround);
        }
    }

    /// Sets the picture of the card that shapes may show.
    pub fn set_card(&mut self, card: Option<&wgpu::Texture>) {
        if let Some(scenery) = &mut self.scenery {
            scenery.set_card(&self.gpu, card);
        }
    }

    /// Shows this cloud from the next frame on, and gives back the one before. It takes no longer for a large cloud
    /// than for a small one: nothing except bind groups is made, and nothing is freed. A technique draws the clouds that have
    /// what its texts bind.
    ///
    /// # Errors
    /// If what the cloud's sums need does not fit the device, or it lacks what the technique's texts bind; then nothing has
    /// changed.
    pub fn set_cloud(&mut self, cloud: CloudBuffers) -> Result<Option<CloudBuffers>, RendererError> {
        self.check_cloud(&cloud)?;
        self.fit_targets(needs_wide(&self.pipelines, Some(&cloud), self.options.quality))?;
        let num_chunks = cloud.chunks.len() as u64;
        if num_chunks * u64::from(COUNTERS_STRIDE) > self.counters.size() {
            // There are more counters than it needs: the same scan's octree may have another chunk.
            self.counters = counters_buffer(&self.gpu, 2 * num_chunks);
            // Frames under way go without times.
            self.timer = Timer::new(&self.gpu, STAGES.len(), self.counters.size());
        }
        let before = self.cloud.replace(cloud);
        self.rebind();
        Ok(before)
    }

    /// Checks that the technique or the cloud has all that the technique's texts bind.
    fn check_cloud(&self, cloud: &CloudBuffers) -> Result<(), ShaderError> {
        let own = self.technique.resources(&self.targets);
        let has = |name: &str| own.iter().any(|(own, _)| *own == name) || cloud.has(name);
        match self.technique.names().into_iter().find(|name| !has(name)) {
            Some(lacking) => Err(ShaderError::lacks(self.technique.texts().name, lacking)),
            None => Ok(()),
        }
    }

    /// Shows nothing from the next frame on, and gives back the cloud.
    pub fn take_cloud(&mut self) -> Option<CloudBuffers> {
        let cloud = self.cloud.take();
        self.rebind();
        cloud
    }

    /// Sets new image sizes, one an eye.
    ///
    /// # Errors
    /// If they do not fit the device.
    pub fn resize(&mut self, sizes_px: &[[u32; 2]]) -> Result<(), RendererError> {
        if self.setup.sizes_px != sizes_px {
            self.targets = Targets::new(&self.gpu, sizes_px, self.targets.has_wide())?;
            self.setup.sizes_px = sizes_px.to_vec();
            self.set_hidden(vec![]);
        }
        Ok(())
    }

    /// Draws only this much of each image, from its top left corner on: no larger than the image. The views'
    /// eyes must have these sizes.
    pub fn set_drawn(&mut self, drawn_px: &[[u32; 2]]) {
        if self.targets.drawn_px != drawn_px {
            self.targets.drawn_px = drawn_px.to_vec();
            self.set_hidden(vec![]);
        }
    }

    /// Sets which pixels of each eye's drawn part nobody sees: a bit a pixel, in rows of
    /// [`crate::layout::mask_words_per_row`].
    pub fn set_hidden(&mut self, hidden: Vec<Vec<u32>>) {
        self.hidden = hidden;
        self.tell_drawn_part();
        self.rebind();
    }

    /// Sets how frames look from the next one on. A change of [`crate::layout::Detail::fill_reach_px`] from or to
    /// `None` compiles pipelines; all else is quick.
    ///
    /// # Errors
    /// If what the quality needs does not fit the device, or a shader cannot be used; then nothing has changed.
    pub fn set_options(&mut self, options: DrawOptions) -> Result<(), RendererError> {
        self.fit_targets(needs_wide(&self.pipelines, self.cloud.as_ref(), options.quality))?;
        if pipeline_options(&self.setup, &options) != pipeline_options(&self.setup, &self.options) {
            (self.pipelines, self.nearest) =
                Pipelines::new(&self.gpu, &*self.technique, pipeline_options(&self.setup, &options))?;
        }
        let is_same_background = options.background == self.options.background;
        self.options = options;
        if !is_same_background {
            self.tell_drawn_part();
        }
        self.rebind();
        Ok(())
    }

    /// Sets what a pixel shows from the next frame on.
    ///
    /// # Errors
    /// See [`Self::set_options`].
    pub fn set_quality(&mut self, quality: Quality) -> Result<(), RendererError> {
        if quality == self.options.quality {
            Ok(())
        } else {
            self.set_options(DrawOptions { quality, ..self.options })
        }
    }

    /// Makes room for four-word sums where there is none.
    fn fit_targets(&mut self, needs_wide: bool) -> Result<(), TargetTooLarge> {
        if needs_wide && !self.targets.has_wide() {
            let targets = Targets::new(&self.gpu, &self.setup.sizes_px, true)?;
            let drawn_px = std::mem::take(&mut self.targets.drawn_px);
            self.targets = Targets { drawn_px, ..targets };
        }
        Ok(())
    }

    /// How frames look.
    #[must_use]
    pub fn options(&self) -> &DrawOptions {
        &self.options
    }

    /// Sets the factor on the thresholds of level of detail, 1 or more.
    pub fn set_lod_scale(&mut self, scale: f32) {
        self.lod_scale = scale;
    }

    /// Points and bytes on the GPU.
    #[must_use]
    pub fn resident(&self) -> (u64, u64) {
        self.cloud.as_ref().map_or((0, 0), |c| (c.num_resident(), c.bytes))
    }

    /// True if level of detail has a say in how much of the cloud is drawn.
    #[must_use]
    pub fn has_detail(&self) -> bool {
        self.cloud.as_ref().is_some_and(|cloud| cloud.has_detail)
    }

    /// How world positions become the shown cloud's pairs of f32.
    #[must_use]
    pub fn split(&self) -> Option<&Split> {
        self.cloud.as_ref().map(|c| &c.split)
    }

    /// The eyes' pixels, for pictures and tests.
    #[must_use]
    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// The finished pixels of an eye's drawn part, row by row: bits of the depth, and the color as the image holds it,
    /// the background where nothing is. For pictures and tests: waits for the GPU.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn read_pixels(&self, eye: usize) -> Result<Vec<Pixel>, ReadbackError> {
        let read = |buffer| -> Result<Vec<u32>, ReadbackError> {
            let words = bytemuck::pod_collect_to_vec(&readback::read_buffer(&self.gpu, buffer)?);
            Ok(of_image(&words, self.targets.drawn_px[eye]))
        };
        let depths = read(&self.targets.image_depth[eye])?;
        let colors = read(&self.targets.image_color[eye])?;
        Ok(depths.into_iter().zip(colors).map(|(depth, color)| [depth, color]).collect())
    }

    /// Batches of a chunk.
    #[must_use]
    pub fn num_batches(&self, chunk: usize) -> u64 {
        self.chunks()[chunk].num_batches.into()
    }

    /// Visible lists of each chunk, the counters and the nodes' states, for tests.
    #[must_use]
    pub fn cull_results(&self) -> (Vec<&wgpu::Buffer>, &wgpu::Buffer, Option<&wgpu::Buffer>) {
        let visible = self.chunks().iter().map(|c| &c.visible).collect();
        (visible, &self.counters, self.cloud.as_ref().map(|c| &c.states))
    }

    pub(super) fn chunks(&self) -> &[Chunk] {
        self.cloud.as_ref().map_or(&[], |c| &c.chunks)
    }

    /// Tells the stages of another drawn part, other hidden pixels or another background.
    fn tell_drawn_part(&mut self) {
        let background = (self.options.background_word(), self.setup.color_format);
        self.drawn = DrawnPart::new(&self.gpu, &self.targets, &self.hidden, background);
    }

    /// Makes every bind group anew; after a change of the cloud, of sizes or of draw options.
    fn rebind(&mut self) {
        let parts = Parts {
            gpu: &self.gpu,
            pipelines: &self.pipelines,
            targets: &self.targets,
            drawn: &self.drawn,
            cloud: self.cloud.as_ref(),
            view: &self.view,
            counters: &self.counters,
            technique: &*self.technique,
            clears: self.nearest.cleared_targets(),
            quality: self.options.quality,
            dilate: self.options.dilate,
        };
        self.groups = parts.groups();
        // In the other quality it lets go of the cloud.
        let cloud = parts.cloud.filter(|_| parts.quality == Quality::Closest);
        self.nearest.bind(&Parts { cloud, ..parts });
        self.images_are_new = true;
        self.rebound();
    }

    /// What a way to the nearest points is told.
    pub(super) fn recording(&self) -> Recording<'_> {
        Recording {
            timer: &self.timer,
            cloud: self.cloud.as_ref(),
            counters: &self.counters,
            targets: &self.targets,
        }
    }

    /// A number that changes whenever bind groups of this renderer's buffers are out of date.
    pub(super) fn binding(&self) -> u64 {
        self.binding
    }

    pub(super) fn rebound(&mut self) {
        self.binding += 1;
    }
}

fn pipeline_options(setup: &Setup, options: &DrawOptions) -> PipelineOptions {
    PipelineOptions {
        num_eyes: setup.sizes_px.len() as u32,
        fill: options.detail.fill_reach_px.is_some(),
        atomics: setup.atomics,
        access: options.access,
        depth_format: setup.depth_format,
    }
}

/// True if a frame of this cloud and quality adds up in four u32.
fn needs_wide(pipelines: &Pipelines, cloud: Option<&CloudBuffers>, quality: Quality) -> bool {
    quality == Quality::Hqs && groups::hqs(pipelines, cloud).sums != Sums::Packed
}

fn counters_buffer(gpu: &Gpu, num_chunks: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_SRC;
    gpu.buffer("counters", num_chunks * u64::from(COUNTERS_STRIDE), usage)
}
