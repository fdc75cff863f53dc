//! What the walks look at: a made-up courtyard, and a red ball close before the viewer.

use base::space::Pose;
use glam::DVec3;
use kit::las_files::las_bytes;
use kit::rows::LogRows;
use kit::{made_up, spread};
use lab::synth::{self, SynthKind};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Eye distance of the test headset in meters.
pub const EYE_DISTANCE: f64 = 0.063;

/// Number of points of the courtyard.
const NUM_POINTS: u64 = 400_000;

pub struct ViewedScans {
    pub courtyard: PathBuf,
    pub ball: PathBuf,
    /// A path file that holds the head at `head`.
    pub pose_path: PathBuf,
    pub head: Pose,
    pub target: DVec3,
    folder: tempfile::TempDir,
}

impl ViewedScans {
    /// Returns the scene, which is made once a test program.
    pub fn get() -> &'static ViewedScans {
        static SCENE: OnceLock<ViewedScans> = OnceLock::new();
        SCENE.get_or_init(ViewedScans::make)
    }

    fn make() -> ViewedScans {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let courtyard = folder.path().join("courtyard.las");
        made_up::file(&courtyard, SynthKind::Terrestrial, NUM_POINTS, 1).expect("a courtyard");
        let place = synth::viewpoints(SynthKind::Terrestrial)
            .iter()
            .find(|v| v.name == "court")
            .expect("a viewpoint");
        let head = Pose::look_at(place.eye, place.target, DVec3::Z);
        let forward = (place.target - place.eye).normalize();
        let ball = folder.path().join("ball.las");
        write_ball(&ball, place.eye + 0.6 * forward);
        let pose_path = folder.path().join("held.csv");
        let (p, q) = (head.position, head.orientation);
        let line = format!("0,{},{},{},{},{},{},{}\n", p.x, p.y, p.z, q.x, q.y, q.z, q.w);
        std::fs::write(&pose_path, line).expect("the pose path");
        ViewedScans { courtyard, ball, pose_path, head, target: place.target, folder }
    }

    /// A file of that name that goes with the tests.
    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}

/// Writes a ball of 3 cm, pure red, which nothing else in the scene is. A ball of one value alone would count as not
/// colored.
fn write_ball(path: &Path, center: DVec3) {
    let mut header = las::Builder::from((1, 2));
    header.point_format = las::point::Format::new(2).expect("format 2");
    let scale = 0.0001;
    let axis = |offset: f64| las::Transform { scale, offset: offset.round() };
    header.transforms = las::Vector { x: axis(center.x), y: axis(center.y), z: axis(center.z) };
    let points = spread::directions(20_000).enumerate().map(|(step, direction)| {
        let p = center + 0.03 * direction;
        let color = Some(las::Color { red: 65535 - (step % 2) as u16, green: 0, blue: 0 });
        las::Point { x: p.x, y: p.y, z: p.z, color, ..Default::default() }
    });
    std::fs::write(path, las_bytes(header, points)).expect("the ball is written");
}

/// Number of frames in a log that is being written that are of the walk and have all points of the courtyard: while
/// nodes still arrive, a picture may stay for some frames and change afterwards.
pub fn num_whole(log: &Path) -> usize {
    let Some(rows) = LogRows::so_far(log) else { return 0 };
    let (phases, resident) = (rows.column("phase"), rows.column("points_resident"));
    let all = NUM_POINTS.to_string();
    phases.iter().zip(resident).filter(|(phase, resident)| **phase == "walking" && *resident == all).count()
}
