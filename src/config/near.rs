//! The value of `frame.near_m`: a length that the user chose, or none.

use crate::draw::NEAR;
use base::choice::AUTO;
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// Points nearer than this are not drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum NearClip {
    /// A length that becomes less in a picture where it would cut a small scene.
    #[default]
    Auto,
    /// The length that the user chose, however small the scene is.
    Meters(f64),
}

impl NearClip {
    /// The length in meters.
    #[must_use]
    pub fn meters(self) -> f64 {
        match self {
            Self::Auto => NEAR,
            Self::Meters(meters) => meters,
        }
    }
}

impl Serialize for NearClip {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => to.serialize_str(AUTO),
            Self::Meters(meters) => to.serialize_f64(*meters),
        }
    }
}

impl<'de> Deserialize<'de> for NearClip {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Length)
    }
}

/// Takes the name or a number.
struct Length;

impl Visitor<'_> for Length {
    type Value = NearClip;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("`auto` or a number")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<NearClip, E> {
        if text == AUTO { Ok(NearClip::Auto) } else { Err(E::invalid_value(Unexpected::Str(text), &self)) }
    }

    fn visit_f64<E: Error>(self, meters: f64) -> Result<NearClip, E> {
        Ok(NearClip::Meters(meters))
    }

    fn visit_i64<E: Error>(self, meters: i64) -> Result<NearClip, E> {
        Ok(NearClip::Meters(meters as f64))
    }

    fn visit_u64<E: Error>(self, meters: u64) -> Result<NearClip, E> {
        Ok(NearClip::Meters(meters as f64))
    }
}
