//! Coordinate systems as scans name them: GeoTIFF keys or well-known text, to a name and a unit.

/// Metres of a US survey foot.
const US_SURVEY_FOOT_M: f64 = 1200.0 / 3937.0;
/// Metres of an international foot.
const FOOT_M: f64 = 0.3048;

/// What could be found out.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Crs {
    /// For people: "EPSG:26910, NAD83 / UTM zone 10N".
    pub name: Option<String>,
    /// Metres a horizontal unit.
    pub unit_m: Option<f64>,
    /// True if x and y are angles.
    pub degrees: bool,
}

impl Crs {
    fn new(code: Option<u32>, name: Option<String>, unit_m: Option<f64>, degrees: bool) -> Self {
        let code = code.filter(|&code| code > 0 && code != 32767);
        let named = name.filter(|name| !name.is_empty() && name != "unnamed" && name != "unknown");
        let name = match (code, named) {
            (Some(code), Some(name)) => Some(format!("EPSG:{code}, {name}")),
            (Some(code), None) => Some(format!("EPSG:{code}")),
            (None, name) => name,
        };
        let unit_m = unit_m.filter(|unit| unit.is_finite() && *unit > 0.0);
        let unit_m = if degrees { None } else { unit_m.or(code.and_then(unit_of_code)) };
        Self { name, unit_m, degrees }
    }
}

/// Metres a unit, for the systems so common that files leave the unit out.
fn unit_of_code(code: u32) -> Option<f64> {
    let metric = matches!(code,
        32601..=32660 | 32701..=32760 // WGS 84 / UTM
        | 25828..=25838               // ETRS89 / UTM
        | 26901..=26923               // NAD83 / UTM
        | 28348..=28358 | 7846..=7859 // GDA / MGA
        | 2154 | 27700 | 28992 | 2056 | 21781 | 31370 | 2180 | 3857 | 4978);
    metric.then_some(1.0)
}

/// From GeoTIFF keys: the key directory, its numbers, its texts.
pub(crate) fn from_geotiff(keys: &[u8], doubles: &[u8], texts: &[u8]) -> Crs {
    let u16_at = |at: usize| keys.get(at..at + 2).map(|b| u16::from_le_bytes([b[0], b[1]]));
    let entries = usize::from(u16_at(6).unwrap_or(0)).min(keys.len() / 8);
    let find = |wanted: u16| {
        (1..=entries)
            .map(|index| 8 * index)
            .find(|&at| u16_at(at) == Some(wanted))
            .and_then(|at| Some((u16_at(at + 2)?, usize::from(u16_at(at + 4)?), u16_at(at + 6)?)))
    };
    let short = |key: u16| find(key).filter(|&(place, ..)| place == 0).map(|(.., value)| value);
    let text = |key: u16| {
        let (_, count, start) = find(key).filter(|&(place, ..)| place == 34737)?;
        let bytes = texts.get(usize::from(start)..)?;
        let text = String::from_utf8_lossy(&bytes[..count.min(bytes.len())]).into_owned();
        let text = text.trim_matches(|c: char| c == '|' || c == '\0' || c.is_whitespace()).to_owned();
        (!text.is_empty() && !text.chars().any(char::is_control)).then_some(text)
    };
    let double = |key: u16| {
        let (.., start) = find(key).filter(|&(place, ..)| place == 34736)?;
        let at = 8 * usize::from(start);
        doubles.get(at..)?.first_chunk().map(|bytes| f64::from_le_bytes(*bytes))
    };
    let unit_m = match short(3076) {
        Some(9001) => Some(1.0),
        Some(9002) => Some(FOOT_M),
        Some(9003) => Some(US_SURVEY_FOOT_M),
        Some(9036) => Some(1000.0),
        _ => double(3077),
    };
    // Model types: 1 projected, 2 geographic, 3 geocentric.
    let projected = short(3072).map(u32::from);
    let degrees = short(1024).map_or(projected.is_none() && short(2048).is_some(), |model| model == 2)
        && projected.is_none();
    let code = if degrees { short(2048).map(u32::from) } else { projected };
    let citation =
        if degrees { text(2049).or_else(|| text(1026)) } else { text(3073).or_else(|| text(1026)) };
    let unit_m = unit_m.or((short(1024) == Some(3)).then_some(1.0));
    Crs::new(code, citation, unit_m, degrees)
}

/// From well-known text, version 1 or 2.
pub(crate) fn from_wkt(bytes: &[u8]) -> Crs {
    let text = String::from_utf8_lossy(bytes);
    let root = parse(&text);
    let Some(system) = root.find(&|node| Kind::of(&node.keyword).is_some()) else { return Crs::default() };
    let kind = Kind::of(&system.keyword);
    let code = system.child(&["AUTHORITY", "ID"]).filter(|id| id.text(0).eq_ignore_ascii_case("EPSG"));
    let code = code.and_then(|id| id.text(1).parse().ok());
    let ellipsoidal = system.child(&["CS"]).is_some_and(|cs| cs.text(0).eq_ignore_ascii_case("ellipsoidal"));
    let cartesian = system.child(&["CS"]).is_some_and(|cs| cs.text(0).eq_ignore_ascii_case("Cartesian"));
    let degrees = kind == Some(Kind::Geographic) && !cartesian || ellipsoidal;
    let axis = || system.child(&["AXIS"]).and_then(|axis| axis.child(&["LENGTHUNIT", "UNIT"]));
    let unit = system.child(&["LENGTHUNIT", "UNIT"]).or_else(axis);
    let unit_m = unit.and_then(|unit| unit.text(1).parse().ok());
    Crs::new(code, Some(system.text(0).to_owned()), unit_m, degrees)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Cartesian,
    Geographic,
}

