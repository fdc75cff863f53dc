//! The child's side: the real window beside a stand-in for the frame thread, which paints a known pattern
//! into the mirror images at 30 Hz, offers rows, and prints the commands that come.

use super::fault;
use base::task::{CancelToken, Task};
use points::ReadOptions;
use render::gpu::Gpu;
use scanwalk::desktop::{Display, WindowOptions};
use scanwalk::resolve::Plan;
use scanwalk::walk::action::Action;
use scanwalk::walk::filling::ScanRequest;
use scanwalk::walk::link::{self, MirrorImages, WalkEnd};
use std::sync::Arc;
use std::time::{Duration, Instant};
use timing::FrameRow;

/// Pixels of an eye's image.
pub const EYE_PX: [u32; 2] = [480, 540];

/// sRGB colors of each eye's quarters: top left, top right, bottom left, bottom right.
pub const QUARTERS: [[[u8; 3]; 4]; 2] = [
    [[200, 30, 40], [20, 180, 60], [30, 60, 210], [127, 128, 129]],
    [[1, 2, 3], [250, 251, 252], [200, 100, 0], [0, 100, 200]],
];

/// What a test sends when the event of its child's role is to happen: the window has been seen by then.
const CUE: Action = Action::WholeView;

/// Time between two frames of the stand-in.
const PERIOD: Duration = Duration::from_micros(33_333);

/// Runs the window; `role` says what happens beside it. Prints "command …" lines and, last, "ended …".
pub fn play(role: &str) {
    let gpu = match Gpu::open(None) {
        Ok(gpu) => Arc::new(gpu),
        Err(error) => return println!("ended without a GPU: {error}"),
    };
    if role == "hazard" {
        fault::write_twice_without_a_barrier(&gpu);
        return println!("ended well");
    }
    let mut state = Plan::default().state_at_start();
    let (walk, actions, viewer) = link::link(state.snapshot());
    walk.set_gpu(&gpu);
    let scan = ScanRequest { files: vec!["hall.laz".into()], read: ReadOptions::AS_FILES_SAY, kind: None };
    walk.update_load(|load| load.scan = Some(Arc::new(scan)));
    walk.update_headset(|headset| headset.runtime = "simulated".into());
    let stop = CancelToken::default();
    let frames = std::thread::spawn({
        let (mut gpu, stop, role) = (Arc::clone(&gpu), stop.clone(), role.to_string());
        move || {
            let begin = Instant::now();
            prepare(&role, &walk);
            let mut images = (role != "broken" && role != "loading").then(|| images_on(&gpu));
            if let Some(images) = &images {
                walk.set_mirror(images.clone());
            }
            for frame in 0.. {
                let mut is_cued = false;
                for action in actions.try_iter() {
                    println!("command {action:?}");
                    is_cued |= action == CUE;
                    state.apply(action);
                }
                // What the window keeps from being published is published with the next frame.
                let _ = walk.try_publish(state.snapshot());
                if stop.is_cancelled() || (role == "vanish" && is_cued) {
                    return;
                }
                if role == "stop" && is_cued {
                    stop.cancel();
                }
                if role == "another" && is_cued {
                    // The walk has lost its GPU, and gets another.
                    gpu.device.destroy();
                    gpu = Arc::new(Gpu::open(None).expect("a GPU again"));
                    walk.set_gpu(&gpu);
                    let anew = images_on(&gpu);
                    walk.set_mirror(anew.clone());
                    images = Some(anew);
                    println!("command another GPU");
                }
                if let Some(images) = &images {
                    paint(&gpu, images);
                    walk.offer_row(row(frame, begin.elapsed().as_secs_f64()));
                }
                std::thread::sleep(PERIOD);
            }
        }
    });
    let options = WindowOptions { size: [960, 640], recent: false, ..Plan::default().window };
    let outcome = Display::open(&stop).and_then(|display| display.run(viewer, options, stop.clone()));
    // An error of the window ends the stand-in too.
    let stopped = stop.is_cancelled();
    stop.cancel();
    frames.join().expect("the stand-in for the frame thread");
    match outcome {
        Ok(()) => println!("ended well, stop requested: {stopped}"),
        Err(error) => println!("ended with: {error}"),
    }
}

fn prepare(role: &str, walk: &WalkEnd) {
    if role == "loading" {
        // 40 % of 52 million points are sorted.
        let observer = walk.clone();
        let task = Task::new(&CancelToken::default())
            .observed(move |count| observer.set_doing(Some(Arc::clone(count))));
        task.begin("sorting", "points", 52_391_020).add(20_956_408);
    }
    walk.update_load(|load| match role {
        "broken" => {
            load.error = Some("hall.laz: the header ends after 100 of 375 bytes; copy the file again".into());
        }
        "loading" => {}
        _ => {
            let facts = [
                ("Format", "LAS 1.4, point format 7"),
                ("Points", "52 391 020"),
                ("Size", "48.1 × 30.9 × 11.2 m"),
            ];
            load.facts = facts.map(|(name, value)| (name.into(), value.into())).to_vec();
            load.warnings = vec!["hall.laz: 12 points lie outside of the header's box; they are kept".into()];
        }
    });
}

fn images_on(gpu: &Gpu) -> MirrorImages {
    MirrorImages::whole([0, 1].map(|_: usize| {
        gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("mirror image"),
            size: wgpu::Extent3d { width: EYE_PX[0], height: EYE_PX[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        })
    }))
}

/// Paints the pattern once more, in a submit of its own, as the frame thread does.
fn paint(gpu: &Gpu, images: &MirrorImages) {
    let [width, height] = EYE_PX;
    let queue = gpu.queue.lock();
    for (image, quarters) in images.textures.iter().zip(QUARTERS) {
        let pixels: Vec<u8> = (0..height)
            .flat_map(|y| (0..width).map(move |x| (2 * (2 * y / height) + 2 * x / width) as usize))
            .flat_map(|quarter| {
                let [r, g, b] = quarters[quarter];
                [r, g, b, 255]
            })
            .collect();
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
        queue.for_uploads().write_texture(image.as_image_copy(), &pixels, layout, image.size());
    }
    queue.submit([]);
}

/// A frame that is near the budget, and over it every now and then.
fn row(frame: u64, time_s: f64) -> FrameRow {
    let wave = (frame as f32 * 0.13).sin() + 0.4 * (frame as f32 * 0.71).sin();
    let late = frame % 41 == 40;
    let depth_ms = 5.2 + 0.8 * wave + if late { 6.0 } else { 0.0 };
    let stage_ms = [0.31, 0.05, 0.42 + 0.1 * wave, 0.6 * depth_ms, 0.4 * depth_ms, 1.3 + 0.1 * wave, 0.2];
    FrameRow {
        frame,
        time_s,
        stage_ms,
        gpu_ms: stage_ms.iter().sum::<f32>() + 0.05,
        missed_periods: u32::from(late),
        visible_nodes: 1210 + frame as u32 % 7,
        ..FrameRow::sample()
    }
}
