//! Every attribute that a LAS, LAZ or PLY file has, read on request and compared with the las crate's values, or with
//! those that were written.

use base::task::Progress;
use kit::las_files::{las_bytes, save};
use las::point::{Classification, Format, ScanDirection};
use las::raw::point::Waveform as LasWaveform;
use las::{Builder, Color, Point, Reader, Vlr};
use points::{Attribute, Block, Column, Field, Marks, OpenHints, Projection, Type, Waveform, open};
use std::path::Path;

pub const NUM_POINTS: usize = 70_001;

/// Returns irregular numbers of this many bits: a multiplicative hash.
fn part(number: usize, salt: u64, bits: u32) -> u64 {
    (number as u64 * 31 + salt + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - bits)
}

pub fn point(number: usize, format: &Format) -> Point {
    let is = |salt| part(number, salt, 3) == 0;
    let bits = |salt, in_old: u32, in_new: u32| {
        part(number, salt, if format.is_extended { in_new } else { in_old }) as u8
    };
    // The las crate makes a flag of class 12.
    let class = Some(bits(1, 5, 8)).filter(|&class| class != 12).unwrap_or(7);
    let angle =
        if format.is_extended { part(number, 2, 15) as f32 * 0.006 } else { part(number, 2, 6) as f32 };
    Point {
        x: part(number, 3, 20) as f64,
        y: part(number, 4, 20) as f64,
        z: part(number, 5, 12) as f64,
        intensity: part(number, 6, 16) as u16,
        return_number: bits(7, 3, 4),
        number_of_returns: bits(8, 3, 4),
        scan_direction: if is(9) { ScanDirection::LeftToRight } else { ScanDirection::RightToLeft },
        is_edge_of_flight_line: is(10),
        classification: Classification::new(class).unwrap(),
        is_synthetic: is(11),
        is_key_point: is(12),
        is_withheld: is(13),
        is_overlap: format.is_extended && is(14),
        scanner_channel: if format.is_extended { part(number, 15, 2) as u8 } else { 0 },
        scan_angle: if is(16) { -angle } else { angle },
        user_data: part(number, 17, 8) as u8,
        point_source_id: part(number, 18, 16) as u16,
        gps_time: format.has_gps_time.then(|| part(number, 19, 50) as f64 / 1e6),
        color: format.has_color.then(|| {
            let [red, green, blue] = [20, 21, 22].map(|salt| part(number, salt, 16) as u16);
            Color { red, green, blue }
        }),
        waveform: format.has_waveform.then(|| LasWaveform {
            wave_packet_descriptor_index: part(number, 23, 8) as u8,
            byte_offset_to_waveform_data: part(number, 24, 60),
            waveform_packet_size_in_bytes: part(number, 25, 32) as u32,
            return_point_waveform_location: part(number, 26, 20) as f32,
            x_t: part(number, 27, 20) as f32,
            y_t: -(part(number, 28, 20) as f32),
            z_t: 0.5,
        }),
        nir: format.has_nir.then(|| part(number, 29, 16) as u16),
        extra_bytes: if format.extra_bytes > 0 { extra_bytes(number) } else { Vec::new() },
    }
}

/// The extra bytes: names, number of the type, bytes (of unknown types).
const EXTRA: [(&str, u8, u8); 7] = [
    ("amplitude", 3, 0),
    ("unknown", 0, 3),
    ("deviation", 2, 0),
    ("range", 9, 0),
    ("stamp", 7, 0),
    ("precise", 10, 0),
    ("change", 6, 0),
];
const NUM_EXTRA_BYTES: u16 = 2 + 3 + 1 + 4 + 8 + 8 + 4;

fn amplitude(number: usize) -> u16 {
    part(number, 40, 16) as u16
}

fn extra_bytes(number: usize) -> Vec<u8> {
    [
        &amplitude(number).to_le_bytes()[..],
        &[1, 2, 3],
        &(part(number, 41, 8) as i8).to_le_bytes(),
        &(part(number, 42, 20) as f32).to_le_bytes(),
        &part(number, 43, 64).to_le_bytes(),
        &(part(number, 44, 50) as f64 / 1e6).to_le_bytes(),
        &(part(number, 45, 32) as i32).to_le_bytes(),
    ]
    .concat()
}

