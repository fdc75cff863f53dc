// Means of color channels.

// (sum + count / 2) / count, rounded down, of count < MAX_MEAN_COUNT channels of at most 255. A division of floats may
// be wrong by 2.5 units in the last place [Vulkan, precision of OpFDiv]: below 256 by 4e-5. With half a unit added
// to the dividend, quotients lie at least 0.5 / count from every integer, which is more. GPUs have no division of
// integers, which takes twenty instructions and more.
fn mean(sum: vec4<u32>, count: vec4<u32>) -> vec4<u32> {
    return vec4<u32>((vec4<f32>(sum + count / vec4<u32>(2u)) + 0.5) / vec4<f32>(count));
}
