//! The painter on a GPU without a window, and the panel without either.

use super::controls::{Controls, PanelTab, WindowState};
use super::easel::PIXELS_PER_POINT;
use super::history::{History, tests::row};
use super::painter::{EguiPicture, Painter};
use super::{MirroredEyes, WindowOptions, card, help, keys, menu, notice, panel, style};
use crate::walk::action::{Action, Stance};
use crate::walk::appearance::QualityPreset;
use crate::walk::kind::ScanKind;
use crate::walk::link::{HeadsetState, LoadState, MirrorImages};
use crate::walk::moving::Turn;
use crate::walk::state::Snapshot;
use base::task::Done;
use render::gpu::Gpu;
use render::options::Overlay;
use std::time::Instant;
use timing::{FrameRow, STAGES};
use wgpu::TextureFormat;

/// Edge of the test images in pixels: a gray ramp of every 8-bit value, 16 × 16, and its negative for the other eye.
const EDGE: u32 = 16;

fn texture(gpu: &Gpu, format: TextureFormat, usage: wgpu::TextureUsages) -> wgpu::Texture {
    gpu.texture("ramp", [EDGE; 2], format, usage)
}

fn ramps(gpu: &Gpu) -> MirrorImages {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    MirrorImages::whole([0u8, 255].map(|flip| {
        let image = texture(gpu, TextureFormat::Rgba8UnormSrgb, usage);
        let pixels: Vec<u8> = (0..=255u8).flat_map(|v| [v ^ flip, v ^ flip, v ^ flip, 255]).collect();
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * EDGE), rows_per_image: None };
        gpu.queue.lock().for_uploads().write_texture(image.as_image_copy(), &pixels, layout, image.size());
        image
    }))
}

/// The first channel of each pixel after mirroring `images` into a picture of their own size.
fn mirrored(gpu: &Gpu, images: &MirrorImages, mirror: MirroredEyes, format: TextureFormat) -> Vec<u8> {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
    let target = texture(gpu, format, usage);
    let nothing = EguiPicture { primitives: Vec::new(), textures: Default::default(), pixels_per_point: 1.0 };
    let view = target.create_view(&Default::default());
    let mut painter = Painter::with_mirror(&gpu.device, format).expect("a painter");
    let commands = painter
        .record(gpu, &view, [EDGE, EDGE], Some((images, mirror)), nothing)
        .expect("nobody else has the queue");
    let row_bytes = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT;
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row_bytes * EDGE),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        target.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        target.size(),
    );
    gpu.queue.lock().submit(commands.into_iter().chain([encoder.finish()]));
    buffer.slice(..).map_async(wgpu::MapMode::Read, |mapped| mapped.unwrap());
    gpu.poll(wgpu::PollType::wait_indefinitely()).unwrap();
    let bytes = buffer.slice(..).get_mapped_range().unwrap();
    let row = |y: u32| (0..EDGE).map(move |x| (y * row_bytes + 4 * x) as usize);
    (0..EDGE).flat_map(row).map(|at| bytes[at]).collect()
}

#[test]
fn the_mirror_keeps_every_8_bit_value() {
    let gpu = Gpu::open(None).unwrap();
    let images = ramps(&gpu);
    let ramp: Vec<u8> = (0..=255).collect();
    let negative: Vec<u8> = (0..=255).rev().collect();
    for format in [TextureFormat::Bgra8Unorm, TextureFormat::Rgba8Unorm, TextureFormat::Bgra8UnormSrgb] {
        assert_eq!(mirrored(&gpu, &images, MirroredEyes::Left, format), ramp, "{format:?}");
        assert_eq!(mirrored(&gpu, &images, MirroredEyes::Right, format), negative, "{format:?}");
    }
    // The comparison can fail: side by side each eye has half of the pixels.
    assert_ne!(mirrored(&gpu, &images, MirroredEyes::Both, TextureFormat::Bgra8Unorm), ramp);
}

