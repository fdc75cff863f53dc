// Colors of discs: the mean of their points. Odd ids are of triangles, whose color is that of the corners by their
// shares of the pixel that is being put.

fn rgb_of(point: u32) -> vec3<f32> {
    let color = colors[point];
    return vec3<f32>((vec3<u32>(color) >> vec3<u32>(0u, GREEN_SHIFT, BLUE_SHIFT)) & vec3<u32>(CHANNEL_MASK));
}

fn color_of(id: u32) -> u32 {
    if (id & ID_ODD) == 0u {
        return colors[id >> ID_SHIFT];
    }
    let mixed = mixed_shares.x * rgb_of(mixed_points.x) + mixed_shares.y * rgb_of(mixed_points.y)
        + mixed_shares.z * rgb_of(mixed_points.z);
    let rgb = vec3<u32>(mixed + 0.5);
    return rgb.r | (rgb.g << GREEN_SHIFT) | (rgb.b << BLUE_SHIFT) | OPAQUE;
}
