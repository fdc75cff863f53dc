//! Bind groups: of the cloud's chunks and the targets at hand. Made anew when either changes.

use super::cloud_buffers::{Chunk, CloudBuffers};
use super::pipelines::{Closest, Hqs, Pipelines};
use super::targets::Targets;
use crate::config::{Dilate, Quality};
use crate::gpu::Gpu;
use crate::layout::{
    COUNTERS_STRIDE, ClearUniform, CullCounters, DilateUniform, EMPTY_DEPTH, ResolveUniform, Sums, TILE_PX,
};
use wgpu::util::DeviceExt;

/// What the groups are made from.
#[derive(Clone, Copy)]
pub(super) struct Parts<'a> {
    pub gpu: &'a Gpu,
    pub pipelines: &'a Pipelines,
    pub targets: &'a Targets,
    pub cloud: Option<&'a CloudBuffers>,
    pub view: &'a wgpu::Buffer,
    pub counters: &'a wgpu::Buffer,
    pub quality: Quality,
    pub dilate: Dilate,
    pub background: u32,
    /// Bits of the pixels that the lenses hide, an eye each.
    pub hidden: &'a [Vec<u32>],
}

/// Every bind group of the frame.
#[derive(Debug, Default)]
pub(super) struct Groups {
    /// One for each pair of targets to clear, with the number of its 16-byte words.
    pub clear: Vec<(wgpu::BindGroup, u32)>,
    pub lod: Option<wgpu::BindGroup>,
    /// One a chunk, and so are the next three.
    pub cull: Vec<wgpu::BindGroup>,
    pub depth: Vec<wgpu::BindGroup>,
    pub ids: Vec<wgpu::BindGroup>,
    pub color: Vec<wgpu::BindGroup>,
    /// Of each eye.
    pub eyes: Vec<EyeGroups>,
}

/// Bind groups of an eye.
#[derive(Debug)]
pub(super) struct EyeGroups {
    /// Tiles that somebody sees.
    pub num_tiles: u32,
    /// `shade`, one a chunk, or `blend`, one.
    pub surface: Vec<wgpu::BindGroup>,
    pub dilate: Option<wgpu::BindGroup>,
    pub image: wgpu::BindGroup,
}

/// Named resources.
type Resources<'a> = Vec<(&'static str, wgpu::BindingResource<'a>)>;

