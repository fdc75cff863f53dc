//! PLY as the world writes it: text whose lines end anywhere, names and types of many programs, colors in odd places,
//! Gaussian splats.

use super::made::{MadeEncoding, MadePly};
use super::{NAME, difference, read_one, text};
use crate::bytes::read_bytes;
use points::{ColorSource, ReadOptions, ScanFile, peek};

/// Header and body of a text file.
fn parts(bytes: &[u8]) -> (&str, &str) {
    let text = std::str::from_utf8(bytes).unwrap();
    text.split_at(text.find("end_header\n").unwrap() + "end_header\n".len())
}

/// Returns the same words with other ends of lines: after this many words each, in turn.
fn reflowed(bytes: &[u8], widths: &[usize], line_end: &str) -> Vec<u8> {
    let (header, body) = parts(bytes);
    let (mut out, mut widths, mut in_line) = (header.to_owned(), widths.iter().cycle(), 0);
    let mut width = *widths.next().unwrap();
    for word in body.split_whitespace() {
        out += word;
        in_line += 1;
        if in_line < width {
            out.push(' ');
        } else {
            out += line_end;
            (in_line, width) = (0, *widths.next().unwrap());
        }
    }
    out.into_bytes()
}

#[test]
fn rows_may_take_several_lines_and_share_one() {
    for num_points in [3, 700] {
        for (lists, faces_first) in [(false, false), (true, false), (false, true)] {
            let made = MadePly { lists, faces_first, ..MadePly::new(num_points) };
            let bytes = made.bytes(MadeEncoding::Ascii);
            let num_words = if lists { 13 } else { 12 };
            for (widths, line_end) in [
                (&[num_words / 2][..], "\n"),
                (&[3], "\r\n"),
                (&[1], "\n"),
                (&[10], " \n"),
                (&[10 * num_words], "\n\n"),
                (&[2, 17, 5, 1, 40], "\t\n"),
                (&[num_words, num_words, num_words, num_words, num_words - 1, 1], "\n"),
                (&[usize::MAX], ""),
            ] {
                let (file, warnings) = read_one(&reflowed(&bytes, widths, line_end));
                assert_eq!(difference(&file, &made), None, "{widths:?} words a line, {num_points} points");
                assert!(warnings.len() == 1, "{warnings:?}");
            }
        }
    }
}

