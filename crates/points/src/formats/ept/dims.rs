//! The schema: which dimensions a point's record has and where, and which attributes they are.

use crate::column::{Number, Type, Value};
use crate::{Attribute, Field, Schema};
use base::words::counted;

/// Most bytes of a record: as many as LAS can have.
const MOST_RECORD_BYTES: usize = u16::MAX as usize;

/// A dimension as the schema has it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Dim {
    pub name: String,
    /// Type of its values, if it is known.
    pub kind: Option<Type>,
    pub num_bytes: usize,
    pub scale: Option<f64>,
    pub offset: f64,
}

/// Where a record has a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct DimCell {
    /// Its first byte.
    pub at: usize,
    pub kind: Type,
}

/// A coordinate: `offset + scale · stored`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlaceDim {
    pub cell: DimCell,
    pub scale: f64,
    pub offset: f64,
    /// True if the schema states the scale.
    pub has_scale: bool,
}

/// How an attribute's values come from dimensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DimUse {
    /// Each is the dimension's.
    Number(DimCell),
    /// Each is true if the dimension's has one of these bits.
    Flag(DimCell, u8),
    /// Each is true if the dimension's is a class of noise.
    Noise(DimCell),
    /// Each is the dimension's, spread over 16 bits if its type has more.
    Intensity(DimCell),
    /// Each is three of the dimensions', bytes as numbers of 16 bits.
    Color([DimCell; 3]),
    /// Each is three of the dimensions'.
    Normal([DimCell; 3]),
}

/// The dimensions of a record.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Dims {
    pub record_bytes: usize,
    pub places: [PlaceDim; 3],
    pub fields: Vec<(Field, DimUse)>,
    /// Names of dimensions of unknown types.
    unread: Vec<String>,
}

/// Names of dimensions that are attributes of all files, and the attributes.
const KNOWN: [(&str, Attribute); 19] = [
    ("Intensity", Attribute::Intensity),
    ("ReturnNumber", Attribute::ReturnNumber),
    ("NumberOfReturns", Attribute::NumReturns),
    ("Classification", Attribute::Classification),
    ("Synthetic", Attribute::Synthetic),
    ("KeyPoint", Attribute::KeyPoint),
    ("Withheld", Attribute::Withheld),
    ("Overlap", Attribute::Overlap),
    ("ScanChannel", Attribute::ScannerChannel),
    ("ScannerChannel", Attribute::ScannerChannel),
    ("ScanDirectionFlag", Attribute::ScanDirection),
    ("EdgeOfFlightLine", Attribute::EdgeOfFlightLine),
    ("ScanAngleRank", Attribute::ScanAngle),
    ("ScanAngle", Attribute::ScanAngle),
    ("UserData", Attribute::UserData),
    ("PointSourceId", Attribute::SourceId),
    ("GpsTime", Attribute::GpsTime),
    ("Infrared", Attribute::NearInfrared),
    ("NearInfrared", Attribute::NearInfrared),
];
/// Names of the dimensions of colors.
const RGB: [&str; 3] = ["Red", "Green", "Blue"];
/// Names of the dimensions of normals.
const NORMAL: [&str; 3] = ["NormalX", "NormalY", "NormalZ"];
/// The bits of the dimension `ClassFlags`.
const CLASS_FLAGS: [(Attribute, u8); 4] =
    [(Attribute::Synthetic, 1), (Attribute::KeyPoint, 2), (Attribute::Withheld, 4), (Attribute::Overlap, 8)];

/// True for types of whole numbers.
pub(super) fn is_whole(kind: Type) -> bool {
    !matches!(kind, Type::F32 | Type::F64)
}

impl DimCell {
    /// The number in a record, which is long enough.
    #[inline]
    pub fn number(self, record: &[u8]) -> Number {
        macro_rules! read {
            ($value:ty) => {
                <$value>::from_le_bytes(record[self.at..].first_chunk().copied().unwrap_or_default()).part(0)
            };
        }
        match self.kind {
            Type::U8 => read!(u8),
            Type::I8 => read!(i8),
            Type::U16 => read!(u16),
            Type::I16 => read!(i16),
            Type::U32 => read!(u32),
            Type::I32 => read!(i32),
            Type::U64 => read!(u64),
            Type::I64 => read!(i64),
            Type::F32 => read!(f32),
            Type::F64 => read!(f64),
            Type::Bool | Type::U16x3 | Type::F32x3 => Number::Whole(0),
        }
    }
}

impl PlaceDim {
    /// The coordinate of a record.
    #[inline]
    pub fn value(&self, record: &[u8]) -> f64 {
        self.offset + self.scale * self.cell.number(record).as_f64()
    }
}

