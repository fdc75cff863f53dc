// One eye's image on the window: a triangle that covers the viewport, which the host lays where the image
// belongs (larger than the window where the image is cropped). Sampling an sRGB texture gives linear light;
// a window surface that is not sRGB itself wants it encoded again.

override ENCODE_SRGB: bool;

// The part of the image that is drawn, from its top left corner, in uv.
struct DrawnUniform {
    size: vec2f,
    // Center of the last texel: beyond it, filtering would mix in pixels that are not drawn.
    last: vec2f,
}

@group(0) @binding(0) var image: texture_2d<f32>;
@group(0) @binding(1) var image_sampler: sampler;
@group(0) @binding(2) var<uniform> drawn: DrawnUniform;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    // The uv are (0, 0), (2, 0), (0, 2): the half of the triangle beyond 1 falls outside the viewport.
    let uv = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return Corner(vec4f(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0), uv);
}

@fragment
fn pixel(in: Corner) -> @location(0) vec4f {
    let linear = textureSample(image, image_sampler, min(in.uv * drawn.size, drawn.last)).rgb;
    if ENCODE_SRGB {
        return vec4f(srgb_from_linear(linear), 1.0);
    }
    return vec4f(linear, 1.0);
}
