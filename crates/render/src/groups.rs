//! Bind groups of the cloud's chunks and the targets at hand. They are made anew when either changes; buffers are not.

use super::cloud_buffers::{Chunk, CloudBuffers, FILTERED_COLORS};
use super::drawn_part::{Clearing, DrawnPart};
use super::pipelines::{Hqs, Pipelines};
use super::targets::Targets;
use crate::bindings::{EyeSet, GeometrySet, OfBatches, OfChunk, OfClear, OfCloud, OfEye, OfOthers, OfPixels};
use crate::gpu::Gpu;
use crate::gpu::stage::Stage;
use crate::layout::{COUNTERS_STRIDE, CullCounters, Sums};
use crate::options::{Dilate, Quality};
use crate::technique::Technique;

/// A pair of targets that is cleared, and to what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClearedTarget {
    /// Keys: no point is near.
    Keys,
    /// Depths: no point is near.
    Depths,
    /// Ids, which are half as large as the keys in whose buffers they are.
    Ids,
    /// Packed sums, in the buffers of keys: nothing is added up.
    Sums,
    /// Wide sums: nothing is added up.
    WideSums,
    /// None: the counters alone, which are cleared in any case.
    Counters,
}

/// What bind groups are made from.
#[derive(Clone, Copy)]
pub struct Parts<'a> {
    /// The GPU that they are on.
    pub gpu: &'a Gpu,
    /// Buffers that are drawn into.
    pub targets: &'a Targets,
    pub(super) pipelines: &'a Pipelines,
    pub(super) drawn: &'a DrawnPart,
    pub(super) technique: &'a dyn Technique,
    /// Targets that are cleared in `closest` quality.
    pub(super) clears: &'static [ClearedTarget],
    pub(super) cloud: Option<&'a CloudBuffers>,
    pub(super) view: &'a wgpu::Buffer,
    pub(super) counters: &'a wgpu::Buffer,
    pub(super) quality: Quality,
    pub(super) dilate: Dilate,
}

/// Every bind group of the frame.
#[derive(Debug, Default)]
pub(super) struct Groups {
    /// One for each pair of targets to clear, with the number of its 16-byte words.
    pub clear: Vec<(wgpu::BindGroup, u32)>,
    pub lod: Option<wgpu::BindGroup>,
    /// One a chunk, as those of `depth` and `color`.
    pub cull: Vec<wgpu::BindGroup>,
    /// Of `depth` in `hqs` quality; in the other, [`crate::nearest::Nearest`] has its own.
    pub depth: Vec<wgpu::BindGroup>,
    pub color: Vec<wgpu::BindGroup>,
    /// Bind groups of each eye.
    pub eyes: Vec<EyeGroups>,
    /// Clear finished colors and depths, before the first frame that resolves these tiles.
    pub clear_images: Vec<(wgpu::BindGroup, u32)>,
}

/// Bind groups of an eye.
#[derive(Debug)]
pub(super) struct EyeGroups {
    /// Tiles that somebody sees, or whose pixels dilation takes.
    pub num_tiles: u32,
    /// One of `blend`, if gaps stay open in `hqs` quality.
    pub blend: Option<wgpu::BindGroup>,
    /// One of `dilate`, `blend-dilate`, or `show`.
    pub image: Option<wgpu::BindGroup>,
    /// One of the depth image's pass, if there are depth images.
    pub depth: Option<wgpu::BindGroup>,
}

