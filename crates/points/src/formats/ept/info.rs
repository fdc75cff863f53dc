//! What `ept.json` says: how nodes are packed, what their points store, which coordinate system they are in.

use super::dims::{Dim, Dims};
use crate::ScanError;
use crate::column::Type;
use crate::crs::{self, Crs};
use crate::source::Source;
use base::space::Bounds;
use base::words::counted;
use glam::DVec3;
use serde::Deserialize;
use serde_json::Value;
use std::path::Path;

/// Most bytes of a file that describes a scan: real ones have some thousands.
const MOST_BYTES: u64 = 1 << 24;

/// How the points of a node are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NodePacking {
    /// Records as the schema describes them.
    Binary,
    /// The same, packed as Zstandard.
    Zstandard,
    /// A LAZ file.
    Laszip,
}

/// What `ept.json` says.
#[derive(Clone, Debug)]
pub(super) struct EptInfo {
    pub version: String,
    pub packing: NodePacking,
    /// Points announced; 0 where no number is stated.
    pub announced: u64,
    pub dims: Dims,
    /// The root's cube.
    pub cube: Option<Bounds>,
    /// Edge of a cell of the root's sampling grid; 0 if it is not stated.
    pub spacing: f64,
    pub crs: Crs,
}

/// The file's fields as they are written. What is not needed may be anything.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct WrittenInfo {
    version: Value,
    data_type: Value,
    points: Value,
    schema: Vec<Value>,
    bounds: Value,
    span: Value,
    ticks: Value,
    srs: Value,
}

impl NodePacking {
    fn of(name: &str) -> Option<Self> {
        match name.to_ascii_lowercase().as_str() {
            "binary" => Some(Self::Binary),
            "zstandard" => Some(Self::Zstandard),
            "laszip" => Some(Self::Laszip),
            _ => None,
        }
    }

    /// What the names of nodes' files end in.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Binary => "bin",
            Self::Zstandard => "zst",
            Self::Laszip => "laz",
        }
    }

    /// Name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Binary => "binary",
            Self::Zstandard => "zstandard",
            Self::Laszip => "laszip",
        }
    }
}

impl EptInfo {
    /// Reads and checks the file.
    ///
    /// # Errors
    /// It cannot be read, is no JSON, packs its nodes in an unknown way, or describes points without x, y and z.
    pub fn read(path: &Path) -> Result<Self, ScanError> {
        let source = Source::open(path)?;
        let text = source.bytes(0, MOST_BYTES)?;
        if text.len() as u64 != source.len() {
            let problem =
                format!("is not the description of a scan: it has {}", counted(source.len(), "byte"));
            return Err(ScanError::Line { path: path.to_owned(), line: 1, problem });
        }
        Self::parse(path, &text)
    }

    fn parse(path: &Path, text: &[u8]) -> Result<Self, ScanError> {
        let fail = |line: usize, problem: String| ScanError::Line {
            path: path.to_owned(),
            line: line.max(1) as u64,
            problem,
        };
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        let written: WrittenInfo = serde_json::from_slice(text).map_err(|error| {
            fail(error.line(), format!("is not the JSON that describes a scan ({error}); get the file again"))
        })?;
        let WrittenInfo { version, data_type, points, schema, bounds, span, ticks, srs } = written;
        let data_type = data_type.as_str().unwrap_or_default();
        let packing = NodePacking::of(data_type).ok_or_else(|| {
            let known = "only laszip, binary and zstandard are known";
            fail(1, format!("its dataType is \"{data_type}\", and {known}; write it anew with another"))
        })?;
        let dims = Dims::new(schema.iter().map(dim).collect())
            .map_err(|problem| fail(1, format!("its schema {problem}; get the file again")))?;
        let cube = cube(&bounds);
        let span = span.as_f64().or_else(|| ticks.as_f64()).filter(|span| *span >= 1.0);
        let spacing = cube.zip(span).map_or(0.0, |(cube, span)| cube.size().max_element() / span);
        Ok(Self {
            version: version.as_str().map(str::to_owned).unwrap_or_default(),
            packing,
            announced: points.as_u64().unwrap_or(0),
            dims,
            cube,
            spacing,
            crs: system(&srs),
        })
    }
}