fn described() -> Vec<u8> {
    let entry = |&(name, kind, options): &(&str, u8, u8)| {
        let mut entry = vec![0; 192];
        (entry[2], entry[3]) = (kind, options);
        entry[4..4 + name.len()].copy_from_slice(name.as_bytes());
        if name == "amplitude" {
            // These flags say that no-data, scale and offset count.
            entry[3] = 1 | 8 | 16;
            entry[40..48].copy_from_slice(&65535u64.to_le_bytes());
            entry[112..120].copy_from_slice(&0.25f64.to_le_bytes());
            entry[136..144].copy_from_slice(&(-40f64).to_le_bytes());
        }
        entry
    };
    EXTRA.iter().flat_map(entry).collect()
}

pub fn las(point_format: u8, compressed: bool, has_extra: bool) -> Vec<u8> {
    let mut format = Format::new(point_format).unwrap();
    format.is_compressed = compressed;
    format.extra_bytes = if has_extra { NUM_EXTRA_BYTES } else { 0 };
    let mut builder = Builder::from((1, 4));
    builder.point_format = format;
    if has_extra {
        let (user_id, description) = ("LASF_Spec".to_owned(), String::new());
        builder.vlrs.push(Vlr { user_id, record_id: 4, description, data: described() });
    }
    las_bytes(builder, (0..NUM_POINTS).map(|number| point(number, &format)))
}

/// Reads all of a file into one block, with these attributes.
pub fn read(path: &Path, want: &Projection) -> (Block, usize) {
    let (mut whole, mut num_blocks): (Option<Block>, usize) = (None, 0);
    let mut take = |block: Block| {
        num_blocks += 1;
        match &mut whole {
            None => whole = Some(block),
            Some(whole) => append(whole, block),
        }
        Ok(())
    };
    open(path, &OpenHints::default()).unwrap().read(want, &mut take, &Progress::hidden()).unwrap();
    (whole.unwrap(), num_blocks)
}

fn append(whole: &mut Block, block: Block) {
    let len = whole.xyz.len();
    whole.xyz.extend(block.xyz);
    assert_eq!(whole.columns.len(), block.columns.len());
    for ((attribute, all), (other, more)) in whole.columns.iter_mut().zip(block.columns) {
        assert_eq!(*attribute, other);
        match (all, more) {
            (Column::Bool(all), Column::Bool(more)) => all.append(&more, len),
            (Column::U8(all), Column::U8(more)) => all.extend(more),
            (Column::I8(all), Column::I8(more)) => all.extend(more),
            (Column::U16(all), Column::U16(more)) => all.extend(more),
            (Column::I16(all), Column::I16(more)) => all.extend(more),
            (Column::U32(all), Column::U32(more)) => all.extend(more),
            (Column::I32(all), Column::I32(more)) => all.extend(more),
            (Column::U64(all), Column::U64(more)) => all.extend(more),
            (Column::I64(all), Column::I64(more)) => all.extend(more),
            (Column::F32(all), Column::F32(more)) => all.extend(more),
            (Column::F64(all), Column::F64(more)) => all.extend(more),
            (Column::U16x3(all), Column::U16x3(more)) => all.extend(more),
            (Column::F32x3(all), Column::F32x3(more)) => all.extend(more),
            (all, more) => panic!("{:?} after {:?}", more.kind(), all.kind()),
        }
    }
}

/// Returns all attributes of a file.
pub fn everything(path: &Path) -> (Vec<Field>, Projection) {
    let schema = open(path, &OpenHints::default()).unwrap().header().schema.clone();
    let want = schema.projection();
    (schema.fields, want)
}

