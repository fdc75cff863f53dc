//! Tests of the hidden area: nothing visible is hidden, and what is hidden is found.

use super::*;
use proptest::prelude::*;

/// A field of view that is asymmetric, as those of headsets are.
const FOV: Fov = Fov { left: -1.2, right: 0.9, up: 1.0, down: -1.1 };
/// An image whose width is no multiple of a word.
const SIZE_PX: [u32; 2] = [45, 37];

fn is_set(words: &[u32], x: u32, y: u32) -> bool {
    words[(y * mask_words_per_row(SIZE_PX[0]) + x / 32) as usize] >> (x % 32) & 1 == 1
}

fn tangents(x: f64, y: f64) -> [f64; 2] {
    let [width, height] = SIZE_PX.map(f64::from);
    [FOV.left + x / width * (FOV.right - FOV.left), FOV.up - y / height * (FOV.up - FOV.down)]
}

/// A twentieth of a pixel, in tangents: as far as a sliver can reach.
const MARGIN: f64 = 2.5e-3;

/// How far inside the triangle a point lies, in tangents; negative: outside.
fn depth_in(corners: &[[f32; 2]; 3], [x, y]: [f64; 2]) -> f64 {
    let [a, b, c] = corners.map(|[x, y]| DVec2::new(x.into(), y.into()));
    let turn = (b - a).perp_dot(c - a).signum();
    let depth =
        |from: DVec2, to: DVec2| turn * (to - from).perp_dot(DVec2::new(x, y) - from) / (to - from).length();
    depth(a, b).min(depth(b, c)).min(depth(c, a))
}

/// Hidden pixels with a spot that no triangle hides, of 5 × 5 spots each.
fn num_wrongly_hidden(area: &HiddenArea, words: &[u32]) -> usize {
    let all = (0..SIZE_PX[1]).flat_map(|y| (0..SIZE_PX[0]).map(move |x| (x, y)));
    let visible_spot = |x: u32, y: u32| {
        (0..25).any(|i| {
            let spot =
                tangents(f64::from(x) + 0.25 * f64::from(i % 5), f64::from(y) + 0.25 * f64::from(i / 5));
            area.triangles.iter().all(|triangle| depth_in(triangle, spot) < -MARGIN)
        })
    };
    all.filter(|&(x, y)| is_set(words, x, y) && visible_spot(x, y)).count()
}

/// Pixels that one triangle covers by a margin and that are not hidden.
fn num_missed(area: &HiddenArea, words: &[u32]) -> usize {
    let all = (0..SIZE_PX[1]).flat_map(|y| (0..SIZE_PX[0]).map(move |x| (x, y)));
    let covered = |x: u32, y: u32, triangle: &[[f32; 2]; 3]| {
        [(0, 0), (1, 0), (0, 1), (1, 1)]
            .iter()
            .all(|(i, j)| depth_in(triangle, tangents(f64::from(x + i), f64::from(y + j))) > MARGIN)
    };
    let any = |x, y| area.triangles.iter().any(|triangle| covered(x, y, triangle));
    all.filter(|&(x, y)| !is_set(words, x, y) && any(x, y)).count()
}

fn rasterize(area: &HiddenArea) -> Vec<u32> {
    area.rasterize(&FOV, SIZE_PX)
}

fn corner() -> impl Strategy<Value = [f32; 2]> {
    [-1.6f32..1.6, -1.6f32..1.6]
}

proptest! {
    #[test]
    fn hidden_is_what_triangles_cover(triangles in prop::collection::vec([corner(), corner(), corner()], 0..12)) {
        let area = HiddenArea { triangles };
        let words = rasterize(&area);
        prop_assert_eq!(num_wrongly_hidden(&area, &words), 0);
        prop_assert_eq!(num_missed(&area, &words), 0);
        let beyond = words.chunks_exact(2).any(|row| row[1] >> (SIZE_PX[0] - 32) != 0);
        prop_assert!(!beyond, "bits beyond the width");
    }

    /// A surface of many triangles hides the pixels on its inner edges too, and an overlap changes nothing.
    #[test]
    fn a_fan_round_any_point_hides_everything(hub in corner(), turn in 0.0f32..1.0, num in 3usize..40) {
        let rim = |i: usize| {
            let angle = std::f32::consts::TAU * ((i % num) as f32 + turn) / num as f32;
            [hub[0] + 9.0 * angle.cos(), hub[1] + 9.0 * angle.sin()]
        };
        let mut area = HiddenArea { triangles: (0..num).map(|i| [hub, rim(i), rim(i + 1)]).collect() };
        let words = rasterize(&area);
        let num_hidden: u32 = words.iter().map(|word| word.count_ones()).sum();
        prop_assert_eq!(num_hidden, SIZE_PX[0] * SIZE_PX[1]);
        let twice = area.triangles.clone();
        area.triangles.extend(twice);
        prop_assert_eq!(rasterize(&area), words);
    }
}

