//! Converts the files' coordinates to those of the world that is drawn: z up, one scale on all axes, lengths and no
//! angles.
//!
//! Files with lengths keep their stored integers: turning and scaling change the grid only. Files on the earth are put
//! onto a new grid, along axes east, north and up about the scan's middle that all files of the scan share.

use super::crs::{Angle, Axes};
use super::earth::{Geodetic, LocalFrame};
use super::grid::FittedGrid;
use super::up::{self, UpAxis};
use super::{Grid, Header, Marks, ReadOptions, Scan, ScanFile, axes, far, unit};
use base::space::Bounds;
use glam::{DVec3, Vec3Swizzles};
use rayon::prelude::*;

/// Units that differ by less are one: a foot and a US survey foot are, for what can be seen.
const SAME_UNIT: f64 = 1e-5;
/// Most points of a file that are looked at to find the scan's middle.
const MOST_SAMPLES: usize = 1 << 14;
/// Points that are a task for a core.
const BLOCK: usize = 1 << 16;

base::choice! {
    /// Which files are put from the earth onto axes east, north and up.
    pub enum Project {
        /// Files whose coordinate system says so, and files without one whose coordinates leave no doubt.
        Auto = "auto",
        /// No files, and coordinates are drawn as they are.
        Off = "off",
        /// All files, with x and y as longitude and latitude in degrees, whatever the files say.
        Degrees = "degrees",
        /// All files, with x, y and z as lengths from the earth's center, whatever the files say.
        Geocentric = "geocentric",
    }
}

/// How a file's coordinates become those of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WorldFromFile {
    /// Axes are exchanged and lengths are scaled.
    Axes {
        /// The file's axis that becomes z.
        up: UpAxis,
        /// World units per unit across.
        across_scale: f64,
        /// World units per unit of height.
        height_scale: f64,
    },
    /// Longitude, latitude and height.
    Geographic {
        /// Unit of x and y.
        angle: Angle,
        /// True if x is the latitude and y the longitude.
        latitude_first: bool,
        /// Meters per unit of z.
        height_m: f64,
        /// The world's axes.
        frame: LocalFrame,
    },
    /// Lengths from the earth's center.
    Geocentric {
        /// Meters per unit.
        unit_m: f64,
        /// The world's axes.
        frame: LocalFrame,
    },
}

impl Default for WorldFromFile {
    /// The file's coordinates as they are.
    fn default() -> Self {
        Self::Axes { up: UpAxis::Z, across_scale: 1.0, height_scale: 1.0 }
    }
}

impl WorldFromFile {
    /// Converts a place in the file to one in the world.
    #[must_use]
    pub fn p_in_world(&self, p_in_file: DVec3) -> DVec3 {
        match self {
            Self::Axes { across_scale, height_scale, .. } => {
                self.direction_in_world(p_in_file) * DVec3::new(*across_scale, *across_scale, *height_scale)
            }
            Self::Geographic { frame, .. } | Self::Geocentric { frame, .. } => {
                frame.p_in_local(self.axes().geocentric(p_in_file, self.scale()))
            }
        }
    }

    /// Converts a direction along the file's axes to one along the world's. Longitude, latitude and height are
    /// directions east, north and up.
    #[must_use]
    pub fn direction_in_world(&self, direction_in_file: DVec3) -> DVec3 {
        match self {
            Self::Axes { up, .. } => up.in_world(direction_in_file),
            Self::Geographic { latitude_first: false, .. } => direction_in_file,
            Self::Geographic { latitude_first: true, .. } => direction_in_file.yxz(),
            Self::Geocentric { frame, .. } => frame.direction_in_local(direction_in_file),
        }
    }

    fn axes(&self) -> Axes {
        match self {
            Self::Axes { .. } => Axes::Planar,
            Self::Geographic { angle, latitude_first: false, .. } => Axes::Geographic(*angle),
            Self::Geographic { angle, latitude_first: true, .. } => Axes::LatitudeFirst(*angle),
            Self::Geocentric { .. } => Axes::Geocentric,
        }
    }

    /// Meters per unit of length of a file on the earth; per unit of height, if it has angles.
    fn scale(&self) -> f64 {
        match self {
            Self::Axes { .. } => 1.0,
            Self::Geographic { height_m: scale, .. } | Self::Geocentric { unit_m: scale, .. } => *scale,
        }
    }
}

