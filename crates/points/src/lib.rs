//! Files to columns of points: one reader a format, all handing over a [`Scan`].
//!
//! Readers parse raw bytes in columns and in parallel, never trust a header's counts or boxes, and lose
//! nothing that can be read. A new format is one more [`Format`] in [`FORMATS`]; nothing else knows of formats.

mod axes;
mod color;
mod crs;
mod distribution;
mod earth;
mod error;
mod far;
mod guard;
pub mod info;
mod inputs;
mod intensity;
mod las;
mod marks;
mod merged;
mod ply;
mod read;
mod scene;
mod sniff;
mod source;
mod stats;
mod uncolored;
mod unit;
mod up;
mod white;
mod world;

pub use crs::{Angle, Axes};
pub use earth::{Geodetic, LocalFrame};
pub use error::ScanError;
pub use marks::Marks;
pub use read::{peek, read};
pub use scene::Scene;
pub use uncolored::Blank;
pub use unit::Unit;
pub use up::{Evidence, Up, UpAxis};
pub use world::{Project, WorldFromFile};

use base::space::Bounds;
use base::task::Progress;
use glam::DVec3;
use source::Source;
use stats::Stats;
use std::path::PathBuf;

/// The integer grid of a file's coordinates: `p_in_world = offset + scale · xyz`, exactly as LAS stores it, and as
/// readers choose it for formats that store other numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// World units a step, an axis; finite and not zero.
    pub scale: DVec3,
    /// World position of the lattice's origin; finite.
    pub offset: DVec3,
}

impl Default for Lattice {
    /// Whole units from the origin.
    fn default() -> Self {
        Self { scale: DVec3::ONE, offset: DVec3::ZERO }
    }
}

impl Lattice {
    /// World position of a lattice point.
    #[must_use]
    pub fn p_in_world(&self, xyz: [i32; 3]) -> DVec3 {
        self.offset + self.scale * DVec3::new(f64::from(xyz[0]), f64::from(xyz[1]), f64::from(xyz[2]))
    }
}

/// The points of one file, a column an attribute, in file order. Columns are empty or as long as `xyz`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// Lattice coordinates.
    pub xyz: Vec<[i32; 3]>,
    /// Red, green, blue as stored (8 to 16 bits used; see [`ColorSource`]); but points that have the [`Blank`] are grey,
    /// and those of fewer bits in a merged file are as bright as the others.
    pub rgb: Vec<[u16; 3]>,
    /// Intensity as stored.
    pub intensity: Vec<u16>,
    /// Unit normals, world axes, pointing to the side from which the surface was seen. NaN where a point has none.
    pub normals: Vec<[f32; 3]>,
    /// Points that are drawn and do not count for the scene: of a noise class, or withheld and shown all the same.
    pub noise: Marks,
    /// Points that the file says are withheld: deleted. They are in the columns only if they are to be shown.
    pub num_withheld: u64,
}

impl Points {
    /// Points that were read, in the columns or left out as withheld.
    #[must_use]
    pub fn num_read(&self, show_withheld: bool) -> u64 {
        self.xyz.len() as u64 + if show_withheld { 0 } else { self.num_withheld }
    }
}

/// Where a file's point colours come from; decided once the whole file (for ramps: the whole scan) is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColorSource {
    /// `rgb` holds 8-bit values.
    Rgb8,
    /// `rgb` holds 10-bit values; 8-bit colour = round(c · 255 / 1023).
    Rgb10,
    /// `rgb` holds 12-bit values; 8-bit colour = round(c · 255 / 4095).
    Rgb12,
    /// `rgb` holds 16-bit values; 8-bit colour = round(c / 257).
    Rgb16,
    /// No colour: intensity through the ramp, `low..=high` of the scan.
    Intensity {
        /// Value at the dark end.
        low: f64,
        /// Value at the bright end.
        high: f64,
    },
    /// Neither: height (world z) through the ramp, `low..=high` of the scan.
    Height {
        /// Height at the dark end.
        low: f64,
        /// Height at the bright end.
        high: f64,
    },
}

impl Default for ColorSource {
    /// By height, of no range yet.
    fn default() -> Self {
        Self::Height { low: 0.0, high: 0.0 }
    }
}

/// One file, read.
#[derive(Clone, Debug, Default)]
pub struct ScanFile {
    /// Where it came from.
    pub path: PathBuf,
    /// For people: "LAS 1.2, point format 3".
    pub format: String,
    /// Grid of `points.xyz`.
    pub lattice: Lattice,
    /// The points.
    pub points: Points,
    /// Their colours.
    pub color: ColorSource,
    /// The color that stands for none.
    pub blank: Option<Blank>,
    /// True box of the points read, world space.
    pub bounds: Bounds,
    /// How the file has them.
    pub in_file: InFile,
    /// What was done to its coordinates.
    pub world_from_file: WorldFromFile,
    /// Triangles of a mesh, of point numbers in this file, each less than the number of its points; counter-clockwise
    /// where the surface is seen from. Empty for all that is no mesh.
    pub triangles: Vec<[u32; 3]>,
}

