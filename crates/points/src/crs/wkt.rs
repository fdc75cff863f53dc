//! Well-known text, version 1 or 2, as a tree and as a coordinate system.

use super::{Angle, Axes, Crs, length};

/// Reads a coordinate system from well-known text, and looks up its codes.
pub(crate) fn from_wkt(bytes: &[u8]) -> Crs {
    read(bytes).or_registered()
}

/// Reads a coordinate system from well-known text, without looking up its codes.
pub(super) fn read(bytes: &[u8]) -> Crs {
    let root = parse(&String::from_utf8_lossy(bytes));
    let is_vertical = |node: &WktNode| matches!(node.keyword.as_str(), "VERT_CS" | "VERTCRS" | "VERTICALCRS");
    let vertical = root.find(&is_vertical);
    let vertical_unit_m = vertical.and_then(WktNode::unit_m).and_then(length);
    let Some(system) = root.find(&|node| SystemKind::of(&node.keyword).is_some()) else {
        return Crs { vertical_unit_m, ..Crs::default() };
    };
    let code = system.code();
    let is = |kind: &str| system.child(&["CS"]).is_some_and(|cs| cs.text(0).eq_ignore_ascii_case(kind));
    let axes = match SystemKind::of(&system.keyword) {
        Some(SystemKind::Earth) if is("Cartesian") => Axes::Geocentric,
        Some(SystemKind::Earth) => Axes::Geographic(system.angle()),
        Some(SystemKind::Geocentric) => Axes::Geocentric,
        _ if is("ellipsoidal") => Axes::Geographic(system.angle()),
        _ => Axes::Planar,
    };
    // A third axis of the system itself is its height.
    let third = system.children.iter().filter(|child| child.keyword == "AXIS").nth(2);
    let vertical_unit_m =
        vertical_unit_m.or_else(|| third.and_then(WktNode::unit_m).filter(|_| axes != Axes::Geocentric));
    let name = Some(system.text(0).to_owned());
    Crs {
        lacks_angle: system.angle_radians().is_none(),
        vertical_code: vertical.and_then(WktNode::code),
        ..Crs::new(code, name, axes, system.unit_m(), vertical_unit_m)
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum SystemKind {
    Planar,
    Geocentric,
    /// Geographic, or in version 2 geocentric if its axes are Cartesian.
    Earth,
}

impl SystemKind {
    fn of(keyword: &str) -> Option<Self> {
        match keyword {
            "PROJCS" | "PROJCRS" | "PROJECTEDCRS" | "LOCAL_CS" | "ENGCRS" | "ENGINEERINGCRS" => {
                Some(Self::Planar)
            }
            "GEOCCS" => Some(Self::Geocentric),
            "GEOGCS" | "GEOGCRS" | "GEOGRAPHICCRS" | "GEODCRS" | "GEODETICCRS" => Some(Self::Earth),
            _ => None,
        }
    }
}

/// `KEYWORD["text", 1.0, CHILD[...]]`; texts and numbers are both texts here.
#[derive(Debug, Default)]
struct WktNode {
    keyword: String,
    texts: Vec<String>,
    children: Vec<WktNode>,
}

impl WktNode {
    /// The `index`-th text or number; empty if there is none.
    fn text(&self, index: usize) -> &str {
        self.texts.get(index).map_or("", String::as_str)
    }

    /// The first direct child with one of these keywords.
    fn child(&self, keywords: &[&str]) -> Option<&WktNode> {
        self.children.iter().find(|child| keywords.contains(&child.keyword.as_str()))
    }

    /// The number that the EPSG gave the system.
    fn code(&self) -> Option<u32> {
        let id = self.child(&["AUTHORITY", "ID"]).filter(|id| id.text(0).eq_ignore_ascii_case("EPSG"));
        id.and_then(|id| id.text(1).parse().ok())
    }

    /// Meters of the unit of length that the node states, itself or at its first axis.
    fn unit_m(&self) -> Option<f64> {
        let axis = || self.child(&["AXIS"]).and_then(|axis| axis.child(&["LENGTHUNIT", "UNIT"]));
        let unit = self.child(&["LENGTHUNIT", "UNIT"]).or_else(axis);
        unit.and_then(|unit| unit.text(1).parse().ok())
    }

    /// The unit of angle that the node states, itself or at its first axis; else degrees.
    fn angle(&self) -> Angle {
        Angle::of_radians(self.angle_radians())
    }

    /// Radians of the unit of angle that the node states.
    fn angle_radians(&self) -> Option<f64> {
        let axis = || self.child(&["AXIS"]).and_then(|axis| axis.child(&["ANGLEUNIT", "UNIT"]));
        let unit = self.child(&["ANGLEUNIT", "UNIT"]).or_else(axis);
        unit.and_then(|unit| unit.text(1).parse().ok())
    }

    /// The first node from the top that `wanted` accepts.
    fn find(&self, wanted: &dyn Fn(&WktNode) -> bool) -> Option<&WktNode> {
        if wanted(self) { Some(self) } else { self.children.iter().find_map(|child| child.find(wanted)) }
    }
}

/// Deepest nesting that is read: no coordinate system has more, and recursion has to end.
const DEEPEST: usize = 32;

/// Parses text into a node without keyword that holds all others. Broken text gives what could be understood.
fn parse(text: &str) -> WktNode {
    let mut open = vec![WktNode::default()];
    let mut word = String::new();
    let mut quoted = false;
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            _ if quoted => word.push(c),
            '[' | '(' if open.len() < DEEPEST => {
                let keyword = std::mem::take(&mut word).to_ascii_uppercase();
                open.push(WktNode { keyword, ..WktNode::default() });
            }
            '[' | '(' => break,
            ',' => end_word(&mut open, &mut word),
            ']' | ')' => {
                end_word(&mut open, &mut word);
                close(&mut open);
            }
            _ if c.is_whitespace() || c == '\0' => {}
            _ => word.push(c),
        }
    }
    while open.len() > 1 {
        close(&mut open);
    }
    open.pop().unwrap_or_default()
}