#[test]
fn the_mirror_shows_only_what_is_drawn() {
    let gpu = Gpu::open(None).unwrap();
    let whole = ramps(&gpu);
    let (across, down) = (8, 4);
    let part = MirrorImages { drawn_px: [[across, down]; 2], ..whole.clone() };
    let corners = |images: &MirrorImages| {
        let shown = mirrored(&gpu, images, MirroredEyes::Left, TextureFormat::Rgba8Unorm);
        [shown[0], shown[shown.len() - 1]]
    };
    // The part is twice as wide as high: it covers the square window and loses a quarter on either side. Nothing is
    // mixed in at the bottom from the row below.
    let [first, last] = corners(&part);
    assert!((1..4).contains(&first), "{first}");
    assert!((EDGE * (down - 1) + 4..EDGE * (down - 1) + 7).contains(&u32::from(last)), "{last}");
    assert_eq!(corners(&whole), [0, 255]);
}

/// Every word that one egui pass paints.
fn painted(contents: impl FnMut(&mut egui::Ui)) -> String {
    fn collect(shape: &egui::Shape, words: &mut String) {
        match shape {
            egui::Shape::Text(text) => *words += &format!("{}\n", text.galley.text()),
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, words)),
            _ => {}
        }
    }
    let context = egui::Context::default();
    style::apply(&context);
    let mut contents = contents;
    let size = egui::vec2(1280.0, 1200.0);
    let mut words = String::new();
    // The first pass of an area only measures it.
    for _ in 0..3 {
        let input = egui::RawInput {
            screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size)),
            ..Default::default()
        };
        let mut output = context.run_ui(input, &mut contents);
        // egui insists that its caller deals with its textures.
        output.textures_delta.clear();
        words.clear();
        output.shapes.iter().for_each(|clipped| collect(&clipped.shape, &mut words));
    }
    words
}

/// What is chosen when a hand points at this word of the menu, presses and lets go; and where the word is, in meters from the
/// menu's middle.
fn chosen(word: &str) -> (Vec<Action>, [f64; 2]) {
    let stance = Stance::sample();
    let state = Snapshot::sample();
    let snapshot = Snapshot { stance: Some(stance), menu: Some(1), ..state };
    let context = egui::Context::default();
    style::apply(&context);
    let size = egui::Vec2::from(menu::SIZE_PX.map(|px| px as f32 / PIXELS_PER_POINT));
    let screen_rect = Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size));
    let mut all = Vec::new();
    let mut pass = |events: Vec<egui::Event>| {
        let input = egui::RawInput { screen_rect, events, ..Default::default() };
        let mut output =
            context.run_ui(input, |ui| all.extend(menu::contents(ui, &snapshot, &stance, "SteamVR/OpenXR")));
        output.textures_delta.clear();
        output.shapes.iter().find_map(|clipped| match &clipped.shape {
            egui::Shape::Text(text) if text.galley.text() == word => {
                Some(text.visual_bounding_rect().center())
            }
            _ => None,
        })
    };
    pass(Vec::new());
    let pos = pass(Vec::new()).unwrap_or_else(|| panic!("no {word} in the menu"));
    let button = |pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    for event in [egui::Event::PointerMoved(pos), button(true), button(false)] {
        pass(vec![event]);
    }
    let [width, height] = crate::walk::menu::SIZE_M;
    let across = |at: f32, length: f32, meters: f64| (f64::from(at / length) - 0.5) * meters;
    (all, [across(pos.x, size.x, width), -across(pos.y, size.y, height)])
}