impl Dims {
    /// The dimensions of a schema. Fails, with the reason as the end of a sentence, if they make no points.
    pub fn new(dims: Vec<Dim>) -> Result<Self, String> {
        let (mut record_bytes, mut cells) = (0usize, Vec::new());
        for dim in &dims {
            if dim.num_bytes == 0 || dim.num_bytes > MOST_RECORD_BYTES {
                return Err(format!("gives {} a size of {}", dim.name, counted(dim.num_bytes, "byte")));
            }
            cells.push(dim.kind.map(|kind| DimCell { at: record_bytes, kind }));
            record_bytes += dim.num_bytes;
            if record_bytes > MOST_RECORD_BYTES {
                return Err(format!(
                    "describes points that are larger than {}",
                    counted(MOST_RECORD_BYTES, "byte")
                ));
            }
        }
        let found = FoundDims { dims: &dims, cells: &cells };
        let mut places = Vec::new();
        for name in ["X", "Y", "Z"] {
            places.push(found.place(name)?);
        }
        let places = <[PlaceDim; 3]>::try_from(places).map_err(|_| "has no X, Y and Z")?;
        let unread = dims.iter().filter(|dim| dim.kind.is_none()).map(|dim| dim.name.clone()).collect();
        Ok(Self { record_bytes, places, fields: found.fields(), unread })
    }

    /// Attributes of the points.
    pub fn schema(&self) -> Schema {
        let fields = self.fields.iter().map(|(field, _)| field.clone()).collect();
        Schema { fields, unread: self.unread.clone() }
    }

    /// True if coordinates are whole steps of a grid that the schema states.
    pub fn is_on_fixed_grid(&self) -> bool {
        self.places.iter().all(|place| place.has_scale && is_whole(place.cell.kind))
    }

    /// The largest value of a color, where its type tells.
    pub fn white(&self) -> Option<u16> {
        self.fields.iter().find_map(|(_, from)| match from {
            DimUse::Color(cells) if cells.iter().all(|cell| cell.kind == Type::U8) => Some(255),
            _ => None,
        })
    }
}

/// The dimensions, and where records have them.
struct FoundDims<'a> {
    dims: &'a [Dim],
    cells: &'a [Option<DimCell>],
}

