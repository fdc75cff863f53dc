//! What picture to draw, and why there may be none.

use crate::draw::{CannotDraw, no_gpu};
use base::output::{Output, OutputError};
use base::space::Fov;
use base::task::Cancelled;
use cloud::BuildError;
use glam::DVec3;
use points::{Scan, ScanError};
use render::gpu::GpuError;
use render::gpu::readback::ReadbackError;
use render::{RendererError, UploadError};
use std::path::PathBuf;

/// What is wrong with an eye and a target at one place.
pub(super) const NO_DIRECTION: &str = "--eye and --target are the same place: the camera has no direction";

/// What picture to draw.
#[derive(Clone, Debug)]
pub struct PictureOptions {
    /// Files, shown as one cloud.
    pub scans: Vec<PathBuf>,
    /// A picture for each eye: one, or two with `stereo`.
    pub out: Vec<Output>,
    /// Where the camera stands, in the files' coordinates; None: where it sees the whole scan.
    pub eye: Option<DVec3>,
    /// Where it looks, in the files' coordinates; None: the scan's center.
    pub target: Option<DVec3>,
    /// Which way is up, along the files' axes; None: what is up in the world.
    pub up: Option<DVec3>,
    /// How much is seen.
    pub fov: PictureFov,
    /// Width, height in pixels.
    pub size_px: [u32; 2],
    /// True for two eyes, `ipd` apart along the camera's right, both looking the same way.
    pub stereo: bool,
    /// Distance of the eyes in meters.
    pub ipd: f64,
    /// Linear depth of each eye as NumPy float32 (H, W), +inf where there is no point; empty if it is not wanted.
    pub depth: Vec<Output>,
    /// Figures as JSON.
    pub metrics: Option<Output>,
}

impl PictureOptions {
    /// Checks what can be told without the scan.
    ///
    /// # Errors
    /// A size or field of view that shows nothing, an upward direction of no length, eye and target at one place.
    pub fn check(&self) -> Result<(), PictureError> {
        let [width, height] = self.size_px;
        let fov = self.fov.left(self.size_px);
        let has_fov = fov.right > fov.left && fov.up > fov.down;
        let problem = if width == 0 || height == 0 {
            format!("--size {width}x{height}: a picture needs at least one pixel")
        } else if !has_fov || !fov.right.is_finite() || !fov.up.is_finite() {
            format!("the field of view {:?} shows nothing", self.fov)
        } else if self.up == Some(DVec3::ZERO) {
            "--up 0,0,0 is no direction: give one, for example 0,0,1".into()
        } else if self.eye.is_some() && self.eye == self.target {
            NO_DIRECTION.into()
        } else {
            return Ok(());
        };
        Err(PictureError::Usage(problem))
    }

    /// The same picture, asked for in the world's coordinates rather than the files'.
    pub(super) fn in_world(&self, scan: &Scan) -> Self {
        let world_from_file = scan.world_from_file();
        let place = |p: Option<DVec3>| p.map(|p_in_file| world_from_file.p_in_world(p_in_file));
        Self {
            eye: place(self.eye),
            target: place(self.target),
            up: self.up.map(|up_in_file| world_from_file.direction_in_world(up_in_file)),
            ipd: self.ipd / scan.unit_m.unwrap_or(1.0),
            ..self.clone()
        }
    }
}

/// A picture's field of view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PictureFov {
    /// Vertical angle in degrees; pixels are square.
    Vertical(f64),
    /// Half angles of the left eye in degrees, as a headset's eyes have them: outwards (left), inwards (right), up,
    /// down. The right eye mirrors them.
    HalfAngles([f64; 4]),
}

impl PictureFov {
    /// Field of view of the left (or only) eye.
    pub(super) fn left(self, [width, height]: [u32; 2]) -> Fov {
        match self {
            Self::Vertical(deg) => Fov::symmetric(deg.to_radians(), f64::from(width) / f64::from(height)),
            Self::HalfAngles(deg) => {
                let [outward, inward, up, down] = deg.map(f64::to_radians);
                Fov::from_angles(-outward, inward, up, -down)
            }
        }
    }
}

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The options show nothing.
    #[error("{0}")]
    Usage(String),
    /// There is no GPU that can be used.
    #[error("{}", no_gpu(.0))]
    Gpu(#[from] GpuError),
    /// The scan cannot be read.
    #[error(transparent)]
    Scan(#[from] ScanError),
    /// No cloud comes of the scan.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The cloud cannot be sent to the GPU.
    #[error(transparent)]
    Upload(#[from] UploadError),
    /// The settings ask for what the GPU does not have.
    #[error(transparent)]
    Draw(#[from] CannotDraw),
    /// The picture is larger than the GPU can draw.
    #[error("--size {width}x{height}: this GPU draws at most {most} pixels a side")]
    Size {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
        /// Pixels that either may be.
        most: u32,
    },
    /// The picture does not fit into the GPU's memory, or what is to be drawn is not to be had.
    #[error(transparent)]
    Renderer(#[from] RendererError),
    /// The GPU draws no frame, or gives none back.
    #[error(transparent)]
    Readback(#[from] ReadbackError),
    /// The GPU measured no frame.
    #[error("the GPU gave no frame back")]
    NoFrame,
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// Somebody asked for an end.
    #[error("{0}; nothing was kept")]
    Cancelled(#[from] Cancelled),
}
