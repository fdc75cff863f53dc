//! Which attributes the scans of a file have together, and how their values become columns of one type.

use super::description::E57Scan;
use super::stream::{NumberCoding, Stream, whole_type};
use crate::column::Type;
use crate::{Attribute, Field, Schema};

pub(super) const CARTESIAN: [&str; 3] = ["cartesianX", "cartesianY", "cartesianZ"];
pub(super) const SPHERICAL: [&str; 3] = ["sphericalRange", "sphericalAzimuth", "sphericalElevation"];
pub(super) const COLOR: [&str; 3] = ["colorRed", "colorGreen", "colorBlue"];
pub(super) const INTENSITY: &str = "intensity";
pub(super) const RETURN_INDEX: &str = "returnIndex";
pub(super) const RETURN_COUNT: &str = "returnCount";
pub(super) const TIME: &str = "timeStamp";
/// The names of the extension for normals, behind whatever prefix.
const NORMAL: [&str; 3] = ["normalX", "normalY", "normalZ"];
/// A name that some programs give to classes, behind whatever prefix.
const CLASSIFICATION: &str = "classification";
/// States of coordinates, which no column needs: points that are not valid are left out.
const STATES: [&str; 2] = ["cartesianInvalidState", "sphericalInvalidState"];
/// Least white of colors that stay as they are stored.
const LEAST_WHITE: f64 = 255.0;

/// An attribute of a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct E57Attribute {
    pub field: Field,
    pub origin: Origin,
}

/// Where an attribute's values come from.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Origin {
    Colors,
    Intensity,
    /// Three streams, which the scan's pose turns.
    Normals,
    /// The number of the scan.
    Station,
    /// A stream of numbers from 0, which become numbers from 1 or more.
    Count {
        stream: String,
        first: i64,
    },
    /// A stream of seconds since the scan began.
    Time,
    /// A stream as it is.
    Stream(String),
}

/// How a file stores colors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PointColor {
    Absent,
    /// Whole numbers that stay; with the largest that they can be, if it is known.
    Stored(Option<u16>),
    /// Others, which become 0 to 1 by their limits.
    Floats,
}

/// How a file stores intensities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PointIntensity {
    Absent,
    /// Whole numbers of 16 bits at most.
    Stored,
    /// Other whole numbers.
    Whole,
    Floats,
}

/// The streams of these names; `None` if the scan lacks one.
pub(super) fn three(scan: &E57Scan, names: [&str; 3]) -> Option<[usize; 3]> {
    let [a, b, c] = names.map(|name| scan.stream(name).map(|(number, _)| number));
    Some([a?, b?, c?])
}

/// The streams of a scan's normals.
pub(super) fn normals(scan: &E57Scan) -> Option<[usize; 3]> {
    let named = |name: &str| scan.streams.iter().position(|stream| local(&stream.name) == name);
    let [x, y, z] = NORMAL.map(named);
    Some([x?, y?, z?])
}

/// The name of a stream without its prefix.
fn local(name: &str) -> &str {
    name.rsplit(':').next().unwrap_or(name)
}

/// The ends of a channel's values: those that the file states, or else those that its type has.
pub(super) fn color_ends(scan: &E57Scan, channel: usize, stream: &Stream) -> Option<(f64, f64)> {
    scan.color_limits[channel].or(match stream.encoding {
        NumberCoding::Whole { min, max, scale, offset } if min < max && max <= u16::MAX.into() => {
            Some((offset + scale * min as f64, offset + scale * max as f64))
        }
        _ => None,
    })
}

/// How the scans of a file store colors.
pub(super) fn colors(scans: &[E57Scan]) -> PointColor {
    let mut all = None;
    for scan in scans {
        let Some(numbers) = three(scan, COLOR) else { continue };
        for (channel, stream) in numbers.map(|number| &scan.streams[number]).into_iter().enumerate() {
            let ends = color_ends(scan, channel, stream);
            let is_white = |white: f64| {
                let is_whole = white.fract() == 0.0 && (LEAST_WHITE..=65535.0).contains(&white);
                is_whole && (white as u32 + 1).is_power_of_two()
            };
            let stays = stream.encoding.is_plain_whole()
                && ends.is_none_or(|(low, high)| low == 0.0 && is_white(high));
            let white = ends.map(|(_, high)| high as u16);
            if !stays || all.is_some_and(|(other, _)| other != white) {
                return PointColor::Floats;
            }
            // Values of 16 bits are often 8 bits in wider fields, which only all of them together tell.
            let holds_more =
                stream.encoding.range().zip(white).is_none_or(|((_, most), white)| most > white.into());
            let is_sure = !holds_more && white.is_some_and(|white| white < u16::MAX);
            all = Some((white, is_sure && all.is_none_or(|(_, is_sure)| is_sure)));
        }
    }
    match all {
        None => PointColor::Absent,
        Some((white, is_sure)) => PointColor::Stored(white.filter(|_| is_sure)),
    }
}

