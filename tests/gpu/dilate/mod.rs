//! `dilate` on the GPU is compared with its CPU reference, bit for bit. The CPU reference is compared with what
//! dilation is for, and with a plain two-dimensional definition where the two must agree.

mod on_gpu;

use base::space::{Bounds, Eye, Fov, Pose, Split, View};
use glam::{DQuat, DVec3};
use kit::frames::{SAMPLE_DETAIL, SplitMix, num_differing};
use lab::reference::color::Sum;
use lab::reference::dilate::{dilate, radius_px};
use lab::reference::resolve::{EMPTY, blend};
use on_gpu::{ShownAs, blended_on_gpu, on_gpu, run_shown};
use render::layout::{
    GUARD_PX, MAX_MEAN_COUNT, Pixel, SURFACE_TOLERANCE, Variant, ViewUniform, depth_of, mask_words_per_row,
};

/// Two eyes with asymmetric images of this size, canted, looking off the center, so that all rings are in the
/// picture.
fn view(size_px: [u32; 2]) -> ViewUniform {
    let eye = |sign: f64| Eye {
        world_from_view: Pose {
            position: DVec3::X * sign * 0.03,
            orientation: DQuat::from_rotation_y(-0.1 * sign),
        },
        fov: Fov { left: -1.0 - 0.2 * sign, right: 1.1, up: 0.9, down: -1.3 },
        size_px,
        gaze_in_view: DVec3::new(0.3 * sign, 0.2, -1.0).normalize(),
    };
    let view = View { eyes: vec![eye(-1.0), eye(1.0)], near: 0.05 };
    let mut uniform = ViewUniform::new(&view, &Split::of(&Bounds::EMPTY, &Bounds::EMPTY), &SAMPLE_DETAIL);
    // The size stands for the one with the guard band, which `dilate` does not tell from the image.
    let guard = GUARD_PX as f32;
    for eye in &mut uniform.eyes {
        eye.first_px = eye.first_px.map(|px| px + guard);
        eye.end_px = eye.end_px.map(|px| px - guard);
        [eye.width, eye.height] = size_px;
    }
    uniform
}

/// The view with one ring everywhere, whose kernel has this radius; 0: with its own rings.
fn fixed(view: &ViewUniform, radius_px: usize) -> ViewUniform {
    let (never, always) = (2.0, -2.0);
    let ring_cos = match radius_px {
        0 => view.ring_cos,
        1 => [always; 2],
        2 => [never, always],
        _ => [never; 2],
    };
    ViewUniform { ring_cos, ..*view }
}

fn pixel(depth: f32, [r, g, b]: [u8; 3]) -> Pixel {
    [depth.to_bits(), u32::from_le_bytes([r, g, b, 255])]
}

/// Two smooth surfaces, one before the other, of which `percent` of the pixels are there, and single points anywhere.
fn sparse([width, height]: [u32; 2], percent: u64, seed: u64) -> Vec<Pixel> {
    let mut random = SplitMix(seed);
    let mut pixels = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let (u, v) = (x as f32 / 64.0, y as f32 / 64.0);
            let near = (u * 3.0).sin() + (v * 2.0).cos() > 0.6;
            let depth = if near { 2.0 + 0.05 * u } else { 5.0 + 0.3 * v };
            let color = [random.bits() as u8, (40.0 * u) as u8, (50.0 * v) as u8];
            pixels.push(match random.bits() % 1000 {
                0 => pixel(0.1 + 10.0 * random.unit() as f32, color),
                n if n < 10 * percent => pixel(depth, color),
                _ => EMPTY,
            });
        }
    }
    pixels
}

#[test]
fn gpu_equals_its_reference() {
    let sizes = [[333, 217], [5, 3], [16, 16], [1, 1], [32, 16], [33, 17], [1, 40], [40, 1], [128, 96]];
    for (number, size) in sizes.into_iter().enumerate() {
        let view = view(size);
        for percent in [10, 40, 70, 97, 100] {
            let surface = sparse(size, percent, number as u64);
            for (eye, radius) in [(0, 0), (1, 0), (0, 1), (0, 2), (0, 3)] {
                let view = fixed(&view, radius);
                let differing = num_differing(&on_gpu(&view, eye, &surface), &dilate(&view, eye, &surface));
                assert_eq!(differing, 0, "{size:?}, {percent} %, {eye}, {radius}: pixels that differ");
            }
        }
    }
}

