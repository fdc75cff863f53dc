//! Reduces many frames to few pixel columns, so that a page stays small and no spike is lost. A column keeps the first,
//! the lowest, the highest and the last of its values, and a line through these four looks like one through all values.

/// Figures of the values in one pixel column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PixelColumn {
    /// First value in time.
    pub(super) first: f64,
    /// Lowest value.
    pub(super) low: f64,
    /// Highest value.
    pub(super) high: f64,
    /// Last value in time.
    pub(super) last: f64,
    sum: f64,
    num: usize,
}

impl PixelColumn {
    /// Mean of the values.
    pub(super) fn mean(&self) -> f64 {
        self.sum / self.num as f64
    }

    /// Sum of the values.
    pub(super) fn sum(&self) -> f64 {
        self.sum
    }
}

/// Sorts values by their place, from 0 to 1, into `num` columns. NaN is left out; a column without a value is
/// `None`.
pub(super) fn columns(values: impl Iterator<Item = (f64, f64)>, num: usize) -> Vec<Option<PixelColumn>> {
    let mut columns: Vec<Option<PixelColumn>> = vec![None; num];
    for (place, value) in values.filter(|(_, value)| !value.is_nan()) {
        // The cast saturates, so every place has a column, if there is one at all.
        let at = ((place * num as f64) as usize).min(num.saturating_sub(1));
        let Some(column) = columns.get_mut(at) else { continue };
        let PixelColumn { first, low, high, sum, num, .. } = column.unwrap_or(PixelColumn {
            first: value,
            low: value,
            high: value,
            last: value,
            sum: 0.0,
            num: 0,
        });
        *column = Some(PixelColumn {
            first,
            low: low.min(value),
            high: high.max(value),
            last: value,
            sum: sum + value,
            num: num + 1,
        });
    }
    columns
}

/// Fills columns without a value with the one before, since a frame stays until the next.
pub(super) fn held(columns: Vec<Option<PixelColumn>>) -> Vec<Option<PixelColumn>> {
    let mut before = None;
    let hold = |column: Option<PixelColumn>| {
        before = column.or(before);
        before
    };
    columns.into_iter().map(hold).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_spike_is_lost(values in prop::collection::vec(-100.0f64..100.0, 1..500), num in 1usize..50) {
            let places = values.iter().enumerate().map(|(i, v)| (i as f64 / values.len() as f64, *v));
            let columns: Vec<PixelColumn> = columns(places, num).into_iter().flatten().collect();
            let fold = |start, f: fn(f64, f64) -> f64| values.iter().copied().fold(start, f);
            let high = columns.iter().map(|c| c.high).fold(f64::NEG_INFINITY, f64::max);
            let low = columns.iter().map(|c| c.low).fold(f64::INFINITY, f64::min);
            prop_assert_eq!(high, fold(f64::NEG_INFINITY, f64::max));
            prop_assert_eq!(low, fold(f64::INFINITY, f64::min));
            let sum: f64 = columns.iter().map(PixelColumn::sum).sum();
            prop_assert!((sum - values.iter().sum::<f64>()).abs() < 1e-6);
            prop_assert_eq!((columns[0].first, columns[columns.len() - 1].last), (values[0], values[values.len() - 1]));
        }
    }

    #[test]
    fn a_mean_alone_would_lose_the_spike() {
        let spike = |i: i32| (f64::from(i) / 1000.0, if i == 500 { 50.0 } else { 5.0 });
        let columns = columns((0..1000).map(spike), 10);
        let of = |f: fn(&PixelColumn) -> f64| columns.iter().flatten().map(f).fold(0.0, f64::max);
        assert_eq!(of(|c| c.high), 50.0);
        assert!(of(PixelColumn::mean) < 6.0);
    }

    #[test]
    fn places_off_the_end_and_values_that_are_none() {
        let odd = [(-1.0, 1.0), (7.0, 2.0), (f64::NAN, 3.0), (0.5, f64::NAN)];
        let found = columns(odd.into_iter(), 3);
        assert_eq!(found.iter().map(|c| c.map(|c| c.last)).collect::<Vec<_>>(), [Some(3.0), None, Some(2.0)]);
        assert_eq!(held(found)[1].map(|c| c.last), Some(3.0));
        assert!(columns([(0.0, 1.0)].into_iter(), 0).is_empty());
    }
}
