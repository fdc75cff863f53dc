//! What files are colored by, from the file to the bytes that are drawn: bits by distribution, one color everywhere, few
//! colored points. Files are made up as text.

mod scan_fixture;

use scan_fixture::save;
use scanwalk::progress::Stop;
use scanwalk::scan::{ColorSource, ReadOptions, Scan, read};
use std::path::{Path, PathBuf};

const NUM_POINTS: usize = 2000;

/// A PLY of points with 16-bit colors and an intensity.
fn file(color: impl Fn(usize) -> [u16; 3]) -> (tempfile::TempDir, PathBuf) {
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {NUM_POINTS}\n");
    text +=
        "property float x\nproperty float y\nproperty float z\nproperty ushort red\nproperty ushort green\n";
    text += "property ushort blue\nproperty ushort intensity\nend_header\n";
    for at in 0..NUM_POINTS {
        let [r, g, b] = color(at);
        text += &format!("{} {} {} {r} {g} {b} {}\n", at % 50, at / 50, at % 7, at % 1000);
    }
    save("a.ply", text.as_bytes())
}

fn read_one(path: &Path) -> Scan {
    read(&[path.to_owned()], &ReadOptions::default(), &Stop::default()).unwrap()
}

fn scan(color: impl Fn(usize) -> [u16; 3]) -> Scan {
    let (_folder, path) = file(color);
    read_one(&path)
}

/// Channels of a scene from 0 to 1, of which some are cut off at 1.
fn channels(at: usize) -> [f64; 3] {
    [0, 1, 2].map(|c| (((3 * at + c + 1).wrapping_mul(40_503) % 65_536) as f64 / 60_000.0).min(1.0))
}

/// The bytes that are drawn.
fn shown(scan: &Scan) -> Vec<[u8; 3]> {
    let file = &scan.files[0];
    let bytes = (0..file.points.xyz.len()).map(|at| file.color(at).to_le_bytes());
    bytes.map(|[r, g, b, _]| [r, g, b]).collect()
}

#[test]
fn a_scene_looks_the_same_in_whatever_bits_it_is_stored() {
    let stored = |white: f64| scan(move |at| channels(at).map(|c| (c * white).round() as u16));
    let sixteen = shown(&stored(65535.0));
    for (white, source) in
        [(255.0, ColorSource::Rgb8), (1023.0, ColorSource::Rgb10), (4095.0, ColorSource::Rgb12)]
    {
        let scan = stored(white);
        assert_eq!(scan.files[0].color, source);
        assert!(scan.warnings.is_empty(), "{:?}", scan.warnings);
        let differs = |(a, b): (&[u8; 3], &[u8; 3])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 1);
        assert!(!shown(&scan).iter().zip(&sixteen).any(differs), "{source:?}");
    }
    // What is honest stays exact.
    let expected: Vec<[u8; 3]> = (0..NUM_POINTS)
        .map(|at| channels(at).map(|c| ((c * 65535.0).round() / 257.0).round() as u8))
        .collect();
    assert!(sixteen == expected);
}

#[test]
fn a_single_wrong_value_darkens_nothing() {
    let scan = scan(|at| if at == 77 { [256; 3] } else { channels(at).map(|c| (c * 255.0).round() as u16) });
    assert_eq!(scan.files[0].color, ColorSource::Rgb8);
    assert_eq!(shown(&scan)[77], [255; 3]);
    assert!(shown(&scan).iter().flatten().filter(|&&c| c == 255).count() > 100);
}

#[test]
fn merged_files_are_drawn_each_point_by_its_own_and_that_is_said() {
    let white = |at: usize| if at < 1000 { 255.0 } else { 65535.0 };
    let scan = scan(|at| channels(at).map(|c| (c * white(at)).round() as u16));
    assert_eq!(scan.files[0].color, ColorSource::Rgb8And16);
    assert!(scan.warnings[0].contains("8 bits at some points and of 16 at others"), "{:?}", scan.warnings);
    for (at, bytes) in shown(&scan).iter().enumerate() {
        let expected = channels(at).map(|c| (c * 255.0).round() as u8);
        assert!(bytes.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1), "{at}: {bytes:?} {expected:?}");
    }
}

