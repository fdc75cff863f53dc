//! Choices: values that users call by name. Names and meanings stand with the values and nowhere else; settings, options of
//! commands, help, widgets and logs take them from there.

use serde::de::{Deserializer, EnumAccess, Error, VariantAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;
use std::marker::PhantomData;

#[doc(hidden)]
pub use serde;

/// A type whose values are chosen by name; [`choice!`](crate::choice!) makes one.
pub trait Choice: Copy + PartialEq + Send + Sync + 'static {
    /// All values, in the order in which people read them.
    const ALL: &'static [Self];
    /// The name of each.
    const NAMES: &'static [&'static str];
    /// [`AUTO`], and the names.
    const NAMES_WITH_AUTO: &'static [&'static str];
    /// The comment of each.
    const COMMENTS: &'static [&'static str];

    /// The name by which users choose the value.
    fn name(self) -> &'static str;

    /// What each value means, as it continues a sentence: "the nearest point's color".
    fn meanings() -> impl Iterator<Item = String> {
        Self::COMMENTS.iter().map(|comment| {
            let meaning = comment.trim().trim_end_matches('.');
            let mut letters = meaning.chars();
            letters.next().map(|first| first.to_lowercase().chain(letters).collect()).unwrap_or_default()
        })
    }
}

/// Makes an enum whose values are chosen by name. What is written above a value is its meaning, which users read.
///
/// ```
/// scanwalk_base::choice! {
///     /// A hand.
///     pub enum Hand {
///         /// The left one.
///         Left = "left",
///         /// The right one.
///         Right = "right",
///     }
/// }
/// assert_eq!(Hand::ALL.map(Hand::name), ["left", "right"]);
/// ```
#[macro_export]
macro_rules! choice {
    (
        $(#[$about:meta])*
        pub enum $Choice:ident {
            $($(#[doc = $comment:literal])+ $Value:ident = $name:literal,)+
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $Choice {
            $($(#[doc = $comment])+ $Value,)+
        }

        impl $Choice {
            /// All values, in the order in which people read them.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$Value),+];

            /// The name by which users choose the value; logs and the names of files have it too.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$Value => $name,)+
                }
            }
        }

        impl $crate::choice::Choice for $Choice {
            const ALL: &'static [Self] = &[$(Self::$Value),+];
            const NAMES: &'static [&'static str] = &[$($name),+];
            const NAMES_WITH_AUTO: &'static [&'static str] = &[$crate::choice::AUTO, $($name),+];
            const COMMENTS: &'static [&'static str] = &[$(concat!($($comment),+)),+];

            fn name(self) -> &'static str {
                // The enum's own function.
                $Choice::name(self)
            }
        }

        impl $crate::choice::serde::Serialize for $Choice {
            fn serialize<S: $crate::choice::serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
                to.serialize_str(self.name())
            }
        }

        impl<'de> $crate::choice::serde::Deserialize<'de> for $Choice {
            fn deserialize<D: $crate::choice::serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                $crate::choice::by_name(from)
            }
        }
    };
}

/// Name that stands for no choice of the user's.
pub const AUTO: &str = "auto";

/// A choice that users may leave to the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Auto<T>(
    /// What the user chose; `None` if the program is to choose.
    pub Option<T>,
);

impl<T: Choice> Serialize for Auto<T> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(self.0.map_or(AUTO, T::name))
    }
}

impl<'de, T: Choice> Deserialize<'de> for Auto<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_enum(AUTO, T::NAMES_WITH_AUTO, NameOrAuto(PhantomData))
    }
}

/// Reads a choice's name.
///
/// # Errors
/// There is no name, or none of the choice's.
pub fn by_name<'de, T: Choice, D: Deserializer<'de>>(from: D) -> Result<T, D::Error> {
    let Auto(chosen) = from.deserialize_enum("choice", T::NAMES, NameOrAuto(PhantomData))?;
    chosen.ok_or_else(|| D::Error::unknown_variant(AUTO, T::NAMES))
}

/// Takes a choice's name, or [`AUTO`] where the choice itself has none of that name. What it expects are the names with
/// their meanings: `"left": the left one; "right": the right one`.
struct NameOrAuto<T>(PhantomData<T>);

impl<'de, T: Choice> Visitor<'de> for NameOrAuto<T> {
    type Value = Auto<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let meanings = T::NAMES.iter().zip(T::meanings());
        let words: Vec<_> = meanings.map(|(name, meaning)| format!("\"{name}\": {meaning}")).collect();
        f.write_str(&words.join("; "))
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<Auto<T>, A::Error> {
        let (name, value) = data.variant::<String>()?;
        value.unit_variant()?;
        match T::ALL.iter().find(|choice| choice.name() == name) {
            None if name != AUTO => Err(A::Error::unknown_variant(&name, T::NAMES)),
            chosen => Ok(Auto(chosen.copied())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::de::IntoDeserializer;
    use serde::de::value::{Error as Refusal, StrDeserializer};

    crate::choice! {
        /// A side.
        pub enum TestedSide {
            /// The side of the
            /// heart.
            Left = "left",
            /// The other side.
            NotLeft = "not-left",
        }
    }

    fn read<T: for<'de> Deserialize<'de>>(name: &str) -> Result<T, Refusal> {
        let text: StrDeserializer<Refusal> = name.into_deserializer();
        T::deserialize(text)
    }

    #[test]
    fn values_are_read_by_their_names_alone() {
        for side in TestedSide::ALL {
            assert_eq!(read(side.name()), Ok(side));
            assert_eq!(read(side.name()), Ok(Auto(Some(side))));
        }
        assert_eq!(read(AUTO), Ok(Auto::<TestedSide>(None)));
        assert!(read::<TestedSide>(AUTO).is_err() && read::<Auto<TestedSide>>("Left").is_err());
        assert_eq!(TestedSide::NAMES, ["left", "not-left"]);
    }

    #[test]
    fn meanings_are_the_comments() {
        let expected = NameOrAuto::<TestedSide>(PhantomData);
        let expected: &dyn serde::de::Expected = &expected;
        let words = "\"left\": the side of the heart; \"not-left\": the other side";
        assert_eq!(expected.to_string(), words);
    }
}
