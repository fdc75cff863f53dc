// The picture while there is no scan: rectangles of one brightness each, laid out by the host.

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) brightness: f32,
}

@vertex
fn vertex(@location(0) position: vec4f, @location(1) brightness: f32) -> Corner {
    return Corner(position, brightness);
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4f {
    return vec4f(vec3f(corner.brightness), 1.0);
}
