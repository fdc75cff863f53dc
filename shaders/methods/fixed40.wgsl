// fixed40: depth in 40 bits, from f64, and color in 24 below it. The smaller color stays if depths are equal.
// [2019 §2.1] A triangle, whose ids are odd beside discs, has the f32 depth that all methods have, and a corner's
// color.

@group(0) @binding(8) var<storage, read> colors: array<u32>;

// The point's depth in f64: from its cells, which are exact, and the head's place among them.
fn exact_depth(eye: u32, point: u32) -> f64 {
    let batch = visible[this_group];
    let cells = cells_of(point, batch.flags & VISIBLE_PLANES);
    let steps = vec3<i32>(vec3<u32>(cells.x.x, cells.y.x, cells.z.x)) - batch.head_cell;
    let x = f64(steps.x) * f64(batch.cell.x) + f64(batch.offset.x);
    let y = f64(steps.y) * f64(batch.cell.y) + f64(batch.offset.y);
    let z = f64(steps.z) * f64(batch.cell.z) + f64(batch.offset.z);
    let row = view.eyes[eye].row_w;
    return f64(row.x) * x + f64(row.y) * y + f64(row.z) * z + f64(row.w);
}

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    let is_triangle = HAS_TRIANGLES && (id & ID_ODD) != 0u;
    var depth = f64(w);
    if !is_triangle {
        depth = exact_depth(eye, id >> ID_SHIFT);
    }
    let color = color_of(select(id, id ^ ID_ODD, is_triangle));
    let key = (depth40_of(depth) << DEPTH40_SHIFT) | u64(color & RGB_MASK);
    if key < key_in(eye, pixel) {
        min_key(eye, pixel, key);
    }
}
