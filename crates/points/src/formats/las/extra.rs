//! Extra bytes: values behind the standard point record, as a record of the file describes them [LAS, table
//! 24].

use super::header::text;
use crate::column::Type;
use crate::{Attribute, Field};

/// Bytes of a description.
const DESCRIPTION_BYTES: usize = 192;
/// Types of single values, from number 1 on, and their bytes.
const TYPES: [(Type, usize); 10] = [
    (Type::U8, 1),
    (Type::I8, 1),
    (Type::U16, 2),
    (Type::I16, 2),
    (Type::U32, 4),
    (Type::I32, 4),
    (Type::U64, 8),
    (Type::I64, 8),
    (Type::F32, 4),
    (Type::F64, 8),
];
/// Option bit of a description that states a value for no data.
const HAS_NO_DATA: u8 = 1;
/// Option bit of a description that states a scale.
const HAS_SCALE: u8 = 1 << 3;
/// Option bit of a description that states an offset.
const HAS_OFFSET: u8 = 1 << 4;

/// Values that a description names together.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Extra {
    pub name: String,
    /// Each value's field and number of bytes; no field for bytes whose meaning is unknown.
    pub fields: Vec<(Option<Field>, usize)>,
}

/// Parses a record that describes extra bytes.
pub(super) fn parse(payload: &[u8]) -> Vec<Extra> {
    payload.chunks_exact(DESCRIPTION_BYTES).map(describe).collect()
}

fn describe(entry: &[u8]) -> Extra {
    let (kind, options) = (usize::from(entry[2]), entry[3]);
    let name = text(&entry[4..36]);
    let Some((number, rest)) = kind.checked_sub(1).map(|kind| (kind % TYPES.len(), kind / TYPES.len()))
    else {
        // The options of this type are a number of bytes.
        return Extra { name, fields: vec![(None, usize::from(options))] };
    };
    // Types of two or three values are deprecated; types of more values are unknown.
    if rest > 2 {
        return Extra { name, fields: vec![(None, 0)] };
    }
    let (kind, num_bytes) = TYPES[number];
    let field = |part: usize| {
        let name = if rest == 0 { name.clone() } else { format!("{name}[{part}]") };
        let number = |start: usize| entry.get(start + 8 * part..).and_then(<[u8]>::first_chunk::<8>).copied();
        let float = |start, bit| number(start).filter(|_| options & bit != 0).map(f64::from_le_bytes);
        let no_data = number(40).filter(|_| options & HAS_NO_DATA != 0).map(|bytes| match kind {
            Type::I8 | Type::I16 | Type::I32 | Type::I64 => i64::from_le_bytes(bytes) as f64,
            Type::F32 | Type::F64 => f64::from_le_bytes(bytes),
            _ => u64::from_le_bytes(bytes) as f64,
        });
        Field {
            attribute: Attribute::Named(name),
            kind,
            scale: float(112, HAS_SCALE).unwrap_or(1.0),
            offset: float(136, HAS_OFFSET).unwrap_or(0.0),
            no_data,
            is_detail: false,
        }
    };
    Extra { fields: (0..=rest).map(|part| (Some(field(part)), num_bytes)).collect(), name }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(kind: u8, options: u8, name: &str) -> Vec<u8> {
        let mut entry = vec![0; DESCRIPTION_BYTES];
        (entry[2], entry[3]) = (kind, options);
        entry[4..4 + name.len()].copy_from_slice(name.as_bytes());
        entry
    }

    #[test]
    fn scale_offset_and_no_data_count_where_they_are_stated() {
        let mut stated = entry(4, HAS_NO_DATA | HAS_SCALE | HAS_OFFSET, "height");
        stated[40..48].copy_from_slice(&(-9999i64).to_le_bytes());
        stated[112..120].copy_from_slice(&0.01f64.to_le_bytes());
        stated[136..144].copy_from_slice(&100f64.to_le_bytes());
        let mut unstated = stated.clone();
        unstated[3] = 0;
        let named = Field::plain(Attribute::Named("height".into()), Type::I16);
        let field = |entry: &[u8]| parse(entry)[0].fields[0].clone();
        let all = Field { scale: 0.01, offset: 100.0, no_data: Some(-9999.0), ..named.clone() };
        assert_eq!(field(&stated), (Some(all), 2));
        assert_eq!(field(&unstated), (Some(named), 2));
    }

    #[test]
    fn unknown_bytes_are_passed_over_and_triples_are_three() {
        let unknown = entry(0, 5, "blob");
        let triple = entry(29, 0, "normal");
        let extra = parse(&[unknown, triple, vec![0; 100]].concat());
        assert_eq!(extra.len(), 2);
        assert_eq!(extra[0].fields, [(None, 5)]);
        let names = extra[1].fields.iter().map(|(field, bytes)| (field.as_ref().unwrap(), bytes));
        let names: Vec<_> =
            names.map(|(field, bytes)| (field.attribute.clone(), field.kind, *bytes)).collect();
        let part = |part| (Attribute::Named(format!("normal[{part}]")), Type::F32, 4);
        assert_eq!(names, [part(0), part(1), part(2)]);
    }
}
