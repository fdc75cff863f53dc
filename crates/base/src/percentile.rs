//! Exact percentiles by the nearest rank, and the median.

/// The percentiles that reports show, in per mille: 50, 90, 99, 99.9 and the maximum.
pub const REPORTED_PER_MILLE: [usize; 5] = [500, 900, 990, 999, 1000];

/// The place of a percentile among `num` ascending values, counted from 1; 0 gives the first, 1000 the last.
#[must_use]
pub fn rank(num: usize, per_mille: usize) -> usize {
    (num * per_mille.min(1000)).div_ceil(1000).max(1)
}

/// The place before the middle of `num` ascending values, one or more, and the place after it, counted from 0. Both are
/// the same if there is a middle value.
#[must_use]
pub fn middle(num: usize) -> [usize; 2] {
    [(num - 1) / 2, num / 2]
}

/// Values in ascending order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sorted(Vec<f64>);

impl Sorted {
    /// Sorts; NaN, which stands for "not measured", is left out.
    #[must_use]
    pub fn new(values: impl IntoIterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.into_iter().filter(|value| !value.is_nan()).collect();
        values.sort_unstable_by(f64::total_cmp);
        Self(values)
    }

    /// The smallest value that at least `per_mille` thousandths of the values do not exceed; `None` if there
    /// is no value. 0 gives the smallest, 1000 the largest.
    #[must_use]
    pub fn percentile(&self, per_mille: usize) -> Option<f64> {
        self.0.get(rank(self.0.len(), per_mille) - 1).copied()
    }

    /// The middle value, or the mean of the two in the middle; `None` if there is no value.
    #[must_use]
    pub fn median(&self) -> Option<f64> {
        if self.0.is_empty() {
            return None;
        }
        let [before, after] = middle(self.0.len()).map(|at| self.0[at]);
        Some(f64::midpoint(before, after))
    }

    /// How many values there are.
    #[must_use]
    pub fn num(&self) -> usize {
        self.0.len()
    }

    /// The values, ascending.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.0
    }

    /// Sum of all values.
    #[must_use]
    pub fn sum(&self) -> f64 {
        self.0.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The percentile by its definition, word for word.
    fn naive(values: &[f64], per_mille: usize) -> Option<f64> {
        let not_above = |v: f64| values.iter().filter(|w| **w <= v).count();
        let enough = |v: &&f64| not_above(**v) * 1000 >= per_mille * values.len();
        values.iter().filter(enough).copied().min_by(f64::total_cmp)
    }

    proptest! {
        #[test]
        fn percentiles_follow_their_definition(
            values in prop::collection::vec((-50i32..50).prop_map(f64::from), 0..300),
            per_mille in 0usize..=1000,
        ) {
            prop_assert_eq!(Sorted::new(values.clone()).percentile(per_mille), naive(&values, per_mille));
        }
    }

    proptest! {
        /// As many values lie above the median as below.
        #[test]
        fn a_median_halves_its_values(values in prop::collection::vec((-50i32..50).prop_map(f64::from), 1..60)) {
            let median = Sorted::new(values.clone()).median().unwrap();
            let [below, above] = [|v: f64, m: f64| v < m, |v: f64, m: f64| v > m]
                .map(|is| values.iter().filter(|v| is(**v, median)).count());
            prop_assert!(2 * below <= values.len() && 2 * above <= values.len());
            let mirrored = Sorted::new(values.iter().map(|v| -v)).median().unwrap();
            prop_assert_eq!(mirrored, -median);
        }
    }

    #[test]
    fn an_even_number_of_values_has_a_median_between_two() {
        let four = Sorted::new([8.0, 1.0, 4.0, 2.0]);
        assert_eq!(four.median(), Some(3.0));
        assert_eq!(four.percentile(500), Some(2.0), "the nearest rank is one of the values");
        assert_eq!(Sorted::new([8.0, 1.0, 4.0]).median(), Some(4.0));
        assert_eq!(Sorted::new([f64::NAN]).median(), None);
    }

    #[test]
    fn known_percentiles() {
        let thousand = Sorted::new((1..=1000).rev().map(f64::from));
        let found = REPORTED_PER_MILLE.map(|p| thousand.percentile(p).unwrap());
        assert_eq!(found, [500.0, 900.0, 990.0, 999.0, 1000.0]);
        assert_eq!(Sorted::new([f64::NAN, 2.0, f64::NAN]).percentile(500), Some(2.0), "NaN is left out");
        assert_eq!(Sorted::new([f64::NAN]).percentile(500), None);
        // The comparison can fail: the rank below is another value.
        assert_ne!(thousand.percentile(499), naive(&(1..=1000).map(f64::from).collect::<Vec<_>>(), 500));
    }
}