#[test]
fn tiles_of_8_bits_among_those_of_more_are_as_bright() {
    let dim = |at: usize| channels(at).map(|c| c * c);
    for (white, bits) in [(1023.0, 10), (4095.0, 12)] {
        for tile in [0..600, 700..1500, 1300..NUM_POINTS] {
            let stored = |at: usize| if tile.contains(&at) { 255.0 } else { white };
            let merged = scan(|at| dim(at).map(|c| (c * stored(at)).round() as u16));
            let sentence = format!("8 bits at some points and of {bits} at others");
            assert!(merged.warnings[0].contains(&sentence), "{white} {tile:?}: {:?}", merged.warnings);
            let right = |at: usize| dim(at).map(|c| (c * 255.0).round() as u8);
            let off = |(at, bytes): &(usize, &[u8; 3])| {
                bytes.iter().zip(right(*at)).any(|(a, b)| a.abs_diff(b) > 1)
            };
            let num_off = shown(&merged).iter().enumerate().filter(off).count();
            assert!(num_off < 10, "{white} {tile:?}: {num_off} of {NUM_POINTS}");
        }
    }
}

/// What `info` prints of a scan's colors.
fn said(path: &Path) -> String {
    let output =
        std::process::Command::new(env!("CARGO_BIN_EXE_scanwalk")).arg("info").arg(path).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().find(|line| line.starts_with("colour")).unwrap().to_owned()
}

#[test]
fn one_color_everywhere_gives_way_to_intensity() {
    for color in [[65535; 3], [1; 3], [0; 3], [200, 10, 10]] {
        let scan = scan(|_| color);
        let file = &scan.files[0];
        assert!(matches!(file.color, ColorSource::Intensity { .. }), "{color:?}: {:?}", file.color);
        let blank = file.blank.unwrap();
        assert_eq!((blank.color, blank.num_others), (color, 0));
        assert_eq!(scan.warnings.len(), usize::from(color != [0; 3]));
    }
}

#[test]
fn one_color_everywhere_but_at_a_few_points_gives_way_to_greys_by_intensity() {
    for (color, other) in [
        ([65535; 3], [65535, 65535, 65534]),
        ([65535; 3], [200, 10, 10]),
        ([65535; 3], [65535, 0, 0]),
        ([255; 3], [255, 255, 254]),
        ([1; 3], [1, 1, 0]),
        ([1; 3], [65535, 0, 9]),
        ([200, 10, 10], [0; 3]),
    ] {
        for num_others in [1, 3, 4] {
            let (folder, path) = file(|at| if at % 500 < 1 && at / 500 < num_others { other } else { color });
            let (scan, info) = (read_one(&path), said(&path));
            drop(folder);
            let what = format!("{num_others} {other:?} among {color:?}: {info}");
            let bytes = shown(&scan);
            let greys: Vec<[u8; 3]> = (0..NUM_POINTS).filter(|at| at % 500 > 0).map(|at| bytes[at]).collect();
            assert!(greys.iter().all(|[r, g, b]| r == g && g == b && (64..=191).contains(r)), "{what}");
            // As intensity rises.
            assert!(greys[1..400].is_sorted() && greys[1] < greys[400], "{what}");
            assert!(
                scan.warnings[0].contains(&format!("a color at only {num_others} of 2,000 points")),
                "{what}"
            );
            assert!(info.contains("shown by intensity, in greys"), "{what}");
            if other[0] > 9 {
                assert!(bytes[0][0] >= 200, "{what}: the few keep their color, {:?}", bytes[0]);
            }
        }
        // More are no accident.
        let some = scan(|at| if at % 100 < 1 { other } else { color });
        assert_eq!(some.files[0].blank, None, "{color:?} {other:?}");
    }
}

#[test]
fn an_overexposed_scene_keeps_its_colors() {
    // Snow: all white but for one point in fifty.
    for white in [255.0, 4095.0, 65535.0] {
        let snow = |at: usize| if at % 50 == 7 { channels(at) } else { [1.0; 3] };
        let scan = scan(|at| snow(at).map(|c| (c * white).round() as u16));
        let expected = snow(57).map(|c| (c * 255.0).round() as u8);
        assert!(shown(&scan)[57].iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1), "{white}");
        assert_eq!((shown(&scan)[0], scan.warnings.len()), ([255; 3], 0), "{white}");
    }
}

#[test]
fn points_without_a_color_among_a_few_that_have_one_are_seen() {
    let scan = scan(|at| if at % 500 == 3 { [65535, 300, 0] } else { [0; 3] });
    assert!(scan.warnings[0].contains("a color at only 4 of 2,000 points"), "{:?}", scan.warnings);
    let bytes = shown(&scan);
    assert_eq!(bytes[3], [255, 1, 0]);
    let greys: Vec<u8> = bytes.iter().filter(|[r, g, b]| r == g && g == b).map(|rgb| rgb[0]).collect();
    assert_eq!(greys.len(), NUM_POINTS - 4);
    let (darkest, brightest) = (greys.iter().min(), greys.iter().max());
    assert_eq!((darkest, brightest), (Some(&64), Some(&191)), "before black and before white");
}
