//! The vignette: the edge of sight darkens while a stick moves the user, which upsets the stomach less.

/// Seconds in which it comes up fully.
const RISES_S: f64 = 0.1;
/// Seconds in which it goes fully.
const FALLS_S: f64 = 0.2;

/// How far the edge of sight may be darkened while a stick moves the user.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VignetteOptions {
    /// The part of the vignette at start.
    pub at_start: f32,
    /// The least and the greatest part.
    pub range: [f32; 2],
}

#[cfg(test)]
impl VignetteOptions {
    /// Options for tests.
    pub(crate) const fn sample() -> Self {
        Self { at_start: 0.5, range: [0.0, 1.0] }
    }
}

/// How far the edge of sight is darkened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vignette {
    options: VignetteOptions,
    strength: f32,
    now: f64,
}

impl Vignette {
    /// None is there yet.
    #[must_use]
    pub fn new(options: VignetteOptions) -> Self {
        Self { options, strength: options.at_start, now: 0.0 }
    }

    /// What may be chosen.
    #[must_use]
    pub fn options(&self) -> VignetteOptions {
        self.options
    }

    /// The part that is drawn while a stick moves the user.
    #[must_use]
    pub fn strength(&self) -> f32 {
        self.strength
    }

    /// Draws this part from now on, or the nearest that may be chosen.
    pub fn set_strength(&mut self, part: f32) {
        let [least, most] = self.options.range;
        self.strength = part.clamp(least, most);
    }

    /// Comes nearer within `seconds` to what is wanted of somebody who is `moved` by this part of a full stick.
    pub fn advance(&mut self, moved: f64, seconds: f64) {
        let [_, most] = self.options.range;
        let wanted = (moved * f64::from(self.strength)).clamp(0.0, most.into());
        self.now = if wanted > self.now {
            (self.now + seconds / RISES_S).min(wanted)
        } else {
            (self.now - seconds / FALLS_S).max(wanted)
        };
    }

    /// The part that is there.
    #[must_use]
    pub fn now(&self) -> f64 {
        self.now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_comes_in_a_tenth_of_a_second_and_goes_in_a_fifth() {
        let mut vignette = Vignette::new(VignetteOptions::sample());
        vignette.set_strength(1.0);
        vignette.advance(1.0, 0.05);
        assert!((vignette.now() - 0.5).abs() < 1e-9);
        vignette.advance(1.0, 0.06);
        assert_eq!(vignette.now(), 1.0);
        vignette.advance(0.0, 0.1);
        assert!((vignette.now() - 0.5).abs() < 1e-9);
        vignette.advance(0.4, 0.1);
        assert_eq!(vignette.now(), 0.4, "not beyond what is wanted");
        vignette.advance(0.0, 1.0);
        assert_eq!(vignette.now(), 0.0);
    }

    #[test]
    fn it_keeps_to_its_limits() {
        let mut vignette = Vignette::new(VignetteOptions { at_start: 0.5, range: [0.25, 0.75] });
        let mut chosen = |part| {
            vignette.set_strength(part);
            vignette.advance(9.0, 1.0);
            (vignette.strength(), vignette.now())
        };
        assert_eq!([0.0, 0.5, 1.0].map(|part| chosen(part).0), [0.25, 0.5, 0.75]);
        assert_eq!(chosen(1.0).1, 0.75, "a stick that is pushed too far");
    }
}