impl Axes {
    /// Converts coordinates on the earth to meters from the earth's center.
    fn geocentric(self, p_in_file: DVec3, unit_m: f64) -> DVec3 {
        let (angle, longitude, latitude) = match self {
            Self::Planar | Self::Geocentric => return p_in_file * unit_m,
            Self::Geographic(angle) => (angle, p_in_file.x, p_in_file.y),
            Self::LatitudeFirst(angle) => (angle, p_in_file.y, p_in_file.x),
        };
        let [longitude, latitude] = [longitude, latitude].map(|value| value * angle.radians());
        Geodetic { longitude, latitude, height_m: p_in_file.z * unit_m }.geocentric()
    }
}

/// Puts all files into one world, and says what was done that a user does not expect.
pub(super) fn place(scan: &mut Scan, headers: &[Header], options: &ReadOptions) {
    let axes: Vec<Axes> =
        scan.files.iter().zip(headers).map(|(file, header)| axes::of(file, header, options)).collect();
    let units: Vec<Units> =
        headers.iter().zip(&axes).map(|(header, &axes)| Units::of(header, axes, options)).collect();
    let on_earth = |at: &usize| axes[*at] != Axes::Planar;
    let projected: Vec<usize> = (0..scan.files.len()).filter(on_earth).collect();
    scan.unit_in_file_m = units.iter().find_map(|units| units.across_m);
    scan.unit_m = if projected.is_empty() { scan.unit_in_file_m } else { Some(1.0) };
    let middle = middle(projected.iter().map(|&at| (&scan.files[at], axes[at], units[at].scale(axes[at]))));
    let frame = LocalFrame::at(middle);
    let (ups, turned) = up::of_files(&scan.files, headers, &axes, options.up);
    for (at, file) in scan.files.iter_mut().enumerate() {
        let scale = units[at].scale(axes[at]);
        file.world_from_file = match axes[at] {
            Axes::Planar => {
                let [across_scale, height_scale] = units[at].planar(scan.unit_m);
                WorldFromFile::Axes { up: ups[at], across_scale, height_scale }
            }
            Axes::Geographic(angle) | Axes::LatitudeFirst(angle) => {
                let latitude_first = axes[at] == Axes::LatitudeFirst(angle);
                WorldFromFile::Geographic { angle, latitude_first, height_m: scale, frame }
            }
            Axes::Geocentric => WorldFromFile::Geocentric { unit_m: scale, frame },
        };
        match axes[at] {
            Axes::Planar => regrid(file),
            _ => {
                let num_far = project(file);
                let path = file.path.display();
                let sentence = || format!("{path}: {}", far::sentence(num_far));
                scan.warnings.extend((num_far > 0).then(sentence));
            }
        }
    }
    scan.warnings.extend(of_units(scan, &units));
    let sentences = sentences(scan, headers, options, middle);
    scan.warnings.extend(sentences.into_iter().chain(turned));
}

/// The units of a file's coordinates.
struct Units {
    across_m: Option<f64>,
    up_m: Option<f64>,
}

impl Units {
    /// The units that the user states, or else the file. A unit that the user states for all axes holds for heights
    /// too.
    fn of(header: &Header, axes: Axes, options: &ReadOptions) -> Self {
        let (unit_m, vertical_m) = (options.unit.meters(), options.vertical_unit.meters());
        // A user who states only a unit of heights has meters across, unless the file says otherwise.
        let meter = vertical_m.map(|_| 1.0);
        // A map's unit says nothing of places on the earth.
        let in_file_m = header.unit_m.filter(|_| axes == Axes::Planar || header.axes != Some(Axes::Planar));
        Self {
            across_m: unit_m.or(in_file_m).or(meter),
            up_m: vertical_m.or(unit_m).or(header.vertical_unit_m),
        }
    }

    /// World units, of `world_m` meters each, per unit across and per unit of height of planar axes. A unit that is not
    /// known is taken for the world's.
    fn planar(&self, world_m: Option<f64>) -> [f64; 2] {
        let (Some(across), Some(world)) = (self.across_m, world_m) else { return [1.0; 2] };
        let ratio = |own: f64| if (own / world - 1.0).abs() > SAME_UNIT { own / world } else { 1.0 };
        [ratio(across), ratio(self.up_m.unwrap_or(across))]
    }

