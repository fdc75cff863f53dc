//! Overlays show over copies of the eyes' images what the frame knows, and the images stay as they are.

use base::space::{Eye, View};
use base::srgb::{linear_from_srgb, linear_of_step, srgb_from_linear};
use base::task::Progress;
use cloud::Cloud;
use cloud::octree::Octree;
use glam::DVec3;
use kit::frames::{Canvas, cloud_of, gpu, octree_of, random_points, sample_options, scan_of, stereo};
use lab::order::Order;
use lab::reference::{self, ReferenceCloud};
use render::DrawOptions;
use render::gpu::{Atomics, readback};
use render::layout::{
    DEPTH_OCTAVES, Detail, EDGE_ALPHA, EMPTY_DEPTH, GUARD_PX, OVERDRAW_OCTAVES, OVERLAY_RAMP, PALETTE,
    RAMP_STEPS, RING_ALPHA, ViewUniform,
};
use render::options::{Dilate, Overlay, Quality};
use render::{CloudBuffers, EyeImage, Overlays};

const SIZE_PX: [u32; 2] = [161, 143];
const DETAIL: Detail = Detail {
    forced_planes: 0,
    threshold_px: [100.0, 200.0, 300.0],
    ring_rad: [0.35, 0.66],
    smooth: false,
    fade: false,
    fill_reach_px: None,
};

/// Both eyes' images and their copies with an overlay: red, green, blue of each pixel.
struct OverlaidEyes {
    images: [Vec<[u8; 3]>; 2],
    copies: [Vec<[u8; 3]>; 2],
}

fn show(canvas: &mut Canvas, view: &View, overlay: Overlay) -> OverlaidEyes {
    let mut overlays = Overlays::new(&canvas.renderer).expect("overlays");
    show_with(&mut overlays, canvas, view, overlay)
}

fn show_with(overlays: &mut Overlays, canvas: &mut Canvas, view: &View, overlay: Overlay) -> OverlaidEyes {
    let gpu = gpu();
    let all = wgpu::TextureUsages::RENDER_ATTACHMENT
        | wgpu::TextureUsages::COPY_SRC
        | wgpu::TextureUsages::COPY_DST;
    let make = || [0, 1].map(|_: i32| gpu.texture("eye", SIZE_PX, wgpu::TextureFormat::Rgba8UnormSrgb, all));
    let (images, copies) = (make(), make());
    let views = |textures: &[wgpu::Texture; 2]| {
        textures.each_ref().map(|texture| texture.create_view(&Default::default()))
    };
    let (image_views, copy_views) = (views(&images), views(&copies));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let renderer = &mut canvas.renderer;
    renderer.record(&mut encoder, 0, &image_views.each_ref().map(|color| EyeImage { color, depth: None }));
    for (image, copy) in images.iter().zip(&copies) {
        encoder.copy_texture_to_texture(image.as_image_copy(), copy.as_image_copy(), image.size());
    }
    overlays.record(renderer, &mut encoder, overlay, &copy_views.each_ref());
    {
        let queue = gpu.queue.lock();
        renderer.set_view(&queue, view);
        queue.submit([encoder.finish()]);
    }
    renderer.submitted();
    let read = |texture: &wgpu::Texture| {
        let bytes = readback::read_texture(&gpu, texture).expect("an image");
        bytes.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect()
    };
    OverlaidEyes { images: images.each_ref().map(read), copies: copies.each_ref().map(read) }
}

fn options(quality: Quality, dilate: Dilate) -> DrawOptions {
    DrawOptions { quality, dilate, background: [1, 2, 3], detail: DETAIL, ..sample_options() }
}

fn flat() -> Cloud {
    cloud_of(&random_points(60_000, 10.0, 9), 0.001, DVec3::new(5e5, 4e6, 100.0), Order::Morton)
}

fn layered() -> Octree {
    octree_of(&scan_of(&random_points(60_000, 10.0, 9), 0.001, DVec3::new(5e5, 4e6, 100.0)))
}

/// Looks at the cloud from this far away, with a gaze off the axis.
fn at(cloud: &Cloud, distance: f64) -> View {
    let center = cloud.bounds.center();
    let mut view = stereo(center - DVec3::new(0.4 * distance, distance, -0.3 * distance), center, SIZE_PX);
    for eye in &mut view.eyes {
        eye.gaze_in_view = DVec3::new(0.3, -0.1, -1.0).normalize();
    }
    view
}

/// An sRGB color over a pixel, as strong as `alpha`.
fn over(image: [u8; 3], color: [f32; 3], alpha: f32) -> [u8; 3] {
    let alpha = f64::from(alpha);
    std::array::from_fn(|i| {
        let color = linear_from_srgb(f64::from(color[i]));
        let mixed = alpha * color + (1.0 - alpha) * linear_of_step(image[i]);
        (255.0 * srgb_from_linear(mixed)).round() as u8
    })
}

