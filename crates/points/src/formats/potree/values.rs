//! How the bytes of an attribute become values of a column, one pass for each.

use super::morton;
use crate::Marks;
use crate::column::{ColumnPart, Type};

/// Classes whose points are noise: low and high.
const NOISE_CLASSES: [u8; 2] = [7, 18];

/// Fills a column, or a part of its values, from an attribute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fill {
    /// Number of the column.
    pub column: usize,
    /// Number of the attribute.
    pub source: usize,
    pub kind: FillKind,
}

/// What the bytes of an attribute mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FillKind {
    /// A number of the column's type at this byte.
    Number { at: usize },
    /// Red, green, blue, a byte or two each.
    Color { is_bytes: bool },
    /// Red, green, blue of 16 bits, interleaved bit by bit in 8 bytes.
    InterleavedColor,
    /// Intensity: (number − start) · factor.
    Intensity { kind: Type, start: f64, factor: f64 },
    /// True if a bit of the mask is set.
    Flag { mask: u8 },
    /// A class, which is noise or not.
    Noise,
    /// A normal in two bytes, mapped from a sphere to a square.
    SphereMapped,
    /// A normal in two bytes, mapped from an octahedron to a square.
    Octahedral,
    /// A normal of three floats.
    Vector,
    /// One coordinate of a normal.
    NormalPart { axis: usize, kind: Type, scale: f64, offset: f64 },
}

impl FillKind {
    /// Reads values that start `stride` bytes after each other, the first at the first byte. Returns false, and does
    /// nothing, if the column has another type.
    pub fn run(self, bytes: &[u8], stride: usize, column: &mut ColumnPart) -> bool {
        let values = Strided { bytes, stride };
        match (self, column) {
            (Self::Number { at }, ColumnPart::U8(to)) => values.copy(to, at, u8::from_le_bytes),
            (Self::Number { at }, ColumnPart::I8(to)) => values.copy(to, at, i8::from_le_bytes),
            (Self::Number { at }, ColumnPart::U16(to)) => values.copy(to, at, u16::from_le_bytes),
            (Self::Number { at }, ColumnPart::I16(to)) => values.copy(to, at, i16::from_le_bytes),
            (Self::Number { at }, ColumnPart::U32(to)) => values.copy(to, at, u32::from_le_bytes),
            (Self::Number { at }, ColumnPart::I32(to)) => values.copy(to, at, i32::from_le_bytes),
            (Self::Number { at }, ColumnPart::U64(to)) => values.copy(to, at, u64::from_le_bytes),
            (Self::Number { at }, ColumnPart::I64(to)) => values.copy(to, at, i64::from_le_bytes),
            (Self::Number { at }, ColumnPart::F32(to)) => values.copy(to, at, f32::from_le_bytes),
            (Self::Number { at }, ColumnPart::F64(to)) => values.copy(to, at, f64::from_le_bytes),
            (Self::Color { is_bytes: true }, ColumnPart::U16x3(to)) => {
                values.copy(to, 0, |rgb: [u8; 3]| rgb.map(u16::from));
            }
            (Self::Color { is_bytes: false }, ColumnPart::U16x3(to)) => {
                values.copy(to, 0, |bytes: [u8; 6]| {
                    [0, 2, 4].map(|at| u16::from_le_bytes([bytes[at], bytes[at + 1]]))
                })
            }
            (Self::InterleavedColor, ColumnPart::U16x3(to)) => {
                values
                    .copy(to, 0, |bytes: [u8; 8]| morton::parts(u64::from_le_bytes(bytes)).map(|c| c as u16));
            }
            (Self::Intensity { kind: Type::U16, .. }, ColumnPart::U16(to)) => {
                values.copy(to, 0, u16::from_le_bytes);
            }
            (Self::Intensity { kind, start, factor }, ColumnPart::U16(to)) => {
                // The cast saturates, and makes 0 of NaN.
                values.numbers(to, kind, |to, number| *to = ((number - start) * factor).round() as u16);
            }
            (Self::Flag { mask }, ColumnPart::Bool(marks)) => values.mark(marks, |byte| byte & mask != 0),
            (Self::Noise, ColumnPart::Bool(marks)) => {
                values.mark(marks, |byte| NOISE_CLASSES.contains(&byte))
            }
            (Self::SphereMapped, ColumnPart::F32x3(to)) => values.copy(to, 0, sphere_mapped),
            (Self::Octahedral, ColumnPart::F32x3(to)) => values.copy(to, 0, octahedral),
            (Self::Vector, ColumnPart::F32x3(to)) => {
                values.copy(to, 0, |bytes: [u8; 12]| {
                    unit([0, 4, 8].map(|at| {
                        f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
                    }))
                })
            }
            (Self::NormalPart { axis, kind, scale, offset }, ColumnPart::F32x3(to)) => {
                values.numbers(to, kind, |to, number| {
                    to[axis] = (offset + scale * number) as f32;
                    // The last part makes it whole.
                    if axis == 2 {
                        *to = unit(*to);
                    }
                });
            }
            _ => return false,
        }
        true
    }
}

