//! The kind of value that a setting takes: its type tells, by what it asks serde for.

use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, forward_to_deserialize_any};
use std::fmt::{self, Display};

/// What can be assigned to a setting. As text it continues "must be …".
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ValueKind {
    /// True or false.
    Flag,
    /// A number without fraction, up to this one.
    Whole(u32),
    /// A number.
    Number,
    /// Any text.
    Text,
    /// One of these names; the words say what each means.
    Choice(&'static [&'static str], String),
    /// This many values of one kind.
    List(Box<Self>, usize),
    /// What the type says of itself.
    Other(String),
}

impl ValueKind {
    /// What `T` takes.
    #[must_use]
    pub fn of<'de, T: Deserialize<'de>>() -> Self {
        match T::deserialize(Asked) {
            Err(Answer(kind)) => kind,
            // The type asked for nothing.
            Ok(_) => Self::Other("anything".into()),
        }
    }

    /// Names of values. What a type says of itself has them in backquotes, as serde's own types do.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        match self {
            Self::Choice(names, _) => names.iter().map(ToString::to_string).collect(),
            Self::Other(words) => words.split('`').skip(1).step_by(2).map(ToOwned::to_owned).collect(),
            _ => Vec::new(),
        }
    }

    /// The least and the greatest number that the type allows, if it is one of whole numbers.
    #[must_use]
    pub fn range(&self) -> Option<[f64; 2]> {
        match self {
            Self::Whole(most) => Some([0.0, f64::from(*most)]),
            Self::List(kind, _) => kind.range(),
            _ => None,
        }
    }
}

impl Display for ValueKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let most = |most: &u32| format!("from 0 to {most}");
        match self {
            Self::Flag => f.write_str("true or false"),
            Self::Whole(number) => write!(f, "a whole number {}", most(number)),
            Self::Number => f.write_str("a number"),
            Self::Text => f.write_str("a text in quotes"),
            Self::Choice([one, other], _) => write!(f, "\"{one}\" or \"{other}\""),
            Self::Choice(names, _) => write!(f, "one of \"{}\"", names.join("\", \"")),
            Self::List(kind, len) => match &**kind {
                Self::Whole(number) => write!(f, "a list of {len} whole numbers {}", most(number)),
                _ => write!(f, "a list of {len} numbers"),
            },
            Self::Other(words) => f.write_str(&words.replace('`', "\"")),
        }
    }
}

/// Stands in for a value: a type that reads it gets nothing, but tells what it wants.
struct Asked;

/// What a type says that it wants.
struct Expected<V>(V);

impl<'de, V: Visitor<'de>> Display for Expected<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(f)
    }
}

/// The kind that was asked for. It travels as an error, which ends the reading.
#[derive(Debug)]
struct Answer(ValueKind);

impl Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl std::error::Error for Answer {}

impl Error for Answer {
    fn custom<T: Display>(words: T) -> Self {
        Self(ValueKind::Other(words.to_string()))
    }
}

impl<'de> Deserializer<'de> for Asked {
    type Error = Answer;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Answer> {
        Err(Answer::custom(Expected(visitor)))
    }

    fn deserialize_bool<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Answer> {
        Err(Answer(ValueKind::Flag))
    }

    fn deserialize_u8<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Answer> {
        Err(Answer(ValueKind::Whole(u8::MAX.into())))
    }

    fn deserialize_u32<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Answer> {
        Err(Answer(ValueKind::Whole(u32::MAX)))
    }

    fn deserialize_f64<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Answer> {
        Err(Answer(ValueKind::Number))
    }

    fn deserialize_string<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Answer> {
        Err(Answer(ValueKind::Text))
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Answer> {
        Err(Answer(ValueKind::Choice(names, Expected(visitor).to_string())))
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, Answer> {
        visitor.visit_seq(self).map_err(|Answer(kind)| Answer(ValueKind::List(Box::new(kind), len)))
    }

    forward_to_deserialize_any! {
        i8 i16 i32 i64 i128 u16 u64 u128 f32 char str bytes byte_buf option unit unit_struct newtype_struct seq
        tuple_struct map struct identifier ignored_any
    }
}

/// The first element of a list tells what all are.
impl<'de> SeqAccess<'de> for Asked {
    type Error = Answer;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Answer> {
        seed.deserialize(Self).map(Some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::choice::Auto;
    use points::{Unit, Up};
    use render::gpu::Atomics;
    use render::options::Quality;

    #[test]
    fn types_tell_what_they_take() {
        let kinds = [
            ValueKind::of::<bool>(),
            ValueKind::of::<u32>(),
            ValueKind::of::<f64>(),
            ValueKind::of::<String>(),
        ];
        assert_eq!(kinds, [ValueKind::Flag, ValueKind::Whole(u32::MAX), ValueKind::Number, ValueKind::Text]);
        assert_eq!(ValueKind::of::<[u8; 3]>(), ValueKind::List(Box::new(ValueKind::Whole(255)), 3));
        let ValueKind::Choice(names, words) = ValueKind::of::<Quality>() else { panic!("no choice") };
        assert_eq!(names, ["closest", "hqs"]);
        assert!(words.starts_with("\"closest\": the nearest point's color; \"hqs\": the blend"), "{words}");
        assert!(matches!(ValueKind::of::<Auto<Atomics>>(), ValueKind::Choice(&["auto", "int32", ..], _)));
    }

    #[test]
    fn kinds_have_names_or_ranges() {
        assert_eq!(ValueKind::of::<Unit>().names(), ["auto", "m", "mm", "cm", "ft", "us-ft"]);
        assert_eq!(ValueKind::of::<Quality>().names(), Quality::ALL.map(Quality::name));
        assert_eq!(ValueKind::of::<[u8; 3]>().range(), Some([0.0, 255.0]));
        assert_eq!((ValueKind::of::<f64>().range(), ValueKind::of::<f64>().names().len()), (None, 0));
    }

    #[test]
    fn words_continue_a_sentence() {
        assert_eq!(ValueKind::of::<[f64; 2]>().to_string(), "a list of 2 numbers");
        assert_eq!(ValueKind::of::<Quality>().to_string(), "\"closest\" or \"hqs\"");
        assert_eq!(ValueKind::of::<Up>().to_string(), "one of \"auto\", \"z\", \"y\", \"-y\"");
        let unit = ValueKind::of::<Unit>().to_string();
        assert!(unit.starts_with("\"auto\", \"m\"") && unit.ends_with("or a number of meters"), "{unit}");
    }
}
