//! Scans that no file holds, for tests and measurements.

use crate::coloring::{ColorSource, Coloring};
use crate::{Grid, InFile, Marks, Scan, ScanFile, WorldFromFile};
use base::space::Bounds;
use std::path::PathBuf;

/// A file in the making: points, and what is said of them.
#[derive(Clone, Debug)]
#[must_use]
pub struct ScanBuilder(ScanFile);

impl ScanBuilder {
    /// A file of points on a grid, colored by height.
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

    /// Sets the path that the file seems to come from.
    pub fn path(mut self, path: impl Into<PathBuf>) -> Self {
        self.0.path = path.into();
        self
    }

    /// Sets colors of 8 bits, by which the file is drawn.
    pub fn rgb(mut self, rgb: Vec<[u16; 3]>) -> Self {
        self.0.points.rgb = rgb;
        self.color(ColorSource::Rgb8)
    }

    /// Sets what the file is drawn by: another column, or colors of more bits.
    pub fn color(mut self, source: ColorSource) -> Self {
        self.0.coloring = Coloring::by(source);
        self
    }

    /// Sets the intensities.
    pub fn intensity(mut self, intensity: Vec<u16>) -> Self {
        self.0.points.intensity = intensity;
        self
    }

    /// Sets the unit normals.
    pub fn normals(mut self, normals: Vec<[f32; 3]>) -> Self {
        self.0.points.normals = normals;
        self
    }

    /// Sets which points are noise.
    pub fn noise(mut self, noise: Marks) -> Self {
        self.0.points.noise = noise;
        self
    }

    /// Sets triangles between the points.
    pub fn triangles(mut self, triangles: Vec<[u32; 3]>) -> Self {
        self.0.triangles = triangles;
        self
    }

    /// Sets the conversion from the file's coordinates to the world's.
    pub fn world_from_file(mut self, world_from_file: WorldFromFile) -> Self {
        self.0.world_from_file = world_from_file;
        self
    }

    /// Returns the file.
    #[must_use]
    pub fn file(self) -> ScanFile {
        self.0
    }

    /// Returns a scan of this file alone.
    #[must_use]
    pub fn scan(self) -> Scan {
        Scan::of(vec![self.0])
    }
}
