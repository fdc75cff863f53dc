//! The numbers of a PLY file: their types, and how they stand in bytes and in text.

use crate::column::{self, Number};
use crate::formats::number::{number, packed_bits, plain_number};
use std::io::{self, BufRead};

/// Type of a single value, which PLY calls scalar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    Char,
    UChar,
    Short,
    UShort,
    Int,
    UInt,
    Long,
    ULong,
    Half,
    Float,
    Double,
}

impl Scalar {
    /// The type of this name: of the format's own names, those with sizes, those of NumPy and of programming languages.
    /// `i8` and `u8` name no type: they are one byte in some places and eight in others.
    pub fn named(name: &str) -> Option<Self> {
        let name = name.to_ascii_lowercase();
        Some(match name.strip_suffix("_t").unwrap_or(&name) {
            "char" | "int8" | "i1" | "sbyte" => Self::Char,
            "uchar" | "uint8" | "u1" | "byte" | "ubyte" | "bool" => Self::UChar,
            "short" | "int16" | "i2" | "i16" => Self::Short,
            "ushort" | "uint16" | "u2" | "u16" => Self::UShort,
            "int" | "int32" | "i4" | "i32" => Self::Int,
            "uint" | "uint32" | "u4" | "u32" => Self::UInt,
            "int64" | "longlong" | "i64" => Self::Long,
            "uint64" | "ulonglong" | "u64" => Self::ULong,
            "half" | "float16" | "f2" | "f16" => Self::Half,
            "float" | "float32" | "f4" | "f32" => Self::Float,
            "double" | "float64" | "f8" | "f64" => Self::Double,
            _ => return None,
        })
    }

    /// Bytes of a value in binary files.
    pub fn num_bytes(self) -> u64 {
        match self {
            Self::Char | Self::UChar => 1,
            Self::Short | Self::UShort | Self::Half => 2,
            Self::Int | Self::UInt | Self::Float => 4,
            Self::Long | Self::ULong | Self::Double => 8,
        }
    }

    /// Type of a column that holds these values exactly. Text may give a float more digits than its type holds, which
    /// are believed.
    pub fn column(self, is_text: bool) -> column::Type {
        match self {
            Self::Char => column::Type::I8,
            Self::UChar => column::Type::U8,
            Self::Short => column::Type::I16,
            Self::UShort => column::Type::U16,
            Self::Int => column::Type::I32,
            Self::UInt => column::Type::U32,
            Self::Long => column::Type::I64,
            Self::ULong => column::Type::U64,
            Self::Half | Self::Float if !is_text => column::Type::F32,
            Self::Half | Self::Float | Self::Double => column::Type::F64,
        }
    }

    /// True for numbers with a fraction.
    pub fn is_float(self) -> bool {
        matches!(self, Self::Half | Self::Float | Self::Double)
    }
}

/// The values of rows, one after the other. A f64 holds each type exactly, except whole numbers beyond 2⁵³.
pub(super) trait Values {
    /// The next value; `None` where there is no value, or it is no number.
    fn value(&mut self, kind: Scalar) -> Option<f64>;

    /// The next value with all its digits.
    fn number(&mut self, kind: Scalar) -> Option<Number>;

    /// The next value as the 32 bits that it stands for: those of an integer, or of a float, in which some programs
    /// pack them.
    fn bits(&mut self, kind: Scalar) -> Option<u32>;

    /// Passes over `num_values` values that have `num_bytes` bytes together; `None` where there are fewer.
    fn skip(&mut self, num_values: u64, num_bytes: u64) -> Option<()>;
}

/// A source of the bytes of values.
pub(super) trait ByteValues {
    /// The next bytes as they stand; `None` where there are fewer.
    fn array<const N: usize>(&mut self) -> Option<[u8; N]>;

    /// True if the first byte of a number is its most significant.
    fn is_big_endian(&self) -> bool;

    /// Passes over bytes; `None` where there are fewer.
    fn skip_bytes(&mut self, num_bytes: u64) -> Option<()>;

    /// The next bytes, the least significant first.
    #[inline]
    fn little<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes = self.array()?;
        if self.is_big_endian() {
            bytes.reverse();
        }
        Some(bytes)
    }
}

