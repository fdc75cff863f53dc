// What the geometry stages share: a workgroup a visible batch, a thread POINTS_PER_LOAD points at a time (one, where
// the loop is BASIC), each point read and decoded once and put into both eyes' pixels. [2022 §3.2 to 3.4] Which points
// of a batch an eye is to see, and how wide they are, say nodes.inc.wgsl and discs.inc.wgsl.
//
// A stage adds its targets from binding 5 on, and what it does with a point in a pixel of an eye, 0 or 1:
//   fn put(eye: u32, pixel: u32, w: f32, id: u32)
// `w` is linear depth, whose IEEE bits order like the number itself; `id` is twice the point's number in the chunk,
// and one more if its filtered color counts, or if it is of a triangle. Where the stage is CONVERGED, all threads of a workgroup come to `put`
// together, those without a point too: their pixel is NO_PIXEL.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<storage, read> visible: array<VisibleBatch>;
@group(0) @binding(2) var<storage, read> plane_hi: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> plane_mid: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> plane_lo: array<vec4<u32>>;

/// Points that a thread draws before it goes on.
const POINTS_PER_TURN: u32 = select(POINTS_PER_LOAD, 1u, BASIC);
const TURNS_PER_LOAD: u32 = POINTS_PER_LOAD / POINTS_PER_TURN;

const MASK: u32 = (1u << PLANE_BITS) - 1u;

// Where this thread is; for those who ask in `put`.
var<private> this_group: u32;
var<private> this_thread: u32;

// Points inside the eye's image have a pixel number; the others NO_PIXEL.
const NO_PIXEL: u32 = 0xffffffffu;

/// Cells that a box edge has.
const CELLS: f32 = 1073741824.0;

struct Cells {
    x: vec4<u32>,
    y: vec4<u32>,
    z: vec4<u32>,
}

struct Projected {
    pixel: vec4<u32>,
    w: vec4<f32>,
}

fn row(r: vec4<f32>, x: vec4<f32>, y: vec4<f32>, z: vec4<f32>) -> vec4<f32> {
    return r.x * x + r.y * y + r.z * z + r.w;
}

fn project(eye: u32, x: vec4<f32>, y: vec4<f32>, z: vec4<f32>, exists: vec4<bool>) -> Projected {
    let w = row(view.eyes[eye].row_w, x, y, z);
    let per_w = 1.0 / w;
    let u = row(view.eyes[eye].row_x, x, y, z) * per_w;
    let v = row(view.eyes[eye].row_y, x, y, z) * per_w;
    let size = view.eyes[eye].size_px;
    let inside = exists & (w > vec4<f32>(view.near)) & (u >= vec4<f32>(0.0)) & (u < vec4<f32>(size.x))
        & (v >= vec4<f32>(0.0)) & (v < vec4<f32>(size.y));
    let pixel = vec4<u32>(v) * view.eyes[eye].width + vec4<u32>(u);
    return Projected(select(vec4<u32>(NO_PIXEL), pixel, inside), w);
}

// A point that is `diameter` world units wide, as a disc of pixels round its own.
fn put_wide(eye: u32, pixel: u32, w: f32, id: u32, diameter: f32) {
    if pixel == NO_PIXEL {
        return;
    }
    let diameter_px = diameter * view.eyes[eye].pixels_per_radian * (1.0 / w);
    let radius = i32(ceil(clamp(0.5 * (diameter_px - view.fill_reach_px), 0.0, f32(MAX_FILL_RADIUS))));
    if radius == 0 {
        put(eye, pixel, w, id);
        return;
    }
    let size = vec2<i32>(i32(view.eyes[eye].width), i32(view.eyes[eye].height));
    let center = vec2<i32>(i32(pixel) % size.x, i32(pixel) / size.x);
    let first = max(center - radius, vec2<i32>(0));
    let last = min(center + radius, size - 1);
    for (var y = first.y; y <= last.y; y += 1) {
        for (var x = first.x; x <= last.x; x += 1) {
            let d = vec2<i32>(x, y) - center;
            if d.x * d.x + d.y * d.y <= radius * (radius + 1) {
                put(eye, u32(y * size.x + x), w, id);
            }
        }
    }
}

fn put_seen(eye: u32, pixel: u32, w: f32, id: u32) {
    if CONVERGED || pixel != NO_PIXEL {
        put(eye, pixel, w, id);
    }
}

fn draw(eye: u32, p: Projected, id: vec4<u32>, diameter: vec4<f32>, is_wide: bool) {
    if FILL && is_wide {
        for (var i = 0u; i < POINTS_PER_TURN; i += 1u) {
            put_wide(eye, p.pixel[i], p.w[i], id[i], diameter[i]);
        }
        return;
    }
    put_seen(eye, p.pixel.x, p.w.x, id.x);
    if !BASIC {
        put_seen(eye, p.pixel.y, p.w.y, id.y);
        put_seen(eye, p.pixel.z, p.w.z, id.z);
        put_seen(eye, p.pixel.w, p.w.w, id.w);
    }
}

// What a turn gets of each plane: a whole load, or one point of it.
fn hi_of(load: u32, turn: u32) -> vec4<u32> {
    if BASIC {
        return vec4<u32>(plane_hi[load][turn % POINTS_PER_LOAD]);
    }
    return plane_hi[load];
}

