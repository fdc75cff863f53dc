//! Positions of any numbers to a lattice of 32-bit integers, an axis at a time.
//!
//! A step is a power of two: the smallest with which the axis' extent has at most 2³² − 3 steps. So a coordinate
//! moves by half a step at most, which is less than the extent / 4 · 10⁹; and a f32 whose magnitude is 2²⁴ steps
//! or more, a 128th of the extent at most, does not move at all, and no f64 does where the extent is less than a
//! 2²¹th of the distance from zero. The lattice's origin is a whole number of steps from zero.

use crate::scan::Lattice;
use crate::space::Bounds;
use glam::DVec3;

/// Coordinates beyond this are no place: sums and differences of them might not be finite.
const FARTHEST: f64 = 1e300;

/// Step where all coordinates are equal, so that any would do: about a millimetre.
const ANY_STEP: f64 = 1.0 / 1024.0;

/// True for what can be put on a lattice.
pub(super) fn is_place(p: &[f64; 3]) -> bool {
    // NaN compares as false.
    p.iter().all(|c| c.abs() <= FARTHEST)
}

/// The lattice of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub lattice: Lattice,
    /// Steps a unit, an axis.
    per_unit: [f64; 3],
}

impl Grid {
    /// For places in a box that holds something; some of them are a sample.
    pub fn over(_sample: Vec<DVec3>, bounds: Bounds) -> Self {
        let lattice = lattice(bounds);
        // The reciprocal of a power of two is exact.
        Self { lattice, per_unit: lattice.scale.recip().to_array() }
    }

    /// True of places that it holds.
    pub fn holds(&self, p: &[f64; 3]) -> bool {
        let steps = (DVec3::from_array(*p) - self.lattice.offset) * DVec3::from_array(self.per_unit);
        steps.abs().cmple(DVec3::splat(2_147_483_648.0)).all()
    }

    /// The nearest lattice point of a place that it holds.
    #[inline]
    pub fn snap(&self, p: &[f64; 3]) -> [i32; 3] {
        let offset = self.lattice.offset.to_array();
        std::array::from_fn(|axis| nearest((p[axis] - offset[axis]) * self.per_unit[axis]))
    }
}

/// The lattice for a box that holds something.
pub(in crate::scan) fn lattice(bounds: Bounds) -> Lattice {
    let axes: [(f64, f64); 3] = std::array::from_fn(|axis| axis_grid(bounds.min[axis], bounds.max[axis]));
    Lattice {
        scale: DVec3::from_array(axes.map(|(step, _)| step)),
        offset: DVec3::from_array(axes.map(|(_, origin)| origin)),
    }
}

/// The nearest of 32-bit integers, of two the even one: adding 1.5 · 2⁵² leaves no bits for a fraction. `round` is a
/// function call that takes longer than the rest, unless a build asks for processors with SSE 4.1.
#[inline]
fn nearest(value: f64) -> i32 {
    const NO_FRACTION: f64 = 1.5 * (1u64 << 52) as f64;
    // Half a step beyond the box is still its last step.
    let value = value.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
    (value + NO_FRACTION).to_bits() as i32
}

/// Step and origin for coordinates from `low` to `high`.
fn axis_grid(low: f64, high: f64) -> (f64, f64) {
    if low == high {
        return (ANY_STEP, low);
    }
    let half_extent = 0.5 * (high - low);
    let needed = power_of_two_from(half_extent / f64::from(i32::MAX - 1));
    // Half of the largest coordinate's last bit: the next smaller power of two has bits that fine.
    let farthest = low.abs().max(high.abs());
    let finest = 0.5 * f64::EPSILON * power_of_two_below(farthest);
    // Positive subnormal steps would have no finite reciprocal.
    let step = needed.max(finest).max(f64::MIN_POSITIVE);
    (step, ((low + half_extent) / step).round() * step)
}

const MANTISSA: u64 = (1 << 52) - 1;

/// The smallest power of two that is not below `value`, which is positive and finite.
fn power_of_two_from(value: f64) -> f64 {
    f64::from_bits((value.to_bits() + MANTISSA) & !MANTISSA)
}

