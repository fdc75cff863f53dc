// Functions that count. Each takes the place of the function of its name, where a shader has one, which is called
// `uncounted_` and its name there.

fn key_in(eye: u32, pixel: u32) -> Key {
    count_read();
    return uncounted_key_in(eye, pixel);
}

fn plain_depth_in(eye: u32, pixel: u32) -> u32 {
    count_read();
    return uncounted_plain_depth_in(eye, pixel);
}

fn depth_in(eye: u32, pixel: u32) -> u32 {
    count_read();
    return uncounted_depth_in(eye, pixel);
}

fn min_key(eye: u32, pixel: u32, key: Key) {
    count_ask();
    uncounted_min_key(eye, pixel, key);
}

fn set_key(eye: u32, pixel: u32, key: u64) {
    count_ask();
    uncounted_set_key(eye, pixel, key);
}

fn exchange_key(eye: u32, pixel: u32, seen: u64, key: u64) -> u64 {
    count_ask();
    return uncounted_exchange_key(eye, pixel, seen, key);
}

fn lock(eye: u32, pixel: u32, seen: u32) -> bool {
    count_ask();
    return uncounted_lock(eye, pixel, seen);
}

fn counts(eye: u32, pixel: u32, w: f32) -> bool {
    count_read();
    let is_near = uncounted_counts(eye, pixel, w);
    if is_near {
        count_color();
    }
    return is_near;
}

fn put_seen(eye: u32, pixel: u32, w: f32, id: u32) {
    uncounted_put_seen(eye, pixel, w, id);
    if !is_in_triangle {
        count_point();
    }
}

fn put_wide(eye: u32, at: vec2<f32>, w: f32, id: u32, radius_px: f32) {
    uncounted_put_wide(eye, at, w, id, radius_px);
    count_point();
}

fn put_share(eye: u32, number: u32) {
    uncounted_put_share(eye, number);
    count_share(number);
}

fn put_waiting(eye: u32) {
    uncounted_put_waiting(eye);
    count_waiting();
}

fn is_chosen(eye: u32, points: Turn) -> vec4<bool> {
    let chosen = uncounted_is_chosen(eye, points);
    let ones = select(vec4<u32>(0u), vec4<u32>(1u), chosen);
    let num_chosen = select(ones.x + ones.y + ones.z + ones.w, ones.x, POINTS_PER_TURN == 1u);
    atomicAdd(&count_bins[this_thread].num_chosen, num_chosen);
    return chosen;
}

fn put_own(eye: u32, t: Triangle, num_pixels: i32) {
    is_in_triangle = true;
    uncounted_put_own(eye, t, num_pixels);
    is_in_triangle = false;
    count_point();
}

fn put_slice(eye: u32, batch: VisibleBatch, number: u32) {
    is_in_triangle = true;
    uncounted_put_slice(eye, batch, number);
    is_in_triangle = false;
    count_once(this_thread == 0u && slice_of(batch) == 0u);
}
