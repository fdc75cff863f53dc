//! LAS 1.0–1.4, point formats 0–10, plain or compressed (LAZ, and COPC, which is LAZ in a certain order).

mod chunks;
mod codec;
mod header;
mod laz;
mod raw;
mod record;
mod vlr;

use super::crs::{self, Crs};
use super::source::Source;
use super::{Columns, Format, Header, ReadOptions, Reader, ScanError};
use base::task::Progress;
use base::words::{agreeing, counted};
use header::LasHeader;
use laz::Laz;
use vlr::{Kind, Vlr};

/// The format.
pub(super) struct Las;

impl Format for Las {
    fn recognises(&self, head: &[u8]) -> bool {
        head.starts_with(b"LASF")
    }

    fn open(&self, source: Source) -> Result<Box<dyn Reader>, ScanError> {
        let las = LasHeader::read(&source)?;
        let vlrs = vlr::read_all(&source, &las)?;
        let packing = Packing::of(&source, &las, &vlrs)?;
        let mut header = describe(&source, &las, &vlrs, &packing);
        header.num_points = match packing {
            Packing::Raw(_) => raw::num_points(&source, &las),
            Packing::Laz(_) => las.announced_points,
        };
        Ok(Box::new(LasFile { source, las, packing, header }))
    }
}

/// How the points are stored.
enum Packing {
    Raw(record::Layout),
    Laz(Box<Laz>),
}

impl Packing {
    fn of(source: &Source, las: &LasHeader, vlrs: &[Vlr]) -> Result<Self, ScanError> {
        let fail = |reason| ScanError::Compression { path: source.path().to_owned(), reason };
        match (vlr::payload(vlrs, Kind::Laszip), las.compressed) {
            (Some(payload), true) => Ok(Self::Laz(Box::new(Laz::parse(payload, las.minor).map_err(fail)?))),
            (None, true) => {
                let reason = "the record that says how (\"laszip encoded\") is missing; get the file again";
                Err(fail(reason.to_owned()))
            }
            (_, false) => Ok(Self::Raw(las.layout(source)?)),
        }
    }

    fn has_rgb(&self) -> bool {
        match self {
            Self::Raw(layout) => layout.rgb_offset.is_some(),
            Self::Laz(laz) => laz.has_rgb(),
        }
    }
}

/// An opened file.
struct LasFile {
    source: Source,
    las: LasHeader,
    packing: Packing,
    header: Header,
}

impl Reader for LasFile {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, options: &ReadOptions, progress: &Progress) -> Result<Columns, ScanError> {
        let Self { source, las, packing, .. } = self;
        let (announced, show_withheld) = (las.announced_points, options.show_withheld);
        if las.points_offset >= source.len() {
            let reason = if announced == 0 {
                "its header announces none".to_owned()
            } else {
                let (start, end) = (las.points_offset, source.len());
                format!(
                    "{announced} should start at byte {start}, but the file ends at byte {end}; get it again"
                )
            };
            return Err(ScanError::NoPoints { path: source.path().to_owned(), reason });
        }
        let mut columns = match packing {
            Packing::Raw(layout) => raw::read(source, las, *layout, show_withheld, progress)?,
            Packing::Laz(laz) => laz.read(source, las, show_withheld, progress)?,
        };
        columns.lattice = las.lattice;
        let num_points = columns.points.num_read(show_withheld);
        if columns.points.xyz.is_empty() && num_points > 0 {
            let advice = "--set cloud.show_withheld=true shows them";
            let all = format!("all {num_points} are");
            let all = agreeing(num_points, "its only point is", &all);
            let reason = format!("{all} withheld, which means deleted; {advice}");
            return Err(ScanError::NoPoints { path: source.path().to_owned(), reason });
        }
        if num_points == 0 {
            let reason = format!("its header announces {announced}, none could be read");
            return Err(ScanError::NoPoints { path: source.path().to_owned(), reason });
        }
        if num_points < announced {
            let end = source.len();
            columns.losses.push(format!(
                "announces {}, but only {num_points} could be read (the file has {end} bytes)",
                counted(announced, "point")
            ));
        } else if num_points > announced {
            columns.warnings.push(format!(
                "announces {}, but holds {num_points}; all were read",
                counted(announced, "point")
            ));
        }
        Ok(columns)
    }
}

fn describe(source: &Source, las: &LasHeader, vlrs: &[Vlr], packing: &Packing) -> Header {
    let kind = match packing {
        Packing::Raw(_) => "LAS",
        Packing::Laz(_) if vlr::payload(vlrs, Kind::Copc).is_some() => "COPC (LAZ)",
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
        num_points: las.announced_points,
        attributes: attributes(las, vlrs, packing),
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
    let wkt = crs::from_wkt(payload(Kind::Wkt));
    let keys = crs::from_geotiff(payload(Kind::GeoKeys), payload(Kind::GeoDoubles), payload(Kind::GeoTexts));
    // The second only fills in what the first leaves open.
    if las.wkt { wkt.or(keys) } else { keys.or(wkt) }
}

fn attributes(las: &LasHeader, vlrs: &[Vlr], packing: &Packing) -> Vec<String> {
    let format = las.point_format;
    let mut names =
        vec!["intensity", "returns", "classification", "scan_angle", "user_data", "point_source_id"];
    if !matches!(format, 0 | 2) {
        names.push("gps_time");
    }
    if packing.has_rgb() {
        names.push("rgb");
    }
    if matches!(format, 8 | 10) {
        names.push("nir");
    }
    if matches!(format, 4 | 5 | 9 | 10) {
        names.push("waveform");
    }
    let extra = vlr::extra_dimensions(vlrs).into_iter();
    names.into_iter().map(str::to_owned).chain(extra.map(|name| format!("extra:{name}"))).collect()
}
