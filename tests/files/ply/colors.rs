//! Which of several colors is shown, colors in lists, opacities, and numbers as few programs write them.

use super::{read_one, text};
use crate::bytes::shown;
use points::ColorSource;

const NUM_POINTS: usize = 200;

/// A text file of points, whose values behind the place `values` writes.
fn points(properties: &str, values: impl Fn(usize) -> String) -> Vec<u8> {
    let row = |at: usize| format!("{} {} {} {}\n", at % 20, at / 20, at % 7, values(at));
    let rows: String = (0..NUM_POINTS).map(row).collect();
    text(&format!("float x, float y, float z, {properties}"), &rows)
}

/// Red, green, blue of a point, all different.
fn rgb(at: usize) -> [usize; 3] {
    [1, 5, 11].map(|step| 20 + at * step % 230)
}

const RGB: &str = "uchar red, uchar green, uchar blue";
const SHAPE: &str = "float scale_0, float scale_1, float scale_2, float rot_0";

#[test]
fn transparent_points_are_left_out_whatever_their_colors_are() {
    let shape = "-5 -5 -5 1";
    // Every fifth point is transparent. Opacity is a logit, a part of 1, of a byte, or of two bytes.
    for (kind, most, least) in [
        ("float", "4.5", "-6"),
        ("double", "0.5", "-2.5"),
        ("float", "0.97", "0.01"),
        ("float", "1", "0"),
        ("uchar", "255", "5"),
        ("ushort", "65535", "0"),
    ] {
        let opacity = |at: usize| if at % 5 == 2 { least } else { most };
        let colored = |at: usize| rgb(at).map(|c| c.to_string()).join(" ");
        let splat = points(&format!("{RGB}, {kind} opacity, {SHAPE}"), |at| {
            format!("{} {} {shape}", colored(at), opacity(at))
        });
        let plain =
            points(&format!("{kind} opacity, {RGB}"), |at| format!("{} {}", opacity(at), colored(at)));
        for (bytes, thing) in [(splat, "splats"), (plain, "points")] {
            let (file, warnings) = read_one(&bytes);
            let expected: Vec<[u8; 3]> =
                (0..NUM_POINTS).filter(|at| at % 5 != 2).map(|at| rgb(at).map(|c| c as u8)).collect();
            assert!(shown(&file) == expected, "{kind} {most} {least}: {} {thing}", file.points.xyz.len());
            let sentence = format!("has 40 {thing} nearly transparent");
            assert!(warnings.len() == 1 && warnings[0].contains(&sentence), "{warnings:?}");
            assert_eq!(file.format.contains("Gaussian splat"), thing == "splats");
        }
    }
    // An opacity that all points share says nothing; nor does alpha, which programs fill with anything.
    for (name, value) in
        [("float opacity", "1"), ("float opacity", "0"), ("float opacity", "nan"), ("uchar alpha", "0")]
    {
        let bytes = points(&format!("{name}, {RGB}"), |at| {
            format!("{value} {}", rgb(at).map(|c| c.to_string()).join(" "))
        });
        let (file, warnings) = read_one(&bytes);
        assert_eq!((file.points.xyz.len(), warnings.len()), (NUM_POINTS, 0), "{name} {value}: {warnings:?}");
    }
}

/// Properties, and how values of red, green and blue stand in them.
type ColorProperties = (&'static str, fn([usize; 3]) -> String);

/// The same colors in all the ways that a point may have them.
fn ways() -> Vec<ColorProperties> {
    fn words<T: ToString>(values: [T; 3]) -> String {
        values.map(|value| value.to_string()).join(" ")
    }
    vec![
        (RGB, words),
        ("float diffuse_red, float diffuse_green, float diffuse_blue", |rgb| {
            words(rgb.map(|c| c as f64 / 255.0))
        }),
        ("float f_dc_0, float f_dc_1, float f_dc_2", |rgb| {
            words(rgb.map(|c| (c as f64 / 255.0 - 0.5) / 0.282_094_79))
        }),
        ("uint rgb", |[r, g, b]| (r << 16 | g << 8 | b).to_string()),
        ("list uchar uchar colors", |rgb| format!("3 {}", words(rgb))),
        ("list uchar uchar rgba", |rgb| format!("4 {} 255", words(rgb))),
    ]
}

#[test]
fn of_several_colors_those_are_shown_that_points_have() {
    let expected: Vec<[u8; 3]> = (0..NUM_POINTS).map(|at| rgb(at).map(|c| c as u8)).collect();
    for (with, write) in ways() {
        let (file, warnings) = read_one(&points(with, |at| write(rgb(at))));
        assert!(shown(&file) == expected && warnings.is_empty(), "{with}: {warnings:?}");
        for (without, write_black) in ways() {
            if with == without || [with, without].iter().all(|way| way.starts_with("list")) {
                continue;
            }
            // All points are black, or gray, or most are black.
            for (gray, step) in [(0, usize::MAX), (128, usize::MAX), (0, 9)] {
                let other = |at: usize| if at % step == 1 { rgb(at) } else { [gray; 3] };
                for is_first in [true, false] {
                    let properties = if is_first { [without, with] } else { [with, without] };
                    let bytes = points(&properties.join(", "), |at| {
                        let values = [write_black(other(at)), write(rgb(at))];
                        if is_first { values.join(" ") } else { format!("{} {}", values[1], values[0]) }
                    });
                    let (file, warnings) = read_one(&bytes);
                    assert!(
                        shown(&file) == expected,
                        "{with} beside {without} of {gray}, {step}: {warnings:?}"
                    );
                }
            }
        }
    }
    // Of two kinds of color that all points have, the one with the first of the usual names is shown, as ever.
    let both = points(&format!("float f_dc_0, float f_dc_1, float f_dc_2, {RGB}"), |at| {
        format!("1 {} 0 {}", at % 3, rgb(at).map(|c| c.to_string()).join(" "))
    });
    let (file, warnings) = read_one(&both);
    assert!(shown(&file) == expected && warnings.is_empty(), "{warnings:?}");
}

/// A mesh of triangles side by side, in either byte order or as text; each triangle has a list of `colors`, as bytes
/// or floats.
fn mesh(format: &str, kind: &str, colors: &[Vec<f32>]) -> Vec<u8> {
    let num = colors.len();
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {num}\nproperty list uchar uchar quality\nproperty list uchar {kind} rgb\n\
         property list uchar int vertex_indices\nproperty uchar flags\nend_header\n",
        3 * num
    )
    .into_bytes();
    let mut put = |value: f64, kind: &str| match (format, kind) {
        ("ascii", _) => bytes.extend(format!("{value} ").bytes()),
        (_, "uchar") => bytes.push(value as u8),
        ("binary_big_endian", "float") => bytes.extend((value as f32).to_be_bytes()),
        ("binary_big_endian", _) => bytes.extend((value as i32).to_be_bytes()),
        (_, "float") => bytes.extend((value as f32).to_le_bytes()),
        _ => bytes.extend((value as i32).to_le_bytes()),
    };
    for at in 0..3 * num {
        [at, at % 3, at % 2].into_iter().for_each(|c| put(c as f64, "float"));
    }
    for (at, color) in colors.iter().enumerate() {
        [1.0, 7.0, color.len() as f64].into_iter().for_each(|value| put(value, "uchar"));
        color.iter().for_each(|&c| put(f64::from(c), kind));
        put(3.0, "uchar");
        (3 * at..3 * at + 3).for_each(|corner| put(corner as f64, "int"));
        put(9.0, "uchar");
    }
    bytes
}

