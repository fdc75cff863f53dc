//! What files are colored by, from the file to the bytes that are drawn: bits by distribution, one color everywhere, few
//! colored points, points without a color. Files are made up as text.

use crate::PROGRAM;
use crate::bytes::shown;
use kit::las_files::save;
use kit::program;
use kit::reading;
use points::{ColorSource, Scan};
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

/// Reads a scan. Whatever is decided about colors, their column stays as it is stored, or is missing.
fn scan(color: impl Fn(usize) -> [u16; 3]) -> Scan {
    let (_folder, path) = file(&color);
    let scan = reading::file(&path).unwrap();
    let rgb = &scan.files[0].points.rgb;
    assert!(rgb.is_empty() || rgb.iter().enumerate().all(|(at, rgb)| *rgb == color(at)));
    scan
}

/// Channels of a scene from 0 to 1, of which some are cut off at 1.
fn channels(at: usize) -> [f64; 3] {
    [0, 1, 2].map(|c| (((3 * at + c + 1).wrapping_mul(40_503) % 65_536) as f64 / 60_000.0).min(1.0))
}

#[test]
fn a_scene_looks_the_same_in_whatever_bits_it_is_stored() {
    let stored = |white: f64| scan(move |at| channels(at).map(|c| (c * white).round() as u16));
    let sixteen = shown(&stored(65535.0).files[0]);
    for (white, source) in
        [(255.0, ColorSource::Rgb8), (1023.0, ColorSource::Rgb10), (4095.0, ColorSource::Rgb12)]
    {
        let scan = stored(white);
        assert_eq!(scan.files[0].coloring.source, source);
        assert!(scan.warnings.is_empty(), "{:?}", scan.warnings);
        let differs = |(a, b): (&[u8; 3], &[u8; 3])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 1);
        assert!(!shown(&scan.files[0]).iter().zip(&sixteen).any(differs), "{source:?}");
    }
    // Colors of 16 bits stay exact.
    let expected: Vec<[u8; 3]> = (0..NUM_POINTS)
        .map(|at| channels(at).map(|c| ((c * 65535.0).round() / 257.0).round() as u8))
        .collect();
    assert!(sixteen == expected);
}

#[test]
fn a_single_wrong_value_darkens_nothing() {
    let scan = scan(|at| if at == 77 { [256; 3] } else { channels(at).map(|c| (c * 255.0).round() as u16) });
    assert_eq!(scan.files[0].coloring.source, ColorSource::Rgb8);
    assert_eq!(shown(&scan.files[0])[77], [255; 3]);
    assert!(shown(&scan.files[0]).iter().flatten().filter(|&&c| c == 255).count() > 100);
}

#[test]
fn merged_files_are_drawn_each_point_by_its_own_and_that_is_said() {
    let white = |at: usize| if at < 1000 { 255.0 } else { 65535.0 };
    let scan = scan(|at| channels(at).map(|c| (c * white(at)).round() as u16));
    assert_eq!(scan.files[0].coloring.source, ColorSource::Rgb16);
    assert!(scan.warnings[0].contains("8 bits at some points and of 16 at others"), "{:?}", scan.warnings);
    for (at, bytes) in shown(&scan.files[0]).iter().enumerate() {
        let expected = channels(at).map(|c| (c * 255.0).round() as u8);
        assert!(bytes.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1), "{at}: {bytes:?} {expected:?}");
    }
}

/// Number of points that are not drawn as `right` says.
fn num_off(scan: &Scan, right: impl Fn(usize) -> [f64; 3]) -> usize {
    let is_off = |(at, bytes): &(usize, [u8; 3])| {
        let right = right(*at).map(|c| (c * 255.0).round() as u8);
        bytes.iter().zip(right).any(|(a, b)| a.abs_diff(b) > 1)
    };
    shown(&scan.files[0]).into_iter().enumerate().filter(is_off).count()
}

fn bits_said(scan: &Scan, low: f64, high: f64) -> bool {
    let bits = |white: f64| (white + 1.0).log2() as u32;
    let sentence = format!("{} bits at some points and of {} at others", bits(low), bits(high));
    scan.warnings.iter().any(|warning| warning.contains(&sentence))
}

const WHITES: [f64; 4] = [255.0, 1023.0, 4095.0, 65535.0];