/// A standard attribute as the las crate has it, made a column; `None` if the points lack it.
pub fn by_las(points: &[Point], attribute: &Attribute, is_extended: bool) -> Option<Column> {
    use Attribute as A;
    let flags = |is: &dyn Fn(&Point) -> bool| {
        let mut marks = Marks::default();
        points.iter().enumerate().filter(|(_, point)| is(point)).for_each(|(number, _)| marks.set(number));
        Column::Bool(marks)
    };
    let bytes = |byte: &dyn Fn(&Point) -> u8| Column::U8(points.iter().map(byte).collect());
    let waves = || points.iter().map(|point| point.waveform).collect::<Option<Vec<LasWaveform>>>();
    Some(match attribute {
        A::Intensity => Column::U16(points.iter().map(|point| point.intensity).collect()),
        A::ReturnNumber => bytes(&|point| point.return_number),
        A::NumReturns => bytes(&|point| point.number_of_returns),
        A::ScanDirection => flags(&|point| point.scan_direction == ScanDirection::LeftToRight),
        A::EdgeOfFlightLine => flags(&|point| point.is_edge_of_flight_line),
        A::Classification => bytes(&|point| point.classification.into()),
        A::Synthetic => flags(&|point| point.is_synthetic),
        A::KeyPoint => flags(&|point| point.is_key_point),
        A::Withheld => flags(&|point| point.is_withheld),
        A::Overlap => flags(&|point| point.is_overlap),
        A::Noise => flags(&|point| [7, 18].contains(&u8::from(point.classification))),
        A::ScannerChannel => bytes(&|point| point.scanner_channel),
        A::ScanAngle if is_extended => {
            let steps = |point: &Point| (f64::from(point.scan_angle) / 0.006).round() as i16;
            Column::I16(points.iter().map(steps).collect())
        }
        A::ScanAngle => Column::I8(points.iter().map(|point| point.scan_angle as i8).collect()),
        A::UserData => bytes(&|point| point.user_data),
        A::SourceId => Column::U16(points.iter().map(|point| point.point_source_id).collect()),
        A::GpsTime => Column::F64(points.iter().map(|point| point.gps_time).collect::<Option<_>>()?),
        A::Color => {
            let color = |point: &Point| point.color.map(|color| [color.red, color.green, color.blue]);
            Column::U16x3(points.iter().map(color).collect::<Option<_>>()?)
        }
        A::NearInfrared => Column::U16(points.iter().map(|point| point.nir).collect::<Option<_>>()?),
        A::Waveform(part) => {
            let waves = waves()?.into_iter();
            match part {
                Waveform::Description => Column::U8(waves.map(|w| w.wave_packet_descriptor_index).collect()),
                Waveform::Offset => Column::U64(waves.map(|w| w.byte_offset_to_waveform_data).collect()),
                Waveform::Size => Column::U32(waves.map(|w| w.waveform_packet_size_in_bytes).collect()),
                Waveform::Location => Column::F32(waves.map(|w| w.return_point_waveform_location).collect()),
                Waveform::Direction => Column::F32x3(waves.map(|w| [w.x_t, w.y_t, w.z_t]).collect()),
            }
        }
        A::Normal | A::Opacity | A::Named(_) => return None,
    })
}

/// An attribute of extra bytes, from the bytes that the las crate hands out.
pub fn by_bytes(points: &[Point], name: &str) -> Option<Column> {
    fn numbers<const N: usize, T>(points: &[Point], at: usize, number: fn([u8; N]) -> T) -> Vec<T> {
        let bytes = |point: &Point| *point.extra_bytes[at..].first_chunk().unwrap();
        points.iter().map(|point| number(bytes(point))).collect()
    }
    Some(match name {
        "amplitude" => Column::U16(numbers(points, 0, u16::from_le_bytes)),
        "deviation" => Column::I8(numbers(points, 5, i8::from_le_bytes)),
        "range" => Column::F32(numbers(points, 6, f32::from_le_bytes)),
        "stamp" => Column::U64(numbers(points, 10, u64::from_le_bytes)),
        "precise" => Column::F64(numbers(points, 18, f64::from_le_bytes)),
        "change" => Column::I32(numbers(points, 26, i32::from_le_bytes)),
        _ => return None,
    })
}

