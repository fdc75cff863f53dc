//! What the `cloud.js` of Potree 1 says: box, scale, attributes of the nodes, and where their files are.

use super::attributes::StoredAttribute;
use super::json;
use super::metadata;
use super::records::RecordLayout;
use super::tree::{NodeName, NodeTree};
use crate::ScanError;
use crate::column::Type;
use crate::crs::{self, Crs};
use crate::source::Source;
use base::space::Bounds;
use glam::DVec3;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The first version whose nodes are read. Those before have other positions, and nobody has them any more.
const FIRST_VERSION: (u64, u64) = (1, 4);
/// Attributes that are named by a word alone, up to version 1.7: their types and numbers of elements.
const WORDS: [(&str, Type, usize); 19] = [
    ("POSITION_CARTESIAN", Type::I32, 3),
    ("COLOR_PACKED", Type::U8, 4),
    ("RGBA_PACKED", Type::U8, 4),
    ("RGB_PACKED", Type::U8, 3),
    ("RGBA", Type::U8, 4),
    ("INTENSITY", Type::U16, 1),
    ("CLASSIFICATION", Type::U8, 1),
    ("RETURN_NUMBER", Type::U8, 1),
    ("NUMBER_OF_RETURNS", Type::U8, 1),
    ("SOURCE_ID", Type::U16, 1),
    ("POINT_SOURCE_ID", Type::U16, 1),
    ("USER_DATA", Type::U8, 1),
    ("GPS_TIME", Type::F64, 1),
    ("NORMAL_SPHEREMAPPED", Type::U8, 2),
    ("NORMAL_OCT16", Type::U8, 2),
    ("NORMAL", Type::F32, 3),
    ("NORMAL_FLOATS", Type::F32, 3),
    ("FILLER_1B", Type::U8, 1),
    ("INDICES", Type::U32, 1),
];

/// What the nodes' files are.
#[derive(Clone, Debug)]
pub(super) enum NodeFiles {
    /// Records, which are little-endian and have no header.
    Binary(RecordLayout),
    /// A whole file each, with this ending.
    Las(&'static str),
}

impl NodeFiles {
    /// Ending of the files' names.
    pub fn ending(&self) -> &'static str {
        match self {
            Self::Binary(_) => "bin",
            Self::Las(ending) => ending,
        }
    }

    /// Name for people.
    pub fn name(&self) -> String {
        match self {
            Self::Binary(_) => "BINARY".into(),
            Self::Las(ending) => ending.to_uppercase(),
        }
    }
}

/// What `cloud.js` says.
#[derive(Debug)]
pub(super) struct Cloud1 {
    /// "1.7".
    pub version: String,
    /// Folder of the nodes' files.
    pub octree_dir: PathBuf,
    /// Levels whose nodes share a folder and a part of the hierarchy; 0 if it is not cut.
    pub step: usize,
    pub files: NodeFiles,
    /// World units of a step of the nodes' positions.
    pub scale: f64,
    /// Nodes and their points, where the hierarchy is in the file itself.
    pub inline: Vec<(NodeName, u64)>,
    /// Points announced, which is sometimes wrong.
    pub announced_points: Option<u64>,
    pub crs: Crs,
    /// The tree, without its nodes.
    pub tree: NodeTree,
}

impl Cloud1 {
    /// Reads and checks the file.
    ///
    /// # Errors
    /// It is no JSON, or lacks what is needed to read points.
    pub fn read(source: &Source) -> Result<Self, ScanError> {
        let all = json::read(source)?;
        let folder = source.path().parent().unwrap_or(Path::new(""));
        Self::of(&all, folder).map_err(|reason| ScanError::NoPoints {
            path: source.path().to_owned(),
            reason: format!("{reason}; get the file again, or convert the scan again"),
        })
    }

    fn of(all: &Value, folder: &Path) -> Result<Self, String> {
        let version = json::text(all, "version").to_owned();
        if number_of(&version) < FIRST_VERSION {
            return Err(format!("it is of Potree {version}, and only 1.4 and later are read"));
        }
        let octree_dir = json::text(all, "octreeDir");
        if octree_dir.contains("://") {
            return Err(format!("its points are on a server ({octree_dir}), not beside it"));
        }
        let files = match all.get("pointAttributes") {
            Some(Value::String(name)) if name.eq_ignore_ascii_case("LAS") => NodeFiles::Las("las"),
            Some(Value::String(name)) if name.eq_ignore_ascii_case("LAZ") => NodeFiles::Las("laz"),
            Some(Value::Array(attributes)) => {
                let stored = attributes.iter().map(attribute).collect::<Result<_, _>>()?;
                NodeFiles::Binary(RecordLayout::of(stored, false)?)
            }
            _ => return Err("it does not say what its nodes store".into()),
        };
        let scale = json::number(all, "scale").filter(|scale| scale.is_normal() && *scale > 0.0);
        let scale = match (&files, scale) {
            (NodeFiles::Binary(_), None) => return Err("it says no scale that is one".into()),
            (_, scale) => scale.unwrap_or(1.0),
        };
        let corner = |names: [&str; 3]| {
            let of = all.get("boundingBox")?;
            let [x, y, z] = names.map(|name| json::number(of, name));
            Some(DVec3::new(x?, y?, z?))
        };
        let root = corner(["lx", "ly", "lz"]).zip(corner(["ux", "uy", "uz"]));
        let root = root.map(|(min, max)| Bounds { min, max });
        let is_box = |root: &Bounds| {
            let size = root.max - root.min;
            size.is_finite() && size.min_element() >= 0.0
        };
        let node = |pair: &Value| {
            Some((NodeName::parse(pair.get(0)?.as_str()?)?, pair.get(1).and_then(Value::as_u64).unwrap_or(0)))
        };
        let inline = all.get("hierarchy").and_then(Value::as_array);
        Ok(Self {
            version,
            octree_dir: folder.join(octree_dir),
            step: json::count(all, "hierarchyStepSize").map_or(0, |step| step.min(1 << 10) as usize),
            files,
            scale,
            inline: inline.into_iter().flatten().filter_map(node).collect(),
            announced_points: json::count(all, "points"),
            crs: crs::from_text(json::text(all, "projection")),
            tree: NodeTree {
                root: root.filter(is_box).ok_or("it says no box that is one")?,
                root_spacing: json::number(all, "spacing").unwrap_or(0.0),
                ..NodeTree::default()
            },
        })
    }
}

