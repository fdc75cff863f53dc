// The last step of `resolve`: an eye's finished pixels, as they are copied into its image, and their depths. Both lie row
// by row without the guard band; rows of `image_pitch_px(resolve.size_px.x)` pixels are such as copies want.

@group(0) @binding(3) var<storage, read_write> image_color: array<u32>;
@group(0) @binding(6) var<storage, read_write> image_depth: array<u32>;
// A bit a pixel of the image, rows of whole words: 1 where the lenses hide it.
@group(0) @binding(7) var<storage, read> hidden: array<u32>;
@group(0) @binding(8) var<uniform> resolve: ResolveUniform;

fn is_hidden(at: vec2<u32>) -> bool {
    let words = (resolve.size_px.x + MASK_WORD_PX - 1u) / MASK_WORD_PX;
    return ((hidden[at.y * words + at.x / MASK_WORD_PX] >> (at.x % MASK_WORD_PX)) & 1u) != 0u;
}

// Puts a pixel of the image with its guard band there; the guard band itself goes nowhere. `color` is r | g≪8 | b≪16.
fn into_image(pixel: vec2<u32>, depth: u32, color: u32, tile_hides: bool) {
    // Left of the image and above it, coordinates wrap to large ones.
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
