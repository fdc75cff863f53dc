//! What a file stores for each point beside its place: attributes, their types, and which of them are wanted.

use crate::column::Type;
use std::borrow::Cow;

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
    /// Number of the return among those of its pulse, from 1.
    ReturnNumber,
    /// Number of returns of the pulse.
    NumReturns,
    /// Class of what the point is of, by the ASPRS.
    Classification,
    /// True if the point was made by other means than scanning.
    Synthetic,
    /// True for a key point of a model.
    KeyPoint,
    /// True for a deleted point.
    Withheld,
    /// True where swaths overlap.
    Overlap,
    /// True for a point of a noise class, which is no part of the scene.
    Noise,
    /// Number of the scanner, where there are several.
    ScannerChannel,
    /// True if the mirror moved in the positive direction.
    ScanDirection,
    /// True for the last point before the mirror turned.
    EdgeOfFlightLine,
    /// Degrees from the nadir.
    ScanAngle,
    /// Anything that the user stored.
    UserData,
    /// Flight line or station that the point is from.
    SourceId,
    /// GPS time in seconds.
    GpsTime,
    /// A part of the reference to the pulse's waveform.
    Waveform(Waveform),
    /// An attribute that only the file has a name for.
    Named(String),
}

/// The parts of a reference to a pulse's waveform [LAS, table 12].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Waveform {
    /// Number of the waveform's description; 0 where there is none.
    Description,
    /// First byte of the waveform's packet.
    Offset,
    /// Bytes of the waveform's packet.
    Size,
    /// Picoseconds from the waveform's start to the point.
    Location,
    /// Change of the place per picosecond.
    Direction,
}

impl Attribute {
    /// Name for people and programs, which no other attribute has.
    #[must_use]
    pub fn name(&self) -> Cow<'static, str> {
        Cow::Borrowed(match self {
            Self::Color => "rgb",
            Self::Intensity => "intensity",
            Self::Normal => "normals",
            Self::NearInfrared => "nir",
            Self::Opacity => "opacity",
            Self::ReturnNumber => "return_number",
            Self::NumReturns => "number_of_returns",
            Self::Classification => "classification",
            Self::Synthetic => "synthetic",
            Self::KeyPoint => "key_point",
            Self::Withheld => "withheld",
            Self::Overlap => "overlap",
            Self::Noise => "noise",
            Self::ScannerChannel => "scanner_channel",
            Self::ScanDirection => "scan_direction",
            Self::EdgeOfFlightLine => "edge_of_flight_line",
            Self::ScanAngle => "scan_angle",
            Self::UserData => "user_data",
            Self::SourceId => "point_source_id",
            Self::GpsTime => "gps_time",
            Self::Waveform(Waveform::Description) => "waveform_description",
            Self::Waveform(Waveform::Offset) => "waveform_offset",
            Self::Waveform(Waveform::Size) => "waveform_size",
            Self::Waveform(Waveform::Location) => "waveform_location",
            Self::Waveform(Waveform::Direction) => "waveform_direction",
            Self::Named(name) => return Cow::Owned(format!("extra:{name}")),
        })
    }

    /// Name in short lists. Attributes that belong together share one; flags have none.
    fn listed_as(&self) -> Option<Cow<'static, str>> {
        match self {
            Self::ReturnNumber | Self::NumReturns => Some(Cow::Borrowed("returns")),
            Self::Waveform(_) => Some(Cow::Borrowed("waveform")),
            Self::Synthetic
            | Self::KeyPoint
            | Self::Withheld
            | Self::Overlap
            | Self::Noise
            | Self::ScannerChannel
            | Self::ScanDirection
            | Self::EdgeOfFlightLine => None,
            _ => Some(self.name()),
        }
    }
}

/// An attribute that a file has, and how it is stored: the value is `offset + scale · stored`.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The attribute.
    pub attribute: Attribute,
    /// Type of its column.
    pub kind: Type,
    /// Value of a stored 1, without the offset.
    pub scale: f64,
    /// Value of a stored 0.
    pub offset: f64,
    /// The stored value that stands for none, where the file states one.
    pub no_data: Option<f64>,
    /// True if short lists pass over it: another attribute has its values in the form that all files share, or it is one
    /// of dozens that make up a splat.
    pub is_detail: bool,
}

impl Field {
    /// A field whose stored values need no scale and no offset.
    #[must_use]
    pub fn plain(attribute: Attribute, kind: Type) -> Self {
        Self { attribute, kind, scale: 1.0, offset: 0.0, no_data: None, is_detail: false }
    }
}

/// The attributes that a file has, known from its header.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Schema {
    /// Fields in the order in which the format lists them.
    pub fields: Vec<Field>,
    /// The file's names for what it stores for each point beside that and no column can hold: lists, bytes of unknown
    /// meaning.
    pub unread: Vec<String>,
}

impl Schema {
    /// How an attribute is stored; `None` if the file does not have it. The first of several attributes of one name
    /// counts.
    #[must_use]
    pub fn field(&self, attribute: &Attribute) -> Option<&Field> {
        self.fields.iter().find(|field| field.attribute == *attribute)
    }

    /// Names of the attributes for a short list, each once.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for field in self.fields.iter().filter(|field| !field.is_detail) {
            if let Some(name) = field.attribute.listed_as()
                && !names.iter().any(|other| *other == name)
            {
                names.push(name.into_owned());
            }
        }
        names
    }

    /// All attributes.
    #[must_use]
    pub fn projection(&self) -> Projection {
        Projection::of(self.fields.iter().map(|field| field.attribute.clone()))
    }
}

/// Which attributes are wanted of a file, and in blocks of how many points. Attributes that are not asked for cost
/// nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    attributes: Vec<Attribute>,
    block_points: usize,
    triangles: bool,
}

impl Projection {
    /// These attributes in blocks as large as the format likes: of all points, if that is the quickest way to have all.
    pub fn of(attributes: impl IntoIterator<Item = Attribute>) -> Self {
        Self { attributes: attributes.into_iter().collect(), block_points: usize::MAX, triangles: true }
    }

    /// Asks for blocks of about this many points, so that no more points need be in memory at once. A format makes
    /// larger blocks where it can only decode more points together.
    #[must_use]
    pub fn in_blocks_of(self, block_points: usize) -> Self {
        Self { block_points: block_points.max(1), ..self }
    }

    /// Asks for no triangles, which a format could only hand over all together.
    #[must_use]
    pub fn without_triangles(self) -> Self {
        Self { triangles: false, ..self }
    }

    /// True if triangles are wanted.
    #[must_use]
    pub fn wants_triangles(&self) -> bool {
        self.triangles
    }

    /// True if an attribute is wanted.
    #[must_use]
    pub fn wants(&self, attribute: &Attribute) -> bool {
        self.attributes.contains(attribute)
    }

    /// Most points of a block, which may have somewhat more.
    #[must_use]
    pub fn block_points(&self) -> usize {
        self.block_points
    }
}