#[test]
fn tiles_of_fewer_bits_among_those_of_more_are_as_bright() {
    let dim = |at: usize| channels(at).map(|c| c * c);
    for (low, high) in WHITES.into_iter().flat_map(|low| WHITES.map(|high| (low, high))) {
        for tile in [0..600, 700..1500, 1300..NUM_POINTS] {
            if low >= high {
                continue;
            }
            let stored = |at: usize| if tile.contains(&at) { low } else { high };
            let merged = scan(|at| dim(at).map(|c| (c * stored(at)).round() as u16));
            assert!(bits_said(&merged, low, high), "{low} {high} {tile:?}: {:?}", merged.warnings);
            let num_off = num_off(&merged, dim);
            assert!(num_off < 10, "{low} {high} {tile:?}: {num_off} of {NUM_POINTS}");
        }
    }
}

#[test]
fn tiles_of_three_kinds_are_as_bright() {
    let dim = |at: usize| channels(at).map(|c| c * c);
    let stored = |at: usize| WHITES[[0, 2, 3][(at * 3 / NUM_POINTS).min(2)]];
    let merged = scan(|at| dim(at).map(|c| (c * stored(at)).round() as u16));
    assert!(
        bits_said(&merged, 255.0, 65535.0) && bits_said(&merged, 4095.0, 65535.0),
        "{:?}",
        merged.warnings
    );
    assert!(num_off(&merged, dim) < 20, "{}", num_off(&merged, dim));
}

#[test]
fn of_points_of_two_kinds_among_each_other_a_warning_says_so() {
    for (low, high) in WHITES.into_iter().flat_map(|low| WHITES.map(|high| (low, high))) {
        for step in [2, 3] {
            if low >= high {
                continue;
            }
            let stored = |at: usize| if at.is_multiple_of(step) { low } else { high };
            let mixed = scan(|at| channels(at).map(|c| (c * stored(at)).round() as u16));
            assert!(bits_said(&mixed, low, high), "{low} {high} {step}: {:?}", mixed.warnings);
            // No point of this scene is dark, so every point's bits are known.
            assert_eq!(num_off(&mixed, channels), 0, "{low} {high} {step}");
        }
    }
    // Nothing is guessed where dark points of 10 bits may as well be bright ones of 8.
    let gray = |at: usize| [((at * 40_503 % 65_536) as f64 / 64_000.0).min(1.0); 3];
    let stored = |at: usize| if at.is_multiple_of(2) { 255.0 } else { 1023.0 };
    let mixed = scan(|at| gray(at).map(|c| (c * stored(at)).round() as u16));
    assert_eq!(mixed.files[0].coloring.source, ColorSource::Rgb10);
    assert!(bits_said(&mixed, 255.0, 1023.0) && mixed.warnings[0].contains("cannot be told"));
    assert!((900..1100).contains(&num_off(&mixed, gray)), "{}", num_off(&mixed, gray));
}

#[test]
fn wild_values_leave_the_others_as_bright_as_they_are() {
    for white in &WHITES[..3] {
        for step in [1000, 100, 50] {
            let wild = |at: usize| [0, 1, 2].map(|c| ((3 * at + c + 7) * 27_644 % 65_536) as u16);
            let is_wild = |at: usize| at % step == 9;
            let scan = scan(|at| {
                if is_wild(at) { wild(at) } else { channels(at).map(|c| (0.97 * c * white).round() as u16) }
            });
            let num_off = num_off(&scan, |at| channels(at).map(|c| 0.97 * c));
            assert!(num_off <= NUM_POINTS / step, "{white} {step}: {num_off}");
            assert_eq!(bits_said(&scan, *white, 65535.0), step < 1000, "{white} {step}: {:?}", scan.warnings);
        }
    }
}

/// What `info` prints of a scan's colors.
fn said(path: &Path) -> String {
    let output = program::run(program::command(PROGRAM).arg("info").arg(path));
    output.text().lines().find(|line| line.starts_with("color")).unwrap().to_owned()
}

#[test]
fn one_color_everywhere_gives_way_to_intensity() {
    for color in [[65535; 3], [1; 3], [0; 3], [200, 10, 10]] {
        let scan = scan(|_| color);
        let file = &scan.files[0];
        assert!(
            matches!(file.coloring.source, ColorSource::Intensity { .. }),
            "{color:?}: {:?}",
            file.coloring.source
        );
        let blank = file.coloring.blank.unwrap();
        assert_eq!((blank.color, blank.num_others), (color, 0));
        assert_eq!(scan.warnings.len(), usize::from(color != [0; 3]));
    }
}