/// Values that start some bytes after each other.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl Strided<'_> {
    /// Makes a value of the bytes from `at` on of each record.
    #[inline]
    fn copy<const N: usize, T>(&self, to: &mut [T], at: usize, value: impl Fn([u8; N]) -> T) {
        let records = self.bytes.chunks(self.stride.max(1));
        for (to, record) in to.iter_mut().zip(records) {
            // The layout keeps every place within the record.
            *to = value(record.get(at..).and_then(<[u8]>::first_chunk).copied().unwrap_or([0; N]));
        }
    }

    /// Gives the number at each record's start.
    fn numbers<T>(&self, to: &mut [T], kind: Type, mut give: impl FnMut(&mut T, f64)) {
        let records = self.bytes.chunks(self.stride.max(1));
        to.iter_mut().zip(records).for_each(|(to, record)| give(to, number(record, kind)));
    }

    /// Marks records by their first byte.
    fn mark(&self, marks: &mut Marks, is_true: impl Fn(u8) -> bool) {
        for (number, byte) in self.bytes.iter().step_by(self.stride.max(1)).enumerate() {
            if is_true(*byte) {
                marks.set(number);
            }
        }
    }
}

/// Bytes of a number of a type.
pub(super) fn element_bytes(kind: Type) -> usize {
    match kind {
        Type::Bool | Type::U8 | Type::I8 => 1,
        Type::U16 | Type::I16 => 2,
        Type::U32 | Type::I32 | Type::F32 => 4,
        Type::U64 | Type::I64 | Type::F64 => 8,
        Type::U16x3 => 6,
        Type::F32x3 => 12,
    }
}

/// The number at the start of some bytes.
fn number(bytes: &[u8], kind: Type) -> f64 {
    fn start<const N: usize>(bytes: &[u8]) -> [u8; N] {
        bytes.first_chunk().copied().unwrap_or([0; N])
    }
    match kind {
        Type::Bool | Type::U8 => u8::from_le_bytes(start(bytes)).into(),
        Type::I8 => i8::from_le_bytes(start(bytes)).into(),
        Type::U16 | Type::U16x3 => u16::from_le_bytes(start(bytes)).into(),
        Type::I16 => i16::from_le_bytes(start(bytes)).into(),
        Type::U32 => u32::from_le_bytes(start(bytes)).into(),
        Type::I32 => i32::from_le_bytes(start(bytes)).into(),
        Type::U64 => u64::from_le_bytes(start(bytes)) as f64,
        Type::I64 => i64::from_le_bytes(start(bytes)) as f64,
        Type::F32 | Type::F32x3 => f32::from_le_bytes(start(bytes)).into(),
        Type::F64 => f64::from_le_bytes(start(bytes)),
    }
}

/// A vector of length 1; NaN for one that has no direction.
fn unit(v: [f32; 3]) -> [f32; 3] {
    let length = v.iter().map(|c| c * c).sum::<f32>().sqrt();
    v.map(|c| c / length)
}

/// The middle of the numbers from −1 to 1 that the converter makes this byte of: it rounds down, with so many steps.
fn signed(byte: u8, steps: f32) -> f32 {
    (f32::from(byte) + 0.5) / steps * 2.0 - 1.0
}

/// The normal of a point on the square that a sphere is mapped to. The square's corners are no normals; the converter
/// leaves (0, 0) where there is none.
fn sphere_mapped([x, y]: [u8; 2]) -> [f32; 3] {
    let (x, y) = (signed(x, 255.0), signed(y, 255.0));
    let rest = 1.0 - x * x - y * y;
    // The root of what is negative is NaN.
    let across = 2.0 * rest.sqrt();
    let z = if rest < 0.0 { f32::NAN } else { 2.0 * rest - 1.0 };
    unit([x * across, y * across, z])
}

