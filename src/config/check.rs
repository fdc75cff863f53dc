//! Checks which values make sense: by the table's ranges, and by what two numbers of one setting must not say
//! together.

use super::{Config, Setting};
use toml::Value;

/// A setting whose value makes no sense.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Problem {
    /// Dotted key.
    pub key: &'static str,
    /// Continues a sentence that starts with the key.
    pub problem: String,
}

/// Checks every value whose type allows more than makes sense.
pub(super) fn check(config: &Config) -> Result<(), Problem> {
    let values = config.to_table();
    for setting in Setting::all() {
        let value = &values[setting.section][setting.name];
        if let Some(problem) = setting.range.and_then(|range| out_of(range, value)) {
            return Err(Problem { key: setting.key, problem });
        }
    }
    let ring_deg = config.fovea.ring_deg;
    if ring_deg[0] > ring_deg[1] {
        let problem = format!("is {ring_deg:?}, but the inner ring must end first");
        return Err(Problem { key: "fovea.ring_deg", problem });
    }
    let threshold_px = config.lod.threshold_px;
    if !threshold_px.is_sorted() {
        let problem = format!("is {threshold_px:?}, but no ring may want more detail than the one inside it");
        return Err(Problem { key: "lod.threshold_px", problem });
    }
    let [outwards, inwards, up, down] = config.simulated.fov_deg;
    if outwards + inwards < 1.0 || up + down < 1.0 {
        let problem = "leaves less than a degree to see: outwards + inwards and up + down must be more";
        return Err(Problem { key: "simulated.fov_deg", problem: problem.into() });
    }
    Ok(())
}

/// Says what is wrong with a value that must be within a range, or with the numbers in it. NaN and the infinities are
/// in no range. A name stands for a value that is in range.
fn out_of([least, most]: [f64; 2], value: &Value) -> Option<String> {
    let is_in = |number: f64| (least..=most).contains(&number);
    match value {
        Value::Float(number) if !is_in(*number) => {
            Some(format!("is {number}, but must be from {least} to {most}"))
        }
        Value::Integer(number) if !is_in(*number as f64) => {
            Some(format!("is {number}, but must be from {least} to {most}"))
        }
        Value::Array(items) if items.iter().any(|item| out_of([least, most], item).is_some()) => {
            Some(format!("is {value}, but each must be from {least} to {most}"))
        }
        _ => None,
    }
}
