//! Tests of each figure of a picture, with what it must not see.

use super::metrics::*;
use super::picture::EyePicture;
use base::space::{Eye, Fov, Pose};

const SIZE_PX: [u32; 2] = [40, 36];

/// A slope in each channel, at depth 10.
pub fn slope() -> EyePicture {
    let [width, height] = SIZE_PX;
    let color = |i: u32| [(40 + 3 * (i % width)) as u8, (60 + 2 * (i / width)) as u8, 128];
    let num_pixels = width * height;
    EyePicture {
        size_px: SIZE_PX,
        rgb: (0..num_pixels).map(color).collect(),
        depth: vec![10.0; num_pixels as usize],
    }
}

/// Moves every value of every pixel up or down by `by`.
fn noisy(picture: &EyePicture, by: u8) -> EyePicture {
    let mut random = 1u64;
    let mut noisy = picture.clone();
    for value in noisy.rgb.as_flattened_mut() {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        *value = if random >> 63 == 0 { *value + by } else { *value - by };
    }
    noisy
}

#[test]
fn equal_pictures_have_no_faults() {
    let a = slope();
    assert_eq!(psnr_db(&a, &a, |_| true), f64::INFINITY);
    assert!((ssim(&a, &a) - 1.0).abs() < 1e-12);
    assert_eq!(Holes::of(&a, &a), Holes { empty: 0, behind: 0, judged: 40 * 36 });
    assert_eq!(mean_change(&a, &a), 0.0);
    assert_eq!(largest_patch_change(&a, &a), 0.0);
}

#[test]
fn psnr_of_known_noise_is_known() {
    let a = slope();
    for by in [1u8, 5, 20] {
        let want = 20.0 * (255.0 / f64::from(by)).log10();
        assert!((psnr_db(&a, &noisy(&a, by), |_| true) - want).abs() < 1e-9, "±{by}");
    }
    let mut worst = a.clone();
    worst.rgb.iter_mut().for_each(|rgb| *rgb = rgb.map(|c| if c < 128 { 255 } else { 0 }));
    assert!(psnr_db(&a, &worst, |_| true) < 6.0);
}

#[test]
fn psnr_sees_what_counts_only() {
    let a = slope();
    let mut b = a.clone();
    b.rgb[7] = [255; 3];
    assert_eq!(psnr_db(&a, &b, |pixel| pixel != 7), f64::INFINITY);
    assert!(psnr_db(&a, &b, |pixel| pixel == 7) < 10.0);
    assert!(psnr_db(&a, &b, |_| false).is_nan());
}

#[test]
fn the_ring_is_round_the_gaze() {
    let eye = |gaze_in_view| Eye {
        world_from_view: Pose::IDENTITY,
        fov: Fov::from_angles(
            -45f64.to_radians(),
            45f64.to_radians(),
            45f64.to_radians(),
            -45f64.to_radians(),
        ),
        size_px: [200, 200],
        gaze_in_view,
    };
    let ahead = within_ring(&eye(Eye::AHEAD), 20.0);
    // The ring is a circle of tan 20° = 0.364 of half the width.
    let num_inside = ahead.iter().filter(|&&inside| inside).count() as f64;
    let want = std::f64::consts::PI * (100.0 * 20f64.to_radians().tan()).powi(2);
    assert!((num_inside / want - 1.0).abs() < 0.01, "{num_inside} and {want}");
    assert!(ahead[100 * 200 + 100] && !ahead[0]);
    let aside = within_ring(&eye(glam::DVec3::new(-1.0, 0.0, -1.0)), 20.0);
    assert!(aside[100 * 200] && !aside[100 * 200 + 100]);
    assert!(within_ring(&eye(Eye::AHEAD), 90.0).iter().all(|&inside| inside));
}

#[test]
fn ssim_falls_with_noise_and_structure_but_hardly_with_brightness() {
    let a = slope();
    let mut brighter = a.clone();
    brighter.rgb.as_flattened_mut().iter_mut().for_each(|value| *value += 5);
    let [little, much] = [5, 20].map(|by| ssim(&a, &noisy(&a, by)));
    assert!(ssim(&a, &brighter) > 0.99);
    assert!(little < 0.95 && much < 0.5 * little, "{little}, {much}");
    let one = noisy(&a, 20);
    let mut opposite = one.clone();
    for (value, mean) in opposite.rgb.as_flattened_mut().iter_mut().zip(a.rgb.as_flattened()) {
        *value = mean.wrapping_mul(2).wrapping_sub(*value);
    }
    assert!(ssim(&one, &opposite) < 0.0, "bright where the other is dark");
}