#[test]
fn the_menu_sends_what_is_chosen_in_it() {
    for (word, action) in [
        ("Back to the start", Action::Reset),
        ("As a model", Action::ShowModel),
        ("Fly", Action::ToggleWalking),
        ("Keep", Action::SavePlace),
        ("Next", Action::NextPlace),
        ("Faster", Action::Faster(2.0)),
        ("Seated", Action::ToggleSeated),
        ("Turns by steps", Action::SetTurn(Turn::Smooth)),
        ("Dark edge: some", Action::SetVignette(1.0)),
        ("Performance", Action::SetPreset(QualityPreset::Performance)),
        ("What the buttons do", Action::ToggleButtons),
        ("Close", Action::ToggleMenu(1)),
        ("Leave scanwalk", Action::Quit),
    ] {
        assert_eq!(chosen(word).0, [action], "{word}");
    }
    // All of it fits, and `tests/view/hands.rs` points at the last button.
    let (_, [x, y]) = chosen("Leave scanwalk");
    assert!((x - 0.05).abs() < 0.03 && (y + 0.168).abs() < 0.01, "{x} {y}");
}

#[test]
fn the_label_says_how_large_hands_make_the_scan() {
    assert!(painted(|ui| menu::label(ui, 0.08)).contains("1 : 12.5"));
}

#[test]
fn the_card_in_the_headset_says_how_far_loading_is_and_why_it_failed() {
    let reading = LoadState {
        doing: Some(Done { what: "reading", unit: "points", done: 1_000_000, total: 4_000_000 }),
        ..LoadState::default()
    };
    let words = painted(|ui| card::contents(ui, "castle.laz", &reading));
    for expected in ["castle.laz", "Reading", "25 %", "4.00 M points"] {
        assert!(words.contains(expected), "{expected}: {words}");
    }
    let failed = LoadState { error: Some("castle.laz: ends at byte 7".into()), ..reading };
    let words = painted(|ui| card::contents(ui, "castle.laz", &failed));
    assert!(words.contains("could not be loaded") && words.contains("ends at byte 7"), "{words}");
    assert!(words.contains("Take the headset off") && !words.contains("25 %"), "{words}");
}

fn panel_words(history: &History, load: &LoadState, overlay: Overlay) -> String {
    words_in(history, load, Snapshot { overlay, ..Snapshot::sample() })
}

fn words_in(history: &History, load: &LoadState, state: Snapshot) -> String {
    let headset =
        HeadsetState { device: "Some GPU".into(), runtime: "Monado 25".into(), ..HeadsetState::default() };
    let now = Instant::now();
    let options = WindowOptions::sample();
    let contents = panel::Contents {
        history,
        load,
        recent: &[],
        headset: &headset,
        widgets: &options.widgets,
        state,
        eye_px: Some([1440, 1600]),
        now,
    };
    let words = |tab| {
        let mut view = WindowState::new(&options);
        view.tab = tab;
        painted(|ui| assert_eq!(panel::show(ui, &contents, &mut view), []))
    };
    // Either tab, one after the other.
    words(PanelTab::Scan) + &words(PanelTab::Timing)
}

#[test]
fn the_panel_opens_with_the_scan_and_timing_is_a_tab() {
    let options = WindowOptions::sample();
    let load = LoadState { facts: vec![("Points".into(), "52 391 020".into())], ..Default::default() };
    let (history, headset) = (History::default(), HeadsetState::default());
    let contents = panel::Contents {
        history: &history,
        load: &load,
        recent: &[],
        headset: &headset,
        widgets: &options.widgets,
        state: Snapshot::sample(),
        eye_px: None,
        now: Instant::now(),
    };
    let mut view = WindowState::new(&options);
    let words = painted(|ui| _ = panel::show(ui, &contents, &mut view));
    assert!(words.contains("52 391 020") && !words.contains("frames / s"), "{words}");
    view.tab = PanelTab::Timing;
    let words = painted(|ui| _ = panel::show(ui, &contents, &mut view));
    assert!(!words.contains("52 391 020") && words.contains("frames / s"), "{words}");
}

