//! The description in an E57 file, which is XML: its scans, what they store for each point, and its images.

use super::stream::{NumberCoding, Stream};
use base::space::Pose;
use glam::{DQuat, DVec3};
use roxmltree::{Document, Error, Node, ParsingOptions};

/// Most elements of a description: many times as many as files of a thousand scans have.
const MOST_NODES: u32 = 1 << 22;
/// Most bytes of a tag: many times as many as any has. The parser compares all attributes of a tag with each other.
const MOST_TAG_BYTES: usize = 1 << 13;
/// Most prefixes of names that are declared for a file that does not do it.
const MOST_UNDECLARED: usize = 16;

/// What the description of a file says.
#[derive(Clone, Debug, Default)]
pub(super) struct E57Description {
    pub scans: Vec<E57Scan>,
    pub images: Vec<E57Image>,
    /// Coordinate reference system.
    pub crs: String,
    /// Program or library that wrote the file.
    pub software: Option<String>,
    /// Seconds since the start of GPS time at which it was written.
    pub created_s: Option<f64>,
}

/// A scan of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct E57Scan {
    pub name: Option<String>,
    pub pose: Option<Pose>,
    /// Physical place of the scan's points.
    pub offset: u64,
    /// Points that are announced.
    pub announced: u64,
    /// What is stored for each point, in the order in which it is stored.
    pub streams: Vec<Stream>,
    /// Least and largest red, green and blue, where stated.
    pub color_limits: [Option<(f64, f64)>; 3],
    /// GPS time in seconds that time stamps count from.
    pub start_s: Option<f64>,
}

/// An image in a file.
#[derive(Clone, Debug)]
pub(super) struct E57Image {
    pub name: Option<String>,
    /// Where it was taken from: x to the right, y up, and looking along −z.
    pub pose: Option<Pose>,
}

impl E57Scan {
    /// The number and the stream of this name.
    pub fn stream(&self, name: &str) -> Option<(usize, &Stream)> {
        self.streams.iter().enumerate().find(|(_, stream)| stream.name == name)
    }
}

/// Reads a description.
///
/// # Errors
/// Why it cannot be read, as the end of a sentence.
pub(super) fn read(text: &str) -> Result<E57Description, String> {
    let mut text = plain(text);
    if longest_tag(&text) > MOST_TAG_BYTES {
        return Err("has a tag that is longer than any".into());
    }
    for _ in 0..MOST_UNDECLARED {
        let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
        let prefix = match Document::parse_with_options(&text, options) {
            Ok(document) => return Ok(describe(document.root_element())),
            Err(Error::UnknownNamespace(prefix, _)) => prefix,
            Err(error) => return Err(format!("cannot be read: {error}")),
        };
        let Some(at) = text.find(ROOT).map(|at| at + ROOT.len()) else { break };
        text.insert_str(at, &format!(" xmlns:{prefix}=\"undeclared:{prefix}\""));
    }
    Err("has names of undeclared kinds".into())
}

/// How the root element begins.
const ROOT: &str = "<e57Root";

/// The text from its first tag to the end of its root element, with blanks for characters that XML does not have.
fn plain(text: &str) -> String {
    let end =
        text.rfind("</e57Root").and_then(|at| Some(at + text[at..].find('>')? + 1)).unwrap_or(text.len());
    let start = text[..end].find('<').unwrap_or(0);
    let is_odd =
        |c: char| c < ' ' && !matches!(c, '\t' | '\n' | '\r') || matches!(c, '\u{fffe}' | '\u{ffff}');
    text[start..end].chars().map(|c| if is_odd(c) { ' ' } else { c }).collect()
}

/// Most bytes of a tag.
fn longest_tag(text: &str) -> usize {
    let is_tag = |rest: &&str| rest.starts_with(|c: char| c.is_alphabetic() || c == '_' || c == '/');
    let tags = text.split('<').filter(is_tag);
    tags.map(|rest| rest.find('>').unwrap_or(rest.len())).max().unwrap_or(0)
}

fn describe(root: Node) -> E57Description {
    let children = |name| child(root, name).into_iter().flat_map(|vector| vector.children());
    let structures = |name| children(name).filter(Node::is_element);
    let software = text(root, "e57LibraryVersion").map(|name| name.trim_matches('"').to_owned());
    let software = software.filter(|name| !name.eq_ignore_ascii_case("unknown"));
    let created_s = child(root, "creationDateTime").and_then(|time| number(time, "dateTimeValue"));
    E57Description {
        scans: structures("data3D").map(|node| scan(node, root)).collect(),
        images: structures("images2D").map(image).collect(),
        crs: text(root, "coordinateMetadata").unwrap_or_default(),
        software,
        created_s: created_s.filter(|&seconds| seconds > 0.0),
    }
}

