//! Attributes as both versions of Potree describe them, and which columns they become.

use super::values::{Fill, FillKind, element_bytes};
use crate::column::Type;
use crate::{Attribute, Field, Projection, Schema};

/// Most numbers of an attribute that get a column each.
const MOST_ELEMENTS: usize = 16;
/// Degrees of a step of LAS 1.4's scan angle, which the converter copies.
const ANGLE_STEP: f64 = 0.006;
/// Flags as LAS 1.4 orders them, which the converter copies too.
const FLAGS: [(Attribute, u8); 4] =
    [(Attribute::Synthetic, 1), (Attribute::KeyPoint, 2), (Attribute::Withheld, 4), (Attribute::Overlap, 8)];
/// Names of the parts of a normal.
const NORMAL_PARTS: [&str; 3] = ["normalx", "normaly", "normalz"];

/// What a file stores for each point under one name.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct StoredAttribute {
    pub name: String,
    /// Type of its numbers; `None` for bytes of unknown meaning.
    pub kind: Option<Type>,
    pub num_elements: usize,
    /// Bytes of all its numbers.
    pub num_bytes: usize,
    /// Scale and offset of each number; 1 and 0 where there are fewer.
    pub scales: Vec<(f64, f64)>,
    /// Least and largest value, if the file says them.
    pub range: Option<[f64; 2]>,
    /// True for a color whose bits are interleaved in 8 bytes.
    pub is_interleaved: bool,
}

impl StoredAttribute {
    /// An attribute of some numbers of a type.
    pub fn plain(name: &str, kind: Type, num_elements: usize) -> Self {
        let num_bytes = num_elements * element_bytes(kind);
        Self { name: name.to_owned(), kind: Some(kind), num_elements, num_bytes, ..Self::default() }
    }

    /// The name without what converters write differently: "gps-time", "GPS_TIME" and "gps time" are one.
    pub fn plain_name(&self) -> String {
        self.name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
    }

    fn scale(&self, element: usize) -> (f64, f64) {
        let stated = self.scales.get(element).copied();
        stated.filter(|(scale, offset)| scale.is_normal() && offset.is_finite()).unwrap_or((1.0, 0.0))
    }

    fn field(&self, attribute: Attribute, kind: Type, element: usize) -> Field {
        let (scale, offset) = self.scale(element);
        Field { scale, offset, ..Field::plain(attribute, kind) }
    }
}

/// Which columns a file's attributes become, and how.
#[derive(Clone, Debug, Default)]
pub(super) struct PointColumns {
    fields: Vec<Field>,
    fills: Vec<Fill>,
    unread: Vec<String>,
    /// The largest that a color can be, where its type says so.
    pub white: Option<u16>,
}

impl PointColumns {
    /// The columns of attributes that are stored in this order, without the one that is the position.
    pub fn of(stored: &[StoredAttribute], position: usize) -> Self {
        let mut columns = Self::default();
        let others = || stored.iter().enumerate().filter(|(at, _)| *at != position);
        for (source, attribute) in others() {
            columns.add(source, attribute);
        }
        let part = |name| {
            others().find(|(_, attribute)| attribute.plain_name() == name && attribute.num_elements == 1)
        };
        if let [Some(x), Some(y), Some(z)] = NORMAL_PARTS.map(part) {
            let parts = [x, y, z].into_iter().enumerate().filter_map(|(axis, (source, attribute))| {
                let (scale, offset) = attribute.scale(0);
                Some((source, FillKind::NormalPart { axis, kind: attribute.kind?, scale, offset }))
            });
            columns.push(Field::plain(Attribute::Normal, Type::F32x3), parts.collect());
        }
        columns
    }

    /// Adds a column, unless there is one of that attribute already.
    fn push(&mut self, field: Field, fills: Vec<(usize, FillKind)>) {
        if self.fields.iter().all(|other| other.attribute != field.attribute) && !fills.is_empty() {
            let column = self.fields.len();
            self.fields.push(field);
            self.fills.extend(fills.into_iter().map(|(source, kind)| Fill { column, source, kind }));
        }
    }

