//! How the rows of an element are read: which values are a point's, a face's, nobody's.

use super::header::{Element, Property, PropertyType};
use super::names::{
    self, CHUNK, HARMONICS, LISTED_RGB, NamedScalar, PACKED_RGB, PLACE, find, intensity, is_of_splats,
};
use super::value::{Scalar, Values};
use crate::column::Number;
use crate::formats::names::{NORMAL, RGB};
use crate::{Attribute, Projection};
use std::ops::Range;

/// Slots of a row's coordinates in [`RowValues::values`].
pub(super) const SLOT_PLACE: Range<usize> = 0..3;
/// Slots of a row's color; packed colors take only the first.
pub(super) const SLOT_RGB: Range<usize> = 3..6;
/// Slot of a row's intensity.
pub(super) const SLOT_INTENSITY: usize = 6;
/// Slots of a row's normal.
pub(super) const SLOT_NORMAL: Range<usize> = 7..10;
/// Slot of a row's opacity.
pub(super) const SLOT_OPACITY: usize = 10;
/// Slots of a row, as many as the box of a chunk needs.
pub(super) const NUM_SLOTS: usize = 12;

/// What the rows of an element are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    Points(Kept),
    /// Polygons, with a list of corners for each, and their color.
    Faces(Color),
    /// Strips of triangles, separated by −1.
    Strips,
    /// Boxes in which 256 points each are packed.
    Chunks,
    Unused,
}

/// What a point has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kept {
    /// True if it is a Gaussian splat.
    pub is_splat: bool,
    /// True if its place is packed in its chunk's box.
    pub chunked: bool,
    pub color: Color,
    pub intensity: Intensity,
    pub normal: bool,
    pub opacity: Opacity,
}

/// How colors are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Color {
    Absent,
    /// Integers, with the largest value that each of red, green and blue can have.
    Integers([u16; 3]),
    Floats,
    /// 32 bits: 0xAARRGGBB.
    Packed,
    /// Constant terms of spherical harmonics.
    Harmonics,
    /// 32 bits: 0xRRGGBBAA, in the chunk's range of colors.
    Chunked,
}

/// How intensities are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Intensity {
    Absent,
    Integers,
    Floats,
}

/// How a point's opacity is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Opacity {
    Absent,
    /// A logit or a part of 1, which only all values together tell.
    Unclear,
    /// The logit of the opacity o: ln(o / (1 − o)).
    Logit,
    /// A part of this number.
    PartOf(u16),
    /// The lowest byte of the color.
    Chunked,
}

/// One property of a row, or several that follow each other and are not kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Use {
    Keep(Scalar, usize),
    /// Keeps a value that is also wanted as it is stored.
    KeepExtra(Scalar, usize),
    /// Keeps a value that stands for 32 bits.
    KeepBits(Scalar, usize),
    /// Keeps a value that only the file has a name for.
    Extra(Scalar),
    Skip {
        num_values: u64,
        num_bytes: u64,
    },
    Corners(Scalar, Scalar),
    /// Keeps a list of red, green, blue and perhaps alpha.
    Colors(Scalar, Scalar),
    SkipList(Scalar, Scalar),
}

impl Use {
    /// Keeps nothing of a value.
    fn skip(kind: Scalar) -> Self {
        Self::Skip { num_values: 1, num_bytes: kind.num_bytes() }
    }
}

/// One of the ways in which an element may have colors: what is to be kept of its properties.
type ColorUses = (Color, Vec<(usize, Use)>);

/// Values that were kept of a row; its buffers are used again for the next row.
#[derive(Clone, Debug)]
pub(super) struct RowValues {
    /// Values by their slots; NaN where a value is unknown.
    pub values: [f64; NUM_SLOTS],
    pub corners: Vec<f64>,
    /// Wanted values that only the file has names for, in the row's order.
    pub extras: Vec<Number>,
    /// True if a list of colors has neither 3 nor 4 values.
    pub has_odd_list: bool,
}

