//! Units in the names of columns and in remarks: "X [m]", "# units: mm".

use crate::crs::{FOOT_M, US_SURVEY_FOOT_M};

/// A name without the unit in brackets behind it.
pub(super) fn bare(name: &str) -> &str {
    name.split(['[', '(']).next().unwrap_or(name).trim()
}

/// Meters of the unit in brackets behind a name.
pub(super) fn of_name(name: &str) -> Option<f64> {
    let (_, unit) = name.split_once(['[', '('])?;
    meters(unit.trim_end().trim_end_matches([']', ')']))
}

/// Meters of the unit that a remark names.
pub(super) fn of_remark(remark: &str) -> Option<f64> {
    let lower = remark.to_ascii_lowercase();
    let text = lower.trim_start_matches(['#', '/', '%', '!', ' ']);
    let behind = text.strip_prefix("units").or_else(|| text.strip_prefix("unit"))?;
    meters(behind.trim_start().strip_prefix([':', '='])?)
}

fn meters(name: &str) -> Option<f64> {
    Some(match name.trim().to_ascii_lowercase().as_str() {
        "m" | "meter" | "meters" | "metre" | "metres" => 1.0,
        "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => 0.001,
        "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => 0.01,
        "ft" | "foot" | "feet" => FOOT_M,
        "us-ft" | "usft" | "ftus" | "us survey foot" | "us survey feet" => US_SURVEY_FOOT_M,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_where_they_stand() {
        assert_eq!((bare("Z [mm]"), of_name("Z [mm]")), ("Z", Some(0.001)));
        assert_eq!((bare("x(ft)"), of_name("x(ft)")), ("x", Some(FOOT_M)));
        assert_eq!((bare("x"), of_name("x"), of_name("x (raw)")), ("x", None, None));
        assert_eq!(of_remark("# Units: Meters"), Some(1.0));
        assert_eq!(of_remark("units of length"), None);
    }
}
