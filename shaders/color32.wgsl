// color for GPUs without 64-bit addition: sums in four u32, equal to the others. docs/FRAME.md §7.

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    if counts(eye, pixel, w) {
        add_wide(eye, pixel, color_of(id));
    }
}
