//! Marks of a few among many points: one bit for each point, up to the last that is marked.

/// Numbers that are marked.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Marks {
    words: Vec<u64>,
}

impl Marks {
    /// Marks a number.
    pub fn set(&mut self, number: usize) {
        if self.words.len() <= number / 64 {
            self.words.resize(number / 64 + 1, 0);
        }
        self.words[number / 64] |= 1 << (number % 64);
    }

    /// True if a number is marked.
    #[must_use]
    pub fn get(&self, number: usize) -> bool {
        self.words.get(number / 64).is_some_and(|word| word >> (number % 64) & 1 == 1)
    }

    /// Number of marks.
    #[must_use]
    pub fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Marks the numbers that another has marked, plus `offset`.
    pub fn append(&mut self, other: &Self, offset: usize) {
        for (at, &word) in other.words.iter().enumerate() {
            let mut left = word;
            while left != 0 {
                self.set(offset + 64 * at + left.trailing_zeros() as usize);
                left &= left - 1;
            }
        }
    }

    /// Keeps only numbers below `len`.
    pub fn truncate(&mut self, len: usize) {
        self.words.truncate(len.div_ceil(64));
        if let Some(last) = self.words.get_mut(len / 64) {
            *last &= (1 << (len % 64)) - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    fn marks(numbers: &BTreeSet<usize>) -> Marks {
        let mut marks = Marks::default();
        numbers.iter().for_each(|&number| marks.set(number));
        marks
    }

    fn numbers(marks: &Marks) -> BTreeSet<usize> {
        (0..2000).filter(|&number| marks.get(number)).collect()
    }

    proptest! {
        #[test]
        fn marks_are_a_set(
            a in proptest::collection::btree_set(0..500usize, 0..50),
            b in proptest::collection::btree_set(0..500usize, 0..50),
            offset in 0..500usize,
            len in 0..600usize,
        ) {
            let mut both = marks(&a);
            prop_assert_eq!(numbers(&both), a.clone());
            both.append(&marks(&b), offset);
            let expected: BTreeSet<usize> = a.iter().copied().chain(b.iter().map(|n| n + offset)).collect();
            prop_assert_eq!(both.count(), expected.len());
            prop_assert_eq!(numbers(&both), expected.clone());
            both.truncate(len);
            prop_assert_eq!(numbers(&both), expected.into_iter().filter(|&n| n < len).collect::<BTreeSet<_>>());
        }
    }
}
