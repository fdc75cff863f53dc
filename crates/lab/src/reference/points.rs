//! CPU reference of `points.inc.wgsl`: every point of the visible batches, in every pixel that it covers.

use super::cull::shares;
use super::rings::ring;
use super::tree::triangles::{Mixture, triangles};
use super::tree::{ChosenDisc, Tree};
use crate::technique::tree::VISIBLE_TRIANGLES;
use render::layout::{
    CELLS, COARSE_CENTER, COARSE_PLANES, COARSE_SHIFT, DRAWN_WHOLE, EyeUniform, FADE_BEGIN, FADE_END,
    FILL_OVERLAP, ID_ODD, ID_SHIFT, LOD_FADE, MAX_FILL_RADIUS, MIDDLE_CENTER, MIDDLE_PLANES, MIDDLE_SHIFT,
    OCTANT_SHIFT, OWN_BITS, OWN_NONE, OWN_PER_WORD, OWN_SHIFT, PLANE_BITS, PLANE_MASK, POINTS_COVER,
    REACH_MASK, SAMPLES_BELOW, SAMPLES_COVER, SPACING_EXPONENT_SHIFT, VISIBLE_BY_EYE, VISIBLE_FILL,
    VISIBLE_PLANES, ViewUniform, VisibleBatch,
};

/// A point in a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Put {
    /// 0 left, 1 right.
    pub eye: usize,
    /// Number of the pixel, row by row, in the image with its guard band.
    pub pixel: usize,
    /// Linear depth.
    pub w: f32,
    /// Twice the point's number, plus one if its filtered color is shown or if it is of a triangle.
    pub id: u32,
    /// Mixture of the corners' colors, if it is of a triangle.
    pub mixture: Option<Mixture>,
}

/// Hands every point in every pixel to `put`. `planes` are the chunk's. Points of a `tree` are discs, or corners of
/// triangles. With `fill`, a point may cover several pixels.
pub fn points(
    view: &ViewUniform,
    num_eyes: usize,
    visible: &[VisibleBatch],
    planes: [&[u32]; 3],
    tree: Option<&Tree>,
    fill: bool,
    put: &mut dyn FnMut(Put),
) {
    for batch in visible {
        // The first slice stands for all slices of its batch.
        if !batch.is_first_slice() {
            continue;
        }
        if let Some(tree) = tree.filter(|_| batch.flags & VISIBLE_TRIANGLES != 0) {
            triangles(view, num_eyes, batch, planes, tree, put);
            continue;
        }
        for i in 0..batch.num_points {
            let rank = i.reverse_bits();
            if batch.drawn != DRAWN_WHOLE && rank >= batch.drawn {
                continue;
            }
            let index = batch.first_point + i;
            let words = planes.map(|p| p[index as usize]);
            let cells = cells(batch.flags & VISIBLE_PLANES, words);
            let p_in_head = p_in_head(batch, cells);
            let [x, y, z] = cells.map(|cell| cell as u32 >> OCTANT_SHIFT);
            let octant = x | y << 1 | z << 2;
            let own = batch.own[(octant / OWN_PER_WORD) as usize] >> (OWN_BITS * (octant % OWN_PER_WORD))
                & OWN_NONE;
            let is_filtered = own != OWN_NONE && rank >> OWN_SHIFT >= own;
            let id = index << ID_SHIFT | if is_filtered { ID_ODD } else { 0 };
            let disc = tree.map(|tree| (tree, ChosenDisc::of(tree, index)));
            let edge = CELLS * batch.cell[0].max(batch.cell[1].max(batch.cell[2]));
            let step = batch.spacing_step;
            let powers = [1.0, step, step * step, step * step * step];
            let power = powers[(words[0] >> SPACING_EXPONENT_SHIFT) as usize];
            let spacing = edge * shares(batch.spacing)[octant as usize] * power;
            let apart = match disc {
                Some((_, disc)) => Distance::Discs(disc.diameter),
                None => Distance::Points(spacing),
            };
            for (eye, uniform) in view.eyes[..num_eyes].iter().enumerate() {
                let is_chosen = disc.is_none_or(|(tree, disc)| disc.is_chosen(view, tree, eye, p_in_head));
                if batch.flags & VISIBLE_BY_EYE << eye == 0 || !is_chosen {
                    continue;
                }
                let Some((at, w)) = project(uniform, view.near, p_in_head) else { continue };
                if fill && batch.flags & VISIBLE_FILL != 0 {
                    let open_px = open_px(view, uniform, batch, p_in_head, w, apart);
                    let w = f32::from_bits(w.to_bits() | reach(view, open_px));
                    pixels_round(uniform, at, radius(view, open_px), &mut |pixel| {
                        put(Put { eye, pixel, w, id, mixture: None });
                    });
                } else if let Some(pixel) = pixel_at(uniform, at) {
                    put(Put { eye, pixel, w, id, mixture: None });
                }
            }
        }
    }
}

/// Edge of the finest nodes that are drawn whole around a point whose node has this edge. It is shorter while the nodes
/// below them fade in.
fn open_edge_px(view: &ViewUniform, edge_px: f32, undivided_px: f32) -> f32 {
    let mut whole_px = if edge_px <= 0.5 * undivided_px { 2.0 * edge_px } else { edge_px };
    while whole_px > undivided_px {
        whole_px *= 0.5;
    }
    if view.flags & LOD_FADE == 0 {
        return whole_px;
    }
    let below = FADE_END * whole_px / undivided_px;
    let share = ((below - FADE_BEGIN) / (FADE_END - FADE_BEGIN)).clamp(0.0, 1.0);
    whole_px / (1.0 + (SAMPLES_BELOW - 1.0) * share).sqrt()
}

