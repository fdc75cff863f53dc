// Overlays of boxes: the cubes of the nodes that are drawn, by level, and the boxes of visible batches, by the bits
// that are read of them. A box is an instance: 12 edges of two triangles each, as wide as they need to be to survive
// the way to the window. Boxes are faint behind surfaces.

@group(0) @binding(4) var<storage, read> nodes: array<GpuNode>;
@group(0) @binding(5) var<storage, read> states: array<u32>;
@group(0) @binding(6) var<storage, read> visible: array<VisibleBatch>;
/// The counters as words, num_visible first; see CullCounters.
@group(0) @binding(7) var<storage, read> counters: array<u32>;

struct Edge {
    @builtin(position) position: vec4<f32>,
    @location(0) depth: f32,
    @location(1) @interpolate(flat) color: vec3<f32>,
}

/// All vertices lie in one place, so that nothing is drawn.
const NO_EDGE: Edge = Edge(vec4<f32>(0.0, 0.0, 0.0, 1.0), 0.0, vec3<f32>(0.0));

fn depth_of(eye: EyeUniform, p: vec3<f32>) -> f32 {
    return dot(eye.row_w, vec4<f32>(p, 1.0));
}

// Pixel coordinates in the image, from its top left corner.
fn px_of(eye: EyeUniform, p: vec3<f32>) -> vec2<f32> {
    let at = vec4<f32>(p, 1.0);
    return vec2<f32>(dot(eye.row_x, at), dot(eye.row_y, at)) / depth_of(eye, p) - eye.first_px - f32(GUARD_PX);
}

// Where the edge p–q begins: p, or the point on the near plane if p is nearer.
fn clipped(eye: EyeUniform, p: vec3<f32>, q: vec3<f32>) -> vec3<f32> {
    let w_p = depth_of(eye, p);
    if w_p >= view.near {
        return p;
    }
    return mix(p, q, (view.near - w_p) / (depth_of(eye, q) - w_p));
}

// Vertex 0 to 71 of a box in head space.
fn box_vertex(vertex: u32, low: vec3<f32>, size: vec3<f32>, color: vec3<f32>) -> Edge {
    let eye = view.eyes[dilate.eye];
    let number = vertex / 6u;
    let axis = number >> 2u;
    var begin = vec3<f32>(0.0);
    begin[(axis + 1u) % 3u] = f32(number & 1u);
    begin[(axis + 2u) % 3u] = f32((number >> 1u) & 1u);
    var finish = begin;
    finish[axis] = 1.0;
    let p = low + size * begin;
    let q = low + size * finish;
    if max(depth_of(eye, p), depth_of(eye, q)) <= view.near {
        return NO_EDGE;
    }
    let ends = array<vec3<f32>, 2>(clipped(eye, p, q), clipped(eye, q, p));
    let along = px_of(eye, ends[1]) - px_of(eye, ends[0]);
    let length = length(along);
    if length < 0.001 {
        return NO_EDGE;
    }
    // Triangles p− p+ q− and q− p+ q+.
    let corner = vertex % 6u;
    let is_far = corner >= 2u && corner != 4u;
    let side = select(-1.0, 1.0, corner == 1u || corner >= 4u);
    let size_px = vec2<f32>(f32(eye.width - 2u * GUARD_PX), f32(eye.height - 2u * GUARD_PX));
    let half_width = max(0.75, size_px.y / 1080.0);
    let end = select(ends[0], ends[1], is_far);
    let w = depth_of(eye, end);
    let px = px_of(eye, end) + side * half_width / length * vec2<f32>(-along.y, along.x);
    let x = 2.0 * px.x / size_px.x - 1.0;
    let y = 1.0 - 2.0 * px.y / size_px.y;
    return Edge(vec4<f32>(x * w, y * w, 0.5 * w, w), w, color);
}

@vertex
fn node_box(@builtin(vertex_index) vertex: u32, @builtin(instance_index) number: u32) -> Edge {
    let node = nodes[number];
    if states[number] == 0u || node.edge == 0.0 {
        return NO_EDGE;
    }
    let low = -(view.head_hi - node.min_hi) - (view.head_lo - node.min_lo);
    return box_vertex(vertex, low, vec3<f32>(node.edge), palette(node.level));
}

@vertex
fn batch_box(@builtin(vertex_index) vertex: u32, @builtin(instance_index) number: u32) -> Edge {
    if number >= counters[0] {
        return NO_EDGE;
    }
    let batch = visible[number];
    // A batch has one box, however many slices it has.
    if slice_of(batch) != 0u {
        return NO_EDGE;
    }
    let low = batch.offset - vec3<f32>(batch.head_cell) * batch.cell;
    return box_vertex(vertex, low, CELLS * batch.cell, palette((batch.flags & VISIBLE_PLANES) - COARSE_PLANES));
}

@fragment
fn line(edge: Edge) -> @location(0) vec4<f32> {
    let nearest = depth_at(edge.position);
    let is_behind = nearest != EMPTY_DEPTH && edge.depth > SURFACE_TOLERANCE * bitcast<f32>(nearest);
    return vec4<f32>(edge.color, select(EDGE_ALPHA.x, EDGE_ALPHA.y, is_behind));
}