impl Default for RowValues {
    fn default() -> Self {
        let (corners, extras) = (Vec::new(), Vec::new());
        Self { values: [f64::NAN; NUM_SLOTS], corners, extras, has_odd_list: false }
    }
}

impl RowValues {
    /// Three values that belong together.
    pub fn three(&self, slots: Range<usize>) -> [f64; 3] {
        [self.values[slots.start], self.values[slots.start + 1], self.values[slots.start + 2]]
    }
}

/// How to read an element.
#[derive(Clone, Debug)]
pub(super) struct RowReader {
    /// Rows announced.
    pub count: u64,
    pub purpose: Purpose,
    /// Properties that can be asked for by name: all except lists and coordinates.
    pub scalars: Vec<NamedScalar>,
    /// Names of a point's lists that are not read.
    pub unread: Vec<String>,
    /// Attributes that are asked for by name, and so are kept.
    pub wanted: Vec<(Attribute, Scalar)>,
    /// Number of properties of a row.
    pub num_properties: u64,
    uses: Vec<Use>,
}

impl RowReader {
    /// The reader for the element that holds the points. Number `color` of its colors is kept, if it has as many.
    ///
    /// # Errors
    /// The names of the coordinates that are missing.
    pub fn of_points(element: &Element, color: usize) -> Result<Self, String> {
        let mut reader = Self::unused(element);
        let place = PLACE.map(|name| find(element, name));
        let chunked = place.contains(&None).then(|| find(element, "packed_position")).flatten();
        match chunked {
            Some((at, kind)) => reader.uses[at] = Use::KeepBits(kind, SLOT_PLACE.start),
            None => {
                let missing: Vec<&str> = PLACE
                    .into_iter()
                    .zip(place)
                    .filter(|(_, found)| found.is_none())
                    .map(|(name, _)| name)
                    .collect();
                if !missing.is_empty() {
                    return Err(missing.join(" and no "));
                }
                reader.keep_three(SLOT_PLACE, place);
            }
        }
        let has = |name| find(element, name).is_some();
        let has_harmonics = HARMONICS.into_iter().all(has);
        let has_shape = ["opacity", "scale_0", "rot_0"].into_iter().all(has);
        let is_splat = chunked.is_some() || has_harmonics || has_shape;
        let color = reader.keep_color(element, color);
        let opacity = match find(element, "opacity") {
            _ if color == Color::Chunked => Opacity::Chunked,
            Some((at, kind)) if kind.is_float() || kind.num_bytes() <= 2 => {
                reader.uses[at] = Use::Keep(kind, SLOT_OPACITY);
                match kind.num_bytes() {
                    _ if kind.is_float() => {
                        if has_harmonics {
                            Opacity::Logit
                        } else {
                            Opacity::Unclear
                        }
                    }
                    1 => Opacity::PartOf(u16::from(u8::MAX)),
                    _ => Opacity::PartOf(u16::MAX),
                }
            }
            _ => Opacity::Absent,
        };
        let intensity = match intensity(element) {
            None => Intensity::Absent,
            Some((at, kind)) => {
                reader.uses[at] = Use::Keep(kind, SLOT_INTENSITY);
                if kind.is_float() { Intensity::Floats } else { Intensity::Integers }
            }
        };
        // Splats have zeros for normals.
        let normal = !is_splat && reader.keep_three(SLOT_NORMAL, NORMAL.map(|name| find(element, name)));
        let kept = Kept { is_splat, chunked: chunked.is_some(), color, intensity, normal, opacity };
        reader.purpose = Purpose::Points(kept);
        for (at, Property { name, kind }) in element.properties.iter().enumerate() {
            // Values kept in slots are spread over a range common to all files; the stored values can be asked for too.
            let is_spread = matches!(reader.uses[at], Use::Keep(_, slot) if !SLOT_PLACE.contains(&slot));
            let is_detail = is_spread || is_splat && is_of_splats(name);
            match (reader.uses[at], *kind) {
                (Use::SkipList(..), _) => reader.unread.push(name.clone()),
                (usage, PropertyType::Value(kind)) if is_spread || matches!(usage, Use::Skip { .. }) => {
                    reader.scalars.push(NamedScalar { at, name: name.clone(), kind, is_detail });
                }
                _ => {}
            }
        }
        Ok(reader)
    }

