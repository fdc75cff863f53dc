//! What the metadata of Potree 2 say: encoding, grid, attributes, and how large the hierarchy's first chunk is.

use super::attributes::StoredAttribute;
use super::json;
use super::records::RecordLayout;
use super::tree::NodeTree;
use crate::column::Type;
use crate::crs::{self, Crs};
use crate::source::Source;
use crate::{Grid, ScanError};
use base::space::Bounds;
use glam::DVec3;
use serde_json::Value;

/// Names of the types of numbers.
const TYPES: [(&str, Type); 10] = [
    ("int8", Type::I8),
    ("int16", Type::I16),
    ("int32", Type::I32),
    ("int64", Type::I64),
    ("uint8", Type::U8),
    ("uint16", Type::U16),
    ("uint32", Type::U32),
    ("uint64", Type::U64),
    ("float", Type::F32),
    ("double", Type::F64),
];
/// Most attributes that are read: more than any real file has.
const MOST_ATTRIBUTES: usize = 1000;

/// How the points of a node are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NodeEncoding {
    /// Record after record.
    Records,
    /// Attribute after attribute, folded.
    Brotli,
}

/// What the metadata of Potree 2 say.
#[derive(Debug)]
pub(super) struct Metadata {
    /// "2.0".
    pub version: String,
    /// Name of the encoding.
    pub encoding_name: String,
    pub encoding: NodeEncoding,
    pub grid: Grid,
    pub layout: RecordLayout,
    /// Bytes of the hierarchy's first chunk.
    pub first_chunk: u64,
    /// Points announced, which is sometimes wrong.
    pub announced_points: Option<u64>,
    pub crs: Crs,
    /// The tree, without its nodes.
    pub tree: NodeTree,
}

impl Metadata {
    /// Reads and checks the metadata.
    ///
    /// # Errors
    /// They are no JSON, or lack what is needed to read points.
    pub fn read(source: &Source) -> Result<Self, ScanError> {
        let all = json::read(source)?;
        Self::of(&all).map_err(|reason| ScanError::NoPoints {
            path: source.path().to_owned(),
            reason: format!("{reason}; get the file again, or convert the scan again"),
        })
    }

    fn of(all: &Value) -> Result<Self, String> {
        let axes = |key: &str| json::triple(all, key).map(DVec3::from_array);
        let scale = axes("scale").filter(|scale| scale.to_array().iter().all(|scale| scale.is_normal()));
        let grid = Grid {
            scale: scale.ok_or("it says no scale that is one")?,
            offset: axes("offset").ok_or("it says no offset that is one")?,
        };
        let encoding_name = match json::text(all, "encoding") {
            // The first converters of Potree 2 had but one encoding.
            "" => "DEFAULT",
            name => name,
        };
        let encoding = match encoding_name {
            "DEFAULT" | "UNCOMPRESSED" => NodeEncoding::Records,
            "BROTLI" => NodeEncoding::Brotli,
            name => {
                return Err(format!(
                    "it is encoded as {name:?}, and only DEFAULT, UNCOMPRESSED and BROTLI are known"
                ));
            }
        };
        let attributes = all.get("attributes").and_then(Value::as_array).ok_or("it says no attributes")?;
        let stored = attributes.iter().take(MOST_ATTRIBUTES).map(attribute).collect();
        let hierarchy = all.get("hierarchy").unwrap_or(&Value::Null);
        let corner = |key| json::triple(all.get("boundingBox")?, key).map(DVec3::from_array);
        let root = corner("min").zip(corner("max")).map(|(min, max)| Bounds { min, max });
        Ok(Self {
            version: json::text(all, "version").to_owned(),
            encoding_name: encoding_name.to_owned(),
            encoding,
            grid,
            layout: RecordLayout::of(stored, encoding == NodeEncoding::Brotli)?,
            first_chunk: json::count(hierarchy, "firstChunkSize").unwrap_or(u64::MAX),
            announced_points: json::count(all, "points"),
            crs: crs::from_text(json::text(all, "projection")),
            tree: NodeTree {
                root: root.unwrap_or(Bounds { min: grid.offset, max: grid.offset }),
                root_spacing: json::number(all, "spacing").unwrap_or(0.0),
                ..NodeTree::default()
            },
        })
    }
}