/// Covers the shader's special cases: tiles that are skipped as a whole, empty tiles, and extreme depths and colors.
#[test]
fn gpu_equals_its_reference_where_tiles_are_whole_or_depths_extreme() {
    let size = [100, 70];
    let view = view(size);
    let white = |depth: f32| pixel(depth, [255; 3]);
    let with_hole = |mut surface: Vec<Pixel>| {
        surface[35 * 100 + 50] = [EMPTY[0], 0x0012_3456];
        surface
    };
    let surfaces = [
        vec![white(3.0); 7000],
        vec![EMPTY; 7000],
        with_hole(vec![white(3.0); 7000]),
        with_hole(vec![white(f32::MAX); 7000]),
        with_hole(vec![white(1e-30); 7000]),
        // Depths differ by exactly the tolerance, then by one step more.
        (0..7000).map(|i| white(if i % 3 == 0 { 2.0 } else { SURFACE_TOLERANCE * 2.0 })).collect(),
        (0..7000)
            .map(|i| white(if i % 3 == 0 { 2.0 } else { (SURFACE_TOLERANCE * 2.0).next_up() }))
            .collect(),
        // The nearest and the farthest pixel of a tile lie in different windows.
        (0..7000).map(|i| white(if i % 100 < 50 { 2.0 } else { 4.0 })).collect(),
    ];
    for (number, surface) in surfaces.iter().enumerate() {
        let want = dilate(&view, 1, surface);
        assert_eq!(num_differing(&on_gpu(&view, 1, surface), &want), 0, "surface {number}");
    }
}

/// Some pixels take nothing though the tile is no single surface, single pixels take, and some tiles have none that
/// does.
#[test]
fn gpu_equals_its_reference_where_few_pixels_take() {
    let size = [200, 150];
    let view = view(size);
    // The floor recedes by less than the tolerance from row to row, so none of its pixels takes from another.
    let slope: Vec<Pixel> =
        (0..30_000).map(|i| pixel(1.0 + 0.001 * (i / 200) as f32, [i as u8, 9, 200])).collect();
    assert_eq!(dilate(&view, 0, &slope), slope);
    let mut random = SplitMix(23);
    for num_holes in [0, 1, 2, 40, 700] {
        let mut surface = slope.clone();
        for _ in 0..num_holes {
            let at = (random.bits() % 30_000) as usize;
            surface[at] = if random.bits().is_multiple_of(2) { EMPTY } else { pixel(9.0, [1, 2, 3]) };
        }
        for (eye, radius) in [(0, 0), (1, 0), (0, 1), (0, 3)] {
            let view = fixed(&view, radius);
            let want = dilate(&view, eye, &surface);
            assert_eq!(want == surface, num_holes == 0, "{num_holes} holes");
            let differing = num_differing(&on_gpu(&view, eye, &surface), &want);
            assert_eq!(differing, 0, "{num_holes} holes, {eye}, {radius}");
        }
    }
}

/// A pixel that nobody sees is background, whether its tile is drawn or not; colors stand as the image holds them.
#[test]
fn hidden_pixels_show_the_background_and_colors_the_images_order() {
    let size = [100, 70];
    let view = view(size);
    let mut surface = sparse(size, 60, 2);
    surface.iter_mut().for_each(|p| {
        if *p != EMPTY {
            p[1] |= 0xff00_0000
        }
    });
    let words = mask_words_per_row(size[0]);
    // All pixels are hidden except for a circle.
    let is_hidden = |x: u32, y: u32| (x.abs_diff(60)).pow(2) + (y.abs_diff(30)).pow(2) > 25 * 25;
    let mut hidden = vec![0u32; (words * size[1]) as usize];
    for (x, y) in
        (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).filter(|&(x, y)| is_hidden(x, y))
    {
        hidden[(y * words + x / 32) as usize] |= 1 << (x % 32);
    }
    let input: [(&str, &[u8]); 1] = [("surface", bytemuck::cast_slice(&surface))];
    let of = (&view, 0);
    for (shader, want) in [("dilate", dilate(&view, 0, &surface)), ("show", surface.clone())] {
        for is_bgra in [false, true] {
            let shown = ShownAs { hidden: hidden.clone(), background: 0xff01_0203, is_bgra };
            let got = run_shown(shader, Variant::eyes(2), of, &input, &shown);
            let mut num_poisoned = 0;
            for (i, (got, want)) in got.iter().zip(&want).enumerate() {
                let (x, y) = (i as u32 % size[0], i as u32 / size[0]);
                let [r, g, b, a] = want[1].to_le_bytes();
                let color = if is_bgra { u32::from_le_bytes([b, g, r, a]) } else { want[1] };
                let nothing = is_hidden(x, y) || want[0] == EMPTY[0];
                let want = if nothing { [EMPTY[0], 0xff01_0203] } else { [want[0], color] };
                let is_poison = *got == [0xabab_abab; 2];
                num_poisoned += u32::from(is_poison);
                assert!(*got == want || is_poison && is_hidden(x, y), "{shader}: pixel {x}, {y}: {got:x?}");
            }
            assert!(num_poisoned > 500, "tiles that nobody sees are left alone");
        }
    }
}

