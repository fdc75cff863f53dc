// What the steps of `resolve` share: a workgroup for each tile of which somebody sees a part.

/// Column | row≪16 of each tile, and TILE_HIDES if lenses hide some of its pixels.
@group(0) @binding(15) var<storage, read> tiles: array<u32>;

// The workgroup's tile. If workgroups come in several rows there may be a few too many, which do the last tile again.
fn tile_of(group: vec3<u32>, groups: vec3<u32>) -> u32 {
    return tiles[min(group.y * groups.x + group.x, arrayLength(&tiles) - 1u)];
}

fn first_pixel(tile: u32) -> vec2<u32> {
    return vec2<u32>(tile & TILE_COLUMN_MASK, (tile & ~TILE_HIDES) >> TILE_ROW_SHIFT) * TILE_PX;
}

fn hides(tile: u32) -> bool {
    return (tile & TILE_HIDES) != 0u;
}
