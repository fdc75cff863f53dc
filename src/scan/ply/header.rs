//! The header of a PLY file: lines of text that say how the rest is written.

use super::value::Type;
use crate::scan::ScanError;
use crate::scan::source::Source;

/// Where a header must have ended; real ones are below a few kilobytes.
const MOST_BYTES: u64 = 1 << 20;

/// How the rows behind the header are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// What a property is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// One value.
    Value(Type),
    /// A count of the first type, then so many values of the second.
    List(Type, Type),
}

/// Part of an element's rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub name: String,
    pub shape: Shape,
}

/// Rows that are alike.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub name: String,
    /// Rows announced.
    pub count: u64,
    pub properties: Vec<Property>,
    /// Where the header names it, from 1.
    pub line: u64,
}

/// What the header says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PlyHeader {
    pub encoding: Encoding,
    /// In the order of their rows.
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
    /// Reads it.
    ///
    /// # Errors
    /// No end, no format, a line that makes the rows' size unknown; each with its line.
    pub fn read(source: &Source) -> Result<Self, ScanError> {
        let bytes = source.bytes(0, MOST_BYTES)?;
        Self::parse(&bytes).map_err(|(line, problem)| ScanError::Line {
            path: source.path().to_owned(),
            line,
            problem,
        })
    }

    /// The header at the start of `bytes`, or the line that is wrong and why.
    fn parse(bytes: &[u8]) -> Result<Self, (u64, String)> {
        let first_end = bytes.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let only_returns =
            first_end.is_some_and(|at| bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n'));
        let line_end = if only_returns { b'\r' } else { b'\n' };
        let mut lines = Lines::default();
        let mut offset = 0;
        for (line, number) in bytes.split_inclusive(|&byte| byte == line_end).zip(1..) {
            offset += line.len() as u64;
            let text = String::from_utf8_lossy(line);
            // The first line said "ply", or this would not be read.
            if number > 1 && !lines.take(text.trim(), number).map_err(|problem| (number, problem))? {
                let fix = "ascii, binary_little_endian or binary_big_endian: export the file again";
                let encoding =
                    lines.encoding.ok_or((number, format!("no line before says the format, {fix}")))?;
                let Lines { elements, remarks, oddities, .. } = lines;
                let body_line = number + 1;
                return Ok(Self {
                    encoding,
                    elements,
                    remarks,
                    body_offset: offset,
                    body_line,
                    line_end,
                    oddities,
                });
            }
        }
        let num_lines = bytes.split(|&byte| byte == line_end).count() as u64;
        let problem =
            "the header has no line end_header up to here: the file was cut off or is damaged, get it again";
        Err((num_lines, problem.into()))
    }
}

/// What the lines so far say.
#[derive(Default)]
struct Lines {
    encoding: Option<Encoding>,
    elements: Vec<Element>,
    remarks: Vec<String>,
    oddities: Vec<String>,
}

impl Lines {
    /// Takes in a line; false for the last. The error is what is wrong with it.
    fn take(&mut self, line: &str, number: u64) -> Result<bool, String> {
        let (keyword, rest) = line.split_once(|c: char| c.is_whitespace()).unwrap_or((line, ""));
        let rest = rest.trim();
        match keyword {
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
            "" => {}
            _ => self.oddities.push(format!("has a header line {number} that means nothing; it was skipped")),
        }
        Ok(true)
    }
}

fn encoding(rest: &str) -> Result<Encoding, String> {
    match rest.split_whitespace().next().unwrap_or_default() {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        other => Err(format!(
            "the format {other:?} is not known, only ascii, binary_little_endian and binary_big_endian: \
             export the file as one of them"
        )),
    }
}

fn element(rest: &str, line: u64) -> Result<Element, String> {
    let mut words = rest.split_whitespace();
    let (name, count) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    let count = count.parse().map_err(|_| {
        format!("the element {name:?} has no count of its rows but {count:?}: the header is damaged, export the file again")
    })?;
    Ok(Element { name: name.to_owned(), count, properties: Vec::new(), line })
}

fn property(rest: &str) -> Result<Property, String> {
    let kind = |name: Option<&str>| {
        let name = name.unwrap_or_default();
        let unknown = "is no type of a PLY file (char to double, int8 to float64), so that its rows cannot be told apart: \
                       export the file again";
        Type::named(name).ok_or_else(|| format!("{name:?} {unknown}"))
    };
    let mut words = rest.split_whitespace().peekable();
    let shape = if words.next_if_eq(&"list").is_some() {
        Shape::List(kind(words.next())?, kind(words.next())?)
    } else {
        Shape::Value(kind(words.next())?)
    };
    Ok(Property { name: words.next().unwrap_or_default().to_owned(), shape })
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "ply \nformat binary_big_endian 1.0\ncomment by hand\nelement vertex 3\n\
                        property float x\nobj_info twice\nproperty list uchar int32 more\nend_header\nDATA";

    #[test]
    fn lines_may_end_in_any_way() {
        for (line_end, byte) in [("\n", b'\n'), ("\r\n", b'\n'), ("\r", b'\r'), (" \t\n", b'\n')] {
            let text = GOOD.replace('\n', line_end);
            let header = PlyHeader::parse(text.as_bytes()).unwrap();
            assert_eq!(&text[header.body_offset as usize..], "DATA");
            assert_eq!((header.body_line, header.line_end), (9, byte));
            assert_eq!(header.remarks, ["by hand", "twice"]);
            assert_eq!(header.encoding, Encoding::BigEndian);
            let [element] = &header.elements[..] else { panic!("{header:?}") };
            assert_eq!((element.name.as_str(), element.count, element.line), ("vertex", 3, 4));
            let shapes: Vec<_> = element.properties.iter().map(|p| (p.name.as_str(), p.shape)).collect();
            let list = Shape::List(Type::UChar, Type::Int);
            assert_eq!(shapes, [("x", Shape::Value(Type::Float)), ("more", list)]);
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
            ("end_header", "end", 9, "no line end_header"),
        ] {
            let (at, why) = PlyHeader::parse(GOOD.replace(from, to).as_bytes()).unwrap_err();
            assert!(at == line && why.contains(problem), "{from} to {to}: {at}, {why}");
        }
        let odd = PlyHeader::parse(GOOD.replace("obj_info", "colour").as_bytes()).unwrap();
        assert_eq!(odd.oddities, ["has a header line 6 that means nothing; it was skipped"]);
    }
}
