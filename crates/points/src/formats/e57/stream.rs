//! How the values of one kind are stored: packed bit by bit, one point's after the other's.

use crate::column::{Column, Type};

/// Bytes behind packed values that may be read together with them.
pub(super) const SPARE_BYTES: usize = 16;

/// What is stored under one name for each point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stream {
    /// "cartesianX", or with the prefix of its extension: "nor:normalX".
    pub name: String,
    pub encoding: NumberCoding,
}

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NumberCoding {
    /// A float of 32 bits.
    Single,
    /// A float of 64 bits.
    Double,
    /// A whole number from `min` to `max`, less `min`, in as few bits as that needs. Its value is
    /// `offset + scale · number`.
    Whole { min: i64, max: i64, scale: f64, offset: f64 },
}

impl NumberCoding {
    /// Bits of a number.
    pub fn bits(&self) -> u32 {
        match *self {
            Self::Single => 32,
            Self::Double => 64,
            Self::Whole { min, max, .. } if max <= min => 0,
            Self::Whole { min, max, .. } => u64::BITS - max.abs_diff(min).leading_zeros(),
        }
    }

    /// The least and the largest whole number; `None` for floats.
    pub fn range(&self) -> Option<(i64, i64)> {
        match *self {
            Self::Whole { min, max, .. } => Some((min, max.max(min))),
            _ => None,
        }
    }

    /// Scale and offset.
    pub fn scaling(&self) -> (f64, f64) {
        match *self {
            Self::Whole { scale, offset, .. } => (scale, offset),
            _ => (1.0, 0.0),
        }
    }

    /// True for whole numbers that stand for themselves.
    pub fn is_plain_whole(&self) -> bool {
        matches!(self, Self::Whole { scale, offset, .. } if (*scale, *offset) == (1.0, 0.0))
    }
}

/// The smallest type that holds whole numbers from `low` to `high`.
pub(super) fn whole_type((low, high): (i64, i64)) -> Type {
    let fits = |least: i64, most: i64| low >= least && high <= most;
    if fits(0, u8::MAX.into()) {
        Type::U8
    } else if fits(i8::MIN.into(), i8::MAX.into()) {
        Type::I8
    } else if fits(0, u16::MAX.into()) {
        Type::U16
    } else if fits(i16::MIN.into(), i16::MAX.into()) {
        Type::I16
    } else if fits(0, u32::MAX.into()) {
        Type::U32
    } else if fits(i32::MIN.into(), i32::MAX.into()) {
        Type::I32
    } else {
        Type::I64
    }
}

/// Numbers as they are stored.
#[derive(Debug)]
pub(super) struct PackedNumbers {
    encoding: NumberCoding,
    /// The bytes that have the numbers, and [`SPARE_BYTES`] more.
    bytes: Vec<u8>,
    /// Bit of the first byte at which the first number starts.
    first_bit: usize,
    num_values: usize,
}

impl PackedNumbers {
    /// `num_values` numbers from a bit of the first byte on. Bytes that are missing are 0.
    pub fn new(encoding: NumberCoding, mut bytes: Vec<u8>, first_bit: usize, num_values: usize) -> Self {
        let num_bits = first_bit + num_values * encoding.bits() as usize;
        bytes.resize(num_bits.div_ceil(8) + SPARE_BYTES, 0);
        Self { encoding, bytes, first_bit, num_values }
    }

    /// Calls `take` with the bits of each number.
    #[inline]
    fn each_bits(&self, mut take: impl FnMut(u64)) {
        let bits = self.encoding.bits() as usize;
        let mask = 1u64.checked_shl(bits as u32).map_or(u64::MAX, |end| end - 1);
        for number in 0..self.num_values {
            let at = self.first_bit + number * bits;
            let (byte, shift) = (at / 8, at % 8);
            let word = |bytes: &[u8]| bytes.first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
            let low = word(&self.bytes[byte..]) >> shift;
            let value =
                if shift + bits <= 64 { low } else { low | u64::from(self.bytes[byte + 8]) << (64 - shift) };
            take(value & mask);
        }
    }

    /// Calls `take` with each whole number, which is in the range that is stated. Floats are none.
    #[inline]
    fn each_whole(&self, mut take: impl FnMut(i64)) {
        if let NumberCoding::Whole { min, max, .. } = self.encoding {
            let most = if max > min { max.abs_diff(min) } else { 0 };
            self.each_bits(|bits| take(min.wrapping_add_unsigned(bits.min(most))));
        }
    }

    /// Calls `take` with each value.
    #[inline]
    pub fn each_value(&self, mut take: impl FnMut(f64)) {
        match self.encoding {
            NumberCoding::Single => self.each_bits(|bits| take(f32::from_bits(bits as u32).into())),
            NumberCoding::Double => self.each_bits(|bits| take(f64::from_bits(bits))),
            NumberCoding::Whole { scale: 1.0, offset: 0.0, .. } => {
                self.each_whole(|whole| take(whole as f64))
            }
            NumberCoding::Whole { scale, offset, .. } => {
                self.each_whole(|whole| take(offset + scale * whole as f64))
            }
        }
    }

