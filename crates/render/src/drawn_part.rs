//! Buffers that tell the stages of the eyes' drawn part: sizes, tiles, hidden pixels. They are made anew when one of
//! these changes, and never with the cloud: a cloud takes another's place without a new buffer.

use super::targets::Targets;
use crate::gpu::Gpu;
use crate::layout::{
    BLUE_SHIFT, CHANNEL_MASK, ClearUniform, DILATE_REACH_PX, DilateUniform, EMPTY_DEPTH, GUARD_PX,
    MASK_WORD_PX, ResolveUniform, TILE_HIDES, TILE_PX, TILE_ROW_SHIFT, guarded, mask_words_per_row,
};
use wgpu::util::DeviceExt;

/// Both eyes' drawn part, as the shaders know it.
#[derive(Debug)]
pub(super) struct DrawnPart {
    /// For targets of 8 bytes a pixel: no point is near.
    pub no_keys: Clearing,
    /// For targets of 4 bytes a pixel: no point is near.
    pub no_depth: Clearing,
    /// For targets of 8 bytes a pixel: nothing is added up.
    pub no_sums: Clearing,
    /// For targets of 16 bytes a pixel: nothing is added up.
    pub no_wide: Clearing,
    /// For any targets, which stay as they are while the counters are cleared.
    pub nothing: Clearing,
    /// For finished colors: the background.
    pub no_colors: Clearing,
    /// For finished depths: no point is near.
    pub no_depths: Clearing,
    /// Each eye's drawn part.
    pub eyes: Vec<EyePart>,
}

/// How a pair of targets begins.
#[derive(Debug)]
pub(super) struct Clearing {
    /// A [`ClearUniform`].
    pub uniform: wgpu::Buffer,
    /// 16-byte words of the larger eye.
    pub num_words: u32,
}

/// An eye's drawn part.
#[derive(Debug)]
pub(super) struct EyePart {
    /// Tiles that somebody sees, or whose pixels dilation takes.
    pub num_tiles: u32,
    /// Words of these tiles; see [`tiles`].
    pub tiles: wgpu::Buffer,
    /// Mask of the hidden pixels, a bit a pixel; see [`mask_words_per_row`].
    pub hidden: wgpu::Buffer,
    /// A [`ResolveUniform`].
    pub resolve: wgpu::Buffer,
    /// A [`DilateUniform`].
    pub dilate: wgpu::Buffer,
}

impl DrawnPart {
    /// Makes the buffers of the part that `targets` says is drawn. `hidden` has the bits of the pixels that the lenses
    /// hide, an entry an eye, and an entry of the wrong size does not count. `background` is the color of a pixel
    /// without points, which is brought into the order of images of this `format`.
    pub fn new(
        gpu: &Gpu,
        targets: &Targets,
        hidden: &[Vec<u32>],
        (background, format): (u32, wgpu::TextureFormat),
    ) -> Self {
        let is_bgra = format == wgpu::TextureFormat::Bgra8UnormSrgb;
        let background = if is_bgra { swapped(background) } else { background };
        let make = PartMaker { gpu, targets };
        Self {
            no_keys: make.clearing(8, EMPTY_DEPTH),
            no_depth: make.clearing(4, EMPTY_DEPTH),
            no_sums: make.clearing(8, 0),
            no_wide: make.clearing(16, 0),
            nothing: make.clearing(0, 0),
            no_colors: make.clearing_images(background),
            no_depths: make.clearing_images(EMPTY_DEPTH),
            eyes: (0..targets.drawn_px.len())
                .map(|eye| make.eye(eye, hidden.get(eye).map_or(&[], |bits| bits), background, is_bgra))
                .collect(),
        }
    }
}

/// What the buffers are made with.
struct PartMaker<'a> {
    gpu: &'a Gpu,
    targets: &'a Targets,
}

impl PartMaker<'_> {
    fn clearing(&self, bytes_per_px: u64, value: u32) -> Clearing {
        self.clearing_words([0, 1].map(|eye| self.targets.num_words(eye, bytes_per_px)), value)
    }

    /// Value that a pair of finished images begins with.
    fn clearing_images(&self, value: u32) -> Clearing {
        self.clearing_words([0, 1].map(|eye| self.targets.num_image_words(eye)), value)
    }

    fn clearing_words(&self, [num_left, num_right]: [u32; 2], value: u32) -> Clearing {
        let uniform = self.uniform("clear", &ClearUniform { value, num_left, num_right, reserved: 0 });
        Clearing { uniform, num_words: num_left.max(num_right) }
    }

    fn eye(&self, eye: usize, hidden: &[u32], background: u32, is_bgra: bool) -> EyePart {
        let size_px = self.targets.drawn_px[eye];
        let nothing = vec![0; num_mask_words(size_px)];
        let hidden = if hidden.len() == nothing.len() { hidden } else { &nothing };
        let tiles = tiles(size_px, hidden);
        EyePart {
            num_tiles: tiles.len() as u32,
            // A binding cannot be empty.
            tiles: self.storage("tiles", if tiles.is_empty() { &[0] } else { &tiles }),
            hidden: self.storage("hidden", hidden),
            resolve: self
                .uniform("resolve", &ResolveUniform { size_px, background, is_bgra: is_bgra.into() }),
            dilate: self.uniform("dilate", &DilateUniform { eye: eye as u32 }),
        }
    }

    fn uniform<T: bytemuck::Pod>(&self, label: &str, value: &T) -> wgpu::Buffer {
        self.buffer(label, bytemuck::bytes_of(value), wgpu::BufferUsages::UNIFORM)
    }

    fn storage(&self, label: &str, words: &[u32]) -> wgpu::Buffer {
        self.buffer(label, bytemuck::cast_slice(words), wgpu::BufferUsages::STORAGE)
    }

    fn buffer(&self, label: &str, contents: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let descriptor = wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage };
        self.gpu.device.create_buffer_init(&descriptor)
    }
}