    /// The reader for any other element. Colors of faces matter only where points have none.
    pub fn of_others(element: &Element, points_have_color: bool) -> Self {
        let mut reader = Self::unused(element);
        match element.name.to_ascii_lowercase().as_str() {
            "face" | "faces" if reader.keep_corners(element) => {
                let color = if points_have_color { Color::Absent } else { reader.keep_color(element, 0) };
                reader.purpose = Purpose::Faces(color);
            }
            "tristrips" if reader.keep_corners(element) => reader.purpose = Purpose::Strips,
            "chunk" => {
                reader.purpose = Purpose::Chunks;
                for (slot, name) in CHUNK.into_iter().enumerate() {
                    if let Some((at, kind)) = find(element, name) {
                        reader.uses[at] = Use::Keep(kind, slot);
                    }
                }
            }
            _ => {}
        }
        reader.join_skips();
        reader
    }

    fn unused(element: &Element) -> Self {
        let usage = |property: &Property| match property.kind {
            PropertyType::Value(kind) => Use::skip(kind),
            PropertyType::List(count, item) => Use::SkipList(count, item),
        };
        let uses: Vec<Use> = element.properties.iter().map(usage).collect();
        let num_properties = uses.len() as u64;
        Self {
            count: element.count,
            purpose: Purpose::Unused,
            scalars: Vec::new(),
            unread: Vec::new(),
            wanted: Vec::new(),
            num_properties,
            uses,
        }
    }

    /// Keeps three values if all are there.
    fn keep_three(&mut self, slots: Range<usize>, found: [Option<(usize, Scalar)>; 3]) -> bool {
        let [Some(a), Some(b), Some(c)] = found else { return false };
        for (slot, (at, kind)) in slots.zip([a, b, c]) {
            self.uses[at] = Use::Keep(kind, slot);
        }
        true
    }

    /// Keeps number `number` of the element's colors.
    fn keep_color(&mut self, element: &Element, number: usize) -> Color {
        let Some((color, uses)) = colors(element).into_iter().nth(number) else { return Color::Absent };
        uses.into_iter().for_each(|(at, usage)| self.uses[at] = usage);
        color
    }

    fn keep_corners(&mut self, element: &Element) -> bool {
        let Some(at) = names::corners(element) else { return false };
        let Use::SkipList(count, item) = self.uses[at] else { return false };
        self.uses[at] = Use::Corners(count, item);
        true
    }

    /// The reader that keeps only wanted values, and always places and opacities, which tell which points there are.
    pub fn projected(&self, want: &Projection) -> Self {
        let mut reader = self.clone();
        let has_color = want.wants(&Attribute::Color);
        let (has_intensity, has_normal) = (want.wants(&Attribute::Intensity), want.wants(&Attribute::Normal));
        // An opacity may be packed beside a color.
        let mut keeps_rgb = has_color;
        match &mut reader.purpose {
            Purpose::Points(has) => {
                keeps_rgb |= has.opacity == Opacity::Chunked;
                has.color = if has_color { has.color } else { Color::Absent };
                has.intensity = if has_intensity { has.intensity } else { Intensity::Absent };
                has.normal &= has_normal;
            }
            Purpose::Faces(color) if !has_color => *color = Color::Absent,
            Purpose::Faces(_) | Purpose::Strips | Purpose::Unused => {}
            // The slots of chunks have other meanings.
            Purpose::Chunks => return reader,
        }
        let is_needed = |slot: usize| match slot {
            SLOT_INTENSITY => has_intensity,
            _ if SLOT_RGB.contains(&slot) => keeps_rgb,
            _ => has_normal || !SLOT_NORMAL.contains(&slot),
        };
        for usage in &mut reader.uses {
            *usage = match *usage {
                Use::Keep(kind, slot) | Use::KeepBits(kind, slot) if !is_needed(slot) => Use::skip(kind),
                Use::Colors(count, item) if !has_color => Use::SkipList(count, item),
                other => other,
            };
        }
        for NamedScalar { at, name, kind, .. } in &self.scalars {
            let attribute = Attribute::Named(name.clone());
            // The first of several properties of one name counts.
            if want.wants(&attribute) && !reader.wanted.iter().any(|(other, _)| *other == attribute) {
                reader.uses[*at] = match reader.uses[*at] {
                    Use::Keep(kind, slot) => Use::KeepExtra(kind, slot),
                    _ => Use::Extra(*kind),
                };
                reader.wanted.push((attribute, *kind));
            }
        }
        reader.join_skips();
        reader
    }

