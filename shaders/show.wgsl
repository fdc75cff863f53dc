// resolve, last step where gaps stay open: the surface to the image, one eye.

@compute @workgroup_size(TILE_PX.x, TILE_PX.y / PIXELS_PER_THREAD)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    let tile = tile_of(group, groups);
    let first = first_pixel(tile) + local.xy;
    for (var row = 0u; row < TILE_PX.y; row += TILE_PX.y / PIXELS_PER_THREAD) {
        let pixel = first + vec2<u32>(0u, row);
        if all(pixel < guarded(resolve.size_px)) {
            let number = pixel.y * guarded(resolve.size_px).x + pixel.x;
            into_image(pixel, surface_depth(number), surface_color(number), hides(tile));
        }
    }
}