impl<B: ByteValues> Values for B {
    #[inline]
    fn value(&mut self, kind: Scalar) -> Option<f64> {
        Some(match kind {
            Scalar::Char => i8::from_le_bytes(self.little()?).into(),
            Scalar::UChar => u8::from_le_bytes(self.little()?).into(),
            Scalar::Short => i16::from_le_bytes(self.little()?).into(),
            Scalar::UShort => u16::from_le_bytes(self.little()?).into(),
            Scalar::Int => i32::from_le_bytes(self.little()?).into(),
            Scalar::UInt => u32::from_le_bytes(self.little()?).into(),
            Scalar::Long => i64::from_le_bytes(self.little()?) as f64,
            Scalar::ULong => u64::from_le_bytes(self.little()?) as f64,
            Scalar::Half => half::f16::from_le_bytes(self.little()?).into(),
            Scalar::Float => f32::from_le_bytes(self.little()?).into(),
            Scalar::Double => f64::from_le_bytes(self.little()?),
        })
    }

    fn number(&mut self, kind: Scalar) -> Option<Number> {
        Some(match kind {
            Scalar::Long => Number::Whole(i64::from_le_bytes(self.little()?).into()),
            Scalar::ULong => Number::Whole(u64::from_le_bytes(self.little()?).into()),
            _ => Number::Float(self.value(kind)?),
        })
    }

    fn bits(&mut self, kind: Scalar) -> Option<u32> {
        match kind {
            // The bits are taken as they stand: as a float they may be a NaN, whose bits a conversion may change.
            Scalar::Float | Scalar::Int | Scalar::UInt => Some(u32::from_le_bytes(self.little()?)),
            _ => self.value(kind).map(|value| packed_bits(value, kind.is_float())),
        }
    }

    fn skip(&mut self, _: u64, num_bytes: u64) -> Option<()> {
        self.skip_bytes(num_bytes)
    }
}

/// Values in bytes that come one after the other.
pub(super) struct Bytes<R> {
    input: R,
    big_endian: bool,
    /// Number of bytes read or passed over.
    pub num_bytes: u64,
    /// Why reading failed, where it was not the file's end.
    pub error: Option<io::Error>,
}

impl<R: BufRead> Bytes<R> {
    /// Values from where `input` stands.
    pub fn new(input: R, big_endian: bool) -> Self {
        Self { input, big_endian, num_bytes: 0, error: None }
    }
}

impl<R: BufRead> ByteValues for Bytes<R> {
    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes = [0; N];
        if let Err(error) = self.input.read_exact(&mut bytes) {
            self.error = Some(error).filter(|error| error.kind() != io::ErrorKind::UnexpectedEof);
            return None;
        }
        self.num_bytes += N as u64;
        Some(bytes)
    }

    fn is_big_endian(&self) -> bool {
        self.big_endian
    }

    fn skip_bytes(&mut self, mut left: u64) -> Option<()> {
        while left > 0 {
            let there = match self.input.fill_buf() {
                Ok(buffer) => buffer.len().min(usize::try_from(left).unwrap_or(usize::MAX)),
                Err(error) => {
                    self.error = Some(error);
                    return None;
                }
            };
            if there == 0 {
                return None;
            }
            self.input.consume(there);
            self.num_bytes += there as u64;
            left -= there as u64;
        }
        Some(())
    }
}

/// Values in bytes that are in memory.
pub(super) struct Record<'a> {
    pub bytes: &'a [u8],
    pub big_endian: bool,
}

impl ByteValues for Record<'_> {
    #[inline]
    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.bytes.split_first_chunk()?;
        self.bytes = rest;
        Some(*first)
    }

    #[inline]
    fn is_big_endian(&self) -> bool {
        self.big_endian
    }

    #[inline]
    fn skip_bytes(&mut self, num_bytes: u64) -> Option<()> {
        self.bytes = self.bytes.get(usize::try_from(num_bytes).ok()?..)?;
        Some(())
    }
}

/// True for a byte that separates words: a blank, an end of a line, or a semicolon, which no number has.
#[inline]
pub(super) fn parts_words(byte: &u8) -> bool {
    byte.is_ascii_whitespace() || *byte == b';'
}

/// The rest of a text from its first word on.
#[inline]
pub(super) fn without_blanks(text: &[u8]) -> &[u8] {
    let start = text.iter().position(|byte| !parts_words(byte)).unwrap_or(text.len());
    &text[start..]
}

