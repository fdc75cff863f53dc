//! CPU reference of `spt/triangles.inc.wgsl`: every triangle of a visible batch, in every pixel that it covers.

use super::{Tree, tolerance};
use crate::reference::points::{Put, cells, p_in_head, without_reach};
use crate::technique::tree::TRIANGLE_SLACK_PX;
use render::layout::{ALL_PLANES, EyeUniform, ID_ODD, ID_SHIFT, VISIBLE_BY_EYE, ViewUniform, VisibleBatch};

/// A triangle's corners and their shares in a pixel, from which `hqs` mixes the color; a key names one corner alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixture {
    /// The corners' points, numbers in the chunk.
    pub points: [u32; 3],
    /// The corners' shares, which sum to 1.
    pub shares: [f32; 3],
}

impl Mixture {
    /// The corners' colors, mixed by their shares.
    #[must_use]
    pub fn color(&self, colors: &[u32]) -> u32 {
        let channel =
            |i: usize, corner: usize| f32::from(colors[self.points[corner] as usize].to_le_bytes()[i]);
        let [a, b, c] = self.shares;
        let mixed = |i: usize| (a * channel(i, 0) + b * channel(i, 1) + c * channel(i, 2) + 0.5) as u8;
        u32::from_le_bytes([mixed(0), mixed(1), mixed(2), 255])
    }
}

/// A triangle as an eye sees it.
struct EyeTriangle {
    x: [f32; 3],
    y: [f32; 3],
    w: [f32; 3],
    slack: [f32; 3],
    first: [i32; 2],
    last: [i32; 2],
    points: [u32; 3],
}

/// Hands every triangle of a batch to `put`, in every pixel.
pub(in crate::reference) fn triangles(
    view: &ViewUniform,
    num_eyes: usize,
    batch: &VisibleBatch,
    planes: [&[u32]; 3],
    tree: &Tree,
    put: &mut dyn FnMut(Put),
) {
    for number in 0..batch.num_points {
        let word = tree.shapes[(batch.first_point + number) as usize];
        for (eye, uniform) in view.eyes[..num_eyes].iter().enumerate() {
            if batch.flags & VISIBLE_BY_EYE << eye == 0 {
                continue;
            }
            let Some(triangle) = EyeTriangle::of((view, eye), batch, planes, (tree, word)) else { continue };
            for v in triangle.first[1]..=triangle.last[1] {
                for u in triangle.first[0]..=triangle.last[0] {
                    let Some((w, shares)) = triangle.in_pixel(view.near, [u, v]) else { continue };
                    let corner = largest(shares);
                    let sum = shares[0] + shares[1] + shares[2];
                    let mixture = Mixture { points: triangle.points, shares: shares.map(|s| s / sum) };
                    let [x, y] = [u - uniform.first_px[0] as i32, v - uniform.first_px[1] as i32];
                    let pixel = y as usize * uniform.width as usize + x as usize;
                    let id = triangle.points[corner] << ID_SHIFT | ID_ODD;
                    put(Put { eye, pixel, w, id, mixture: Some(mixture) });
                }
            }
        }
    }
}

/// Index of the largest number; of equals, the first.
fn largest([a, b, c]: [f32; 3]) -> usize {
    if a.max(b) < c {
        2
    } else if a >= b {
        0
    } else {
        1
    }
}

fn least(v: [f32; 3]) -> f32 {
    v[0].min(v[1].min(v[2]))
}

fn most(v: [f32; 3]) -> f32 {
    v[0].max(v[1].max(v[2]))
}

impl EyeTriangle {
    /// The triangle of a word as an eye sees it; `None` if it is not drawn.
    fn of(
        (view, number): (&ViewUniform, usize),
        batch: &VisibleBatch,
        planes: [&[u32]; 3],
        (tree, word): (&Tree, u32),
    ) -> Option<Self> {
        let eye = &view.eyes[number];
        let [a, b, c, step] = word.to_le_bytes();
        let points = [a, b, c].map(|corner| batch.first_point + u32::from(corner));
        let words = |point: u32| planes.map(|plane| plane[point as usize]);
        let corners = points.map(|point| p_in_head(batch, cells(ALL_PLANES, words(point))));
        let from_eye = |p: [f32; 3]| std::array::from_fn(|i| p[i] - eye.eye_in_head[i]);
        let tolerance = corners.map(|p| tolerance::of(view, &tree.uniform, number, from_eye(p)));
        if tree.scale().step_below(least(tolerance)) >= step {
            return None;
        }
        let row = |r: [f32; 4]| corners.map(|[x, y, z]| r[0] * x + r[1] * y + r[2] * z + r[3]);
        let (x, y, w) = (row(eye.row_x), row(eye.row_y), row(eye.row_w));
        let growth = |v: [f32; 3], i: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            v[k] * w[j] - v[j] * w[k]
        };
        let slack = |i: usize| {
            let (gx, gy) = (growth(x, i), growth(y, i));
            TRIANGLE_SLACK_PX * (gx * gx + gy * gy).sqrt()
        };
        let slack = [slack(0), slack(1), slack(2)];
        let [first, last] = pixels(view.near, eye, x, y, w)?;
        Some(Self { x, y, w, slack, first, last, points })
    }

    /// Depth and the corners' shares in a pixel, if the triangle covers it.
    fn in_pixel(&self, near: f32, [u, v]: [i32; 2]) -> Option<(f32, [f32; 3])> {
        let from = |v: [f32; 3], px: i32| -> [f32; 3] {
            std::array::from_fn(|i| v[i] - (px as f32 + 0.5) * self.w[i])
        };
        let (x, y) = (from(self.x, u), from(self.y, v));
        let edge = |i: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            x[j] * y[k] - x[k] * y[j]
        };
        let edge = [edge(0), edge(1), edge(2)];
        let is_front = (0..3).all(|i| edge[i] >= -self.slack[i]);
        let is_back = (0..3).all(|i| edge[i] <= self.slack[i]);
        let shares = edge.map(|e| if is_front { e } else { -e }.max(0.0));
        let sum = shares[0] + shares[1] + shares[2];
        let w = without_reach((self.w[0] * shares[0] + self.w[1] * shares[1] + self.w[2] * shares[2]) / sum);
        ((is_front || is_back) && sum > 0.0 && w > near).then_some((w, shares))
    }
}

/// First and last of the pixels that the triangle may cover.
fn pixels(near: f32, eye: &EyeUniform, x: [f32; 3], y: [f32; 3], w: [f32; 3]) -> Option<[[i32; 2]; 2]> {
    if least(w) > near {
        let at = |v: [f32; 3]| [0, 1, 2].map(|i| v[i] / w[i] - 0.5);
        let (u, v) = (at(x), at(y));
        let (first_px, end_px) = (eye.first_px, eye.end_px);
        let first = |v: [f32; 3], axis: usize| {
            (least(v) - TRIANGLE_SLACK_PX).ceil().clamp(first_px[axis], end_px[axis]) as i32
        };
        let last = |v: [f32; 3], axis: usize| {
            (most(v) + TRIANGLE_SLACK_PX).floor().clamp(first_px[axis] - 1.0, end_px[axis] - 1.0) as i32
        };
        return Some([[first(u, 0), first(v, 1)], [last(u, 0), last(v, 1)]]);
    }
    (most(w) > near).then(|| [eye.first_px.map(|px| px as i32), eye.end_px.map(|px| px as i32 - 1)])
}
