//! Every space and every matrix of the program, in f64; f32 only at the very end (frame.md section 2).
//!
//! Spaces, all right-handed:
//! - **world**: scan coordinates as the files have them (f64, z up for LAS), in file units.
//! - **stage**: the headset's play space: metres, y up, floor at 0.
//! - **view**: an eye's own space: x right, y up, looking along −z. Lengths are world units.
//! - **head**: world axes, origin at the point midway between the eyes. The GPU works in it: numbers near
//!   the viewer are small, so f32 is exact enough there.
//! - **pixel**: (0, 0) is the top left corner of an eye's image, y down.
//!
//! Matrices and poses are named `to_from`.

use glam::{DMat3, DMat4, DQuat, DVec3};

/// An axis-aligned box in world space. `min > max` on every axis means empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest corner.
    pub min: DVec3,
    /// Largest corner (inclusive).
    pub max: DVec3,
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

    /// `from_to`.
    #[must_use]
    pub fn inverse(&self) -> Pose {
        let orientation = self.orientation.inverse();
        Pose { position: -(orientation * self.position), orientation }
    }

    /// The same as a matrix.
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
}

impl Eye {
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

    /// Pixels per radian at the optical axis; the smaller of both directions would lose detail, so the larger.
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
