//! The vignette: the edge of sight darkens while a stick moves the user, which upsets the stomach less.

/// Seconds in which it comes up fully.
const RISES_S: f64 = 0.1;
/// Seconds in which it goes fully.
const FALLS_S: f64 = 0.2;

/// How far the edge of sight is darkened.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vignette(f64);

impl Vignette {
    /// Comes nearer to `wanted`, 0 to 1, within `seconds`.
    pub fn advance(&mut self, wanted: f64, seconds: f64) {
        let wanted = wanted.clamp(0.0, 1.0);
        self.0 = if wanted > self.0 {
            (self.0 + seconds / RISES_S).min(wanted)
        } else {
            (self.0 - seconds / FALLS_S).max(wanted)
        };
    }

    /// The part that is there, 0 to 1.
    #[must_use]
    pub fn now(&self) -> f64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_comes_in_a_tenth_of_a_second_and_goes_in_a_fifth() {
        let mut vignette = Vignette::default();
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
}
