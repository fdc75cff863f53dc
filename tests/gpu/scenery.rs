//! The stage `scenery`: surround, shapes and vignette are seen as the CPU reference has them; points cover the surround, and
//! what stands behind points is faint.

use base::space::{Eye, Fov, Pose, View};
use base::srgb::{linear_of_step, srgb_from_linear};
use glam::{DQuat, DVec3};
use kit::frames::{Canvas, gpu, image, scan_of};
use lab::reference::scenery::{self as reference, CardPicture, SceneryFrame};
use render::gpu::readback;
use render::layout::SceneryUniform;
use render::scenery::{SceneryView, Shapes, Surround, uniform_of};
use render::{EyeImage, Renderer, Setup};
use scanwalk::resolve::Plan;

const SIZE_PX: [u32; 2] = [240, 200];
const SURROUND: Surround =
    Surround { sky: [20, 40, 90], horizon: [90, 90, 100], ground: [60, 40, 20], grid: Some([200, 210, 220]) };

/// An eye 1.6 m above the floor that looks `down_rad` below the horizon, and `left_rad` to the left.
fn eye(x: f64, down_rad: f64, left_rad: f64) -> Eye {
    let orientation = DQuat::from_rotation_y(left_rad) * DQuat::from_rotation_x(-down_rad);
    Eye {
        world_from_view: Pose { position: DVec3::new(x, 1.6, 0.0), orientation },
        fov: Fov { left: -0.9, right: 1.1, up: 0.8, down: -0.7 },
        size_px: SIZE_PX,
        gaze_in_view: Eye::AHEAD,
    }
}

fn view(eyes: &[Eye]) -> SceneryView<'_> {
    let stage_from_grid =
        Pose { position: DVec3::new(0.3, 0.0, 12.6), orientation: DQuat::from_rotation_y(0.4) };
    SceneryView { eyes, near_m: 0.05, units_per_m: 1.0, stage_from_grid, vignette: 0.0 }
}

/// Both eyes' pixels of a frame without a scan.
fn drawn(view: &SceneryView, surround: Option<Surround>, shapes: &Shapes) -> [Vec<[u8; 4]>; 2] {
    let gpu = gpu();
    let color_format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let depth_format = wgpu::TextureFormat::Depth32Float;
    let (sizes_px, atomics) = (vec![SIZE_PX; 2], gpu.atomics());
    let setup = Setup { sizes_px, color_format, depth_format: Some(depth_format), atomics };
    let mut renderer = Renderer::new(&gpu, setup, Plan::default().draw.options).expect("a renderer");
    renderer.show_scenery(surround).expect("scenery");
    let images = [0, 1].map(|_: i32| image(&gpu, SIZE_PX, color_format));
    let depths = [0, 1]
        .map(|_: i32| gpu.texture("depth", SIZE_PX, depth_format, wgpu::TextureUsages::RENDER_ATTACHMENT));
    let of = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
    let (colors, depths) = (images.each_ref().map(of), depths.each_ref().map(of));
    let eyes = [0, 1].map(|eye: usize| EyeImage { color: &colors[eye], depth: Some(&depths[eye]) });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    renderer.record(&mut encoder, 0, &eyes);
    let queue = gpu.queue.lock();
    renderer.set_scenery(&queue, view, shapes);
    queue.submit([encoder.finish()]);
    drop(queue);
    images.map(|image| pixels(&readback::read_texture(&gpu, &image).expect("an image")))
}

fn pixels(bytes: &[u8]) -> Vec<[u8; 4]> {
    bytes.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2], pixel[3]]).collect()
}

/// Linear light in steps of the image.
fn srgb(linear: f32) -> f64 {
    255.0 * srgb_from_linear(f64::from(linear))
}

/// Largest difference of a channel from the reference, in steps of the image.
fn largest_difference(pixels: &[[u8; 4]], view: &SceneryView, eye: usize) -> f64 {
    let uniform = uniform_of(view, &view.eyes[eye], Some(SURROUND), false);
    let mut largest = 0.0f64;
    for (number, pixel) in pixels.iter().enumerate() {
        let (x, y) = (number % SIZE_PX[0] as usize, number / SIZE_PX[0] as usize);
        let want = reference::surround(&uniform, [x as f32 + 0.5, y as f32 + 0.5]);
        for (got, want) in pixel.iter().zip(want) {
            largest = largest.max((f64::from(*got) - srgb(want)).abs());
        }
    }
    largest
}