fn num_mask_words([width, height]: [u32; 2]) -> usize {
    (mask_words_per_row(width) * height) as usize
}

/// A color with red and blue in each other's place.
fn swapped(color: u32) -> u32 {
    let kept = color & !(CHANNEL_MASK | CHANNEL_MASK << BLUE_SHIFT);
    kept | color >> BLUE_SHIFT & CHANNEL_MASK | (color & CHANNEL_MASK) << BLUE_SHIFT
}

/// Tiles, x | y≪16, of an image of this size with its guard band. A tile is listed if a pixel that is not hidden lies
/// in it or so near to it that dilation reaches it; it has [`TILE_HIDES`] if a pixel of the tile itself is hidden.
/// `hidden` has a bit a pixel of the image, in rows of [`mask_words_per_row`].
#[must_use]
pub fn tiles([width, height]: [u32; 2], hidden: &[u32]) -> Vec<u32> {
    let [across, down] = TILE_PX;
    let words = mask_words_per_row(width);
    let is_hidden =
        |x: u32, y: u32| hidden[(y * words + x / MASK_WORD_PX) as usize] >> (x % MASK_WORD_PX) & 1 == 1;
    // Pixels of the image along an axis that a tile of this number and size has, with `reach_px` more to each side.
    let around = |tile: u32, tile_px: u32, size_px: u32, reach_px: u32| {
        let first = (tile * tile_px).saturating_sub(GUARD_PX + reach_px);
        first..((tile + 1) * tile_px + reach_px).saturating_sub(GUARD_PX).min(size_px)
    };
    let any = |(tx, ty): (u32, u32), reach_px: u32, counts: &dyn Fn(u32, u32) -> bool| {
        let columns = around(tx, across, width, reach_px);
        around(ty, down, height, reach_px).any(|y| columns.clone().any(|x| counts(x, y)))
    };
    let is_needed = |&tile: &(u32, u32)| any(tile, DILATE_REACH_PX, &|x, y| !is_hidden(x, y));
    let word = |tile: (u32, u32)| {
        let hides = if any(tile, 0, &is_hidden) { TILE_HIDES } else { 0 };
        tile.0 | tile.1 << TILE_ROW_SHIFT | hides
    };
    let [columns, rows] = guarded([width, height]);
    let tiles = (0..rows.div_ceil(down)).flat_map(|y| (0..columns.div_ceil(across)).map(move |x| (x, y)));
    tiles.filter(is_needed).map(word).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tiles' words without [`TILE_HIDES`].
    fn places(size: [u32; 2], hidden: &[u32]) -> Vec<u32> {
        tiles(size, hidden).into_iter().map(|tile| tile & !TILE_HIDES).collect()
    }

    #[test]
    fn tiles_say_whether_they_hide_pixels() {
        let size = [80, 20];
        let mut hidden = vec![0; num_mask_words(size)];
        assert!(tiles(size, &hidden).iter().all(|tile| tile & TILE_HIDES == 0));
        // Column 29 of the image is the first of the second tile, row 13 the first of the second row.
        hidden[3 * 12] |= 1 << 29;
        let hides: Vec<u32> =
            tiles(size, &hidden).into_iter().filter(|tile| tile & TILE_HIDES != 0).collect();
        assert_eq!(hides, [1 | TILE_HIDES]);
    }

    #[test]
    fn a_tile_is_left_out_only_when_all_that_it_reaches_is_hidden() {
        // The image has 86 × 26 pixels with its guard band.
        let size = [80, 20];
        let none = vec![0; num_mask_words(size)];
        assert_eq!(places(size, &none), [0, 1, 2, 1 << 16, 1 | 1 << 16, 2 | 1 << 16]);
        // The left 32 columns of all rows are hidden, first all, then all except one pixel: the tile ends at the
        // image's column 29.
        let mut left = none.clone();
        left.iter_mut().step_by(3).for_each(|word| *word = u32::MAX);
        assert_eq!(places(size, &left), [1, 2, 1 | 1 << 16, 2 | 1 << 16]);
        left[3 * 19] ^= 1 << 15;
        assert_eq!(places(size, &left), [1, 2, 1 << 16, 1 | 1 << 16, 2 | 1 << 16]);
        // Column 31 is in the next tile, and dilation there reaches three pixels to the left, into this one.
        left[3 * 19] ^= 1 << 15 | 1 << 31;
        assert_eq!(places(size, &left), [1, 2, 1 << 16, 1 | 1 << 16, 2 | 1 << 16]);
        left[3 * 19 + 1] = 0;
        left[3 * 19] = u32::MAX;
        assert_eq!(places(size, &left), [1, 2, 1 << 16 | 1, 2 | 1 << 16]);
    }

    #[test]
    fn tiles_of_the_guard_band_alone_are_there_for_dilation() {
        // Rows 26 to 31 of the second row of tiles are beyond the guard band; a mask hides all pixels except the
        // corner.
        let size = [26, 20];
        let mut hidden = vec![u32::MAX; num_mask_words(size)];
        assert!(places(size, &hidden).is_empty());
        hidden[0] ^= 1;
        assert_eq!(places(size, &hidden), [0]);
        // Row 9 of the image is row 12 of the first tile; the second begins with row 13, three pixels on from row 10.
        hidden[0] ^= 1;
        hidden[9] ^= 1;
        assert_eq!(places(size, &hidden), [0]);
        hidden[10] ^= 1;
        assert_eq!(places(size, &hidden), [0, 1 << 16]);
    }
}
