//! Files to columns of points: formats hand over [`Block`]s, of which a [`Scan`] is made.
//!
//! Formats parse raw bytes in columns and in parallel, never trust a header's counts or boxes, and lose nothing that
//! can be read. A new format is one more entry in the list of [`formats`]; nothing else knows of formats.

mod axes;
mod block;
mod builder;
mod collect;
mod color;
mod coloring;
mod column;
mod column_names;
mod crs;
mod distribution;
mod earth;
mod error;
mod far;
mod formats;
mod grid;
mod guard;
pub mod info;
mod inputs;
mod intensity;
mod marks;
mod merged;
mod ramp;
mod read;
mod scene;
mod schema;
mod source;
mod station;
mod stats;
mod tally;
mod uncolored;
mod unit;
mod unpacked;
mod up;
mod white;
mod world;

pub use block::{Block, Trailer};
pub use builder::ScanBuilder;
pub use coloring::{ColorSource, Coloring};
pub use column::{Column, Type};
pub use column_names::ColumnNames;
pub use crs::{Angle, Axes};
pub use earth::{Geodetic, LocalFrame};
pub use error::ScanError;
pub use formats::{Dataset, OpenHints, Take, format_endings, format_names, is_named_as_scan, open};
pub use grid::Grid;
pub use marks::Marks;
pub use read::{peek, read};
pub use scene::Scene;
pub use schema::{Attribute, Field, Projection, Schema, Waveform};
pub use station::{PlacedStation, Station, StationKind};
pub use stats::Stats;
pub use uncolored::Blank;
pub use unit::Unit;
pub use up::{Evidence, Up, UpAxis};
pub use world::{Project, WorldFromFile};

use base::space::Bounds;
use std::path::PathBuf;

/// The points of one file in file order, one column per attribute, with values as the file stores them. Columns are
/// empty or as long as `xyz`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// Grid coordinates.
    pub xyz: Vec<[i32; 3]>,
    /// Red, green, blue (8 to 16 bits used; see [`Coloring`], which says how they are drawn).
    pub rgb: Vec<[u16; 3]>,
    /// Intensity.
    pub intensity: Vec<u16>,
    /// Unit normals, world axes, pointing to the side from which the surface was seen. NaN where a point has none.
    pub normals: Vec<[f32; 3]>,
    /// Points that are drawn and do not count for the scene: of a noise class, or withheld and shown all the same.
    pub noise: Marks,
    /// Points that the file says are withheld: deleted. They are in the columns only if they are to be shown.
    pub num_withheld: u64,
}

/// One file, read.
#[derive(Clone, Debug, Default)]
pub struct ScanFile {
    /// Path that it was read from.
    pub path: PathBuf,
    /// Name of the format, for people: "LAS 1.2, point format 3".
    pub format: String,
    /// Grid of `points.xyz`.
    pub grid: Grid,
    /// The points.
    pub points: Points,
    /// How the points get their colors.
    pub coloring: Coloring,
    /// True box of the points read, in world space.
    pub bounds: Bounds,
    /// Grid and box in the file's own coordinates.
    pub in_file: InFile,
    /// Conversion from the file's coordinates to the world's.
    pub world_from_file: WorldFromFile,
    /// Where it was measured and photographed from.
    pub stations: Vec<Station>,
    /// Triangles of a mesh: three point numbers in this file, each less than the number of its points,
    /// counter-clockwise where the surface is seen from. Empty for a file that is no mesh.
    pub triangles: Vec<[u32; 3]>,
}

/// Grid and box of a file's points in its own coordinates, which may differ from the world's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InFile {
    /// Grid of its coordinates.
    pub grid: Grid,
    /// Box of the points read.
    pub bounds: Bounds,
}

/// How files are read: what a user may say of them that they do not say themselves.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// Axis of the files that points up.
    pub up: Up,
    /// Unit of their lengths.
    pub unit: Unit,
    /// Unit of their heights, where it differs from that of lengths.
    pub vertical_unit: Unit,
    /// Which files lie on the earth.
    pub project: Project,
    /// True if a file that cannot be read, whole or in part, is an error although the rest can be read.
    pub strict: bool,
    /// True if points that are withheld, which means deleted, are read too.
    pub show_withheld: bool,
    /// What the columns of text files are.
    pub columns: ColumnNames,
}

