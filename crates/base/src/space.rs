//! Every space and every matrix of the program, in f64; f32 only at the very end (docs/FRAME.md §2).
//!
//! Spaces, all right-handed:
//! - **world**: the scan's coordinates (f64, z up), in one unit along all axes: see `points::WorldFromFile`.
//! - **stage**: the headset's play space: meters, y up, floor at 0.
//! - **view**: an eye's own space: x right, y up, looking along −z. Lengths are world units.
//! - **head**: world axes, origin at the point midway between the eyes. The GPU works in it: numbers near
//!   the viewer are small, so f32 is exact enough there.
//! - **pixel**: (0, 0) is the top left corner of an eye's image, y down.
//!
//! Matrices and poses are named `to_from`.

use glam::{DMat3, DMat4, DQuat, DVec3, Vec3};

/// An axis-aligned box in world space. `min > max` on every axis means empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest corner.
    pub min: DVec3,
    /// Largest corner (inclusive).
    pub max: DVec3,
}

impl Default for Bounds {
    /// The box of no points.
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Bounds {
    /// The box that contains nothing; the neutral element of [`Bounds::union`].
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The box extended to hold `p_in_world`.
    #[must_use]
    pub fn with(self, p_in_world: DVec3) -> Self {
        Self { min: self.min.min(p_in_world), max: self.max.max(p_in_world) }
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// True if nothing has been added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x
    }

    /// Edge lengths; zero if empty.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { self.max - self.min }
    }

    /// The longest edge; zero if empty.
    #[must_use]
    pub fn edge(&self) -> f64 {
        self.size().max_element()
    }

    /// The box of these positions.
    #[must_use]
    pub fn around(positions: &[DVec3]) -> Self {
        positions.iter().fold(Self::EMPTY, |bounds, &p| bounds.with(p))
    }

    /// The box with `margin` more on every side.
    #[must_use]
    pub fn grown(self, margin: f64) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// True of positions in the box, its surface included.
    #[must_use]
    pub fn contains(&self, p_in_world: DVec3) -> bool {
        p_in_world.cmpge(self.min).all() && p_in_world.cmple(self.max).all()
    }

    /// The distance between two boxes; zero where they touch.
    #[must_use]
    pub fn gap(&self, other: &Self) -> f64 {
        (other.min - self.max).max(self.min - other.max).max(DVec3::ZERO).length()
    }

    /// The middle; the origin if empty.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { self.min + 0.5 * (self.max - self.min) }
    }
}

/// A rigid transform `to_from`: `p_in_to = orientation · p_in_from + position`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where the `from` origin lies in `to`.
    pub position: DVec3,
    /// Rotation of `from` axes into `to` axes; unit length.
    pub orientation: DQuat,
}

impl Pose {
    /// `to` and `from` coincide.
    pub const IDENTITY: Self = Self { position: DVec3::ZERO, orientation: DQuat::IDENTITY };

    /// The pose of a camera at `eye` that looks to `target`, both in world space.
    ///
    /// `up` need only not be parallel to the viewing direction; if it is (a plan view straight down with
    /// `up` = z), the world axis least aligned with the view takes its place.
    #[must_use]
    pub fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> Self {
        let back = (eye - target).try_normalize().unwrap_or(DVec3::Y);
        let up = up.try_normalize().unwrap_or(DVec3::Z);
        let right = up.cross(back);
        let right = if right.length() > 1e-9 {
            right.normalize()
        } else {
            let other = if back.y.abs() < 0.9 { DVec3::Y } else { DVec3::X };
            other.cross(back).normalize()
        };
        let world_from_view = DMat3::from_cols(right, back.cross(right), back);
        Self { position: eye, orientation: DQuat::from_mat3(&world_from_view).normalize() }
    }

    /// `a_from_b · b_from_c = a_from_c`.
    #[must_use]
    pub fn then(&self, b_from_c: &Pose) -> Pose {
        Pose {
            position: self.orientation * b_from_c.position + self.position,
            orientation: (self.orientation * b_from_c.orientation).normalize(),
        }
    }

