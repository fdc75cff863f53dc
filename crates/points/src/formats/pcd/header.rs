//! The header of a PCD file: lines of a word and its values, up to the one that says how the points are stored.

use crate::ScanError;
use crate::column::Type;
use crate::source::Source;
use base::words::counted;

/// Most bytes of a header.
const MOST_BYTES: u64 = 1 << 20;
/// Most values of a field that get a column each.
const MOST_COLUMNS_OF_A_FIELD: u64 = 16;
/// Most bytes of a row, and most values of a field: far more than any histogram has.
const MOST_ROW_BYTES: u64 = 1 << 20;
/// Words that may begin a header.
const WORDS: [&str; 10] =
    ["version", "fields", "columns", "size", "type", "count", "width", "height", "viewpoint", "points"];

/// How the points are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PcdEncoding {
    Ascii,
    Binary,
    Compressed,
}

/// A field: one or more values of each point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct PcdField {
    pub name: String,
    /// Type of its values; `None` if they have one that no column holds.
    pub kind: Option<Type>,
    /// Bytes of a value.
    pub size: u64,
    /// Number of values.
    pub count: u64,
    /// First byte in a row.
    pub offset: u64,
}

/// What a header says.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PcdHeader {
    pub version: String,
    pub fields: Vec<PcdField>,
    /// Bytes of a row.
    pub row_bytes: u64,
    pub width: Option<u64>,
    pub height: Option<u64>,
    /// Points that are announced.
    pub num_points: u64,
    /// Position, and quaternion w x y z.
    pub viewpoint: Option<[f64; 7]>,
    pub encoding: PcdEncoding,
    /// First byte behind the header.
    pub body_offset: u64,
    /// Sentences about what was odd, whose subject is the file.
    pub oddities: Vec<String>,
}

/// True for a line that a PCD file may begin with.
pub(super) fn is_first_line(line: &str) -> bool {
    let line = line.trim();
    if let Some(comment) = line.strip_prefix('#') {
        return comment.trim_start().to_ascii_lowercase().starts_with(".pcd");
    }
    let mut words = line.split_whitespace();
    let first = words.next().unwrap_or_default();
    // A table may have a column named so, beside others that are no numbers.
    let is_version = first.eq_ignore_ascii_case("version");
    let is_fields = first == "FIELDS" || first == "COLUMNS";
    is_version && words.clone().count() == 1 && words.all(|word| word.parse::<f64>().is_ok())
        || is_fields && line.split_whitespace().count() > 3
}

impl PcdHeader {
    /// Reads and checks a header.
    ///
    /// # Errors
    /// It has no fields or no end, or cannot be read.
    pub fn read(source: &Source) -> Result<Self, ScanError> {
        let head = source.bytes(0, MOST_BYTES)?;
        let mut lines = PcdLines::default();
        let mut at = 0;
        for (number, line) in head.split_inclusive(|&byte| byte == b'\n').enumerate() {
            at += line.len();
            let is_whole = line.last() == Some(&b'\n');
            let text = String::from_utf8_lossy(line);
            let mut words = text.trim_start_matches('\u{feff}').split_whitespace();
            let Some(word) = words.next().map(str::to_ascii_lowercase) else { continue };
            let values: Vec<String> = words.map(str::to_owned).collect();
            if word.starts_with('#') {
                continue;
            }
            if word == "data" {
                if !is_whole {
                    break;
                }
                return lines.finish(source, number as u64 + 1, &values, at as u64);
            }
            if !WORDS.contains(&word.as_str()) {
                return Err(fail(
                    source,
                    number as u64 + 1,
                    format!("begins with {word:?}, which no header of a PCD file has: export it again"),
                ));
            }
            lines.0.push((word, values));
        }
        Err(ScanError::Truncated {
            path: source.path().to_owned(),
            len: source.len(),
            what: "header",
            needed: source.len() + 1,
        })
    }

    /// The pose of whoever measured, if the header tells one: PCL writes "0 0 0 1 0 0 0" where it knows none.
    pub fn pose(&self) -> Option<base::space::Pose> {
        let [x, y, z, w, i, j, k] = self.viewpoint.filter(|values| values.iter().all(|v| v.is_finite()))?;
        let orientation = glam::DQuat::from_xyzw(i, j, k, w);
        let length = orientation.length();
        let is_rotation = (0.99..1.01).contains(&length);
        let pose = base::space::Pose {
            position: glam::DVec3::new(x, y, z),
            orientation: if is_rotation { orientation.normalize() } else { return None },
        };
        (pose != base::space::Pose::IDENTITY).then_some(pose)
    }
}

/// A line that makes no sense.
fn fail(source: &Source, line: u64, problem: String) -> ScanError {
    ScanError::Line { path: source.path().to_owned(), line, problem }
}

/// Lines before the last: a word, and its values.
#[derive(Debug, Default)]
struct PcdLines(Vec<(String, Vec<String>)>);

impl PcdLines {
    /// The values of the first line with one of these words.
    fn values(&self, words: &[&str]) -> Option<&[String]> {
        let line = self.0.iter().find(|(word, _)| words.contains(&word.as_str()));
        line.map(|(_, values)| values.as_slice())
    }

    fn number(&self, word: &str) -> Option<u64> {
        self.values(&[word])?.first()?.parse().ok()
    }