fn end_word(open: &mut [WktNode], word: &mut String) {
    if let Some(node) = open.last_mut()
        && !word.is_empty()
    {
        node.texts.push(std::mem::take(word));
    }
}

fn close(open: &mut Vec<WktNode>) {
    if open.len() > 1
        && let Some(node) = open.pop()
        && let Some(parent) = open.last_mut()
    {
        parent.children.push(node);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_1_and_2() {
        let compound = from_wkt(
            br#"COMPD_CS["both",PROJCS["NAD83 / Oregon LCC (ft)",GEOGCS["NAD83",UNIT["degree",0.0174],
            AUTHORITY["EPSG","4269"]],UNIT["foot",0.3048],AUTHORITY["EPSG","2992"]],VERT_CS["h",UNIT["metre",1]]]"#,
        );
        assert_eq!(compound.name.as_deref(), Some("EPSG:2992, NAD83 / Oregon LCC (ft)"));
        assert_eq!(
            (compound.unit_m, compound.vertical_unit_m, compound.axes),
            (Some(0.3048), Some(1.0), Some(Axes::Planar))
        );
        let v2 = from_wkt(
            br#"PROJCRS["RGF93 / Lambert-93",BASEGEOGCRS["RGF93",ID["EPSG",4171]],CS[Cartesian,2],
            AXIS["x",east,LENGTHUNIT["metre",1.0]],ID["EPSG",2154]]"#,
        );
        assert_eq!(v2.name.as_deref(), Some("EPSG:2154, RGF93 / Lambert-93"));
        assert_eq!((v2.unit_m, v2.vertical_unit_m), (Some(1.0), None));
        let degrees = from_wkt(br#"GEOGCS["WGS 84",UNIT["degree",0.0174],AUTHORITY["EPSG","4326"]]"#);
        assert_eq!((degrees.unit_m, degrees.axes), (None, Some(Axes::Geographic(Angle::Degree))));
    }

    #[test]
    fn heights_have_their_own_unit() {
        for vertical in [
            r#"VERT_CS["h (ftUS)",VERT_DATUM["NAVD88",2005],UNIT["US survey foot",0.304800609601219],AXIS["Up",UP]]"#,
            r#"VERTCRS["h",VDATUM["x"],CS[vertical,1],AXIS["H",up,LENGTHUNIT["US survey foot",0.304800609601219]]]"#,
        ] {
            let text = format!(r#"COMPD_CS["both",PROJCS["p",UNIT["metre",1]],{vertical}]"#);
            let crs = from_wkt(text.as_bytes());
            assert_eq!((crs.unit_m, crs.vertical_unit_m), (Some(1.0), Some(1200.0 / 3937.0)), "{text}");
        }
        let third = br#"PROJCRS["p",CS[Cartesian,3],AXIS["E",east,LENGTHUNIT["metre",1]],AXIS["N",north,LENGTHUNIT["metre",1]],
            AXIS["h",up,LENGTHUNIT["foot",0.3048]]]"#;
        assert_eq!(from_wkt(third).vertical_unit_m, Some(0.3048));
        // Codes alone tell both units.
        let code = from_wkt(
            br#"COMPD_CS["x",PROJCS["p",AUTHORITY["EPSG","26918"]],VERT_CS["h",AUTHORITY["EPSG","6360"]]]"#,
        );
        assert_eq!((code.unit_m, code.vertical_unit_m), (Some(1.0), Some(1200.0 / 3937.0)));
    }

    #[test]
    fn geocentric_and_gradian_systems() {
        for text in [
            r#"GEOCCS["WGS 84",DATUM["x"],UNIT["metre",1],AUTHORITY["EPSG","4978"]]"#,
            r#"GEODCRS["WGS 84",CS[Cartesian,3],AXIS["X",geocentricX],LENGTHUNIT["metre",1],ID["EPSG",4978]]"#,
        ] {
            let crs = from_wkt(text.as_bytes());
            assert_eq!((crs.axes, crs.unit_m), (Some(Axes::Geocentric), Some(1.0)), "{text}");
        }
        let gradian =
            from_wkt(br#"GEOGCS["NTF (Paris)",UNIT["grad",0.01570796326794897],AUTHORITY["EPSG","4807"]]"#);
        assert_eq!(gradian.axes, Some(Axes::Geographic(Angle::Gradian)));
        let by_number = from_wkt(br#"GEOGCS["NTF (Paris)",DATUM["x"],AUTHORITY["EPSG","4807"]]"#);
        assert_eq!(by_number.axes, Some(Axes::Geographic(Angle::Gradian)));
    }

    #[test]
    fn nonsense_is_no_system() {
        assert_eq!(from_wkt(b"\xff\x00]]]]\"["), Crs::default());
        assert_eq!(from_wkt("A[".repeat(100_000).as_bytes()), Crs::default());
    }
}