impl FoundDims<'_> {
    /// The first dimension of a name, if its type is known.
    fn find(&self, name: &str) -> Option<(&Dim, DimCell)> {
        let is_named = |dim: &&Dim| dim.name.eq_ignore_ascii_case(name);
        let (dim, cell) = self.dims.iter().zip(self.cells).find(|(dim, _)| is_named(dim))?;
        Some((dim, (*cell)?))
    }

    fn place(&self, name: &str) -> Result<PlaceDim, String> {
        let (dim, cell) = self.find(name).ok_or_else(|| format!("has no {name} of a known type"))?;
        let (scale, offset) = (dim.scale.unwrap_or(1.0), dim.offset);
        let is_sound =
            scale.is_finite() && scale != 0.0 && (offset.abs() + scale.abs() * 2f64.powi(64)).is_finite();
        if !is_sound {
            return Err(format!(
                "gives {name} the scale {scale} and the offset {offset}, so no point has a place"
            ));
        }
        Ok(PlaceDim { cell, scale, offset, has_scale: dim.scale.is_some() })
    }

    /// Three dimensions, if all have types that `fits`.
    fn three(&self, names: [&str; 3], fits: impl Fn(Type) -> bool) -> Option<[DimCell; 3]> {
        let cells = names.map(|name| self.find(name).map(|(_, cell)| cell).filter(|cell| fits(cell.kind)));
        let [Some(a), Some(b), Some(c)] = cells else { return None };
        (a.kind == b.kind && b.kind == c.kind).then_some([a, b, c])
    }

    fn fields(&self) -> Vec<(Field, DimUse)> {
        let color = self.three(RGB, |kind| matches!(kind, Type::U8 | Type::U16));
        let normal = self.three(NORMAL, |kind| !is_whole(kind));
        let mut fields: Vec<(Field, DimUse)> = Vec::new();
        let mut add = |field: Field, from| {
            if !fields.iter().any(|(other, _)| other.attribute == field.attribute) {
                fields.push((field, from));
            }
        };
        let is_one_of = |name: &str, names: [&str; 3]| names.iter().any(|n| n.eq_ignore_ascii_case(name));
        for dim in self.dims {
            let Some((_, cell)) = self.find(&dim.name) else { continue };
            let name = dim.name.as_str();
            if is_one_of(name, ["X", "Y", "Z"]) {
                continue;
            }
            if let Some(cells) = color.filter(|_| is_one_of(name, RGB)) {
                add(Field::plain(Attribute::Color, Type::U16x3), DimUse::Color(cells));
                continue;
            }
            if let Some(cells) = normal.filter(|_| is_one_of(name, NORMAL)) {
                add(Field::plain(Attribute::Normal, Type::F32x3), DimUse::Normal(cells));
                continue;
            }
            let known = KNOWN.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
            let attribute = known.map(|(_, attribute)| attribute.clone());
            self.add(dim, cell, attribute, &mut add);
        }
        fields
    }

    /// Adds the attributes of a dimension.
    fn add(
        &self,
        dim: &Dim,
        cell: DimCell,
        attribute: Option<Attribute>,
        add: &mut impl FnMut(Field, DimUse),
    ) {
        use Attribute as A;
        let Dim { name, scale, offset, .. } = dim;
        let scale = scale.filter(|scale| scale.is_finite() && *scale != 0.0).unwrap_or(1.0);
        let stored = |attribute| Field { scale, offset: *offset, ..Field::plain(attribute, cell.kind) };
        let whole = is_whole(cell.kind);
        match attribute {
            Some(A::Intensity) if cell.kind != Type::U16 => {
                add(Field::plain(A::Intensity, Type::U16), DimUse::Intensity(cell));
                if cell.kind != Type::U8 {
                    let raw = Field { is_detail: true, ..stored(A::Named(name.clone())) };
                    add(raw, DimUse::Number(cell));
                }
            }
            Some(
                flag @ (A::Synthetic
                | A::KeyPoint
                | A::Withheld
                | A::Overlap
                | A::ScanDirection
                | A::EdgeOfFlightLine),
            ) if matches!(cell.kind, Type::U8 | Type::I8) => {
                add(Field::plain(flag, Type::Bool), DimUse::Flag(cell, 0xff));
            }
            Some(A::Classification) if whole => {
                add(stored(A::Classification), DimUse::Number(cell));
                add(Field::plain(A::Noise, Type::Bool), DimUse::Noise(cell));
            }
            Some(A::NearInfrared) if cell.kind != Type::U16 => {
                add(stored(A::Named(name.clone())), DimUse::Number(cell));
            }
            Some(known) => add(stored(known), DimUse::Number(cell)),
            None => {
                add(stored(A::Named(name.clone())), DimUse::Number(cell));
                if name.eq_ignore_ascii_case("ClassFlags") && cell.kind == Type::U8 {
                    for (flag, bit) in CLASS_FLAGS {
                        add(Field::plain(flag, Type::Bool), DimUse::Flag(cell, bit));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dimensions by name and type.
    fn dims(list: &[(&str, Type)]) -> Dims {
        let size = |kind| match kind {
            Type::U8 | Type::I8 => 1,
            Type::U16 | Type::I16 => 2,
            Type::U32 | Type::I32 | Type::F32 => 4,
            _ => 8,
        };
        let dim = |&(name, kind): &(&str, Type)| Dim {
            name: name.to_owned(),
            kind: Some(kind),
            num_bytes: size(kind),
            scale: None,
            offset: 0.0,
        };
        Dims::new(list.iter().map(dim).collect()).unwrap()
    }

    const XYZ: [(&str, Type); 3] = [("X", Type::I32), ("y", Type::I32), ("Z", Type::F64)];

    #[test]
    fn dimensions_become_the_attributes_that_they_are() {
        let others = [
            ("Intensity", Type::F32),
            ("Classification", Type::U8),
            ("Withheld", Type::U8),
            ("ClassFlags", Type::U8),
            ("ScanAngleRank", Type::F32),
            ("Blue", Type::U8),
            ("Green", Type::U8),
            ("Red", Type::U8),
            ("OriginId", Type::U32),
        ];
        let dims = dims(&[&others[..], &XYZ[..]].concat());
        assert_eq!((dims.record_bytes, dims.places[0].cell.at, dims.white()), (34, 18, Some(255)));
        let names: Vec<String> = dims
            .fields
            .iter()
            .map(|(field, _)| format!("{} {}", field.attribute.name(), field.kind.name()))
            .collect();
        let expected = [
            "intensity u16",
            "extra:Intensity f32",
            "classification u8",
            "noise bool",
            "withheld bool",
            "extra:ClassFlags u8",
            "synthetic bool",
            "key_point bool",
            "overlap bool",
            "scan_angle f32",
            "rgb u16x3",
            "extra:OriginId u32",
        ];
        assert_eq!(names, expected);
        let color = dims.fields.iter().find(|(field, _)| field.attribute == Attribute::Color).unwrap();
        let DimUse::Color(cells) = color.1 else { panic!("{color:?}") };
        assert_eq!(cells.map(|cell| cell.at), [13, 12, 11]);
        assert!(!dims.is_on_fixed_grid());
    }

    #[test]
    fn colors_of_other_types_are_named() {
        let floats = [("Red", Type::F32), ("Green", Type::F32), ("Blue", Type::F32)];
        let dims = dims(&[&XYZ[..], &floats[..], &[("Red", Type::U8)]].concat());
        let names: Vec<_> =
            dims.fields.iter().map(|(field, _)| field.attribute.name().into_owned()).collect();
        assert_eq!(names, ["extra:Red", "extra:Green", "extra:Blue"]);
    }

    #[test]
    fn records_without_a_place_are_refused() {
        let said = |dim: Dim| Dims::new(vec![dim]).unwrap_err();
        let x = Dim { name: "X".into(), kind: Some(Type::I32), num_bytes: 4, scale: Some(0.0), offset: 0.0 };
        assert!(said(x.clone()).contains("the scale 0"));
        assert!(said(Dim { scale: None, ..x.clone() }).contains("no Y"));
        assert!(said(Dim { kind: None, num_bytes: 3, ..x.clone() }).contains("no X of a known type"));
        assert!(said(Dim { num_bytes: usize::MAX, ..x.clone() }).contains("size of"));
        assert!(Dims::new(vec![Dim { num_bytes: 60_000, kind: None, ..x }; 2]).is_err());
    }
}
