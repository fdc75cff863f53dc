//! The integer grid of coordinates, and how places with any coordinates are put on a grid, one axis at a time.
//!
//! LAS stores whole steps of a grid. Formats that store other numbers get a grid made for their points.
//!
//! A step is the smallest power of two with which the axis' extent has at most 2³² − 3 steps. So a coordinate moves by
//! at most half a step, which is less than the extent / 4 · 10⁹. A f32 whose magnitude is at least 2²⁴ steps, which are
//! at most a 128th of the extent, does not move at all. No f64 moves where the extent is less than a 2²¹th of the
//! distance from zero. The grid's origin is a whole number of steps from zero.
//!
//! One point far away would make the steps coarse for all others. So the extent covers only points that can be held
//! without cost to the scene: steps are never coarser than a 2²²th of the scene. Points beyond are left out.

use crate::{FARTHEST, scene};
use base::space::Bounds;
use glam::DVec3;

/// The integer grid of a file's coordinates: `p_in_world = offset + scale · xyz`, exactly as LAS stores it, and as
/// readers choose it for formats that store other numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// World units per step along each axis; finite and not zero.
    pub scale: DVec3,
    /// World position of the grid's origin; finite.
    pub offset: DVec3,
}

impl Default for Grid {
    /// A grid of whole units from the origin.
    fn default() -> Self {
        Self { scale: DVec3::ONE, offset: DVec3::ZERO }
    }
}

impl Grid {
    /// World position of a grid point.
    #[must_use]
    pub fn p_in_world(&self, xyz: [i32; 3]) -> DVec3 {
        self.offset + self.scale * DVec3::new(f64::from(xyz[0]), f64::from(xyz[1]), f64::from(xyz[2]))
    }
}

/// Coordinates beyond this are no place: their sums and differences might not be finite.
const MOST: f64 = 1e300;

/// Step where all coordinates are equal, so that any would do: about a millimeter.
const ANY_STEP: f64 = 1.0 / 1024.0;

/// Edges of the scene that can be held round it: steps are then a 2²²th of the scene.
const HELD: f64 = 511.0;
/// A scene's thickness counts as at least this part of its longest edge, so that flat scenes have one.
const LEAST_THICKNESS: f64 = 1.0 / 1024.0;

/// True for coordinates that can be put on a grid.
pub(crate) fn is_place(p: &[f64; 3]) -> bool {
    // NaN compares as false.
    p.iter().all(|c| c.abs() <= MOST)
}

/// A grid made for places, and the box of those that it holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FittedGrid {
    pub grid: Grid,
    /// Steps per unit along each axis.
    per_unit: [f64; 3],
    held: Bounds,
}

impl FittedGrid {
    /// The grid for places that have this box, and of which these are an even sample.
    pub fn over(mut sample: Vec<DVec3>, all: Bounds) -> Self {
        let most = Bounds { min: DVec3::splat(-FARTHEST), max: DVec3::splat(FARTHEST) };
        sample.retain(|&p| most.contains(p));
        let Some(scene) = scene::find(sample.clone()) else {
            return Self {
                held: Bounds::EMPTY,
                ..Self::of_box(Bounds { min: DVec3::ZERO, max: DVec3::ZERO })
            };
        };
        if most.contains(all.min) && most.contains(all.max) && is_fine_enough(&all, &scene) {
            return Self::of_box(all);
        }
        let reach = scene.grown(HELD * scene.edge());
        sample.retain(|&p| reach.contains(p));
        // Places outside the sample may be a little further out.
        let held = Bounds::around(&sample).grown(scene.edge());
        Self::of_box(Bounds { min: held.min.max(all.min), max: held.max.min(all.max) })
    }

    /// The grid for a box that is not empty.
    fn of_box(held: Bounds) -> Self {
        let grid = grid(held);
        // The reciprocal of a power of two is exact.
        Self { grid, per_unit: grid.scale.recip().to_array(), held }
    }

    /// True for places that the grid holds.
    #[inline]
    pub fn holds(&self, p: &[f64; 3]) -> bool {
        self.held.contains(DVec3::from_array(*p))
    }

