//! A picture's border looks like its middle: any part of a picture, drawn alone, is that part of the larger picture, bit
//! for bit. Points whose middle lies outside reach in, and dilation takes what lies beyond the edge.

use base::space::{Eye, Fov, Pose, View};
use cloud::octree::Octree;
use glam::DVec3;
use kit::frames::{
    Canvas, Drawn, SAMPLE_DETAIL, SplitMix, gpu, num_differing, octree_of, sample_options, scan_of, sizes,
    tiers,
};
use lab::reference::dilate::dilate;
use render::gpu::Atomics;
use render::layout::{Detail, GUARD_PX, Pixel, ViewUniform};
use render::options::{Dilate, Quality};
use render::{DrawOptions, RINGS_REACH_PX};

/// Pixels per unit of tangent: a power of two, so that an edge's tangent is exact.
const PX_PER_TANGENT: f64 = 64.0;
/// The larger picture's left and upper edge, in pixels from the optical axis.
const FIRST: [i32; 2] = [-91, -70];
/// The larger picture's size in pixels.
const SIZE: [u32; 2] = [177, 150];

/// A part of a picture: its first pixel and its size.
#[derive(Clone, Copy, Debug)]
struct PicturePart {
    first: [u32; 2],
    size: [u32; 2],
}

/// Parts at each border, in each corner, in the middle, and some smaller than what reaches into them.
const PARTS: [PicturePart; 11] = [
    PicturePart { first: [0, 40], size: [60, 50] },
    PicturePart { first: [117, 40], size: [60, 50] },
    PicturePart { first: [50, 0], size: [70, 41] },
    PicturePart { first: [50, 109], size: [70, 41] },
    PicturePart { first: [0, 0], size: [64, 48] },
    PicturePart { first: [113, 0], size: [64, 48] },
    PicturePart { first: [0, 102], size: [64, 48] },
    PicturePart { first: [113, 102], size: [64, 48] },
    PicturePart { first: [53, 47], size: [33, 31] },
    PicturePart { first: [90, 75], size: [5, 3] },
    PicturePart { first: [140, 20], size: [1, 1] },
];

/// Both eyes of the larger picture, or of a part of it.
fn view(part: Option<PicturePart>) -> View {
    let PicturePart { first, size } = part.unwrap_or(PicturePart { first: [0, 0], size: SIZE });
    let tangent = |axis: usize, px: u32| f64::from(FIRST[axis] + px as i32) / PX_PER_TANGENT;
    let fov = Fov {
        left: tangent(0, first[0]),
        right: tangent(0, first[0] + size[0]),
        up: -tangent(1, first[1]),
        down: -tangent(1, first[1] + size[1]),
    };
    let eye = |x: f64| Eye {
        world_from_view: Pose::look_at(DVec3::new(x, 0.0, 0.0), DVec3::new(x + 0.1, 3.0, 0.1), DVec3::Z),
        fov,
        size_px: size,
        gaze_in_view: DVec3::new(0.2, 0.1, -1.0).normalize(),
    };
    View { eyes: vec![eye(-0.03), eye(0.03)], near: 0.05 }
}

/// The inside of a box round the eyes, thin enough that points are drawn larger, and single points nearer.
fn room() -> Octree {
    let mut random = SplitMix(11);
    let mut at = |half: f64| (2000.0 * half * (random.unit() - 0.5)) as i32;
    let mut xyz = Vec::new();
    for i in 0..60_000 {
        let mut p = [at(2.0), at(2.0), at(2.0)];
        p[i % 3] = if i % 2 == 0 { 2000 } else { -2000 };
        xyz.push(p);
    }
    xyz.extend((0..300).map(|_| [at(1.5), at(1.5), at(1.5)]));
    octree_of(&scan_of(&xyz, 0.001, DVec3::ZERO))
}

fn options(quality: Quality, dilate: Dilate, fill: bool) -> DrawOptions {
    let detail = Detail {
        threshold_px: [30.0, 60.0, 90.0],
        fade: true,
        smooth: true,
        fill_reach_px: fill.then_some(if dilate == Dilate::Rings { RINGS_REACH_PX } else { [1.0; 3] }),
        ..SAMPLE_DETAIL
    };
    DrawOptions { quality, dilate, background: [1, 2, 3], detail, ..sample_options() }
}

fn draw(octree: &Octree, view: &View, options: DrawOptions, tier: Atomics) -> Drawn {
    Canvas::layered(octree, view, options, tier, 0).draw(view)
}

/// A part of the larger picture's pixels.
fn cut<T: Copy>(pixels: &[T], PicturePart { first, size }: PicturePart) -> Vec<T> {
    let rows = pixels.chunks_exact(SIZE[0] as usize).skip(first[1] as usize).take(size[1] as usize);
    rows.flat_map(|row| &row[first[0] as usize..][..size[0] as usize]).copied().collect()
}