/// Returns the first attribute that differs from what the las crate has, or how many were compared.
fn difference(path: &Path) -> Result<usize, String> {
    let mut reader = Reader::from_path(path).unwrap();
    let is_extended = reader.header().point_format().is_extended;
    let points: Vec<Point> = reader.read_all().unwrap().points().map(Result::unwrap).collect();
    let (fields, want) = everything(path);
    let (block, _) = read(path, &want);
    if block.xyz.len() != points.len() {
        return Err(format!("{} points, not {}", block.xyz.len(), points.len()));
    }
    for Field { attribute, kind, .. } in &fields {
        let theirs = match attribute {
            Attribute::Named(name) => by_bytes(&points, name),
            standard => by_las(&points, standard, is_extended),
        };
        let ours = block.column(attribute).ok_or(format!("no {attribute:?}"))?;
        if ours.kind() != *kind || theirs.as_ref() != Some(ours) {
            return Err(format!("{attribute:?} differs"));
        }
    }
    Ok(fields.len())
}

#[test]
fn all_attributes_of_all_formats_equal_the_las_crates() {
    let cases = (0..=10)
        .map(|format| (format, false))
        .chain((0..=8).filter(|f| ![4, 5].contains(f)).map(|f| (f, true)));
    for (format, compressed) in cases {
        for has_extra in [false, true] {
            let what = format!("format {format}, compressed {compressed}, extra bytes {has_extra}");
            let (_folder, path) = save("scan.las", &las(format, compressed, has_extra));
            let least = if format < 6 { 13 } else { 15 };
            let gps = usize::from(![0, 2].contains(&format));
            let color = usize::from([2, 3, 5, 7, 8, 10].contains(&format));
            let nir = usize::from([8, 10].contains(&format));
            let waveform = if [4, 5, 9, 10].contains(&format) { 5 } else { 0 };
            // Nobody knows what the unknown bytes are.
            let extra = if has_extra { EXTRA.len() - 1 } else { 0 };
            assert_eq!(difference(&path), Ok(least + gps + color + nir + waveform + extra), "{what}");
        }
    }
}

#[test]
fn a_changed_bit_is_a_difference() {
    let bytes = las(7, false, true);
    let record = 36 + usize::from(NUM_EXTRA_BYTES);
    let start = bytes.len() - 5000 * record;
    for (at, attribute) in [
        (12, "Intensity"),
        (14, "ReturnNumber"),
        (15, "Synthetic"),
        (16, "Classification"),
        (18, "ScanAngle"),
        (35, "Color"),
        (36, "Named(\"amplitude\")"),
    ] {
        let (_a, path) = save("a.las", &bytes);
        let mut changed = bytes.clone();
        changed[start + at] ^= 1;
        let (_b, other) = save("b.las", &changed);
        let (_, want) = everything(&path);
        let (ours, theirs) = (read(&path, &want).0, read(&other, &want).0);
        let columns = ours.columns.iter().zip(&theirs.columns);
        let different: Vec<String> =
            columns.filter(|(a, b)| a.1 != b.1).map(|(a, _)| format!("{:?}", a.0)).collect();
        assert!(different.contains(&attribute.to_owned()), "{attribute}: {different:?}");
        assert!(
            different.iter().all(|name| name == attribute || name == "Noise"),
            "{attribute}: {different:?}"
        );
    }
}

#[test]
fn scale_offset_and_no_data_are_those_of_the_file() {
    let (_folder, path) = save("scan.laz", &las(6, true, true));
    let schema = &open(&path, &OpenHints::default()).unwrap().header().clone().schema;
    let amplitude = schema.field(&Attribute::Named("amplitude".into())).unwrap();
    assert_eq!((amplitude.scale, amplitude.offset, amplitude.no_data), (0.25, -40.0, Some(65535.0)));
    let angle = schema.field(&Attribute::ScanAngle).unwrap();
    assert_eq!((angle.kind, angle.scale, angle.no_data), (Type::I16, 0.006, None));
    assert_eq!(schema.field(&Attribute::Named("unknown".into())), None);
    assert!(schema.names().contains(&"extra:amplitude".into()), "{:?}", schema.names());
    assert_eq!(schema.unread, ["unknown"]);
}