impl Parts<'_> {
    fn chunks(&self) -> &[Chunk] {
        self.cloud.map_or(&[], |cloud| &cloud.chunks)
    }

    /// The `hqs` pipelines for the cloud's sums.
    pub fn hqs(&self) -> &Hqs {
        hqs(self.pipelines, self.cloud)
    }

    pub fn groups(&self) -> Groups {
        let mut groups = Groups {
            clear: self.clear(),
            lod: self.cloud.map(|cloud| self.pipelines.lod.bind(self.gpu, &self.of_cloud(cloud))),
            cull: vec![],
            depth: vec![],
            ids: vec![],
            color: vec![],
            eyes: (0..self.targets.sizes_px.len()).map(|eye| self.eye(eye)).collect(),
        };
        for number in 0..self.chunks().len() {
            let resources = self.of_chunk(number);
            groups.cull.push(self.pipelines.cull.bind(self.gpu, &resources));
            match self.quality {
                Quality::Closest => {
                    let Closest { depth, ids, .. } = &self.pipelines.closest;
                    groups.depth.push(depth.bind(self.gpu, &resources));
                    groups.ids.extend(ids.iter().map(|ids| ids.bind(self.gpu, &resources)));
                }
                Quality::Hqs => {
                    groups.depth.push(self.hqs().depth.bind(self.gpu, &resources));
                    groups.color.push(self.hqs().color.bind(self.gpu, &resources));
                }
            }
        }
        groups
    }

    /// The targets that this quality begins with, and with which value.
    fn clear(&self) -> Vec<(wgpu::BindGroup, u32)> {
        let Targets { keys, depth, wide, .. } = self.targets;
        let pairs: Vec<(&[wgpu::Buffer; 2], u64, u32)> = match self.quality {
            Quality::Closest if self.pipelines.closest.ids.is_none() => vec![(keys, 8, EMPTY_DEPTH)],
            Quality::Closest => vec![(depth, 4, EMPTY_DEPTH), (keys, 4, EMPTY_DEPTH)],
            Quality::Hqs => match self.hqs().sums {
                Sums::Packed => vec![(depth, 4, EMPTY_DEPTH), (keys, 8, 0)],
                Sums::Protected => vec![(depth, 4, EMPTY_DEPTH), (keys, 8, 0), (wide, 16, 0)],
                Sums::Wide | Sums::Pairs => vec![(depth, 4, EMPTY_DEPTH), (wide, 16, 0)],
            },
        };
        let group = |(pair, bytes_per_px, value): (&[wgpu::Buffer; 2], u64, u32)| {
            let num_words = [0, 1].map(|eye| self.targets.num_words(eye, bytes_per_px));
            let [num_left, num_right] = num_words;
            let uniform = self.uniform(&ClearUniform { value, num_left, num_right, reserved: 0 });
            let resources = [
                ("clear", uniform.as_entire_binding()),
                ("left", pair[0].as_entire_binding()),
                ("right", pair[1].as_entire_binding()),
                ("counters", self.counters.as_entire_binding()),
            ];
            (self.pipelines.clear.bind(self.gpu, &resources), num_left.max(num_right))
        };
        pairs.into_iter().map(group).collect()
    }

    fn of_cloud<'b>(&'b self, cloud: &'b CloudBuffers) -> Resources<'b> {
        vec![
            ("view", self.view.as_entire_binding()),
            ("nodes", cloud.nodes.as_entire_binding()),
            ("states", cloud.states.as_entire_binding()),
        ]
    }

    /// Everything that `cull`, `depth` and `color` may bind, by the shaders' names.
    fn of_chunk(&self, number: usize) -> Resources<'_> {
        let chunk = &self.chunks()[number];
        let counters = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: self.counters,
            offset: number as u64 * u64::from(COUNTERS_STRIDE),
            size: std::num::NonZeroU64::new(size_of::<CullCounters>() as u64),
        });
        let Targets { keys, depth, wide, .. } = self.targets;
        let mut resources = self.cloud.map_or_else(Vec::new, |cloud| self.of_cloud(cloud));
        resources.extend([
            ("chunk", chunk.chunk.as_entire_binding()),
            ("batches", chunk.batches.as_entire_binding()),
            ("visible", chunk.visible.as_entire_binding()),
            ("counters", counters),
            ("plane_hi", chunk.planes[0].as_entire_binding()),
            ("plane_mid", chunk.planes[1].as_entire_binding()),
            ("plane_lo", chunk.planes[2].as_entire_binding()),
            ("colors", chunk.colors.as_entire_binding()),
            ("filtered_colors", chunk.filtered_colors.as_entire_binding()),
        ]);
        let names: [(&[wgpu::Buffer; 2], [&'static str; 2]); 6] = [
            (keys, ["keys_left", "keys_right"]),
            (keys, ["sums_left", "sums_right"]),
            (keys, ["ids_left", "ids_right"]),
            (depth, ["depth_left", "depth_right"]),
            (wide, ["wide_left", "wide_right"]),
            (wide, ["pairs_left", "pairs_right"]),
        ];
        for (pair, names) in names {
            resources.extend([0, 1].map(|eye| (names[eye], pair[eye].as_entire_binding())));
        }
        resources
    }

    fn eye(&self, eye: usize) -> EyeGroups {
        let targets = self.targets;
        let size_px = targets.drawn_px[eye];
        let hidden = self.hidden.get(eye).filter(|bits| bits.len() == num_mask_words(size_px));
        let nothing = vec![0u32; num_mask_words(size_px)];
        let hidden = hidden.unwrap_or(&nothing);
        let tiles = tiles(size_px, hidden);
        let tiles_buffer = self.storage("tiles", if tiles.is_empty() { &[0] } else { &tiles });
        let hidden_buffer = self.storage("hidden", hidden);
        let uniform = |first_index: u32, num_points: u32| {
            self.uniform(&ResolveUniform {
                size_px,
                first_index,
                num_points,
                background: self.background,
                reserved_a: 0,
                reserved_b: 0,
                reserved_c: 0,
            })
        };
        let plain = uniform(0, 0);
        let by_ring = self.uniform(&DilateUniform { eye: eye as u32, ..DilateUniform::default() });
        let shared = |resolve: &wgpu::Buffer,
                      colors: [&wgpu::Buffer; 2],
                      bind: &dyn Fn(&Resources) -> wgpu::BindGroup| {
            // Where depth is a part of the key, `shade` reads both from there.
            let depth = match self.quality {
                Quality::Closest if self.pipelines.closest.ids.is_none() => &targets.keys[eye],
                _ => &targets.depth[eye],
            };
            bind(&vec![
                ("resolve", resolve.as_entire_binding()),
                ("tiles", tiles_buffer.as_entire_binding()),
                ("depth", depth.as_entire_binding()),
                ("ids", targets.keys[eye].as_entire_binding()),
                ("sums", targets.keys[eye].as_entire_binding()),
                ("wide", targets.wide[eye].as_entire_binding()),
                ("colors", colors[0].as_entire_binding()),
                ("filtered_colors", colors[1].as_entire_binding()),
                ("surface", targets.surface[eye].as_entire_binding()),
                ("dilate", by_ring.as_entire_binding()),
                ("view", self.view.as_entire_binding()),
                ("image", targets.finished(self.dilate)[eye].as_entire_binding()),
                ("hidden", hidden_buffer.as_entire_binding()),
            ])
        };
        let shade = |chunk: &Chunk| {
            let uniform = uniform(chunk.uniform.first_index, chunk.uniform.num_points);
            let colors = [&chunk.colors, &chunk.filtered_colors];
            shared(&uniform, colors, &|r| self.pipelines.closest.shade.bind(self.gpu, r))
        };
        let none = [&targets.depth[eye]; 2];
        let surface = match self.quality {
            _ if self.cloud.is_none() => vec![],
            Quality::Closest => self.chunks().iter().map(shade).collect(),
            Quality::Hqs => vec![shared(&plain, none, &|r| self.hqs().blend.bind(self.gpu, r))],
        };
        let dilates = self.cloud.is_some() && self.dilate == Dilate::Rings;
        let dilate = dilates.then(|| shared(&plain, none, &|r| self.pipelines.dilate.bind(self.gpu, r)));
        let image = shared(&plain, none, &|r| self.pipelines.image.bind(self.gpu, r));
        EyeGroups { num_tiles: tiles.len() as u32, surface, dilate, image }
    }

    fn uniform<T: bytemuck::Pod>(&self, value: &T) -> wgpu::Buffer {
        self.init("uniform", bytemuck::bytes_of(value), wgpu::BufferUsages::UNIFORM)
    }

    fn storage(&self, label: &str, words: &[u32]) -> wgpu::Buffer {
        self.init(label, bytemuck::cast_slice(words), wgpu::BufferUsages::STORAGE)
    }

    fn init(&self, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let descriptor = wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage };
        self.gpu.device.create_buffer_init(&descriptor)
    }
}

