// resolve, first step of `point-list`: shows the points that the hardware left in its image.

@group(0) @binding(2) var points: texture_2d<u32>;

fn finish(pixel: u32) {
    let key = textureLoad(points, vec2<u32>(pixel % guarded(resolve.size_px).x, pixel / guarded(resolve.size_px).x), 0);
    show(pixel, key.y, key.x);
}
