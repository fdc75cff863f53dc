//! GeoTIFF keys, as LAS files have them.

use super::units::{angle, length_m};
use super::{Angle, Axes, Crs};

/// Reads a coordinate system from GeoTIFF keys: the key directory, its numbers and its texts.
pub(crate) fn from_geotiff(keys: &[u8], doubles: &[u8], texts: &[u8]) -> Crs {
    let u16_at = |at: usize| keys.get(at..at + 2).map(|b| u16::from_le_bytes([b[0], b[1]]));
    let entries = usize::from(u16_at(6).unwrap_or(0)).min(keys.len() / 8);
    let find = |wanted: u16| {
        (1..=entries)
            .map(|index| 8 * index)
            .find(|&at| u16_at(at) == Some(wanted))
            .and_then(|at| Some((u16_at(at + 2)?, usize::from(u16_at(at + 4)?), u16_at(at + 6)?)))
    };
    let short = |key: u16| find(key).filter(|&(place, ..)| place == 0).map(|(.., value)| value);
    let text = |key: u16| {
        let (_, count, start) = find(key).filter(|&(place, ..)| place == 34737)?;
        let bytes = texts.get(usize::from(start)..)?;
        let text = String::from_utf8_lossy(&bytes[..count.min(bytes.len())]).into_owned();
        let text = text.trim_matches(|c: char| c == '|' || c == '\0' || c.is_whitespace()).to_owned();
        (!text.is_empty() && !text.chars().any(char::is_control)).then_some(text)
    };
    let double = |key: u16| {
        let (.., start) = find(key).filter(|&(place, ..)| place == 34736)?;
        let at = 8 * usize::from(start);
        doubles.get(at..)?.first_chunk().map(|bytes| f64::from_le_bytes(*bytes))
    };
    let unit_m = short(3076).and_then(length_m).or_else(|| double(3077));
    let vertical_unit_m = short(4099).and_then(length_m);
    let angle = short(2054).and_then(angle);
    let geographic = Axes::Geographic(angle.unwrap_or(Angle::Degree));
    let (model, projected, geodetic) = (short(1024), short(3072).map(u32::from), short(2048).map(u32::from));
    let axes = match model {
        // Model types: 1 projected, 2 geographic, 3 geocentric.
        Some(3) => Axes::Geocentric,
        Some(2) if projected.is_none() => geographic,
        None if projected.is_none() && geodetic.is_some() => geographic,
        None if projected.is_none() && unit_m.is_none() => return Crs { vertical_unit_m, ..Crs::default() },
        _ => Axes::Planar,
    };
    let on_earth = axes != Axes::Planar;
    let code = if on_earth { geodetic } else { projected };
    let citation =
        if on_earth { text(2049).or_else(|| text(1026)) } else { text(3073).or_else(|| text(1026)) };
    let vertical_code = short(4096).map(u32::from);
    let lacks_angle = angle.is_none();
    let crs = Crs { vertical_code, lacks_angle, ..Crs::new(code, citation, axes, unit_m, vertical_unit_m) };
    crs.or_registered()
}

#[cfg(test)]
mod tests {
    use super::super::{FOOT_M, US_SURVEY_FOOT_M};
    use super::*;

    fn geotiff(keys: &[[u16; 4]], doubles: &[f64], texts: &str) -> Crs {
        let head = [1, 1, 0, keys.len() as u16];
        let words: Vec<u16> = head.into_iter().chain(keys.iter().flatten().copied()).collect();
        let keys: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        let doubles: Vec<u8> = doubles.iter().flat_map(|value| value.to_le_bytes()).collect();
        from_geotiff(&keys, &doubles, texts.as_bytes())
    }

    #[test]
    fn codes_units_and_citations() {
        let utm = geotiff(&[[1024, 0, 1, 1], [3072, 0, 1, 26910], [3073, 34737, 6, 0]], &[], "UTM10|x");
        assert_eq!(utm.name.as_deref(), Some("EPSG:26910, UTM10"));
        assert_eq!((utm.unit_m, utm.axes), (Some(1.0), Some(Axes::Planar)));
        let feet = geotiff(&[[1024, 0, 1, 1], [3072, 0, 1, 2992], [3076, 0, 1, 9002]], &[], "");
        assert_eq!(feet.unit_m, Some(0.3048));
        let own = geotiff(&[[1024, 0, 1, 1], [3072, 0, 1, 32767], [3077, 34736, 1, 1]], &[0.0, 0.5], "");
        assert_eq!((own.name, own.unit_m), (None, Some(0.5)));
        let degrees = geotiff(&[[1024, 0, 1, 2], [2048, 0, 1, 4326], [2049, 34737, 7, 0]], &[], "WGS 84|");
        assert_eq!(degrees.name.as_deref(), Some("EPSG:4326, WGS 84"));
        assert_eq!((degrees.unit_m, degrees.axes), (None, Some(Axes::Geographic(Angle::Degree))));
    }

