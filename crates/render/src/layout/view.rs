//! What the stages know of a frame: the eyes, and how much of the cloud is drawn for them.

use super::{FADE_END, GUARD_PX, LOD_FADE, LOD_SMOOTH, MAX_FILL_RADIUS, guarded};
use base::space::{Eye, Fov, Split, View};
use bytemuck::{Pod, Zeroable};
use glam::DVec3;

/// The angle from the optical axis that images reach at most, 70°, unless they are wider than any headset's.
pub const WIDEST_RAD: f64 = 70.0 * std::f64::consts::PI / 180.0;

/// One eye as the shaders see it: rows of `pixel_from_head` ([`base::space::Eye::pixel_from_head`]), the gaze,
/// and the way from a pixel back to a direction.
///
/// Its pixels are those of the image with the guard band ([`GUARD_PX`]) round it. Their coordinates count from the
/// corner of pixels that lies nearest to the optical axis, wherever the image's edges are: so a point is rounded to the
/// same pixel in a picture and in each part of it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct EyeUniform {
    /// Row that gives px · w.
    pub row_x: [f32; 4],
    /// Row that gives py · w.
    pub row_y: [f32; 4],
    /// Row that gives w, the linear depth.
    pub row_w: [f32; 4],
    /// The eye in head space.
    pub eye_in_head: [f32; 3],
    /// Pixels per radian at the optical axis.
    pub pixels_per_radian: f32,
    /// Direction of the gaze in head space, unit length.
    pub gaze_in_head: [f32; 3],
    /// Cosine of the largest angle from the optical axis at which sizes are judged: what is seen lies within, and what
    /// lies beyond is as large as there.
    pub widest_cos: f32,
    /// Direction of the gaze in view space, unit length; (0, 0, −1) is the optical axis.
    pub gaze_in_view: [f32; 3],
    /// Always 0.
    pub reserved: f32,
    /// Tangents of the angles to the corner that coordinates count from: right and up are positive.
    pub tangent_origin: [f32; 2],
    /// Tangents from one pixel to the next, to the right and down. The center of pixel (x, y) lies in the
    /// direction `(tangent_origin + tangent_per_px · (x + ½, y + ½), −1)` of view space.
    pub tangent_per_px: [f32; 2],
    /// The top left pixel; a whole number.
    pub first_px: [f32; 2],
    /// The pixel beyond the bottom right one.
    pub end_px: [f32; 2],
    /// Width in pixels, with the guard band.
    pub width: u32,
    /// Height in pixels, with the guard band.
    pub height: u32,
    /// Always 0.
    pub reserved_end: [u32; 2],
}

impl EyeUniform {
    /// The GPU's form of an eye, relative to the head.
    #[must_use]
    pub fn new(eye: &Eye, head_in_world: DVec3) -> Self {
        let [row_x, row_y, row_w] = eye.pixel_from_head(head_in_world);
        let Fov { left, right, up, down } = eye.fov;
        let [width, height] = eye.size_px.map(f64::from);
        let per_px = [(right - left) / width, (down - up) / height];
        // The corner nearest to the axis, in pixels of the image.
        let corner = [-left / per_px[0], -up / per_px[1]].map(f64::round);
        let from_corner =
            |row: [f64; 4], corner: f64| std::array::from_fn(|i| (row[i] - corner * row_w[i]) as f32);
        let [width, height] = guarded(eye.size_px);
        let first_px = corner.map(|corner| (-corner - f64::from(GUARD_PX)) as f32);
        Self {
            row_x: from_corner(row_x, corner[0]),
            row_y: from_corner(row_y, corner[1]),
            row_w: row_w.map(|v| v as f32),
            eye_in_head: (eye.world_from_view.position - head_in_world).as_vec3().to_array(),
            pixels_per_radian: eye.pixels_per_radian() as f32,
            gaze_in_head: (eye.world_from_view.orientation * eye.gaze_in_view).as_vec3().to_array(),
            widest_cos: widest_cos(&eye.fov),
            gaze_in_view: eye.gaze_in_view.as_vec3().to_array(),
            reserved: 0.0,
            tangent_origin: [left + per_px[0] * corner[0], up + per_px[1] * corner[1]].map(|t| t as f32),
            tangent_per_px: per_px.map(|t| t as f32),
            first_px,
            end_px: [first_px[0] + width as f32, first_px[1] + height as f32],
            width,
            height,
            reserved_end: [0; 2],
        }
    }
}