#[test]
fn the_surround_equals_its_reference() {
    for (down_rad, left_rad) in [(0.3, 0.0), (-0.6, 2.0), (1.2, -1.0)] {
        let eyes = [-0.03, 0.03].map(|x| eye(x, down_rad, left_rad));
        let view = view(&eyes);
        let both = drawn(&view, Some(SURROUND), &Shapes::default());
        for (number, pixels) in both.iter().enumerate() {
            let difference = largest_difference(pixels, &view, number);
            assert!(difference < 2.0, "down {down_rad}: {difference} steps");
        }
        // The comparison can fail: the eyes see different pictures where the floor is near.
        let other = largest_difference(&both[1], &view, 0);
        assert!(down_rad < 1.0 || other > 20.0, "{other}");
    }
}

#[test]
fn without_a_surround_nothing_is_seen() {
    let eyes = [-0.03, 0.03].map(|x| eye(x, 0.3, 0.0));
    let none = drawn(&view(&eyes), None, &Shapes::default());
    assert!(none.iter().flatten().all(|pixel| *pixel == [0, 0, 0, 255]));
}

#[test]
fn the_vignette_darkens_the_edge_of_sight_alone() {
    let eyes = [-0.03, 0.03].map(|x| eye(x, 0.0, 0.0));
    let [plain, _] = drawn(&view(&eyes), Some(SURROUND), &Shapes::default());
    let [dark, _] = drawn(&SceneryView { vignette: 1.0, ..view(&eyes) }, Some(SURROUND), &Shapes::default());
    // The axis meets the image at 0.9 / 2 of its width and 0.8 / 1.5 of its height.
    let at = |x: usize, y: usize| y * SIZE_PX[0] as usize + x;
    assert_eq!(plain[at(108, 107)], dark[at(108, 107)]);
    assert_eq!(dark[at(0, 0)], [0, 0, 0, 255]);
    assert_ne!(plain[at(0, 0)], dark[at(0, 0)]);
}

/// A wall of white points 3 m before the head that reaches from 1 m to the left of the eyes to their axis.
fn wall_before(eyes: &[Eye; 2]) -> (Canvas, View) {
    // World: x right, y forward, z up.
    let wall: Vec<[i32; 3]> =
        (0..200).flat_map(|x| (0..200).map(move |z| [5 * x - 1000, 3000, 10 * z - 1000 + 1600])).collect();
    let scan = scan_of(&wall, 0.001, DVec3::ZERO);
    let world_from_stage = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let of_world = |eye: &Eye| Eye {
        world_from_view: Pose {
            position: world_from_stage * eye.world_from_view.position,
            orientation: world_from_stage * eye.world_from_view.orientation,
        },
        ..*eye
    };
    let in_world = View { eyes: eyes.iter().map(of_world).collect(), near: 0.05 };
    let cloud = cloud::build(&scan, &base::task::Progress::hidden()).expect("a cloud");
    (Canvas::flat(&cloud, &in_world, Plan::default().draw.options, 0), in_world)
}

#[test]
fn points_cover_the_surround_and_what_is_behind_them() {
    let eyes = [-0.03, 0.03].map(|x| eye(x, 0.0, 0.0));
    let (mut canvas, in_world) = wall_before(&eyes);
    let plain = canvas.draw(&in_world);
    canvas.renderer.show_scenery(Some(SURROUND)).expect("scenery");
    // A red band before the wall, a green one behind it; both go on where no wall is.
    let mut shapes = Shapes::default();
    let head = DVec3::new(0.0, 1.6, 0.0);
    let mut band = |height: f64, away: f64, color: [f32; 4]| {
        let ends = [-0.3, 0.3].map(|x| DVec3::new(x * away, 1.6 + height * away, -away));
        shapes.band(ends, 0.05 * away, head, [color; 2]);
    };
    band(0.1, 2.0, [1.0, 0.0, 0.0, 1.0]);
    band(-0.1, 4.0, [0.0, 1.0, 0.0, 1.0]);
    let view = SceneryView { eyes: &eyes, ..view(&eyes) };
    let drawn = canvas.draw_with(&in_world, |renderer, queue| renderer.set_scenery(queue, &view, &shapes));
    let left = pixels(bytemuck::cast_slice(&drawn.images[0]));
    // Columns a sixth of a tangent left and right of the axis; the rows of the bands and between them.
    let [wall_x, open_x] = [-0.15, 0.15].map(|t: f64| ((0.9 + t) / 2.0 * 240.0) as usize);
    let row = |t: f64| ((0.8 - t) / 1.5 * 200.0) as usize;
    let at = |x: usize, t: f64| left[row(t) * 240 + x];
    let wall = |t: f64| pixels(bytemuck::cast_slice(&plain.images[0]))[row(t) * 240 + wall_x];
    assert_eq!(at(wall_x, 0.0), wall(0.0), "the wall");
    assert_eq!(at(wall_x, 0.1)[..3], [255, 0, 0], "before the wall");
    assert_eq!(at(open_x, 0.1)[..3], [255, 0, 0]);
    assert_eq!(at(open_x, -0.1)[..3], [0, 255, 0]);
    let ([r, g, b, _], [wall_r, wall_g, wall_b, _]) = (at(wall_x, -0.1), wall(-0.1));
    let is_faint = r < wall_r.max(1) && g > wall_g && g < 200 && b <= wall_b;
    assert!(is_faint, "behind the wall {:?}: {:?}", [wall_r, wall_g, wall_b], [r, g, b]);
    let uniform = uniform_of(&view, &eyes[0], Some(SURROUND), true);
    let want = reference::surround(&uniform, [open_x as f32 + 0.5, row(0.0) as f32 + 0.5]).map(srgb);
    let got = at(open_x, 0.0);
    assert!((0..3).all(|c| (f64::from(got[c]) - want[c]).abs() < 2.0), "{got:?} {want:?}");
}