impl Kind {
    fn of(keyword: &str) -> Option<Self> {
        match keyword {
            "PROJCS" | "PROJCRS" | "PROJECTEDCRS" | "GEOCCS" | "LOCAL_CS" | "ENGCRS" | "ENGINEERINGCRS" => {
                Some(Self::Cartesian)
            }
            "GEOGCS" | "GEOGCRS" | "GEOGRAPHICCRS" | "GEODCRS" | "GEODETICCRS" => Some(Self::Geographic),
            _ => None,
        }
    }
}

/// `KEYWORD["text", 1.0, CHILD[...]]`; texts and numbers are both texts here.
#[derive(Debug, Default)]
struct Node {
    keyword: String,
    texts: Vec<String>,
    children: Vec<Node>,
}

impl Node {
    /// The `index`-th text or number; empty if there is none.
    fn text(&self, index: usize) -> &str {
        self.texts.get(index).map_or("", String::as_str)
    }

    /// The first direct child with one of these keywords.
    fn child(&self, keywords: &[&str]) -> Option<&Node> {
        self.children.iter().find(|child| keywords.contains(&child.keyword.as_str()))
    }

    /// The first node from the top that `wanted` accepts.
    fn find(&self, wanted: &dyn Fn(&Node) -> bool) -> Option<&Node> {
        if wanted(self) { Some(self) } else { self.children.iter().find_map(|child| child.find(wanted)) }
    }
}

/// Deeper nesting than this is no coordinate system, and recursion has to end.
const DEEPEST: usize = 32;

/// A node without keyword that holds what the text holds; broken text gives what could be understood.
fn parse(text: &str) -> Node {
    let mut open = vec![Node::default()];
    let mut word = String::new();
    let mut quoted = false;
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            _ if quoted => word.push(c),
            '[' | '(' if open.len() < DEEPEST => {
                let keyword = std::mem::take(&mut word).to_ascii_uppercase();
                open.push(Node { keyword, ..Node::default() });
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

fn end_word(open: &mut [Node], word: &mut String) {
    if let Some(node) = open.last_mut()
        && !word.is_empty()
    {
        node.texts.push(std::mem::take(word));
    }
}

fn close(open: &mut Vec<Node>) {
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

    fn geotiff(keys: &[[u16; 4]], doubles: &[f64], texts: &str) -> Crs {
        let head = [1, 1, 0, keys.len() as u16];
        let words: Vec<u16> = head.into_iter().chain(keys.iter().flatten().copied()).collect();
        let keys: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        let doubles: Vec<u8> = doubles.iter().flat_map(|value| value.to_le_bytes()).collect();
        from_geotiff(&keys, &doubles, texts.as_bytes())
    }

    #[test]
    fn geotiff_codes_units_and_citations() {
        let utm = geotiff(&[[1024, 0, 1, 1], [3072, 0, 1, 26910], [3073, 34737, 6, 0]], &[], "UTM10|x");
        assert_eq!(utm.name.as_deref(), Some("EPSG:26910, UTM10"));
        assert_eq!((utm.unit_m, utm.degrees), (Some(1.0), false));
        let feet = geotiff(&[[1024, 0, 1, 1], [3072, 0, 1, 2992], [3076, 0, 1, 9002]], &[], "");
        assert_eq!(feet.unit_m, Some(0.3048));
        let own = geotiff(&[[1024, 0, 1, 1], [3072, 0, 1, 32767], [3077, 34736, 1, 1]], &[0.0, 0.5], "");
        assert_eq!((own.name, own.unit_m), (None, Some(0.5)));
        let degrees = geotiff(&[[1024, 0, 1, 2], [2048, 0, 1, 4326], [2049, 34737, 7, 0]], &[], "WGS 84|");
        assert_eq!(degrees.name.as_deref(), Some("EPSG:4326, WGS 84"));
        assert_eq!((degrees.unit_m, degrees.degrees), (None, true));
    }

    #[test]
    fn wkt_1_and_2() {
        let compound = from_wkt(
            br#"COMPD_CS["both",PROJCS["NAD83 / Oregon LCC (ft)",GEOGCS["NAD83",UNIT["degree",0.0174],
            AUTHORITY["EPSG","4269"]],UNIT["foot",0.3048],AUTHORITY["EPSG","2992"]],VERT_CS["h",UNIT["metre",1]]]"#,
        );
        assert_eq!(compound.name.as_deref(), Some("EPSG:2992, NAD83 / Oregon LCC (ft)"));
        assert_eq!((compound.unit_m, compound.degrees), (Some(0.3048), false));
        let v2 = from_wkt(
            br#"PROJCRS["RGF93 / Lambert-93",BASEGEOGCRS["RGF93",ID["EPSG",4171]],CS[Cartesian,2],
            AXIS["x",east,LENGTHUNIT["metre",1.0]],ID["EPSG",2154]]"#,
        );
        assert_eq!(v2.name.as_deref(), Some("EPSG:2154, RGF93 / Lambert-93"));
        assert_eq!(v2.unit_m, Some(1.0));
        let degrees = from_wkt(br#"GEOGCS["WGS 84",UNIT["degree",0.0174],AUTHORITY["EPSG","4326"]]"#);
        assert_eq!((degrees.unit_m, degrees.degrees), (None, true));
    }

    #[test]
    fn nonsense_is_no_system() {
        assert_eq!(from_wkt(b"\xff\x00]]]]\"["), Crs::default());
        assert_eq!(from_wkt("A[".repeat(100_000).as_bytes()), Crs::default());
        assert_eq!(from_geotiff(&[1, 0, 1, 0, 0, 0, 255, 255, 0], &[], &[]), Crs::default());
    }
}