    /// The reader that keeps only what the grid and the ranges of columns depend on, and colors if asked for.
    pub fn for_survey(&self, with_colors: bool) -> Self {
        let mut reader = self.clone();
        let has = match reader.purpose {
            Purpose::Points(has) => Some(has),
            _ => {
                reader.purpose = Purpose::Unused;
                None
            }
        };
        let is_needed = |slot: usize| {
            let rgb =
                |has: Kept| with_colors || has.color == Color::Floats || has.opacity == Opacity::Chunked;
            has.is_some_and(|has| match slot {
                _ if SLOT_RGB.contains(&slot) => rgb(has),
                _ => !SLOT_NORMAL.contains(&slot),
            })
        };
        for usage in &mut reader.uses {
            *usage = match *usage {
                Use::Keep(kind, slot) | Use::KeepBits(kind, slot) | Use::KeepExtra(kind, slot)
                    if !is_needed(slot) =>
                {
                    Use::skip(kind)
                }
                Use::KeepExtra(kind, slot) => Use::Keep(kind, slot),
                Use::Extra(kind) => Use::skip(kind),
                Use::Colors(count, item) if !is_needed(SLOT_RGB.start) => Use::SkipList(count, item),
                Use::Corners(count, item) => Use::SkipList(count, item),
                other => other,
            };
        }
        reader.join_skips();
        reader
    }

    /// The reader that keeps nothing unless the rows are chunks.
    pub fn for_chunks(&self) -> Self {
        match self.purpose {
            Purpose::Chunks => self.clone(),
            _ => Self { purpose: Purpose::Unused, ..self.for_survey(false) },
        }
    }

    /// Joins values that follow each other and are not kept into one step.
    fn join_skips(&mut self) {
        self.uses.dedup_by(|later, earlier| match (earlier, later) {
            (
                Use::Skip { num_values, num_bytes },
                Use::Skip { num_values: more_values, num_bytes: more_bytes },
            ) => {
                *num_values += *more_values;
                *num_bytes += *more_bytes;
                true
            }
            _ => false,
        });
    }

    /// Least size of a row in binary files, and whether all rows have that size.
    pub fn row_bytes(&self) -> (u64, bool) {
        let sizes = self.uses.iter().map(|usage| match usage {
            Use::Keep(kind, _) | Use::KeepExtra(kind, _) | Use::KeepBits(kind, _) | Use::Extra(kind) => {
                (kind.num_bytes(), true)
            }
            Use::Skip { num_bytes, .. } => (*num_bytes, true),
            Use::Corners(count, _) | Use::Colors(count, _) | Use::SkipList(count, _) => {
                (count.num_bytes(), false)
            }
        });
        sizes.fold((0, true), |(sum, all_fixed), (size, fixed)| (sum + size, all_fixed && fixed))
    }

    /// Number of values of a row in text files, if all rows have as many.
    pub fn num_words(&self) -> Option<u64> {
        self.row_bytes().1.then_some(self.num_properties)
    }