/// How the scans of a file store intensities.
pub(super) fn intensities(scans: &[E57Scan]) -> PointIntensity {
    let streams = || scans.iter().filter_map(|scan| Some(scan.stream(INTENSITY)?.1.encoding));
    let is_16_bits = |encoding: NumberCoding| {
        let range = encoding.range().filter(|_| encoding.is_plain_whole());
        range.is_some_and(|(low, high)| low >= 0 && high <= u16::MAX.into())
    };
    if streams().next().is_none() {
        PointIntensity::Absent
    } else if streams().all(is_16_bits) {
        PointIntensity::Stored
    } else if streams().all(|encoding| encoding.is_plain_whole()) {
        PointIntensity::Whole
    } else {
        PointIntensity::Floats
    }
}

/// All attributes of a file.
pub(super) fn all(scans: &[E57Scan]) -> Vec<E57Attribute> {
    let mut all = Vec::new();
    let mut used: Vec<&str> = CARTESIAN.into_iter().chain(STATES).collect();
    let mut add = |attribute, kind, origin| {
        all.push(E57Attribute { field: Field::plain(attribute, kind), origin });
    };
    if colors(scans) != PointColor::Absent {
        add(Attribute::Color, Type::U16x3, Origin::Colors);
        used.extend(COLOR);
    }
    let intensities = intensities(scans);
    if intensities != PointIntensity::Absent {
        add(Attribute::Intensity, Type::U16, Origin::Intensity);
        used.extend((intensities == PointIntensity::Stored).then_some(INTENSITY));
    }
    if scans.iter().any(|scan| normals(scan).is_some()) {
        add(Attribute::Normal, Type::F32x3, Origin::Normals);
    }
    let of = |name: &str| {
        let streams = scans.iter().flat_map(|scan| &scan.streams).filter(|stream| stream.name == name);
        streams.map(|stream| stream.encoding).collect::<Vec<NumberCoding>>()
    };
    for (name, attribute, first) in
        [(RETURN_INDEX, Attribute::ReturnNumber, 1), (RETURN_COUNT, Attribute::NumReturns, 0)]
    {
        let encodings = of(name);
        if !encodings.is_empty() && encodings.iter().all(NumberCoding::is_plain_whole) {
            add(attribute, Type::U8, Origin::Count { stream: name.to_owned(), first });
            used.push(name);
        }
    }
    let mut timed = scans.iter().filter(|scan| scan.stream(TIME).is_some()).peekable();
    if timed.peek().is_some() && timed.all(|scan| scan.start_s.is_some()) {
        add(Attribute::GpsTime, Type::F64, Origin::Time);
        used.push(TIME);
    }
    add(Attribute::SourceId, Type::U16, Origin::Station);
    let mut named: Vec<&str> = Vec::new();
    for scan in scans {
        // Angles and ranges are attributes where the coordinates are not made of them.
        let of_place = if three(scan, CARTESIAN).is_some() { &[][..] } else { &SPHERICAL };
        let is_normal = |name: &str| normals(scan).is_some() && NORMAL.contains(&local(name));
        for stream in &scan.streams {
            let name = &stream.name[..];
            if !used.contains(&name)
                && !named.contains(&name)
                && !of_place.contains(&name)
                && !is_normal(name)
            {
                named.push(name);
            }
        }
    }
    for name in named {
        let (kind, scale, offset) = joint(&of(name));
        let is_class = local(name) == CLASSIFICATION && kind == Type::U8 && (scale, offset) == (1.0, 0.0);
        let has_class =
            all.iter().any(|other: &E57Attribute| other.field.attribute == Attribute::Classification);
        let attribute = if is_class && !has_class {
            Attribute::Classification
        } else {
            Attribute::Named(name.to_owned())
        };
        let field = Field { scale, offset, is_detail: name == INTENSITY, ..Field::plain(attribute, kind) };
        all.push(E57Attribute { field, origin: Origin::Stream(name.to_owned()) });
    }
    all
}

/// The attributes of a file as its schema.
pub(super) fn schema(attributes: &[E57Attribute]) -> Schema {
    Schema {
        fields: attributes.iter().map(|attribute| attribute.field.clone()).collect(),
        unread: Vec::new(),
    }
}

