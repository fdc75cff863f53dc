//! Triangles that stand in the stage: laid out anew for each frame, in memory that is taken once.

use base::space::Pose;
use bytemuck::{Pod, Zeroable};
use glam::DVec3;

/// Corners of a frame's shapes at most; what does not fit is left out.
pub const MOST_CORNERS: usize = 3 * 4096;
/// How strongly shapes that lie behind points cover them, unless they are marks.
const FAINT: f32 = 0.15;
/// How strongly marks that lie behind points cover them: a mark on a floor lies among the floor's points.
const MARKED: f32 = 0.6;
/// Sides of a ring.
const RING_SIDES: usize = 48;
/// Sides of a tube.
const TUBE_SIDES: usize = 8;

/// A corner of a triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ShapeCorner {
    /// Place in the stage, meters.
    pub p_in_stage: [f32; 3],
    /// Place on the card, from its top left corner to (1, 1). If the first is below 0, the triangle shows its own color,
    /// and the second says how strongly it covers points that it lies behind.
    pub on_card: [f32; 2],
    /// Color in linear light, and how strongly it covers what is behind.
    pub color: [f32; 4],
}

impl ShapeCorner {
    pub(super) fn layout() -> wgpu::VertexBufferLayout<'static> {
        const ATTRIBUTES: [wgpu::VertexAttribute; 3] =
            wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x2, 2 => Float32x4];
        wgpu::VertexBufferLayout {
            array_stride: size_of::<Self>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &ATTRIBUTES,
        }
    }
}

/// A frame's shapes. Later ones cover earlier ones.
#[derive(Debug)]
pub struct Shapes {
    corners: Vec<ShapeCorner>,
    /// How strongly what is laid next covers points that it lies behind.
    behind: f32,
}

impl Default for Shapes {
    fn default() -> Self {
        Self { corners: Vec::with_capacity(MOST_CORNERS), behind: FAINT }
    }
}

impl Shapes {
    /// All corners, three a triangle.
    #[must_use]
    pub fn corners(&self) -> &[ShapeCorner] {
        &self.corners
    }

    /// Forgets all shapes; the memory stays.
    pub fn clear(&mut self) {
        self.corners.clear();
    }

    /// Lays marks, which are to be seen among points too.
    pub fn marks(&mut self, lay: impl FnOnce(&mut Self)) {
        self.behind = MARKED;
        lay(self);
        self.behind = FAINT;
    }

    fn own_color(&self) -> [f32; 2] {
        [-1.0, self.behind]
    }

    /// A triangle of one color.
    pub fn triangle(&mut self, places: [DVec3; 3], color: [f32; 4]) {
        let on_card = self.own_color();
        self.push(places.map(|p| ShapeCorner { p_in_stage: p.as_vec3().to_array(), on_card, color }));
    }

    /// A quadrangle of one color, its corners in turn.
    pub fn quadrangle(&mut self, [a, b, c, d]: [DVec3; 4], color: [f32; 4]) {
        self.triangle([a, b, c], color);
        self.triangle([a, c, d], color);
    }

    /// The card, upright in the x-y plane of its own space round the origin: width and height in meters.
    pub fn card(&mut self, stage_from_card: &Pose, size_m: [f64; 2]) {
        self.card_part(stage_from_card, size_m, [0.0, 1.0]);
    }

