//! Made-up scans for demos, tests and benchmarks: the same seed gives the same bytes, everywhere.
//!
//! ```text
//!  SynthKind ──▶ MeasuringDevice (terrestrial | aerial | photogrammetry) ──lines──▶ file (LAS | LAZ)
//!                  │ plan: how many points each scan line has                          │ ordered blocks, one header
//!                  └ ray-casts a scene of analytic shapes                              └ temporary name, then renamed
//! ```
//!
//! Photogrammetry also makes meshes: the statue's surface as triangles, in a PLY file.
//!
//! A device hands over its points line by line, in the order in which a real one writes them. Every line has
//! its own stream of random numbers and its own exact share of the points, so lines are made in parallel and
//! the result depends neither on the number of threads nor on their timing. Arithmetic is IEEE `+ − × ÷ √`
//! and the `libm` crate only: the platform's own sine would differ in the last bit from machine to machine.

mod aerial;
mod bvh;
mod courtyard;
mod device;
mod file;
mod header;
mod landscape;
mod light;
mod material;
mod mesh;
mod photogrammetry;
mod plan;
mod ply;
mod record;
mod shape;
mod span;
mod statue;
mod terrestrial;

pub use file::{SCAN, SynthError, out_help};

use base::output::Output;
use base::space::Bounds;
use base::task::Task;
use glam::DVec3;

base::choice! {
    /// The kind of a scan: the device that made it.
    pub enum SynthKind {
        /// A courtyard, by a scanner on two stations: columns of rising elevation (LAS 1.4, point format 7).
        Terrestrial = "terrestrial",
        /// 1 km² of land with a village, from an aircraft: strips, up to three returns (LAS 1.4, point format 7).
        Aerial = "aerial",
        /// A statue, from photographs: dense, noisy, tile by tile (LAS 1.2, point format 2, 8-bit colors); or, as
        /// .ply, its mesh, smooth and complete.
        Photogrammetry = "photogrammetry",
    }
}

/// What to make.
#[derive(Clone, Debug)]
pub struct SynthOptions {
    /// Kind of scan.
    pub kind: SynthKind,
    /// File to write; `.las` or `.laz`, or for a mesh `.ply`.
    pub out: Output,
    /// Exact number of points, at least 1; of a mesh the approximate number, at least some 20 000.
    pub points: u64,
    /// Seed; the same seed gives the same bytes.
    pub seed: u64,
}

/// Figures of the file that was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrittenScan {
    /// Points written.
    pub num_points: u64,
    /// Size of the file.
    pub file_bytes: u64,
    /// True box of the points, in world space.
    pub bounds: Bounds,
}

/// A good place to stand in a made-up scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// A word or two in kebab case.
    pub name: &'static str,
    /// Position of the eye, in world space.
    pub eye: DVec3,
    /// Position that the eye looks at, in world space; up is +z.
    pub target: DVec3,
}

/// Places to stand in a scan of this kind, the same for every seed; the first shows the whole scan.
#[must_use]
pub fn viewpoints(kind: SynthKind) -> &'static [Viewpoint] {
    match kind {
        SynthKind::Terrestrial => &terrestrial::VIEWPOINTS,
        SynthKind::Aerial => &aerial::VIEWPOINTS,
        SynthKind::Photogrammetry => &photogrammetry::VIEWPOINTS,
    }
}

/// Makes a scan and writes it; memory does not grow with the number of points, except for a mesh.
///
/// # Errors
/// When the options make no sense, when the file cannot be written, and when the task was cancelled. In each
/// case nothing is left behind, and what was at `options.out` before is untouched.
pub fn write(options: &SynthOptions, task: impl Into<Task>) -> Result<WrittenScan, SynthError> {
    let progress = task.into().begin("making", "points", options.points);
    let SynthOptions { kind, points, seed, .. } = *options;
    let target = file::SynthFile::check(&options.out, kind, points)?;
    if target.is_mesh() {
        return target.write_mesh(points, seed, &progress);
    }
    match kind {
        SynthKind::Terrestrial => target.write(&terrestrial::Scanner::new(points), seed, &progress),
        SynthKind::Aerial => target.write(&aerial::Aircraft::new(points), seed, &progress),
        SynthKind::Photogrammetry => {
            target.write(&photogrammetry::Reconstruction::new(points), seed, &progress)
        }
    }
}
