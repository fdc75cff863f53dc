//! What files are colored by, from the file to the bytes that are drawn: bits by distribution, one color everywhere, few
//! colored points. Files are made up as text.

mod scan_fixture;

use scan_fixture::save;
use scanwalk::progress::Stop;
use scanwalk::scan::{ColorSource, ReadOptions, Scan, read};

const NUM_POINTS: usize = 2000;

/// A PLY of points with 16-bit colors and an intensity.
fn scan(color: impl Fn(usize) -> [u16; 3]) -> Scan {
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {NUM_POINTS}\n");
    text +=
        "property float x\nproperty float y\nproperty float z\nproperty ushort red\nproperty ushort green\n";
    text += "property ushort blue\nproperty ushort intensity\nend_header\n";
    for at in 0..NUM_POINTS {
        let [r, g, b] = color(at);
        text += &format!("{} {} {} {r} {g} {b} {}\n", at % 50, at / 50, at % 7, at % 1000);
    }
    let (_folder, path) = save("a.ply", text.as_bytes());
    read(&[path], &ReadOptions::default(), &Stop::default()).unwrap()
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
fn one_color_everywhere_gives_way_to_intensity() {
    for color in [[65535; 3], [1; 3], [0; 3], [200, 10, 10]] {
        let scan = scan(|_| color);
        let file = &scan.files[0];
        assert!(matches!(file.color, ColorSource::Intensity { .. }), "{color:?}: {:?}", file.color);
        assert_eq!((file.one_color, scan.warnings.len()), (Some(color), usize::from(color != [0; 3])));
    }
    assert_eq!(scan(|at| [1, 1, u16::from(at == 5)]).files[0].color, ColorSource::Rgb8);
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