/// Puts this many points into each pixel of a surface at most, so that there are sums of all sizes, whose means are
/// not the colors that the surface had.
fn sums_of(surface: &[Pixel], max_points: u64) -> Vec<Sum> {
    let mut random = SplitMix(17);
    let mut sum = |&[depth, color]: &Pixel| {
        let [r, g, b, _] = color.to_le_bytes().map(u64::from);
        let count = 1 + random.bits() % max_points;
        let mut channel = |of: u64| (count * of + random.bits() % count).min(255 * count) as u32;
        if depth == EMPTY[0] { [0; 4] } else { [channel(r), channel(g), channel(b), count as u32] }
    };
    surface.iter().map(&mut sum).collect()
}

#[test]
fn blended_and_dilated_in_one_equals_the_references() {
    for (number, size) in [[333, 217], [5, 3], [33, 17], [1, 40], [128, 96]].into_iter().enumerate() {
        let view = view(size);
        for (percent, max_points) in [(10, 1), (40, 3), (70, 1023), (97, 20), (100, 300)] {
            let surface = sparse(size, percent, number as u64);
            let depth: Vec<u32> = surface.iter().map(|p| p[0]).collect();
            let sums = sums_of(&surface, max_points);
            for (eye, radius) in [(0, 0), (1, 0), (0, 3)] {
                let view = fixed(&view, radius);
                let want = dilate(&view, eye, &blend(&depth, &sums));
                for image in blended_on_gpu(&view, eye, &depth, &sums) {
                    let differing = num_differing(&image, &want);
                    assert_eq!(differing, 0, "{size:?}, {percent} %, {eye}, {radius}: pixels that differ");
                }
            }
            // The comparison can fail: it sees sums, not only depths.
            let mut wrong = sums.clone();
            let point = depth.iter().position(|&w| w != EMPTY[0]);
            if let Some(at) = point.filter(|&at| sums[at][1] < 255 * sums[at][3]) {
                wrong[at][1] += sums[at][3];
                assert_ne!(blend(&depth, &wrong), blend(&depth, &sums));
            }
        }
    }
}

/// The comparisons above can fail: one bit of a color or of a depth shows, and so does a wrong radius.
#[test]
fn the_comparison_notices_a_bit_and_a_radius() {
    let size = [64, 48];
    let view = view(size);
    let surface = sparse(size, 50, 9);
    let good = on_gpu(&view, 0, &surface);
    let index = surface.iter().position(|p| *p != EMPTY).expect("a point");
    for bit in [[1, 0], [0, 1]] {
        let mut wrong = surface.clone();
        wrong[index] = [wrong[index][0] ^ bit[0], wrong[index][1] ^ bit[1]];
        assert!(num_differing(&good, &dilate(&view, 0, &wrong)) > 0);
    }
    for radius in 1..=3 {
        assert!(num_differing(&good, &dilate(&fixed(&view, radius), 0, &surface)) > 0, "radius {radius}");
    }
    assert!(num_differing(&good, &dilate(&view, 1, &surface)) > 0, "the other eye's rings");
}

