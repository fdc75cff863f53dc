//! A scan arrives while frames are drawn: the root first, then run after run of nodes. No frame is missed for it, none is
//! empty, and the frame thread makes nothing on the GPU.

use base::space::{Fov, Pose};
use base::task::{CancelToken, Progress};
use cloud::octree::{Hierarchy, NodeBlock, build_nodes};
use glam::{DQuat, DVec3};
use kit::frames::{Canvas, gpu, octree_of, random_points, scan_of, stereo};
use lab::technique::LabTechnique;
use points::Scan;
use render::DrawOptions;
use render::gpu::{Gpu, readback};
use render::options::Quality;
use render::{CloudBuffers, CloudUpload, EyeImage};
use scanwalk::resolve::Plan;
use scanwalk::walk::action::Action;
use scanwalk::walk::filling::{Loaded, ScanRequest};
use scanwalk::walk::governor::GovernorOptions;
use scanwalk::walk::headsets::{CannotGoOn, Headsets};
use scanwalk::walk::link::WalkEnd;
use scanwalk::walk::locomotion::Start;
use scanwalk::walk::moving::Standpoint;
use scanwalk::walk::simulated::{SimulatedHeadset, SimulatedOptions};
use scanwalk::walk::start::start;
use scanwalk::walk::{Walk, WalkOptions, link};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::time::Duration;
use timing::FrameRow;
use xr::{ControllerInput, End, EyeImages, FrameState, Headset, StageEye};

const SIZE_PX: [u32; 2] = [97, 65];

fn scan() -> Scan {
    scan_of(&random_points(150_000, 10.0, 5), 0.001, DVec3::new(5e5, 4e6, 100.0))
}

/// Returns the scan's nodes, run after run.
fn runs(scan: &Scan) -> (Hierarchy, Vec<Vec<NodeBlock>>) {
    let mut runs = Vec::new();
    let hierarchy = build_nodes(scan, &Progress::hidden(), &mut |_, blocks| {
        runs.push(blocks);
        Ok::<(), cloud::BuildError>(())
    });
    (hierarchy.expect("an octree"), runs)
}

/// What lies in the GPU's memory: name, size, offset.
fn allocations(gpu: &Gpu) -> Vec<(String, u64, u64)> {
    let report = gpu.device.generate_allocator_report().expect("Vulkan's allocator reports");
    let mut all: Vec<_> = report.allocations.into_iter().map(|a| (a.name, a.size, a.offset)).collect();
    all.sort();
    all
}

/// The draw options of headsets.
fn options(quality: Quality) -> DrawOptions {
    DrawOptions { quality, ..Plan::default().draw.options }
}

#[test]
fn setting_a_cloud_makes_and_frees_nothing_on_the_gpu() {
    let scan = scan();
    // The test has a GPU of its own: other tests make and free what they like.
    let gpu = Arc::new(Gpu::open(None).expect("a Vulkan driver"));
    for quality in [Quality::Hqs, Quality::Closest] {
        let upload = || CloudBuffers::upload_layered(&gpu, &octree_of(&scan), 0, &Progress::hidden());
        let [one, other] = [upload().expect("upload"), upload().expect("upload")];
        let center = scan.bounds().center();
        let view = stereo(center - DVec3::new(4.0, 10.0, -3.0), center, SIZE_PX);
        let sizes = kit::frames::sizes(&view);
        let mut canvas =
            Canvas::on(Arc::clone(&gpu), &sizes, options(quality), gpu.atomics(), LabTechnique::OWN);
        canvas.renderer.set_cloud(one).expect("room");
        canvas.draw(&view);
        // This frame waits to be submitted, so what it uses cannot be freed and made anew unseen.
        let images =
            [0, 1].map(|_: i32| kit::frames::image(&gpu, SIZE_PX, wgpu::TextureFormat::Rgba8UnormSrgb));
        let views = images.each_ref().map(|image| image.create_view(&Default::default()));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let eyes = views.each_ref().map(|color| EyeImage { color, depth: None });
        canvas.renderer.record(&mut encoder, 1, &eyes);

        let before = allocations(&gpu);
        let one = canvas.renderer.set_cloud(other).expect("room").expect("the one before");
        assert_eq!(allocations(&gpu), before, "{quality:?}");
        // The count can fail: another background makes buffers.
        canvas.renderer.set_options(DrawOptions { background: [9, 9, 9], ..options(quality) }).expect("room");
        assert!(allocations(&gpu).len() > before.len());
        drop((one, encoder));
    }
}

