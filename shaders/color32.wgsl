// color for GPUs without 64-bit addition: the same sums in four u32. frame.md section 7.

fn put_left(pixel: u32, w: f32, id: u32) {
    if counts(w, depth_left[pixel]) {
        add_wide_left(pixel, color_of(id));
    }
}

fn put_right(pixel: u32, w: f32, id: u32) {
    if counts(w, depth_right[pixel]) {
        add_wide_right(pixel, color_of(id));
    }
}
