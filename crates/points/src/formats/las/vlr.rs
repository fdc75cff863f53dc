//! Reads variable length records, also extended ones, by where they really lie, not by how many are announced.

use super::extra::{self, Extra};
use super::header::{LasHeader, text};
use crate::ScanError;
use crate::source::Source;

/// Bytes before the payload of a variable length record.
const VLR_HEADER: u64 = 54;
/// Bytes before the payload of an extended variable length record.
const EVLR_HEADER: u64 = 60;
/// Most records that are read, more than any real file has: each costs a read.
const MOST_RECORDS: u32 = 100_000;
/// Most bytes of a payload that is kept; well-known text of compound systems can take more than a mebibyte.
const MOST_PAYLOAD: u64 = 1 << 26;

/// A record that we know what to do with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Vlr {
    pub kind: VlrKind,
    pub payload: Vec<u8>,
}

/// The records that matter here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VlrKind {
    /// How the points are compressed.
    Laszip,
    /// GeoTIFF keys.
    GeoKeys,
    /// Numbers of the GeoTIFF keys.
    GeoDoubles,
    /// Texts of the GeoTIFF keys.
    GeoTexts,
    /// Coordinate system as well-known text.
    Wkt,
    /// What the bytes behind the standard record are.
    ExtraBytes,
    /// Marks a COPC file.
    Copc,
}

impl VlrKind {
    fn of(user: &str, record: u16) -> Option<Self> {
        match (user, record) {
            ("laszip encoded", 22204) => Some(Self::Laszip),
            ("LASF_Projection", 34735) => Some(Self::GeoKeys),
            ("LASF_Projection", 34736) => Some(Self::GeoDoubles),
            ("LASF_Projection", 34737) => Some(Self::GeoTexts),
            ("LASF_Projection" | "liblas", 2112) => Some(Self::Wkt),
            ("LASF_Spec", 4) => Some(Self::ExtraBytes),
            ("copc", 1) => Some(Self::Copc),
            _ => None,
        }
    }
}

/// The known records of a file; records that run beyond its end or into the points are left out.
///
/// # Errors
/// The system cannot read the file.
pub(super) fn read_all(source: &Source, header: &LasHeader) -> Result<Vec<Vlr>, ScanError> {
    let mut found = Vec::new();
    let end = header.points_offset.min(source.len());
    let mut offset = header.header_bytes;
    for index in 0..MOST_RECORDS {
        if offset + VLR_HEADER > end {
            break;
        }
        let head = source.bytes(offset, VLR_HEADER)?;
        let Some((user, record)) = identity(&head) else { break };
        // Some writers count too few records, but bytes behind the counted records must at least look like one.
        let counted = index < header.announced_vlrs;
        if !counted
            && (user.is_empty() || head[2..18].iter().any(|&b| b != 0 && !b.is_ascii_graphic() && b != b' '))
        {
            break;
        }
        let len = u64::from(u16::from_le_bytes([head[20], head[21]]));
        keep(source, &mut found, &user, record, offset + VLR_HEADER, len, end)?;
        offset += VLR_HEADER + len;
    }
    if let Some(evlrs) = header.evlrs {
        let mut offset = evlrs.offset;
        for _ in 0..evlrs.announced.min(MOST_RECORDS) {
            let head = source.bytes(offset, EVLR_HEADER)?;
            let (Some((user, record)), Some(len)) = (identity(&head), head.get(20..28)) else { break };
            let len = len.first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
            keep(source, &mut found, &user, record, offset + EVLR_HEADER, len, source.len())?;
            let Some(next) = (offset + EVLR_HEADER).checked_add(len) else { break };
            offset = next;
        }
    }
    Ok(found)
}

/// User id and record id; `None` if `head` is cut off.
fn identity(head: &[u8]) -> Option<(String, u16)> {
    let record = head.get(18..20)?.first_chunk().map(|bytes| u16::from_le_bytes(*bytes))?;
    (head.len() as u64 >= VLR_HEADER).then(|| (text(&head[2..18]), record))
}

fn keep(
    source: &Source,
    found: &mut Vec<Vlr>,
    user: &str,
    record: u16,
    offset: u64,
    len: u64,
    end: u64,
) -> Result<(), ScanError> {
    let Some(kind) = VlrKind::of(user, record) else { return Ok(()) };
    let whole = offset.checked_add(len).is_some_and(|after| after <= end);
    if whole && len <= MOST_PAYLOAD {
        found.push(Vlr { kind, payload: source.bytes(offset, len)? });
    }
    Ok(())
}

/// Payload of the first record of a kind.
pub(super) fn payload(vlrs: &[Vlr], kind: VlrKind) -> Option<&[u8]> {
    vlrs.iter().find(|vlr| vlr.kind == kind).map(|vlr| vlr.payload.as_slice())
}

/// Extra bytes that the records describe.
pub(super) fn extra(vlrs: &[Vlr]) -> Vec<Extra> {
    vlrs.iter()
        .filter(|vlr| vlr.kind == VlrKind::ExtraBytes)
        .flat_map(|vlr| extra::parse(&vlr.payload))
        .collect()
}
