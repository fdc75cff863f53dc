//! Coordinate systems as converters note them: PROJ's strings, numbers of the EPSG, or well-known text.

use super::{Angle, Axes, Crs, from_wkt, registered};

/// Meters of the units of length that PROJ has words for.
const UNITS_M: [(&str, f64); 7] = [
    ("m", 1.0),
    ("km", 1000.0),
    ("cm", 0.01),
    ("mm", 0.001),
    ("ft", super::FOOT_M),
    ("us-ft", super::US_SURVEY_FOOT_M),
    ("yd", 3.0 * super::FOOT_M),
];

/// Reads a coordinate system from text of any of these kinds.
pub(crate) fn from_text(text: &str) -> Crs {
    let text = text.trim();
    if text.contains('[') {
        return from_wkt(text.as_bytes());
    }
    if text.contains("+proj") || text.contains("+init") {
        return from_proj(text);
    }
    let known =
        text.get(..5).filter(|start| start.eq_ignore_ascii_case("EPSG:")).map_or(text, |_| &text[5..]);
    match known.trim().parse().ok().and_then(registered) {
        Some(crs) => crs,
        None => Crs { name: Some(text.to_owned()).filter(|name| !name.is_empty()), ..Crs::default() },
    }
}

/// Reads a string of PROJ.
fn from_proj(text: &str) -> Crs {
    let value = |key: &str| {
        text.split_whitespace().find_map(|word| {
            let word = word.strip_prefix('+')?;
            let (found, value) = word.split_once('=').unwrap_or((word, ""));
            (found == key).then_some(value)
        })
    };
    let number = |key| value(key).and_then(|number| number.parse::<f64>().ok());
    let init = value("init").and_then(|init| init.rsplit(':').next()?.parse().ok());
    if let Some(crs) = init.or_else(|| utm(&value)).and_then(registered) {
        return crs;
    }
    let axes = match value("proj").unwrap_or_default() {
        "longlat" | "latlong" | "lonlat" | "latlon" => Axes::Geographic(Angle::Degree),
        "geocent" | "cart" => Axes::Geocentric,
        _ => Axes::Planar,
    };
    let unit =
        |word: Option<&str>| UNITS_M.iter().find(|(name, _)| word == Some(name)).map(|(_, unit_m)| *unit_m);
    let unit_m = number("to_meter").or_else(|| unit(value("units")));
    let vertical_unit_m = number("vto_meter").or_else(|| unit(value("vunits")));
    Crs::new(None, Some(text.to_owned()), axes, unit_m, vertical_unit_m)
}

/// The EPSG's number of a zone of UTM on WGS 84.
fn utm<'a>(value: &impl Fn(&str) -> Option<&'a str>) -> Option<u32> {
    let zone: u32 = value("zone")?.parse().ok()?;
    let is_wgs84 =
        value("datum") == Some("WGS84") || value("datum").is_none() && value("ellps") == Some("WGS84");
    let is_in_meters = value("to_meter").is_none() && value("units").is_none_or(|units| units == "m");
    let is_utm = value("proj") == Some("utm") && is_wgs84 && is_in_meters && (1..=60).contains(&zone);
    let hemisphere = if value("south").is_some() { 32700 } else { 32600 };
    is_utm.then_some(hemisphere + zone)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn systems_are_named_in_all_ways() {
        let name = |text: &str| from_text(text).name.unwrap_or_default();
        for text in [
            "EPSG:32633",
            "epsg:32633",
            "32633",
            "+init=epsg:32633",
            "+proj=utm +zone=33 +datum=WGS84 +units=m",
        ] {
            assert_eq!(name(text), "EPSG:32633, WGS 84 / UTM zone 33N", "{text}");
        }
        assert_eq!(name("+proj=utm +zone=33 +south +ellps=WGS84"), "EPSG:32733, WGS 84 / UTM zone 33S");
        let feet = "+proj=utm +zone=33 +datum=WGS84 +units=us-ft +vunits=m";
        let crs = from_text(feet);
        assert_eq!((crs.name.as_deref(), crs.unit_m), (Some(feet), Some(1200.0 / 3937.0)));
        assert_eq!((crs.vertical_unit_m, crs.axes), (Some(1.0), Some(Axes::Planar)));
        assert_eq!(from_text("+proj=longlat +datum=WGS84").axes, Some(Axes::Geographic(Angle::Degree)));
        assert_eq!(from_text("+proj=geocent").axes, Some(Axes::Geocentric));
        assert_eq!(name(r#"PROJCS["Lambert",UNIT["metre",1]]"#), "Lambert");
        assert_eq!(name("our site"), "our site");
        assert_eq!(from_text(" "), Crs::default());
        assert_eq!(name("+proj=utm +zone=99 +datum=WGS84"), "+proj=utm +zone=99 +datum=WGS84");
        assert_eq!(name("ä€😀EPSG"), "ä€😀EPSG");
    }
}