    /// Meters per unit of the lengths of coordinates on the earth.
    fn scale(&self, axes: Axes) -> f64 {
        match axes {
            Axes::Planar => 1.0,
            Axes::Geographic(_) | Axes::LatitudeFirst(_) => self.up_m.unwrap_or(1.0),
            Axes::Geocentric => self.across_m.unwrap_or(1.0),
        }
    }
}

/// Some points of a file, evenly over it, in its coordinates.
pub(super) fn samples(file: &ScanFile) -> impl Iterator<Item = DVec3> {
    let step = file.points.xyz.len().div_ceil(MOST_SAMPLES).max(1);
    file.points.xyz.iter().step_by(step).map(|&xyz| file.grid.p_in_world(xyz))
}

/// The median along each axis, which strays do not move.
pub(super) fn median(points: Vec<DVec3>) -> DVec3 {
    let along = |axis: usize| {
        let mut values: Vec<f64> = points.iter().map(|p| p[axis]).collect();
        let half = values.len() / 2;
        if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(half, f64::total_cmp).1 }
    };
    DVec3::new(along(0), along(1), along(2))
}

/// The middle of files on the earth, each with its axes and meters per unit.
fn middle<'a>(files: impl Iterator<Item = (&'a ScanFile, Axes, f64)>) -> Geodetic {
    let places =
        files.flat_map(|(file, axes, unit_m)| samples(file).map(move |p| axes.geocentric(p, unit_m)));
    Geodetic::of_geocentric(median(places.collect()))
}

/// Turns and scales the grid of a file with lengths; no coordinate is rounded.
fn regrid(file: &mut ScanFile) {
    let world_from_file = file.world_from_file;
    if world_from_file == WorldFromFile::default() {
        return;
    }
    let WorldFromFile::Axes { up, across_scale, height_scale } = world_from_file else { return };
    let Grid { scale, offset } = file.grid;
    // The scale takes the sign, because a negated coordinate might not fit.
    file.grid = Grid { scale: world_from_file.p_in_world(scale), offset: world_from_file.p_in_world(offset) };
    if up != UpAxis::Z {
        file.points.xyz.par_iter_mut().for_each(|p| p.swap(1, 2));
    }
    turn_normals(file, DVec3::new(across_scale, across_scale, height_scale).recip());
    rebound(file);
}

/// Puts a file's points from the earth onto a new grid along the world's axes, made for its scene. Returns how many
/// points were left out because they are too far away for the grid.
fn project(file: &mut ScanFile) -> usize {
    let (world_from_file, grid) = (file.world_from_file, file.grid);
    let place = |xyz: [i32; 3]| world_from_file.p_in_world(grid.p_in_world(xyz));
    let box_of =
        |block: &[[i32; 3]]| block.iter().fold(Bounds::EMPTY, |bounds, &xyz| bounds.with(place(xyz)));
    let bounds = file.points.xyz.par_chunks(BLOCK).map(box_of).reduce(|| Bounds::EMPTY, Bounds::union);
    let sample = samples(file).map(|p| world_from_file.p_in_world(p)).collect();
    let fitted = FittedGrid::over(sample, bounds);
    let mut far = Marks::default();
    let is_far = |xyz: [i32; 3]| !fitted.holds(&place(xyz).to_array());
    if is_far_anywhere(&fitted, &bounds) {
        let numbers = file.points.xyz.iter().enumerate().filter(|(_, xyz)| is_far(**xyz));
        numbers.for_each(|(number, _)| far.set(number));
    }
    far::leave_out(file, &far);
    file.points.xyz.par_iter_mut().for_each(|xyz| *xyz = fitted.snap(&place(*xyz).to_array()));
    file.grid = fitted.grid;
    turn_normals(file, DVec3::ONE);
    rebound(file);
    far.count()
}

/// True if a part of the box is beyond what the grid holds.
fn is_far_anywhere(fitted: &FittedGrid, bounds: &Bounds) -> bool {
    !fitted.holds(&bounds.min.to_array()) || !fitted.holds(&bounds.max.to_array())
}