/// Whatever has come is drawn as the whole octree is drawn while all other nodes count as not large enough.
#[test]
fn what_has_come_is_drawn() {
    let scan = scan();
    let (hierarchy, runs) = runs(&scan);
    let blocks: Vec<NodeBlock> = runs.into_iter().flatten().collect();
    assert!(blocks.len() > 8, "{}", blocks.len());
    let center = scan.bounds().center();
    let view = stereo(center - DVec3::new(4.0, 10.0, -3.0), center, SIZE_PX);
    // All nodes are large enough.
    let mut fine = options(Quality::Hqs);
    fine.detail.threshold_px = [1.0; 3];
    let silent = Progress::hidden();
    let device = gpu();
    let mut upload = CloudUpload::layered(&device, &hierarchy, 0, &silent).expect("room");
    let mut canvas = Canvas::new(&kit::frames::sizes(&view), fine, device.atomics());
    canvas.renderer.set_cloud(upload.buffers()).expect("room");
    let mut drawn = canvas.draw(&view);
    assert_eq!((drawn.visible.len(), canvas.renderer.resident().0), (0, 0), "nothing has come");
    let mut num_drawn = Vec::new();
    // Nodes come one by one, and several in one go.
    for part in [&blocks[..1], &blocks[1..2], &blocks[2..7], &blocks[7..]] {
        upload.write_blocks(&hierarchy, part).expect("room");
        drawn = canvas.draw(&view);
        let come = part.last().map_or(0, |block| block.node);
        let nodes = &hierarchy.nodes[..=come];
        let end = nodes.last().map_or(0, |node| node.first_point + node.num_points);
        assert!(drawn.visible.iter().all(|batch| batch.first_point < end));
        assert!(drawn.states[come + 1..].iter().all(|&state| state == 0));
        num_drawn.push(drawn.visible.len());
        let resident: u64 = nodes.iter().map(|node| u64::from(node.num_points)).sum();
        assert_eq!(canvas.renderer.resident().0, resident);
    }
    assert!(num_drawn.is_sorted() && num_drawn[0] > 0 && num_drawn[0] < num_drawn[3], "{num_drawn:?}");
    let whole = Canvas::layered(&octree_of(&scan), &view, fine, device.atomics(), 0).draw(&view);
    assert!(drawn.images == whole.images && drawn.visible == whole.visible, "all has come");
}

/// What the test's headset saw of a frame.
#[derive(Debug)]
struct SeenFrame {
    /// Pixels of both eyes that are not the background.
    num_lit: usize,
    /// Sum of their colors, to tell pictures apart.
    colors: u64,
}

/// A headset that reads back each frame before it asks for the next.
struct Witness {
    images: [wgpu::Texture; 2],
    display: i64,
    seen: SyncSender<SeenFrame>,
    ended: bool,
}