#[test]
fn a_part_of_a_picture_is_that_part_of_the_larger_one() {
    let octree = room();
    for quality in [Quality::Closest, Quality::Hqs] {
        for (dilate, fill) in [(Dilate::Off, true), (Dilate::Rings, false), (Dilate::Rings, true)] {
            let options = options(quality, dilate, fill);
            let whole = draw(&octree, &view(None), options, gpu().atomics());
            // All parts are drawn where dilation and fill come together; elsewhere a border, a corner, and the
            // middle.
            let is_all = dilate == Dilate::Rings && fill;
            let parts = PARTS.into_iter().enumerate().filter(|(i, _)| is_all || [1, 4, 8].contains(i));
            for (_, part) in parts {
                // One part is drawn in the other tiers, which draw what the best one does.
                let is_corner = part.first == [0, 0];
                for tier in tiers().into_iter().filter(|&tier| is_corner || tier == gpu().atomics()) {
                    let drawn = draw(&octree, &view(Some(part)), options, tier);
                    for eye in 0..2 {
                        let what =
                            format!("{quality:?}, {dilate:?}, fill {fill}, {part:?}, {tier:?}, eye {eye}");
                        let pixels = num_differing(&drawn.pixels[eye], &cut(&whole.pixels[eye], part));
                        assert_eq!(pixels, 0, "{what}: pixels that differ");
                        assert!(drawn.images[eye] == cut(&whole.images[eye], part), "{what}: image");
                    }
                }
            }
            // The comparison can fail: a pixel further on is another part.
            let [part, beside] = [PARTS[4], PicturePart { first: [1, 0], ..PARTS[4] }];
            assert!(num_differing(&cut(&whole.pixels[0], part), &cut(&whole.pixels[0], beside)) > 500);
        }
    }
}

/// One eye's part may begin and end elsewhere than the other's.
#[test]
fn an_eye_does_not_depend_on_where_the_others_picture_ends() {
    let octree = room();
    let options = options(Quality::Hqs, Dilate::Rings, true);
    let whole = draw(&octree, &view(None), options, gpu().atomics());
    let (left, right) = (PARTS[0], PARTS[8]);
    let eyes = vec![view(Some(left)).eyes[0], view(Some(right)).eyes[1]];
    let both = View { eyes, near: 0.05 };
    assert_ne!(sizes(&both)[0], sizes(&both)[1]);
    let drawn = draw(&octree, &both, options, gpu().atomics());
    assert!(drawn.pixels[0] == cut(&whole.pixels[0], left));
    assert!(drawn.pixels[1] == cut(&whole.pixels[1], right));
}

/// Shows what the guard band is for: dilation of a part alone makes another picture at the border, and only there.
#[test]
fn without_a_guard_band_the_border_would_differ() {
    let octree = room();
    let options = options(Quality::Closest, Dilate::Rings, false);
    let whole = draw(&octree, &view(None), options, gpu().atomics());
    let part = PARTS[8];
    let mut uniform = ViewUniform::new(&view(Some(part)), &octree.cloud.split, &options.detail);
    for eye in &mut uniform.eyes {
        eye.first_px = eye.first_px.map(|px| px + GUARD_PX as f32);
        [eye.width, eye.height] = part.size;
    }
    let alone: Vec<Pixel> = dilate(&uniform, 0, &cut(&whole.surface[0], part));
    let want = cut(&whole.pixels[0], part);
    let [width, height] = part.size;
    let (mut border, mut middle) = (0, 0);
    for (i, _) in alone.iter().zip(&want).enumerate().filter(|(_, (a, b))| a != b) {
        let (x, y) = (i as u32 % width, i as u32 / width);
        let is_border = x.min(y).min(width - 1 - x).min(height - 1 - y) < GUARD_PX;
        *if is_border { &mut border } else { &mut middle } += 1;
    }
    assert!(border > 20 && middle == 0, "{border} pixels of the border, {middle} others");
}

/// Shows what the margin is for: points are seen in a part in which their own pixel is not.
#[test]
fn points_reach_into_the_picture_from_outside() {
    let octree = room();
    let options = options(Quality::Closest, Dilate::Off, true);
    let part = PARTS[8];
    let view = view(Some(part));
    let drawn = draw(&octree, &view, options, gpu().atomics());
    let flat = DrawOptions { detail: Detail { fill_reach_px: None, ..options.detail }, ..options };
    // Each point is in its own pixel in the larger picture.
    let ids = |pixels: &[u64]| -> std::collections::HashSet<u32> {
        pixels.iter().filter(|key| **key != u64::MAX).map(|key| *key as u32 >> 1).collect()
    };
    let own = ids(&draw(&octree, &self::view(None), flat, gpu().atomics()).keys[0]);
    let own_inside = ids(&draw(&octree, &view, flat, gpu().atomics()).keys[0]);
    let from_outside =
        ids(&drawn.keys[0]).into_iter().filter(|id| own.contains(id) && !own_inside.contains(id));
    assert!(from_outside.count() > 10);
}
