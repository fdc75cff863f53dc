//! The eyes see how far the scan is before it is there.

use base::space::{Eye, Fov, Pose};
use glam::{DQuat, DVec3};
use kit::frames::{gpu, image};
use render::gpu::readback;
use render::{EyeImage, Renderer, Setup};
use scanwalk::resolve::Plan;

const SIZE_PX: [u32; 2] = [160, 120];
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Both eyes' pixels of a frame without a scan, with the bar 2 m before the head, and with depth images, as headsets
/// take them.
fn seen(fraction: Option<f64>, turned_rad: f64) -> [Vec<[u8; 4]>; 2] {
    let gpu = gpu();
    let depth_format = wgpu::TextureFormat::Depth32Float;
    let setup = Setup {
        sizes_px: vec![SIZE_PX; 2],
        color_format: FORMAT,
        depth_format: Some(depth_format),
        atomics: gpu.atomics(),
    };
    let mut renderer = Renderer::new(&gpu, setup, Plan::default().draw.options).expect("a renderer");
    let eye = |x: f64| Eye {
        world_from_view: Pose {
            position: DVec3::new(x, 1.6, 0.0),
            orientation: DQuat::from_rotation_y(turned_rad),
        },
        fov: Fov { left: -0.9, right: 1.1, up: 0.8, down: -0.7 },
        size_px: SIZE_PX,
        gaze_in_view: Eye::AHEAD,
    };
    let bar = Pose { position: DVec3::new(0.0, 1.6, -2.0), orientation: DQuat::IDENTITY };
    renderer.set_waiting(&gpu.queue.lock(), &[eye(-0.03), eye(0.03)], 0.05, &bar, fraction);
    let images = [0, 1].map(|_: i32| image(&gpu, SIZE_PX, FORMAT));
    let depths = [0, 1]
        .map(|_: i32| gpu.texture("depth", SIZE_PX, depth_format, wgpu::TextureUsages::RENDER_ATTACHMENT));
    let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
    let (colors, depths) = (images.each_ref().map(view), depths.each_ref().map(view));
    let eyes = [0, 1].map(|eye: usize| EyeImage { color: &colors[eye], depth: Some(&depths[eye]) });
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    renderer.record(&mut encoder, 0, &eyes);
    gpu.queue.lock().submit([encoder.finish()]);
    images.map(|image| {
        let bytes = readback::read_texture(&gpu, &image).expect("an image");
        bytes.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2], pixel[3]]).collect()
    })
}

fn num_bright(pixels: &[[u8; 4]]) -> usize {
    pixels.iter().filter(|pixel| pixel[0] > 150).count()
}

#[test]
fn a_bar_fills_in_both_eyes() {
    let none = seen(None, 0.0);
    assert!(none.iter().flatten().all(|pixel| pixel[..3] == [0; 3]), "nothing goes on, so nothing is shown");
    let mut before = [0, 0];
    for fraction in [0.0, 0.4, 0.8] {
        let now = seen(Some(fraction), 0.0).map(|eye| num_bright(&eye));
        assert!(now[0] > before[0] && now[1] > before[1], "{fraction}: {now:?} after {before:?}");
        before = now;
    }
    // The bar is 0.8 m wide and 2 m away, and a tangent of 2 spans 160 pixels: it has 32 pixels, of which 80 % are
    // bright.
    let [left, _] = seen(Some(0.8), 0.0);
    let row = |y: usize| num_bright(&left[y * 160..(y + 1) * 160]);
    let widest = (0..120).map(row).max().expect("rows");
    assert!((24..=27).contains(&widest), "{widest} pixels of 26");
    // Nobody sees the bar when turned away by 90 or 180 degrees: nothing behind the head is drawn in front of it.
    for turned_rad in [1.6, std::f64::consts::PI] {
        assert!(seen(Some(0.8), turned_rad).iter().all(|eye| num_bright(eye) == 0));
    }
}
