//! EPT, Entwine Point Tiles: an octree as a folder, with a file for each node, as LAZ or as records.
//!
//! ```text
//!  ept.json ──▶ EptInfo: packing, Dims ──▶ EptTree: nodes, breadth first ──laz | records──▶ NodeMerger: blocks
//! ```
//!
//! None of the three counts of points that a scan states is believed, and no node's file is taken for points that the
//! schema does not describe.

mod dims;
#[cfg(test)]
mod ept_tests;
mod hierarchy;
mod info;
mod nodes;
mod ranges;
mod read;
mod records;
mod regrid;

use super::{Candidate, Dataset, Format, OpenHints, Take};
use crate::block::Trailer;
use crate::source::Source;
use crate::{Grid, Header, Projection, ScanError, Schema};
use base::task::Progress;
use base::words::counted;
use glam::DVec3;
use hierarchy::EptTree;
use info::{EptInfo, NodePacking};
use nodes::EptFault;
use read::{EptRead, EptReading};
use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Name of the file that describes a scan.
const INFO: &str = "ept.json";
/// Most bytes of the file that says which program made the scan.
const MOST_BUILD_BYTES: u64 = 1 << 16;

/// The format EPT.
pub(super) struct Ept;

impl Format for Ept {
    fn names(&self) -> &'static [&'static str] {
        &["EPT"]
    }

    fn endings(&self) -> Option<&'static [&'static str]> {
        Some(&[INFO])
    }

    fn opens_folders(&self) -> bool {
        true
    }

    fn probe(&self, candidate: &Candidate) -> bool {
        let is_info = |name: &OsStr| name.eq_ignore_ascii_case(INFO);
        if candidate.is_folder {
            candidate.path.join(INFO).is_file()
        } else {
            candidate.path.file_name().is_some_and(is_info)
        }
    }

    fn open(&self, path: &Path, _: &OpenHints) -> Result<Box<dyn Dataset>, ScanError> {
        let (folder, info) = match path.is_dir() {
            true => (path.to_owned(), path.join(INFO)),
            false => (path.parent().unwrap_or(Path::new("")).to_owned(), path.to_owned()),
        };
        let info = EptInfo::read(&info)?;
        let (schema, grid) = match info.packing {
            NodePacking::Laszip => of_laz(path, &folder, &info)?,
            _ => (info.dims.schema(), Grid::default()),
        };
        let header = describe(path, &info, schema, software(&folder));
        Ok(Box::new(EptFolder { folder, info, grid, header }))
    }
}

/// An opened scan.
struct EptFolder {
    folder: PathBuf,
    info: EptInfo,
    /// The grid, where nodes are LAZ files.
    grid: Grid,
    header: Header,
}

impl Dataset for EptFolder {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, want: &Projection, take: &mut Take, progress: &Progress) -> Result<Trailer, ScanError> {
        let Self { folder, info, grid, header } = self;
        let tree = EptTree::read(folder, info.spacing, progress)?;
        let schema = &header.schema;
        let reading = EptReading { folder, info, tree: &tree, schema, grid: *grid, want, progress };
        let EptRead { num_points, losses, mut warnings } = reading.all(take)?;
        let losses: Vec<String> = tree.losses.iter().cloned().chain(losses).collect();
        if num_points == 0 {
            let announced = counted(info.announced, "point");
            let lost = losses.first().map(|loss| format!(" ({loss})")).unwrap_or_default();
            let reason = format!("it announces {announced}, none could be read{lost}; get it again");
            return Err(ScanError::NoPoints { path: header.path.clone(), reason });
        }
        if num_points != info.announced && losses.is_empty() {
            let announced = counted(info.announced, "point");
            warnings.push(format!("announces {announced}, but holds {num_points}; all were read"));
        }
        Ok(Trailer { white: info.dims.white(), losses, warnings, ..Trailer::default() })
    }
}

/// What the points have whose nodes are LAZ files, and on which grid: what the first file says that can be read.
fn of_laz(path: &Path, folder: &Path, info: &EptInfo) -> Result<(Schema, Grid), ScanError> {
    let mut first_fault = None;
    for key in EptTree::first(folder) {
        let file = nodes::path(folder, key, NodePacking::Laszip);
        match read::open_laz(&file) {
            Ok(laz) => {
                let grid = if info.dims.is_on_fixed_grid() { stated(info) } else { laz_grid(&file)? };
                return Ok((laz.header().schema.clone(), grid));
            }
            Err(EptFault::Fatal(error)) => return Err(error),
            Err(fault) => first_fault = first_fault.or(Some((key, fault))),
        }
    }
    let reason = match first_fault {
        Some((key, EptFault::Unreadable(reason))) => format!("node {key} {reason}"),
        Some((key, _)) => format!("the file of node {key} is missing"),
        None => "it has no nodes".into(),
    };
    Err(ScanError::NoPoints { path: path.to_owned(), reason: format!("{reason}; get it again") })
}

/// The grid that the schema states.
fn stated(info: &EptInfo) -> Grid {
    let places = &info.dims.places;
    Grid {
        scale: DVec3::from_array([0, 1, 2].map(|axis| places[axis].scale)),
        offset: DVec3::from_array([0, 1, 2].map(|axis| places[axis].offset)),
    }
}

fn laz_grid(file: &Path) -> Result<Grid, ScanError> {
    super::las::grid(&Source::open(file)?)
}

/// The program that made the scan, where a file beside it says so.
fn software(folder: &Path) -> Option<String> {
    let bytes = Source::open(&folder.join("ept-build.json")).ok()?.bytes(0, MOST_BUILD_BYTES).ok()?;
    let build: Value = serde_json::from_slice(&bytes).ok()?;
    let text = |name: &str| build.get(name).and_then(Value::as_str);
    let name = text("software")?.to_owned();
    Some(text("version").map_or_else(|| name.clone(), |version| format!("{name} {version}")))
}

fn describe(path: &Path, info: &EptInfo, schema: Schema, software: Option<String>) -> Header {
    let version = Some(&info.version).filter(|version| !version.is_empty());
    let version = version.map(|version| format!(" {version}")).unwrap_or_default();
    let EptInfo { crs, .. } = info;
    Header {
        path: path.to_owned(),
        format: format!("EPT{version}, {}", info.packing.name()),
        num_points: info.announced,
        schema,
        crs: crs.name.clone(),
        unit_m: crs.unit_m,
        vertical_unit_m: crs.vertical_unit_m,
        axes: crs.axes,
        is_on_fixed_grid: info.packing == NodePacking::Laszip || info.dims.is_on_fixed_grid(),
        software,
        ..Header::default()
    }
}
