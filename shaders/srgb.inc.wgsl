// sRGB and linear light; see base::srgb.

// A stored color as linear light: an sRGB target encodes it back to what was stored.
fn linear_from_srgb(c: vec3<f32>) -> vec3<f32> {
    let curved = pow((c + SRGB_SHIFT) / SRGB_STRETCH, vec3<f32>(SRGB_POWER));
    return select(curved, c / SRGB_SLOPE, c <= vec3<f32>(SRGB_STRAIGHT));
}

// Linear light as a target stores it that does not encode.
fn srgb_from_linear(linear: vec3<f32>) -> vec3<f32> {
    let curved = SRGB_STRETCH * pow(linear, vec3<f32>(1.0 / SRGB_POWER)) - SRGB_SHIFT;
    return select(curved, SRGB_SLOPE * linear, linear <= vec3<f32>(LINEAR_STRAIGHT));
}