fn is_near(a: [u8; 3], b: [u8; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 4)
}

fn ramp(share: f32) -> [f32; 3] {
    let at = RAMP_STEPS as f32 * share.clamp(0.0, 1.0);
    let stop = (at as usize).min(RAMP_STEPS as usize - 1);
    let [below, above] = [OVERLAY_RAMP[stop], OVERLAY_RAMP[stop + 1]];
    std::array::from_fn(|i| below[i] + (at - stop as f32) * (above[i] - below[i]))
}

/// Number of an eye's pixels that are not as wanted; the comparison is only worth something if what is wanted varies.
fn num_wrong(copy: &[[u8; 3]], wanted: &dyn Fn(usize) -> [u8; 3]) -> usize {
    let first = wanted(0);
    assert!((0..copy.len()).any(|i| !is_near(wanted(i), first)), "all the same");
    (0..copy.len()).filter(|&i| !is_near(copy[i], wanted(i))).count()
}

#[test]
fn no_overlay_touches_the_eyes_images() {
    let octree = layered();
    let view = at(&octree.cloud, 12.0);
    for (quality, dilate) in [(Quality::Hqs, Dilate::Rings), (Quality::Closest, Dilate::Off)] {
        let mut canvas = Canvas::layered(&octree, &view, options(quality, dilate), gpu().atomics(), 0);
        let plain = show(&mut canvas, &view, Overlay::None);
        assert!(plain.copies == plain.images && plain.images[0] != plain.images[1]);
        for overlay in Overlay::ALL {
            let shown = show(&mut canvas, &view, overlay);
            assert!(shown.images == plain.images, "{overlay:?} {quality:?}");
            let is_drawn =
                overlay != Overlay::None && !(overlay == Overlay::Overdraw && quality == Quality::Closest);
            for eye in 0..2 {
                assert_eq!(shown.copies[eye] != plain.images[eye], is_drawn, "{overlay:?} {quality:?}");
            }
        }
    }
}

#[test]
fn rings_follow_the_rule_of_dilation() {
    let cloud = flat();
    let view = at(&cloud, 40.0);
    let mut canvas = Canvas::flat(&cloud, &view, options(Quality::Closest, Dilate::Off), 0);
    let shown = show(&mut canvas, &view, Overlay::Rings);
    let uniform = ViewUniform::new(&view, &cloud.split, &DETAIL);
    let [width, height] = SIZE_PX.map(|edge| edge as usize);
    for eye in 0..2 {
        let guard = GUARD_PX as usize;
        let ring = |x, y| reference::dilate::radius_px(&uniform, eye, x + guard, y + guard);
        let mut num_of = [0; 4];
        for (x, y) in (1..height - 1).flat_map(|y| (1..width - 1).map(move |x| (x, y))) {
            let own = ring(x, y);
            let around = [ring(x + 1, y), ring(x - 1, y), ring(x, y + 1), ring(x, y - 1)];
            let is_edge = around.iter().any(|&other| other != own);
            let at = y * width + x;
            let alpha = RING_ALPHA[usize::from(is_edge)];
            let wanted = over(shown.images[eye][at], PALETTE[own - 1], alpha);
            assert!(
                is_near(shown.copies[eye][at], wanted),
                "{x}, {y}: {:?}, not {wanted:?}",
                shown.copies[eye][at]
            );
            num_of[if is_edge { 0 } else { own }] += 1;
        }
        assert!(num_of.iter().all(|&num| num > 50), "edges and all three rings: {num_of:?}");
    }
}

#[test]
fn depth_is_a_ramp_from_near() {
    let cloud = flat();
    let view = at(&cloud, 9.0);
    for dilate in [Dilate::Off, Dilate::Rings] {
        let options = options(Quality::Closest, dilate);
        let mut canvas = Canvas::flat(&cloud, &view, options, 0);
        let pixels = reference::frame(&ReferenceCloud::flat(&cloud), &view, &options, None).pixels;
        let shown = show(&mut canvas, &view, Overlay::Depth);
        for (eye, pixels) in pixels.iter().enumerate() {
            let wanted = |i: usize| match pixels[i] {
                [EMPTY_DEPTH, _] => [0; 3],
                [w, _] => {
                    let octaves = (f32::from_bits(w) / view.near as f32).log2();
                    over([0; 3], ramp(octaves / DEPTH_OCTAVES), 1.0)
                }
            };
            assert_eq!(num_wrong(&shown.copies[eye], &wanted), 0, "{dilate:?}");
            assert!(num_wrong(&shown.images[eye], &wanted) > 100, "the image itself is no ramp");
        }
    }
}