    /// The grid point nearest to a place that the grid holds.
    #[inline]
    pub fn snap(&self, p: &[f64; 3]) -> [i32; 3] {
        let offset = self.grid.offset.to_array();
        std::array::from_fn(|axis| nearest((p[axis] - offset[axis]) * self.per_unit[axis]))
    }
}

/// The grid for a box that is not empty.
fn grid(bounds: Bounds) -> Grid {
    let axes: [(f64, f64); 3] = std::array::from_fn(|axis| axis_grid(bounds.min[axis], bounds.max[axis]));
    Grid {
        scale: DVec3::from_array(axes.map(|(step, _)| step)),
        offset: DVec3::from_array(axes.map(|(_, origin)| origin)),
    }
}

/// The nearest 32-bit integer, the even one of two equally near: adding 1.5 · 2⁵² leaves no bits for a fraction.
/// `round` is a function call that takes longer than the rest, unless a build asks for processors with SSE 4.1.
#[inline]
fn nearest(value: f64) -> i32 {
    const NO_FRACTION: f64 = 1.5 * (1u64 << 52) as f64;
    // A value half a step beyond the box is still its last step.
    let value = value.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
    (value + NO_FRACTION).to_bits() as i32
}

/// True if the grid over all places has steps that are fine enough for the scene.
fn is_fine_enough(all: &Bounds, scene: &Bounds) -> bool {
    let [of_all, of_scene] = [*all, *scene].map(|bounds| grid(bounds).scale);
    let thickness = scene.size().max(DVec3::splat(LEAST_THICKNESS * scene.edge()));
    let coarsest = thickness * (2.0 * (HELD + 1.0) / 2f64.powi(32));
    of_all.cmple(coarsest.max(of_scene)).all()
}

