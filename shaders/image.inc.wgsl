// The last step of `resolve`: an eye's finished pixels, as they are copied into its image, and their depths. Both lie
// row by row without the guard band, in rows of `image_pitch_px(resolve.size_px.x)` pixels, as copies want them.

@group(0) @binding(3) var<storage, read_write> image_color: array<u32>;
@group(0) @binding(6) var<storage, read_write> image_depth: array<u32>;
// A bit a pixel of the image, in rows of whole words: 1 if the lenses hide the pixel.
@group(0) @binding(7) var<storage, read> hidden: array<u32>;
@group(0) @binding(8) var<uniform> resolve: ResolveUniform;

fn is_hidden(at: vec2<u32>) -> bool {
    let words = (resolve.size_px.x + MASK_WORD_PX - 1u) / MASK_WORD_PX;
    return ((hidden[at.y * words + at.x / MASK_WORD_PX] >> (at.x % MASK_WORD_PX)) & 1u) != 0u;
}

// Writes a pixel of the image with its guard band; pixels of the guard band are dropped. `color` is r | g≪8 | b≪16.
fn into_image(pixel: vec2<u32>, depth: u32, color: u32, tile_hides: bool) {
    // Coordinates left of the image and above it wrap to large ones.
    let at = pixel - GUARD_PX;
    if at.x >= resolve.size_px.x || at.y >= resolve.size_px.y {
        return;
    }
    var w = depth;
    if tile_hides && is_hidden(at) {
        w = EMPTY_DEPTH;
    }
    var word = color | OPAQUE;
    if resolve.is_bgra != 0u {
        let kept = word & ~(CHANNEL_MASK | (CHANNEL_MASK << BLUE_SHIFT));
        word = kept | ((word >> BLUE_SHIFT) & CHANNEL_MASK) | ((word & CHANNEL_MASK) << BLUE_SHIFT);
    }
    let number = at.y * image_pitch_px(resolve.size_px.x) + at.x;
    image_color[number] = select(word, resolve.background, w == EMPTY_DEPTH);
    image_depth[number] = w;
}