fn mid_of(load: u32, turn: u32) -> vec4<u32> {
    if BASIC {
        return vec4<u32>(plane_mid[load][turn % POINTS_PER_LOAD]);
    }
    return plane_mid[load];
}

fn lo_of(load: u32, turn: u32) -> vec4<u32> {
    if BASIC {
        return vec4<u32>(plane_lo[load][turn % POINTS_PER_LOAD]);
    }
    return plane_lo[load];
}

// Coordinates in 30-bit cells. Bits that are not read stand at half: the centre of the coarser cell.
fn cells_of(load: u32, turn: u32, planes: u32) -> Cells {
    let hi = hi_of(load, turn);
    var x = ((hi & vec4<u32>(MASK)) << vec4<u32>(20u)) | vec4<u32>(0x80000u);
    var y = (((hi >> vec4<u32>(10u)) & vec4<u32>(MASK)) << vec4<u32>(20u)) | vec4<u32>(0x80000u);
    var z = ((hi >> vec4<u32>(20u)) << vec4<u32>(20u)) | vec4<u32>(0x80000u);
    if planes >= 2u {
        let mid = mid_of(load, turn);
        x = (x & vec4<u32>(0xfff00000u)) | ((mid & vec4<u32>(MASK)) << vec4<u32>(10u)) | vec4<u32>(0x200u);
        y = (y & vec4<u32>(0xfff00000u)) | (((mid >> vec4<u32>(10u)) & vec4<u32>(MASK)) << vec4<u32>(10u)) | vec4<u32>(0x200u);
        z = (z & vec4<u32>(0xfff00000u)) | ((mid >> vec4<u32>(20u)) << vec4<u32>(10u)) | vec4<u32>(0x200u);
    }
    if planes == 3u {
        let lo = lo_of(load, turn);
        x = (x & vec4<u32>(0xfffffc00u)) | (lo & vec4<u32>(MASK));
        y = (y & vec4<u32>(0xfffffc00u)) | ((lo >> vec4<u32>(10u)) & vec4<u32>(MASK));
        z = (z & vec4<u32>(0xfffffc00u)) | (lo >> vec4<u32>(20u));
    }
    return Cells(x, y, z);
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    this_group = group.x;
    this_thread = thread;
    let batch = visible[group.x];
    if DISCS && (batch.flags & VISIBLE_TRIANGLES) != 0u {
        draw_triangles(batch);
        return;
    }
    let planes = batch.flags & 3u;
    let is_wide = (batch.flags & VISIBLE_FILL) != 0u;
    let first_load = batch.first_point / POINTS_PER_LOAD;
    let num_turns = (batch.num_points + POINTS_PER_TURN - 1u) / POINTS_PER_TURN;

    for (var first = 0u; first < num_turns; first += WORKGROUP_SIZE) {
        let turn = first + thread;
        if !CONVERGED && turn >= num_turns {
            break;
        }
        let load = first_load + turn / TURNS_PER_LOAD;
        let cells = cells_of(load, turn, planes);
        // The integer difference is exact: see VisibleBatch.
        let px = vec4<f32>(vec4<i32>(cells.x) - batch.head_cell.x) * batch.cell.x + batch.offset.x;
        let py = vec4<f32>(vec4<i32>(cells.y) - batch.head_cell.y) * batch.cell.y + batch.offset.y;
        let pz = vec4<f32>(vec4<i32>(cells.z) - batch.head_cell.z) * batch.cell.z + batch.offset.z;

        let number = vec4<u32>(turn * POINTS_PER_TURN) + vec4<u32>(0u, 1u, 2u, 3u);
        let rank = reverseBits(number);
        var exists = number < vec4<u32>(batch.num_points);
        if batch.drawn != DRAWN_WHOLE {
            exists = exists & (rank < vec4<u32>(batch.drawn));
        }
        // The octant says of which child the color and the spacing depend.
        let octant = (cells.x >> vec4<u32>(29u)) | ((cells.y >> vec4<u32>(29u)) << vec4<u32>(1u))
            | ((cells.z >> vec4<u32>(29u)) << vec4<u32>(2u));
        var id = (vec4<u32>(batch.first_point) + number) << vec4<u32>(1u);
        if (batch.own.x & batch.own.y) != 0xffffffffu {
            let word = select(vec4<u32>(batch.own.x), vec4<u32>(batch.own.y), octant >= vec4<u32>(4u));
            let own = (word >> ((octant & vec4<u32>(3u)) << vec4<u32>(3u))) & vec4<u32>(255u);
            let is_filtered = (own != vec4<u32>(255u)) & ((rank >> vec4<u32>(24u)) >= own);
            id |= select(vec4<u32>(0u), vec4<u32>(1u), is_filtered);
        }
        var diameter = vec4<f32>(0.0);
        if FILL && is_wide {
            let edge = CELLS * max(batch.cell.x, max(batch.cell.y, batch.cell.z));
            diameter = diameters(load, turn, octant, edge, batch.spacing);
        }
        if (batch.flags & 16u) != 0u {
            let chosen = exists & is_chosen(0u, batch.flags, load, turn, px, py, pz);
            draw(0u, project(0u, px, py, pz, chosen), id, diameter, is_wide);
        }
        if NUM_EYES == 2u && (batch.flags & 32u) != 0u {
            let chosen = exists & is_chosen(1u, batch.flags, load, turn, px, py, pz);
            draw(1u, project(1u, px, py, pz, chosen), id, diameter, is_wide);
        }
    }
}
