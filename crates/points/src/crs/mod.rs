//! Coordinate systems as scans name them, by GeoTIFF keys or well-known text, read into a name, axes and units. The
//! EPSG's register says by the system's number what a file leaves out.

mod geotiff;
mod proj;
mod units;
mod wkt;

pub(crate) use geotiff::from_geotiff;
pub(crate) use proj::from_text;
pub(crate) use wkt::from_wkt;

/// Meters of a US survey foot.
pub(crate) const US_SURVEY_FOOT_M: f64 = 1200.0 / 3937.0;
/// Meters of an international foot.
pub(crate) const FOOT_M: f64 = 0.3048;

/// What x, y and z of a coordinate system are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// Lengths across and a height.
    Planar,
    /// Longitude, latitude and a height.
    Geographic(Angle),
    /// Latitude, longitude and a height. No coordinate system is read as this, but some files store it.
    LatitudeFirst(Angle),
    /// Lengths from the earth's center: to longitude 0 on the equator, to 90 degrees east, to the north pole.
    Geocentric,
}

/// A unit of angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Angle {
    /// A turn has 360.
    Degree,
    /// A turn has 400.
    Gradian,
    /// A turn has 2 π.
    Radian,
}

impl Angle {
    /// Radians of one unit.
    #[must_use]
    pub fn radians(self) -> f64 {
        match self {
            Self::Degree => std::f64::consts::PI / 180.0,
            Self::Gradian => std::f64::consts::PI / 200.0,
            Self::Radian => 1.0,
        }
    }

    /// Name for people: "degree".
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Degree => "degree",
            Self::Gradian => "gradian",
            Self::Radian => "radian",
        }
    }

    /// The unit that is about this many radians, which files round. Degrees unless another unit fits.
    fn of_radians(radians: Option<f64>) -> Self {
        let fits = |unit: &Self| radians.is_some_and(|value| (value / unit.radians() - 1.0).abs() < 0.01);
        [Self::Gradian, Self::Radian].into_iter().find(fits).unwrap_or(Self::Degree)
    }
}

/// What could be found out about a coordinate system.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Crs {
    /// Name for people: "EPSG:26910, NAD83 / UTM zone 10N".
    pub name: Option<String>,
    /// Meters per unit of x and y; `None` also for angles.
    pub unit_m: Option<f64>,
    /// Meters per unit of height, where that is stated by itself.
    pub vertical_unit_m: Option<f64>,
    /// What x, y and z are.
    pub axes: Option<Axes>,
    /// True if the unit of angles is not stated, so that degrees were taken.
    lacks_angle: bool,
    code: Option<u32>,
    vertical_code: Option<u32>,
}

impl Crs {
    fn new(
        code: Option<u32>,
        name: Option<String>,
        axes: Axes,
        unit_m: Option<f64>,
        vertical_unit_m: Option<f64>,
    ) -> Self {
        let code = code.filter(|&code| code > 0 && code != 32767);
        let named = name.filter(|name| !name.is_empty() && name != "unnamed" && name != "unknown");
        let name = named_with(code, named);
        let [unit_m, vertical_unit_m] = [unit_m, vertical_unit_m].map(|unit| unit.and_then(length));
        let unit_m = unit_m.filter(|_| !matches!(axes, Axes::Geographic(_)));
        Self { name, unit_m, vertical_unit_m, axes: Some(axes), code, ..Self::default() }
    }

    /// Adds what the register says by the numbers, where the file says nothing itself.
    fn or_registered(self) -> Self {
        let system = self.code.and_then(registered).unwrap_or_default();
        let vertical = self.vertical_code.and_then(registered).unwrap_or_default();
        // The number of a geocentric system counts more than the kind that the file states. A number also tells the
        // unit of angle where the file names none.
        let counts_more = |axes: &Axes| match axes {
            Axes::Geocentric => true,
            Axes::Geographic(_) | Axes::LatitudeFirst(_) => self.lacks_angle,
            Axes::Planar => false,
        };
        let axes = system.axes.filter(counts_more).or(self.axes);
        let says_name = self.name.as_ref().is_some_and(|name| name.contains(", "));
        Self {
            name: if says_name { self.name } else { system.name.or(self.name) },
            unit_m: self.unit_m.or(system.unit_m).filter(|_| !matches!(axes, Some(Axes::Geographic(_)))),
            vertical_unit_m: self.vertical_unit_m.or(vertical.vertical_unit_m).or(system.vertical_unit_m),
            axes,
            ..self
        }
    }

    /// Adds what `other` says, where this says nothing.
    pub fn or(self, other: Self) -> Self {
        if self.name.is_none() && self.unit_m.is_none() && self.axes.is_none() {
            return Self { vertical_unit_m: self.vertical_unit_m.or(other.vertical_unit_m), ..other };
        }
        let unit_m = self.unit_m.or(other.unit_m.filter(|_| !matches!(self.axes, Some(Axes::Geographic(_)))));
        let vertical_unit_m = self.vertical_unit_m.or(other.vertical_unit_m);
        Self {
            name: self.name.or(other.name),
            unit_m,
            vertical_unit_m,
            axes: self.axes.or(other.axes),
            ..self
        }
    }
}

fn named_with(code: Option<u32>, name: Option<String>) -> Option<String> {
    match (code, name) {
        (Some(code), Some(name)) => Some(format!("EPSG:{code}, {name}")),
        (Some(code), None) => Some(format!("EPSG:{code}")),
        (None, name) => name,
    }
}

/// Returns a length in meters if it makes sense. Feet get back the last digits that files round off.
fn length(meters: f64) -> Option<f64> {
    let close = |unit: &f64| (meters / unit - 1.0).abs() < 1e-7;
    let unit_m = [FOOT_M, US_SURVEY_FOOT_M].into_iter().find(close).unwrap_or(meters);
    Some(unit_m).filter(|unit| unit.is_finite() && *unit > 0.0)
}

/// The systems that have these numbers in the EPSG's register: of places, and of heights.
pub(crate) fn from_epsg(code: Option<u32>, vertical_code: Option<u32>) -> Crs {
    let system = code.and_then(registered).unwrap_or_default();
    let vertical = vertical_code.and_then(registered).unwrap_or_default();
    Crs { vertical_unit_m: vertical.vertical_unit_m.or(system.vertical_unit_m), ..system }
}

/// What the EPSG's register has under a number.
fn registered(code: u32) -> Option<Crs> {
    let text = epsg_utils::epsg_to_wkt2(i32::try_from(code).ok()?).ok()?;
    Some(wkt::read(text.as_bytes()))
}
