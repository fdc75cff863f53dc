//! The header of a PLY file: lines of text that say how the rest is written.

use super::value::Scalar;
use crate::ScanError;
use crate::formats::number::number;
use crate::source::Source;
use base::words::counted;

/// Bytes of a file that are searched first for the header's end; most headers take a few kilobytes.
const FIRST_BYTES: u64 = 1 << 16;
/// Most bytes of a header: comments may be long, but not without end.
const MOST_BYTES: u64 = 1 << 24;
/// Mark that some editors write at the start of a text to say that it is UTF-8.
pub(super) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// How the rows behind the header are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Whether a property is one value or a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PropertyType {
    /// One value.
    Value(Scalar),
    /// A count of the first type, then this many values of the second type.
    List(Scalar, Scalar),
}

/// Part of an element's rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub name: String,
    pub kind: PropertyType,
}

/// Rows that have the same properties.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub name: String,
    /// Rows announced.
    pub count: u64,
    pub properties: Vec<Property>,
    /// Line of the header that names it, from 1.
    pub line: u64,
}

/// What the header says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PlyHeader {
    pub encoding: Encoding,
    /// Elements in the order of their rows.
    pub elements: Vec<Element>,
    /// Comments and obj_infos, without these words.
    pub remarks: Vec<String>,
    /// First byte of the rows.
    pub body_offset: u64,
    /// Number of the line that the rows start in, from 1.
    pub body_line: u64,
    /// What ends a line: `\n` (after which `\r` is a blank), or `\r` alone.
    pub line_end: u8,
    /// What was odd, as ends of sentences.
    pub oddities: Vec<String>,
}

impl PlyHeader {
    /// Reads the header.
    ///
    /// # Errors
    /// The header has no end, no format, or a line that makes the rows' size unknown. The error names the line.
    pub fn read(source: &Source) -> Result<Self, ScanError> {
        let fail = |(line, problem)| ScanError::Line { path: source.path().to_owned(), line, problem };
        let mut limit = FIRST_BYTES;
        loop {
            let bytes = source.bytes(0, limit)?;
            let is_all = (bytes.len() as u64) < limit;
            if let Some(header) = Self::parse(&bytes, is_all).map_err(fail)? {
                return Ok(header);
            }
            let num_lines = bytes.split(|&byte| byte == b'\n').count() as u64;
            if is_all {
                let problem = "the header has no line end_header up to here: the file was cut off or is damaged, get it again";
                return Err(fail((num_lines, problem.into())));
            }
            if limit >= MOST_BYTES {
                let problem = format!(
                    "the header has no line end_header in its first {} MiB, so long is none: the file is damaged or no PLY \
                     file, export it again",
                    MOST_BYTES >> 20
                );
                return Err(fail((num_lines, problem)));
            }
            limit = MOST_BYTES.min(8 * limit);
        }
    }

    /// Parses the header at the start of `bytes`; `None` if its end is not among them. The error is the number of the
    /// wrong line, and why. The last line counts only if it has its end, or if these are all bytes.
    fn parse(bytes: &[u8], is_all: bool) -> Result<Option<Self>, (u64, String)> {
        let first_end = bytes.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let only_returns =
            first_end.is_some_and(|at| bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n'));
        let line_end = if only_returns { b'\r' } else { b'\n' };
        let mut lines = HeaderLines::default();
        let mut offset = 0;
        for (line, number) in bytes.split_inclusive(|&byte| byte == line_end).zip(1..) {
            if !is_all && line.last() != Some(&line_end) {
                break;
            }
            offset += line.len() as u64;
            let line = if number == 1 { line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line) } else { line };
            let text = String::from_utf8_lossy(line);
            if lines.take(text.trim(), number).map_err(|problem| (number, problem))? {
                continue;
            }
            let fix = "ascii, binary_little_endian or binary_big_endian: export the file again";
            let encoding =
                lines.encoding.ok_or((number, format!("no line before says the format, {fix}")))?;
            let oddities = lines.oddities();
            let HeaderLines { elements, remarks, .. } = lines;
            let (body_offset, body_line) = (offset, number + 1);
            return Ok(Some(Self {
                encoding,
                elements,
                remarks,
                body_offset,
                body_line,
                line_end,
                oddities,
            }));
        }
        Ok(None)
    }
}