    /// Adds the columns of an attribute.
    fn add(&mut self, source: usize, stored: &StoredAttribute) {
        use Attribute as A;
        let Some(kind) = stored.kind.filter(|kind| {
            let elements = 1..=MOST_ELEMENTS;
            elements.contains(&stored.num_elements)
                && (stored.num_elements * element_bytes(*kind) <= stored.num_bytes || stored.is_interleaved)
        }) else {
            if stored.num_bytes > 0 {
                self.unread.push(stored.name.clone());
            }
            return;
        };
        let name = stored.plain_name();
        let is_single = stored.num_elements == 1;
        let number = |columns: &mut Self, attribute, kind| {
            columns.push(stored.field(attribute, kind, 0), vec![(source, FillKind::Number { at: 0 })]);
        };
        match (name.as_str(), kind) {
            ("rgb" | "rgba" | "color" | "colorpacked" | "rgbpacked" | "rgbapacked", Type::U8 | Type::U16)
                if stored.num_elements >= 3 =>
            {
                let fill = match stored.is_interleaved {
                    true => FillKind::InterleavedColor,
                    false => FillKind::Color { is_bytes: kind == Type::U8 },
                };
                self.push(Field::plain(A::Color, Type::U16x3), vec![(source, fill)]);
                self.white = (kind == Type::U8).then_some(u8::MAX.into());
                if stored.num_elements == 4 && !stored.is_interleaved {
                    let alpha = FillKind::Number { at: 3 * element_bytes(kind) };
                    let field = Field { is_detail: true, ..Field::plain(A::Named("alpha".into()), kind) };
                    self.push(field, vec![(source, alpha)]);
                }
            }
            ("intensity", _) if is_single => {
                let (factor, start) = intensity_ramp(kind, stored.range);
                let fill = FillKind::Intensity { kind, start, factor };
                self.push(Field::plain(A::Intensity, Type::U16), vec![(source, fill)]);
                if kind != Type::U16 {
                    let field = stored.field(A::Named(stored.name.clone()), kind, 0);
                    self.push(Field { is_detail: true, ..field }, vec![(source, FillKind::Number { at: 0 })]);
                }
            }
            ("classification", _) if is_single => {
                number(self, A::Classification, kind);
                if kind == Type::U8 {
                    self.push(Field::plain(A::Noise, Type::Bool), vec![(source, FillKind::Noise)]);
                }
            }
            ("classificationflags", Type::U8) if is_single => {
                for (flag, mask) in FLAGS {
                    self.push(Field::plain(flag, Type::Bool), vec![(source, FillKind::Flag { mask })]);
                }
            }
            ("normalspheremapped", Type::U8) if stored.num_elements == 2 => {
                let fill = vec![(source, FillKind::SphereMapped)];
                self.push(Field::plain(A::Normal, Type::F32x3), fill);
            }
            ("normaloct16", Type::U8) if stored.num_elements == 2 => {
                self.push(Field::plain(A::Normal, Type::F32x3), vec![(source, FillKind::Octahedral)]);
            }
            ("normal" | "normals" | "normalfloats", Type::F32) if stored.num_elements == 3 => {
                self.push(Field::plain(A::Normal, Type::F32x3), vec![(source, FillKind::Vector)]);
            }
            ("returnnumber", _) if is_single => number(self, A::ReturnNumber, kind),
            ("numberofreturns", _) if is_single => number(self, A::NumReturns, kind),
            ("userdata", _) if is_single => number(self, A::UserData, kind),
            ("sourceid" | "pointsourceid", _) if is_single => number(self, A::SourceId, kind),
            ("gpstime", _) if is_single => number(self, A::GpsTime, kind),
            ("nir" | "nearinfrared", Type::U16) if is_single => number(self, A::NearInfrared, kind),
            // The type says that there is no sign, but there is one.
            ("scananglerank", Type::U8 | Type::I8) if is_single => number(self, A::ScanAngle, Type::I8),
            ("scanangle", Type::I16) if is_single => {
                let (scale, offset) = stored.scale(0);
                let scale = if scale == 1.0 { ANGLE_STEP } else { scale };
                let field = Field { scale, offset, ..Field::plain(A::ScanAngle, kind) };
                self.push(field, vec![(source, FillKind::Number { at: 0 })]);
            }
            ("scanangle" | "scananglerank", _) if is_single => number(self, A::ScanAngle, kind),
            ("filler" | "filler1b", _) => {}
            _ => self.add_named(source, stored, kind),
        }
    }

    /// Adds an attribute by its own name, a column for each of its numbers.
    fn add_named(&mut self, source: usize, stored: &StoredAttribute, kind: Type) {
        for element in 0..stored.num_elements {
            let name = match stored.num_elements {
                1 => stored.name.clone(),
                _ => format!("{}[{element}]", stored.name),
            };
            let fill = FillKind::Number { at: element * element_bytes(kind) };
            self.push(stored.field(Attribute::Named(name), kind, element), vec![(source, fill)]);
        }
    }

    /// What the file stores for each point.
    pub fn schema(&self) -> Schema {
        Schema { fields: self.fields.clone(), unread: self.unread.clone() }
    }

    /// The columns that are wanted.
    pub fn wanted(&self, want: &Projection) -> WantedColumns {
        let mut wanted = WantedColumns::default();
        for (at, field) in self.fields.iter().enumerate().filter(|(_, field)| want.wants(&field.attribute)) {
            let column = wanted.columns.len();
            wanted.columns.push((field.attribute.clone(), field.kind));
            let fills = self.fills.iter().filter(|fill| fill.column == at);
            wanted.fills.extend(fills.map(|fill| Fill { column, ..*fill }));
        }
        wanted
    }
}