/// Reach of the narrowest kernel that closes a square of this width.
fn reach(view: &ViewUniform, open_px: f32) -> u32 {
    1 + view.fill_reach_px[..2].iter().filter(|&&px| open_px > px).count() as u32
}

/// Radius in pixels of a splat around its own pixel.
pub(super) fn radius(view: &ViewUniform, open_px: f32) -> f32 {
    (0.5 * (open_px - view.fill_reach_px[2])).clamp(0.0, MAX_FILL_RADIUS as f32).ceil()
}

/// Width in pixels of the square that a point has to close.
fn open_px(
    view: &ViewUniform,
    eye: &EyeUniform,
    batch: &VisibleBatch,
    p_in_head: [f32; 3],
    w: f32,
    apart: Distance,
) -> f32 {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let from_eye: [f32; 3] = std::array::from_fn(|i| p_in_head[i] - eye.eye_in_head[i]);
    let distance_sq = dot(from_eye, from_eye);
    let ring = ring(view, dot(from_eye, eye.gaze_in_head), distance_sq);
    let per_w = 1.0 / w;
    let px_per_unit = eye.pixels_per_radian * per_w;
    let stretch = distance_sq.sqrt() * per_w;
    let edge = CELLS * batch.cell[0].max(batch.cell[1].max(batch.cell[2]));
    let edge_px = open_edge_px(view, edge * px_per_unit, view.undivided_px[ring]);
    let samples_px = batch.sample_spacing * edge_px * stretch;
    let samples_px = (SAMPLES_COVER * samples_px).min((FILL_OVERLAP * samples_px).max(view.fill_reach_px[2]));
    let apart_px = apart.length() * px_per_unit * stretch;
    let cover_px = match apart {
        Distance::Points(_) => {
            (POINTS_COVER * apart_px).min(FILL_OVERLAP * apart_px + view.fill_reach_px[ring])
        }
        Distance::Discs(_) => apart_px,
    };
    cover_px.max(samples_px)
}

/// Distance between the points or discs that are drawn, in world units.
#[derive(Clone, Copy)]
enum Distance {
    /// Distance of points of flat clouds and of an octree's nodes.
    Points(f32),
    /// Diameter of discs of a sequential point tree, which is also their distance.
    Discs(f32),
}

impl Distance {
    fn length(self) -> f32 {
        match self {
            Self::Points(length) | Self::Discs(length) => length,
        }
    }
}

/// Hands the pixels of a splat around the pixel at these coordinates to `each`, cut at the image's edges.
fn pixels_round(eye: &EyeUniform, at: [f32; 2], radius: f32, each: &mut dyn FnMut(usize)) {
    let size = [eye.width as f32, eye.height as f32];
    let center: [f32; 2] = std::array::from_fn(|i| at[i] - eye.first_px[i]);
    let first: [i32; 2] = std::array::from_fn(|i| (center[i] - radius).clamp(0.0, size[i]) as i32);
    let last: [i32; 2] = std::array::from_fn(|i| (center[i] + radius).clamp(-1.0, size[i] - 1.0) as i32);
    let (center, radius) = (center.map(|px| px as i32), radius as i32);
    for v in first[1]..=last[1] {
        for u in first[0]..=last[0] {
            let (dx, dy) = (u - center[0], v - center[1]);
            if dx * dx + dy * dy <= radius * (radius + 1) {
                each((v * eye.width as i32 + u) as usize);
            }
        }
    }
}

/// Cell numbers from the planes that are read; bits that are not read stand at the middle of their range.
#[must_use]
pub fn cells(num_planes: u32, [hi, mid, lo]: [u32; 3]) -> [i32; 3] {
    std::array::from_fn(|axis| {
        let part = |plane: u32| plane >> (PLANE_BITS * axis as u32) & PLANE_MASK;
        let cell = match num_planes {
            COARSE_PLANES => part(hi) << COARSE_SHIFT | COARSE_CENTER,
            MIDDLE_PLANES => part(hi) << COARSE_SHIFT | part(mid) << MIDDLE_SHIFT | MIDDLE_CENTER,
            _ => part(hi) << COARSE_SHIFT | part(mid) << MIDDLE_SHIFT | part(lo),
        };
        cell as i32
    })
}

/// Position of a cell in head space.
#[must_use]
pub fn p_in_head(batch: &VisibleBatch, cells: [i32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| (cells[i] - batch.head_cell[i]) as f32 * batch.cell[i] + batch.offset[i])
}

/// Whole pixel coordinates and linear depth of a point, in the image or outside; `None` if it is too near.
fn project(eye: &EyeUniform, near: f32, [x, y, z]: [f32; 3]) -> Option<([f32; 2], f32)> {
    let row = |r: [f32; 4]| r[0] * x + r[1] * y + r[2] * z + r[3];
    let w = row(eye.row_w);
    let per_w = 1.0 / w;
    let at = [(row(eye.row_x) * per_w).floor(), (row(eye.row_y) * per_w).floor()];
    let w = without_reach(w);
    (w > near).then_some((at, w))
}

/// The depth with the bits of [`REACH_MASK`] cleared.
#[must_use]
pub fn without_reach(w: f32) -> f32 {
    f32::from_bits(w.to_bits() & !REACH_MASK)
}

/// Number of the pixel at these coordinates, if it is of the image or its guard band.
fn pixel_at(eye: &EyeUniform, at: [f32; 2]) -> Option<usize> {
    let inside = (0..2).all(|i| at[i] >= eye.first_px[i] && at[i] < eye.end_px[i]);
    let [x, y] = [0, 1].map(|i: usize| (at[i] - eye.first_px[i]) as usize);
    inside.then(|| y * eye.width as usize + x)
}