/// The type, scale and offset of a column for numbers that are stored in all these ways.
fn joint(encodings: &[NumberCoding]) -> (Type, f64, f64) {
    let ranges: Option<Vec<(i64, i64)>> = encodings.iter().map(NumberCoding::range).collect();
    let scaling = encodings.first().map_or((1.0, 0.0), NumberCoding::scaling);
    match ranges {
        Some(ranges) if encodings.iter().all(|encoding| encoding.scaling() == scaling) => {
            let both = |a: (i64, i64), b: (i64, i64)| (a.0.min(b.0), a.1.max(b.1));
            (whole_type(ranges.into_iter().reduce(both).unwrap_or((0, 0))), scaling.0, scaling.1)
        }
        _ if encodings.iter().all(|encoding| *encoding == NumberCoding::Single) => (Type::F32, 1.0, 0.0),
        _ => (Type::F64, 1.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole(min: i64, max: i64) -> NumberCoding {
        NumberCoding::Whole { min, max, scale: 1.0, offset: 0.0 }
    }

    fn scan(streams: &[(&str, NumberCoding)]) -> E57Scan {
        let stream = |(name, encoding): &(&str, NumberCoding)| Stream {
            name: (*name).to_owned(),
            encoding: *encoding,
        };
        E57Scan { streams: streams.iter().map(stream).collect(), ..E57Scan::default() }
    }

    fn colored(encoding: NumberCoding, limits: Option<(f64, f64)>) -> E57Scan {
        E57Scan { color_limits: [limits; 3], ..scan(&COLOR.map(|name| (name, encoding))) }
    }

    #[test]
    fn colors_of_whole_bits_stay_and_others_go_by_their_limits() {
        let of = |encoding, limits| colors(&[colored(encoding, limits)]);
        assert_eq!(of(whole(0, 255), None), PointColor::Stored(Some(255)));
        assert_eq!(of(whole(0, 255), Some((0.0, 255.0))), PointColor::Stored(Some(255)));
        assert_eq!(of(whole(0, 1023), None), PointColor::Stored(Some(1023)));
        // Values may exceed these limits, and those of 16 bits may be of 8.
        assert_eq!(of(whole(0, 65535), Some((0.0, 255.0))), PointColor::Stored(None));
        assert_eq!(of(whole(0, 65535), None), PointColor::Stored(None));
        assert_eq!(of(whole(i64::MIN, i64::MAX), None), PointColor::Stored(None));
        for (encoding, limits) in [
            (whole(0, 100), None),
            (whole(0, 255), Some((0.0, 1.0))),
            (whole(-128, 127), None),
            (NumberCoding::Single, Some((0.0, 1.0))),
            (NumberCoding::Whole { min: 0, max: 255, scale: 0.5, offset: 0.0 }, None),
        ] {
            assert_eq!(of(encoding, limits), PointColor::Floats, "{encoding:?} {limits:?}");
        }
        let [bytes, words, none] = [colored(whole(0, 255), None), colored(whole(0, 65535), None), scan(&[])];
        assert_eq!(colors(&[bytes.clone(), words]), PointColor::Floats);
        assert_eq!(colors(&[none.clone(), bytes]), PointColor::Stored(Some(255)));
        assert_eq!(colors(&[none]), PointColor::Absent);
    }

    #[test]
    fn scans_have_their_attributes_together() {
        let a = scan(&[
            ("cartesianX", NumberCoding::Single),
            ("rowIndex", whole(0, 255)),
            ("intensity", NumberCoding::Single),
            ("x:classification", whole(0, 31)),
        ]);
        let b = scan(&[
            ("rowIndex", whole(0, 1000)),
            ("returnIndex", whole(0, 3)),
            ("nor:normalX", NumberCoding::Single),
            ("timeStamp", NumberCoding::Double),
            ("sphericalRange", NumberCoding::Double),
        ]);
        let fields = |scans: &[E57Scan]| {
            let all = all(scans);
            all.into_iter()
                .map(|attribute| (attribute.field.attribute.name().into_owned(), attribute.field.kind))
                .collect::<Vec<_>>()
        };
        let named = |name: &str, kind| (name.to_owned(), kind);
        assert_eq!(
            fields(&[a.clone(), b.clone()]),
            [
                named("intensity", Type::U16),
                named("return_number", Type::U8),
                named("point_source_id", Type::U16),
                named("extra:rowIndex", Type::U16),
                named("extra:intensity", Type::F32),
                named("classification", Type::U8),
                named("extra:nor:normalX", Type::F32),
                named("extra:timeStamp", Type::F64),
            ]
        );
        let b = E57Scan { start_s: Some(1.0), ..b };
        assert!(fields(&[b]).contains(&named("gps_time", Type::F64)));
    }

    #[test]
    fn numbers_stored_in_several_ways_share_a_type() {
        let scaled = |scale| NumberCoding::Whole { min: 0, max: 9, scale, offset: 1.0 };
        assert_eq!(joint(&[scaled(0.5), scaled(0.5)]), (Type::U8, 0.5, 1.0));
        assert_eq!(joint(&[scaled(0.5), scaled(0.25)]), (Type::F64, 1.0, 0.0));
        assert_eq!(joint(&[NumberCoding::Single, NumberCoding::Single]), (Type::F32, 1.0, 0.0));
        assert_eq!(joint(&[NumberCoding::Single, whole(0, 1)]), (Type::F64, 1.0, 0.0));
        assert_eq!(joint(&[whole(-1, 0), whole(0, 200)]), (Type::I16, 1.0, 0.0));
    }
}