#[test]
fn each_attribute_alone_is_the_same_as_with_the_others() {
    for (format, compressed) in [(3, false), (3, true), (8, false), (8, true)] {
        let (_folder, path) = save("scan.las", &las(format, compressed, true));
        let (fields, want) = everything(&path);
        let (all, _) = read(&path, &want);
        for Field { attribute, .. } in fields {
            let (alone, _) = read(&path, &Projection::of([attribute.clone()]));
            // Layers that are not wanted must not be needed by those that are.
            assert_eq!(alone.columns.len(), 1, "what is not asked for has no column");
            assert!(
                alone.xyz == all.xyz && alone.column(&attribute) == all.column(&attribute),
                "{attribute:?}"
            );
        }
        let (none, _) = read(&path, &Projection::of([]));
        assert!(none.xyz == all.xyz && none.columns.is_empty());
    }
}

#[test]
fn blocks_put_together_are_the_whole_file() {
    let mut made = super::ply::made::MadePly::new(90_000);
    // A normal of NaN does not equal itself, so there is to be none.
    made.points.iter_mut().for_each(|point| point.normal[0] += 0.25);
    let mut cases = vec![("scan.laz", las(7, true, false)), ("scan.las", repeated(las(7, false, true), 9))];
    cases.extend(super::ply::made::MadeEncoding::ALL.map(|encoding| ("mesh.ply", made.bytes(encoding))));
    for (name, bytes) in cases {
        let (_folder, path) = save(name, &bytes);
        let (_, want) = everything(&path);
        let (whole, _) = read(&path, &want);
        let (parts, num_blocks) = read(&path, &want.in_blocks_of(10_000));
        assert!(num_blocks > 1, "{name}: one block");
        assert!(whole.xyz == parts.xyz && whole.columns == parts.columns, "{name}");
    }
}

/// Returns the same file with its points several times.
fn repeated(mut bytes: Vec<u8>, times: usize) -> Vec<u8> {
    let start = u32::from_le_bytes(*bytes[96..].first_chunk().unwrap());
    let points = bytes[start as usize..].to_vec();
    (1..times).for_each(|_| bytes.extend_from_slice(&points));
    bytes[247..255].copy_from_slice(&((times * NUM_POINTS) as u64).to_le_bytes());
    bytes
}

/// 2, −2 and 8 as floats of 16 bits.
const HALVES: [u16; 3] = [0x4000, 0xc000, 0x4800];

