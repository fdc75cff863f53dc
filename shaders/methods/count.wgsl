// count: early-z, and how many points asked for their pixel: what the papers' tables call drawn. For measuring.
// [2022, table 2]

@group(0) @binding(8) var<storage, read_write> asked_left: array<atomic<u32>>;
@group(0) @binding(9) var<storage, read_write> asked_right: array<atomic<u32>>;

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    let key = key_of(w, id);
    if key < key_in(eye, pixel) {
        min_key(eye, pixel, key);
        if eye == 0u {
            atomicAdd(&asked_left[pixel], 1u);
        } else {
            atomicAdd(&asked_right[pixel], 1u);
        }
    }
}
