//! Stations: where a scanner stood, or a camera. Files of several scans have one for each.

use base::space::Pose;

/// What was at a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StationKind {
    /// A scanner, whose axes are x, y and z up.
    Scanner,
    /// A camera, which looks along its −z axis, y up.
    Camera,
}

/// A place from which a part of a file was measured or photographed.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// Its name in the file; a number, if it has none.
    pub name: String,
    /// What was there.
    pub kind: StationKind,
    /// Where it was, in the file's coordinates, if the file says so.
    pub file_from_station: Option<Pose>,
    /// The [`SourceId`](crate::Attribute::SourceId) of the points that were measured from there.
    pub source_id: Option<u16>,
}
