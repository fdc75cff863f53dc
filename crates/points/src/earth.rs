//! The earth as far as a scan needs it: longitude, latitude and height turned into places in space, and the local frame
//! that is drawn. One ellipsoid is enough for all coordinate systems: those of other surveys differ by meters in place
//! and by millionths in size, and only differences within a scan are drawn.

use glam::{DMat3, DVec3};
use libm::{atan2, sincos};

/// Equatorial radius of WGS 84 in meters.
const EQUATOR_M: f64 = 6_378_137.0;
/// Flattening of WGS 84.
const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// Eccentricity of WGS 84, squared.
const ECCENTRICITY_2: f64 = FLATTENING * (2.0 - FLATTENING);

/// Longitude and latitude in radians, height above the ellipsoid in meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geodetic {
    /// East of Greenwich.
    pub longitude: f64,
    /// North of the equator.
    pub latitude: f64,
    /// Above the ellipsoid.
    pub height_m: f64,
}

impl Geodetic {
    /// The place in meters from the earth's center.
    #[must_use]
    pub fn geocentric(self) -> DVec3 {
        let ((sin_lat, cos_lat), (sin_lon, cos_lon)) = (sincos(self.latitude), sincos(self.longitude));
        let normal_m = EQUATOR_M / (1.0 - ECCENTRICITY_2 * sin_lat * sin_lat).sqrt();
        let across = (normal_m + self.height_m) * cos_lat;
        let up = (normal_m * (1.0 - ECCENTRICITY_2) + self.height_m) * sin_lat;
        DVec3::new(across * cos_lon, across * sin_lon, up)
    }

    /// Converts a place in meters from the earth's center. No latitude is right close to the center.
    #[must_use]
    pub fn of_geocentric(p: DVec3) -> Self {
        let across = p.x.hypot(p.y);
        let mut latitude = atan2(p.z, across * (1.0 - ECCENTRICITY_2));
        let mut height_m = 0.0;
        // Each round gains at least two digits, down to the last bit.
        for _ in 0..8 {
            let (sin_lat, cos_lat) = sincos(latitude);
            let normal_m = EQUATOR_M / (1.0 - ECCENTRICITY_2 * sin_lat * sin_lat).sqrt();
            // The height along the normal is exact at the poles as well as at the equator.
            height_m = across * cos_lat + p.z * sin_lat - EQUATOR_M * EQUATOR_M / normal_m;
            let share = ECCENTRICITY_2 * normal_m / (normal_m + height_m);
            latitude = atan2(p.z, across * (1.0 - share));
        }
        Self { longitude: atan2(p.y, p.x), latitude, height_m }
    }
}

/// Axes east, north and up that touch the ellipsoid at one place. At that place, z is the height above the ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalFrame {
    origin: DVec3,
    geocentric_from_local: DMat3,
}

impl LocalFrame {
    /// A frame that touches the ellipsoid below or above `at`.
    #[must_use]
    pub fn at(at: Geodetic) -> Self {
        let ((sin_lat, cos_lat), (sin_lon, cos_lon)) = (sincos(at.latitude), sincos(at.longitude));
        let east = DVec3::new(-sin_lon, cos_lon, 0.0);
        let north = DVec3::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat);
        let up = DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat);
        let origin = Geodetic { height_m: 0.0, ..at }.geocentric();
        Self { origin, geocentric_from_local: DMat3::from_cols(east, north, up) }
    }

    /// Converts meters from the earth's center to meters along these axes.
    #[must_use]
    pub fn p_in_local(&self, p_in_geocentric: DVec3) -> DVec3 {
        self.direction_in_local(p_in_geocentric - self.origin)
    }

    /// Converts meters along these axes to meters from the earth's center.
    #[must_use]
    pub fn p_in_geocentric(&self, p_in_local: DVec3) -> DVec3 {
        self.geocentric_from_local * p_in_local + self.origin
    }

    /// Converts a direction along the geocentric axes to one along these axes.
    #[must_use]
    pub fn direction_in_local(&self, direction_in_geocentric: DVec3) -> DVec3 {
        self.geocentric_from_local.transpose() * direction_in_geocentric
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place(longitude: f64, latitude: f64, height_m: f64) -> Geodetic {
        Geodetic { longitude: longitude.to_radians(), latitude: latitude.to_radians(), height_m }
    }

    #[test]
    fn places_that_are_known() {
        // The quarter meridians' ends, and a place from a table of EPSG's guidance note 7-2, section 4.1.1.
        assert_eq!(place(0.0, 0.0, 10.0).geocentric(), DVec3::new(EQUATOR_M + 10.0, 0.0, 0.0));
        assert!((place(0.0, 90.0, 0.0).geocentric().z - 6_356_752.314_245).abs() < 1e-6);
        let known = place(2.0 + 7.0 / 60.0 + 46.38 / 3600.0, 53.0 + 48.0 / 60.0 + 33.82 / 3600.0, 73.0);
        assert!((known.geocentric() - DVec3::new(3_771_793.968, 140_253.342, 5_124_304.349)).length() < 2e-3);
    }

    proptest! {
        #[test]
        fn there_and_back(lon in -180.0..180.0, lat in -90.0..90.0, height in -11_000.0..20_000.0) {
            let p = place(lon, lat, height).geocentric();
            let back = Geodetic::of_geocentric(p);
            prop_assert!((back.height_m - height).abs() < 1e-8, "{back:?}");
            prop_assert!((back.geocentric() - p).length() < 1e-8, "{back:?}");
        }

        #[test]
        fn a_local_frame_is_upright_and_keeps_distances(lon in -180.0..180.0, lat in -89.0..89.0, height in -400.0..9000.0) {
            let here = place(lon, lat, height);
            let frame = LocalFrame::at(here);
            prop_assert!((frame.p_in_local(here.geocentric()) - DVec3::Z * height).length() < 1e-8);
            let above = Geodetic { height_m: height + 6.0, ..here };
            prop_assert!((frame.p_in_local(above.geocentric()) - DVec3::Z * (height + 6.0)).length() < 1e-8);
            // A second of latitude is 31 meters to the north.
            let north = frame.p_in_local(place(lon, lat + 1.0 / 3600.0, height).geocentric());
            prop_assert!(north.x.abs() < 1e-6 && (30.7..31.1).contains(&north.y) && (north.z - height).abs() < 1e-3, "{north}");
            let p = DVec3::new(120.0, -340.0, 5.0);
            prop_assert!((frame.p_in_local(frame.p_in_geocentric(p)) - p).length() < 1e-8);
        }
    }
}
