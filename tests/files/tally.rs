//! What `info --attributes` says of files: compared with what was written, and for real scans with plain folds over all
//! values at once.

use super::attributes::{by_bytes, by_las, everything, las, point, read};
use base::task::{CancelToken, Progress, Task};
use kit::las_files::save;
use kit::real_scans::folder;
use las::Point;
use las::point::Format;
use points::info::attributes_text;
use points::{Attribute, Column, Field, OpenHints, ReadOptions, Type, open};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

fn described(path: &Path) -> Result<Value, String> {
    let task = Task::new(&CancelToken::default());
    let text = attributes_text(&[path.to_owned()], true, &ReadOptions::AS_FILES_SAY, &task);
    Ok(serde_json::from_str(&text.map_err(|error| error.to_string())?).unwrap())
}

/// Number of values, the smallest and the largest, of a list of numbers that are ordered.
macro_rules! of_numbers {
    ($values:expr, $field:expr) => {{
        let is_value = |value: &_| $field.no_data != Some(*value as f64);
        let mut values: Vec<_> = $values.iter().copied().filter(is_value).collect();
        values.retain(|value| !(*value as f64).is_nan());
        let is_less = |a: &_, b: &_| PartialOrd::partial_cmp(a, b).unwrap();
        let is_plain = $field.scale == 1.0 && $field.offset == 0.0;
        let json = |value: Option<_>| match value {
            None => Value::Null,
            Some(value) if is_plain => Value::from(value),
            Some(value) => Value::from($field.offset + $field.scale * value as f64),
        };
        let ends = [values.iter().copied().min_by(is_less), values.iter().copied().max_by(is_less)].map(json);
        (values.len(), ends)
    }};
}

/// The same of a column of the points' values.
fn folded(column: &Column, field: &Field, num_points: usize) -> (usize, [Value; 2]) {
    let of_parts = |parts: [(usize, [Value; 2]); 3]| {
        let [a, b, c] = parts;
        let ends = [0, 1].map(|end| json!([a.1[end], b.1[end], c.1[end]]));
        (a.0, ends)
    };
    match column {
        Column::Bool(marks) => {
            (marks.count(), [json!(marks.count() == num_points), json!(marks.count() > 0)])
        }
        Column::U8(values) => of_numbers!(values, field),
        Column::I8(values) => of_numbers!(values, field),
        Column::U16(values) => of_numbers!(values, field),
        Column::I16(values) => of_numbers!(values, field),
        Column::U32(values) => of_numbers!(values, field),
        Column::I32(values) => of_numbers!(values, field),
        Column::U64(values) => of_numbers!(values, field),
        Column::I64(values) => of_numbers!(values, field),
        Column::F32(values) => {
            let values: Vec<f64> = values.iter().map(|&value| value.into()).collect();
            of_numbers!(values, field)
        }
        Column::F64(values) => of_numbers!(values, field),
        Column::U16x3(values) => of_parts([0, 1, 2].map(|part| {
            let values: Vec<u16> = values.iter().map(|value| value[part]).collect();
            of_numbers!(values, field)
        })),
        Column::F32x3(values) => of_parts([0, 1, 2].map(|part| {
            let values: Vec<f64> = values.iter().map(|value| value[part].into()).collect();
            of_numbers!(values, field)
        })),
    }
}

/// What differs between the description and the attributes that these columns hold, if anything does.
fn difference(
    described: &Value,
    fields: &[Field],
    num_points: usize,
    column: impl Fn(&Attribute) -> Option<Column>,
) -> Option<String> {
    let columns = described["columns"].as_array().unwrap();
    if described["points"] != num_points || columns.len() != fields.len() {
        return Some(format!("{} points, {} columns", described["points"], columns.len()));
    }
    columns.iter().zip(fields).find_map(|(got, field)| {
        let column = column(&field.attribute)?;
        let (num_values, [min, max]) = folded(&column, field, num_points);
        let name = field.attribute.name();
        let expected = json!([name, column.kind().name(), num_values, min, max]).to_string();
        // A float may lose its last bit where JSON is read.
        let expected: Value = serde_json::from_str(&expected).unwrap();
        let got_all = json!([got["name"], got["type"], got["points"], got["min"], got["max"]]);
        if got_all != expected {
            return Some(format!("{got_all}, not {expected}"));
        }
        let (Attribute::Classification, Column::U8(classes)) = (&field.attribute, &column) else {
            return None;
        };
        let counts = (0..=255).map(|class| (class, classes.iter().filter(|&&other| other == class).count()));
        let counts: serde_json::Map<String, Value> = counts
            .filter(|(_, num)| *num > 0)
            .map(|(class, num): (u8, usize)| (class.to_string(), num.into()))
            .collect();
        (got["classes"] != Value::Object(counts)).then(|| format!("classes {}", got["classes"]))
    })
}