/// Columns that are wanted, and how they are filled.
#[derive(Clone, Debug, Default)]
pub(super) struct WantedColumns {
    pub columns: Vec<(Attribute, Type)>,
    pub fills: Vec<Fill>,
}

/// The factor of intensities and what is subtracted before. Integers stay if 16 bits hold their type; others are spread
/// over 16 bits by the range that the file states, if it does.
fn intensity_ramp(kind: Type, range: Option<[f64; 2]>) -> (f64, f64) {
    let range = range.filter(|[low, high]| low < high && (high - low).is_finite());
    match (kind, range) {
        (Type::U8 | Type::U16, _) => (1.0, 0.0),
        (Type::F32 | Type::F64, None) => (65535.0, 0.0),
        (_, Some([low, high])) if !matches!(kind, Type::F32 | Type::F64) && low >= 0.0 && high <= 65535.0 => {
            (1.0, 0.0)
        }
        (_, Some([low, high])) => (65535.0 / (high - low), low),
        (_, None) => (1.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::column::Column;

    #[test]
    fn names_of_all_converters_are_known() {
        let stored = [
            StoredAttribute::plain("POSITION_CARTESIAN", Type::I32, 3),
            StoredAttribute::plain("COLOR_PACKED", Type::U8, 4),
            StoredAttribute::plain("GPS_TIME", Type::F64, 1),
            StoredAttribute::plain("point source id", Type::U16, 1),
            StoredAttribute::plain("scan angle rank", Type::U8, 1),
            StoredAttribute::plain("classification", Type::U8, 1),
            StoredAttribute::plain("classification flags", Type::U8, 1),
            StoredAttribute::plain("wind", Type::F32, 2),
            StoredAttribute::plain("gps-time", Type::F64, 1),
            StoredAttribute { num_bytes: 5, ..StoredAttribute::plain("blob", Type::U8, 0) },
            StoredAttribute::plain("FILLER_1B", Type::U8, 1),
        ];
        let columns = PointColumns::of(&stored, 0);
        let schema = columns.schema();
        let names: Vec<_> = schema.fields.iter().map(|field| field.attribute.name()).collect();
        let expected = "rgb extra:alpha gps_time point_source_id scan_angle classification noise synthetic key_point \
                        withheld overlap extra:wind[0] extra:wind[1]";
        assert_eq!(names.join(" "), expected);
        assert_eq!((schema.unread, columns.white), (vec!["blob".to_owned()], Some(255)));
        let wanted = columns.wanted(&Projection::of([Attribute::Withheld, Attribute::ScanAngle]));
        assert_eq!(wanted.columns, [(Attribute::ScanAngle, Type::I8), (Attribute::Withheld, Type::Bool)]);
        let sources: Vec<usize> = wanted.fills.iter().map(|fill| fill.source).collect();
        assert_eq!(sources, [4, 6]);
    }

    #[test]
    fn every_fill_fits_its_column() {
        let kinds = [
            Type::U8,
            Type::I8,
            Type::U16,
            Type::I16,
            Type::U32,
            Type::I32,
            Type::U64,
            Type::I64,
            Type::F32,
            Type::F64,
        ];
        let names = [
            "rgb",
            "intensity",
            "classification",
            "classification flags",
            "NORMAL_SPHEREMAPPED",
            "NORMAL_OCT16",
            "normal",
            "NormalX",
            "NormalY",
            "NormalZ",
            "scan angle rank",
            "scan angle",
            "user data",
            "nir",
            "x",
        ];
        for kind in kinds {
            for num_elements in [1, 2, 3, 4] {
                let stored: Vec<StoredAttribute> =
                    names.iter().map(|name| StoredAttribute::plain(name, kind, num_elements)).collect();
                let columns = PointColumns::of(&stored, usize::MAX);
                for fill in &columns.fills {
                    let mut column = Column::zeros(columns.fields[fill.column].kind, 2).unwrap();
                    let (attribute, part) = (&stored[fill.source], &mut column.parts(2, 1)[0]);
                    let bytes = vec![1; 2 * attribute.num_bytes];
                    assert!(fill.kind.run(&bytes, attribute.num_bytes, part), "{attribute:?} {fill:?}");
                }
            }
        }
    }

    #[test]
    fn intensities_are_spread_where_they_must_be() {
        assert_eq!(intensity_ramp(Type::U16, Some([5.0, 9.0])), (1.0, 0.0));
        assert_eq!(intensity_ramp(Type::U32, Some([5.0, 9.0])), (1.0, 0.0));
        assert_eq!(intensity_ramp(Type::I32, Some([-10.0, 90.0])), (655.35, -10.0));
        assert_eq!(intensity_ramp(Type::F32, None), (65535.0, 0.0));
        assert_eq!(intensity_ramp(Type::F32, Some([0.0, 0.0])), (65535.0, 0.0));
    }
}
