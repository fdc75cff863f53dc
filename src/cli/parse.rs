//! Values on the command line: points, sizes, colors, numbers in a range; and what is said of scans.

use crate::config::{PRESETS, Setting};
use crate::walk::headsets::Wish;
use base::choice::Choice;
use clap::builder::{PossibleValue, PossibleValuesParser, StyledStr, TypedValueParser};
use glam::DVec3;
use lab::LodMethod;
use std::str::FromStr;

/// Largest edge of a picture in pixels.
const MAX_EDGE_PX: u32 = 16_384;

/// Help text for the files that are one scan.
pub(super) fn scans_help() -> String {
    points::format_names("or") + " files; several are one scan"
}

/// Help text for a file that is measured with.
pub(super) fn scan_help() -> String {
    format!("A {} file to measure with [default: made-up ones]", points::format_names("or"))
}

/// Help text for `--preset`.
pub(super) fn presets_help() -> String {
    let presets = PRESETS.map(|preset| format!("{}: {}", preset.name, preset.meaning()));
    format!("Settings that belong together; may be repeated. {}", presets.join("; "))
}

/// Help text for an option that stands for a setting: what the setting means, and that its value is the default.
pub(super) fn setting_help(key: &str) -> String {
    // A key that is not in the table is a mistake of the option, which every test of the command line shows.
    let setting = Setting::find(key).expect("a setting");
    format!("{} [default: {key}]", setting.meaning())
}

/// Parses one of the values of a choice by its name.
pub(super) fn choice<T: Choice>() -> impl TypedValueParser<Value = T> {
    named(T::ALL.iter().copied().zip(T::NAMES.iter().copied().zip(T::meanings())))
}

/// Parses one of these values by its name; help says what each means.
fn named<T: Copy + Send + Sync + 'static>(
    values: impl IntoIterator<Item = (T, (&'static str, impl Into<StyledStr>))>,
) -> impl TypedValueParser<Value = T> {
    let (values, names): (Vec<T>, Vec<PossibleValue>) = values
        .into_iter()
        .map(|(value, (name, meaning))| (value, PossibleValue::new(name).help(meaning)))
        .unzip();
    let known: Vec<String> = names.iter().map(|name| name.get_name().to_owned()).collect();
    // The parser lets no other names through.
    PossibleValuesParser::new(names)
        .map(move |name| values[known.iter().position(|known| *known == name).expect("a known name")])
}

/// Parses whether to use something that may be absent. These are the names of [`Wish::Auto`], [`Wish::On`] and
/// [`Wish::Off`], with what they mean.
pub(super) fn wish(names: [(&'static str, &'static str); 3]) -> impl TypedValueParser<Value = Wish> {
    named([Wish::Auto, Wish::On, Wish::Off].into_iter().zip(names))
}

/// Parses whether there is level of detail, and by what.
pub(super) fn lod() -> impl TypedValueParser<Value = Option<LodMethod>> {
    let methods = LodMethod::ALL.map(Some);
    let words = LodMethod::NAMES.iter().copied().zip(LodMethod::meanings());
    let on_and_off = [
        (Some(LodMethod::Octree), ("on", "what matters is drawn, by an octree".to_owned())),
        (None, ("off", "every point is drawn".to_owned())),
    ];
    named(on_and_off.into_iter().chain(methods.into_iter().zip(words)))
}

/// Parses three parts between commas.
fn three<T: FromStr>(text: &str) -> Option<[T; 3]> {
    let parts: Vec<T> = text.split(',').map(|part| part.trim().parse().ok()).collect::<Option<_>>()?;
    parts.try_into().ok()
}

/// Parses `X,Y,Z`, three finite numbers.
pub(super) fn point(text: &str) -> Result<DVec3, String> {
    let point = three(text).map(DVec3::from_array).filter(|point| point.is_finite());
    point.ok_or_else(|| "write three numbers, X,Y,Z: for example 1.5,-2,0".into())
}

/// Parses `R,G,B`, each from 0 to 255.
pub(super) fn color(text: &str) -> Result<[u8; 3], String> {
    three(text).ok_or_else(|| "write three whole numbers from 0 to 255, R,G,B: for example 30,30,40".into())
}

/// Parses `WxH` in pixels.
pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let edges = text.split_once(['x', 'X', '×']);
    let size =
        edges.and_then(|(width, height)| Some([width.trim().parse().ok()?, height.trim().parse().ok()?]));
    size.filter(|size: &[u32; 2]| size.iter().all(|edge| (1..=MAX_EDGE_PX).contains(edge)))
        .ok_or_else(|| format!("write WIDTHxHEIGHT, each from 1 to {MAX_EDGE_PX}: for example 1920x1080"))
}

