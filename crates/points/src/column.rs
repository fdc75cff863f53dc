//! Columns: the values of one attribute, as they are stored, of points that follow each other.

use crate::Marks;
use std::collections::TryReserveError;

/// A number before it is known which column it goes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Number {
    Whole(i128),
    Float(f64),
}

impl Number {
    /// True if it is less than another number, which is told exactly of whole numbers.
    pub(crate) fn is_less(self, other: Self) -> bool {
        match (self, other) {
            (Self::Whole(own), Self::Whole(other)) => own < other,
            _ => self.as_f64() < other.as_f64(),
        }
    }

    /// The nearest float.
    pub(crate) fn as_f64(self) -> f64 {
        match self {
            Self::Whole(whole) => whole as f64,
            Self::Float(float) => float,
        }
    }
}

/// A type whose values a column holds.
pub(crate) trait Value: Copy + Default {
    /// How many numbers a value has.
    const PARTS: usize;

    /// The value nearest to a number. NaN becomes 0 in a type that has no NaN.
    fn of(number: Number) -> Self;

    /// The number of a part, less than [`PARTS`](Self::PARTS).
    fn part(self, part: usize) -> Number;
}

macro_rules! whole_numbers {
    ($($value:ty),*) => {$(
        impl Value for $value {
            const PARTS: usize = 1;

            fn part(self, _: usize) -> Number {
                Number::Whole(self.into())
            }

            fn of(number: Number) -> Self {
                match number {
                    // The cast is exact, because the number is clamped to the type's range.
                    Number::Whole(whole) => whole.clamp(<$value>::MIN.into(), <$value>::MAX.into()) as $value,
                    Number::Float(float) => float.round() as $value,
                }
            }
        }
    )*};
}
whole_numbers!(u8, i8, u16, i16, u32, i32, u64, i64);

macro_rules! floats {
    ($($value:ty),*) => {$(
        impl Value for $value {
            const PARTS: usize = 1;

            fn part(self, _: usize) -> Number {
                Number::Float(self.into())
            }

            fn of(number: Number) -> Self {
                match number {
                    Number::Whole(whole) => whole as $value,
                    Number::Float(float) => float as $value,
                }
            }
        }
    )*};
}
floats!(f32, f64);

impl<T: Value> Value for [T; 3] {
    const PARTS: usize = 3;

    fn part(self, part: usize) -> Number {
        self[part].part(0)
    }

    fn of(number: Number) -> Self {
        [T::of(number); 3]
    }
}