#[test]
fn one_color_everywhere_but_at_a_few_points_gives_way_to_grays_by_intensity() {
    for (color, other) in [
        ([65535; 3], [200, 10, 10]),
        ([65535; 3], [65535, 0, 0]),
        ([1; 3], [65535, 0, 9]),
        ([200, 10, 10], [0; 3]),
    ] {
        for num_others in [1, 3, 4] {
            let (folder, path) = file(|at| if at % 500 < 1 && at / 500 < num_others { other } else { color });
            let (scan, info) = (reading::file(&path).unwrap(), said(&path));
            drop(folder);
            let what = format!("{num_others} {other:?} among {color:?}: {info}");
            let bytes = shown(&scan.files[0]);
            let grays: Vec<[u8; 3]> = (0..NUM_POINTS).filter(|at| at % 500 > 0).map(|at| bytes[at]).collect();
            assert!(grays.iter().all(|[r, g, b]| r == g && g == b && (64..=191).contains(r)), "{what}");
            // Grays rise with the intensity.
            assert!(grays[1..400].is_sorted() && grays[1] < grays[400], "{what}");
            assert!(
                scan.warnings[0].contains(&format!("a color at only {num_others} of 2,000 points")),
                "{what}"
            );
            assert!(info.contains("shown by intensity, in grays"), "{what}");
            if other[0] > 9 {
                assert!(bytes[0][0] >= 200, "{what}: the few keep their color, {:?}", bytes[0]);
            }
        }
        // More points of the other color are no accident.
        let some = scan(|at| if at % 100 < 1 { other } else { color });
        assert_eq!(some.files[0].coloring.blank, None, "{color:?} {other:?}");
    }
}

#[test]
fn an_overexposed_scene_keeps_its_colors() {
    // A snow scene is white everywhere except for one point in fifty.
    for white in [255.0, 4095.0, 65535.0] {
        let snow = |at: usize| if at % 50 == 7 { channels(at) } else { [1.0; 3] };
        let scan = scan(|at| snow(at).map(|c| (c * white).round() as u16));
        let expected = snow(57).map(|c| (c * 255.0).round() as u8);
        assert!(shown(&scan.files[0])[57].iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1), "{white}");
        assert_eq!((shown(&scan.files[0])[0], scan.warnings.len()), ([255; 3], 0), "{white}");
    }
}

#[test]
fn points_without_a_color_among_a_few_that_have_one_are_seen() {
    let scan = scan(|at| if at % 500 == 3 { [65535, 300, 0] } else { [0; 3] });
    assert!(scan.warnings[0].contains("a color at only 4 of 2,000 points"), "{:?}", scan.warnings);
    let bytes = shown(&scan.files[0]);
    assert_eq!(bytes[3], [255, 1, 0]);
    let grays: Vec<u8> = bytes.iter().filter(|[r, g, b]| r == g && g == b).map(|rgb| rgb[0]).collect();
    assert_eq!(grays.len(), NUM_POINTS - 4);
    let (darkest, brightest) = (grays.iter().min(), grays.iter().max());
    assert_eq!((darkest, brightest), (Some(&64), Some(&191)), "before black and before white");
}

#[test]
fn colors_that_nobody_can_tell_apart_give_way_to_intensity() {
    for (a, b) in [
        ([0; 3], [1; 3]),
        ([1; 3], [1, 1, 0]),
        ([254; 3], [255; 3]),
        ([65280; 3], [65535; 3]),
        ([65535; 3], [65535, 65535, 65534]),
        ([200, 10, 10], [201, 11, 9]),
    ] {
        for step in [2, 7, 2000] {
            let (folder, path) = file(|at| if at % step == 1 { a } else { b });
            let (scan, info) = (reading::file(&path).unwrap(), said(&path));
            drop(folder);
            assert!(
                matches!(scan.files[0].coloring.source, ColorSource::Intensity { .. }),
                "{a:?} {b:?}: {info}"
            );
            assert!(info.contains("none (all points are nearly ") && info.contains("intensity"), "{info}");
            let sentence = "has nearly the same color at all points";
            assert!(scan.warnings.len() == 1 && scan.warnings[0].contains(sentence), "{:?}", scan.warnings);
        }
    }
}

