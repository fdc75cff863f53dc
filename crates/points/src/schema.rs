//! What a file stores for each point beside its place: attributes, their types, and which of them are wanted.

use crate::column::Type;

/// What a value says of its point, whatever the format calls it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Attribute {
    /// Red, green, blue, as stored.
    Color,
    /// How strong the pulse came back.
    Intensity,
    /// Direction across the surface, to the side from which it was seen: unit length, or NaN where a point has none.
    Normal,
    /// Near infrared, beside red, green and blue.
    NearInfrared,
    /// How little light a splat lets pass: 0 to 1.
    Opacity,
    /// Which of a pulse's returns it is, from 1.
    ReturnNumber,
    /// How many returns its pulse has.
    NumReturns,
    /// What it is of, as a class of the ASPRS.
    Classification,
    /// Made by other means than by scanning.
    Synthetic,
    /// A key point of a model.
    KeyPoint,
    /// Deleted.
    Withheld,
    /// Where swaths overlap.
    Overlap,
    /// Of a class that is noise: no part of the scene.
    Noise,
    /// Which scanner of several.
    ScannerChannel,
    /// The mirror moved in the positive direction.
    ScanDirection,
    /// The last point before the mirror turned.
    EdgeOfFlightLine,
    /// Degrees from the nadir.
    ScanAngle,
    /// Whatever the user liked.
    UserData,
    /// Which flight line or station it is from.
    SourceId,
    /// Seconds.
    GpsTime,
    /// A part of what leads to the pulse's waveform.
    Waveform(Waveform),
    /// What only the file has a name for.
    Named(String),
}

/// What leads to a pulse's waveform [LAS 1.4 R15, table 12].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Waveform {
    /// Number of its description; 0 where there is none.
    Description,
    /// First byte of its packet.
    Offset,
    /// Bytes of its packet.
    Size,
    /// Picoseconds from its start to the point.
    Location,
    /// What the place changes by in a picosecond.
    Direction,
}

impl Attribute {
    /// Its name in lists for people and programs; attributes that belong together share one, flags have none.
    #[must_use]
    pub fn listed_as(&self) -> Option<&str> {
        Some(match self {
            Self::Color => "rgb",
            Self::Intensity => "intensity",
            Self::Normal => "normals",
            Self::NearInfrared => "nir",
            Self::Opacity => "opacity",
            Self::ReturnNumber | Self::NumReturns => "returns",
            Self::Classification => "classification",
            Self::ScanAngle => "scan_angle",
            Self::UserData => "user_data",
            Self::SourceId => "point_source_id",
            Self::GpsTime => "gps_time",
            Self::Waveform(_) => "waveform",
            Self::Named(name) => name,
            Self::Synthetic
            | Self::KeyPoint
            | Self::Withheld
            | Self::Overlap
            | Self::Noise
            | Self::ScannerChannel
            | Self::ScanDirection
            | Self::EdgeOfFlightLine => return None,
        })
    }
}

/// An attribute that a file has, and how it is stored: the value is `offset + scale · stored`.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// What it is.
    pub attribute: Attribute,
    /// Type of its column.
    pub kind: Type,
    /// What a stored 1 counts.
    pub scale: f64,
    /// What a stored 0 stands for.
    pub offset: f64,
    /// The stored value that stands for none, where the file states one.
    pub no_data: Option<f64>,
}

impl Field {
    /// Whose stored values are what they say.
    #[must_use]
    pub fn plain(attribute: Attribute, kind: Type) -> Self {
        Self { attribute, kind, scale: 1.0, offset: 0.0, no_data: None }
    }
}

/// The attributes that a file has, known from its header.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Schema {
    /// In the order in which the format lists them.
    pub fields: Vec<Field>,
}

impl Schema {
    /// How an attribute is stored; `None` if the file has none. Of several of one name, the first counts.
    #[must_use]
    pub fn field(&self, attribute: &Attribute) -> Option<&Field> {
        self.fields.iter().find(|field| field.attribute == *attribute)
    }

    /// Names of the attributes that all files call the same, each once.
    pub(crate) fn standard_names(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for field in &self.fields {
            if let (false, Some(name)) =
                (matches!(field.attribute, Attribute::Named(_)), field.attribute.listed_as())
                && !names.iter().any(|other| other == name)
            {
                names.push(name.to_owned());
            }
        }
        names
    }
}

/// Which attributes are wanted of a file, and in how large pieces. What is not asked for costs nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    attributes: Vec<Attribute>,
    block_points: usize,
}

impl Projection {
    /// These attributes of as many points at once as the format likes: of all, if that is the quickest way to have all.
    pub fn of(attributes: impl IntoIterator<Item = Attribute>) -> Self {
        Self { attributes: attributes.into_iter().collect(), block_points: usize::MAX }
    }

    /// The same in blocks of about so many points, so that no more need be in memory at once. A format goes beyond where it
    /// can only decode more together.
    #[must_use]
    pub fn in_blocks_of(self, block_points: usize) -> Self {
        Self { block_points: block_points.max(1), ..self }
    }

    /// True if an attribute is wanted.
    #[must_use]
    pub fn wants(&self, attribute: &Attribute) -> bool {
        self.attributes.contains(attribute)
    }

    /// Points of a block at most, or somewhat more.
    #[must_use]
    pub fn block_points(&self) -> usize {
        self.block_points
    }
}
