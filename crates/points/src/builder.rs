//! Scans of points that no file holds: what tests and measurements are made of.

use crate::coloring::{ColorSource, Coloring};
use crate::{Grid, InFile, Marks, Scan, ScanFile, WorldFromFile};
use base::space::Bounds;
use std::path::PathBuf;

/// A file in the making: points, and what is said of them.
#[derive(Clone, Debug)]
#[must_use]
pub struct ScanBuilder(ScanFile);

impl ScanBuilder {
    /// Points on a grid, colored by height.
    pub fn new(grid: Grid, xyz: Vec<[i32; 3]>) -> Self {
        let bounds = xyz.iter().fold(Bounds::EMPTY, |bounds, &p| bounds.with(grid.p_in_world(p)));
        let mut file = ScanFile {
            path: "made-up".into(),
            format: "made up".into(),
            grid,
            bounds,
            in_file: InFile { grid, bounds },
            ..ScanFile::default()
        };
        file.points.xyz = xyz;
        Self(file)
    }

    /// Where it seems to come from.
    pub fn path(mut self, path: impl Into<PathBuf>) -> Self {
        self.0.path = path.into();
        self
    }

    /// Colors of 8 bits, which it is drawn by.
    pub fn rgb(mut self, rgb: Vec<[u16; 3]>) -> Self {
        self.0.points.rgb = rgb;
        self.color(ColorSource::Rgb8)
    }

    /// Another column that it is drawn by, or colors of more bits.
    pub fn color(mut self, source: ColorSource) -> Self {
        self.0.coloring = Coloring::by(source);
        self
    }

    /// Intensities.
    pub fn intensity(mut self, intensity: Vec<u16>) -> Self {
        self.0.points.intensity = intensity;
        self
    }

    /// Unit normals.
    pub fn normals(mut self, normals: Vec<[f32; 3]>) -> Self {
        self.0.points.normals = normals;
        self
    }

    /// Which points are noise.
    pub fn noise(mut self, noise: Marks) -> Self {
        self.0.points.noise = noise;
        self
    }

    /// Triangles between the points.
    pub fn triangles(mut self, triangles: Vec<[u32; 3]>) -> Self {
        self.0.triangles = triangles;
        self
    }

    /// What was done to its coordinates.
    pub fn world_from_file(mut self, world_from_file: WorldFromFile) -> Self {
        self.0.world_from_file = world_from_file;
        self
    }

    /// The file.
    #[must_use]
    pub fn file(self) -> ScanFile {
        self.0
    }

    /// A scan of this file alone.
    #[must_use]
    pub fn scan(self) -> Scan {
        Scan::of(vec![self.0])
    }
}
