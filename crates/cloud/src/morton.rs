//! Morton (z-order) codes of 21 bits an axis: points that are near in space become near in memory.

use base::space::Bounds;
use glam::DVec3;

/// Bits an axis; three of them fill 63 bits.
pub const BITS: u32 = 21;

/// World positions to codes within one cubic grid.
#[derive(Clone, Copy, Debug)]
pub struct MortonGrid {
    min: DVec3,
    cells_per_unit: f64,
}

impl MortonGrid {
    /// The grid over `bounds`: cubic cells, the longest edge is 2²¹ of them.
    #[must_use]
    pub fn new(bounds: &Bounds) -> Self {
        Self::of_cube(bounds.min, bounds.size().max_element())
    }

    /// The grid over the cube with its smallest corner at `min`: 2²¹ cells an axis.
    #[must_use]
    pub fn of_cube(min: DVec3, edge: f64) -> Self {
        let cells_per_unit = if edge > 0.0 { f64::from(1 << BITS) / edge } else { 0.0 };
        Self { min, cells_per_unit }
    }

    /// Code of a position; positions outside are clamped to the border.
    #[must_use]
    pub fn code(&self, p_in_world: DVec3) -> u64 {
        // A cast from float saturates, so only the upper end needs a clamp.
        let cell = |v: f64| ((v * self.cells_per_unit) as u64).min((1 << BITS) - 1);
        let d = p_in_world - self.min;
        spread(cell(d.x)) | spread(cell(d.y)) << 1 | spread(cell(d.z)) << 2
    }
}

/// Moves bit i of a 21-bit number to bit 3i.
#[must_use]
pub fn spread(v: u64) -> u64 {
    let mut v = v & 0x1f_ffff;
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

/// Inverse of [`spread`]: bit 3i to bit i; the bits between are ignored.
#[must_use]
pub fn compact(code: u64) -> u64 {
    let mut v = code & 0x1249_2492_4924_9249;
    v = (v | v >> 2) & 0x10c3_0c30_c30c_30c3;
    v = (v | v >> 4) & 0x100f_00f0_0f00_f00f;
    v = (v | v >> 8) & 0x001f_0000_ff00_00ff;
    v = (v | v >> 16) & 0x001f_0000_0000_ffff;
    (v | v >> 32) & 0x1f_ffff
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Moves the bits one by one, as the definition says.
    fn spread_by_definition(v: u64) -> u64 {
        (0..BITS).map(|i| (v >> i & 1) << (3 * i)).sum()
    }

    proptest! {
        #[test]
        fn spread_follows_the_definition(v in 0u64..1 << BITS) {
            prop_assert_eq!(spread(v), spread_by_definition(v));
        }

        #[test]
        fn compact_undoes_spread_whatever_lies_between(v in 0u64..1 << BITS, other in 0u64..1 << BITS) {
            prop_assert_eq!(compact(spread(v) | spread(other) << 1 | spread(other) << 2), v);
        }

        #[test]
        fn codes_order_octants_before_cells(a in 0.0f64..1.0, b in 0.0f64..1.0, c in 0.0f64..1.0) {
            let grid = MortonGrid::new(&Bounds { min: DVec3::ZERO, max: DVec3::ONE });
            let code = grid.code(DVec3::new(a, b, c));
            let octant = u64::from(a >= 0.5) | u64::from(b >= 0.5) << 1 | u64::from(c >= 0.5) << 2;
            prop_assert_eq!(code >> 60, octant);
        }
    }

    #[test]
    fn faces_and_flat_clouds_stay_inside() {
        let grid = MortonGrid::new(&Bounds { min: DVec3::ZERO, max: DVec3::new(4.0, 0.0, 2.0) });
        let far = grid.code(DVec3::new(4.0, 0.0, 2.0));
        assert_eq!(far, spread((1 << BITS) - 1) | spread(1 << (BITS - 1)) << 2);
        let point = MortonGrid::new(&Bounds { min: DVec3::ONE, max: DVec3::ONE });
        assert_eq!(point.code(DVec3::ONE), 0);
        assert_eq!(grid.code(DVec3::splat(-1.0)), 0);
    }
}
