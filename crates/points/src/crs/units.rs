//! Units by their numbers in the EPSG's register, as GeoTIFF keys have them.

use super::{Angle, FOOT_M, US_SURVEY_FOOT_M};

/// Feet of several times and countries: meters of one foot, and the numbers of the foot, the yard (3 feet), the chain
/// (66 feet) and the link (a hundredth of a chain). 0 stands for no number.
const FEET: [(f64, [u16; 4]); 14] = [
    (FOOT_M, [9002, 9096, 9097, 9098]),
    (US_SURVEY_FOOT_M, [9003, 0, 9033, 9034]),
    // Modified American.
    (12.000_458_4 / 39.37, [9004, 0, 0, 0]),
    // Clarke.
    (0.304_797_265_4, [9005, 9037, 9038, 9039]),
    // Sears 1922, and its truncated form.
    (12.0 / 39.370_147, [9041, 9040, 9042, 9043]),
    (0.914_398 / 3.0, [9300, 9099, 9301, 9302]),
    // Benoit 1895 A and B.
    (0.914_399_2 / 3.0, [9051, 9050, 9052, 9053]),
    (12.0 / 39.370_113, [9061, 9060, 9062, 9063]),
    // British 1865, British 1936, Gold Coast.
    (0.914_402_5 / 3.0, [9070, 0, 0, 0]),
    (0.304_800_749_1, [9095, 0, 0, 0]),
    (6_378_300.0 / 20_926_201.0, [9094, 0, 0, 0]),
    // Indian, Indian 1937, Indian 1962; Indian 1975 is in [`OTHERS`].
    (12.0 / 39.370_142, [9080, 9084, 0, 0]),
    (0.304_798_41, [9081, 9085, 0, 0]),
    (0.304_799_6, [9082, 9086, 0, 0]),
];

/// Meters of all other units of length.
const OTHERS: [(u16, f64); 11] = [
    (1025, 0.001),
    (1033, 0.01),
    (9001, 1.0),
    (9014, 1.828_8),
    (9030, 1852.0),
    // German legal meter.
    (9031, 1.000_013_596_5),
    (9035, 5280.0 * US_SURVEY_FOOT_M),
    (9036, 1000.0),
    (9083, 0.304_799_5),
    (9087, 0.914_398_5),
    (9093, 5280.0 * FOOT_M),
];

/// Numbers from the first version of GeoTIFF that the register gave up, each with the number that means the same.
const OLDER: [(u16, u16); 8] = [
    (9006, 9080),
    (9008, 9053),
    (9009, 9043),
    (9010, 9052),
    (9011, 9042),
    (9012, 9040),
    (9013, 9084),
    (9015, 9030),
];

/// Meters of the unit of length with this number.
pub(super) fn length_m(number: u16) -> Option<f64> {
    let number = OLDER.iter().find(|(older, _)| *older == number).map_or(number, |(_, newer)| *newer);
    let of_feet = FEET.iter().flat_map(|(foot_m, numbers)| {
        let times = [1.0, 3.0, 66.0, 0.66];
        std::iter::zip(*numbers, times).map(move |(number, times)| (number, times * foot_m))
    });
    of_feet.chain(OTHERS).find(|(known, _)| *known == number && number != 0).map(|(_, meters)| meters)
}

/// The unit of angle with this number.
pub(super) fn angle(number: u16) -> Option<Angle> {
    match number {
        9101 => Some(Angle::Radian),
        9102 | 9122 => Some(Angle::Degree),
        9105 | 9106 => Some(Angle::Gradian),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// All units of length that coordinate systems of the register have.
    fn of_register() -> BTreeMap<u16, f64> {
        let texts = (1000..40_000).filter_map(|code| epsg_utils::epsg_to_wkt2(code).ok());
        let units = texts.flat_map(|text| text.split("LENGTHUNIT[").skip(1));
        let unit = |unit: &str| {
            let mut words = unit.split(']').next()?.split(',').skip(1);
            let meters = words.next()?.parse().ok()?;
            Some((words.nth(1)?.parse().ok()?, meters))
        };
        units.filter_map(unit).collect()
    }

    #[test]
    fn lengths_are_the_registers() {
        let register = of_register();
        assert!(register.len() >= 15, "{register:?}");
        for (number, meters) in register {
            let known = length_m(number).unwrap_or_else(|| panic!("{number}: {meters} m"));
            assert!((known / meters - 1.0).abs() < 1e-14, "{number}: {known}, not {meters}");
        }
    }

    #[test]
    fn every_number_means_one_length_near_what_its_kind_has() {
        let feet = FEET.iter().flat_map(|(_, numbers)| numbers).copied().filter(|number| *number > 0);
        let mut numbers: Vec<u16> = feet.chain(OTHERS.map(|(number, _)| number)).collect();
        numbers.sort_unstable();
        assert!(numbers.windows(2).all(|pair| pair[0] < pair[1]), "twice: {numbers:?}");
        for (older, newer) in OLDER {
            assert!(!numbers.contains(&older) && numbers.contains(&newer), "{older}");
            assert_eq!(length_m(older), length_m(newer));
        }
        for (foot_m, _) in FEET {
            assert!((foot_m / FOOT_M - 1.0).abs() < 5e-5, "{foot_m}");
        }
        for (number, meters) in
            [(9037, 0.914_391_796_2), (9084, 0.914_398_530_744_440), (9062, 20.116_782_494_375_9)]
        {
            assert!((length_m(number).unwrap() / meters - 1.0).abs() < 1e-14, "{number}");
        }
        assert_eq!((length_m(9014), length_m(0), length_m(9102)), (Some(1.8288), None, None));
    }
}