/// Pixels of the card's picture, which is smooth: GPUs mix its pixels in steps of 1/256.
const CARD_PX: [u32; 2] = [16, 8];

/// Shows a card, and gives its picture in linear light.
fn show_card(canvas: &mut Canvas) -> CardPicture {
    let [width, height] = CARD_PX;
    let color = |x: u32, y: u32| [40 + 8 * x, 200 - 9 * x, 90 + 12 * y].map(|c| c as u8);
    let rgb: Vec<[u8; 3]> = (0..height).flat_map(|y| (0..width).map(move |x| color(x, y))).collect();
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = canvas.gpu.texture("card", CARD_PX, wgpu::TextureFormat::Rgba8UnormSrgb, usage);
    let bytes: Vec<u8> = rgb.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255]).collect();
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
    let queue = canvas.gpu.queue.lock();
    queue.for_uploads().write_texture(texture.as_image_copy(), &bytes, layout, texture.size());
    drop(queue);
    canvas.renderer.set_card(Some(&texture));
    let rgb = rgb.iter().map(|rgb| rgb.map(|c| linear_of_step(c) as f32).into()).collect();
    CardPicture { width: width as usize, rgb }
}

/// What becomes of a pixel's color over which a color is blended, as images hold it.
fn blended(below: [u8; 3], [r, g, b, alpha]: [f32; 4]) -> [u8; 3] {
    let rgb = [r, g, b];
    std::array::from_fn(|c| {
        let mixed = f64::from(rgb[c] * alpha) + linear_of_step(below[c]) * f64::from(1.0 - alpha);
        srgb(mixed as f32).round() as u8
    })
}

/// Shapes of all kinds, before the wall, behind it, and where no wall is.
fn all_kinds_of_shapes() -> Shapes {
    let mut shapes = Shapes::default();
    let head = DVec3::new(0.0, 1.6, 0.0);
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, 1.6 + y, -z);
    // Some are partly behind the eyes, or reach through the wall.
    shapes.band(
        [at(-2.0, 0.5, 4.0), at(2.0, 0.3, 2.0)],
        0.3,
        head,
        [[1.0, 0.2, 0.1, 0.8], [0.1, 0.3, 1.0, 0.4]],
    );
    shapes.band([at(0.3, -0.6, -1.0), at(-0.5, -0.4, 5.0)], 0.2, head, [[0.3, 0.9, 0.2, 0.7]; 2]);
    shapes.marks(|shapes| shapes.ring(at(-0.3, -0.1, 4.0), DVec3::Z, [0.3, 0.6], [0.9, 0.8, 0.1, 0.9]));
    shapes.ring(at(0.6, 0.2, 2.0), DVec3::new(0.6, 0.8, 0.0), [0.2, 0.5], [0.2, 0.9, 0.9, 1.0]);
    shapes.tube([at(-0.8, -0.8, 2.5), at(0.8, -0.7, 2.0)], [0.1, 0.05], [0.8, 0.6, 0.5, 1.0]);
    shapes.quadrangle([at(0.1, 0.5, 1.5), at(0.4, 0.5, 1.5), at(0.4, 0.7, 1.5), at(0.1, 0.7, 1.5)], [0.5; 4]);
    let card = |x: f64, away: f64, turn: f64| Pose {
        position: at(x, 0.0, away),
        orientation: DQuat::from_rotation_y(turn),
    };
    shapes.card(&card(-0.9, 3.4, 0.5), [1.5, 0.8]);
    shapes.card(&card(1.2, 2.5, -0.9), [1.2, 0.6]);
    shapes
}