    /// The inverse transform, `from_to`.
    #[must_use]
    pub fn inverse(&self) -> Pose {
        let orientation = self.orientation.inverse();
        Pose { position: -(orientation * self.position), orientation }
    }

    /// The transform as a matrix.
    #[must_use]
    pub fn matrix(&self) -> DMat4 {
        DMat4::from_rotation_translation(self.orientation, self.position)
    }
}

/// A field of view as tangents of its four half angles; left and down are usually negative.
///
/// Headset displays are asymmetric: left ≠ −right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fov {
    /// Tangent of the angle to the left edge (usually < 0).
    pub left: f64,
    /// Tangent of the angle to the right edge.
    pub right: f64,
    /// Tangent of the angle to the top edge.
    pub up: f64,
    /// Tangent of the angle to the bottom edge (usually < 0).
    pub down: f64,
}

impl Fov {
    /// A symmetric field of view from the vertical angle in radians and width / height.
    #[must_use]
    pub fn symmetric(fov_y: f64, aspect: f64) -> Self {
        let t = (0.5 * fov_y).tan();
        Self { left: -t * aspect, right: t * aspect, up: t, down: -t }
    }

    /// The field of view of the other eye: left and right exchanged.
    #[must_use]
    pub fn mirrored(self) -> Self {
        Self { left: -self.right, right: -self.left, ..self }
    }

    /// From four signed half angles in radians (OpenXR's XrFovf).
    #[must_use]
    pub fn from_angles(left: f64, right: f64, up: f64, down: f64) -> Self {
        Self { left: left.tan(), right: right.tan(), up: up.tan(), down: down.tan() }
    }
}

/// One eye: where it is, what it sees, and how many pixels that is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Pose of the eye in world space. The rotation is rigid; view lengths are world units.
    pub world_from_view: Pose,
    /// Field of view.
    pub fov: Fov,
    /// Image size in pixels: width, height; both at least 1.
    pub size_px: [u32; 2],
    /// Where the eye looks, in view space, unit length: an eye tracker's answer, else [`Eye::AHEAD`].
    pub gaze_in_view: DVec3,
}

impl Eye {
    /// The optical axis: the gaze of an eye that nobody tracks. It is not the image's center, which an asymmetric field
    /// of view puts degrees away.
    pub const AHEAD: DVec3 = DVec3::NEG_Z;

    /// Rows of `pixel_from_head`: for p in head space (world axes, relative to `head_in_world`),
    /// `w = r[2]·(p, 1)` is the linear depth (distance along the view direction, world units),
    /// `px = r[0]·(p, 1) / w` and `py = r[1]·(p, 1) / w` are pixel coordinates, y down.
    ///
    /// The viewport transform is folded into the projection, so a point costs three dot products and one
    /// reciprocal. Matches the picture formula of the command line contract: floor(px), floor(py).
    #[must_use]
    pub fn pixel_from_head(&self, head_in_world: DVec3) -> [[f64; 4]; 3] {
        let rotation = DMat3::from_quat(self.world_from_view.orientation);
        let (right, up, back) = (rotation.x_axis, rotation.y_axis, rotation.z_axis);
        let eye_in_head = self.world_from_view.position - head_in_world;
        let row = |axis: DVec3| [axis.x, axis.y, axis.z, -axis.dot(eye_in_head)];
        let (x, y, w) = (row(right), row(up), row(-back));
        let Fov { left, right, up, down } = self.fov;
        let [width, height] = self.size_px.map(f64::from);
        // tangent x: left → 0, right → width; tangent y: up → 0, down → height.
        let (sx, sy) = (width / (right - left), height / (up - down));
        let px = std::array::from_fn(|i| sx * (x[i] - left * w[i]));
        let py = std::array::from_fn(|i| sy * (up * w[i] - y[i]));
        [px, py, w]
    }

    /// The direction in world space, of any length, in which the eye sees a place of its image: fractions of the image's width
    /// from the left and of its height from the top.
    #[must_use]
    pub fn along_in_world(&self, [x, y]: [f64; 2]) -> DVec3 {
        let Fov { left, right, up, down } = self.fov;
        let along_in_view = DVec3::new(left + x * (right - left), up + y * (down - up), -1.0);
        self.world_from_view.orientation * along_in_view
    }