#[test]
fn overdraw_counts_what_a_pixel_blends() {
    let (cloud, octree) = (flat(), layered());
    let view = at(&cloud, 60.0);
    for dilate in [Dilate::Off, Dilate::Rings] {
        let options = options(Quality::Hqs, dilate);
        let check = |what: &str, scene: &ReferenceCloud, canvas: &mut Canvas| {
            // The canvas has drawn no frame yet, so the reference has none before it.
            let sums = reference::frame(scene, &view, &options, None).sums;
            let shown = show(canvas, &view, Overlay::Overdraw);
            for (sums, copy) in sums.iter().zip(&shown.copies) {
                let wanted = |i: usize| match sums[i][3] {
                    0 => [0; 3],
                    count => over([0; 3], ramp((count as f32).log2() / OVERDRAW_OCTAVES), 1.0),
                };
                assert_eq!(num_wrong(copy, &wanted), 0, "{what} {dilate:?}");
                assert!(sums.iter().any(|sum| sum[3] > 1), "{what}: some pixels have several");
            }
        };
        // The sums are in one word, in one that overflows into four, and in four.
        let tiers = [Atomics::Int64, Atomics::Int32].into_iter().filter(|&tier| tier <= gpu().atomics());
        for tier in tiers {
            let mut canvas = Canvas::layered(&octree, &view, options, tier, 0);
            check(&format!("layered {tier:?}"), &ReferenceCloud::layered(&octree), &mut canvas);
        }
        check("flat", &ReferenceCloud::flat(&cloud), &mut Canvas::flat(&cloud, &view, options, 0));
    }
}

/// Pixel and depth of a place, if the eye sees it.
fn pixel_of(view: &View, eye: &Eye, p_in_world: DVec3) -> Option<[usize; 2]> {
    let head = view.head_in_world();
    let p = (p_in_world - head).extend(1.0);
    let [x, y, w] = eye.pixel_from_head(head).map(|row| glam::DVec4::from_array(row).dot(p));
    let px = [x / w, y / w];
    let inside = w > view.near && (0..2).all(|i| px[i] > 2.0 && px[i] < f64::from(SIZE_PX[i]) - 2.0);
    inside.then(|| px.map(|px| px as usize))
}

fn pixel(image: &[[u8; 3]], [x, y]: [usize; 2]) -> [u8; 3] {
    image[y * SIZE_PX[0] as usize + x]
}

/// Checks that a box's edges are drawn in a color, its faces are not, and next to nothing else is.
fn assert_box(shown: &OverlaidEyes, view: &View, low: DVec3, size: DVec3, color: [f32; 3]) {
    for (eye, (image, copy)) in view.eyes.iter().zip(shown.images.iter().zip(&shown.copies)) {
        let place = |share: [f64; 3]| pixel_of(view, eye, low + size * DVec3::from_array(share));
        let mut num_strong = 0;
        for edge in 0..12 {
            let (axis, bits) = (edge / 4, edge % 4);
            let mut share = [0.5; 3];
            share[(axis + 1) % 3] = f64::from((bits & 1) as u8);
            share[(axis + 2) % 3] = f64::from((bits >> 1) as u8);
            let middle = place(share).expect("the whole box is seen");
            let wanted = EDGE_ALPHA.map(|alpha| over(pixel(image, middle), color, alpha));
            let is = wanted.map(|wanted| is_near(pixel(copy, middle), wanted));
            assert!(is[0] || is[1], "edge {edge}: {:?}, not of {wanted:?}", pixel(copy, middle));
            num_strong += usize::from(is[0]);
        }
        assert!(num_strong >= 7, "edges before the points: {num_strong}");
        let num_changed = image.iter().zip(copy).filter(|(a, b)| a != b).count();
        assert!(num_changed < image.len() / 6, "{num_changed} pixels changed");
    }
}

#[test]
fn nodes_are_cubes_in_their_places() {
    let octree = layered();
    let root = &octree.nodes[0];
    // The view is so far away that only the root is drawn.
    let view = at(&octree.cloud, 25.0);
    let detail = Detail { threshold_px: [200.0; 3], ..DETAIL };
    let options = DrawOptions { detail, ..options(Quality::Hqs, Dilate::Off) };
    let mut canvas = Canvas::layered(&octree, &view, options, gpu().atomics(), 0);
    let states = canvas.draw(&view).states;
    assert!(states[0] != 0 && states[1..].iter().all(|&state| state == 0), "only the root is drawn");
    let shown = show(&mut canvas, &view, Overlay::Nodes);
    assert_box(&shown, &view, root.min, DVec3::splat(root.edge), PALETTE[0]);
    // The root's parts are drawn too from nearer, each level in a color of its own.
    let near = DrawOptions { detail: Detail { threshold_px: [20.0; 3], ..DETAIL }, ..options };
    canvas.renderer.set_options(near).expect("room");
    let nearer = show(&mut canvas, &view, Overlay::Nodes);
    let num_green = |shown: &OverlaidEyes| {
        let both = shown.copies[0].iter().zip(&shown.images[0]);
        both.filter(|(copy, image)| is_near(**copy, over(**image, PALETTE[1], EDGE_ALPHA[0]))).count()
    };
    assert!(num_green(&shown) == 0 && num_green(&nearer) > 20, "{}", num_green(&nearer));
}