fn scan(node: Node, root: Node) -> E57Scan {
    let limits = |of: &str, value: &str| {
        let limits = child(node, of)?;
        let ends = (number(limits, &format!("{value}Minimum"))?, number(limits, &format!("{value}Maximum"))?);
        Some(ends).filter(|(low, high)| low < high && low.is_finite() && high.is_finite())
    };
    let points = child(node, "points");
    let attribute = |name| points.and_then(|points| points.attribute(name)?.trim().parse().ok()).unwrap_or(0);
    let start_s = child(node, "acquisitionStart").and_then(|time| number(time, "dateTimeValue"));
    E57Scan {
        name: text(node, "name"),
        pose: child(node, "pose").and_then(pose),
        offset: attribute("fileOffset"),
        announced: attribute("recordCount"),
        streams: points
            .and_then(|points| child(points, "prototype"))
            .map(|of| streams(of, root))
            .unwrap_or_default(),
        color_limits: ["colorRed", "colorGreen", "colorBlue"].map(|color| limits("colorLimits", color)),
        start_s: start_s.filter(|&seconds| seconds > 0.0),
    }
}

fn image(node: Node) -> E57Image {
    let forward_along_x = ["sphericalRepresentation", "cylindricalRepresentation"];
    let pose = child(node, "pose").and_then(pose).map(|pose| {
        if forward_along_x.into_iter().any(|name| child(node, name).is_some()) {
            // The middle of such an image is at azimuth 0, along x, with z up.
            pose.then(&Pose {
                position: DVec3::ZERO,
                orientation: DQuat::from_mat3(&camera_from_x_forward()),
            })
        } else {
            pose
        }
    });
    E57Image { name: text(node, "name"), pose }
}

/// Axes of a camera that looks along x, z up: its x, y and z.
fn camera_from_x_forward() -> glam::DMat3 {
    glam::DMat3::from_cols(DVec3::NEG_Y, DVec3::Z, DVec3::NEG_X)
}

/// The values of a point, in the order in which they are stored.
fn streams(prototype: Node, root: Node) -> Vec<Stream> {
    let is_value =
        |node: &Node| node.is_element() && node.attribute("type").is_some_and(|of| of != "Structure");
    prototype.descendants().skip(1).filter(is_value).map(|node| stream(node, root)).collect()
}

fn stream(node: Node, root: Node) -> Stream {
    let namespace = node.tag_name().namespace();
    let prefix = namespace.filter(|own| Some(*own) != root.tag_name().namespace());
    let prefix = prefix.and_then(|own| node.lookup_prefix(own)).filter(|prefix| !prefix.is_empty());
    let local = node.tag_name().name();
    let name = prefix.map_or_else(|| local.to_owned(), |prefix| format!("{prefix}:{local}"));
    let real = |name: &str, otherwise: f64| {
        let value = node.attribute(name).and_then(|text| text.trim().parse().ok());
        value.filter(|value: &f64| value.is_finite()).unwrap_or(otherwise)
    };
    let whole = |name: &str, otherwise: i64| {
        let text = node.attribute(name).map(str::trim);
        // Some programs write whole numbers with a point or an exponent.
        let parse =
            |text: &str| text.parse().ok().or_else(|| text.parse::<f64>().ok().map(|value| value as i64));
        text.and_then(parse).unwrap_or(otherwise)
    };
    let encoding = match node.attribute("type") {
        Some("Float") if node.attribute("precision") == Some("single") => NumberCoding::Single,
        Some("Float") => NumberCoding::Double,
        of => {
            let is_scaled = of == Some("ScaledInteger");
            let (scale, offset) =
                if is_scaled { (real("scale", 1.0), real("offset", 0.0)) } else { (1.0, 0.0) };
            NumberCoding::Whole {
                min: whole("minimum", i64::MIN),
                max: whole("maximum", i64::MAX),
                scale,
                offset,
            }
        }
    };
    Stream { name, encoding }
}

fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.is_element() && child.tag_name().name() == name)
}

/// A text that is not blank.
fn text(node: Node, name: &str) -> Option<String> {
    let parts = child(node, name)?.children().filter_map(|part| part.text());
    Some(parts.collect::<String>().trim().to_owned()).filter(|text| !text.is_empty())
}

/// A number; an element without content is 0.
fn number(node: Node, name: &str) -> Option<f64> {
    let child = child(node, name)?;
    let stored: f64 = match text(node, name) {
        Some(text) => text.parse().ok()?,
        None => 0.0,
    };
    if child.attribute("type") != Some("ScaledInteger") {
        return Some(stored);
    }
    let real = |name, otherwise| {
        child.attribute(name).and_then(|text| text.trim().parse().ok()).unwrap_or(otherwise)
    };
    Some(real("offset", 0.0) + real("scale", 1.0) * stored)
}

