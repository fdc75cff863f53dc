//! The place that the terrestrial scanner sees: an old courtyard with an arcade round it.
//!
//! Coordinates are its own: meters, x east, y north, z up, the fountain at the origin, the paving at height 0. The
//! court measures 30 × 24 m between its walls; the arcade, 3.2 m deep, takes part of that all round.

mod arcade;
mod garden;
mod rooms;
mod walls;

use super::bvh::Bvh;
use super::light::Light;
use super::material::Material;
use super::shape::Shape;
use super::span::{Hit, Ray};
use base::space::Bounds;
use glam::DVec3;
use std::sync::OnceLock;

/// Half the court, east–west: the inner face of its walls.
pub const HALF_X: f64 = 15.0;
/// Half the court, south–north.
pub const HALF_Y: f64 = 12.0;
/// Middle of the arcade's columns, east and west.
pub const COLUMNS_X: f64 = 11.8;
/// Middle of the arcade's columns, south and north.
pub const COLUMNS_Y: f64 = 8.8;
/// Height of the arcade's floor, one step above the paving.
pub const ARCADE_FLOOR: f64 = 0.15;
/// Height of the terrace on the north side.
pub const TERRACE: f64 = 4.6;
/// Thickness of the walls.
pub const WALL: f64 = 0.5;

/// The whole place, ready for rays.
pub struct Courtyard {
    bvh: Bvh,
    materials: Vec<Material>,
    light: Light,
}

impl Courtyard {
    /// The courtyard; built once a process, for it is the same for every seed.
    pub fn get() -> &'static Self {
        static COURTYARD: OnceLock<Courtyard> = OnceLock::new();
        COURTYARD.get_or_init(|| {
            let mut parts = CourtyardParts::default();
            walls::add(&mut parts);
            arcade::add(&mut parts);
            rooms::add(&mut parts);
            garden::add(&mut parts);
            let bvh = Bvh::new(&parts.shapes);
            let around = Bounds { min: DVec3::new(-16.5, -18.5, 0.45), max: DVec3::new(22.5, 12.5, 9.45) };
            let to_sun = DVec3::new(-0.50, -0.52, 0.69).normalize();
            let light = Light::new(&bvh, to_sun, around);
            Courtyard { bvh, materials: parts.materials, light }
        })
    }

    /// The nearest surface that a ray meets within `reach`, and its material.
    pub fn nearest(&self, ray: &Ray, reach: f64) -> Option<(Hit, Material)> {
        self.bvh.nearest(ray, reach).map(|(hit, shape)| (hit, self.materials[shape]))
    }

    /// Display color (0 to 1 and above, where it is overexposed) of a lit surface.
    pub fn color(&self, p: DVec3, normal: DVec3, material: &Material) -> DVec3 {
        let light = self.light.at(&self.bvh, p, normal, material.is_thin());
        material.color(p, normal) * light.map(f64::sqrt)
    }
}

/// Shapes of the courtyard and their materials.
#[derive(Default)]
struct CourtyardParts {
    shapes: Vec<Shape>,
    materials: Vec<Material>,
}

impl CourtyardParts {
    fn add(&mut self, shape: Shape, material: Material) {
        self.shapes.push(shape);
        self.materials.push(material);
    }

    /// A box from two opposite corners in any order.
    fn cuboid(&mut self, a: [f64; 3], b: [f64; 3], material: Material) {
        let (a, b) = (DVec3::from_array(a), DVec3::from_array(b));
        self.add(Shape::Cuboid { min: a.min(b), max: a.max(b) }, material);
    }

    /// A round piece standing on `base`.
    fn turned(&mut self, base: DVec3, height: f64, bottom: f64, top: f64, material: Material) {
        self.add(Shape::Frustum { base, height, bottom, top }, material);
    }

    /// Round pieces on top of each other, each (height, bottom radius, top radius).
    fn stack(&mut self, mut base: DVec3, pieces: &[(f64, f64, f64)], material: Material) {
        for &(height, bottom, top) in pieces {
            self.turned(base, height, bottom, top, material);
            base.z += height;
        }
    }

    /// A round bar.
    fn bar(&mut self, a: DVec3, b: DVec3, radius: f64, material: Material) {
        self.add(Shape::Capsule { a, b, radius }, material);
    }
}