    /// Reads one row; `None` if it is not whole.
    #[inline]
    pub fn read_row(&self, values: &mut impl Values, row: &mut RowValues) -> Option<()> {
        row.corners.clear();
        row.extras.clear();
        row.has_odd_list = false;
        for usage in &self.uses {
            match *usage {
                Use::Keep(kind, slot) => row.values[slot] = values.value(kind)?,
                Use::KeepExtra(kind, slot) => {
                    let number = values.number(kind)?;
                    row.values[slot] = number.as_f64();
                    row.extras.push(number);
                }
                Use::KeepBits(kind, slot) => row.values[slot] = values.bits(kind)?.into(),
                Use::Extra(kind) => row.extras.push(values.number(kind)?),
                Use::Skip { num_values, num_bytes } => values.skip(num_values, num_bytes)?,
                // `as` saturates, so a count below zero becomes 0.
                Use::SkipList(count, item) => {
                    let count = values.value(count)? as u64;
                    values.skip(count, count.checked_mul(item.num_bytes())?)?;
                }
                Use::Colors(count, item) => {
                    let count = values.value(count)? as u64;
                    row.has_odd_list = !(3..=4).contains(&count);
                    let num_channels = if row.has_odd_list { 0 } else { 3 };
                    row.values[SLOT_RGB].fill(f64::NAN);
                    for slot in SLOT_RGB.take(num_channels) {
                        row.values[slot] = values.value(item)?;
                    }
                    let left = count - num_channels as u64;
                    values.skip(left, left.checked_mul(item.num_bytes())?)?;
                }
                Use::Corners(count, item) => {
                    for _ in 0..values.value(count)? as u64 {
                        row.corners.push(values.value(item)?);
                    }
                }
            }
        }
        Some(())
    }
}

/// The ways in which an element has colors, the likeliest first.
fn colors(element: &Element) -> Vec<ColorUses> {
    let three = |names: [&str; 3]| {
        let [a, b, c] = names.map(|name| find(element, name));
        Some([a?, b?, c?])
    };
    let keep = |found: [(usize, Scalar); 3]| {
        found.into_iter().zip(SLOT_RGB).map(|((at, kind), slot)| (at, Use::Keep(kind, slot))).collect()
    };
    let bits = |(at, kind)| vec![(at, Use::KeepBits(kind, SLOT_RGB.start))];
    let list = LISTED_RGB.iter().find_map(|name| {
        element.properties.iter().enumerate().find_map(|(at, p)| match p.kind {
            PropertyType::List(count, item) if p.name.eq_ignore_ascii_case(name) => Some((at, count, item)),
            _ => None,
        })
    });
    let packed =
        PACKED_RGB.iter().find_map(|name| find(element, name)).filter(|(_, kind)| kind.num_bytes() >= 4);
    let chunked = find(element, "packed_position").and_then(|_| find(element, "packed_color"));
    let chunked = chunked.map(|found| (Color::Chunked, bits(found)));
    let rgb = RGB.into_iter().filter_map(three);
    let rgb = rgb.map(|found| (plain(found.map(|(_, kind)| kind)), keep(found)));
    let harmonics = three(HARMONICS).map(|found| (Color::Harmonics, keep(found)));
    let listed = list.map(|(at, count, item)| (plain([item; 3]), vec![(at, Use::Colors(count, item))]));
    let packed = packed.map(|found| (Color::Packed, bits(found)));
    chunked.into_iter().chain(rgb).chain(harmonics).chain(listed).chain(packed).collect()
}

/// How red, green and blue of these types are stored.
fn plain(kinds: [Scalar; 3]) -> Color {
    let largest = |kind: Scalar| if kind.num_bytes() == 1 { u16::from(u8::MAX) } else { u16::MAX };
    let any_float = kinds.iter().any(|kind| kind.is_float());
    if any_float { Color::Floats } else { Color::Integers(kinds.map(largest)) }
}