    /// The values.
    pub fn values(&self) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.num_values);
        self.each_value(|value| values.push(value));
        values
    }

    /// The whole numbers, which are taken to a type that holds them.
    pub fn whole<T>(&self, of: impl Fn(i64) -> T) -> Vec<T> {
        let mut values = Vec::with_capacity(self.num_values);
        self.each_whole(|whole| values.push(of(whole)));
        values
    }

    /// A column of this type: of the numbers as they are stored if they are whole and so is the type, or else of the
    /// values.
    pub fn column(&self, kind: Type) -> Column {
        let is_whole = matches!(self.encoding, NumberCoding::Whole { .. });
        match kind {
            Type::U8 if is_whole => Column::U8(self.whole(|v| v as u8)),
            Type::I8 if is_whole => Column::I8(self.whole(|v| v as i8)),
            Type::U16 if is_whole => Column::U16(self.whole(|v| v as u16)),
            Type::I16 if is_whole => Column::I16(self.whole(|v| v as i16)),
            Type::U32 if is_whole => Column::U32(self.whole(|v| v as u32)),
            Type::I32 if is_whole => Column::I32(self.whole(|v| v as i32)),
            Type::I64 if is_whole => Column::I64(self.whole(|v| v)),
            Type::F32 => Column::F32(self.values().into_iter().map(|v| v as f32).collect()),
            _ => Column::F64(self.values()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Packs numbers behind `first_bit` zeros.
    fn packed(encoding: NumberCoding, first_bit: usize, numbers: &[i64]) -> PackedNumbers {
        let NumberCoding::Whole { min, .. } = encoding else { panic!() };
        let mut bits = vec![false; first_bit];
        for number in numbers {
            let value = number.wrapping_sub(min) as u64;
            bits.extend((0..encoding.bits()).map(|bit| value >> bit & 1 == 1));
        }
        let bytes =
            bits.chunks(8).map(|byte| byte.iter().rev().fold(0, |byte, bit| byte << 1 | u8::from(*bit)));
        PackedNumbers::new(encoding, bytes.collect(), first_bit, numbers.len())
    }

    proptest! {
        #[test]
        fn numbers_of_any_width_are_unpacked(a in any::<i64>(), b in any::<i64>(), shift in 0..64u32, first_bit in 0..8usize, parts in proptest::collection::vec(any::<u64>(), 0..40)) {
            let (a, b) = (a >> shift, b >> shift);
            let (min, max) = (a.min(b), a.max(b));
            let encoding = NumberCoding::Whole { min, max, scale: 1.0, offset: 0.0 };
            let width = u128::from(max.abs_diff(min)) + 1;
            let numbers: Vec<i64> = parts.iter().map(|part| (i128::from(min) + (u128::from(*part) % width) as i128) as i64).collect();
            let packed = packed(encoding, first_bit, &numbers);
            prop_assert_eq!(packed.whole(|v| v), numbers.clone());
            prop_assert_eq!(packed.values(), numbers.iter().map(|v| *v as f64).collect::<Vec<_>>());
        }
    }

    #[test]
    fn widths_are_the_smallest_that_do() {
        let bits = |min, max| NumberCoding::Whole { min, max, scale: 1.0, offset: 0.0 }.bits();
        let widths = [(0, 0), (5, 5), (0, 1), (0, 2), (0, 255), (-1, 255), (i64::MIN, i64::MAX), (3, -3)];
        assert_eq!(widths.map(|(min, max)| bits(min, max)), [0, 0, 1, 2, 8, 9, 64, 0]);
        let constant =
            PackedNumbers::new(NumberCoding::Whole { min: 7, max: 7, scale: 0.5, offset: 1.0 }, vec![], 0, 3);
        assert_eq!(constant.values(), [4.5; 3]);
    }

    #[test]
    fn types_are_the_smallest_that_do() {
        let ranges = [(0, 255), (-1, 127), (0, 256), (-1, 128), (0, 65536), (-40_000, 0), (0, i64::MAX)];
        let types = [Type::U8, Type::I8, Type::U16, Type::I16, Type::U32, Type::I32, Type::I64];
        assert_eq!(ranges.map(whole_type), types);
        let packed =
            packed(NumberCoding::Whole { min: -1, max: 127, scale: 0.5, offset: 0.0 }, 0, &[-1, 127]);
        assert_eq!(packed.column(Type::I8), Column::I8(vec![-1, 127]));
        assert_eq!(packed.column(Type::F32), Column::F32(vec![-0.5, 63.5]));
    }

    #[test]
    fn floats_are_their_bits() {
        let singles: Vec<u8> = [1.5f32, -0.1].iter().flat_map(|v| v.to_le_bytes()).collect();
        assert_eq!(
            PackedNumbers::new(NumberCoding::Single, singles, 0, 2).column(Type::F32),
            Column::F32(vec![1.5, -0.1])
        );
        let doubles: Vec<u8> = [1.5f64, -0.1].iter().flat_map(|v| v.to_le_bytes()).collect();
        assert_eq!(
            PackedNumbers::new(NumberCoding::Double, doubles, 0, 2).column(Type::F64),
            Column::F64(vec![1.5, -0.1])
        );
    }
}
