//! LAS 1.0–1.4, point formats 0–10, plain or compressed (LAZ, and COPC, which is LAZ whose chunks are an octree).

mod chunks;
mod codec;
mod copc;
#[cfg(test)]
mod copc_tests;
mod extra;
mod header;
mod laz;
mod raw;
mod record;
mod vlr;

use super::{Candidate, Dataset, Format, OpenHints, Take};
use crate::block::Trailer;
use crate::crs::{self, Crs};
use crate::source::Source;
use crate::{Grid, Header, Projection, ScanError, Schema};
use base::task::Progress;
use base::words::counted;
use header::LasHeader;
use laz::Laz;
use record::Layout;
use std::path::Path;
use vlr::{Vlr, VlrKind};

/// The format LAS, with LAZ.
pub(super) struct Las;

impl Format for Las {
    fn names(&self) -> &'static [&'static str] {
        &["LAS", "LAZ", "COPC"]
    }

    fn endings(&self) -> Option<&'static [&'static str]> {
        // COPC files end in .copc.laz.
        Some(&["las", "laz"])
    }

    fn sidecars(&self) -> &'static [&'static str] {
        // Spatial indexes, and statistics and tables of tiles that other programs keep.
        &["lax", "lasx", "lasd", "copc"]
    }

    fn probe(&self, candidate: &Candidate) -> bool {
        candidate.head.starts_with(b"LASF")
    }

    fn open(&self, path: &Path, _: &OpenHints) -> Result<Box<dyn Dataset>, ScanError> {
        let source = Source::open(path)?;
        let las = LasHeader::read(&source)?;
        let vlrs = vlr::read_all(&source, &las)?;
        let extra = vlr::extra(&vlrs);
        let packing = Packing::of(&source, &las, &vlrs)?;
        let layout = match &packing {
            Packing::Raw => Layout::of_format(las.point_format, las.minor, las.record_bytes, &extra)
                .ok_or_else(|| las.short_records(&source))?,
            Packing::Laz(laz) => laz.layout(las.minor, &extra),
        };
        if let Some((attribute, kind)) = layout.misfit() {
            return Err(ScanError::Column { path: path.to_owned(), attribute, kind });
        }
        let header = describe(&source, &las, &vlrs, &packing, layout.schema());
        Ok(Box::new(LasFile { source, las, packing, layout, header }))
    }
}

/// The grid that a file's header states.
///
/// # Errors
/// It cannot be read, or has no readable header.
pub(super) fn grid(source: &Source) -> Result<Grid, ScanError> {
    Ok(LasHeader::read(source)?.grid)
}

/// How the points are stored.
enum Packing {
    Raw,
    Laz(Box<Laz>),
}

impl Packing {
    fn of(source: &Source, las: &LasHeader, vlrs: &[Vlr]) -> Result<Self, ScanError> {
        let fail = |reason| ScanError::Compression { path: source.path().to_owned(), reason };
        match (vlr::payload(vlrs, VlrKind::Laszip), las.compressed) {
            (Some(payload), true) => {
                let laz = Laz::parse(payload).map_err(fail)?;
                Ok(Self::Laz(Box::new(match vlr::payload(vlrs, VlrKind::Copc) {
                    Some(payload) => laz.of_copc(payload),
                    None => laz,
                })))
            }
            (None, true) => {
                let reason = "the record that says how (\"laszip encoded\") is missing; get the file again";
                Err(fail(reason.to_owned()))
            }
            (_, false) => Ok(Self::Raw),
        }
    }
}

/// An opened file.
struct LasFile {
    source: Source,
    las: LasHeader,
    packing: Packing,
    layout: Layout,
    header: Header,
}

/// What was read of the points.
#[derive(Debug, Default)]
struct PointsRead {
    num_points: u64,
    /// Sentences about what could not be read, whose subject is the file.
    losses: Vec<String>,
    /// Sentences about what else was odd, whose subject is the file.
    warnings: Vec<String>,
}

impl Dataset for LasFile {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, want: &Projection, take: &mut Take, progress: &Progress) -> Result<Trailer, ScanError> {
        let Self { source, las, packing, layout, .. } = self;
        let announced = las.announced_points;
        let no_points = |reason| Err(ScanError::NoPoints { path: source.path().to_owned(), reason });
        if las.points_offset >= source.len() {
            let (start, end) = (las.points_offset, source.len());
            return no_points(match announced {
                0 => "its header announces none; choose another file".to_owned(),
                _ => format!(
                    "{announced} should start at byte {start}, but the file ends at byte {end}; get it again"
                ),
            });
        }
        let PointsRead { num_points, mut losses, mut warnings } = match packing {
            Packing::Raw => raw::read(source, las, &layout.extractor(want), want, take, progress)?,
            Packing::Laz(laz) => laz.read(source, las, &Laz::wanted(las, layout, want), take, progress)?,
        };
        if num_points == 0 {
            return no_points(format!("its header announces {announced}, none could be read; get it again"));
        }
        if num_points < announced {
            let end = source.len();
            losses.push(format!(
                "announces {}, but only {num_points} could be read (the file has {end} bytes)",
                counted(announced, "point")
            ));
        } else if num_points > announced {
            warnings.push(format!(
                "announces {}, but holds {num_points}; all were read",
                counted(announced, "point")
            ));
        }
        Ok(Trailer { losses, warnings, ..Trailer::default() })
    }
}

fn describe(source: &Source, las: &LasHeader, vlrs: &[Vlr], packing: &Packing, schema: Schema) -> Header {
    let kind = match packing {
        Packing::Raw => "LAS",
        Packing::Laz(_) if vlr::payload(vlrs, VlrKind::Copc).is_some() => "COPC (LAZ)",
        Packing::Laz(_) => "LAZ",
    };
    let mut warnings = las.oddities.clone();
    let crs = crs(las, vlrs);
    if let Packing::Laz(laz) = packing
        && laz.record_bytes() < usize::from(record::standard_bytes(las.point_format).unwrap_or(0))
    {
        warnings.push(format!(
            "stores only part of point format {} (its waveforms are missing)",
            las.point_format
        ));
    }
    Header {
        path: source.path().to_owned(),
        format: format!("{kind} 1.{}, point format {}", las.minor, las.point_format),
        num_points: match packing {
            Packing::Raw => raw::num_points(source, las),
            Packing::Laz(_) => las.announced_points,
        },
        schema,
        parts: Vec::new(),
        stations: Vec::new(),
        is_splats: false,
        crs: crs.name,
        unit_m: crs.unit_m,
        vertical_unit_m: crs.vertical_unit_m,
        axes: crs.axes,
        is_on_fixed_grid: true,
        up: None,
        software: Some(las.software.clone()).filter(|name| !name.is_empty()),
        created: las.created_date(),
        warnings,
    }
}

fn crs(las: &LasHeader, vlrs: &[Vlr]) -> Crs {
    let payload = |kind| vlr::payload(vlrs, kind).unwrap_or_default();
    let wkt = crs::from_wkt(payload(VlrKind::Wkt));
    let keys = crs::from_geotiff(
        payload(VlrKind::GeoKeys),
        payload(VlrKind::GeoDoubles),
        payload(VlrKind::GeoTexts),
    );
    // The second system only fills in what the first leaves open.
    if las.wkt { wkt.or(keys) } else { keys.or(wkt) }
}