/// Radii by cosines without roots are those of the angles, except on the edge between two rings.
#[test]
fn rings_follow_the_angle_from_the_gaze() {
    let size = [200, 150];
    let detail = SAMPLE_DETAIL;
    let view = view(size);
    for number in 0..2 {
        let eye = &view.eyes[number];
        let gaze = DVec3::from_array(eye.gaze_in_view.map(f64::from));
        let mut counts = [0; 4];
        for (x, y) in (0..150).flat_map(|y| (0..200).map(move |x| (x, y))) {
            let along = |axis: usize, at: usize| {
                let from_corner = at as f64 + f64::from(eye.first_px[axis]) + 0.5;
                f64::from(eye.tangent_origin[axis]) + f64::from(eye.tangent_per_px[axis]) * from_corner
            };
            let angle = gaze.angle_between(DVec3::new(along(0, x), along(1, y), -1.0));
            let want = 1 + detail.ring_rad.iter().filter(|&&end| angle > end).count();
            let on_edge = detail.ring_rad.iter().any(|end| (angle - end).abs() < 1e-5);
            let got = radius_px(&view, number, x, y);
            assert!(got == want || on_edge, "pixel {x}, {y} at {angle} has radius {got}, not {want}");
            counts[got] += 1;
        }
        assert!(counts[1..].iter().all(|&count| count > 500), "every ring is in the picture: {counts:?}");
    }
}

#[test]
fn one_surface_without_holes_stays() {
    let view = view([40, 30]);
    let mut random = SplitMix(3);
    let surface: Vec<Pixel> =
        (0..1200).map(|_| pixel(2.5, [random.bits() as u8, random.bits() as u8, 7])).collect();
    assert_eq!(dilate(&view, 0, &surface), surface);
}

#[test]
fn what_is_empty_stays_empty() {
    let view = view([40, 30]);
    assert_eq!(dilate(&view, 0, &vec![EMPTY; 1200]), vec![EMPTY; 1200]);
}

/// A near surface and what it fills keep depth and color, whatever is added behind it.
#[test]
fn the_far_never_bleeds_over_the_near() {
    let size = [120, 90];
    let view = view(size);
    for radius in 0..=3 {
        let view = fixed(&view, radius);
        let mut near = sparse(size, 50, 4);
        near.iter_mut().filter(|p| !(2.0..2.1).contains(&depth_of(**p))).for_each(|p| *p = EMPTY);
        let mut both = near.clone();
        let mut random = SplitMix(5);
        for p in both.iter_mut().filter(|p| **p == EMPTY) {
            *p = pixel(2.3 + random.unit() as f32, [random.bits() as u8; 3]);
        }
        let (alone, together) = (dilate(&view, 0, &near), dilate(&view, 0, &both));
        for (i, p) in alone.iter().enumerate().filter(|(_, p)| **p != EMPTY) {
            assert_eq!(together[i], *p, "pixel {i} of the near surface, radius {radius}");
        }
        for (i, p) in near.iter().enumerate().filter(|(_, p)| **p != EMPTY) {
            assert_eq!(together[i], *p, "point {i}, radius {radius}");
        }
        assert!(alone.contains(&EMPTY) && near != alone);
    }
}

/// A wall shows through a slit, as wide as the radius, in a surface of two colors.
#[test]
fn a_hole_in_the_near_is_closed_from_the_near() {
    let view = view([60, 50]);
    for radius in 1..=3usize {
        let is_hole = |x: usize| (30..30 + radius).contains(&x);
        for behind in [EMPTY, pixel(8.0, [0, 0, 255])] {
            let surface: Vec<Pixel> = (0..3000)
                .map(|i| i % 60)
                .map(
                    |x| if is_hole(x) { behind } else { pixel(2.0, [if x < 30 { 100 } else { 200 }, 10, 0]) },
                )
                .collect();
            let image = dilate(&fixed(&view, radius), 0, &surface);
            for (i, got) in image.iter().enumerate() {
                let [r, g, b, a] = got[1].to_le_bytes();
                assert_eq!(depth_of(*got), 2.0, "pixel {i} belongs to the surface");
                assert!(
                    (100..=200).contains(&r) && g == 10 && b == 0 && a == 255,
                    "{:?}",
                    got[1].to_le_bytes()
                );
                assert!(is_hole(i % 60) || *got == surface[i], "pixel {i} was no hole");
            }
        }
    }
}