#[test]
fn every_attribute_of_las_and_laz_is_told() {
    let plain = (0..=10).map(|format| (format, false));
    let compressed = (0..=8).filter(|format| ![4, 5].contains(format)).map(|format| (format, true));
    for (number, compressed) in plain.chain(compressed) {
        let bytes = las(number, compressed, true);
        let (_folder, path) = save("scan.las", &bytes);
        let mut format = Format::new(number).unwrap();
        format.extra_bytes = 1;
        let points: Vec<Point> = (0..super::attributes::NUM_POINTS).map(|at| point(at, &format)).collect();
        let (fields, _) = everything(&path);
        let column = |attribute: &Attribute| match attribute {
            Attribute::Named(name) => by_bytes(&points, name),
            standard => by_las(&points, standard, format.is_extended),
        };
        let got = described(&path).unwrap();
        assert_eq!(got["not_read"], json!(["unknown"]));
        assert_eq!(difference(&got, &fields, points.len(), column), None, "{number} {compressed}");
        // A point of another class, at its byte in an uncompressed record, is noticed.
        if !compressed && number == 7 {
            let mut changed = bytes;
            let at = changed.len() - 66 + 16;
            changed[at] ^= 1;
            let (_folder, path) = save("changed.las", &changed);
            assert!(difference(&described(&path).unwrap(), &fields, points.len(), column).is_some());
        }
    }
}

/// A row of a PLY file beside its place.
type ScalarRow = (i8, u8, i16, u16, i32, u32, f32, f64);

const PLY_TYPES: [(&str, Type); 8] = [
    ("char", Type::I8),
    ("uchar", Type::U8),
    ("short", Type::I16),
    ("ushort", Type::U16),
    ("int", Type::I32),
    ("uint", Type::U32),
    ("float", Type::F32),
    ("double", Type::F64),
];

fn ply(rows: &[ScalarRow], encoding: &str) -> Vec<u8> {
    let mut bytes = format!("ply\nformat {encoding} 1.0\nelement vertex {}\n", rows.len()).into_bytes();
    bytes.extend(b"property int x\nproperty int y\nproperty int z\nproperty list uchar uchar weights\n");
    PLY_TYPES.iter().for_each(|(name, _)| bytes.extend(format!("property {name} a_{name}\n").bytes()));
    bytes.extend(b"end_header\n");
    for (number, row) in rows.iter().enumerate() {
        let (a, b, c, d, e, f, g, h) = *row;
        if encoding == "ascii" {
            bytes.extend(format!("{number} 0 0 1 7 {a} {b} {c} {d} {e} {f} {g:?} {h:?}\n").bytes());
            continue;
        }
        let is_big = encoding == "binary_big_endian";
        let mut put = |little: &[u8]| match is_big {
            true => bytes.extend(little.iter().rev()),
            false => bytes.extend(little),
        };
        [number as i32, 0, 0].iter().for_each(|place| put(&place.to_le_bytes()));
        [1, 7].iter().for_each(|&byte: &u8| put(&[byte]));
        put(&a.to_le_bytes());
        put(&b.to_le_bytes());
        put(&c.to_le_bytes());
        put(&d.to_le_bytes());
        put(&e.to_le_bytes());
        put(&f.to_le_bytes());
        put(&g.to_le_bytes());
        put(&h.to_le_bytes());
    }
    bytes
}