#[test]
fn black_points_beside_colored_ones_are_seen_and_those_of_a_dark_scene_stay() {
    for white in [255.0, 4095.0, 65535.0] {
        for (percent, only) in [(15, ""), (30, ""), (50, ""), (70, "only ")] {
            let has_color = |at: usize| at * 37 % 100 >= percent;
            let color = |at: usize| channels(at).map(|c| (c * white).round() as u16);
            let (folder, path) = file(|at| if has_color(at) { color(at) } else { [0; 3] });
            let (scan, info) = (reading::file(&path).unwrap(), said(&path));
            drop(folder);
            let num = NUM_POINTS / 100 * (100 - percent);
            let sentence = format!("a color at {only}{num} of 2,000 points").replace("1700", "1,700");
            let sentence = sentence.replace("1400", "1,400").replace("1000", "1,000");
            assert!(scan.warnings.iter().any(|w| w.contains(&sentence)), "{sentence}: {:?}", scan.warnings);
            assert!(info.contains("which are black and shown by intensity, in grays"), "{info}");
            for (at, bytes) in shown(&scan.files[0]).into_iter().enumerate() {
                let expected = channels(at).map(|c| (c * 255.0).round() as u8);
                let is_right = if has_color(at) {
                    bytes.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1)
                } else {
                    bytes.iter().all(|c| *c == bytes[0] && (64..=191).contains(c))
                };
                assert!(is_right, "{white} {percent} {at}: {bytes:?}");
            }
        }
        // A night scene in 8 bits has a seventh of its points black, and more nearly so.
        let light = |at: usize| 0.1 * ((at * 27_644 % 65_536) as f64 / 65_536.0).powi(2);
        let scan = scan(|at| channels(at).map(|c| (c * light(at) * white).round() as u16));
        assert_eq!(
            (scan.files[0].coloring.blank, scan.warnings.len()),
            (None, 0),
            "{white}: {:?}",
            scan.warnings
        );
    }
}

#[test]
fn colors_that_are_nearly_black_are_said_to_be_and_stay() {
    for white in [255.0, 1023.0, 4095.0, 65535.0] {
        for (percent, is_said) in [(99, true), (95, true), (91, true), (85, false), (50, false)] {
            // If bright points are this few among dark ones of 16 bits, they count as wild values among points of 10
            // bits.
            if white > 60_000.0 && percent > 94 {
                continue;
            }
            // Dark colors have up to 3 of 255 levels.
            let dark = |at: usize| channels(at).map(|c| c * 2.9 / 255.0);
            let color = |at: usize| if at * 37 % 100 < percent { dark(at) } else { channels(at) };
            let scan = scan(|at| color(at).map(|c| (c * white).round() as u16));
            let said =
                scan.warnings.iter().any(|w| w.contains("nearly black") && w.contains("frame.background"));
            assert_eq!(said, is_said, "{white} {percent}: {:?}", scan.warnings);
            assert_eq!(num_off(&scan, color), 0, "{white} {percent}");
        }
    }
}

#[test]
fn tiles_of_8_bit_intensities_are_as_bright_as_those_of_16() {
    let folder = tempfile::tempdir().unwrap();
    let tile = |name: &str, white: f64| {
        let mut text = format!("ply\nformat ascii 1.0\nelement vertex {NUM_POINTS}\nproperty float x\n");
        text += "property float y\nproperty float z\nproperty ushort intensity\nend_header\n";
        for at in 0..NUM_POINTS {
            let value = (channels(at)[0] * white).round();
            text += &format!("{} {} {} {value}\n", at % 50, at / 50, at % 7);
        }
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let both = |white: f64| {
        let paths = [tile("a.ply", 65535.0), tile("b.ply", white)];
        reading::files(&paths).unwrap()
    };
    let brightest = |scan: &Scan, file: usize| {
        let greens = (0..NUM_POINTS).map(|at| scan.files[file].color(at).to_le_bytes()[1]);
        greens.max().unwrap()
    };
    let scan = both(255.0);
    assert!(brightest(&scan, 0).abs_diff(brightest(&scan, 1)) <= 2);
    let said = "b.ply: has intensities of 8 bits, other files of 16";
    assert!(scan.warnings.iter().any(|warning| warning.contains(said)), "{:?}", scan.warnings);
    // A file that is only dim stays dim.
    let scan = both(2000.0);
    assert!(brightest(&scan, 1) < 60 && brightest(&scan, 0) > 200 && scan.warnings.is_empty());
}