/// A file's points in its own coordinates, where the world's are others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InFile {
    /// Grid of its coordinates.
    pub lattice: Lattice,
    /// Box of the points read.
    pub bounds: Bounds,
}

/// How files are read: what a user may say of them that they do not say themselves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Axis of the files that points up.
    pub up: Up,
    /// Unit of their lengths.
    pub unit: Unit,
    /// Unit of their heights, where it is another.
    pub vertical_unit: Unit,
    /// Which files lie on the earth.
    pub project: Project,
    /// Whether a file that cannot be read, or of which a part cannot, is an error although the rest can.
    pub strict: bool,
    /// Points that are withheld, which means deleted, are read too.
    pub show_withheld: bool,
}

/// Several files as one cloud.
#[derive(Clone, Debug, Default)]
pub struct Scan {
    /// In the order given.
    pub files: Vec<ScanFile>,
    /// Sentences for people about what was odd, each naming its file.
    pub warnings: Vec<String>,
    /// Coordinate reference system, as the files name it.
    pub crs: Option<String>,
    /// Metres a world unit where the files or the user say so.
    pub unit_m: Option<f64>,
    /// What a viewer means by it; empty until it is found.
    pub scene: Scene,
    /// Metres a unit of the files' lengths across, where they or the user say so.
    pub unit_in_file_m: Option<f64>,
}

impl Scan {
    /// Points of all files.
    #[must_use]
    pub fn num_points(&self) -> usize {
        self.files.iter().map(|f| f.points.xyz.len()).sum()
    }

    /// Box of all files, world space.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.files.iter().fold(Bounds::EMPTY, |b, f| b.union(f.bounds))
    }

    /// Box of all files, in their own coordinates.
    #[must_use]
    pub fn bounds_in_file(&self) -> Bounds {
        self.files.iter().fold(Bounds::EMPTY, |b, f| b.union(f.in_file.bounds))
    }

    /// From the coordinates of the files, of the first if they differ, to those of the world.
    #[must_use]
    pub fn world_from_file(&self) -> WorldFromFile {
        self.files.first().map(|file| file.world_from_file).unwrap_or_default()
    }
}

/// What a file says of itself, known before its points are read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Header {
    /// Where it came from.
    pub path: PathBuf,
    /// For people: "LAS 1.2, point format 3".
    pub format: String,
    /// Points that are to be expected; only [`read()`] knows how many there are.
    pub num_points: u64,
    /// Names of what is stored for each point beside its place.
    pub attributes: Vec<String>,
    /// Coordinate reference system.
    pub crs: Option<String>,
    /// Metres a unit of x and y.
    pub unit_m: Option<f64>,
    /// Metres a unit of height, where that is stated by itself.
    pub vertical_unit_m: Option<f64>,
    /// What the coordinates are.
    pub axes: Option<Axes>,
    /// True if the format stores whole steps of a grid that its writer chose, which tells how exact coordinates are.
    pub is_on_fixed_grid: bool,
    /// The axis that points up, where that is evident from the header.
    pub up: Option<Evidence>,
    /// Program that wrote the file.
    pub software: Option<String>,
    /// Day on which it was written, "2024-05-09".
    pub created: Option<String>,
    /// What was odd, as sentences whose subject is the file.
    pub warnings: Vec<String>,
}

/// One file format.
trait Format: Sync {
    /// True if a file that starts with `head` (up to [`HEAD_BYTES`]) is of this format.
    fn recognises(&self, head: &[u8]) -> bool;

    /// Reads and checks the header.
    fn open(&self, source: Source) -> Result<Box<dyn Reader>, ScanError>;
}

/// An opened file.
trait Reader {
    /// What it says of itself.
    fn header(&self) -> &Header;

    /// Reads all points that can be read; at least one.
    fn read(&self, options: &ReadOptions, progress: &Progress) -> Result<Columns, ScanError>;
}

/// The points of a file and what was learnt on the way.
#[derive(Debug)]
struct Columns {
    /// Grid of the points' coordinates.
    lattice: Lattice,
    points: Points,
    /// See [`ScanFile::triangles`].
    triangles: Vec<[u32; 3]>,
    stats: Stats,
    /// The largest that a color can be, where the reader knows it.
    white: Option<u16>,
    /// What the file has or announces and could not be read, as sentences whose subject is the file.
    losses: Vec<String>,
    /// What else was odd, likewise.
    warnings: Vec<String>,
}

impl Default for Columns {
    fn default() -> Self {
        let (lattice, points) = (Lattice::default(), Points::default());
        Self {
            lattice,
            points,
            triangles: Vec::new(),
            stats: Stats::EMPTY,
            white: None,
            losses: Vec::new(),
            warnings: Vec::new(),
        }
    }
}

/// Largest coordinate: far more than any planet, and f32 still holds its square.
pub const FARTHEST: f64 = 1e15;
/// All formats that can be read.
const FORMATS: [&dyn Format; 2] = [&las::Las, &ply::Ply];
/// Bytes from a file's start that tell its format.
const HEAD_BYTES: u64 = 512;