impl Headset for Witness {
    fn runtime(&self) -> String {
        "a test's".into()
    }
    fn eye_sizes(&self) -> [[u32; 2]; 2] {
        [SIZE_PX; 2]
    }
    fn refresh_hz(&self) -> f64 {
        72.0
    }
    fn image_format(&self) -> wgpu::TextureFormat {
        self.images[0].format()
    }
    fn wait(&mut self) -> FrameState {
        if self.ended {
            return FrameState::Ended(End::ByUser);
        }
        self.display += 1;
        let period_ns = 13_888_889;
        FrameState::Frame { predicted_display_ns: self.display * period_ns, period_ns, should_render: true }
    }
    fn input(&mut self) -> ControllerInput {
        ControllerInput::default()
    }
    fn acquire(&mut self) -> Option<EyeImages> {
        Some(EyeImages { color: self.images.clone(), depth: None })
    }
    fn locate(&mut self) -> [StageEye; 2] {
        let eye = |x: f64| StageEye {
            stage_from_view: Pose { position: DVec3::new(x, 1.6, 0.0), orientation: DQuat::IDENTITY },
            fov: Fov { left: -1.0, right: 1.0, up: 1.0, down: -1.0 },
            gaze_in_view: None,
        };
        [eye(-0.03), eye(0.03)]
    }
    fn submit(&mut self, commands: Option<wgpu::CommandEncoder>) {
        let Some(commands) = commands else { return };
        gpu().queue.lock().submit([commands.finish()]);
        let (mut num_lit, mut colors) = (0, 0);
        for image in &self.images {
            for pixel in readback::read_texture(&gpu(), image).expect("readback").chunks_exact(4) {
                num_lit += usize::from(pixel[..3] != [0; 3]);
                colors += pixel[..3].iter().map(|&c| u64::from(c)).sum::<u64>();
            }
        }
        // Sending fails once the test has seen enough.
        let _ = self.seen.send(SeenFrame { num_lit, colors });
    }
    fn request_exit(&mut self) {
        self.ended = true;
    }
}

impl Witness {
    fn new(seen: SyncSender<SeenFrame>) -> Self {
        let image = |_: i32| kit::frames::image(&gpu(), SIZE_PX, wgpu::TextureFormat::Rgba8UnormSrgb);
        Self { images: [0, 1].map(image), display: 0, seen, ended: false }
    }
}

/// A headset that no other follows, and the scan on its GPU.
struct Only<H> {
    gpu: Arc<Gpu>,
    headset: H,
    loaded: Option<Receiver<Loaded>>,
}

impl<H: Headset> Headsets for Only<H> {
    fn current(&mut self) -> (Arc<Gpu>, &mut dyn Headset) {
        (Arc::clone(&self.gpu), &mut self.headset)
    }
    fn take_filling(&mut self) -> Option<Receiver<Loaded>> {
        self.loaded.take()
    }
    fn has_another(&mut self) -> bool {
        false
    }
    fn open_scan(&mut self, _: Arc<ScanRequest>) {}
    fn look_now(&mut self) {}
    fn replace(&mut self, _: Option<&End>) -> Result<bool, CannotGoOn> {
        Ok(false)
    }
}

/// A walk without window, log, governor, limits, and anything beside the scan.
fn endless((actions, link): (Receiver<Action>, WalkEnd), stop: &CancelToken) -> Walk {
    let Plan { draw, walk, .. } = Plan::default();
    let governor = GovernorOptions { enabled: false, ..walk.governor };
    Walk {
        draw,
        options: WalkOptions { governor, shows_surround: false, ..walk },
        actions,
        link,
        mirrored: false,
        log: None,
        pose_path: None,
        max_frames: None,
        max_time: None,
        error_stays: Duration::ZERO,
        stop: stop.clone(),
    }
}

/// The rows and the pictures of a walk that shows nothing, then the root, then the octree.
fn walk(scan: &Scan) -> (Vec<FrameRow>, Vec<SeenFrame>) {
    let (hierarchy, runs) = runs(scan);
    let outside = start(&hierarchy.scene, 1.0, None);
    // The place is so near that the points fill the view.
    let place = scan.bounds().center() - DVec3::new(0.0, 6.0, 1.7);
    let standpoint = Standpoint { floor_in_world: place, ..outside.standpoint };
    let start = Start { standpoint, ..outside };
    let (frame_link, actions, viewer) = link::link(Plan::default().state_at_start().snapshot());
    let (loaded_sender, loaded) = channel();
    // The channel has no room: a frame ends when the test has taken it.
    let (seen_sender, seen) = sync_channel(0);
    let stop = CancelToken::default();
    let walk = endless((actions, frame_link), &stop);
    let mut pictures: Vec<SeenFrame> = Vec::new();
    std::thread::scope(|scope| {
        let frames = scope.spawn(move || {
            let headset = Witness::new(seen_sender);
            walk.run(&mut Only { gpu: gpu(), headset, loaded: Some(loaded) })
        });
        let mut see = |count: usize| pictures.extend(seen.iter().take(count));
        see(3);
        let (device, silent) = (gpu(), Progress::hidden());
        let mut upload = CloudUpload::layered(&device, &hierarchy, 0, &silent).expect("room");
        upload.write_blocks(&hierarchy, &runs[0]).expect("the root");
        loaded_sender
            .send(Loaded {
                cloud: upload.buffers(),
                start,
                starts: Arc::default(),
                floors: Arc::default(),
                stations: Vec::new(),
            })
            .expect("the walk goes on");
        see(12);
        for run in &runs[1..] {
            upload.write_blocks(&hierarchy, run).expect("more nodes");
        }
        see(12);
        stop.cancel();
        pictures.extend(seen.iter());
        frames.join().expect("no panic").expect("a walk");
    });
    (viewer.rows.try_iter().collect(), pictures)
}