#[test]
fn lists_of_colors_on_faces_are_used() {
    let num = 60;
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for kind in ["uchar", "float"] {
            let white = if kind == "float" { 255.0 } else { 1.0 };
            for len in [3, 4, 9, 2, 0] {
                // Every tenth face has a list of another length.
                let color = |at: usize| {
                    let len = if at % 10 == 4 { 5 } else { len };
                    rgb(at).iter().cycle().take(len).map(|&c| c as f32 / white).collect()
                };
                let colors: Vec<Vec<f32>> = (0..num).map(color).collect();
                let (file, warnings) = read_one(&mesh(format, kind, &colors));
                let case = format!("{format} {kind} {len}: {warnings:?}");
                assert_eq!(file.triangles.len(), num, "{case}");
                let is_read = len == 3 || len == 4;
                let num_odd = if is_read { num / 10 } else { num };
                let sentence =
                    format!("has {num_odd} faces with a list of colors of other than 3 or 4 values");
                assert!(warnings.iter().any(|warning| warning.contains(&sentence)), "{case}");
                assert_eq!(matches!(file.coloring.source, ColorSource::Height { .. }), !is_read, "{case}");
                for (at, bytes) in
                    shown(&file).into_iter().enumerate().filter(|(at, _)| is_read && at / 3 % 10 != 4)
                {
                    assert_eq!(bytes, rgb(at / 3).map(|c| c as u8), "{case}");
                }
            }
        }
    }
}

#[test]
fn exponents_and_semicolons_of_other_hands_are_read() {
    let place = |at: usize| [at as f64 * 0.5, -2.25 * (at % 9) as f64, 1e-3 * at as f64];
    let plain = |separator: &str, end: &str| {
        let row = |at: usize| place(at).map(|c| c.to_string()).join(separator) + end;
        (0..NUM_POINTS).map(row).collect::<String>()
    };
    let fortran = |letter: &str| {
        let word = |c: f64| {
            let text = format!("{c:.15e}");
            let (digits, exponent) = text.split_once('e').unwrap();
            format!("{digits}{letter}{:+03}", exponent.parse::<i32>().unwrap())
        };
        (0..NUM_POINTS).map(|at| place(at).map(word).join("  ") + "\n").collect::<String>()
    };
    let bodies = [
        plain(" ", "\n"),
        plain(" ", ";\n"),
        plain(" ", " ;\n"),
        plain(" ", "; "),
        plain(";", "\n"),
        plain(";", ";\n"),
        plain(" ; ", "\r\n"),
        plain("; ", ";"),
        plain(";", ";"),
        plain(", ", "; "),
        fortran("D"),
        fortran("d"),
        fortran("E"),
        fortran("Q"),
        fortran("D").replace('\n', ";\n"),
    ];
    for body in bodies {
        let bytes = text("double x, double y, double z", &body);
        let header = String::from_utf8_lossy(&bytes).replace(
            &format!("element vertex {}\n", body.lines().count()),
            &format!("element vertex {NUM_POINTS}\n"),
        );
        let (file, warnings) = read_one(header.as_bytes());
        let start: String = body.chars().take(40).collect();
        assert!(warnings.is_empty() && file.points.xyz.len() == NUM_POINTS, "{start:?}: {warnings:?}");
        for (at, &xyz) in file.points.xyz.iter().enumerate() {
            let moved = file.grid.p_in_world(xyz) - glam::DVec3::from_array(place(at));
            assert!(moved.abs().max_element() < 1e-6, "{start:?}: {at} moved by {moved}");
        }
    }
}
