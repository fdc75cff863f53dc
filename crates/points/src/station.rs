//! Stations: where a scanner stood, or a camera. Files of several scans have one for each.

use crate::WorldFromFile;
use base::space::Pose;
use glam::DVec3;

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

/// A station in the world that is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedStation {
    /// The station's name.
    pub name: String,
    /// What was there.
    pub kind: StationKind,
    /// Where it was: the scanner's or the camera's center.
    pub p_in_world: DVec3,
    /// Where a camera looked, unit length; `None` of a scanner, which looks all around.
    pub looks_in_world: Option<DVec3>,
}

impl Station {
    /// The station in the world; `None` if the file does not say where it was, or nowhere in particular.
    #[must_use]
    pub fn placed(&self, world_from_file: &WorldFromFile) -> Option<PlacedStation> {
        let pose = self.file_from_station.as_ref()?;
        let p_in_world = world_from_file.p_in_world(pose.position);
        let looks = world_from_file.direction_in_world(pose.orientation * DVec3::NEG_Z);
        let looks_in_world = (self.kind == StationKind::Camera).then(|| looks.try_normalize()).flatten();
        p_in_world.is_finite().then(|| PlacedStation {
            name: self.name.clone(),
            kind: self.kind,
            p_in_world,
            looks_in_world,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::UpAxis;
    use glam::DQuat;

    #[test]
    fn a_station_turns_with_its_file() {
        let mut station = Station {
            name: "S1".into(),
            kind: StationKind::Camera,
            file_from_station: Some(Pose {
                position: DVec3::new(1.0, 2.0, 3.0),
                orientation: DQuat::IDENTITY,
            }),
            source_id: None,
        };
        let y_up = WorldFromFile::Axes { up: UpAxis::Y, across_scale: 2.0, height_scale: 2.0 };
        let seen = station.placed(&y_up).unwrap();
        assert_eq!(seen.p_in_world, DVec3::new(2.0, -6.0, 4.0));
        // The camera looks along −z of a file whose y points up, which is the world's y.
        assert_eq!(seen.looks_in_world, Some(DVec3::Y));
        station.kind = StationKind::Scanner;
        assert_eq!(station.placed(&y_up).unwrap().looks_in_world, None);
        station.file_from_station = None;
        assert_eq!(station.placed(&y_up), None);
    }
}