/// Turns normals to the world's axes. Normals of a scaled surface lean the other way, so `scale` is the reciprocal.
fn turn_normals(file: &mut ScanFile, scale: DVec3) {
    let world_from_file = file.world_from_file;
    file.points.normals.par_iter_mut().for_each(|normal| {
        let turned = world_from_file.direction_in_world(DVec3::from_array(normal.map(f64::from))) * scale;
        // Normals keep their last bit where all is as long as before.
        let turned = if scale == DVec3::ONE { turned } else { turned.normalize() };
        *normal = turned.as_vec3().to_array();
    });
}

/// Finds the file's box again, of the points as they now are.
fn rebound(file: &mut ScanFile) {
    let grid = file.grid;
    let box_of = |block: &[[i32; 3]]| {
        block.iter().fold(Bounds::EMPTY, |bounds, &xyz| bounds.with(grid.p_in_world(xyz)))
    };
    file.bounds = file.points.xyz.par_chunks(BLOCK).map(box_of).reduce(|| Bounds::EMPTY, Bounds::union);
}

/// Sentences about files whose lengths are in another unit than the world's.
fn of_units(scan: &Scan, units: &[Units]) -> Vec<String> {
    let sentence = |(file, units): (&ScanFile, &Units)| {
        let WorldFromFile::Axes { across_scale, .. } = file.world_from_file else { return None };
        let (path, own) = (file.path.display(), unit::words(units.across_m?));
        (across_scale != 1.0).then(|| {
            format!(
                "{path}: has its lengths in another unit, {own}; they are scaled to that of the other files"
            )
        })
    };
    scan.files.iter().zip(units).filter_map(sentence).collect()
}

/// Sentences about what was done, once for the scan, and about files that do not fit.
fn sentences(scan: &Scan, headers: &[Header], options: &ReadOptions, middle: Geodetic) -> Vec<String> {
    let mut sentences = Vec::new();
    let all = || scan.files.iter().zip(headers);
    let is_projected = |file: &ScanFile| !matches!(file.world_from_file, WorldFromFile::Axes { .. });
    if let Some((file, header)) = all().find(|(file, _)| is_projected(file)) {
        let what = match file.world_from_file {
            WorldFromFile::Geographic { latitude_first: true, .. } => "in angles, the latitude first",
            WorldFromFile::Geographic { angle: Angle::Degree, .. } => "in degrees",
            WorldFromFile::Geographic { .. } => "in angles",
            _ => "from the earth's center",
        };
        let is_as_stated = match (header.axes, file.world_from_file) {
            (Some(Axes::Geographic(stated)), WorldFromFile::Geographic { angle, .. }) => stated == angle,
            (stated, world_from_file) => stated == Some(world_from_file.axes()),
        };
        let how = match header.axes {
            _ if options.project != Project::Auto || is_as_stated => "has its coordinates",
            None => "names no coordinate system, but has its coordinates",
            Some(_) => "names another coordinate system, but has its coordinates",
        };
        let (lon, lat) = (middle.longitude.to_degrees(), middle.latitude.to_degrees());
        let path = file.path.display();
        sentences.push(format!(
            "{path}: {how} {what}; they are drawn in meters east, north and up of longitude {lon:.5}, latitude {lat:.5} \
             (cloud.project=off draws them as they are)"
        ));
        let is_geographic = matches!(file.world_from_file, WorldFromFile::Geographic { .. });
        if is_geographic && options.project == Project::Auto && options.unit.meters().is_some() {
            sentences.push(format!(
                "{path}: cloud.unit is the unit of its heights only, for its coordinate system is one of angles \
                 (cloud.project=off, if it has lengths)"
            ));
        }
        if let Some((other, _)) = all().find(|(file, _)| !is_projected(file)) {
            let other = other.path.display();
            sentences.push(format!(
                "{other}: has its coordinates in lengths, others on the earth; they do not fit together"
            ));
        }
    }
    for (file, header) in all() {
        let path = file.path.display();
        if options.project == Project::Off && matches!(header.axes, Some(Axes::Geographic(_))) {
            sentences.push(format!("{path}: has its coordinates in degrees and is drawn so, which looks flat (cloud.project=auto)"));
        }
        if options.project == Project::Auto
            && let (Some(Axes::Geographic(_) | Axes::Geocentric), false) = (header.axes, is_projected(file))
        {
            sentences.push(format!("{path}: its coordinate system is one on the earth, but its points are not there; they are drawn as lengths"));
        }
    }
    sentences
}