/// [`EyeUniform::widest_cos`]: of the image's farthest corner or of [`WIDEST_RAD`], which is farther in all headsets,
/// so that a part of a picture is judged like the whole.
fn widest_cos(fov: &Fov) -> f32 {
    let (x, y) = (fov.left.abs().max(fov.right.abs()), fov.up.abs().max(fov.down.abs()));
    (1.0 + x * x + y * y).sqrt().recip().min(WIDEST_RAD.cos()) as f32
}

/// How much of a cloud a frame draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// 0: precision by projected size; else that many planes always, up to [`super::ALL_PLANES`].
    pub forced_planes: u32,
    /// Pixels that a node's projected edge needs in the inner, middle and outer ring.
    pub threshold_px: [f32; 3],
    /// Angles from the gaze at which the inner and the middle ring end, radians.
    pub ring_rad: [f64; 2],
    /// True if thresholds grow from the first to the third between the rings' ends.
    pub smooth: bool,
    /// True if points of a node appear one by one.
    pub fade: bool,
    /// Pixels across that the kernels of dilation close, in the inner, middle and outer ring. Points that are to close
    /// more have a wider kernel, and a splat if the widest leaves gaps. `None`: every point is drawn as one pixel,
    /// always.
    pub fill_reach_px: Option<[f32; 3]>,
}

/// The view of one frame: both eyes and the head that they are relative to.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ViewUniform {
    /// Head position, coarse part, relative to the cloud origin.
    pub head_hi: [f32; 3],
    /// Points with w ≤ near are not drawn.
    pub near: f32,
    /// Head position, fine part.
    pub head_lo: [f32; 3],
    /// [`Detail::forced_planes`].
    pub forced_planes: u32,
    /// Pixels that a node's projected edge needs in the inner, middle and outer ring.
    pub threshold_px: [f32; 3],
    /// [`LOD_FADE`], [`LOD_SMOOTH`].
    pub flags: u32,
    /// Cosines of the angles from the gaze at which the inner and the middle ring end.
    pub ring_cos: [f32; 2],
    /// Sines of the angles from the gaze at which the inner and the middle ring end.
    pub ring_sin: [f32; 2],
    /// [`Detail::fill_reach_px`].
    pub fill_reach_px: [f32; 3],
    /// Pixels outside an eye's image in which a point may still be large enough to be seen.
    pub margin_px: f32,
    /// Pixels that the edge of the finest node has at most, in the inner, middle and outer ring, if that node is drawn
    /// whole: twice the size from which on a node is.
    pub undivided_px: [f32; 3],
    /// Always 0.
    pub reserved: f32,
    /// Left, right. With one eye the second is a copy of the first and not drawn.
    pub eyes: [EyeUniform; 2],
}

impl ViewUniform {
    /// The GPU's form of a view of one or two eyes.
    ///
    /// # Panics
    /// If the view has no eye.
    #[must_use]
    pub fn new(view: &View, split: &Split, detail: &Detail) -> Self {
        let head_in_world = view.head_in_world();
        let (hi, lo) = split.pair(head_in_world);
        let eye = |index: usize| EyeUniform::new(&view.eyes[index.min(view.eyes.len() - 1)], head_in_world);
        Self {
            head_hi: hi.to_array(),
            near: view.near as f32,
            head_lo: lo.to_array(),
            forced_planes: detail.forced_planes,
            threshold_px: detail.threshold_px,
            flags: if detail.fade { LOD_FADE } else { 0 } | if detail.smooth { LOD_SMOOTH } else { 0 },
            ring_cos: detail.ring_rad.map(|angle| angle.cos() as f32),
            ring_sin: detail.ring_rad.map(|angle| angle.sin() as f32),
            fill_reach_px: detail.fill_reach_px.unwrap_or([f32::MAX; 3]),
            margin_px: if detail.fill_reach_px.is_some() { MAX_FILL_RADIUS as f32 } else { 0.0 },
            undivided_px: undivided_px(detail),
            reserved: 0.0,
            eyes: [eye(0), eye(1)],
        }
    }
}

/// [`ViewUniform::undivided_px`]. A node that reaches into an inner ring has that ring's threshold; where thresholds
/// grow smoothly, they end the middle ring as the outer one's.
fn undivided_px(detail: &Detail) -> [f32; 3] {
    let [inner, middle, outer] = detail.threshold_px;
    let middle = if detail.smooth { middle.max(outer) } else { middle };
    let whole = if detail.fade { FADE_END } else { 1.0 };
    [inner, inner.max(middle), inner.max(middle).max(outer)].map(|px| 2.0 * whole * px)
}
