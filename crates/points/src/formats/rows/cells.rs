//! The cells of a line of text: what separates them, and which character is the decimal point.

use crate::formats::number::{number, plain_number};

/// What stands between two values of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::formats) enum Separator {
    /// Any number of blanks and tabs.
    Blanks,
    Tab,
    Comma,
    Semicolon,
}

impl Separator {
    /// In words: "blanks", "commas".
    pub fn words(self) -> &'static str {
        match self {
            Self::Blanks => "blanks",
            Self::Tab => "tabs",
            Self::Comma => "commas",
            Self::Semicolon => "semicolons",
        }
    }

    /// Its byte.
    fn byte(self) -> u8 {
        match self {
            Self::Blanks => b' ',
            Self::Tab => b'\t',
            Self::Comma => b',',
            Self::Semicolon => b';',
        }
    }
}

/// How values are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::formats) struct Dialect {
    pub separator: Separator,
    /// The character between a number's whole part and its decimals.
    pub point: u8,
}

impl Dialect {
    /// Values between blanks, with decimal points.
    pub const BLANKS: Self = Self { separator: Separator::Blanks, point: b'.' };

    /// The cells of a line, which may have its end.
    #[inline]
    pub fn cells(self, line: &[u8]) -> LineCells<'_> {
        LineCells { dialect: self, rest: line, byte: self.separator.byte(), is_open: false }
    }

    /// A word as a number: NaN if it is empty, as an empty cell is.
    pub fn number(self, word: &[u8]) -> Option<f64> {
        if word.is_empty() {
            return Some(f64::NAN);
        }
        // A sign of plus is rare, and words such as "infinite" or "Nantes" are none of a scan's numbers.
        let first = word.strip_prefix(b"-").unwrap_or(word).first()?;
        let may_be = first.is_ascii_digit() || matches!(first, b'.' | b',' | b'+') || word.len() <= 10;
        if !may_be {
            return None;
        }
        if self.point == b'.' {
            return number(word);
        }
        if word.contains(&b'.') {
            return None;
        }
        let word: Vec<u8> = word.iter().map(|&byte| if byte == self.point { b'.' } else { byte }).collect();
        number(&word)
    }
}

/// The cells of a line that are left.
#[derive(Clone, Copy, Debug)]
pub(in crate::formats) struct LineCells<'a> {
    dialect: Dialect,
    rest: &'a [u8],
    /// The separator's byte.
    byte: u8,
    /// True if the last cell ended with a separator, so that there is another, perhaps an empty one.
    is_open: bool,
}

impl<'a> LineCells<'a> {
    /// True for a byte that may stand beside a value, beside separators.
    #[inline]
    fn is_blank(&self, byte: u8) -> bool {
        byte.is_ascii_whitespace() && (byte != b'\t' || self.byte != b'\t')
    }

    #[inline]
    fn skip_blanks(&mut self) {
        let start = self.rest.iter().position(|&byte| !self.is_blank(byte)).unwrap_or(self.rest.len());
        self.rest = &self.rest[start..];
    }

    /// True if nothing is left.
    #[inline]
    pub fn is_empty(&mut self) -> bool {
        self.skip_blanks();
        self.rest.is_empty()
    }

