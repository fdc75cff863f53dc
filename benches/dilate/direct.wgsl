// Dilation over the whole square window at once, straight from global memory. `dilate` is timed against it.

fn weight(x: u32, y: u32, center: vec2<u32>) -> u32 {
    let distance = max(x, center.x) - min(x, center.x) + max(y, center.y) - min(y, center.y);
    return 1u << (DILATE_FALLOFF_BITS * (2u * DILATE_REACH_PX - distance));
}

// The depth at a pixel if that pixel reaches `center`, else EMPTY_DEPTH.
fn reaching(pixel: vec2<u32>, center: vec2<u32>) -> u32 {
    let eye = view.eyes[dilate.eye];
    let w = surface[pixel.y * eye.width + pixel.x].x;
    let reach = max(w & REACH_MASK, radius_px(eye, i32(pixel.x), i32(pixel.y)));
    let distance = max(pixel, center) - min(pixel, center);
    return select(EMPTY_DEPTH, (w & ~REACH_MASK) | reach, max(distance.x, distance.y) <= reach);
}

@compute @workgroup_size(16, 16)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let width = view.eyes[dilate.eye].width;
    let height = view.eyes[dilate.eye].height;
    if id.x >= width || id.y >= height {
        return;
    }
    let reach = DILATE_REACH_PX;
    let first = vec2<u32>(max(id.x, reach) - reach, max(id.y, reach) - reach);
    let last = vec2<u32>(min(id.x + reach, width - 1u), min(id.y + reach, height - 1u));

    var nearest = EMPTY_DEPTH;
    for (var y = first.y; y <= last.y; y += 1u) {
        for (var x = first.x; x <= last.x; x += 1u) {
            nearest = min(nearest, reaching(vec2(x, y), id.xy));
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
            if reaching(vec2(x, y), id.xy) <= end {
                let w = weight(x, y, id.xy);
                let color = surface[y * width + x].y;
                sums += w * (vec3<u32>(color, color >> GREEN_SHIFT, color >> BLUE_SHIFT) & vec3<u32>(CHANNEL_MASK));
                weights += w;
            }
        }
    }
    let color = (sums + weights / 2u) / weights;
    into_image(id.xy, nearest & ~REACH_MASK, color.r | color.g << GREEN_SHIFT | color.b << BLUE_SHIFT, false);
}