    /// What the header says, whose last line has this number, these values, and ends at byte `body_offset`.
    fn finish(
        self,
        source: &Source,
        line: u64,
        data: &[String],
        body_offset: u64,
    ) -> Result<PcdHeader, ScanError> {
        let encoding = match data.first().map(|word| word.to_ascii_lowercase()).as_deref() {
            Some("ascii") => PcdEncoding::Ascii,
            Some("binary") => PcdEncoding::Binary,
            Some("binary_compressed") => PcdEncoding::Compressed,
            other => {
                let other = other.unwrap_or("nothing");
                let problem = format!(
                    "says that the data are {other:?}: export it as ascii, binary or binary_compressed"
                );
                return Err(fail(source, line, problem));
            }
        };
        let mut oddities = Vec::new();
        let (fields, row_bytes) = self.fields(source, line, encoding, &mut oddities)?;
        let (width, height) = (self.number("width"), self.number("height"));
        let of_grid = width.map(|width| width.saturating_mul(height.unwrap_or(1)));
        let stated = self.number("points");
        let num_points = match (stated, of_grid) {
            (Some(stated), Some(of_grid)) if stated != of_grid => {
                oddities.push(format!(
                    "announces {}, and width × height are {of_grid}: as many as can be read are shown",
                    counted(stated, "point")
                ));
                stated.max(of_grid)
            }
            (Some(num), _) | (None, Some(num)) => num,
            // As many as there are.
            (None, None) => u64::MAX,
        };
        let viewpoint = self.values(&["viewpoint"]).and_then(|values| {
            let values: Vec<f64> = values.iter().filter_map(|value| value.parse().ok()).collect();
            <[f64; 7]>::try_from(values).ok()
        });
        let version = self.values(&["version"]).and_then(<[String]>::first).cloned().unwrap_or_default();
        let version = if version.starts_with('.') { format!("0{version}") } else { version };
        Ok(PcdHeader {
            version,
            fields,
            row_bytes,
            width,
            height,
            num_points,
            viewpoint,
            encoding,
            body_offset,
            oddities,
        })
    }

    /// The fields, and the bytes of a row.
    fn fields(
        &self,
        source: &Source,
        line: u64,
        encoding: PcdEncoding,
        oddities: &mut Vec<String>,
    ) -> Result<(Vec<PcdField>, u64), ScanError> {
        let names = self.values(&["fields", "columns"]).unwrap_or_default();
        if names.is_empty() {
            return Err(fail(
                source,
                line,
                "no line FIELDS before it names what points have: export it again".into(),
            ));
        }
        let [sizes, kinds, counts] =
            ["size", "type", "count"].map(|word| self.values(&[word]).unwrap_or_default());
        let is_odd = |values: &[String]| !values.is_empty() && values.len() != names.len();
        if is_odd(sizes) || is_odd(kinds) || is_odd(counts) {
            let problem = format!(
                "{} fields have {} sizes, {} types and {} counts: export it again",
                names.len(),
                sizes.len(),
                kinds.len(),
                counts.len()
            );
            if encoding != PcdEncoding::Ascii {
                return Err(fail(source, line, problem));
            }
            oddities.push(format!("has a header with an odd number of values: {problem}"));
        }
        let (mut fields, mut offset) = (Vec::new(), 0u64);
        for (at, name) in names.iter().enumerate() {
            // The first version had neither sizes nor types: all were floats.
            let number = |values: &[String], else_: u64| match values.get(at) {
                None => Some(else_),
                Some(value) => value.parse::<u64>().ok().filter(|number| *number <= MOST_ROW_BYTES),
            };
            let (Some(size), Some(count)) = (number(sizes, 4), number(counts, 1)) else {
                let problem =
                    format!("field {name:?} has a size or a count that makes no sense: export it again");
                return Err(fail(source, line, problem));
            };
            let kind = kinds.get(at).map_or("F", String::as_str).to_ascii_uppercase();
            // PCL writes a count of 0 for one value.
            let count = count.max(1);
            fields.push(PcdField { name: name.clone(), kind: kind_of(&kind, size), size, count, offset });
            offset += size * count;
            if offset > MOST_ROW_BYTES {
                let problem =
                    format!("points are larger than {}: export it again", counted(MOST_ROW_BYTES, "byte"));
                return Err(fail(source, line, problem));
            }
        }
        if offset == 0 {
            return Err(fail(source, line, "points have no bytes: export it again".into()));
        }
        Ok((fields, offset))
    }
}

/// Type of a column for values of a type and a size.
fn kind_of(kind: &str, size: u64) -> Option<Type> {
    Some(match (kind, size) {
        ("U", 1) => Type::U8,
        ("I", 1) => Type::I8,
        ("U", 2) => Type::U16,
        ("I", 2) => Type::I16,
        ("U", 4) => Type::U32,
        ("I", 4) => Type::I32,
        ("U", 8) => Type::U64,
        ("I", 8) => Type::I64,
        ("F", 4) => Type::F32,
        ("F", 8) => Type::F64,
        _ => return None,
    })
}

/// A column of a PCD file: one value of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FieldValue {
    /// Number of the field.
    pub field: usize,
    /// Number of the value in it.
    pub value: u64,
}

impl PcdHeader {
    /// The values of a row that get columns, with their names, and names of fields that get none.
    pub fn values(&self) -> (Vec<(FieldValue, String)>, Vec<String>) {
        let (mut values, mut unread) = (Vec::new(), Vec::new());
        for (number, PcdField { name, kind, count, .. }) in self.fields.iter().enumerate() {
            let is_padding = name == "_" || name.eq_ignore_ascii_case("padding");
            if is_padding {
                continue;
            }
            if kind.is_none() || *count > MOST_COLUMNS_OF_A_FIELD {
                unread.push(name.clone());
                continue;
            }
            for value in 0..*count {
                let name = if *count == 1 { name.clone() } else { format!("{name}_{value}") };
                values.push((FieldValue { field: number, value }, name));
            }
        }
        (values, unread)
    }
}