impl<'a> Parts<'a> {
    /// The cloud's chunks, with their numbers.
    fn chunks(&self) -> impl Iterator<Item = (&'a CloudBuffers, &'a Chunk, usize)> + use<'a> {
        self.cloud
            .into_iter()
            .flat_map(|cloud| (0..).zip(&cloud.chunks).map(move |(n, chunk)| (cloud, chunk, n)))
    }

    /// The `hqs` pipelines for the cloud's sums.
    pub(super) fn hqs(&self) -> &'a Hqs {
        hqs(self.pipelines, self.cloud)
    }

    pub(super) fn groups(&self) -> Groups {
        let [depth, color] = match self.quality {
            // `Nearest` has bind groups of its own.
            Quality::Closest => [vec![], vec![]],
            Quality::Hqs => [&self.hqs().depth, &self.hqs().color].map(|stage| self.bind_geometry(stage)),
        };
        Groups {
            clear: self.clear(),
            lod: self.cloud.map(|cloud| self.pipelines.lod.bind(self.gpu, &self.of_cloud(cloud))),
            cull: self.each_chunk(|resources| self.pipelines.cull.bind(self.gpu, &resources)),
            depth,
            color,
            eyes: (0..self.targets.sizes_px.len()).map(|eye| self.eye(eye)).collect(),
            clear_images: vec![
                self.cleared(&self.targets.image_color, &self.drawn.no_colors),
                self.cleared(&self.targets.image_depth, &self.drawn.no_depths),
            ],
        }
    }

    /// The targets that this quality begins with, and how.
    fn clear(&self) -> Vec<(wgpu::BindGroup, u32)> {
        let Targets { keys, depth, wide, .. } = self.targets;
        let DrawnPart { no_keys, no_depth, no_sums, no_wide, nothing, .. } = self.drawn;
        let clears = match (self.quality, self.hqs().sums) {
            (Quality::Closest, _) => self.clears,
            (Quality::Hqs, Sums::Packed) => &[ClearedTarget::Depths, ClearedTarget::Sums],
            (Quality::Hqs, Sums::Protected) => {
                &[ClearedTarget::Depths, ClearedTarget::Sums, ClearedTarget::WideSums]
            }
            (Quality::Hqs, Sums::Wide) => &[ClearedTarget::Depths, ClearedTarget::WideSums],
        };
        let group = |clear: &ClearedTarget| match clear {
            ClearedTarget::Keys => self.cleared(keys, no_keys),
            ClearedTarget::Depths => self.cleared(depth, no_depth),
            ClearedTarget::Ids => self.cleared(keys, no_depth),
            ClearedTarget::Sums => self.cleared(keys, no_sums),
            ClearedTarget::WideSums => self.cleared(wide, no_wide),
            ClearedTarget::Counters => self.cleared(keys, nothing),
        };
        clears.iter().map(group).collect()
    }

    fn cleared(&self, pair: &[wgpu::Buffer; 2], clearing: &Clearing) -> (wgpu::BindGroup, u32) {
        let resources = OfClear {
            clear: clearing.uniform.as_entire_binding(),
            left: pair[0].as_entire_binding(),
            right: pair[1].as_entire_binding(),
            counters: self.counters.as_entire_binding(),
        };
        (self.pipelines.clear.bind(self.gpu, &resources), clearing.num_words.max(1))
    }

    fn of_cloud(&self, cloud: &'a CloudBuffers) -> OfCloud<'a> {
        OfCloud {
            view: self.view.as_entire_binding(),
            nodes: cloud.nodes.as_entire_binding(),
            states: cloud.states.as_entire_binding(),
            counted: cloud.counted.as_entire_binding(),
        }
    }

    fn of_chunk(&self, chunk: &'a Chunk, number: usize) -> OfChunk<'a> {
        let counters = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.counters,
            offset: number as u64 * u64::from(COUNTERS_STRIDE),
            size: std::num::NonZeroU64::new(size_of::<CullCounters>() as u64),
        });
        OfChunk {
            chunk: chunk.chunk.as_entire_binding(),
            batches: chunk.batches.as_entire_binding(),
            visible: chunk.visible.as_entire_binding(),
            counters,
            plane_hi: chunk.planes[0].as_entire_binding(),
            plane_mid: chunk.planes[1].as_entire_binding(),
            plane_lo: chunk.planes[2].as_entire_binding(),
            colors: chunk.colors.as_entire_binding(),
            filtered_colors: chunk.column(FILTERED_COLORS).unwrap_or(&chunk.colors).as_entire_binding(),
        }
    }

    fn of_pixels(&self) -> OfPixels<'a> {
        let Targets { keys, depth, wide, .. } = self.targets;
        let [keys, depth, wide] =
            [keys, depth, wide].map(|pair| pair.each_ref().map(|buffer| buffer.as_entire_binding()));
        let ([keys_left, keys_right], [depth_left, depth_right], [wide_left, wide_right]) =
            (keys, depth, wide);
        OfPixels {
            sums_left: keys_left.clone(),
            sums_right: keys_right.clone(),
            ids_left: keys_left.clone(),
            ids_right: keys_right.clone(),
            keys_left,
            keys_right,
            depth_left,
            depth_right,
            wide_left,
            wide_right,
        }
    }

    /// Tiles of an eye that somebody sees, or whose pixels dilation takes.
    #[must_use]
    pub fn num_tiles(&self, eye: usize) -> u32 {
        self.drawn.eyes[eye].num_tiles
    }

    /// The resources of an eye that the steps of `resolve` may bind.
    #[must_use]
    pub fn of_eye(&self, eye: usize) -> OfEye<'a> {
        let (targets, part) = (self.targets, &self.drawn.eyes[eye]);
        // Where depth is a part of the key, `shade` reads both from there.
        let depth = match self.quality {
            Quality::Closest if self.pipelines.has_keys => &targets.keys[eye],
            _ => &targets.depth[eye],
        };
        OfEye {
            resolve: part.resolve.as_entire_binding(),
            tiles: part.tiles.as_entire_binding(),
            hidden: part.hidden.as_entire_binding(),
            dilate: part.dilate.as_entire_binding(),
            depth: depth.as_entire_binding(),
            ids: targets.keys[eye].as_entire_binding(),
            sums: targets.keys[eye].as_entire_binding(),
            wide: targets.wide[eye].as_entire_binding(),
            surface: targets.surface[eye].as_entire_binding(),
            view: self.view.as_entire_binding(),
            image_color: targets.image_color[eye].as_entire_binding(),
            image_depth: targets.image_depth[eye].as_entire_binding(),
        }
    }

    /// The resources of a chunk, its cloud and the technique, by names of their own.
    fn of_others(&self, cloud: &'a CloudBuffers, chunk: &'a Chunk) -> OfOthers<'a> {
        let columns = chunk.column.iter().chain(&cloud.besides);
        let buffers = columns.map(|(name, buffer)| (*name, buffer.as_entire_binding()));
        OfOthers(buffers.chain(self.technique.resources(self.targets)).collect())
    }

    /// Bind groups of a geometry stage, one a chunk.
    #[must_use]
    pub fn bind_geometry(&self, stage: &Stage<GeometrySet>) -> Vec<wgpu::BindGroup> {
        self.each_chunk(|batches| stage.bind(self.gpu, &(batches, self.of_pixels())))
    }

    /// Has `bind` bind, chunk by chunk, the resources that a pass over batches may use.
    pub fn each_chunk(&self, bind: impl Fn(OfBatches<'a>) -> wgpu::BindGroup) -> Vec<wgpu::BindGroup> {
        let resources = |(cloud, chunk, number): (&'a CloudBuffers, &'a Chunk, usize)| {
            (self.of_cloud(cloud), (self.of_chunk(chunk, number), self.of_others(cloud, chunk)))
        };
        self.chunks().map(resources).map(bind).collect()
    }

    /// Has `bind` bind, chunk by chunk, the resources of an eye that a step of `resolve` may use.
    pub fn each_chunk_of_eye(
        &self,
        eye: usize,
        bind: impl Fn((OfChunk<'a>, OfEye<'a>)) -> wgpu::BindGroup,
    ) -> Vec<wgpu::BindGroup> {
        self.chunks()
            .map(|(_, chunk, number)| bind((self.of_chunk(chunk, number), self.of_eye(eye))))
            .collect()
    }

    fn eye(&self, eye: usize) -> EyeGroups {
        let bind = |stage: &Stage<EyeSet>| stage.bind(self.gpu, &self.of_eye(eye));
        let blends = self.quality == Quality::Hqs && self.dilate == Dilate::Off;
        let image = finishing(self.pipelines, self.cloud, self.quality, self.dilate);
        EyeGroups {
            num_tiles: self.num_tiles(eye),
            blend: self.cloud.filter(|_| blends).map(|_| bind(&self.hqs().blend)),
            image: self.cloud.map(|_| bind(image)),
            depth: self.pipelines.depth_image.as_ref().map(|pass| pass.bind(self.gpu, &self.of_eye(eye))),
        }
    }
}

/// The `hqs` pipelines for a cloud's sums: the packed form where it is enough.
pub(super) fn hqs<'a>(pipelines: &'a Pipelines, cloud: Option<&CloudBuffers>) -> &'a Hqs {
    let is_crowded = cloud.is_none_or(|cloud| cloud.is_crowded);
    // The leanest form comes first, the safest last, and there is at least one.
    &pipelines.hqs[if is_crowded { pipelines.hqs.len() - 1 } else { 0 }]
}

/// The step that makes an eye's finished pixels.
pub(super) fn finishing<'a>(
    pipelines: &'a Pipelines,
    cloud: Option<&CloudBuffers>,
    quality: Quality,
    dilate: Dilate,
) -> &'a Stage<EyeSet> {
    match (dilate, quality) {
        (Dilate::Off, _) => &pipelines.show,
        (Dilate::Rings, Quality::Closest) => &pipelines.dilate,
        (Dilate::Rings, Quality::Hqs) => &hqs(pipelines, cloud).blend_dilate,
    }
}