/// The `hqs` pipelines for a cloud's sums: the packed form where it is enough.
pub(super) fn hqs<'a>(pipelines: &'a Pipelines, cloud: Option<&CloudBuffers>) -> &'a Hqs {
    let is_crowded = cloud.is_none_or(|cloud| cloud.is_crowded);
    // The leanest form comes first, the safest last, and there is at least one.
    &pipelines.hqs[if is_crowded { pipelines.hqs.len() - 1 } else { 0 }]
}

/// Words of a mask of one bit a pixel, rows of whole words.
fn num_mask_words([width, height]: [u32; 2]) -> usize {
    width.div_ceil(32) as usize * height as usize
}

/// Tiles of which at least one pixel is not hidden, x | y≪16; `hidden` has a bit a pixel, rows of whole words.
#[must_use]
pub fn tiles([width, height]: [u32; 2], hidden: &[u32]) -> Vec<u32> {
    let [across, down] = TILE_PX;
    let words = width.div_ceil(32);
    let is_hidden = |x: u32, y: u32| hidden[(y * words + x / 32) as usize] >> (x % 32) & 1 == 1;
    let is_visible = |&(tx, ty): &(u32, u32)| {
        let mut rows = ty * down..((ty + 1) * down).min(height);
        let columns = tx * across..((tx + 1) * across).min(width);
        rows.any(|y| columns.clone().any(|x| !is_hidden(x, y)))
    };
    let tiles = (0..height.div_ceil(down)).flat_map(|y| (0..width.div_ceil(across)).map(move |x| (x, y)));
    tiles.filter(is_visible).map(|(x, y)| x | y << 16).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_is_left_out_only_when_all_of_it_is_hidden() {
        let size = [80, 20];
        let none = vec![0; num_mask_words(size)];
        assert_eq!(tiles(size, &none), [0, 1, 2, 1 << 16, 1 | 1 << 16, 2 | 1 << 16]);
        // The left 32 columns of all rows, but for one pixel.
        let mut left = none.clone();
        left.iter_mut().step_by(3).for_each(|word| *word = u32::MAX);
        assert_eq!(tiles(size, &left), [1, 2, 1 | 1 << 16, 2 | 1 << 16]);
        left[3 * 19] ^= 1 << 15;
        assert_eq!(tiles(size, &left), [1, 2, 1 << 16, 1 | 1 << 16, 2 | 1 << 16]);
    }
}
