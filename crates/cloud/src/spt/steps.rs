//! Lengths in eight bits: the upper end of an f32, with three bits of mantissa.
//!
//! A step is an eighth of an octave, 7 to 12 %, and 32 octaves fit. Shaders turn a length into its step, and back,
//! by a shift, so that they and their CPU references agree to the bit.

use crate::format::{ENDLESS_STEP, STEP_SHIFT};

/// The step above every tolerance: the upper end of the root's interval.
pub const ENDLESS: u8 = ENDLESS_STEP as u8;

/// Which lengths the steps stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepScale {
    /// Number of step 0 among the steps of all positive f32; step 0 itself is the length 0.
    pub base: u32,
}

impl StepScale {
    /// The steps whose last before [`ENDLESS`] holds `largest`.
    #[must_use]
    pub fn up_to(largest: f32) -> Self {
        Self { base: Self::above(largest).saturating_sub(u32::from(ENDLESS) - 1) }
    }

    /// The smallest step that is not less than a length ≥ 0; a length beyond the last step has the last step.
    #[must_use]
    pub fn step(&self, length: f32) -> u8 {
        if length <= 0.0 {
            return 0;
        }
        // The step is at least 1: only the length 0 has step 0.
        Self::above(length).saturating_sub(self.base).clamp(1, u32::from(ENDLESS) - 1) as u8
    }

    /// The largest step that is not more than a length ≥ 0: `step(a) <= step_below(b)` if the length of a's step is at
    /// most b. The result is below [`ENDLESS`], however large the length.
    #[must_use]
    pub fn step_below(&self, length: f32) -> u8 {
        (length.to_bits() >> STEP_SHIFT).saturating_sub(self.base).min(u32::from(ENDLESS) - 1) as u8
    }

    /// The length of a step other than [`ENDLESS`].
    #[must_use]
    pub fn length(&self, step: u8) -> f32 {
        if step == 0 { 0.0 } else { f32::from_bits((self.base + u32::from(step)) << STEP_SHIFT) }
    }

    /// Number of the first step ≥ a length among the steps of all positive f32, which are ordered as their bits.
    fn above(length: f32) -> u32 {
        (length.to_bits() + ((1 << STEP_SHIFT) - 1)) >> STEP_SHIFT
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn steps_round_up_by_an_eighth_at_most(largest in 1e-3f32..1e6, share in 1e-8f32..=1.0) {
            let scale = StepScale::up_to(largest);
            let length = largest * share;
            let rounded = scale.length(scale.step(length));
            prop_assert!(rounded >= length && rounded <= length * 1.126, "{length} {rounded}");
            prop_assert!(scale.length(scale.step_below(length)) <= length);
        }

        #[test]
        fn a_step_is_reached_from_its_length_on(a in 0.0f32..1e3, b in 0.0f32..1e3) {
            let scale = StepScale::up_to(1e3);
            let reached = scale.length(scale.step(a)) <= b;
            prop_assert_eq!(reached, scale.step(a) <= scale.step_below(b));
        }
    }

    #[test]
    fn the_ends_of_the_scale() {
        let scale = StepScale::up_to(100.0);
        assert_eq!((scale.step(0.0), scale.step_below(0.0)), (0, 0));
        assert_eq!(scale.step(100.0), ENDLESS - 1);
        assert_eq!(scale.step_below(1e30), ENDLESS - 1);
        assert_eq!((scale.step(1e-30), scale.step_below(1e-30)), (1, 0));
        assert_eq!(StepScale::up_to(0.0).base, 0);
        // The length of each step has that step.
        assert!((0..ENDLESS).all(|step| scale.step(scale.length(step)) == step));
        assert!((0..ENDLESS).all(|step| scale.step_below(scale.length(step)) == step));
    }
}
