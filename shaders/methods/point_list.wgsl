// point-list: each point is a hardware primitive of one pixel, hidden by the hardware's depth test; the compute frame
// is measured against it. An instance a visible batch, a vertex a point. [2022 §4.1, GL_POINTS]
//
// The image is that of the other methods: a vertex lies at the center of its point's pixel, and depths are the bits of
// w, moved down so that they are floats from 0 to 1. Points at the same depth win in the order of batches, which is
// any.

@group(0) @binding(5) var<uniform> chunk: ChunkUniform;

struct Vertex {
    @builtin(position) position: vec4<f32>,
    /// Id in the cloud, bits of w.
    @location(0) @interpolate(flat, either) key: vec2<u32>,
}

/// The smallest float that hardware does not take for 0.
const LEAST: u32 = 0x00800000u;

fn vertex_of(eye: u32, instance: u32, number: u32) -> Vertex {
    let batch = visible[instance];
    let nowhere = Vertex(vec4<f32>(2.0, 2.0, 2.0, 1.0), vec2<u32>(0u));
    if number >= batch.num_points || !sees(eye, batch) {
        return nowhere;
    }
    let points = points_of(batch, number);
    let p = seen(eye, batch, points);
    if p.pixel.x == NO_PIXEL {
        return nowhere;
    }
    let width = view.eyes[eye].width;
    let size_px = vec2<f32>(f32(width), f32(view.eyes[eye].height));
    let center = vec2<f32>(vec2<u32>(p.pixel.x % width, p.pixel.x / width)) + 0.5;
    let at = 2.0 * center / size_px - 1.0;
    let bits = bitcast<u32>(p.w.x);
    let depth = bitcast<f32>(bits - bitcast<u32>(view.near) + LEAST);
    return Vertex(vec4<f32>(at.x, -at.y, depth, 1.0), vec2<u32>((chunk.first_index << ID_SHIFT) + points.id.x, bits));
}

@vertex
fn left(@builtin(instance_index) instance: u32, @builtin(vertex_index) number: u32) -> Vertex {
    return vertex_of(0u, instance, number);
}

@vertex
fn right(@builtin(instance_index) instance: u32, @builtin(vertex_index) number: u32) -> Vertex {
    return vertex_of(1u, instance, number);
}

@fragment
fn fragment(point: Vertex) -> @location(0) vec2<u32> {
    return point.key;
}