/// Indices at which a value differs from the one before.
fn changes<T: PartialEq>(values: impl IntoIterator<Item = T>) -> Vec<usize> {
    let values: Vec<T> = values.into_iter().collect();
    (1..values.len()).filter(|&i| values[i] != values[i - 1]).collect()
}

#[test]
fn no_frame_is_missed_or_empty_while_nodes_arrive() {
    let scan = scan();
    let (rows, pictures) = walk(&scan);
    assert!(rows.iter().map(|row| row.frame).eq(0..pictures.len() as u64), "a row a frame");
    assert!(rows.iter().all(|row| row.missed_periods == 0));
    // The walk shows nothing, the root, then the octree: each change comes in a single frame, in the figures and in
    // the picture.
    let figures: Vec<_> = rows.iter().map(|row| (row.visible_nodes, row.points_read)).collect();
    let [shown, arrived] = changes(&figures)[..] else { panic!("{figures:?}") };
    assert_eq!(changes(pictures.iter().map(|seen| seen.colors)), [shown, arrived]);
    for (row, seen) in rows.iter().zip(&pictures) {
        let is_shown = row.frame >= shown as u64;
        assert_eq!(is_shown, row.visible_nodes > 0 && row.points_read > 1000, "{row:?}");
        // A missing picture would look like those before there is a cloud: they show nothing.
        assert_eq!(is_shown, seen.num_lit > SIZE_PX[0] as usize * SIZE_PX[1] as usize, "{seen:?}");
    }
    assert!(rows[arrived - 1].visible_nodes == 1 && rows[arrived].visible_nodes > 1);
    let resident = changes(rows.iter().map(|row| row.points_resident));
    assert!(resident.len() == 2 && rows.last().unwrap().points_resident == scan.num_points() as u64);
}

/// A lost device ends the headset with a reason that says so, in the frame that follows.
#[test]
fn a_lost_gpu_ends_the_headset_with_its_reason() {
    let gpu = Arc::new(Gpu::open(None).expect("a Vulkan driver"));
    assert_eq!(gpu.lost(), None);
    let options = SimulatedOptions { size_px: SIZE_PX, ..Plan::default().simulated };
    let (frame_link, actions, viewer) = link::link(Plan::default().state_at_start().snapshot());
    let (loaded_sender, loaded) = channel();
    let walk = endless((actions, frame_link), &CancelToken::default());
    let headset = SimulatedHeadset::new(&gpu, options);
    let mut only = Only { gpu: Arc::clone(&gpu), headset, loaded: Some(loaded) };
    let summary = std::thread::scope(|scope| {
        let frames = scope.spawn(|| walk.run(&mut only));
        viewer.rows.recv().expect("a frame");
        gpu.device.destroy();
        frames.join().expect("no panic").expect("a walk")
    });
    assert!(matches!(summary.ended, End::DeviceLost(_)), "{:?}", summary.ended);
    assert!(summary.ended.to_string().contains("the GPU was lost"), "{}", summary.ended);
    drop(loaded_sender);
}
