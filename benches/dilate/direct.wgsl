// The rule of dilation over the whole square window at once, straight from global memory: what `dilate` is timed
// against.

fn weight(x: u32, y: u32, center: vec2<u32>) -> u32 {
    let distance = max(x, center.x) - min(x, center.x) + max(y, center.y) - min(y, center.y);
    return 1u << (DILATE_FALLOFF_BITS * (2u * DILATE_REACH_PX - distance));
}

@compute @workgroup_size(16, 16)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let width = view.eyes[dilate.eye].width;
    let height = view.eyes[dilate.eye].height;
    if id.x >= width || id.y >= height {
        return;
    }
    let radius = radius_px(view.eyes[dilate.eye], i32(id.x), i32(id.y));
    let first = vec2<u32>(max(id.x, radius) - radius, max(id.y, radius) - radius);
    let last = vec2<u32>(min(id.x + radius, width - 1u), min(id.y + radius, height - 1u));

    var nearest = EMPTY_DEPTH;
    for (var y = first.y; y <= last.y; y += 1u) {
        for (var x = first.x; x <= last.x; x += 1u) {
            nearest = min(nearest, surface[y * width + x].x);
        }
    }
    let own = surface[id.y * width + id.x];
    let end = surface_end(vec4<u32>(nearest)).x;
    if nearest == EMPTY_DEPTH || own.x <= end {
        into_image(id.xy, own.x, own.y, false);
        return;
    }
    var sums = vec3<u32>(0u);
    var weights = 0u;
    for (var y = first.y; y <= last.y; y += 1u) {
        for (var x = first.x; x <= last.x; x += 1u) {
            let neighbour = surface[y * width + x];
            if neighbour.x <= end {
                let w = weight(x, y, id.xy);
                sums += w * (vec3<u32>(neighbour.y, neighbour.y >> 8u, neighbour.y >> 16u) & vec3<u32>(0xffu));
                weights += w;
            }
        }
    }
    let color = (sums + weights / 2u) / weights;
    into_image(id.xy, nearest, color.r | color.g << 8u | color.b << 16u, false);
}
