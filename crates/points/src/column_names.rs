//! Names of a text's columns, where a user says what they are.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// Names of the columns of text files, "x,y,z,r,g,b,i,-", in their order; `-` is one that nobody reads. Without names, a
/// file says what its columns are.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ColumnNames(Vec<String>);

impl ColumnNames {
    /// No names: files are taken for what they say of themselves.
    pub const AS_FILES_SAY: Self = Self(Vec::new());

    /// The names in a text, with commas or blanks between them; none if it is empty.
    ///
    /// # Errors
    /// A sentence, if x, y or z is not among them.
    pub fn named(text: &str) -> Result<Self, String> {
        let parts = text.split([',', ';', ' ', '\t']).map(str::trim).filter(|name| !name.is_empty());
        let names: Vec<String> = parts.map(str::to_owned).collect();
        let borrowed: Vec<&str> = names.iter().map(String::as_str).collect();
        if !names.is_empty() && crate::formats::place_of(&borrowed).is_none() {
            return Err(format!("{text:?} has no x, y and z: name all columns, as in x,y,z,r,g,b,i,-"));
        }
        Ok(Self(names))
    }

    /// The names, in the order of the columns.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.0
    }
}

impl fmt::Display for ColumnNames {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.0.join(","))
    }
}

impl Serialize for ColumnNames {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for ColumnNames {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        Self::named(&String::deserialize(from)?).map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parted_by_commas_or_blanks_and_have_a_place() {
        let names = ColumnNames::named("x, y,z  r g b;-").unwrap();
        assert_eq!(names.to_string(), "x,y,z,r,g,b,-");
        assert_eq!(ColumnNames::named(" ").unwrap(), ColumnNames::AS_FILES_SAY);
        assert!(ColumnNames::named("x,y,i").unwrap_err().contains("no x, y and z"));
    }
}