/// Defines `Type`, `Column` and `ColumnPart`, with one variant per type of value.
macro_rules! columns {
    ($($(#[$doc:meta])* $name:ident: $value:ty,)*) => {
        /// Type of an attribute's values.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Type {
            /// Yes or no.
            Bool,
            $($(#[$doc])* $name,)*
        }

        impl Type {
            /// Numbers that a value has: three of a color, one of most.
            pub(crate) fn num_parts(self) -> usize {
                match self {
                    Self::Bool => 1,
                    $(Self::$name => <$value as Value>::PARTS,)*
                }
            }
        }

        /// The values of an attribute, one a point.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Column {
            /// Marks of the points for which the attribute is true.
            Bool(Marks),
            $($(#[$doc])* $name(Vec<$value>),)*
        }

        /// A part of a column that is to be written.
        #[derive(Debug)]
        pub(crate) enum ColumnPart<'a> {
            /// Marks, which count from the part's first point.
            Bool(Marks),
            $($name(&'a mut [$value]),)*
        }

        impl Column {
            /// A column without values.
            #[must_use]
            pub fn new(kind: Type) -> Self {
                match kind {
                    Type::Bool => Self::Bool(Marks::default()),
                    $(Type::$name => Self::$name(Vec::new()),)*
                }
            }

            /// Type of its values.
            #[must_use]
            pub fn kind(&self) -> Type {
                match self {
                    Self::Bool(_) => Type::Bool,
                    $(Self::$name(_) => Type::$name,)*
                }
            }

            /// Calls `take` with one part of each value, of a column of `len` points.
            pub(crate) fn each(&self, part: usize, len: usize, mut take: impl FnMut(Number)) {
                match self {
                    Self::Bool(marks) => (0..len).for_each(|number| take(Number::Whole(marks.get(number).into()))),
                    $(Self::$name(values) => values.iter().for_each(|value| take(value.part(part))),)*
                }
            }

            /// Number of its values; `None` for marks, which end with the last that is marked.
            pub(crate) fn num_values(&self) -> Option<usize> {
                match self {
                    Self::Bool(_) => None,
                    $(Self::$name(values) => Some(values.len()),)*
                }
            }

            /// A column of `len` zeros; `None` if there is no memory for them.
            pub(crate) fn zeros(kind: Type, len: usize) -> Option<Self> {
                Some(match kind {
                    Type::Bool => Self::Bool(Marks::default()),
                    $(Type::$name => Self::$name(zeros(len)?),)*
                })
            }

            /// Makes room for more values.
            pub(crate) fn reserve(&mut self, more: usize) -> Result<(), TryReserveError> {
                match self {
                    Self::Bool(_) => Ok(()),
                    $(Self::$name(values) => values.try_reserve(more),)*
                }
            }

            /// Appends `more` zeros and returns them to be written. [`mark`](Self::mark) takes in the marks of a `Bool`
            /// part.
            pub(crate) fn grow(&mut self, more: usize) -> Result<ColumnPart<'_>, TryReserveError> {
                self.reserve(more)?;
                Ok(match self {
                    Self::Bool(_) => ColumnPart::Bool(Marks::default()),
                    $(Self::$name(values) => {
                        let len = values.len();
                        values.resize(len + more, Default::default());
                        ColumnPart::$name(&mut values[len..])
                    })*
                })
            }

            /// Splits the column into `num_parts` parts of `len` values each.
            pub(crate) fn parts(&mut self, len: usize, num_parts: usize) -> Vec<ColumnPart<'_>> {
                match self {
                    Self::Bool(_) => (0..num_parts).map(|_| ColumnPart::Bool(Marks::default())).collect(),
                    $(Self::$name(values) => values.chunks_mut(len).map(ColumnPart::$name).collect(),)*
                }
            }

            /// Takes in the marks of a part that starts at point `first`. Columns of numbers are written already.
            pub(crate) fn mark(&mut self, part: &Marks, first: usize) {
                if let Self::Bool(marks) = self {
                    marks.append(part, first);
                }
            }

            /// Keeps the first values.
            pub(crate) fn truncate(&mut self, len: usize) {
                match self {
                    Self::Bool(marks) => marks.truncate(len),
                    $(Self::$name(values) => values.truncate(len),)*
                }
            }

            /// Keeps the values of the points for which `is_kept` is true, of a column of as many points.
            pub(crate) fn keep(&mut self, is_kept: &[bool]) {
                let mut kept = is_kept.iter().copied();
                match self {
                    Self::Bool(marks) => {
                        let left = (0..is_kept.len()).filter(|&number| is_kept[number]);
                        let mut moved = Marks::default();
                        left.enumerate().filter(|(_, number)| marks.get(*number)).for_each(|(next, _)| moved.set(next));
                        *marks = moved;
                    }
                    $(Self::$name(values) => values.retain(|_| kept.next().unwrap_or(false)),)*
                }
            }

            /// Appends later values of the same attribute to the `len` values that are here already. Values of another type
            /// are not taken in: the column is too short then, which is an error where its block is handed over.
            pub(crate) fn append(&mut self, later: Self, len: usize) {
                match (self, later) {
                    (Self::Bool(marks), Self::Bool(later)) => marks.append(&later, len),
                    $((Self::$name(values), Self::$name(mut later)) => values.append(&mut later),)*
                    _ => {}
                }
            }

            /// Appends the values of these points of a column of the same type.
            pub(crate) fn take_from(&mut self, other: &Self, numbers: impl Iterator<Item = usize>) {
                match (self, other) {
                    (Self::Bool(marks), Self::Bool(other)) => {
                        for (at, _) in numbers.enumerate().filter(|(_, number)| other.get(*number)) {
                            marks.set(at);
                        }
                    }
                    $((Self::$name(values), Self::$name(other)) => {
                        values.extend(numbers.filter_map(|number| other.get(number)));
                    })*
                    _ => {}
                }
            }

            /// Appends the value of point `number`. A `Bool` column is true for every value except 0.
            pub(crate) fn push(&mut self, value: Number, number: usize) {
                match self {
                    Self::Bool(marks) => {
                        if value != Number::Whole(0) && value != Number::Float(0.0) {
                            marks.set(number);
                        }
                    }
                    $(Self::$name(values) => values.push(Value::of(value)),)*
                }
            }
        }
    };
}

columns! {
    /// Whole numbers of 8 bits.
    U8: u8,
    /// Whole numbers of 8 bits with a sign.
    I8: i8,
    /// Whole numbers of 16 bits.
    U16: u16,
    /// Whole numbers of 16 bits with a sign.
    I16: i16,
    /// Whole numbers of 32 bits.
    U32: u32,
    /// Whole numbers of 32 bits with a sign.
    I32: i32,
    /// Whole numbers of 64 bits.
    U64: u64,
    /// Whole numbers of 64 bits with a sign.
    I64: i64,
    /// Floats of 32 bits.
    F32: f32,
    /// Floats of 64 bits.
    F64: f64,
    /// Three whole numbers of 16 bits: a color.
    U16x3: [u16; 3],
    /// Three floats of 32 bits: a direction.
    F32x3: [f32; 3],
}

impl Type {
    /// Name for people and programs: "u16", "f32x3".
    #[must_use]
    pub fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }
}

impl ColumnPart<'_> {
    /// The marks of a `Bool` part; no marks for a part of numbers.
    pub(crate) fn into_marks(self) -> Marks {
        match self {
            Self::Bool(marks) => marks,
            _ => Marks::default(),
        }
    }
}

/// Leaves out the values whose numbers are marked.
pub(crate) fn leave_out<T>(values: &mut Vec<T>, gone: &Marks) {
    let mut number = 0;
    values.retain(|_| {
        number += 1;
        !gone.get(number - 1)
    });
}

/// Returns `vec![zero; len]`, or `None` if there is no memory for it, which `vec!` cannot say. Zeroed pages come from
/// the system untouched, and become real in parallel as they are written.
pub(crate) fn zeros<T: Copy + Default>(len: usize) -> Option<Vec<T>> {
    Vec::<T>::new().try_reserve_exact(len).ok()?;
    Some(vec![T::default(); len])
}
