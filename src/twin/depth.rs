//! Twin of `depth`: the nearest point of each pixel of every eye.

use super::clear::EMPTY;
use crate::layout::{EyeUniform, PLANE_BITS, ViewUniform, VisibleBatch};

/// Draws the visible batches into the eyes' pixels; `planes` are the chunk's, whose first point is number 0.
pub fn depth(view: &ViewUniform, visible: &[VisibleBatch], planes: [&[u32]; 3], pixels: &mut [Vec<u64>]) {
    for batch in visible {
        for i in 0..batch.num_points {
            let index = batch.first_point + i;
            let words = planes.map(|p| p[index as usize]);
            let p_in_head = p_in_head(batch, cells(batch.flags & 3, words));
            for (eye, pixels) in pixels.iter_mut().enumerate() {
                if batch.flags & 16 << eye == 0 {
                    continue;
                }
                if let Some((pixel, w)) = project(&view.eyes[eye], view.near, p_in_head) {
                    let key = u64::from(w.to_bits()) << 32 | u64::from(index);
                    pixels[pixel] = pixels[pixel].min(key);
                }
            }
        }
    }
}

/// Cell numbers from the planes that are read; bits that are not read stand at half.
#[must_use]
pub fn cells(num_planes: u32, [hi, mid, lo]: [u32; 3]) -> [i32; 3] {
    let mask = (1 << PLANE_BITS) - 1;
    std::array::from_fn(|axis| {
        let part = |plane: u32| plane >> (PLANE_BITS * axis as u32) & mask;
        let cell = match num_planes {
            1 => part(hi) << 20 | 0x80000,
            2 => part(hi) << 20 | part(mid) << 10 | 0x200,
            _ => part(hi) << 20 | part(mid) << 10 | part(lo),
        };
        cell as i32
    })
}

/// Position of a cell in head space.
#[must_use]
pub fn p_in_head(batch: &VisibleBatch, cells: [i32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| (cells[i] - batch.head_cell[i]) as f32 * batch.cell[i] + batch.offset[i])
}

/// Pixel number and linear depth of a point, if the eye sees it.
#[must_use]
pub fn project(eye: &EyeUniform, near: f32, [x, y, z]: [f32; 3]) -> Option<(usize, f32)> {
    let row = |r: [f32; 4]| r[0] * x + r[1] * y + r[2] * z + r[3];
    let w = row(eye.row_w);
    let per_w = 1.0 / w;
    let (u, v) = (row(eye.row_x) * per_w, row(eye.row_y) * per_w);
    let inside = w > near && u >= 0.0 && u < eye.size_px[0] && v >= 0.0 && v < eye.size_px[1];
    inside.then(|| (v as usize * eye.width as usize + u as usize, w))
}

/// Linear depth of a pixel; infinite where no point is.
#[must_use]
pub fn depth_of(pixel: u64) -> f32 {
    if pixel == EMPTY { f32::INFINITY } else { f32::from_bits((pixel >> 32) as u32) }
}