#[test]
fn precision_is_the_color_of_a_batchs_box() {
    let cloud = cloud_of(&random_points(9_000, 10.0, 11), 0.001, DVec3::new(5e5, 4e6, 100.0), Order::Morton);
    let [batch] = &cloud.batches[..] else { panic!("one batch") };
    let size = DVec3::from_array(batch.cell.map(f64::from)) * f64::from(1 << 30);
    let view = at(&cloud, 25.0);
    for (forced_planes, color) in [(0, PALETTE[0]), (2, PALETTE[1]), (3, PALETTE[2])] {
        let detail = Detail { forced_planes, ..DETAIL };
        let options = DrawOptions { detail, ..options(Quality::Hqs, Dilate::Off) };
        let shown = show(&mut Canvas::flat(&cloud, &view, options, 0), &view, Overlay::Precision);
        assert_box(&shown, &view, batch.min, size, color);
    }
}

#[test]
fn boxes_end_at_the_near_clip() {
    let octree = layered();
    // The view is in the middle of the cloud: every cube's edges pass beside or behind the eyes.
    let view = at(&octree.cloud, 0.01);
    let detail = Detail { threshold_px: [4000.0; 3], ..DETAIL };
    let options = DrawOptions { detail, ..options(Quality::Hqs, Dilate::Rings) };
    let mut canvas = Canvas::layered(&octree, &view, options, gpu().atomics(), 0);
    let shown = show(&mut canvas, &view, Overlay::Nodes);
    let changed = shown.images[0].iter().zip(&shown.copies[0]).filter(|(a, b)| a != b).count();
    assert!((20..shown.images[0].len() / 8).contains(&changed), "{changed} pixels changed");
}

/// Overlays bind the renderer's buffers once; they draw what new overlays would, whatever the renderer changes.
#[test]
fn overlays_follow_the_renderer() {
    let octree = layered();
    let view = at(&octree.cloud, 25.0);
    let rings = options(Quality::Hqs, Dilate::Rings);
    let mut canvas = Canvas::layered(&octree, &view, rings, gpu().atomics(), 0);
    let mut overlays = Overlays::new(&canvas.renderer).expect("overlays");
    let other = scan_of(&random_points(30_000, 10.0, 8), 0.001, DVec3::new(5e5, 4e6, 100.0));
    let other = octree_of(&other);
    let set_cloud = |canvas: &mut Canvas, octree: &Octree| {
        let buffers = CloudBuffers::upload_layered(&gpu(), octree, 0, &Progress::hidden()).expect("upload");
        canvas.renderer.set_cloud(buffers).expect("room");
    };
    let set_options =
        |canvas: &mut Canvas, options: DrawOptions| canvas.renderer.set_options(options).expect("room");
    type Change<'a> = (&'a str, &'a dyn Fn(&mut Canvas));
    let changes: [Change; 5] = [
        ("nothing", &|_| ()),
        ("the cloud", &|canvas| set_cloud(canvas, &other)),
        ("no dilation", &|canvas| set_options(canvas, options(Quality::Hqs, Dilate::Off))),
        ("dilation", &|canvas| set_options(canvas, rings)),
        ("the cloud again", &|canvas| set_cloud(canvas, &octree)),
    ];
    let mut before: Option<Vec<OverlaidEyes>> = None;
    for (what, change) in changes {
        change(&mut canvas);
        let mut all = Vec::new();
        for overlay in [Overlay::Depth, Overlay::Overdraw, Overlay::Nodes, Overlay::Precision] {
            let shown = show_with(&mut overlays, &mut canvas, &view, overlay);
            assert!(shown.copies == show(&mut canvas, &view, overlay).copies, "{overlay:?} after {what}");
            all.push(shown);
        }
        // The comparison can fail: each overlay shows which cloud it is.
        if let Some(before) = before.filter(|_| what.contains("cloud")) {
            assert!(before.iter().zip(&all).all(|(a, b)| a.copies != b.copies), "{what}");
        }
        before = Some(all);
    }
}