/// Two flat pictures have no variance: what remains is the luminance term, known in closed form.
#[test]
fn ssim_of_flat_pictures_is_known() {
    let flat = |value: u8| EyePicture { rgb: vec![[value; 3]; 40 * 36], ..slope() };
    let (a, b, c1) = (100.0, 150.0, 2.55f64.powi(2));
    let want = (2.0 * a * b + c1) / (a * a + b * b + c1);
    assert!((ssim(&flat(100), &flat(150)) - want).abs() < 1e-9);
}

#[test]
fn holes_are_empty_or_behind() {
    let truth = slope();
    let mut picture = truth.clone();
    picture.depth[50] = f32::INFINITY;
    picture.depth[90] = 10.2;
    // Depths within 1 %, and before the surface, are no holes.
    picture.depth[130] = 10.05;
    picture.depth[170] = 1.0;
    let holes = Holes::of(&picture, &truth);
    assert_eq!(holes, Holes { empty: 1, behind: 1, judged: 40 * 36 });
    assert!((holes.share() - 2.0 / 1440.0).abs() < 1e-12);
}

#[test]
fn edges_and_sky_are_no_holes() {
    // The truth has a near surface on the left, a far one on the right, and sky at the bottom.
    let mut truth = slope();
    for (pixel, depth) in truth.depth.iter_mut().enumerate() {
        *depth = if pixel / 40 >= 30 {
            f32::INFINITY
        } else if pixel % 40 < 20 {
            2.0
        } else {
            10.0
        };
    }
    let mut picture = truth.clone();
    let at = |x: usize, y: usize| y * 40 + x;
    // Half a pixel of shift shows the far surface where the near one ends, and sky where the surface ends.
    picture.depth[at(19, 5)] = 10.0;
    picture.depth[at(25, 29)] = f32::INFINITY;
    let holes = Holes::of(&picture, &truth);
    assert_eq!(holes, Holes { empty: 0, behind: 0, judged: 40 * 29 });
    // They are holes one pixel further in.
    picture.depth[at(18, 5)] = 10.0;
    picture.depth[at(25, 28)] = f32::INFINITY;
    let holes = Holes::of(&picture, &truth);
    assert_eq!((holes.empty, holes.behind), (1, 1));
    let sky = EyePicture { depth: vec![f32::INFINITY; truth.depth.len()], ..truth.clone() };
    assert!(Holes::of(&picture, &sky).share().is_nan());
}

#[test]
fn own_change_is_what_the_truth_does_not_do() {
    let (a, b) = (slope(), noisy(&slope(), 4));
    assert_eq!(mean_own_change([&a, &b], [&a, &b]), 0.0);
    assert_eq!(mean_own_change([&a, &b], [&a, &a]), 4.0);
    assert_eq!(mean_own_change([&a, &a], [&a, &b]), 4.0, "standing still where the truth moves is wrong too");
    assert_eq!(mean_own_change([&b, &a], [&a, &b]), 8.0);
    let nothing = EyePicture { depth: vec![f32::INFINITY; a.depth.len()], ..a.clone() };
    assert!(mean_own_change([&a, &b], [&a, &nothing]).is_nan());
}

#[test]
fn a_patch_that_pops_is_found_where_the_mean_hides_it() {
    let a = slope();
    let mut b = a.clone();
    for y in 16..32 {
        for x in 0..16 {
            b.rgb[y * 40 + x][2] -= 30;
        }
    }
    assert!((largest_patch_change(&a, &b) - 10.0).abs() < 1e-12);
    assert!((mean_change(&a, &b) - 10.0 * 256.0 / 1440.0).abs() < 1e-12);
    // A patch of 8 × 4 pixels at the edge counts by its own pixels.
    let mut b = a.clone();
    b.rgb[33 * 40 + 39] = a.rgb[33 * 40 + 39].map(|c| c - 32);
    assert!((largest_patch_change(&a, &b) - 1.0).abs() < 1e-12);
}