/// A version as two numbers; zeros for what is none.
fn number_of(version: &str) -> (u64, u64) {
    let mut numbers = version.split('.').map(|number| number.trim().parse().unwrap_or(0));
    (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0))
}

/// An attribute, which is a word up to version 1.7, and described since.
fn attribute(of: &Value) -> Result<StoredAttribute, String> {
    let Value::String(word) = of else { return Ok(metadata::attribute(of)) };
    let known = WORDS.iter().find(|(name, ..)| name == word);
    let (name, kind, num) =
        known.ok_or_else(|| format!("it stores {word:?}, whose size only newer programs know"))?;
    Ok(StoredAttribute::plain(name, *kind, *num))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn cloud() -> Value {
        json!({
            "version": "1.8", "octreeDir": "data", "spacing": 0.5, "scale": 0.001, "hierarchyStepSize": 5,
            "boundingBox": {"lx": 1, "ly": 2, "lz": 3, "ux": 5, "uy": 6, "uz": 7},
            "pointAttributes": [
                {"name": "POSITION_CARTESIAN", "size": 12, "elements": 3, "elementSize": 4, "type": "int32"},
                {"name": "RGBA", "size": 4, "elements": 4, "elementSize": 1, "type": "uint8"},
            ],
        })
    }

    #[test]
    fn all_versions_are_read() {
        let read = |all: &Value| Cloud1::of(all, Path::new("a"));
        let newest = read(&cloud()).unwrap();
        assert_eq!((newest.octree_dir, newest.step, newest.scale), (PathBuf::from("a/data"), 5, 0.001));
        let NodeFiles::Binary(layout) = newest.files else { panic!("no records") };
        assert_eq!((layout.record_bytes, layout.columns.white), (16, Some(255)));
        let mut words = cloud();
        words["version"] = json!("1.7");
        words["pointAttributes"] = json!(["POSITION_CARTESIAN", "COLOR_PACKED", "NORMAL_SPHEREMAPPED"]);
        let NodeFiles::Binary(layout) = read(&words).unwrap().files else { panic!("no records") };
        assert_eq!(layout.record_bytes, 18);
        let mut oldest = cloud();
        oldest["version"] = json!("1.4");
        oldest["pointAttributes"] = json!("LAZ");
        oldest["hierarchy"] = json!([["r", 5], ["r7", 4], ["x", 3], 3, ["r70"]]);
        let oldest = read(&oldest).unwrap();
        assert_eq!(oldest.files.ending(), "laz");
        let names: Vec<_> = oldest.inline.iter().map(|(key, num)| (key.name(), *num)).collect();
        assert_eq!(names, [("r".to_owned(), 5), ("r7".to_owned(), 4), ("r70".to_owned(), 0)]);
    }

    #[test]
    fn what_makes_no_sense_is_said() {
        let cases = [
            ("version", json!("1.3"), "only 1.4"),
            ("version", json!(null), "only 1.4"),
            ("octreeDir", json!("https://a.b/data"), "on a server"),
            ("pointAttributes", json!("ZIP"), "what its nodes store"),
            ("pointAttributes", json!(["POSITION_CARTESIAN", "WIND"]), "\"WIND\""),
            ("pointAttributes", json!([]), "no position"),
            ("scale", json!(0), "no scale"),
            ("boundingBox", json!({"lx": 1}), "no box"),
            ("boundingBox", json!({"lx": 1, "ly": 1, "lz": 1, "ux": 0, "uy": 2, "uz": 2}), "no box"),
            ("boundingBox", json!({"lx": -1e308, "ly": 1, "lz": 1, "ux": 1e308, "uy": 2, "uz": 2}), "no box"),
        ];
        for (key, value, said) in cases {
            let mut all = cloud();
            all[key] = value;
            let error = Cloud1::of(&all, Path::new("")).map(|_| ()).unwrap_err();
            assert!(error.contains(said), "{error}");
        }
    }
}
