// What the steps of `resolve` share: a workgroup a tile of which somebody sees a part.

/// x | y≪16.
@group(0) @binding(15) var<storage, read> tiles: array<u32>;

// The first pixel of the workgroup's tile. Where workgroups come in several rows there may be a few too many: they
// do the last tile again.
fn first_pixel(group: vec3<u32>, groups: vec3<u32>) -> vec2<u32> {
    let tile = tiles[min(group.y * groups.x + group.x, arrayLength(&tiles) - 1u)];
    return vec2<u32>(tile & 0xffffu, tile >> 16u) * TILE_PX;
}