/// Vertices stand on two lines, as the RealSense SDK writes them; there are more than are read at once.
#[test]
fn many_rows_of_several_lines_keep_their_order() {
    let num_points = 400_000;
    let mut bytes = format!(
        "ply\nformat ascii 1.0\nelement vertex {num_points}\nproperty float32 x\nproperty float32 y\n\
         property float32 z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    );
    for i in 0..num_points {
        bytes += &format!("{i} {} 0.5\n{} 7 {}\n", i % 1000, i % 256, i % 7);
    }
    let (file, warnings) = read_one(bytes.as_bytes());
    assert_eq!((file.points.xyz.len(), warnings.len()), (num_points, 0));
    let wrong = (0..num_points).find(|&i| {
        let place = file.grid.p_in_world(file.points.xyz[i]).to_array();
        place != [i as f64, (i % 1000) as f64, 0.5]
            || file.points.rgb[i] != [(i % 256) as u16, 7, (i % 7) as u16]
    });
    assert_eq!(wrong, None);
}

#[test]
fn a_bad_word_costs_its_row_only() {
    let row = |i: usize| format!("{i} 0 {}\n{} 1 2\n", i * 2, i % 256);
    let rows: Vec<String> = (0..100).map(row).collect();
    let properties = "float x, float y, float z, uchar red, uchar green, uchar blue";
    let whole = text(properties, &rows.concat());
    let whole = String::from_utf8(whole).unwrap().replace("element vertex 200", "element vertex 100");
    assert_eq!(read_one(whole.as_bytes()).0.points.xyz.len(), 100);
    let (file, warnings) = read_one(whole.replace("\n50 0 100\n", "\n50 zero 100\n").as_bytes());
    assert_eq!(file.points.xyz.len(), 99);
    let sentence = "has 1 line that could not be read and was left out: line 111, \"50 zero 100\"; get or export it again";
    assert!(warnings.len() == 1 && warnings[0].ends_with(sentence), "{warnings:?}");
    let places: Vec<f64> = file.points.xyz.iter().map(|&xyz| file.grid.p_in_world(xyz).x).collect();
    assert!(places.iter().all(|&x| x != 50.0 && x < 100.0) && places[98] == 99.0);
    // The file is cut off within a row.
    let (file, warnings) = read_one(&whole.as_bytes()[..whole.len() - 9]);
    assert_eq!(file.points.xyz.len(), 99);
    assert!(warnings[0].contains("announces 100 points, but only 99"), "{warnings:?}");
}

#[test]
fn a_value_that_is_missing_shifts_nothing() {
    let mut rows: Vec<String> = (0..50).map(|i| format!("{i} 0 0")).collect();
    rows[20] = "20 0".into();
    rows[30] = "30 0 0 7 8".into();
    let (file, warnings) = read_one(&text("float x, float y, float z", &(rows.join("\n") + "\n")));
    let places: Vec<f64> = file.points.xyz.iter().map(|&xyz| file.grid.p_in_world(xyz).x).collect();
    let expected: Vec<f64> = (0..50).filter(|&i| i != 20).map(f64::from).collect();
    assert_eq!(places, expected);
    assert!(warnings[0].contains("has 1 line that could not be read"), "{warnings:?}");
}

#[test]
fn values_that_no_property_names_are_said() {
    let bytes = text("float x, float y, float z", "0 0 0\n1 0 0\n");
    let (file, warnings) = read_one(&[&bytes[..], b"2 0 0\n"].concat());
    assert_eq!(file.points.xyz.len(), 2);
    assert!(warnings[0].contains("more values behind its last row"), "{warnings:?}");
    assert!(read_one(&[&bytes[..], b" \n\n"].concat()).1.is_empty());
}

#[test]
fn headers_of_other_hands_are_read() {
    let plain = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                 end_header\n0 0 0\n1 2 3\n4 5 6\n";
    let expected = read_one(plain.as_bytes()).0.points;
    let long = format!("comment {}\n", "preview ".repeat(8)).repeat(30_000);
    for (from, to) in [
        ("ply\n", "\u{feff}ply\n"),
        ("ply\n", "PLY\n"),
        ("ply\n", "\u{feff}PLY\r\n"),
        ("vertex 3", "vertex 3e+00"),
        ("element vertex", "ELEMENT Vertex"),
        ("float x", "float64 X"),
        ("float x", "int64 x"),
        ("float x", "f4 x"),
        ("property float z\n", &format!("property float z\n{long}")),
    ] {
        let bytes = plain.replacen(from, to, 1);
        let (file, warnings) = read_one(bytes.as_bytes());
        assert!(file.points == expected && warnings.is_empty(), "{}: {warnings:?}", &to[..to.len().min(40)]);
    }
    assert!(long.len() > 1 << 21);
    let endless = format!("ply\nformat ascii 1.0\n{}", "comment and so on\n".repeat(1 << 20));
    let error = read_bytes(NAME, endless.as_bytes()).map(|scan| scan.num_points()).unwrap_err().to_string();
    assert!(error.contains("no line end_header in its first 16 MiB"), "{error}");
}

#[test]
fn eight_byte_integers_are_read_as_bytes() {
    let header = "ply\nformat binary_big_endian 1.0\nelement vertex 2\nproperty int64 x\nproperty uint64 time\n\
                  property double y\nproperty float z\nend_header\n";
    let row = |x: i64| [&x.to_be_bytes()[..], &[9; 8], &2.5f64.to_be_bytes(), &1f32.to_be_bytes()].concat();
    let (file, _) = read_one(&[header.as_bytes(), &row(-7), &row(9)].concat());
    assert_eq!((file.bounds.min.to_array(), file.bounds.max.to_array()), ([-7.0, 2.5, 1.0], [9.0, 2.5, 1.0]));
}

#[test]
fn intensities_have_many_names() {
    let rows = "0 0 0 1\n0 0 1 2\n0 0 2 3\n";
    for name in [
        "intensity",
        "Intensity",
        "i",
        "reflectance",
        "Reflectance",
        "scalar_Intensity",
        "scalar_Reflectance",
        "scalar_Scalar_field",
        "amplitude",
        "scalar_Intensity_#1",
        "remission",
        "Reflected_intensity",
    ] {
        let (file, _) = read_one(&text(&format!("float x, float y, float z, float {name}"), rows));
        assert_eq!(file.points.intensity, [0, 32768, 65535], "{name}");
        assert!(matches!(file.coloring.source, ColorSource::Intensity { .. }), "{name}");
    }
    // The likeliest name counts.
    let both = text(
        "float x, float y, float z, float scalar_Scalar_field, float reflectance",
        "0 0 0 9 1\n0 0 1 0 2\n",
    );
    assert_eq!(read_one(&both).0.points.intensity, [0, 65535]);
}

fn colors(file: &ScanFile) -> Vec<u32> {
    (0..file.points.xyz.len()).map(|i| file.color(i) & 0xff_ffff).collect()
}

#[test]
fn packed_colors_are_unpacked() {
    // 0xAARRGGBB, as PCL packs them; expected are r | g << 8 | b << 16.
    let packed = [0xffff_8040u32, 0x0000_00ff, 0x0010_2030];
    let expected = [0x40_80ff, 0xff_0000, 0x30_2010];
    for kind in ["uint", "int", "float"] {
        for name in ["rgb", "rgba", "RGB"] {
            let header = format!(
                "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                 property float z\nproperty {kind} {name}\nend_header\n"
            );
            let row = |bits: &u32| [&[0; 12][..], &bits.to_le_bytes()].concat();
            let bytes = [header.as_bytes(), &packed.iter().flat_map(row).collect::<Vec<u8>>()].concat();
            assert_eq!(colors(&read_one(&bytes).0), expected, "{kind} {name}");
        }
    }
    let as_text =
        packed[1..].iter().map(|&bits| format!("0 0 0 {:e}\n", f32::from_bits(bits))).collect::<String>();
    assert_eq!(colors(&read_one(&text("float x, float y, float z, float rgb", &as_text)).0), expected[1..]);
}

#[test]
fn faces_color_their_corners_where_points_have_none() {
    let header = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 3\nproperty list uchar int vertex_indices\nproperty KIND red\nproperty KIND green\n\
                  property KIND blue\nend_header\n0 0 0\n1 0 0\nnan 0 0\n0 1 0\n1 1 0\n";
    let red = 0x00_00ff;
    let green = 0x00_ff00;
    for (kind, one) in [("uchar", "255"), ("float", "1.0"), ("ushort", "65535")] {
        let faces = format!("3 0 1 3 {one} 0 0\n3 1 4 3 0 {one} 0\n3 2 4 1 0 0 {one}\n");
        let bytes = (header.to_owned() + &faces).replace("KIND", kind);
        let (file, _) = read_one(bytes.as_bytes());
        assert_eq!(colors(&file), [red, red, red, green], "{kind}");
        assert_eq!(file.triangles, [[0, 1, 2], [1, 3, 2]]);
    }
    // The points' own colors win over those of faces.
    let own = header
        .replace("float z\n", "float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n");
    let own = own.replace("KIND", "uchar").replace(" 0\n", " 0 9 9 200\n");
    let faces = "3 0 1 3 255 0 0\n3 1 4 3 0 255 0\n3 0 4 1 0 0 255\n";
    let (file, warnings) = read_one((own.replace("1 1 0 9", "1 1 0 99") + faces).as_bytes());
    assert_eq!(file.points.rgb, [[9, 9, 200], [9, 9, 200], [9, 9, 200], [99, 9, 200]]);
    assert!(warnings.iter().any(|warning| warning.contains("those of faces are not read")), "{warnings:?}");
    // The faces' colors win if the points' are the same everywhere.
    let (file, warnings) = read_one((own + faces).as_bytes());
    assert_eq!(colors(&file), [red, red, red, green]);
    assert!(warnings.iter().any(|warning| warning.contains("those of its faces are shown")), "{warnings:?}");
}

#[test]
fn a_texture_is_said_not_to_be_read() {
    let rows = "0 0 0 0.5 0.5\n1 0 0 0.5 0.5\n";
    let bytes = text("float x, float y, float z, float s, float t", rows);
    let (_, warnings) = read_one(&bytes);
    assert!(warnings[0].contains("colors in a texture: its texture is not read"), "{warnings:?}");
    let named =
        String::from_utf8(bytes).unwrap().replace("element", "comment TextureFile castle wall.png\nelement");
    let (_, warnings) = read_one(named.as_bytes());
    assert!(warnings[0].contains("(castle wall.png) is not read; bake it into colors"), "{warnings:?}");
    let colored = named.replace("float s\n", "uchar red\nproperty uchar green\nproperty uchar blue\n");
    let colored = colored.replace("property float t\n", "").replace(" 0.5 0.5", " 1 2 3");
    let (_, warnings) = read_one(colored.as_bytes());
    assert!(warnings[0].contains("beside the colors of its points"), "{warnings:?}");
}

/// Place, constant terms, and opacity as a logit, of a splat as its training writes it.
type Splat = ([f32; 3], [f32; 3], f32);

fn splats(splats: &[Splat]) -> Vec<u8> {
    let names = "x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 f_rest_0 f_rest_1 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3";
    let properties: String = names.split(' ').map(|name| format!("property float {name}\n")).collect();
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n{properties}end_header\n",
        splats.len()
    );
    let row = |(place, color, opacity): &Splat| {
        let rest = [*opacity, -3.0, -3.0, -3.0, 1.0, 0.0, 0.0, 0.0];
        [&place[..], &[0.0; 3], color, &[0.1, 0.2], &rest].concat()
    };
    let values = splats.iter().flat_map(row).flat_map(f32::to_le_bytes);
    header.into_bytes().into_iter().chain(values).collect()
}

