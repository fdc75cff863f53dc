//! The numbers of a PLY file: their types, and how they stand in bytes and in text.

use std::io::{self, BufRead};

/// Type of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Char,
    UChar,
    Short,
    UShort,
    Int,
    UInt,
    Float,
    Double,
}

impl Type {
    /// By either of its names.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::Char,
            "uchar" | "uint8" => Self::UChar,
            "short" | "int16" => Self::Short,
            "ushort" | "uint16" => Self::UShort,
            "int" | "int32" => Self::Int,
            "uint" | "uint32" => Self::UInt,
            "float" | "float32" => Self::Float,
            "double" | "float64" => Self::Double,
            _ => return None,
        })
    }

    /// Size in binary files.
    pub fn num_bytes(self) -> u64 {
        match self {
            Self::Char | Self::UChar => 1,
            Self::Short | Self::UShort => 2,
            Self::Int | Self::UInt | Self::Float => 4,
            Self::Double => 8,
        }
    }

    /// True for float and double.
    pub fn is_float(self) -> bool {
        matches!(self, Self::Float | Self::Double)
    }
}

/// The values of rows, one after the other. A f64 holds each type exactly.
pub(super) trait Values {
    /// The next value; `None` where there is none, or none that is a number.
    fn value(&mut self, kind: Type) -> Option<f64>;

    /// Passes over values; `None` where there are not so many.
    fn skip(&mut self, kind: Type, count: u64) -> Option<()>;
}

/// Values in bytes.
pub(super) struct Bytes<R> {
    input: R,
    big_endian: bool,
    /// How many were read or passed over.
    pub num_bytes: u64,
    /// Why reading failed, where it was not the file's end.
    pub error: Option<io::Error>,
}

impl<R: BufRead> Bytes<R> {
    /// From where `input` stands.
    pub fn new(input: R, big_endian: bool) -> Self {
        Self { input, big_endian, num_bytes: 0, error: None }
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes = [0; N];
        if let Err(error) = self.input.read_exact(&mut bytes) {
            self.error = Some(error).filter(|error| error.kind() != io::ErrorKind::UnexpectedEof);
            return None;
        }
        self.num_bytes += N as u64;
        if self.big_endian {
            bytes.reverse();
        }
        Some(bytes)
    }
}

impl<R: BufRead> Values for Bytes<R> {
    fn value(&mut self, kind: Type) -> Option<f64> {
        Some(match kind {
            Type::Char => i8::from_le_bytes(self.array()?).into(),
            Type::UChar => u8::from_le_bytes(self.array()?).into(),
            Type::Short => i16::from_le_bytes(self.array()?).into(),
            Type::UShort => u16::from_le_bytes(self.array()?).into(),
            Type::Int => i32::from_le_bytes(self.array()?).into(),
            Type::UInt => u32::from_le_bytes(self.array()?).into(),
            Type::Float => f32::from_le_bytes(self.array()?).into(),
            Type::Double => f64::from_le_bytes(self.array()?),
        })
    }

    fn skip(&mut self, kind: Type, count: u64) -> Option<()> {
        let mut left = count.checked_mul(kind.num_bytes())?;
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

/// Values in a line of text, between blanks.
pub(super) struct Words<'a>(pub &'a [u8]);

impl<'a> Words<'a> {
    fn word(&mut self) -> Option<&'a [u8]> {
        let line = self.0.trim_ascii_start();
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (word, rest) = line.split_at(end);
        self.0 = rest;
        (!word.is_empty()).then_some(word)
    }
}

impl Values for Words<'_> {
    /// The type is not asked: text that says more than its type holds is believed.
    fn value(&mut self, _: Type) -> Option<f64> {
        let word = std::str::from_utf8(self.word()?).ok()?;
        match word.parse() {
            Ok(value) => Some(value),
            // "-nan(ind)", "1.#QNAN", "-1.#INF": what C libraries print where there is no number.
            Err(_) if word.contains('#') || word.to_ascii_lowercase().contains("nan") => Some(f64::NAN),
            Err(_) => None,
        }
    }

    fn skip(&mut self, _: Type, count: u64) -> Option<()> {
        (0..count).try_for_each(|_| self.word().map(|_| ()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_byte_orders_hold_every_type() {
        let little: &[u8] =
            &[0xff, 0xff, 0xfe, 0xff, 0xfe, 0xff, 0xfd, 0xff, 0xff, 0xff, 0xfd, 0xff, 0xff, 0xff];
        let big: &[u8] =
            &[0xff, 0xff, 0xff, 0xfe, 0xff, 0xfe, 0xff, 0xff, 0xff, 0xfd, 0xff, 0xff, 0xff, 0xfd];
        let kinds = [Type::Char, Type::UChar, Type::Short, Type::UShort, Type::Int, Type::UInt];
        for (bytes, big_endian) in [(little, false), (big, true)] {
            let mut values = Bytes::new(bytes, big_endian);
            let read = kinds.map(|kind| values.value(kind).unwrap());
            assert_eq!(read, [-1.0, 255.0, -2.0, 65534.0, -3.0, 4_294_967_293.0]);
            assert_eq!((values.num_bytes, values.value(Type::UChar)), (14, None));
        }
        let floats = [1.5f32.to_be_bytes().as_slice(), &(-0.1f64).to_be_bytes()].concat();
        let mut values = Bytes::new(&floats[..], true);
        assert_eq!([Type::Float, Type::Double].map(|kind| values.value(kind).unwrap()), [1.5, -0.1]);
    }

    #[test]
    fn passing_over_more_than_there_is_ends() {
        let mut values = Bytes::new(&[1u8, 2, 3][..], false);
        assert_eq!(values.skip(Type::UShort, 1), Some(()));
        assert_eq!(values.skip(Type::UShort, 1), None);
        assert_eq!(Bytes::new(&[][..], false).skip(Type::Double, u64::MAX), None);
        assert_eq!(Words(b"1 2").skip(Type::Int, u64::MAX), None);
    }

    #[test]
    fn words_are_numbers_between_any_blanks() {
        let mut words = Words(b"  1\t-2.5e3 \r.5 nan -nan(ind) 1.#INF +inf abc 7");
        let read: Vec<_> = (0..9).map(|_| words.value(Type::Float)).collect();
        assert_eq!(read[..3], [Some(1.0), Some(-2500.0), Some(0.5)]);
        assert!(read[3..6].iter().all(|value| value.unwrap().is_nan()), "{read:?}");
        assert_eq!(read[6..], [Some(f64::INFINITY), None, Some(7.0)]);
        assert_eq!(words.value(Type::Float), None);
    }
}
