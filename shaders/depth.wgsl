// depth: the nearest point of each pixel, for both eyes in one dispatch. A workgroup a visible batch, a thread
// POINTS_PER_LOAD points at a time. [2022 §3.2 to 3.4]
//
// A pixel holds depth ≪ 32 | point index; depth is linear w, whose IEEE bits order like the number itself.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<storage, read> visible: array<VisibleBatch>;
@group(0) @binding(2) var<storage, read> plane_hi: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> plane_mid: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> plane_lo: array<vec4<u32>>;
@group(0) @binding(5) var<uniform> chunk: ChunkUniform;
@group(0) @binding(6) var<storage, read_write> depth_left: array<atomic<u64>>;
@group(0) @binding(7) var<storage, read_write> depth_right: array<atomic<u64>>;

const MASK: u32 = (1u << PLANE_BITS) - 1u;

// Points inside the eye's image have a pixel number; the others NO_PIXEL.
const NO_PIXEL: u32 = 0xffffffffu;

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

fn key_of(w: f32, index: u32) -> u64 {
    return (u64(bitcast<u32>(w)) << 32u) | u64(index);
}

// Early-z: a plain look first, since most points lie behind one that is already there. [2022 §3.2]
fn draw_left(pixel: u32, w: f32, index: u32) {
    let key = key_of(w, index);
    if pixel != NO_PIXEL && key < atomicLoad(&depth_left[pixel]) {
        atomicMin(&depth_left[pixel], key);
    }
}

fn draw_right(pixel: u32, w: f32, index: u32) {
    let key = key_of(w, index);
    if pixel != NO_PIXEL && key < atomicLoad(&depth_right[pixel]) {
        atomicMin(&depth_right[pixel], key);
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let batch = visible[group.x];
    let planes = batch.flags & 3u;
    let first_load = batch.first_point / POINTS_PER_LOAD;
    let num_loads = (batch.num_points + POINTS_PER_LOAD - 1u) / POINTS_PER_LOAD;

    for (var load = thread; load < num_loads; load += WORKGROUP_SIZE) {
        let hi = plane_hi[first_load + load];
        // Bits that are not read stand at half: the centre of the coarser cell.
        var x = ((hi & vec4<u32>(MASK)) << vec4<u32>(20u)) | vec4<u32>(0x80000u);
        var y = (((hi >> vec4<u32>(10u)) & vec4<u32>(MASK)) << vec4<u32>(20u)) | vec4<u32>(0x80000u);
        var z = ((hi >> vec4<u32>(20u)) << vec4<u32>(20u)) | vec4<u32>(0x80000u);
        if planes >= 2u {
            let mid = plane_mid[first_load + load];
            x = (x & vec4<u32>(0xfff00000u)) | ((mid & vec4<u32>(MASK)) << vec4<u32>(10u)) | vec4<u32>(0x200u);
            y = (y & vec4<u32>(0xfff00000u)) | (((mid >> vec4<u32>(10u)) & vec4<u32>(MASK)) << vec4<u32>(10u)) | vec4<u32>(0x200u);
            z = (z & vec4<u32>(0xfff00000u)) | ((mid >> vec4<u32>(20u)) << vec4<u32>(10u)) | vec4<u32>(0x200u);
        }
        if planes == 3u {
            let lo = plane_lo[first_load + load];
            x = (x & vec4<u32>(0xfffffc00u)) | (lo & vec4<u32>(MASK));
            y = (y & vec4<u32>(0xfffffc00u)) | ((lo >> vec4<u32>(10u)) & vec4<u32>(MASK));
            z = (z & vec4<u32>(0xfffffc00u)) | (lo >> vec4<u32>(20u));
        }
        // The integer difference is exact: see VisibleBatch.
        let px = vec4<f32>(vec4<i32>(x) - batch.head_cell.x) * batch.cell.x + batch.offset.x;
        let py = vec4<f32>(vec4<i32>(y) - batch.head_cell.y) * batch.cell.y + batch.offset.y;
        let pz = vec4<f32>(vec4<i32>(z) - batch.head_cell.z) * batch.cell.z + batch.offset.z;

        let first = load * POINTS_PER_LOAD;
        let exists = vec4<u32>(first) + vec4<u32>(0u, 1u, 2u, 3u) < vec4<u32>(batch.num_points);
        let index = chunk.first_index + batch.first_point + first;
        if (batch.flags & 16u) != 0u {
            let p = project(0u, px, py, pz, exists);
            draw_left(p.pixel.x, p.w.x, index);
            draw_left(p.pixel.y, p.w.y, index + 1u);
            draw_left(p.pixel.z, p.w.z, index + 2u);
            draw_left(p.pixel.w, p.w.w, index + 3u);
        }
        if NUM_EYES == 2u && (batch.flags & 32u) != 0u {
            let p = project(1u, px, py, pz, exists);
            draw_right(p.pixel.x, p.w.x, index);
            draw_right(p.pixel.y, p.w.y, index + 1u);
            draw_right(p.pixel.z, p.w.z, index + 2u);
            draw_right(p.pixel.w, p.w.w, index + 3u);
        }
    }
}
