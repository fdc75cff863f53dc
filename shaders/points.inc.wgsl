// Points of visible batches, a turn at a time: read, decoded, and projected into an eye's pixels. [2022 §3.2 to 3.4]
// turn.inc.wgsl says how many points a turn has, nodes.inc.wgsl which of them an eye is to see, and how wide they are.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<storage, read> visible: array<VisibleBatch>;
@group(0) @binding(2) var<storage, read> plane_hi: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> plane_mid: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> plane_lo: array<vec4<u32>>;

// Number of a pixel that is none: points outside the eye's image and its guard band have it.
const NO_PIXEL: u32 = ~0u;

struct Cells {
    x: vec4<u32>,
    y: vec4<u32>,
    z: vec4<u32>,
}

/// The points of a turn, in head space. `at` is the turn's place in the chunk, in turns. `id` is twice the point's number
/// in the chunk, and one more if its filtered color counts.
struct Turn {
    at: u32,
    octant: vec4<u32>,
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
    id: vec4<u32>,
    exists: vec4<bool>,
}

/// `x` and `y` are whole coordinates, inside the image or not. `w` is linear depth, whose IEEE bits are ordered as the
/// number itself is, with room for REACH_MASK; 0 for points that are not there or too near.
struct Projected {
    pixel: vec4<u32>,
    x: vec4<f32>,
    y: vec4<f32>,
    w: vec4<f32>,
}

fn sees(eye: u32, batch: VisibleBatch) -> bool {
    return (batch.flags & (VISIBLE_BY_EYE << eye)) != 0u;
}

fn row(r: vec4<f32>, x: vec4<f32>, y: vec4<f32>, z: vec4<f32>) -> vec4<f32> {
    return r.x * x + r.y * y + r.z * z + r.w;
}

// Depths whose last bits are free for REACH_MASK.
fn without_reach(w: vec4<f32>) -> vec4<f32> {
    return bitcast<vec4<f32>>(bitcast<vec4<u32>>(w) & vec4<u32>(~REACH_MASK));
}

fn project(eye: u32, x: vec4<f32>, y: vec4<f32>, z: vec4<f32>, exists: vec4<bool>) -> Projected {
    let exact_w = row(view.eyes[eye].row_w, x, y, z);
    let w = without_reach(exact_w);
    let per_w = 1.0 / exact_w;
    let u = floor(row(view.eyes[eye].row_x, x, y, z) * per_w);
    let v = floor(row(view.eyes[eye].row_y, x, y, z) * per_w);
    let first = view.eyes[eye].first_px;
    let end = view.eyes[eye].end_px;
    let is_there = exists & (w > vec4<f32>(view.near));
    let inside = is_there & (u >= vec4<f32>(first.x)) & (u < vec4<f32>(end.x)) & (v >= vec4<f32>(first.y))
        & (v < vec4<f32>(end.y));
    // Differences of whole numbers are exact.
    let pixel = vec4<u32>(v - first.y) * view.eyes[eye].width + vec4<u32>(u - first.x);
    return Projected(select(vec4<u32>(NO_PIXEL), pixel, inside), u, v, select(vec4<f32>(0.0), w, is_there));
}

// Coordinates in 30-bit cells of the turn at a place. Bits that are not read are set to half, the center of the coarser cell.
fn cells_of(at: u32, planes: u32) -> Cells {
    let hi = hi_of(at);
    let mask = vec4<u32>(PLANE_MASK);
    let coarse_center = vec4<u32>(COARSE_CENTER);
    var x = ((hi & mask) << vec4<u32>(COARSE_SHIFT)) | coarse_center;
    var y = (((hi >> vec4<u32>(Y_SHIFT)) & mask) << vec4<u32>(COARSE_SHIFT)) | coarse_center;
    // The bits of z are in place already, below the spacing exponent.
    var z = (hi & vec4<u32>(PLANE_MASK << Z_SHIFT)) | coarse_center;
    if planes >= MIDDLE_PLANES {
        let mid = mid_of(at);
        let coarse = vec4<u32>(COARSE_MASK);
        let shift = vec4<u32>(MIDDLE_SHIFT);
        let center = vec4<u32>(MIDDLE_CENTER);
        x = (x & coarse) | ((mid & mask) << shift) | center;
        y = (y & coarse) | (((mid >> vec4<u32>(Y_SHIFT)) & mask) << shift) | center;
        z = (z & coarse) | ((mid >> vec4<u32>(Z_SHIFT)) << shift) | center;
    }
    if planes == ALL_PLANES {
        let lo = lo_of(at);
        let above = vec4<u32>(MIDDLE_MASK);
        x = (x & above) | (lo & mask);
        y = (y & above) | ((lo >> vec4<u32>(Y_SHIFT)) & mask);
        z = (z & above) | (lo >> vec4<u32>(Z_SHIFT));
    }
    return Cells(x, y, z);
}

// The points of a turn of a batch.
fn points_of(batch: VisibleBatch, turn: u32) -> Turn {
    let at = batch.first_point / POINTS_PER_TURN + turn;
    let cells = cells_of(at, batch.flags & VISIBLE_PLANES);
    // The integer difference is exact: see VisibleBatch.
    let x = vec4<f32>(vec4<i32>(cells.x) - batch.head_cell.x) * batch.cell.x + batch.offset.x;
    let y = vec4<f32>(vec4<i32>(cells.y) - batch.head_cell.y) * batch.cell.y + batch.offset.y;
    let z = vec4<f32>(vec4<i32>(cells.z) - batch.head_cell.z) * batch.cell.z + batch.offset.z;

    let number = vec4<u32>(turn * POINTS_PER_TURN) + vec4<u32>(0u, 1u, 2u, 3u);
    let rank = reverseBits(number);
    var exists = number < vec4<u32>(batch.num_points);
    if batch.drawn != DRAWN_WHOLE {
        exists = exists & (rank < vec4<u32>(batch.drawn));
    }
    // The octant tells the child that the color and the spacing depend on.
    let octant = (cells.x >> vec4<u32>(OCTANT_SHIFT)) | ((cells.y >> vec4<u32>(OCTANT_SHIFT)) << vec4<u32>(1u))
        | ((cells.z >> vec4<u32>(OCTANT_SHIFT)) << vec4<u32>(2u));
    var id = (vec4<u32>(batch.first_point) + number) << vec4<u32>(ID_SHIFT);
    if (batch.own.x & batch.own.y) != OWN_NONE_WORD {
        let word = select(vec4<u32>(batch.own.x), vec4<u32>(batch.own.y), octant >= vec4<u32>(OWN_PER_WORD));
        let place = (octant & vec4<u32>(OWN_PER_WORD - 1u)) * OWN_BITS;
        let own = (word >> place) & vec4<u32>(OWN_NONE);
        let is_filtered = (own != vec4<u32>(OWN_NONE)) & ((rank >> vec4<u32>(OWN_SHIFT)) >= own);
        id |= select(vec4<u32>(0u), vec4<u32>(ID_ODD), is_filtered);
    }
    return Turn(at, octant, x, y, z, id, exists);
}
