//! Coordinates to 30-bit cells of their batch's box, split into three planes of 10 bits [2022 §3.3].
//!
//! `X30 = min(⌊(x − min) / cell⌋, 2³⁰ − 1)`. The paper divides the box into 2³⁰ cells; here the cell's edge is rounded
//! up to 12 bits of mantissa (the box grows by at most 0.05 %), so that the product of a cell edge and a coarse cell
//! number is exact in f32, as the renderer's `VisibleBatch` needs it.

use crate::format::{COORDINATE_BITS, PLANE_BITS};
use base::space::Bounds;
use glam::DVec3;

/// Largest cell number an axis.
const MAX_CELL: u32 = (1 << COORDINATE_BITS) - 1;
/// Mantissa bits of a cell edge.
const CELL_BITS: i32 = 12;
/// Boxes thinner than this have no extent: their cells would leave the normal range of f32.
const MIN_EDGE: f64 = 1e-20;

/// Cells of a box: its minimum and the edge of a cell an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells {
    /// Box minimum, world space.
    pub min: DVec3,
    /// Edge of a cell, world units; 0 where the box is flat.
    pub cell: [f32; 3],
}

impl Cells {
    /// The cells that cover `bounds`.
    #[must_use]
    pub fn covering(bounds: &Bounds) -> Self {
        Self { min: bounds.min, cell: bounds.size().to_array().map(cell_edge) }
    }

    /// Cell numbers of a position inside the box.
    #[must_use]
    pub fn quantize(&self, p_in_world: DVec3) -> [u32; 3] {
        let d = p_in_world - self.min;
        let axis = |d: f64, cell: f32| {
            if cell == 0.0 {
                return 0;
            }
            // Casts from float saturate: a position just below the box gives 0.
            ((d / f64::from(cell)) as u32).min(MAX_CELL)
        };
        let [x, y, z] = self.cell;
        [axis(d.x, x), axis(d.y, y), axis(d.z, z)]
    }

    /// World position of a cell's center (on a flat axis: of the box).
    #[must_use]
    pub fn center(&self, xyz: [u32; 3]) -> DVec3 {
        let offset = std::array::from_fn(|axis| (f64::from(xyz[axis]) + 0.5) * f64::from(self.cell[axis]));
        self.min + DVec3::from_array(offset)
    }
}

/// `edge / 2³⁰`, rounded up to [`CELL_BITS`] bits of mantissa; 0 if the edge is shorter than [`MIN_EDGE`].
pub(super) fn cell_edge(edge: f64) -> f32 {
    if edge < MIN_EDGE {
        return 0.0;
    }
    let exact = edge / f64::from(1u32 << COORDINATE_BITS);
    let step = (exact.log2().floor() - f64::from(CELL_BITS - 1)).exp2();
    ((exact / step).ceil() * step) as f32
}

/// The three plane words of a point: bits 20–29, 10–19, 0–9 of each axis, x | y≪10 | z≪20.
#[must_use]
pub fn planes([x, y, z]: [u32; 3]) -> [u32; 3] {
    let mask = (1 << PLANE_BITS) - 1;
    let word = |shift: u32| {
        (x >> shift & mask) | (y >> shift & mask) << PLANE_BITS | (z >> shift & mask) << (2 * PLANE_BITS)
    };
    [word(2 * PLANE_BITS), word(PLANE_BITS), word(0)]
}

/// Inverse of [`planes`].
#[must_use]
pub fn cells_of(planes: [u32; 3]) -> [u32; 3] {
    let mask = (1 << PLANE_BITS) - 1;
    std::array::from_fn(|axis| {
        let part = |plane: u32| plane >> (PLANE_BITS * axis as u32) & mask;
        part(planes[0]) << (2 * PLANE_BITS) | part(planes[1]) << PLANE_BITS | part(planes[2])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn planes_round_trip(x in 0..=MAX_CELL, y in 0..=MAX_CELL, z in 0..=MAX_CELL) {
            prop_assert_eq!(cells_of(planes([x, y, z])), [x, y, z]);
        }

        #[test]
        fn a_position_lies_in_its_cell(
            min in -1e7f64..1e7, edge in 1e-6f64..1e6, part in 0.0f64..=1.0,
        ) {
            let bounds = Bounds { min: DVec3::splat(min), max: DVec3::splat(min + edge) };
            let cells = Cells::covering(&bounds);
            let p = bounds.min + (bounds.max - bounds.min) * part;
            let back = cells.center(cells.quantize(p));
            // The bound is half a cell, and what f64 itself loses at this distance from the origin.
            let bound = 0.5000001 * f64::from(cells.cell[0]) + 4.0 * f64::EPSILON * (min.abs() + edge);
            prop_assert!((back - p).abs().max_element() <= bound);
        }

        #[test]
        fn cell_edges_cover_the_box_with_twelve_bits(edge in 1e-9f64..1e9) {
            let cell = f64::from(cell_edge(edge));
            let exact = edge / f64::from(1u32 << COORDINATE_BITS);
            prop_assert!(cell >= exact && cell <= exact * (1.0 + 1.0 / 2048.0));
            prop_assert_eq!(cell_edge(edge).to_bits() & 0xfff, 0, "12 bits: 1 implicit, 11 stored");
        }
    }

    #[test]
    fn the_far_face_and_flat_axes_stay_inside() {
        // 2^30 units: the cell is exactly 1, and the far face would be cell 2^30.
        let bounds = Bounds { min: DVec3::ZERO, max: DVec3::new(1_073_741_824.0, 0.0, 8.0) };
        let cells = Cells::covering(&bounds);
        assert_eq!(cells.quantize(bounds.max), [MAX_CELL, 0, MAX_CELL]);
        assert_eq!(cells.cell[1], 0.0);
        assert_eq!(cells.quantize(bounds.min), [0, 0, 0]);
    }
}
