//! Units of length as a user names them.

use super::crs::{FOOT_M, US_SURVEY_FOOT_M};
use base::choice::AUTO;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// Names of units, each with the meters of one.
const NAMED: [(&str, f64); 5] =
    [("m", 1.0), ("mm", 0.001), ("cm", 0.01), ("ft", FOOT_M), ("us-ft", US_SURVEY_FOOT_M)];

/// The unit of a file's coordinates: as the file states it, or as the user does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Unit {
    /// The unit that the file states.
    #[default]
    Auto,
    /// A unit of this many meters.
    Meters(f64),
}

impl Unit {
    /// Meters of one unit, if the user says so.
    #[must_use]
    pub fn meters(self) -> Option<f64> {
        match self {
            Self::Auto => None,
            Self::Meters(meters) => Some(meters),
        }
    }

    fn named(text: &str) -> Option<Self> {
        if text == AUTO {
            return Some(Self::Auto);
        }
        let named = NAMED.iter().find(|(name, _)| *name == text).map(|(_, meters)| *meters);
        named.or_else(|| text.parse().ok()).map(Self::Meters)
    }
}

impl Serialize for Unit {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => to.serialize_str(AUTO),
            Self::Meters(meters) => match NAMED.iter().find(|(_, unit)| unit == meters) {
                Some((name, _)) => to.serialize_str(name),
                None => to.serialize_f64(*meters),
            },
        }
    }
}

impl<'de> Deserialize<'de> for Unit {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Names)
    }
}

/// Takes a name or a number.
struct Names;

impl Visitor<'_> for Names {
    type Value = Unit;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("`auto`, `m`, `mm`, `cm`, `ft`, `us-ft` or a number of meters")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Unit, E> {
        Unit::named(text).ok_or_else(|| E::invalid_value(serde::de::Unexpected::Str(text), &self))
    }

    fn visit_f64<E: Error>(self, meters: f64) -> Result<Unit, E> {
        Ok(Unit::Meters(meters))
    }

    fn visit_i64<E: Error>(self, meters: i64) -> Result<Unit, E> {
        Ok(Unit::Meters(meters as f64))
    }

    fn visit_u64<E: Error>(self, meters: u64) -> Result<Unit, E> {
        Ok(Unit::Meters(meters as f64))
    }
}

/// A unit for people: "meter", "US survey foot (0.3048006 m)".
pub(super) fn words(unit_m: f64) -> String {
    let name = match unit_m {
        1.0 => return "meter".into(),
        0.001 => "millimeter",
        0.01 => "centimeter",
        FOOT_M => "foot",
        US_SURVEY_FOOT_M => return "US survey foot (0.3048006 m)".into(),
        _ => return format!("{unit_m} m"),
    };
    format!("{name} ({unit_m} m)")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Deserialize, Serialize)]
    struct Document {
        unit: Unit,
    }

    #[test]
    fn names_and_numbers_are_units_and_come_back() {
        for (text, unit) in [
            ("\"auto\"", Unit::Auto),
            ("\"mm\"", Unit::Meters(0.001)),
            ("\"us-ft\"", Unit::Meters(US_SURVEY_FOOT_M)),
            ("0.9144", Unit::Meters(0.9144)),
            ("\"0.9144\"", Unit::Meters(0.9144)),
            ("2", Unit::Meters(2.0)),
        ] {
            let read: Document = toml::from_str(&format!("unit = {text}")).unwrap();
            assert_eq!(read.unit, unit, "{text}");
            let again: Document = toml::from_str(&toml::to_string(&read).unwrap()).unwrap();
            assert_eq!(again.unit, unit, "{text}");
        }
        let error = toml::from_str::<Document>("unit = \"feet\"").err().unwrap().to_string();
        assert!(error.contains("expected `auto`, `m`, `mm`"), "{error}");
    }

    #[test]
    fn people_read_names() {
        assert_eq!(words(1.0), "meter");
        assert_eq!(words(0.001), "millimeter (0.001 m)");
        assert_eq!(words(US_SURVEY_FOOT_M), "US survey foot (0.3048006 m)");
        assert_eq!(words(0.5), "0.5 m");
    }
}
