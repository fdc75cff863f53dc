// What both forms of the first step of `resolve` share: one eye, a workgroup a tile that somebody sees. Each form
// writes
//   fn finish(pixel: u32)
// which puts a pixel's depth and color into `surface`.

@group(0) @binding(0) var<uniform> resolve: ResolveUniform;
@group(0) @binding(1) var<storage, read_write> surface: array<vec2<u32>>;

@compute @workgroup_size(TILE_PX.x, TILE_PX.y / PIXELS_PER_THREAD)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    let first = first_pixel(tile_of(group, groups)) + local.xy;
    for (var row = 0u; row < TILE_PX.y; row += TILE_PX.y / PIXELS_PER_THREAD) {
        if first.x < guarded(resolve.size_px).x && first.y + row < guarded(resolve.size_px).y {
            finish((first.y + row) * guarded(resolve.size_px).x + first.x);
        }
    }
}