/// The largest power of two that is not above `value`, which is positive and finite; 0 of subnormal ones.
fn power_of_two_below(value: f64) -> f64 {
    f64::from_bits(value.to_bits() & !MANTISSA)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn on_lattice(places: &[[f64; 3]]) -> (Lattice, Vec<[f64; 3]>) {
        let grid = grid(places);
        let snapped = |place: &[f64; 3]| grid.lattice.p_in_world(grid.snap(place)).to_array();
        (grid.lattice, places.iter().map(snapped).collect())
    }

    fn grid(places: &[[f64; 3]]) -> Grid {
        let bounds = places.iter().fold(Bounds::EMPTY, |bounds, p| bounds.with(DVec3::from_array(*p)));
        Grid::over(Vec::new(), bounds)
    }

    fn axis(places: &[[f64; 3]]) -> Vec<f64> {
        places.iter().map(|p| p[0]).collect()
    }

    fn extent(values: &[f64]) -> f64 {
        values.iter().fold(f64::MIN, |a, &b| a.max(b)) - values.iter().fold(f64::MAX, |a, &b| a.min(b))
    }

    /// Any finite coordinate, the large and the tiny as likely as others.
    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![
            -1e300..1e300,
            -1e3..1e3,
            (-300..300i32, 1.0..10.0, any::<bool>()).prop_map(|(e, m, s): (i32, f64, bool)| if s {
                m
            } else {
                -m
            } * 10f64
                .powi(e)),
            5e6..5.001e6,
            Just(0.0),
            (0..100u64).prop_map(f64::from_bits),
        ]
    }

    proptest! {
        #[test]
        fn nothing_moves_by_more_than_half_a_step(values in proptest::collection::vec(coordinate(), 1..20)) {
            let places: Vec<[f64; 3]> = values.iter().map(|&v| [v; 3]).collect();
            let (lattice, moved) = on_lattice(&places);
            let step = lattice.scale.x;
            prop_assert!(step > 0.0 && step.is_finite() && lattice.offset.is_finite());
            let extent = extent(&values);
            prop_assert!(step == ANY_STEP || step <= extent / 2e9 || step == f64::MIN_POSITIVE || extent < values[0].abs() / 1e6);
            for (was, is) in values.iter().zip(axis(&moved)) {
                // The difference is rounded, by far less than a step.
                let most = if extent == 0.0 { 0.0 } else { 0.5 * step * (1.0 + 1e-6) };
                prop_assert!((was - is).abs() <= most, "{was} to {is}, step {step}");
                let bound = (extent / 4e9).max(f64::MIN_POSITIVE);
                prop_assert!((was - is).abs() <= bound, "{was} to {is}, extent {extent}");
            }
        }

        #[test]
        fn floats_move_only_near_zero(values in proptest::collection::vec(-1000f32..1000.0, 2..50)) {
            let places: Vec<[f64; 3]> = values.iter().map(|&v| [f64::from(v); 3]).collect();
            let (lattice, moved) = on_lattice(&places);
            for (was, is) in axis(&places).into_iter().zip(axis(&moved)) {
                prop_assert!(was == is || was.abs() < lattice.scale.x * f64::from(1 << 24), "{was} to {is}");
            }
        }

        #[test]
        fn doubles_far_from_zero_do_not_move(base in 1e6..2e6, deltas in proptest::collection::vec(0.0..0.4, 2..50)) {
            let places: Vec<[f64; 3]> = deltas.iter().map(|delta| [base + delta; 3]).collect();
            prop_assert_eq!(on_lattice(&places).1, places);
        }
    }

    #[test]
    fn the_bound_is_one_that_can_be_broken() {
        let values = [0.0, 1.0, 0.3];
        let places = values.map(|v| [v; 3]);
        let Grid { lattice, per_unit } = grid(&places);
        let lattice = Lattice { scale: lattice.scale * 8.0, ..lattice };
        let coarse = Grid { lattice, per_unit: per_unit.map(|steps| steps / 8.0) };
        let moved = lattice.p_in_world(coarse.snap(&places[2])).x;
        assert!((moved - 0.3).abs() > 1.0 / 4e9, "{moved}");
    }

    #[test]
    fn what_the_lattice_does_not_reach_is_none() {
        let grid = grid(&[[0.0; 3], [1.0; 3]]);
        assert!(grid.holds(&[1.0, 0.0, 1.0]));
        assert!(!grid.holds(&[9.0, 0.0, 0.0]) && !grid.holds(&[0.0, -1e300, 0.0]));
    }

    #[test]
    fn the_nearest_integer_is_taken() {
        let values = [0.0, 0.4, -0.6, 2.5, -3.5, 2147483646.7, 2147483647.5, -2147483648.5, -2147483647.4];
        let expected = [0, 0, -1, 2, -4, i32::MAX, i32::MAX, i32::MIN, i32::MIN + 1];
        assert_eq!(values.map(nearest), expected);
    }

    #[test]
    fn one_place_is_kept_and_none_is_refused() {
        let place = [1.234_57, 12_345.678_9, 1_234_567_890.123_45];
        let (lattice, moved) = on_lattice(&[place, place]);
        assert_eq!((lattice.scale, moved), (DVec3::splat(ANY_STEP), vec![place; 2]));
        for none in [f64::NAN, f64::INFINITY, -1e301] {
            assert!(!is_place(&[0.0, none, 0.0]));
        }
        assert!(is_place(&[1e300, -1e300, 0.0]));
    }
}