#[test]
fn the_panel_tells_of_frames_scan_and_machine() {
    let mut history = History::default();
    for frame in 0..=180 {
        history.push(
            FrameRow { missed_periods: u32::from(frame == 7), ..row(frame, frame as f64 / 90.0, 8.0) },
            Instant::now(),
        );
    }
    let load = LoadState {
        facts: vec![("Points".into(), "52 391 020".into())],
        warnings: vec!["hall.laz: odd".into()],
        ..Default::default()
    };
    let words = panel_words(&history, &load, Overlay::Overdraw);
    assert!(words.contains("Not in the quality 'closest'"), "{words}");
    let words = panel_words(&history, &load, Overlay::Precision);
    let wanted = [
        "90",
        "1 missed",
        "budget 11.1 ms",
        "depth",
        "4.80 ms",
        "8.00 ms",
        "median",
        "8.00 M",
        "52.4 M",
        "800",
        "closest",
        "52 391 020",
        "hall.laz: odd",
        "Some GPU",
        "Monado 25",
        "1440 × 1600 px",
        "both",
        "×1",
        "20 green",
        "times above are without it",
    ];
    for text in wanted {
        assert!(words.lines().any(|line| line.contains(text)), "no '{text}' in:\n{words}");
    }
}

#[test]
fn the_panel_bears_having_nothing_to_tell() {
    let words = panel_words(&History::default(), &LoadState::default(), Overlay::None);
    assert!(words.contains("No frame yet") && !words.contains("Warnings"), "{words}");
    let mut silent = History::default();
    silent.push(
        FrameRow {
            stage_ms: [f32::NAN; STAGES.len()],
            gpu_ms: f32::NAN,
            budget_ms: f32::NAN,
            ..row(0, 0.0, 1.0)
        },
        Instant::now(),
    );
    let words = panel_words(&silent, &LoadState::default(), Overlay::None);
    assert!(words.contains("This GPU tells no times"), "{words}");
}

#[test]
fn the_panel_tells_how_the_user_is_in_the_scan() {
    let words_with = |stance| {
        let state = Snapshot { stance, ..Snapshot::sample() };
        words_in(&History::default(), &LoadState::default(), state)
    };
    let words = words_with(Some(Stance::sample()));
    for expected in ["interior", "walk on floors", "as large as life", "Fly", "Model", "Keep place"] {
        assert!(words.contains(expected), "{expected}: {words}");
    }
    assert!(!words.contains("Raised") && !words.contains("Next place"), "{words}");
    let (kind, scale) = (ScanKind::Landscape, 0.01);
    let model = Stance { kind, is_walking: false, scale, raised_m: -0.25, num_places: 3, ..Stance::sample() };
    let words = words_with(Some(model));
    for expected in ["landscape", "fly", "1 : 100", "-0.25 m", "3", "Walk", "Life size", "Next place"] {
        assert!(words.contains(expected), "{expected}: {words}");
    }
    assert!(!words_with(None).contains("Moving"), "nothing of a scan has come");
}

#[test]
fn the_help_lists_the_whole_table() {
    let mut view = WindowState::new(&WindowOptions { panel: false, ..WindowOptions::sample() });
    assert_eq!(painted(|ui| help::show(ui, &mut view)), "");
    let mut controls = Controls::new(view);
    controls.key(winit::keyboard::KeyCode::F1, true, Instant::now());
    let words = painted(|ui| help::show(ui, &mut controls.view));
    for binding in keys::BINDINGS {
        assert!(words.contains(binding.does), "{}", binding.does);
        assert!(binding.labels().iter().all(|label| words.lines().any(|line| line == label)), "{binding:?}");
    }
}