/// A dimension of the schema.
fn dim(written: &Value) -> Dim {
    let text = |name: &str| written.get(name).and_then(Value::as_str).unwrap_or_default();
    let number = |name: &str| written.get(name).and_then(Value::as_f64);
    let num_bytes = written.get("size").and_then(Value::as_u64).unwrap_or(0);
    let kind = match (text("type").to_ascii_lowercase().as_str(), num_bytes) {
        ("unsigned", 1) => Some(Type::U8),
        ("unsigned", 2) => Some(Type::U16),
        ("unsigned", 4) => Some(Type::U32),
        ("unsigned", 8) => Some(Type::U64),
        ("signed", 1) => Some(Type::I8),
        ("signed", 2) => Some(Type::I16),
        ("signed", 4) => Some(Type::I32),
        ("signed", 8) => Some(Type::I64),
        ("float" | "floating", 4) => Some(Type::F32),
        ("float" | "floating", 8) => Some(Type::F64),
        _ => None,
    };
    Dim {
        name: text("name").to_owned(),
        kind,
        num_bytes: usize::try_from(num_bytes).unwrap_or(usize::MAX),
        scale: number("scale"),
        offset: number("offset").unwrap_or(0.0),
    }
}

/// The root's cube, if the numbers make one.
fn cube(bounds: &Value) -> Option<Bounds> {
    let numbers: Vec<f64> = bounds.as_array()?.iter().filter_map(Value::as_f64).collect();
    let [min, max] = [numbers.get(..3)?, numbers.get(3..6)?].map(DVec3::from_slice);
    min.cmplt(max).all().then_some(Bounds { min, max })
}

/// The coordinate system, by its text or else by its numbers.
fn system(srs: &Value) -> Crs {
    let text = |name: &str| srs.get(name).and_then(Value::as_str).unwrap_or_default();
    let code = |name: &str| match srs.get(name) {
        Some(Value::String(code)) => code.parse().ok(),
        Some(code) => code.as_u64().and_then(|code| u32::try_from(code).ok()),
        None => None,
    };
    let by_text = crs::from_wkt(text("wkt").as_bytes());
    if !text("authority").eq_ignore_ascii_case("EPSG") {
        return by_text;
    }
    by_text.or(crs::from_epsg(code("horizontal"), code("vertical")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Axes;

    const XYZ: &str = r#"{"name":"X","type":"signed","size":4,"scale":0.01,"offset":500000},
        {"name":"Y","type":"signed","size":4,"scale":0.01},{"name":"Z","type":"float","size":8}"#;

    fn parse(fields: &str) -> Result<EptInfo, String> {
        let text = format!(r#"{{"schema":[{XYZ}]{fields}}}"#);
        EptInfo::parse(Path::new("ept.json"), text.as_bytes()).map_err(|error| error.to_string())
    }

    #[test]
    fn what_is_not_needed_may_be_anything() {
        let info = parse(
            r#","dataType":"Zstandard","points":-1.5,"bounds":["a"],"span":0,"srs":7,"version":1,"more":[[{}]]"#,
        );
        let info = info.unwrap();
        assert_eq!((info.packing, info.announced, info.cube), (NodePacking::Zstandard, 0, None));
        assert_eq!((info.spacing, info.crs), (0.0, Crs::default()));
        let info = parse(
            r#","dataType":"binary","points":7,"bounds":[0,0,0,64,64,64],"span":128,
               "srs":{"authority":"EPSG","horizontal":"26912"}"#,
        );
        let info = info.unwrap();
        assert_eq!((info.announced, info.spacing), (7, 0.5));
        assert_eq!((info.crs.unit_m, info.crs.axes), (Some(1.0), Some(Axes::Planar)));
        assert!(info.crs.name.unwrap().contains("EPSG:26912"));
    }

    #[test]
    fn what_is_needed_and_senseless_is_said() {
        let path = Path::new("a/ept.json");
        let said = |text: &str| EptInfo::parse(path, text.as_bytes()).err().unwrap().to_string();
        for (text, words) in [
            ("", "line 1: is not the JSON"),
            ("[1, 2", "not the JSON"),
            (r#"{"dataType":"binary","schema":[]}"#, "no X"),
            (r#"{"dataType":"binary","schema":7}"#, "not the JSON"),
            (r#"{"dataType":"draco","schema":[]}"#, "\"draco\", and only laszip"),
            (r#"{"dataType":"binary","schema":[{"name":"X","type":"signed","size":3}]}"#, "X"),
        ] {
            let error = said(text);
            assert!(error.starts_with("a/ept.json: ") && error.contains(words), "{error}");
        }
        // JSON that is nested without end is an error, not an overflow.
        for open in ["[", "{\"a\":"] {
            let nested = format!("{{\"dataType\":\"binary\",\"more\":{}", open.repeat(1_000_000));
            assert!(said(&nested).contains("not the JSON"), "{open}");
        }
    }
}