    /// A part of the card, like a card of its own: from one share of its width to another.
    pub fn card_part(&mut self, stage_from_card: &Pose, [width, height]: [f64; 2], [from, to]: [f32; 2]) {
        let corner = |x: f32, y: f32| {
            let p = DVec3::new((f64::from(x) - 0.5) * width, (0.5 - f64::from(y)) * height, 0.0);
            let p_in_stage = stage_from_card.matrix().transform_point3(p).as_vec3().to_array();
            ShapeCorner { p_in_stage, on_card: [from + x * (to - from), y], color: [1.0; 4] }
        };
        let [a, b, c, d] = [corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0)];
        self.push([a, b, c]);
        self.push([a, c, d]);
    }

    /// A band from one place to another, `width_m` wide, which shows its broad side to `head`; the colors are those of
    /// its ends.
    pub fn band(&mut self, ends: [DVec3; 2], width_m: f64, head: DVec3, colors: [[f32; 4]; 2]) {
        let along = ends[1] - ends[0];
        let aside = along.cross(head - ends[0]).normalize_or_zero() * (0.5 * width_m);
        let on_card = self.own_color();
        let corner = |end: usize, side: f64| {
            let p_in_stage = (ends[end] + side * aside).as_vec3().to_array();
            ShapeCorner { p_in_stage, on_card, color: colors[end] }
        };
        let [a, b, c, d] = [corner(0, -1.0), corner(0, 1.0), corner(1, 1.0), corner(1, -1.0)];
        self.push([a, b, c]);
        self.push([a, c, d]);
    }

    /// A flat ring round a place, across `axis` (of length 1), from the inner to the outer radius.
    pub fn ring(&mut self, center: DVec3, axis: DVec3, radii_m: [f64; 2], color: [f32; 4]) {
        let (x, y) = axis.any_orthonormal_pair();
        let at = |side: usize, radius: f64| {
            let (sin, cos) = (std::f64::consts::TAU * side as f64 / RING_SIDES as f64).sin_cos();
            center + radius * (cos * x + sin * y)
        };
        for side in 0..RING_SIDES {
            let [inner, outer] = radii_m;
            self.quadrangle(
                [at(side, inner), at(side, outer), at(side + 1, outer), at(side + 1, inner)],
                color,
            );
        }
    }

    /// A tube from one place to another with a radius at each, shaded as if lit from above.
    pub fn tube(&mut self, ends: [DVec3; 2], radii_m: [f64; 2], color: [f32; 4]) {
        let axis = (ends[1] - ends[0]).normalize_or(DVec3::Y);
        let (x, y) = axis.any_orthonormal_pair();
        let out = |side: usize| {
            let (sin, cos) = (std::f64::consts::TAU * side as f64 / TUBE_SIDES as f64).sin_cos();
            cos * x + sin * y
        };
        for side in 0..TUBE_SIDES {
            let (a, b) = (out(side), out(side + 1));
            let light = (0.7 + 0.3 * (a + b).normalize_or_zero().y) as f32;
            let [r, g, b_color, alpha] = color;
            let lit = [light * r, light * g, light * b_color, alpha];
            let at = |end: usize, out: DVec3| ends[end] + radii_m[end] * out;
            self.quadrangle([at(0, a), at(1, a), at(1, b), at(0, b)], lit);
        }
    }

    fn push(&mut self, corners: [ShapeCorner; 3]) {
        if self.corners.len() + corners.len() <= MOST_CORNERS {
            self.corners.extend(corners);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_is_upright_and_as_large_as_asked() {
        let mut shapes = Shapes::default();
        shapes.card(&Pose { position: DVec3::new(0.0, 1.5, -2.0), ..Pose::IDENTITY }, [0.8, 0.5]);
        let of = |on_card: [f32; 2]| {
            let corner = shapes.corners().iter().find(|corner| corner.on_card == on_card);
            corner.expect("a corner of the card").p_in_stage
        };
        assert_eq!(of([0.0, 0.0]), [-0.4, 1.75, -2.0]);
        assert_eq!(of([1.0, 1.0]), [0.4, 1.25, -2.0]);
        assert_eq!(shapes.corners().len(), 6);
        shapes.clear();
        shapes.card_part(&Pose::IDENTITY, [0.8, 0.5], [0.5, 1.0]);
        let left = shapes.corners().iter().find(|corner| corner.p_in_stage[0] < 0.0).expect("a left corner");
        assert_eq!(left.on_card[0], 0.5);
    }

    #[test]
    fn what_does_not_fit_is_left_out_and_no_memory_is_taken() {
        let mut shapes = Shapes::default();
        let capacity = shapes.corners.capacity();
        for _ in 0..MOST_CORNERS {
            shapes.ring(DVec3::ZERO, DVec3::Y, [0.2, 0.3], [1.0; 4]);
        }
        assert!(shapes.corners().len() > MOST_CORNERS - 3 && shapes.corners().len() <= MOST_CORNERS);
        assert_eq!(shapes.corners.capacity(), capacity);
        shapes.clear();
        assert!(shapes.corners().is_empty());
    }

    #[test]
    fn a_band_faces_the_head() {
        let mut shapes = Shapes::default();
        let head = DVec3::new(0.0, 1.7, 0.0);
        let ends = [DVec3::new(0.3, 1.0, -0.4), DVec3::new(0.3, 0.2, -3.0)];
        shapes.band(ends, 0.02, head, [[1.0; 4]; 2]);
        let [a, b] = [0, 1].map(|i| glam::Vec3::from(shapes.corners()[i].p_in_stage).as_dvec3());
        assert!(((b - a).length() - 0.02).abs() < 1e-6);
        assert!((b - a).dot(head - ends[0]).abs() < 1e-6);
        // A band that points at the head has no side to show.
        shapes.band([DVec3::ZERO, head], 0.02, 2.0 * head, [[1.0; 4]; 2]);
        assert!(shapes.corners()[6..].iter().all(|corner| corner.p_in_stage.iter().all(|c| c.is_finite())));
    }
}