/// A PLY file with a scalar of each type, in each encoding.
#[test]
fn scalars_of_every_type_are_read_from_ply() {
    let names =
        ["char", "uchar", "short", "ushort", "int", "uint", "int64", "uint64", "float16", "float", "double"];
    let rows: [[i128; 11]; 3] = [
        [
            -128,
            255,
            -32768,
            65535,
            -2_147_483_648,
            4_294_967_295,
            i64::MIN as i128,
            u64::MAX as i128,
            2,
            3,
            4,
        ],
        [127, 0, 32767, 1, 2_147_483_647, 7, i64::MAX as i128, (1 << 53) + 1, -2, -3, -4],
        [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10],
    ];
    for (encoding, is_big) in [("ascii", false), ("binary_little_endian", false), ("binary_big_endian", true)]
    {
        let mut bytes = format!("ply\nformat {encoding} 1.0\nelement vertex 3\n").into_bytes();
        bytes.extend(b"property float x\nproperty float y\nproperty float z\n");
        for name in names {
            bytes.extend(format!("property {name} scalar_{name}\n").bytes());
        }
        bytes.extend(b"end_header\n");
        for (number, row) in rows.iter().enumerate() {
            if encoding == "ascii" {
                let words: Vec<String> = row.iter().map(i128::to_string).collect();
                bytes.extend(format!("{number} 0 0 {}\n", words.join(" ")).bytes());
                continue;
            }
            let mut put = |mut little: Vec<u8>| {
                if is_big {
                    little.reverse();
                }
                bytes.extend(little);
            };
            [number as f32, 0.0, 0.0].iter().for_each(|c| put(c.to_le_bytes().to_vec()));
            for (kind, value) in names.iter().zip(row) {
                let num_bytes =
                    [1, 1, 2, 2, 4, 4, 8, 8][..].get(names.iter().position(|n| n == kind).unwrap());
                match (num_bytes, *kind) {
                    (Some(&num_bytes), _) => put(value.to_le_bytes()[..num_bytes].to_vec()),
                    (_, "float16") => put(HALVES[number].to_le_bytes().to_vec()),
                    (_, "float") => put((*value as f32).to_le_bytes().to_vec()),
                    _ => put((*value as f64).to_le_bytes().to_vec()),
                }
            }
        }
        let (_folder, path) = save("scalars.ply", &bytes);
        let (fields, want) = everything(&path);
        assert_eq!(fields.len(), names.len());
        let (block, _) = read(&path, &want);
        let column = |at: usize| rows.iter().map(move |row| row[at]);
        let floats = |at: usize| column(at).map(|value| value as f64);
        let is_text = encoding == "ascii";
        let of_32 = |at: usize| {
            if is_text {
                Column::F64(floats(at).collect())
            } else {
                Column::F32(floats(at).map(|v| v as f32).collect())
            }
        };
        let expected = [
            Column::I8(column(0).map(|v| v as i8).collect()),
            Column::U8(column(1).map(|v| v as u8).collect()),
            Column::I16(column(2).map(|v| v as i16).collect()),
            Column::U16(column(3).map(|v| v as u16).collect()),
            Column::I32(column(4).map(|v| v as i32).collect()),
            Column::U32(column(5).map(|v| v as u32).collect()),
            Column::I64(column(6).map(|v| v as i64).collect()),
            Column::U64(column(7).map(|v| v as u64).collect()),
            of_32(8),
            of_32(9),
            Column::F64(floats(10).collect()),
        ];
        for ((name, field), expected) in names.iter().zip(&fields).zip(&expected) {
            assert_eq!(field.attribute, Attribute::Named(format!("scalar_{name}")));
            assert_eq!(field.kind, expected.kind(), "{name} {encoding}");
            assert_eq!(block.column(&field.attribute), Some(expected), "{name} {encoding}");
        }
        // One scalar is read alone, and with a color that the file lacks.
        let some = Projection::of([Attribute::Named("scalar_int".into()), Attribute::Color]);
        assert_eq!(read(&path, &some).0.columns, [(fields[4].attribute.clone(), expected[4].clone())]);
    }
}

/// Values of PLY that are scaled to what all files have in common can also be had as they are stored, alone and
/// beside the scaled ones.
#[test]
fn intensities_and_colors_of_ply_can_be_had_as_they_are_stored() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                property double intensity\nproperty float red\nproperty float green\nproperty float blue\n\
                end_header\n0 0 0 -20.5 0.25 0.5 1\n1 0 0 -10.25 0 0 0\n2 0 0 -3.125 1 1 1\n";
    let (_folder, path) = save("spread.ply", text.as_bytes());
    let [intensity, red] = ["intensity", "red"].map(|name| Attribute::Named(name.into()));
    let stored = Column::F64(vec![-20.5, -10.25, -3.125]);
    let alone = read(&path, &Projection::of([intensity.clone()])).0;
    assert_eq!(alone.columns, [(intensity.clone(), stored.clone())]);
    let want = Projection::of([Attribute::Intensity, Attribute::Color, intensity.clone(), red.clone()]);
    let all = read(&path, &want).0;
    assert_eq!(all.column(&intensity), Some(&stored));
    assert_eq!(all.column(&red), Some(&Column::F64(vec![0.25, 0.0, 1.0])));
    let spread = read(&path, &Projection::of([Attribute::Intensity, Attribute::Color])).0;
    for attribute in [Attribute::Intensity, Attribute::Color] {
        assert!(all.column(&attribute).is_some(), "{attribute:?}");
        assert_eq!(all.column(&attribute), spread.column(&attribute));
    }
}
