// The stage `scenery`: what is seen beside the scan. The surround fills pixels without a point: a gradient from the
// ground over the horizon to the sky, and a grid on the floor. Shapes stand in the stage: cards, rays, rings, hands. The
// vignette darkens the edge of sight while the viewer is moved.

struct SceneryUniform {
    clip_from_stage: mat4x4<f32>,
    ray: vec3<f32>,
    has_points: u32,
    ray_right: vec3<f32>,
    units_per_m: f32,
    ray_down: vec3<f32>,
    vignette: f32,
    ahead: vec3<f32>,
    pitch_px: u32,
    eye_in_grid: vec3<f32>,
    has_surround: u32,
    sky: vec3<f32>,
    has_grid: u32,
    horizon: vec3<f32>,
    reserved: u32,
    ground: vec3<f32>,
    reserved_ground: u32,
    line: vec3<f32>,
    reserved_end: u32,
}

@group(0) @binding(0) var<uniform> scenery: SceneryUniform;
// Depths of the finished pixels.
@group(0) @binding(1) var<storage, read> image_depth: array<u32>;
@group(0) @binding(2) var card: texture_2d<f32>;
@group(0) @binding(3) var card_sampler: sampler;

// The bits of the nearest point's depth at a place in the image.
fn depth_at(position: vec4<f32>) -> u32 {
    if scenery.has_points == 0u {
        return EMPTY_DEPTH;
    }
    return image_depth[u32(position.y) * scenery.pitch_px + u32(position.x)];
}

// The direction through a place in the image.
fn ray_at(px: vec2<f32>) -> vec3<f32> {
    return scenery.ray + scenery.ray_right * px.x + scenery.ray_down * px.y;
}

// How much of a pixel, `width` wide along an axis at `at`, lines of that half width at whole multiples of `cell` cover.
fn covered(at: f32, width: f32, cell: f32, half_line: f32) -> f32 {
    let low = (at - 0.5 * width + half_line) / cell;
    let high = (at + 0.5 * width + half_line) / cell;
    let line = 2.0 * half_line / cell;
    let below_low = floor(low) * line + min(fract(low), line);
    let below_high = floor(high) * line + min(fract(high), line);
    return (below_high - below_low) / max(high - low, GRID_LEAST_CELLS);
}

fn lines(at: vec2<f32>, width: vec2<f32>, cell: f32, half_line: f32) -> f32 {
    let across = covered(at.x, width.x, cell, half_line);
    let along = covered(at.y, width.y, cell, half_line);
    return across + along - across * along;
}

// How strongly the grid is seen in the direction `ray`, through the middle of a pixel.
fn grid(ray: vec3<f32>) -> f32 {
    let eye = scenery.eye_in_grid;
    // The floor is in sight from above and from below.
    let far = -eye.y / ray.y;
    if far <= 0.0 {
        return 0.0;
    }
    let at = eye.xz + far * ray.xz;
    let right = far * (scenery.ray_right.xz - ray.xz * (scenery.ray_right.y / ray.y));
    let down = far * (scenery.ray_down.xz - ray.xz * (scenery.ray_down.y / ray.y));
    let width = max(abs(right) + abs(down), vec2<f32>(GRID_LEAST_WIDTH_M));
    let distance = length(far * ray);
    let narrow = lines(at, width, GRID_CELL_M, GRID_LINE_M);
    let seen = max(GRID_LINE_ALPHA * narrow, lines(at, width, GRID_WIDE_CELL_M, GRID_WIDE_LINE_M));
    return seen * exp(-distance / GRID_REACH_M);
}

// The surround in the direction `ray`.
fn surround_at(ray: vec3<f32>) -> vec3<f32> {
    let up = ray.y / length(ray);
    let end = select(scenery.ground, scenery.sky, up > 0.0);
    var color = mix(scenery.horizon, end, 1.0 - exp(-HORIZON_FALLOFF * abs(up)));
    if scenery.has_grid != 0u {
        color = mix(color, scenery.line, grid(ray));
    }
    return color;
}

@vertex
fn whole(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers the image.
    return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn surround(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    if scenery.has_surround == 0u || depth_at(position) != EMPTY_DEPTH {
        discard;
    }
    return vec4<f32>(surround_at(ray_at(position.xy)), 1.0);
}

@fragment
fn vignette(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let ray = ray_at(position.xy);
    let from_ahead = dot(ray, scenery.ahead) / length(ray);
    let begin = mix(VIGNETTE_WIDE_COS, VIGNETTE_NARROW_COS, scenery.vignette);
    let dark = 1.0 - smoothstep(begin - VIGNETTE_EDGE_COS, begin, from_ahead);
    return vec4<f32>(0.0, 0.0, 0.0, dark * min(VIGNETTE_RISE * scenery.vignette, 1.0));
}

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) color: vec4<f32>,
    @location(1) depth_m: f32,
    @location(2) on_card: vec2<f32>,
}

@vertex
fn corner(
    @location(0) p_in_stage: vec3<f32>,
    @location(1) on_card: vec2<f32>,
    @location(2) color: vec4<f32>,
) -> Corner {
    let position = scenery.clip_from_stage * vec4<f32>(p_in_stage, 1.0);
    return Corner(position, color, position.w, on_card);
}

// The card's color: four places in a pixel, since it may be drawn at half its size.
fn card_at(at: vec2<f32>) -> vec3<f32> {
    let right = CARD_STEP * dpdx(at);
    let down = CARD_STEP * dpdy(at);
    var sum = textureSampleLevel(card, card_sampler, at + right + CARD_TURN * down, 0.0).rgb;
    sum += textureSampleLevel(card, card_sampler, at - right - CARD_TURN * down, 0.0).rgb;
    sum += textureSampleLevel(card, card_sampler, at + down - CARD_TURN * right, 0.0).rgb;
    sum += textureSampleLevel(card, card_sampler, at - down + CARD_TURN * right, 0.0).rgb;
    return 0.25 * sum;
}

@fragment
fn shape(corner: Corner) -> @location(0) vec4<f32> {
    let nearest = depth_at(corner.position);
    let depth = corner.depth_m * scenery.units_per_m;
    let is_behind = nearest != EMPTY_DEPTH && depth > SURFACE_TOLERANCE * bitcast<f32>(nearest);
    let on_card = card_at(corner.on_card);
    let is_card = corner.on_card.x >= 0.0;
    let color = select(corner.color.rgb, corner.color.rgb * on_card, is_card);
    // A shape that is no card has its own strength there.
    let behind = select(corner.on_card.y, CARD_BEHIND_ALPHA, is_card);
    return vec4<f32>(color, corner.color.a * select(1.0, behind, is_behind));
}