#[test]
fn splats_are_points_with_their_own_color_and_without_fog() {
    let red = [1.772_45, -1.772_45, 0.0];
    let opaque = ([0.0, 0.0, 0.0], red, 3.0);
    let faint = ([9.0, 9.0, 9.0], red, -4.0);
    let (file, warnings) = read_one(&splats(&[opaque, faint, ([1.0, 2.0, 3.0], [0.0; 3], 0.0)]));
    assert_eq!(colors(&file), [0x80_00ff, 0x80_8080]);
    assert_eq!(file.bounds.max.to_array(), [1.0, 2.0, 3.0], "what is left out does not count");
    assert!(file.points.normals.is_empty(), "splats have zeros there");
    assert!(
        warnings.len() == 1 && warnings[0].contains("has 1 splat nearly transparent; it was"),
        "{warnings:?}"
    );
    assert!(file.format.ends_with(", Gaussian splat"), "{}", file.format);
    // If all splats are faint, they are all that can be seen.
    let (file, warnings) = read_one(&splats(&[faint, ([8.0, 9.0, 9.0], [0.0; 3], -4.0)]));
    assert_eq!((file.points.xyz.len(), warnings.len()), (2, 0), "{warnings:?}");
}

#[test]
fn the_attributes_of_a_splat_are_not_listed_one_by_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scan.ply");
    std::fs::write(&path, splats(&[([0.0; 3], [0.0; 3], 0.0)])).unwrap();
    assert_eq!(peek(&[path], &ReadOptions::AS_FILES_SAY).unwrap()[0].attributes(), ["rgb", "opacity"]);
}