    /// The next cell without blanks and quotes round it; `None` where there is none, or only an empty last one.
    #[inline]
    pub fn word(&mut self) -> Option<&'a [u8]> {
        if self.is_empty() {
            return None;
        }
        let is_end = |byte: u8| match self.dialect.separator {
            Separator::Blanks => byte.is_ascii_whitespace(),
            _ => byte == self.byte,
        };
        let quoted =
            self.rest.strip_prefix(b"\"").and_then(|text| text.iter().position(|&byte| byte == b'"'));
        let from = quoted.map_or(0, |end| end + 2);
        let end = self.rest[from..].iter().position(|&byte| is_end(byte));
        let end = end.map_or(self.rest.len(), |end| from + end);
        let word = self.rest[..end].trim_ascii();
        self.is_open = end < self.rest.len() && self.dialect.separator != Separator::Blanks;
        self.rest = self.rest.get(end + 1..).unwrap_or_default();
        Some(word.strip_prefix(b"\"").and_then(|word| word.strip_suffix(b"\"")).unwrap_or(word).trim_ascii())
    }

    /// The next cell as a number, NaN where the cell is empty; `None` where there is no cell, or no number in it.
    #[inline]
    pub fn value(&mut self) -> Option<f64> {
        self.skip_blanks();
        let byte = self.byte;
        let ends = |end: &u8| end.is_ascii_whitespace() || *end == byte;
        if let Some((value, rest)) = plain_number(self.rest, self.dialect.point, ends) {
            let is_between_blanks = self.dialect.separator == Separator::Blanks;
            match rest.first() {
                None => {
                    (self.rest, self.is_open) = (rest, false);
                    return Some(value);
                }
                Some(&end) if end == byte || is_between_blanks => {
                    (self.rest, self.is_open) = (&rest[1..], !is_between_blanks);
                    return Some(value);
                }
                // Blanks stand before a separator or the line's end, or within a cell that is no number.
                Some(_) => {}
            }
        }
        let dialect = self.dialect;
        self.cell().and_then(|word| dialect.number(word))
    }

    /// The next cell; the last may be empty.
    #[inline]
    pub fn cell(&mut self) -> Option<&'a [u8]> {
        let is_open = std::mem::take(&mut self.is_open);
        self.word().or(is_open.then_some(&[]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dialect(separator: Separator, point: u8) -> Dialect {
        Dialect { separator, point }
    }

    fn words(dialect: Dialect, line: &str) -> Vec<String> {
        let mut cells = dialect.cells(line.as_bytes());
        std::iter::from_fn(|| cells.word().map(|word| String::from_utf8_lossy(word).into_owned())).collect()
    }

    fn values(dialect: Dialect, line: &str) -> Vec<Option<f64>> {
        let num = words(dialect, line).len();
        let mut cells = dialect.cells(line.as_bytes());
        (0..num).map(|_| cells.value()).collect()
    }

    #[test]
    fn cells_lie_between_separators() {
        assert_eq!(words(Dialect::BLANKS, "  a \t b  \"c d\"\r\n"), ["a", "b", "c d"]);
        let comma = dialect(Separator::Comma, b'.');
        assert_eq!(words(comma, "\"X\", \"Y, m\",,4 ,\r\n"), ["X", "Y, m", "", "4"]);
        assert_eq!(words(dialect(Separator::Tab, b'.'), "a b\t\t c\n"), ["a b", "", "c"]);
        assert_eq!(words(comma, " \r\n"), Vec::<String>::new());
    }

    #[test]
    fn values_are_numbers_in_each_dialect() {
        assert_eq!(values(Dialect::BLANKS, "1 -2.5\t3e2 x\r\n"), [Some(1.0), Some(-2.5), Some(300.0), None]);
        let comma = dialect(Separator::Comma, b'.');
        assert_eq!(values(comma, "1 , \"2\",3 4,.5"), [Some(1.0), Some(2.0), None, Some(0.5)]);
        let empty = values(comma, "1,,2\n");
        assert!(empty[1].is_some_and(f64::is_nan) && empty[2] == Some(2.0), "{empty:?}");
        // A separator at the end is that of an empty cell, if a value is expected there.
        let mut cells = comma.cells(b"1,2,\r\n");
        assert_eq!([cells.value(), cells.value()], [Some(1.0), Some(2.0)]);
        assert!(cells.value().is_some_and(f64::is_nan) && cells.value().is_none());
        assert_eq!(words(comma, "1,2,\r\n").len(), 2);
        let semicolon = dialect(Separator::Semicolon, b',');
        assert_eq!(values(semicolon, "1,5;-2,25e1; 3;4.5\r\n"), [Some(1.5), Some(-22.5), Some(3.0), None]);
        assert_eq!(values(dialect(Separator::Blanks, b','), "1,5 2"), [Some(1.5), Some(2.0)]);
        assert_eq!(values(Dialect::BLANKS, "Nantes-la-Jolie infinitesimal"), [None, None]);
        assert!(values(Dialect::BLANKS, "nan -nan(ind)").iter().all(|v| v.unwrap().is_nan()));
    }
}
