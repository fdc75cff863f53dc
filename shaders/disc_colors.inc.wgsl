// Colors of discs: the mean of what they stand for. Odd ids are of triangles: the corners' colors by their shares of the
// pixel that is being put.

fn rgb_of(point: u32) -> vec3<f32> {
    let color = colors[point];
    return vec3<f32>((vec3<u32>(color) >> vec3<u32>(0u, 8u, 16u)) & vec3<u32>(255u));
}

fn color_of(id: u32) -> u32 {
    if (id & 1u) == 0u {
        return colors[id >> 1u];
    }
    let mixed = mixed_shares.x * rgb_of(mixed_points.x) + mixed_shares.y * rgb_of(mixed_points.y)
        + mixed_shares.z * rgb_of(mixed_points.z);
    let rgb = vec3<u32>(mixed + 0.5);
    return rgb.r | (rgb.g << 8u) | (rgb.b << 16u) | 0xff000000u;
}