/// An attribute that is described by name, type and number of elements; Potree 1.8 calls the last by another name.
pub(super) fn attribute(of: &Value) -> StoredAttribute {
    let count =
        |keys: &[&str]| keys.iter().find_map(|key| json::count(of, key)).and_then(|num| num.try_into().ok());
    let known = TYPES.iter().find(|(name, _)| *name == json::text(of, "type")).map(|(_, kind)| *kind);
    let num_elements: usize = count(&["numElements", "elements"]).unwrap_or(1);
    let plain = match known {
        // No real attribute is that long, and so is none of these.
        Some(kind) if num_elements < 1 << 20 => StoredAttribute::plain("", kind, num_elements),
        _ => StoredAttribute::default(),
    };
    let scale = |at| {
        let item = |key| json::item(of, key, at);
        (item("scale").unwrap_or(1.0), item("offset").unwrap_or(0.0))
    };
    StoredAttribute {
        name: json::text(of, "name").to_owned(),
        num_bytes: count(&["size"]).filter(|&size| size > 0).unwrap_or(plain.num_bytes),
        scales: (0..num_elements.min(16)).map(scale).collect(),
        range: json::item(of, "min", 0).zip(json::item(of, "max", 0)).map(|(low, high)| [low, high]),
        ..plain
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn metadata() -> Value {
        json!({
            "version": "2.0", "points": 5, "encoding": "DEFAULT", "spacing": 4.0,
            "scale": [0.01, 0.01, 0.001], "offset": [1.0, 2.0, 3.0],
            "hierarchy": {"firstChunkSize": 22, "depth": 77},
            "boundingBox": {"min": [1, 2, 3], "max": [9, 10, 11]},
            "attributes": [
                {"name": "position", "size": 12, "numElements": 3, "type": "int32"},
                {"name": "height", "size": 2, "numElements": 1, "type": "int16", "scale": [0.5], "offset": [100]},
                {"name": "blob", "size": 7, "numElements": 7, "type": "undefined"},
            ],
        })
    }

    #[test]
    fn what_is_needed_is_read() {
        let read = Metadata::of(&metadata()).unwrap();
        assert_eq!(
            read.grid,
            Grid { scale: DVec3::new(0.01, 0.01, 0.001), offset: DVec3::new(1.0, 2.0, 3.0) }
        );
        assert_eq!((read.layout.record_bytes, read.first_chunk, read.announced_points), (21, 22, Some(5)));
        let schema = read.layout.columns.schema();
        assert_eq!((schema.fields[0].scale, schema.fields[0].offset), (0.5, 100.0));
        assert_eq!(schema.unread, ["blob"]);
        assert_eq!(read.tree.root.max, DVec3::new(9.0, 10.0, 11.0));
    }

    #[test]
    fn what_is_missing_or_makes_no_sense_is_said() {
        let cases = [
            ("/scale", json!([0, 1, 1]), "no scale"),
            ("/scale", json!([null, 1, 1]), "no scale"),
            ("/offset", json!("x"), "no offset"),
            ("/encoding", json!("ZIP"), "\"ZIP\""),
            ("/attributes", json!({}), "no attributes"),
            ("/attributes/0/name", json!("place"), "no position"),
            ("/attributes/0/type", json!("double"), "32 bits"),
            ("/attributes/1/size", json!(1u64 << 60), "bytes each"),
        ];
        for (pointer, value, said) in cases {
            let mut all = metadata();
            *all.pointer_mut(pointer).unwrap() = value;
            let error = Metadata::of(&all).map(|_| ()).unwrap_err();
            assert!(error.contains(said), "{error}");
        }
        for odd in [json!(null), json!([]), json!({"attributes": [null, 3]})] {
            assert!(Metadata::of(&odd).is_err());
        }
        // Elements without end are bytes of no meaning.
        let endless = attribute(&json!({"name": "a", "numElements": u64::MAX, "type": "double"}));
        assert_eq!(endless.num_bytes, 0);
    }
}