#[test]
fn notices_say_what_goes_on() {
    let sorting = Done { what: "sorting", unit: "points", done: 425_000, total: 1_000_000 };
    let mut load = LoadState { doing: Some(sorting), ..Default::default() };
    let words = painted(|ui| notice::show(ui, ui.ctx().content_rect(), &load, false, false));
    for expected in ["Sorting …", "42 %", "425 k of 1.00 M points"] {
        assert!(words.contains(expected), "{expected} is not in {words}");
    }
    // Progress goes on, in the words and in the bar.
    load.doing = Some(Done { done: 999_999, ..sorting });
    let words = painted(|ui| notice::show(ui, ui.ctx().content_rect(), &load, false, false));
    assert!(words.contains("99 %") && words.contains("1.00 M of 1.00 M points"), "{words}");
    load.error = Some("hall.laz: not a LAS file; choose another".into());
    let words = painted(|ui| notice::show(ui, ui.ctx().content_rect(), &load, true, true));
    assert!(words.contains("not a LAS file") && words.contains("Esc again") && !words.contains("Sorting"));
    // The header of a file may have claimed too few bytes; bytes have a unit of their own. Work that is not counted
    // has no figure.
    for (done, total, expected) in [(3 << 20, 2 << 20, "3.00 MiB of 2.00 MiB"), (0, 0, "über …")] {
        let doing = Some(Done { what: "über", unit: "bytes", done, total });
        let load = LoadState { doing, ..Default::default() };
        let words = painted(|ui| notice::show(ui, ui.ctx().content_rect(), &load, true, false));
        assert!(words.contains("über") && words.contains(expected), "{words}");
        assert_eq!(words.contains('%'), total > 0, "{words}");
    }
    assert_eq!(
        painted(|ui| notice::show(ui, ui.ctx().content_rect(), &LoadState::default(), true, false)),
        "",
        "nothing goes on any more"
    );
    let waiting = |headset: HeadsetState| painted(|ui| _ = notice::waiting(ui, &headset, false));
    let focused = HeadsetState { session: "FOCUSED", ..HeadsetState::default() };
    assert_eq!([waiting(focused.clone()), waiting(HeadsetState::default())], ["", ""]);
    let words = waiting(HeadsetState { session: "SYNCHRONIZED", ..focused.clone() });
    assert!(words.contains("Nobody wears the headset") && !words.contains("Look for it"), "{words}");
    let words = painted(|ui| _ = notice::waiting(ui, &focused, true));
    assert!(words.contains("does not answer") && words.contains("Esc"), "{words}");
    let simulated = HeadsetState { session: "simulated", ..HeadsetState::default() };
    assert_eq!(painted(|ui| _ = notice::waiting(ui, &simulated, true)), "", "a slow driver is no headset");
    let lost = Some("the headset was lost (LOSS_PENDING)".to_owned());
    let words = waiting(HeadsetState { session: "simulated", waiting_because: lost, ..focused });
    for said in ["Waiting for the headset", "LOSS_PENDING", "Look for it now"] {
        assert!(words.contains(said), "{said}: {words}");
    }
    let now = Instant::now();
    let told = Some((now, "Saved a.left.png".to_string()));
    let words = |at| painted(|ui| notice::told(ui, ui.ctx().content_rect(), told.as_ref(), at));
    assert!(words(now).contains("Saved a.left.png"));
    assert_eq!(words(now + std::time::Duration::from_secs(9)), "", "it is told once");
}

#[test]
fn all_words_of_the_menu_are_on_it() {
    let snapshot = Snapshot { stance: Some(Stance::sample()), menu: Some(1), ..Snapshot::sample() };
    let context = egui::Context::default();
    style::apply(&context);
    let size = egui::Vec2::from(menu::SIZE_PX.map(|px| px as f32 / PIXELS_PER_POINT));
    let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size);
    for runtime in ["SteamVR/OpenXR", "Oculus", "PICO", "Monado"] {
        // The words that reach beyond the menu, by how wide it is.
        let beyond = |screen: egui::Rect| {
            let input = egui::RawInput { screen_rect: Some(screen), ..Default::default() };
            let mut output = context.run_ui(input, |ui| {
                menu::contents(ui, &snapshot, &Stance::sample(), runtime);
            });
            output.textures_delta.clear();
            let words = output.shapes.iter().filter_map(|clipped| match &clipped.shape {
                egui::Shape::Text(text) => Some(text.visual_bounding_rect()),
                _ => None,
            });
            words.filter(|words| !screen.expand(0.5).contains_rect(*words)).count()
        };
        beyond(screen);
        assert_eq!(beyond(screen), 0, "{runtime}");
        let narrow = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(200.0, size.y));
        assert!(beyond(narrow) > 0, "what does not fit is noticed");
    }
}