    /// Clip coordinates of a place, for what the GPU's own pipeline draws: w is the linear depth, and z / w is near /
    /// w, as depth images have it.
    #[must_use]
    pub fn clip_from_world(&self, p_in_world: DVec3, near: f64) -> [f32; 4] {
        let p = self.world_from_view.inverse().matrix().transform_point3(p_in_world);
        let Fov { left, right, up, down } = self.fov;
        let w = -p.z;
        let x = (2.0 * p.x - (left + right) * w) / (right - left);
        let y = (2.0 * p.y - (up + down) * w) / (up - down);
        [x, y, near, w].map(|c| c as f32)
    }

    /// Pixels per radian at the optical axis, in the direction that has more of them: the smaller would lose detail.
    #[must_use]
    pub fn pixels_per_radian(&self) -> f64 {
        let [width, height] = self.size_px.map(f64::from);
        (width / (self.fov.right - self.fov.left)).max(height / (self.fov.up - self.fov.down))
    }
}

/// The eyes of one frame: one (a plain picture) or two (left, right).
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Left, then right.
    pub eyes: Vec<Eye>,
    /// Points at a depth ≤ this are not drawn; world units.
    pub near: f64,
}

impl View {
    /// The head: midway between the eyes, in world space.
    #[must_use]
    pub fn head_in_world(&self) -> DVec3 {
        let sum: DVec3 = self.eyes.iter().map(|e| e.world_from_view.position).sum();
        sum / self.eyes.len().max(1) as f64
    }
}

/// How world positions become pairs of f32 that lose nothing that matters.
///
/// `p − origin = hi + lo`: `hi` is a multiple of `unit`, a power of two so large that every `hi` of the scene
/// has at most 22 significant bits. The difference of two `hi` is then exact in f32, and `lo`, at most
/// half a unit, is exact to 2⁻²⁵ of it: micrometers in a scene of a thousand kilometers. Points far outside the scene
/// are exact to 2⁻²⁴ of their distance at least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// World position that maps to (0, 0).
    pub origin: DVec3,
    /// Grid of `hi`; a power of two, world units.
    pub unit: f64,
}

impl Split {
    /// The split for a scene in the box of `all` points: the scene's center as origin. Differences are exact as far as
    /// the points reach, or a million times as far as the scene does: beyond that its own precision would suffer.
    #[must_use]
    pub fn of(scene: &Bounds, all: &Bounds) -> Self {
        let origin = scene.center();
        let farthest = (all.max - origin).max(origin - all.min).max_element();
        let reach = farthest.min(f64::from(1 << 20) * 0.5 * scene.edge());
        let unit = if reach > 0.0 { (reach.log2().ceil() - 22.0).exp2() } else { 2f64.powi(-22) };
        Self { origin, unit }
    }