/// A pose; `None` if its numbers make none.
fn pose(node: Node) -> Option<Pose> {
    let [w, x, y, z] = match child(node, "rotation") {
        Some(rotation) => ["w", "x", "y", "z"].map(|part| number(rotation, part).unwrap_or(0.0)),
        None => [1.0, 0.0, 0.0, 0.0],
    };
    let position = match child(node, "translation") {
        Some(of) => DVec3::from_array(["x", "y", "z"].map(|part| number(of, part).unwrap_or(0.0))),
        None => DVec3::ZERO,
    };
    let orientation = DQuat::from_xyzw(x, y, z, w);
    let length = orientation.length();
    let is_pose = length > 0.0 && length.is_finite() && position.is_finite();
    // A quaternion of unit length stays as it is.
    let orientation = if length == 1.0 { orientation } else { orientation / length };
    is_pose.then_some(Pose { position, orientation })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str =
        r#"<?xml version="1.0"?><e57Root xmlns="http://www.astm.org/COMMIT/E57/2010-e57-v1.0">"#;

    fn described(inner: &str) -> E57Description {
        read(&format!("{HEAD}{inner}</e57Root>\0\0")).unwrap()
    }

    fn of_prototype(fields: &str) -> Vec<Stream> {
        let inner = format!(
            "<data3D><vectorChild><points type=\"CompressedVector\" fileOffset=\"48\" recordCount=\"7\">\
             <prototype type=\"Structure\">{fields}</prototype></points></vectorChild></data3D>"
        );
        described(&inner).scans.remove(0).streams
    }

    #[test]
    fn values_have_types_and_names_have_prefixes() {
        let streams = of_prototype(
            r#"<cartesianX type="Float"/><cartesianY type="Float" precision="single"/>
               <inner type="Structure"><cartesianZ type="ScaledInteger" minimum="-5" maximum="1e3" scale="0.5"/></inner>
               <nor:normalX xmlns:nor="http://x" type="Float"/><odd:thing type="Integer" minimum="0" maximum="255"/>"#,
        );
        let names: Vec<&str> = streams.iter().map(|stream| &stream.name[..]).collect();
        assert_eq!(names, ["cartesianX", "cartesianY", "cartesianZ", "nor:normalX", "odd:thing"]);
        let encodings: Vec<&NumberCoding> = streams.iter().map(|stream| &stream.encoding).collect();
        assert_eq!(encodings[..2], [&NumberCoding::Double, &NumberCoding::Single]);
        assert_eq!(encodings[2], &NumberCoding::Whole { min: -5, max: 1000, scale: 0.5, offset: 0.0 });
        assert_eq!(encodings[4], &NumberCoding::Whole { min: 0, max: 255, scale: 1.0, offset: 0.0 });
    }

    #[test]
    fn poses_are_made_of_unit_quaternions_or_none() {
        let image = |pose: &str, kind: &str| {
            let inner = format!(
                "<images2D><vectorChild><name> a </name><pose>{pose}</pose><{kind}/></vectorChild></images2D>"
            );
            described(&inner).images.remove(0).pose
        };
        let turned = "<rotation><w>2</w><x/><y/><z/></rotation><translation><x>4</x><y>5</y><z type=\"ScaledInteger\" scale=\"2\">3</z></translation>";
        let pose = image(turned, "pinholeRepresentation").unwrap();
        assert_eq!(pose, Pose { position: DVec3::new(4.0, 5.0, 6.0), orientation: DQuat::IDENTITY });
        let pose = image(turned, "sphericalRepresentation").unwrap();
        let [forward, up] = [DVec3::NEG_Z, DVec3::Y].map(|axis| pose.orientation * axis);
        assert!((forward - DVec3::X).length() < 1e-15 && (up - DVec3::Z).length() < 1e-15);
        assert_eq!(image("<rotation><w>0</w></rotation>", "a"), None);
        assert_eq!(image("<translation><x>NaN</x></translation>", "a"), None);
    }

    #[test]
    fn limits_may_be_scaled_or_missing() {
        let of = |limits: &str| {
            described(&format!("<data3D><v><colorLimits>{limits}</colorLimits></v></data3D>")).scans[0]
                .color_limits[0]
        };
        let scaled = r#"<colorRedMinimum type="Integer"/><colorRedMaximum type="ScaledInteger" scale="0.5">510</colorRedMaximum>"#;
        assert_eq!(of(scaled), Some((0.0, 255.0)));
        assert_eq!(of("<colorRedMinimum/><colorRedMaximum/>"), None);
        assert_eq!(of("<colorRedMinimum/>"), None);
    }

    #[test]
    fn broken_descriptions_are_said_to_be_so() {
        for broken in ["", "\0\0", "<e57Root><a></e57Root>", "no", "<e57Root>"] {
            assert!(read(broken).is_err(), "{broken}");
        }
        assert!(read(&format!("{HEAD}<a {}/></e57Root>", "b ".repeat(9000))).unwrap_err().contains("tag"));
        let many: String = (0..40).map(|n| format!("<p{n}:a/>")).collect();
        assert!(read(&format!("{HEAD}{many}</e57Root>")).unwrap_err().contains("undeclared"));
        // Neither depth nor control characters harm.
        let deep = format!("{HEAD}{}{}</e57Root>", "<a>".repeat(100_000), "</a>".repeat(100_000));
        assert!(read(&deep).unwrap().scans.is_empty());
        assert_eq!(
            described("<e57LibraryVersion>a\u{1}b</e57LibraryVersion>").software.as_deref(),
            Some("a b")
        );
    }
}