/// The normal of a point on the square that an octahedron is unfolded to.
fn octahedral([x, y]: [u8; 2]) -> [f32; 3] {
    let (x, y) = (signed(x, 256.0), signed(y, 256.0));
    let z = 1.0 - x.abs() - y.abs();
    let folded = |own: f32, other: f32| if z >= 0.0 { own } else { (1.0 - other.abs()).copysign(own) };
    unit([folded(x, y), folded(y, x), z])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::column::Column;

    /// As the converter writes normals.
    fn to_sphere_mapped([x, y, z]: [f32; 3]) -> [u8; 2] {
        let across = (x * x + y * y).sqrt();
        let far = (-z * 0.5 + 0.5).sqrt();
        [x, y].map(|c| (((0.5 * (c / across)) * far + 0.5) * 255.0) as u8)
    }

    fn to_octahedral(v: [f32; 3]) -> [u8; 2] {
        let norm = v.iter().map(|c| c.abs()).sum::<f32>();
        let [x, y, z] = v.map(|c| c / norm);
        let sign = |c: f32| if c >= 0.0 { 1.0 } else { -1.0 };
        let flat = if z >= 0.0 { [x, y] } else { [sign(x) * (1.0 - y.abs()), sign(y) * (1.0 - x.abs())] };
        flat.map(|c| ((c + 1.0) * 128.0).min(255.0) as u8)
    }

    #[test]
    fn normals_come_back_as_the_converter_took_them() {
        for i in 1..2000 {
            let z = (i as f32 * 0.618_034).fract() * 2.0 - 1.0;
            let (sin, cos) = (i as f32 * 2.4).sin_cos();
            let across = (1.0 - z * z).sqrt();
            let normal = [cos * across, sin * across, z];
            let cosine = |other: [f32; 3]| normal.iter().zip(other).map(|(a, b)| a * b).sum::<f32>();
            assert!(cosine(octahedral(to_octahedral(normal))) > 0.999, "{normal:?}");
            // Near the circle in the square, which is a single direction, steps are coarse.
            let least = if z > -0.9 { 0.998 } else { 0.98 };
            let mapped = sphere_mapped(to_sphere_mapped(normal));
            assert!(cosine(mapped) > least || mapped[0].is_nan() && z < -0.99, "{normal:?} {mapped:?}");
        }
        // A normal straight up is written as none, and so is none.
        assert!(sphere_mapped(to_sphere_mapped([0.0, 0.0, 1.0])).iter().all(|c| c.is_nan()));
        assert!(unit([0.0; 3])[0].is_nan());
    }

    #[test]
    fn parts_of_normals_and_flags_are_taken_apart() {
        let mut column = Column::zeros(Type::F32x3, 2).unwrap();
        for (axis, bytes) in [[0u8, 3], [0, 0], [254, 4]].iter().enumerate() {
            let kind = FillKind::NormalPart { axis, kind: Type::I8, scale: 0.5, offset: 0.0 };
            assert!(kind.run(bytes, 1, &mut column.parts(2, 1)[0]));
        }
        assert_eq!(column, Column::F32x3(vec![[0.0, 0.0, -1.0], [0.6, 0.0, 0.8]]));
        let mut part = ColumnPart::Bool(Marks::default());
        assert!(FillKind::Flag { mask: 4 }.run(&[4, 0, 3, 0, 7, 0], 2, &mut part));
        let marks = part.into_marks();
        assert_eq!([0, 1, 2].map(|at| marks.get(at)), [true, false, true]);
        let mut wrong = [0u8; 1];
        assert!(!FillKind::Vector.run(&[0; 12], 12, &mut ColumnPart::U8(&mut wrong)));
        let mut to = [0u16; 3];
        let kind = FillKind::Intensity { kind: Type::F32, start: 0.0, factor: 65535.0 };
        let bytes: Vec<u8> = [0.5f32, f32::NAN, 7.0].iter().flat_map(|v| v.to_le_bytes()).collect();
        assert!(kind.run(&bytes, 4, &mut ColumnPart::U16(&mut to)));
        assert_eq!(to, [32768, 0, 65535]);
    }
}