/// What comparing an eye's pixels with the reference has found.
struct SceneryCheck {
    /// Share of the pixels that were compared.
    share: f64,
    /// Pixels a channel of which differs by more steps of the image than there are layers.
    num_wrong: usize,
    /// Largest difference of a channel in steps of the image.
    largest: u8,
}

/// Compares an eye's pixels, of which `plain` have nothing beside the scan.
///
/// A layer may win or lose a step: the image holds whole steps after each, and blending, encoding, and the mixing of a
/// card's pixels are the hardware's and not of f32.
fn check(got: &[[u8; 4]], plain: &[[u8; 4]], depths: &[[u32; 2]], frame: &SceneryFrame) -> SceneryCheck {
    let (mut num, mut check) = (0, SceneryCheck { share: 0.0, num_wrong: 0, largest: 0 });
    for (number, got) in got.iter().enumerate() {
        let (x, y) = (number as u32 % SIZE_PX[0], number as u32 / SIZE_PX[0]);
        let Some(layers) = frame.layers([x, y], depths[number][0]) else { continue };
        let num_layers = layers.iter().filter(|layer| layer[3] > 0.0).count();
        let [r, g, b, _] = plain[number];
        let want = layers.into_iter().fold([r, g, b], blended);
        let difference = (0..3).map(|c| got[c].abs_diff(want[c])).max().unwrap_or(0);
        num += 1;
        check.num_wrong += usize::from(usize::from(difference) > num_layers);
        check.largest = check.largest.max(difference);
    }
    check.share = f64::from(num) / got.len() as f64;
    check
}

#[test]
fn shapes_and_the_vignette_equal_their_reference() {
    let shapes = all_kinds_of_shapes();
    for (vignette, down_rad) in [(0.4, 0.0), (0.7, 0.25)] {
        let eyes = [-0.03, 0.03].map(|x| eye(x, down_rad, 0.1));
        let (mut canvas, in_world) = wall_before(&eyes);
        let plain = canvas.draw(&in_world);
        canvas.renderer.show_scenery(Some(SURROUND)).expect("scenery");
        let card = show_card(&mut canvas);
        let view = SceneryView { vignette, ..view(&eyes) };
        let drawn =
            canvas.draw_with(&in_world, |renderer, queue| renderer.set_scenery(queue, &view, &shapes));
        let image = |images: &[Vec<u32>], eye: usize| pixels(bytemuck::cast_slice(&images[eye]));
        for eye in [0, 1] {
            let (got, below) = (image(&drawn.images, eye), image(&plain.images, eye));
            let uniform = uniform_of(&view, &eyes[eye], Some(SURROUND), true);
            let frame =
                SceneryFrame { uniform: &uniform, size_px: SIZE_PX, corners: shapes.corners(), card: &card };
            let compare = |frame: &SceneryFrame| check(&got, &below, &drawn.pixels[eye], frame);
            let SceneryCheck { share, num_wrong, largest } = compare(&frame);
            eprintln!("eye {eye}: {share:.3} of the pixels, up to {largest} steps");
            assert!(
                share > 0.9 && num_wrong == 0 && largest < 4,
                "eye {eye}: {num_wrong} pixels, {largest} steps"
            );
            // The comparison can fail: each part of the scenery is seen in it, and where it is seen from.
            let other_eye = uniform_of(&view, &eyes[1 - eye], Some(SURROUND), true);
            let without_vignette = SceneryUniform { vignette: 0.0, ..uniform };
            let nearer = SceneryUniform { units_per_m: 0.5, ..uniform };
            for uniform in [other_eye, without_vignette, nearer] {
                assert!(compare(&SceneryFrame { uniform: &uniform, ..frame }).largest > 20, "{uniform:?}");
            }
            let gray = CardPicture { rgb: vec![glam::Vec3::splat(0.5); card.rgb.len()], width: card.width };
            assert!(compare(&SceneryFrame { card: &gray, ..frame }).largest > 20);
        }
    }
}