impl ReadOptions {
    /// Files are taken for what they say of themselves. The settings begin with it.
    pub const AS_FILES_SAY: Self = Self {
        up: Up::Auto,
        unit: Unit::Auto,
        vertical_unit: Unit::Auto,
        project: Project::Auto,
        strict: false,
        show_withheld: false,
        columns: ColumnNames::AS_FILES_SAY,
    };

    /// What is needed to open a file.
    #[must_use]
    pub fn hints(&self) -> OpenHints {
        OpenHints { columns: self.columns.clone() }
    }
}

/// Several files as one cloud.
#[derive(Clone, Debug, Default)]
pub struct Scan {
    /// The files in the order given.
    pub files: Vec<ScanFile>,
    /// Sentences for people about what was odd, each naming its file.
    pub warnings: Vec<String>,
    /// Coordinate reference system, as the files name it.
    pub crs: Option<String>,
    /// Meters per world unit, where the files or the user say so.
    pub unit_m: Option<f64>,
    /// The scan's points without strays; empty until they are found.
    pub scene: Scene,
    /// Meters per unit of the files' lengths across, where the files or the user say so.
    pub unit_in_file_m: Option<f64>,
}

impl Scan {
    /// A scan of these files, about which nothing else is known.
    #[must_use]
    pub fn of(files: Vec<ScanFile>) -> Self {
        Self { files, ..Self::default() }
    }

    /// Number of points of all files.
    #[must_use]
    pub fn num_points(&self) -> usize {
        self.files.iter().map(|f| f.points.xyz.len()).sum()
    }

    /// Box of all files, in world space.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.files.iter().fold(Bounds::EMPTY, |b, f| b.union(f.bounds))
    }

    /// Box of all files, in their own coordinates.
    #[must_use]
    pub fn bounds_in_file(&self) -> Bounds {
        self.files.iter().fold(Bounds::EMPTY, |b, f| b.union(f.in_file.bounds))
    }

    /// Conversion from the files' coordinates (the first file's, if they differ) to the world's.
    #[must_use]
    pub fn world_from_file(&self) -> WorldFromFile {
        self.files.first().map(|file| file.world_from_file).unwrap_or_default()
    }
}

/// What a file says of itself, known before its points are read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Header {
    /// Path of the file.
    pub path: PathBuf,
    /// Name of the format, for people: "LAS 1.2, point format 3".
    pub format: String,
    /// Points that are to be expected; only [`read()`] knows how many there are.
    pub num_points: u64,
    /// What is stored for each point beside its place.
    pub schema: Schema,
    /// What the file has beside points, in words: "faces: 2".
    pub parts: Vec<String>,
    /// Where it was measured and photographed from, in the file's order.
    pub stations: Vec<Station>,
    /// True if its points are the middles of Gaussian splats.
    pub is_splats: bool,
    /// Coordinate reference system.
    pub crs: Option<String>,
    /// Meters per unit of x and y.
    pub unit_m: Option<f64>,
    /// Meters per unit of height, where that is stated by itself.
    pub vertical_unit_m: Option<f64>,
    /// What x, y and z are.
    pub axes: Option<Axes>,
    /// True if the format stores whole steps of a grid that its writer chose, which tells how exact coordinates are.
    pub is_on_fixed_grid: bool,
    /// The axis that points up, where that is evident from the header.
    pub up: Option<Evidence>,
    /// Program that wrote the file.
    pub software: Option<String>,
    /// Day on which it was written, "2024-05-09".
    pub created: Option<String>,
    /// Sentences about what was odd, whose subject is the file.
    pub warnings: Vec<String>,
}

impl Header {
    /// Names of what the file has, for a short list: attributes of its points, and what there is beside points.
    #[must_use]
    pub fn attributes(&self) -> Vec<String> {
        self.schema.names().into_iter().chain(self.parts.iter().cloned()).collect()
    }
}

/// Largest coordinate that is read: far larger than any planet, and f32 still holds its square.
pub const FARTHEST: f64 = 1e15;
