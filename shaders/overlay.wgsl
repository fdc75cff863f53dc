// Overlays with a color for every pixel: rings, depth, overdraw.

@group(0) @binding(4) var<storage, read> sums: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> wide: array<vec4<u32>>;

/// Color of a pixel without points.
const NOTHING: vec4<f32> = vec4<f32>(0.0, 0.0, 0.0, 1.0);

fn ramp(share: f32) -> vec4<f32> {
    var stops = OVERLAY_RAMP;
    let at = clamp(share, 0.0, 1.0) * f32(RAMP_STEPS);
    let stop = min(u32(at), RAMP_STEPS - 1u);
    return vec4<f32>(linear_from_srgb(mix(stops[stop], stops[stop + 1u], at - f32(stop))), 1.0);
}

@vertex
fn whole(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers the image.
    return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Colors by the rule of dilation, with a line where a ring ends.
@fragment
fn rings(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let eye = view.eyes[dilate.eye];
    let at = vec2<i32>(position.xy) + i32(GUARD_PX);
    let ring = radius_px(eye, at.x, at.y);
    let step = 1 + i32(eye.height / 720u);
    let is_edge = radius_px(eye, at.x + step, at.y) != ring || radius_px(eye, at.x, at.y + step) != ring
        || radius_px(eye, at.x - step, at.y) != ring || radius_px(eye, at.x, at.y - step) != ring;
    return vec4<f32>(palette(ring - 1u), select(RING_ALPHA.x, RING_ALPHA.y, is_edge));
}

@fragment
fn depth(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let w = depth_at(position);
    if w == EMPTY_DEPTH {
        return NOTHING;
    }
    return ramp(log2(bitcast<f32>(w) / view.near) / DEPTH_OCTAVES);
}

// Points that a pixel's sums hold; see `blend`.
fn num_points(pixel: u32) -> u32 {
    if SUMS == WIDE {
        return wide[pixel].w;
    }
    if SUMS == PACKED {
        return sums[pixel].x & PACKED_COUNT_MASK;
    }
    let first = sums[pixel].x & PROTECTED_MASK;
    if first < PROTECTED_POINTS {
        return first;
    }
    return first + wide[pixel].w;
}

@fragment
fn overdraw(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    // Sums have the guard band round the image.
    let pixel = (u32(position.y) + GUARD_PX) * view.eyes[dilate.eye].width + u32(position.x) + GUARD_PX;
    let count = num_points(pixel);
    if count == 0u {
        return NOTHING;
    }
    return ramp(log2(f32(count)) / OVERDRAW_OCTAVES);
}