/// A position, and red, green, blue and opacity, 0 to 1.
type Packed = ([f64; 3], [f64; 4]);

/// A file of compressed splats: 256 to a chunk, which has a box of positions and, if wished, one of colors.
fn compressed(points: &[Packed], color_boxes: bool) -> Vec<u8> {
    let of =
        |names: &str| names.split(' ').map(|name| format!("property float {name}\n")).collect::<String>();
    let mut names =
        "min_x min_y min_z max_x max_y max_z min_scale_x min_scale_y min_scale_z max_scale_x max_scale_y \
                     max_scale_z"
            .to_owned();
    if color_boxes {
        names += " min_r min_g min_b max_r max_g max_b";
    }
    let packed =
        "position rotation scale color".split(' ').map(|name| format!("property uint packed_{name}\n"));
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement chunk {}\n{}element vertex {}\n{}element sh {}\n\
         property uchar f_rest_0\nend_header\n",
        points.len().div_ceil(256),
        of(&names),
        points.len(),
        packed.collect::<String>(),
        points.len(),
    );
    let (mut boxes, mut rows) = (Vec::new(), Vec::new());
    for chunk in points.chunks(256) {
        let range = |value: &dyn Fn(&Packed) -> f64| {
            chunk.iter().map(value).fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)))
        };
        let places = [0, 1, 2].map(|axis| range(&|point| point.0[axis]));
        let colors =
            [0, 1, 2].map(|channel| if color_boxes { range(&|point| point.1[channel]) } else { (0.0, 1.0) });
        let mut numbers = [places.map(|r| r.0), places.map(|r| r.1), [-9.0; 3], [0.0; 3]].concat();
        if color_boxes {
            numbers.extend([colors.map(|r| r.0), colors.map(|r| r.1)].concat());
        }
        boxes.extend(numbers.iter().flat_map(|&number| (number as f32).to_le_bytes()));
        let part = |value: f64, (low, high): (f64, f64), most: f64| {
            if high > low { ((value - low) / (high - low) * most).round() as u32 } else { 0 }
        };
        for (place, color) in chunk {
            let position = part(place[0], places[0], 2047.0) << 21
                | part(place[1], places[1], 1023.0) << 11
                | part(place[2], places[2], 2047.0);
            let shade = |channel: usize| part(color[channel], colors[channel], 255.0);
            let rgba = shade(0) << 24 | shade(1) << 16 | shade(2) << 8 | part(color[3], (0.0, 1.0), 255.0);
            rows.extend([position, 0, 0, rgba].iter().flat_map(|bits| bits.to_le_bytes()));
        }
    }
    [header.as_bytes(), &boxes, &rows, &vec![0; points.len()]].concat()
}