/// What the lines so far say.
#[derive(Default)]
struct HeaderLines {
    encoding: Option<Encoding>,
    elements: Vec<Element>,
    remarks: Vec<String>,
    /// Number of lines that mean nothing, and the first one's number.
    meaningless: (u64, u64),
}

impl HeaderLines {
    /// Takes in a line; returns false for the header's last line. The error says what is wrong with the line.
    fn take(&mut self, line: &str, number: u64) -> Result<bool, String> {
        let (keyword, rest) = line.split_once(|c: char| c.is_whitespace()).unwrap_or((line, ""));
        let rest = rest.trim();
        match keyword.to_ascii_lowercase().as_str() {
            "end_header" => return Ok(false),
            "format" => self.encoding = Some(encoding(rest)?),
            "comment" | "obj_info" => self.remarks.push(rest.to_owned()),
            "element" => self.elements.push(element(rest, number)?),
            "property" => {
                let element = self
                    .elements
                    .last_mut()
                    .ok_or("a property before the first element: the header is damaged")?;
                element.properties.push(property(rest)?);
            }
            // This is the first line, or the file would not be read.
            "" | "ply" => {}
            _ => {
                let (count, first) = self.meaningless;
                self.meaningless = (count + 1, if count == 0 { number } else { first });
            }
        }
        Ok(true)
    }

    fn oddities(&self) -> Vec<String> {
        match self.meaningless {
            (0, _) => Vec::new(),
            (1, line) => vec![format!("has a header line {line} that means nothing; it was skipped")],
            (count, line) => {
                vec![format!(
                    "has {} that mean nothing, first line {line}; they were skipped",
                    counted(count, "header line")
                )]
            }
        }
    }
}

fn encoding(rest: &str) -> Result<Encoding, String> {
    let name = rest.split_whitespace().next().unwrap_or_default();
    match name.to_ascii_lowercase().as_str() {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(format!(
            "the format {name:?} is not known, only ascii, binary_little_endian and binary_big_endian: \
             export the file as one of them"
        )),
    }
}

fn element(rest: &str, line: u64) -> Result<Element, String> {
    let mut words = rest.split_whitespace();
    let (name, count) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    let count = whole_number(count).ok_or_else(|| {
        format!("the element {name:?} has no count of its rows but {count:?}: the header is damaged, export the file again")
    })?;
    Ok(Element { name: name.to_owned(), count, properties: Vec::new(), line })
}

/// Parses a count, which some programs write as 5e+03, 5D+03 or 5000.0.
fn whole_number(word: &str) -> Option<u64> {
    let as_float = || {
        let value = number(word.as_bytes())?;
        (value >= 0.0 && value.fract() == 0.0 && value < 2f64.powi(53)).then_some(value as u64)
    };
    word.parse().ok().or_else(as_float)
}

