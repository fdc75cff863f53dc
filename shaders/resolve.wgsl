// resolve, last step: an eye's colors to its image, and depth for the runtime's reprojection.
//
// Colors are stored sRGB-encoded and the target encodes what it is given, so they are decoded here: the image
// ends up with the stored bytes. Storage textures cannot be sRGB, hence a pass that draws.

@group(0) @binding(0) var<uniform> resolve: ResolveUniform;
@group(0) @binding(1) var<storage, read> image: array<vec2<u32>>;
// A bit a pixel of the image, which has no guard band, rows of whole words: 1 where the lenses hide it.
@group(0) @binding(2) var<storage, read> hidden: array<u32>;
@group(0) @binding(3) var<uniform> view: ViewUniform;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers the image.
    return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn pixel_at(position: vec2<f32>) -> vec2<u32> {
    let x = u32(position.x);
    let y = u32(position.y);
    let words = (resolve.size_px.x - 2u * GUARD_PX + 31u) / 32u;
    if ((hidden[y * words + x / 32u] >> (x % 32u)) & 1u) != 0u {
        return vec2<u32>(EMPTY_DEPTH, resolve.background);
    }
    let pixel = image[(y + GUARD_PX) * resolve.size_px.x + x + GUARD_PX];
    return select(pixel, vec2<u32>(EMPTY_DEPTH, resolve.background), pixel.x == EMPTY_DEPTH);
}

fn color_of(pixel: vec2<u32>) -> vec4<f32> {
    return vec4<f32>(linear_from_srgb(unpack4x8unorm(pixel.y).rgb), 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return color_of(pixel_at(position.xy));
}

struct ColorAndDepth {
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

// Depth is near / w, 0 where nothing is: infinitely far.
@fragment
fn fragment_with_depth(@builtin(position) position: vec4<f32>) -> ColorAndDepth {
    let pixel = pixel_at(position.xy);
    let depth = select(view.near / bitcast<f32>(pixel.x), 0.0, pixel.x == EMPTY_DEPTH);
    return ColorAndDepth(color_of(pixel), depth);
}