#[test]
fn compressed_splats_are_unpacked() {
    let point = |i: u32| {
        let part = |salt: u32| f64::from((i * 7 + salt).wrapping_mul(0x9e37_79b9) >> 8) / f64::from(1 << 24);
        let place = [10.0 * part(1) + f64::from(i / 256), 5.0 * part(2), -2.0 * part(3)];
        (place, [part(4), 0.5 * part(5), 1.0, if i % 10 == 3 { 0.05 } else { 0.9 }])
    };
    let points: Vec<_> = (0..20_000).map(point).collect();
    for color_boxes in [false, true] {
        let (file, warnings) = read_one(&compressed(&points, color_boxes));
        let visible: Vec<_> = points.iter().filter(|point| point.1[3] > 0.1).collect();
        assert_eq!(file.points.xyz.len(), visible.len());
        for (i, (place, color)) in visible.iter().enumerate() {
            let moved = file.grid.p_in_world(file.points.xyz[i]) - glam::DVec3::from_array(*place);
            // The tolerance is half a step of the packed position, in a box of at most 10 × 5 × 2.
            assert!(moved.abs().cmple(glam::DVec3::new(0.0026, 0.0026, 0.0006)).all(), "{i}: {moved}");
            for (ours, theirs) in file.points.rgb[i].iter().zip(color) {
                assert!(
                    (f64::from(*ours) / 65535.0 - theirs).abs() < 0.5 / 255.0 + 1e-4,
                    "{i}: {ours}, {theirs}"
                );
            }
        }
        assert!(warnings.len() == 1 && warnings[0].contains("has 2000 splats"), "{warnings:?}");
        assert!(file.format.contains("compressed Gaussian splat"), "{}", file.format);
    }
}

#[test]
fn a_compressed_splat_without_its_chunks_has_no_places() {
    let bytes = compressed(&[([0.0; 3], [0.5; 4]); 300], false);
    let header = parts(&bytes[..bytes.iter().position(|&byte| byte > 127).unwrap_or(bytes.len())]).0.len();
    let lost = [
        &String::from_utf8_lossy(&bytes[..header]).replace("element chunk 2", "element chunk 1").into_bytes()
            [..],
        &bytes[header + 48..],
    ]
    .concat();
    let (file, warnings) = read_one(&lost);
    assert_eq!(file.points.xyz.len(), 256);
    assert!(
        warnings.iter().any(|warning| warning.contains("44 points without a finite place")),
        "{warnings:?}"
    );
    let error =
        read_bytes(NAME, &bytes[..header + 10]).map(|scan| scan.num_points()).unwrap_err().to_string();
    assert!(error.contains("scan.ply: holds no points"), "{error}");
}