/// Parses a number for which `fits` holds.
fn number(text: &str, wanted: &str, fits: impl Fn(f64) -> bool) -> Result<f64, String> {
    let value = text.trim().parse().ok().filter(|value: &f64| value.is_finite() && fits(*value));
    value.ok_or_else(|| format!("write {wanted}"))
}

/// Parses millions of points: at least a thousand points, and no more than a cloud holds.
pub(super) fn millions(text: &str) -> Result<f64, String> {
    number(text, "millions of points from 0.001 to 2000: for example 1,4,16", |m| {
        (0.001..=2000.0).contains(&m)
    })
}

/// Parses a field of view in degrees.
pub(super) fn field_of_view(text: &str) -> Result<f64, String> {
    number(text, "degrees, more than 0 and less than 180", |deg| deg > 0.0 && deg < 180.0)
}

/// Parses half angles `OUT,IN,UP,DOWN` in degrees.
pub(super) fn half_angles(text: &str) -> Result<[f64; 4], String> {
    let angles: Option<Vec<f64>> = text.split(',').map(|angle| angle.trim().parse().ok()).collect();
    let angles: Option<[f64; 4]> = angles.and_then(|angles| angles.try_into().ok());
    let seen = |a: &[f64; 4]| a.iter().all(|v| v.abs() < 90.0) && a[0] + a[1] > 0.0 && a[2] + a[3] > 0.0;
    angles
        .filter(seen)
        .ok_or_else(|| "write four angles below 90 degrees, OUT,IN,UP,DOWN: for example 50,40,45,45".into())
}

/// Parses a distance between the eyes.
pub(super) fn eye_distance(text: &str) -> Result<f64, String> {
    number(text, "a distance from 0 upwards", |distance| distance >= 0.0)
}

/// Parses a time in seconds.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    number(text, "seconds, more than 0 and at most 1e9", |seconds| seconds > 0.0 && seconds <= 1e9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_meant() {
        assert_eq!(point("1.5, -2,1e6"), Ok(DVec3::new(1.5, -2.0, 1e6)));
        assert_eq!(color("0,128,255"), Ok([0, 128, 255]));
        assert_eq!(size("1920x1080"), Ok([1920, 1080]));
        assert_eq!(field_of_view("60"), Ok(60.0));
        assert_eq!(half_angles("50, 40,45,45.5"), Ok([50.0, 40.0, 45.0, 45.5]));
        assert_eq!(eye_distance("0"), Ok(0.0));
        assert_eq!(seconds("0.5"), Ok(0.5));
    }

    #[test]
    fn values_that_are_not() {
        for text in ["", "1,2", "1,2,3,4", "1,2,x", "1,2,nan", "inf,0,0"] {
            assert!(point(text).is_err(), "{text}");
        }
        for text in ["256,0,0", "-1,0,0", "1,2", "1.5,0,0"] {
            assert!(color(text).is_err(), "{text}");
        }
        for text in ["0x5", "5x0", "5", "x", "20000x1", "-5x5", "99999999999x1"] {
            assert!(size(text).is_err(), "{text}");
        }
        assert!(
            field_of_view("0").is_err() && field_of_view("180").is_err() && field_of_view("nan").is_err()
        );
        for text in ["1,2,3", "90,1,1,1", "-5,5,1,1", "1,1,nan,1", "x"] {
            assert!(half_angles(text).is_err(), "{text}");
        }
        assert!(eye_distance("-0.1").is_err() && seconds("0").is_err() && seconds("inf").is_err());
    }
}