    #[test]
    fn a_code_alone_tells_the_unit() {
        let projected = |code| geotiff(&[[1024, 0, 1, 1], [3072, 0, 1, code]], &[], "");
        for (code, unit_m) in
            [(2263, US_SURVEY_FOOT_M), (2992, FOOT_M), (32633, 1.0), (7415, 1.0), (2056, 1.0)]
        {
            assert_eq!(projected(code).unit_m, Some(unit_m), "{code}");
        }
        assert_eq!(projected(2263).name.as_deref(), Some("EPSG:2263, NAD83 / New York Long Island (ftUS)"));
        // What the file says itself wins; an unknown code says nothing.
        assert_eq!(geotiff(&[[3072, 0, 1, 2263], [3076, 0, 1, 9001]], &[], "").unit_m, Some(1.0));
        assert_eq!(projected(65000).unit_m, None);
    }

    #[test]
    fn units_of_every_number_are_known() {
        for (number, unit_m) in
            [(9005, 0.304_797_265_4), (9014, 1.8288), (9037, 0.914_391_796_2), (9093, 1609.344)]
        {
            let keys = [[1024, 0, 1, 1], [3072, 0, 1, 32767], [3076, 0, 1, number], [4099, 0, 1, number]];
            let crs = geotiff(&keys, &[], "");
            for found_m in [crs.unit_m, crs.vertical_unit_m] {
                assert!((found_m.unwrap_or_default() - unit_m).abs() < 1e-12, "{number}: {found_m:?}");
            }
        }
        let angle = |keys: &[[u16; 4]]| geotiff(keys, &[], "").axes;
        let gradian = Some(Axes::Geographic(Angle::Gradian));
        assert_eq!(angle(&[[1024, 0, 1, 2], [2048, 0, 1, 32767], [2054, 0, 1, 9105]]), gradian);
        assert_eq!(angle(&[[1024, 0, 1, 2], [2048, 0, 1, 4807]]), gradian, "by the system's number");
        let stated = angle(&[[1024, 0, 1, 2], [2048, 0, 1, 4807], [2054, 0, 1, 9102]]);
        assert_eq!(stated, Some(Axes::Geographic(Angle::Degree)), "what the file says itself wins");
    }

    #[test]
    fn heights_have_their_own_unit() {
        let with =
            |key: [u16; 4]| geotiff(&[[1024, 0, 1, 1], [3072, 0, 1, 26918], key], &[], "").vertical_unit_m;
        assert_eq!(with([4099, 0, 1, 9003]), Some(US_SURVEY_FOOT_M));
        assert_eq!(with([4099, 0, 1, 9001]), Some(1.0));
        assert_eq!(with([4096, 0, 1, 6360]), Some(US_SURVEY_FOOT_M));
        assert_eq!(with([4096, 0, 1, 5703]), Some(1.0));
        assert_eq!(with([4096, 0, 1, 5030]), None, "an ellipsoid by its old number");
        assert_eq!(with([1025, 0, 1, 1]), None);
    }

    #[test]
    fn geocentric_by_model_or_by_code() {
        for keys in [
            &[[1024, 0, 1, 3], [2048, 0, 1, 4978]][..],
            &[[1024, 0, 1, 2], [2048, 0, 1, 4978]],
            &[[2048, 0, 1, 7930]],
        ] {
            let crs = geotiff(keys, &[], "");
            assert_eq!((crs.axes, crs.unit_m), (Some(Axes::Geocentric), Some(1.0)), "{keys:?}");
        }
    }

    #[test]
    fn nonsense_is_no_system() {
        assert_eq!(from_geotiff(&[1, 0, 1, 0, 0, 0, 255, 255, 0], &[], &[]), Crs::default());
    }
}