fn ply_columns(rows: &[ScalarRow], is_text: bool) -> [Column; 8] {
    // Text has the digits of the shortest number of 32 bits, and is read in double precision.
    let as_text = |value: f32| format!("{value:?}").parse().unwrap();
    [
        Column::I8(rows.iter().map(|row| row.0).collect()),
        Column::U8(rows.iter().map(|row| row.1).collect()),
        Column::I16(rows.iter().map(|row| row.2).collect()),
        Column::U16(rows.iter().map(|row| row.3).collect()),
        Column::I32(rows.iter().map(|row| row.4).collect()),
        Column::U32(rows.iter().map(|row| row.5).collect()),
        if is_text {
            Column::F64(rows.iter().map(|row| as_text(row.6)).collect())
        } else {
            Column::F32(rows.iter().map(|row| row.6).collect())
        },
        Column::F64(rows.iter().map(|row| row.7).collect()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn every_scalar_of_ply_is_told(rows in prop::collection::vec(
        (any::<i8>(), any::<u8>(), any::<i16>(), any::<u16>(), any::<i32>(), any::<u32>(),
         prop_oneof![9 => prop::num::f32::NORMAL, 1 => Just(f32::NAN)], prop::num::f64::NORMAL), 1..60)) {
        for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
            let (_folder, path) = save("scan.ply", &ply(&rows, encoding));
            let columns = ply_columns(&rows, encoding == "ascii");
            let fields: Vec<Field> = PLY_TYPES.iter().zip(&columns).map(|((name, _), column)| {
                Field::plain(Attribute::Named(format!("a_{name}")), column.kind())
            }).collect();
            let column = |attribute: &Attribute| {
                let at = fields.iter().position(|field| field.attribute == *attribute);
                at.map(|at| columns[at].clone())
            };
            let got = described(&path).unwrap();
            prop_assert_eq!(difference(&got, &fields, rows.len(), column), None, "{}", encoding);
            prop_assert_eq!(&got["not_read"], &json!(["weights"]));
            let mut others = rows.clone();
            others[0].4 = others[0].4.wrapping_add(1);
            let (_folder, path) = save("other.ply", &ply(&others, encoding));
            let is_extreme = rows.iter().map(|row| row.4).min() != others.iter().map(|row| row.4).min()
                || rows.iter().map(|row| row.4).max() != others.iter().map(|row| row.4).max();
            let other = described(&path).unwrap();
            prop_assert_eq!(difference(&other, &fields, rows.len(), column).is_some(), is_extreme);
        }
    }
}

#[test]
fn several_files_are_told_together() {
    let (_a, first) = save("a.las", &las(6, false, false));
    let (_b, second) = save(
        "b.ply",
        b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
        property float z\nproperty ushort intensity\nproperty uchar odd\nend_header\n0 0 0 65535 9\n",
    );
    let task = Task::new(&CancelToken::default());
    let text = attributes_text(&[first, second], false, &ReadOptions::AS_FILES_SAY, &task).unwrap();
    for line in ["points      70,002", "format      LAS 1.4, point format 6; PLY, ascii", "classes     0 ("] {
        assert!(text.contains(line), "{line}: {text}");
    }
    let row = |name: &str| {
        let line = text.lines().find(|line| line.trim_start().starts_with(name)).unwrap_or_default();
        line.split_whitespace().map(String::from).collect::<Vec<_>>()
    };
    assert_eq!(row("intensity "), ["intensity", "u16", "70,002", "0", "65535"]);
    assert_eq!(row("extra:odd "), ["extra:odd", "u8", "1", "9", "9"]);
    assert_eq!(row("key_point ")[3..], ["no", "yes"]);
}

/// Faces are passed over, wherever they are: their triangles would be in memory all together.
#[test]
fn points_of_a_mesh_are_told_without_its_faces() {
    let mut made = super::ply::made::MadePly::new(5000);
    for faces_first in [false, true] {
        made.faces_first = faces_first;
        for encoding in super::ply::made::MadeEncoding::ALL {
            let (_folder, path) = save("mesh.ply", &made.bytes(encoding));
            let got = described(&path).unwrap();
            assert_eq!((&got["points"], &got["warnings"]), (&json!(5000), &json!([])), "{encoding:?}");
            let want = open(&path, &OpenHints::default()).unwrap().header().schema.projection();
            for (want, has_triangles) in [(want.clone(), true), (want.without_triangles(), false)] {
                let mut take = |_| Ok(());
                let trailer = open(&path, &OpenHints::default())
                    .unwrap()
                    .read(&want, &mut take, &Progress::hidden())
                    .unwrap();
                assert_eq!(!trailer.triangles.is_empty(), has_triangles, "{encoding:?}");
            }
        }
    }
}

/// Files below a folder.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files_below(&path) } else { vec![path] }).collect()
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn every_attribute_of_real_scans_is_told() {
    let (mut num_files, mut num_attributes) = (0, 0);
    for path in files_below(&folder()) {
        // Files that cannot be read are told by other tests.
        let Ok(got) = described(&path) else { continue };
        let (fields, want) = everything(&path);
        let (block, _) = read(&path, &want);
        let column = |attribute: &Attribute| block.column(attribute).cloned();
        assert_eq!(difference(&got, &fields, block.xyz.len(), column), None, "{}", path.display());
        assert_eq!(
            got["not_read"],
            json!(open(&path, &OpenHints::default()).unwrap().header().schema.unread),
            "{}",
            path.display()
        );
        (num_files, num_attributes) = (num_files + 1, num_attributes + fields.len());
    }
    assert!(num_files > 100 && num_attributes > 1500, "{num_files} files, {num_attributes} attributes");
}