fn property(rest: &str) -> Result<Property, String> {
    let scalar = |name: Option<&str>| {
        let name = name.unwrap_or_default();
        let unknown = "is no type of a PLY file (char to double, int8 to float64), so that its rows cannot be told apart: \
                       export the file again";
        Scalar::named(name).ok_or_else(|| format!("{name:?} {unknown}"))
    };
    let mut words = rest.split_whitespace().peekable();
    let kind = if words.next_if(|word| word.eq_ignore_ascii_case("list")).is_some() {
        PropertyType::List(scalar(words.next())?, scalar(words.next())?)
    } else {
        PropertyType::Value(scalar(words.next())?)
    };
    Ok(Property { name: words.next().unwrap_or_default().to_owned(), kind })
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "ply \nformat binary_big_endian 1.0\ncomment by hand\nelement vertex 3\n\
                        property float x\nobj_info twice\nproperty list uchar int32 more\nend_header\nDATA";

    fn parse(text: &str) -> Result<PlyHeader, (u64, String)> {
        PlyHeader::parse(text.as_bytes(), true).map(Option::unwrap)
    }

    #[test]
    fn lines_may_end_in_any_way() {
        for (line_end, byte) in [("\n", b'\n'), ("\r\n", b'\n'), ("\r", b'\r'), (" \t\n", b'\n')] {
            let text = GOOD.replace('\n', line_end);
            let header = parse(&text).unwrap();
            assert_eq!(&text[header.body_offset as usize..], "DATA");
            assert_eq!((header.body_line, header.line_end), (9, byte));
            assert_eq!(header.remarks, ["by hand", "twice"]);
            assert_eq!(header.encoding, Encoding::BigEndian);
            let [element] = &header.elements[..] else { panic!("{header:?}") };
            assert_eq!((element.name.as_str(), element.count, element.line), ("vertex", 3, 4));
            let kinds: Vec<_> = element.properties.iter().map(|p| (p.name.as_str(), p.kind)).collect();
            let list = PropertyType::List(Scalar::UChar, Scalar::Int);
            assert_eq!(kinds, [("x", PropertyType::Value(Scalar::Float)), ("more", list)]);
            assert!(header.oddities.is_empty());
        }
    }

    #[test]
    fn what_is_wrong_names_its_line() {
        for (from, to, line, problem) in [
            ("big_endian", "middle_endian", 2, "\"binary_middle_endian\" is not known"),
            ("format binary_big_endian 1.0\n", "", 7, "says the format"),
            ("vertex 3", "vertex -3", 4, "\"vertex\" has no count of its rows but \"-3\""),
            ("vertex 3", "vertex", 4, "but \"\""),
            ("element vertex 3\n", "", 4, "before the first element"),
            ("float x", "quaternion x", 5, "\"quaternion\" is no type"),
            ("uchar int32 more", "uchar", 7, "\"\" is no type"),
        ] {
            let (at, why) = parse(&GOOD.replace(from, to)).unwrap_err();
            assert!(at == line && why.contains(problem), "{from} to {to}: {at}, {why}");
        }
        let odd = parse(&GOOD.replace("obj_info", "colour")).unwrap();
        assert_eq!(odd.oddities, ["has a header line 6 that means nothing; it was skipped"]);
        let odder = parse(&GOOD.replace("obj_info", "colour\ncolor\nx")).unwrap();
        assert_eq!(odder.oddities, ["has 3 header lines that mean nothing, first line 6; they were skipped"]);
    }

    #[test]
    fn capitals_marks_and_exponents_are_read() {
        let plain = parse(GOOD).unwrap();
        for (from, to) in [
            ("ply \n", "\u{feff}PLY\n"),
            ("element vertex 3", "ELEMENT vertex 3e+00"),
            ("element vertex 3", "element vertex 3.0"),
            ("element vertex 3", "element vertex 0.3D+01"),
            ("property list uchar int32", "Property List UCHAR Int"),
            ("property float", "property Float32"),
            ("format binary_big_endian", "FORMAT Binary_Big_Endian"),
        ] {
            let text = GOOD.replace(from, to);
            let header = parse(&text).unwrap();
            assert_eq!(header.elements, plain.elements, "{to}");
            assert_eq!((&text[header.body_offset as usize..], header.encoding), ("DATA", plain.encoding));
        }
        for wrong in ["3.5", "-3", "nan", "inf", "1e300", "three", ""] {
            assert_eq!(whole_number(wrong), None, "{wrong}");
        }
        assert_eq!(whole_number("18446744073709551615"), Some(u64::MAX));
    }

    #[test]
    fn what_is_cut_off_is_not_yet_a_header() {
        for len in 0..GOOD.len() - "\nDATA".len() {
            assert_eq!(PlyHeader::parse(&GOOD.as_bytes()[..len], false), Ok(None), "cut at {len}");
        }
    }
}
