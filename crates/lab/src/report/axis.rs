//! The axis of a plot: values to places, and round numbers to mark.

/// Most marks on an axis; nobody reads more.
const MAX_TICKS: usize = 40;
/// Range that the begin of a logarithmic axis is clamped to.
const LOG_BEGIN: [f64; 2] = [1e-9, 1e15];

/// How values lie along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scale {
    /// Evenly.
    Linear,
    /// A factor of ten is as long everywhere.
    Log,
}

/// The range of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axis {
    scale: Scale,
    low: f64,
    high: f64,
}

impl Axis {
    /// A linear axis; an empty range is made one unit long.
    pub(super) fn linear(low: f64, high: f64) -> Self {
        let high = if high > low && (high - low).is_finite() { high } else { low + 1.0 };
        Self { scale: Scale::Linear, low, high }
    }

    /// A logarithmic axis of positive values.
    pub(super) fn log(low: f64, high: f64) -> Self {
        let low = if low.is_nan() { LOG_BEGIN[0] } else { low.clamp(LOG_BEGIN[0], LOG_BEGIN[1]) };
        Self { scale: Scale::Log, low, high: if high > low && high.is_finite() { high } else { 10.0 * low } }
    }

    /// An axis for these values: logarithmic from one of 1, 2, 5, 10 …, if the positive values span more than `factor`;
    /// else linear from 0.
    pub(super) fn spanning(values: impl Iterator<Item = f64> + Clone, factor: f64) -> Self {
        let positive = values.filter(|value| *value > 0.0 && value.is_finite());
        let (low, high) = positive.fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
        if high <= low * factor {
            return Self::linear(0.0, 1.05 * high);
        }
        let below = |value: f64| {
            let decade = 10f64.powf(value.log10().floor());
            [5.0, 2.0].map(|m| m * decade).into_iter().find(|step| *step <= 0.8 * value).unwrap_or(decade)
        };
        Self::log(below(low), 1.1 * high)
    }

    /// How values lie along it.
    pub(super) fn scale(&self) -> Scale {
        self.scale
    }

    /// Where a value lies, from 0 to 1; values beyond the ends lie at the ends.
    pub(super) fn place(&self, value: f64) -> f64 {
        let place = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => (value.max(LOG_BEGIN[0]) / self.low).ln() / (self.high / self.low).ln(),
        };
        // NaN, which nobody should ask for, lies at the beginning.
        if place > 0.0 { place.min(1.0) } else { 0.0 }
    }

    /// Round values on the axis, about `num` of them.
    pub(super) fn ticks(&self, num: usize) -> Vec<f64> {
        match self.scale {
            Scale::Linear => {
                let step = round_up((self.high - self.low) / num.max(1) as f64);
                let first = (self.low / step - 1e-9).ceil();
                let ticks = (0..MAX_TICKS).map(|i| (first + i as f64) * step);
                ticks.take_while(|tick| *tick <= self.high + 1e-9 * step).collect()
            }
            Scale::Log => {
                let decades = (self.high / self.low).log10();
                let per_decade: &[f64] =
                    if decades * 3.0 <= 1.5 * num as f64 { &[1.0, 2.0, 5.0] } else { &[1.0] };
                let first = self.low.log10().floor() as i32;
                let all = (first..first + MAX_TICKS as i32)
                    .flat_map(|power| per_decade.iter().map(move |m| m * 10f64.powi(power)));
                all.filter(|tick| (self.low * 0.999..=self.high * 1.001).contains(tick))
                    .take(MAX_TICKS)
                    .collect()
            }
        }
    }
}

/// Rounds up to the next of 1, 2, 5, 10, 20 … times a power of ten.
fn round_up(value: f64) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0]
        .map(|m| m * decade)
        .into_iter()
        .find(|step| *step >= value * 0.999)
        .unwrap_or(10.0 * decade)
}

/// A mark's value without trailing zeros.
pub(super) fn label(value: f64) -> String {
    let digits = if value.abs() >= 1e6 { format!("{value:e}") } else { format!("{value:.6}") };
    if digits.contains('.') && !digits.contains('e') {
        digits.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        digits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_on_the_axis() {
        let labels = |axis: Axis, num| axis.ticks(num).into_iter().map(label).collect::<Vec<_>>();
        assert_eq!(labels(Axis::linear(0.0, 11.1), 5), ["0", "5", "10"]);
        assert_eq!(labels(Axis::linear(0.6, 1.0), 2), ["0.6", "0.8", "1"]);
        assert_eq!(labels(Axis::log(0.5, 120.0), 8), ["0.5", "1", "2", "5", "10", "20", "50", "100"]);
        assert_eq!(labels(Axis::log(0.5, 120.0), 3), ["1", "10", "100"]);
    }

    #[test]
    fn places_span_the_axis() {
        for axis in [Axis::linear(2.0, 10.0), Axis::log(2.0, 10.0)] {
            assert_eq!(axis.place(2.0), 0.0);
            assert!((axis.place(10.0) - 1.0).abs() < 1e-12);
            assert_eq!([axis.place(-5.0), axis.place(1e9), axis.place(f64::NAN)], [0.0, 1.0, 0.0]);
        }
        assert!((Axis::log(1.0, 100.0).place(10.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn wide_spans_become_logarithmic() {
        let axis = Axis::spanning([0.7, 3.0, 900.0].into_iter(), 20.0);
        assert_eq!(axis.scale(), Scale::Log);
        assert!(axis.place(0.7) > 0.0 && axis.place(900.0) < 1.0);
        assert_eq!(Axis::spanning([1.0, 3.0].into_iter(), 20.0).scale(), Scale::Linear);
    }

    /// Whatever a file holds, there is no panic and no endless list.
    #[test]
    fn odd_ranges_have_few_ticks() {
        let values = [0.0, -1.0, 1e-300, 1e12, -1e12, 1e300, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE];
        for low in values {
            for high in values {
                for axis in [Axis::linear(low, high), Axis::log(low, high)] {
                    assert!(axis.ticks(8).len() <= MAX_TICKS, "{axis:?}");
                    assert!((0.0..=1.0).contains(&axis.place(1.0)), "{axis:?}");
                }
                let spanning = Axis::spanning([low, high].into_iter(), 20.0);
                assert!(spanning.ticks(8).len() <= MAX_TICKS);
            }
        }
        assert!(Axis::spanning(std::iter::empty(), 20.0).ticks(5).len() <= MAX_TICKS);
    }
}