#[test]
fn both_counts_can_fail() {
    let area = HiddenArea { triangles: vec![[[-1.2, 1.0], [-1.2, -1.1], [0.9, -1.1]]] };
    let words = rasterize(&area);
    assert_eq!((num_wrongly_hidden(&area, &words), num_missed(&area, &words)), (0, 0));
    let everything = vec![!0; words.len()];
    assert!(num_wrongly_hidden(&area, &everything) > 700);
    assert!(num_missed(&area, &vec![0; words.len()]) > 700);
}

/// A test of corners and center alone would hide this pixel.
#[test]
fn a_hole_between_corners_keeps_its_pixel() {
    let fov = Fov { left: -1.0, right: 1.0, up: 1.0, down: -1.0 };
    // Everything is hidden except a strip through the only pixel, between its center and its corners.
    let (below, above) = ([[-9.0, -9.0], [9.0, -9.0]], [[-9.0, 9.0], [9.0, 9.0]]);
    let band = |[a, b]: [[f32; 2]; 2], y: f32| [[a, b, [9.0, y]], [a, [9.0, y], [-9.0, y]]];
    let strip = |from, to| HiddenArea { triangles: [band(below, from), band(above, to)].concat() };
    assert_eq!(strip(0.4, 0.6).rasterize(&fov, [1, 1]), [0]);
    assert_eq!(strip(0.5, 0.5).rasterize(&fov, [1, 1]), [1]);
}

/// The runtime's corners are f32, so they may miss the image's border by a hair.
#[test]
fn rounding_leaves_no_visible_border() {
    let edge = 1.234_567_89_f64;
    let fov = Fov { left: -edge, right: edge, up: edge, down: -edge };
    let e = (edge - 1e-7) as f32;
    let area = HiddenArea { triangles: vec![[[-e, -e], [e, -e], [e, e]], [[-e, -e], [e, e], [-e, e]]] };
    assert!(f64::from(e) < edge);
    assert!(area.rasterize(&fov, [64, 2048]).iter().all(|word| *word == !0));
    // A quarter of a pixel is no rounding.
    let wider = Fov { right: edge * (1.0 + 2.0 * 0.25 / 64.0), ..fov };
    assert!(area.rasterize(&wider, [64, 64]).iter().skip(1).step_by(2).all(|word| *word == !0 >> 1));
}

#[test]
fn up_is_up_and_left_is_left() {
    let fov = Fov { left: -1.0, right: 1.0, up: 1.0, down: -1.0 };
    let top_left = HiddenArea { triangles: vec![[[-1.0, 1.0], [1.0, 1.0], [-1.0, -1.0]]] };
    assert_eq!(top_left.rasterize(&fov, [4, 4]), [0b0111, 0b0011, 0b0001, 0]);
    // These are the same corners the other way round.
    let reversed = HiddenArea { triangles: vec![[[-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]] };
    assert_eq!(reversed.rasterize(&fov, [4, 4]), [0b0111, 0b0011, 0b0001, 0]);
}

#[test]
fn nonsense_hides_nothing() {
    let mesh = HiddenArea::from_mesh(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], &[0, 1, 2, 0, 1, 3, 2, 1]);
    assert_eq!(mesh.triangles, [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]]);
    for odd in [f32::NAN, f32::INFINITY, f32::MAX] {
        let area = HiddenArea { triangles: vec![[[-9.0, -9.0], [odd, -9.0], [0.0, 9.0]]] };
        assert!(rasterize(&area).iter().all(|word| *word == 0), "{odd}");
    }
    let line = HiddenArea { triangles: vec![[[-1.0, -1.0], [0.0, 0.0], [1.0, 1.0]]] };
    assert!(rasterize(&line).iter().all(|word| *word == 0));
    let flat = Fov { left: 0.5, right: 0.5, ..FOV };
    assert!(mesh.rasterize(&flat, SIZE_PX).iter().all(|word| *word == 0));
}