/// Values in text, between blanks, ends of lines and semicolons.
#[derive(Clone, Copy)]
pub(super) struct Words<'a>(pub &'a [u8]);

impl<'a> Words<'a> {
    /// The next word.
    #[inline]
    pub fn word(&mut self) -> Option<&'a [u8]> {
        let text = without_blanks(self.0);
        let end = text.iter().position(parts_words).unwrap_or(text.len());
        let (word, rest) = text.split_at(end);
        self.0 = rest;
        (!word.is_empty()).then_some(word)
    }
}

impl Values for Words<'_> {
    /// Reads a value whatever its type: text that says more than its type holds is believed.
    #[inline]
    fn value(&mut self, _: Scalar) -> Option<f64> {
        self.0 = without_blanks(self.0);
        if let Some((value, rest)) = plain_number(self.0, b'.', parts_words) {
            self.0 = rest;
            return Some(value);
        }
        number(self.word()?)
    }

    fn number(&mut self, kind: Scalar) -> Option<Number> {
        let word = self.word()?;
        let whole = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        match whole {
            Some(whole) if !kind.is_float() => Some(Number::Whole(whole)),
            _ => number(word).map(Number::Float),
        }
    }

    fn bits(&mut self, kind: Scalar) -> Option<u32> {
        self.value(kind).map(|value| packed_bits(value, kind.is_float()))
    }

    fn skip(&mut self, num_values: u64, _: u64) -> Option<()> {
        (0..num_values).try_for_each(|_| self.word().map(|_| ()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_byte_orders_hold_every_type() {
        let kinds = [
            Scalar::Char,
            Scalar::UChar,
            Scalar::Short,
            Scalar::UShort,
            Scalar::Int,
            Scalar::UInt,
            Scalar::Long,
        ];
        let expected = [-1.0, 255.0, -2.0, 65534.0, -3.0, 4_294_967_293.0, -4.0];
        let numbers: [&[u8]; 7] = [
            &[0xff],
            &[0xff],
            &[0xff, 0xfe],
            &[0xff, 0xfe],
            &[0xff, 0xff, 0xff, 0xfd],
            &[0xff, 0xff, 0xff, 0xfd],
            &(-4i64).to_be_bytes(),
        ];
        let big = numbers.concat();
        let little: Vec<u8> = numbers.iter().flat_map(|number| number.iter().rev().copied()).collect();
        for (bytes, big_endian) in [(&little[..], false), (&big[..], true)] {
            let mut values = Bytes::new(bytes, big_endian);
            assert_eq!(kinds.map(|kind| values.value(kind).unwrap()), expected);
            assert_eq!((values.num_bytes, values.value(Scalar::UChar)), (22, None));
            let mut values = Record { bytes, big_endian };
            assert_eq!(kinds.map(|kind| values.value(kind).unwrap()), expected);
            assert_eq!(values.value(Scalar::UChar), None);
        }
        let floats = [&0x3e00u16.to_be_bytes()[..], &1.5f32.to_be_bytes(), &(-0.1f64).to_be_bytes()].concat();
        let mut values = Record { bytes: &floats, big_endian: true };
        let kinds = [Scalar::Half, Scalar::Float, Scalar::Double];
        assert_eq!(kinds.map(|kind| values.value(kind).unwrap()), [1.5, 1.5, -0.1]);
    }

    #[test]
    fn types_have_many_names() {
        for (names, kind) in [
            ("char int8 i1 INT8 int8_t", Scalar::Char),
            ("uchar uint8 u1 uint8_t ubyte", Scalar::UChar),
            ("uint64 u64 uint64_t", Scalar::ULong),
            ("Float float32 f4 f32", Scalar::Float),
            ("DOUBLE float64 f8 f64", Scalar::Double),
        ] {
            assert!(names.split(' ').all(|name| Scalar::named(name) == Some(kind)), "{names}");
        }
        for none in ["", "i8", "u8", "flaot", "list", "_t"] {
            assert_eq!(Scalar::named(none), None, "{none}");
        }
    }

    #[test]
    fn bits_are_kept_in_integers_and_floats() {
        let packed = [0x00ff_8040u32, 0xffc1_8040, 0xff81_8040, 0, 7];
        for bits in packed {
            for big_endian in [false, true] {
                let bytes = if big_endian { bits.to_be_bytes() } else { bits.to_le_bytes() };
                for kind in [Scalar::Int, Scalar::UInt, Scalar::Float] {
                    assert_eq!(
                        Record { bytes: &bytes, big_endian }.bits(kind),
                        Some(bits),
                        "{bits:x} {kind:?}"
                    );
                }
            }
        }
        let word = |word: &str, kind| Words(word.as_bytes()).bits(kind);
        assert_eq!(word("16744512", Scalar::UInt), Some(0xff_8040));
        assert_eq!(word("-4161472", Scalar::Int), Some(0xffc0_8040));
        assert_eq!(word(&format!("{:e}", f32::from_bits(0xff_8040)), Scalar::Float), Some(0xff_8040));
        assert_eq!(word("16744512", Scalar::Float), Some(0xff_8040));
        assert_eq!(word("red", Scalar::Float), None);
    }

    #[test]
    fn passing_over_more_than_there_is_ends() {
        let mut values = Bytes::new(&[1u8, 2, 3][..], false);
        assert_eq!(values.skip(1, 2), Some(()));
        assert_eq!(values.skip(1, 2), None);
        assert_eq!(Bytes::new(&[][..], false).skip(1, u64::MAX), None);
        assert_eq!(Record { bytes: &[1, 2], big_endian: false }.skip(1, u64::MAX), None);
        assert_eq!(Words(b"1 2").skip(u64::MAX, 0), None);
    }

    #[test]
    fn exponents_of_fortran_are_read() {
        let words = "1.0D+00 -2.5d-1 3D2 .5Q1 7d";
        let mut words = Words(words.as_bytes());
        let read: Vec<_> = (0..5).map(|_| words.value(Scalar::Double)).collect();
        assert_eq!(read, [Some(1.0), Some(-0.25), Some(300.0), Some(5.0), None]);
        for no_number in ["d", "D5", "1.0D", "1D2D3", "1.0De5", "add", "q"] {
            assert_eq!(number(no_number.as_bytes()), None, "{no_number}");
        }
    }

    #[test]
    fn semicolons_part_numbers_wherever_they_stand() {
        let mut words = Words(b";1;2 ; 3;; -4e1;\n;5;");
        let read: Vec<_> = (0..6).map(|_| words.value(Scalar::Float)).collect();
        assert_eq!(read, [Some(1.0), Some(2.0), Some(3.0), Some(-40.0), Some(5.0), None]);
    }

    #[test]
    fn commas_before_blanks_part_numbers_and_within_words_nothing() {
        let mut words = Words(b"1.5, -2; 3,\t4e2,\n5 6,5 1.5,2.5 ,");
        let read: Vec<_> = (0..8).map(|_| words.value(Scalar::Float)).collect();
        assert_eq!(read[..5], [1.5, -2.0, 3.0, 400.0, 5.0].map(Some));
        assert_eq!(read[5..], [None; 3]);
    }

    proptest::proptest! {
        #[test]
        fn plain_numbers_are_rounded_as_others(digits in "-?[0-9]{0,12}\\.?[0-9]{0,24}", float in proptest::num::f64::ANY) {
            for word in [digits, float.to_string(), format!("{float:e}"), format!("{float:.3}")] {
                let text = format!("{word} 1");
                let (mut words, expected) = (Words(text.as_bytes()), word.parse::<f64>().ok());
                let read = if word.is_empty() { None } else { words.value(Scalar::Double) };
                let same = read.map(f64::to_bits) == expected.map(f64::to_bits)
                    || read.is_some_and(f64::is_nan) && expected.is_some_and(f64::is_nan);
                proptest::prop_assert!(same, "{word}: {read:?}, not {expected:?}");
            }
        }
    }

    #[test]
    fn words_are_numbers_between_any_blanks() {
        let mut words = Words(b"  1\t-2.5e3 \r.5 nan\n-nan(ind) 1.#INF +inf abc 7");
        let read: Vec<_> = (0..9).map(|_| words.value(Scalar::Float)).collect();
        assert_eq!(read[..3], [Some(1.0), Some(-2500.0), Some(0.5)]);
        assert!(read[3..6].iter().all(|value| value.unwrap().is_nan()), "{read:?}");
        assert_eq!(read[6..], [Some(f64::INFINITY), None, Some(7.0)]);
        assert_eq!(words.value(Scalar::Float), None);
    }
}