/// A single point becomes a square of its radius, and no more; the radius is that of the ring that it lies in.
#[test]
fn edges_grow_by_the_radius_at_most() {
    let size = [90usize, 70];
    let view = view([90, 70]);
    for (x, y) in [(0, 0), (45, 35), (89, 69), (20, 60), (70, 10), (33, 35)] {
        for radius in 0..=3 {
            let mut surface = vec![EMPTY; size[0] * size[1]];
            surface[y * size[0] + x] = pixel(1.0, [1, 2, 3]);
            let view = fixed(&view, radius);
            let image = dilate(&view, 0, &surface);
            for (i, got) in image.iter().enumerate() {
                let (column, row) = (i % size[0], i / size[0]);
                let reach = radius_px(&view, 0, x, y);
                let reached = x.abs_diff(column).max(y.abs_diff(row)) <= reach;
                let want = if reached { pixel(1.0, [1, 2, 3]) } else { EMPTY };
                assert_eq!(*got, want, "point {x}, {y}, radius {radius}: pixel {column}, {row}");
            }
        }
    }
}

/// Applies the rule to the whole window at once, in floats, without rows, columns or tolerance, for one constant
/// depth.
fn plain([width, height]: [usize; 2], radius: usize, surface: &[Pixel]) -> Vec<Option<[f64; 3]>> {
    let weight = |distance: usize| 4f64.powi(-(distance as i32));
    let mut image = Vec::new();
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let (mut sums, mut weights) = ([0.0; 3], 0.0);
        for row in y.saturating_sub(radius)..(y + radius + 1).min(height) {
            for column in x.saturating_sub(radius)..(x + radius + 1).min(width) {
                let from = surface[row * width + column];
                if from != EMPTY {
                    let w = weight(x.abs_diff(column)) * weight(y.abs_diff(row));
                    let channels = from[1].to_le_bytes();
                    (0..3).for_each(|c| sums[c] += w * f64::from(channels[c]));
                    weights += w;
                }
            }
        }
        let own = surface[y * width + x];
        image.push(match own {
            EMPTY => (weights > 0.0).then(|| sums.map(|sum| sum / weights)),
            _ => Some([0, 1, 2].map(|c: usize| f64::from(own[1].to_le_bytes()[c]))),
        });
    }
    image
}

#[test]
fn the_reference_equals_the_plain_definition_on_one_depth() {
    let size = [70usize, 50];
    let view = view([70, 50]);
    for (radius, percent) in [(1, 30), (2, 10), (3, 3), (3, 60)] {
        let mut surface = sparse([70, 50], percent, 11);
        surface.iter_mut().filter(|p| **p != EMPTY).for_each(|p| p[0] = 3f32.to_bits());
        let image = dilate(&fixed(&view, radius), 0, &surface);
        let want = plain(size, radius, &surface);
        for (i, (got, want)) in image.iter().zip(&want).enumerate() {
            let Some(want) = want else {
                assert_eq!(*got, EMPTY, "pixel {i}");
                continue;
            };
            assert_eq!(depth_of(*got), 3.0, "pixel {i}");
            for (channel, want) in got[1].to_le_bytes().into_iter().zip(want) {
                assert!((f64::from(channel) - want).abs() <= 0.5 + 1e-9, "pixel {i}: {channel}, not {want}");
            }
        }
        assert!(want.iter().any(Option::is_none) || percent > 10, "some pixels have no point near");
    }
}

/// Means by floats equal those by integers, for every count that `mean` is used for and every mean at its edges, even
/// where a division is wrong by as much as Vulkan allows: 2.5 units in the last place.
#[test]
fn float_means_are_exact() {
    let weights: u32 = (0..=2 * 3).map(|i: i32| 64u32 >> (2 * (i - 3).abs())).sum();
    assert!(weights * weights < MAX_MEAN_COUNT, "what `dilate` divides by");
    // The mean is this many units in the last place off the true quotient.
    let mean = |sum: u32, count: u32, units: f64| {
        let quotient = (f64::from(sum + count / 2) + 0.5) / f64::from(count);
        let unit = f64::from((quotient as f32).next_up()) - f64::from(quotient as f32);
        (quotient + units * unit) as u32
    };
    let mut is_wrong_by_more = false;
    for count in 1..MAX_MEAN_COUNT {
        for value in 0..=255 {
            // These are the first and the last sum of this mean.
            let first = (value * count).saturating_sub(count / 2);
            let last = (value * count + (count - 1) / 2).min(255 * count);
            for sum in [first, last] {
                let want = (sum + count / 2) / count;
                for units in [-2.5, 0.0, 2.5] {
                    assert_eq!(mean(sum, count, units), want, "{sum} / {count}, {units} units off");
                }
                is_wrong_by_more |= mean(sum, count, 6.0) != want || mean(sum, count, -6.0) != want;
            }
        }
    }
    assert!(is_wrong_by_more, "the check can fail");
}
