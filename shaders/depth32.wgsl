// depth, `hqs` quality and the tier without 64-bit atomics: the nearest depth of each pixel.

@group(0) @binding(6) var<storage, read_write> depth_left: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> depth_right: array<atomic<u32>>;

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    let depth = bitcast<u32>(w);
    if eye == 0u {
        if depth < atomicLoad(&depth_left[pixel]) {
            atomicMin(&depth_left[pixel], depth);
        }
    } else if depth < atomicLoad(&depth_right[pixel]) {
        atomicMin(&depth_right[pixel], depth);
    }
}