/// Step and origin for coordinates from `low` to `high`.
fn axis_grid(low: f64, high: f64) -> (f64, f64) {
    if low == high {
        return (ANY_STEP, low);
    }
    let half_extent = 0.5 * (high - low);
    let needed = power_of_two_from(half_extent / f64::from(i32::MAX - 1));
    // No step needs to be finer than half the largest coordinate's last bit: the next smaller power of two has bits
    // that fine.
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

/// The largest power of two that is not above `value`, which is positive and finite; 0 if `value` is subnormal.
fn power_of_two_below(value: f64) -> f64 {
    f64::from_bits(value.to_bits() & !MANTISSA)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn on_grid(places: &[[f64; 3]]) -> (Grid, Vec<[f64; 3]>) {
        let grid = grid(places);
        let snapped = |place: &[f64; 3]| grid.grid.p_in_world(grid.snap(place)).to_array();
        (grid.grid, places.iter().map(snapped).collect())
    }

    fn grid(places: &[[f64; 3]]) -> FittedGrid {
        let bounds = places.iter().fold(Bounds::EMPTY, |bounds, p| bounds.with(DVec3::from_array(*p)));
        FittedGrid::of_box(bounds)
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
            let (grid, moved) = on_grid(&places);
            let step = grid.scale.x;
            prop_assert!(step > 0.0 && step.is_finite() && grid.offset.is_finite());
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
            let (grid, moved) = on_grid(&places);
            for (was, is) in axis(&places).into_iter().zip(axis(&moved)) {
                prop_assert!(was == is || was.abs() < grid.scale.x * f64::from(1 << 24), "{was} to {is}");
            }
        }

        #[test]
        fn doubles_far_from_zero_do_not_move(base in 1e6..2e6, deltas in proptest::collection::vec(0.0..0.4, 2..50)) {
            let places: Vec<[f64; 3]> = deltas.iter().map(|delta| [base + delta; 3]).collect();
            prop_assert_eq!(on_grid(&places).1, places);
        }
    }

    #[test]
    fn the_bound_is_one_that_can_be_broken() {
        let values = [0.0, 1.0, 0.3];
        let places = values.map(|v| [v; 3]);
        let FittedGrid { grid, per_unit, held } = grid(&places);
        let grid = Grid { scale: grid.scale * 8.0, ..grid };
        let coarse = FittedGrid { grid, per_unit: per_unit.map(|steps| steps / 8.0), held };
        let moved = grid.p_in_world(coarse.snap(&places[2])).x;
        assert!((moved - 0.3).abs() > 1.0 / 4e9, "{moved}");
    }

    #[test]
    fn what_the_grid_does_not_reach_is_none() {
        let grid = grid(&[[0.0; 3], [1.0; 3]]);
        assert!(grid.holds(&[1.0, 0.0, 1.0]));
        assert!(!grid.holds(&[9.0, 0.0, 0.0]) && !grid.holds(&[0.0, -1e300, 0.0]));
    }

    /// The grid for places that are all in the sample.
    fn of(places: &[[f64; 3]]) -> FittedGrid {
        let sample: Vec<DVec3> = places.iter().map(|&p| DVec3::from_array(p)).collect();
        let bounds = Bounds::around(&sample);
        FittedGrid::over(sample, bounds)
    }

    /// Places all over a cube of edge `size` at `origin`.
    fn cube(num: usize, size: f64, origin: f64) -> Vec<[f64; 3]> {
        let part = |i: usize, step: f64| origin + size * (i as f64 * step).fract();
        (0..num).map(|i| [part(i, 0.618_034), part(i, 0.754_878), part(i, 0.569_840)]).collect()
    }

    /// Largest distance along an axis that one of the places moves by.
    fn moved(grid: &FittedGrid, places: &[[f64; 3]]) -> f64 {
        let moved = |p: &[f64; 3]| (grid.grid.p_in_world(grid.snap(p)) - DVec3::from_array(*p)).abs();
        places.iter().map(|p| moved(p).max_element()).fold(0.0, f64::max)
    }

    #[test]
    fn far_places_never_cost_the_scene_its_precision() {
        for num in [20, 1000, 300_000] {
            for (size, origin) in [(1.0, 0.0), (5e-5, 0.0), (20.0, 5e6), (5e4, 5e5)] {
                let scene = cube(num, size, origin);
                for far in [10.0, 300.0, 2e4, 1e9, 3e12, 1e15, 1e38, 1e300] {
                    let strays = [[far * size, origin, 0.0], [0.0, origin, -far * size], [far; 3]];
                    let places: Vec<[f64; 3]> = scene.iter().copied().chain(strays).collect();
                    let grid = of(&places);
                    let what = format!("{num} within {size} at {origin}, strays at {far}: {grid:?}");
                    assert!(scene.iter().all(|p| grid.holds(p)), "{what}");
                    let most = size * 0.6 * 2f64.powi(-22) + 1e-9 * origin;
                    assert!(moved(&grid, &scene) <= most, "{what}: {}", moved(&grid, &scene));
                    if far >= 3e12 {
                        assert!(!strays.iter().any(|p| grid.holds(p)), "{what}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_costs_nothing_is_held() {
        // A tree is a hundred times as high as the rest: nothing is left out, and doubles stay as fine as they are.
        let places: Vec<[f64; 3]> = cube(1000, 10.0, 0.0).into_iter().chain([[5.0, 5.0, 1e3]]).collect();
        let all = of(&places);
        assert!(places.iter().all(|p| all.holds(p)) && moved(&all, &places) < 1e-6);
        // The comparison can fail: a grid over everything moves a scene that has a stray.
        let places: Vec<[f64; 3]> = cube(1000, 1.0, 0.0).into_iter().chain([[1e9; 3]]).collect();
        assert!(moved(&grid(&places), &places[..1000]) > 0.1);
        // No place is held if all are far out.
        assert!(!of(&[[1e20; 3]]).holds(&[1e20; 3]));
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
        let (grid, moved) = on_grid(&[place, place]);
        assert_eq!((grid.scale, moved), (DVec3::splat(ANY_STEP), vec![place; 2]));
        for none in [f64::NAN, f64::INFINITY, -1e301] {
            assert!(!is_place(&[0.0, none, 0.0]));
        }
        assert!(is_place(&[1e300, -1e300, 0.0]));
    }
}