    /// (hi, lo) of a world position.
    #[must_use]
    pub fn pair(&self, p_in_world: DVec3) -> (Vec3, Vec3) {
        let relative = p_in_world - self.origin;
        // Rounded twice only far outside the scene; `lo` has the rest all the same.
        let hi = ((relative / self.unit).round() * self.unit).as_vec3();
        (hi, (relative - hi.as_dvec3()).as_vec3())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vec(range: f64) -> impl Strategy<Value = DVec3> {
        [-range..range, -range..range, -range..range].prop_map(DVec3::from_array)
    }

    /// The picture formula of the command line contract, straight from its text.
    fn contract_pixel(
        p: DVec3,
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        fov_y: f64,
        size: [f64; 2],
    ) -> (f64, f64, f64) {
        let back = (eye - target).normalize();
        let right = up.cross(back).normalize();
        let true_up = back.cross(right);
        let v = p - eye;
        let (x, y, d) = (v.dot(right), v.dot(true_up), -v.dot(back));
        let (t, aspect) = ((fov_y / 2.0).tan(), size[0] / size[1]);
        ((x / (d * t * aspect) * 0.5 + 0.5) * size[0], (0.5 - y / (d * t) * 0.5) * size[1], d)
    }

    proptest! {
        #[test]
        fn rows_follow_the_picture_formula(p in vec(50.0), eye in vec(50.0), target in vec(50.0), fov in 20.0f64..120.0) {
            let direction = target - eye;
            prop_assume!(direction.length() > 0.1 && direction.normalize().z.abs() < 0.99);
            let size = [641u32, 479];
            let camera = Eye {
                world_from_view: Pose::look_at(eye, target, DVec3::Z),
                fov: Fov::symmetric(fov.to_radians(), f64::from(size[0]) / f64::from(size[1])),
                size_px: size,
                gaze_in_view: Eye::AHEAD,
            };
            let head = eye + DVec3::new(0.1, -0.2, 0.3);
            let rows = camera.pixel_from_head(head);
            let q = (p - head).extend(1.0);
            let [x, y, w] = rows.map(|r| glam::DVec4::from_array(r).dot(q));
            let clip = camera.clip_from_world(p, 0.05).map(f64::from);
            if w > 0.05 {
                prop_assert!(((0.5 + 0.5 * clip[0] / clip[3]) * 641.0 - x / w).abs() < 1e-3 * (1.0 + (x / w).abs()));
                prop_assert!(((0.5 - 0.5 * clip[1] / clip[3]) * 479.0 - y / w).abs() < 1e-3 * (1.0 + (y / w).abs()));
            }
            let want = contract_pixel(p, eye, target, DVec3::Z, fov.to_radians(), size.map(f64::from));
            prop_assume!(want.2.abs() > 0.05);
            prop_assert!((w - want.2).abs() < 1e-9);
            prop_assert!((x / w - want.0).abs() < 1e-6 * (1.0 + want.0.abs()), "{} {}", x / w, want.0);
            prop_assert!((y / w - want.1).abs() < 1e-6 * (1.0 + want.1.abs()), "{} {}", y / w, want.1);
        }

        #[test]
        fn pairs_keep_micrometers_in_twenty_kilometers(a in vec(10_000.0), b in vec(10_000.0)) {
            let corner = DVec3::new(500_000.0, 4_000_000.0, 100.0);
            let bounds = Bounds { min: corner - 10_000.0, max: corner + 10_000.0 };
            let split = Split::of(&bounds, &bounds);
            let ((a_hi, a_lo), (b_hi, b_lo)) = (split.pair(corner + a), split.pair(corner + b));
            let hi = a_hi - b_hi;
            prop_assert_eq!(hi.as_dvec3(), a_hi.as_dvec3() - b_hi.as_dvec3(), "difference of hi is exact");
            let got = hi.as_dvec3() + (a_lo - b_lo).as_dvec3();
            // 1e-8 covers the f64 coordinates' own grid at 4e6.
            prop_assert!((got - (a - b)).length() < 1e-8);
        }

        #[test]
        fn pose_inverse_undoes(p in vec(9.0), eye in vec(9.0), target in vec(9.0)) {
            prop_assume!((target - eye).length() > 0.1);
            let pose = Pose::look_at(eye, target, DVec3::Z);
            let q = pose.matrix().transform_point3(p);
            prop_assert!((pose.inverse().matrix().transform_point3(q) - p).length() < 1e-9);
            prop_assert!((pose.then(&pose.inverse()).position).length() < 1e-9);
        }
    }

    #[test]
    fn looking_straight_down_has_a_right_hand_side() {
        let pose = Pose::look_at(DVec3::new(1.0, 2.0, 9.0), DVec3::new(1.0, 2.0, 0.0), DVec3::Z);
        assert!((pose.orientation * DVec3::NEG_Z - DVec3::NEG_Z).length() < 1e-12);
        assert!((pose.orientation * DVec3::X).z.abs() < 1e-12);
    }

    #[test]
    fn bounds_of_nothing_are_empty() {
        assert!(Bounds::EMPTY.is_empty());
        assert_eq!(Bounds::EMPTY.size(), DVec3::ZERO);
        assert!(!Bounds::EMPTY.with(DVec3::ONE).is_empty());
    }
}
