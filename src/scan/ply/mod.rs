//! PLY: points and meshes as scanners' programs and photogrammetry write them, as text or binary.
//!
//! ```text
//!  header ──▶ a Plan an element ──binary | text──▶ Survey: box, ranges ──▶ Grid ──binary | text──▶ Rows: columns
//! ```
//!
//! A file is read twice: which grid its coordinates go to, and what its intensities and colors range over, is known
//! only after the last point. So no more is held than the columns and the blocks in work.

mod binary;
mod body;
mod columns;
mod faces;
pub(super) mod grid;
mod header;
mod plan;
mod point;
mod rows;
mod survey;
mod text;
mod value;
mod window;

use super::source::Source;
use super::{Columns, Format, Header, ReadOptions, Reader, ScanError, up};
use crate::progress::Progress;
use crate::words::{agreeing, counted};
use body::{Body, Sink};
use header::{BYTE_ORDER_MARK, Encoding, PlyHeader};
use plan::{Color, Intensity, Kept, Opacity, Plan, Purpose};
use point::{Chunk, Meaning};
use rows::{LeftOut, Rows};
use survey::{Chunks, Found, Survey};
use window::Window;

/// The format.
pub(super) struct Ply;

impl Format for Ply {
    fn recognises(&self, head: &[u8]) -> bool {
        let text = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(head).trim_ascii_start();
        let is_ply = text.get(..3).is_some_and(|word| word.eq_ignore_ascii_case(b"ply"));
        is_ply && text.get(3).is_none_or(u8::is_ascii_whitespace)
    }

    fn open(&self, source: Source) -> Result<Box<dyn Reader>, ScanError> {
        let ply = PlyHeader::read(&source)?;
        let plans = plans(&source, &ply)?;
        let points = plans.iter().find_map(|plan| match plan.purpose {
            Purpose::Points(has) => Some((plan, has)),
            _ => None,
        });
        let (points, has) = points.ok_or_else(|| ScanError::NoPoints {
            path: source.path().to_owned(),
            reason: "its header has no element named vertex; export it again, with points".into(),
        })?;
        let header = describe(&source, &ply, &plans, points, has);
        let num_announced = points.count;
        Ok(Box::new(PlyFile { source, ply, plans, has, num_announced, header }))
    }
}

/// What is done with each element. The first that is named vertex has the points, or else the first that has x, y and z.
fn plans(source: &Source, ply: &PlyHeader) -> Result<Vec<Plan>, ScanError> {
    let is_vertex = |element: &header::Element| element.name.eq_ignore_ascii_case("vertex");
    let has_places = |element: &header::Element| {
        let has = |axis| element.properties.iter().any(|property| property.name.eq_ignore_ascii_case(axis));
        ["x", "y", "z"].into_iter().all(has)
    };
    let vertex = ply.elements.iter().position(is_vertex).or_else(|| ply.elements.iter().position(has_places));
    let points = vertex.map(|at| {
        let element = &ply.elements[at];
        let fail = |missing| ScanError::Line {
            path: source.path().to_owned(),
            line: element.line,
            problem: format!("the element vertex has no {missing}: export the file again, with x, y and z"),
        };
        Plan::of_points(element).map_err(fail)
    });
    let mut points = points.transpose()?;
    let has_color = points
        .as_ref()
        .is_some_and(|points| matches!(points.purpose, Purpose::Points(has) if has.color != Color::Absent));
    let plan = |(at, element): (usize, &header::Element)| {
        let points = if Some(at) == vertex { points.take() } else { None };
        points.unwrap_or_else(|| Plan::of_others(element, has_color))
    };
    Ok(ply.elements.iter().enumerate().map(plan).collect())
}

/// An opened file.
struct PlyFile {
    source: Source,
    ply: PlyHeader,
    plans: Vec<Plan>,
    has: Kept,
    num_announced: u64,
    header: Header,
}

impl Reader for PlyFile {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, _options: &ReadOptions, progress: &Progress) -> Result<Columns, ScanError> {
        let chunks = self.chunks(progress)?;
        let mut meaning = Meaning { has: self.has, chunks, leaves_faint_out: true };
        let mut found = self.survey(&meaning, progress)?;
        if found.num_kept == 0 && found.num_faint > 0 {
            meaning.leaves_faint_out = false;
            found = self.survey(&meaning, progress)?;
        }
        let faces = self.plans.iter().filter(|plan| plan.count > 0);
        let has_faces = faces.clone().any(|plan| matches!(plan.purpose, Purpose::Faces(_) | Purpose::Strips));
        let mut colors_of_faces = faces.filter_map(|plan| match plan.purpose {
            Purpose::Faces(color) => Some(color),
            _ => None,
        });
        let of_faces = colors_of_faces.next().unwrap_or(Color::Absent);
        let how = columns::how(&meaning, &found, has_faces, self.num_announced);
        let mut rows = Rows::new(&how);
        let memory =
            |_| ScanError::Memory { path: self.source.path().to_owned(), num_points: found.num_kept };
        rows.reserve(found.num_kept).map_err(memory)?;
        let mut body = Body::new(rows);
        self.pass(&self.plans, self.plans.len(), &mut body, progress)?;
        let mut warnings = std::mem::take(&mut body.warnings);
        let num_faces = body.sink.faces.num_faces;
        warnings.extend(self.cut_off(body.sink.num_points(), num_faces));
        let (bad_rows, left_out) = (bad_rows(&body), body.sink.left_out);
        let (columns, loss) = columns::columns(body.sink, &how, &found, of_faces);
        if columns.points.xyz.is_empty() {
            // None can be held, or the file changed since the survey.
            return Err(self.no_points(None, left_out.far));
        }
        warnings.extend(bad_rows);
        warnings.extend(sentences(left_out, loss));
        Ok(Columns { warnings, ..columns })
    }
}

impl PlyFile {
    /// Goes once over the rows of the first elements.
    fn pass<S: Sink>(
        &self,
        plans: &[Plan],
        num_elements: usize,
        body: &mut Body<S>,
        progress: &Progress,
    ) -> Result<(), ScanError> {
        let Self { source, ply, .. } = self;
        match ply.encoding {
            Encoding::Ascii => {
                let window = Window::new(ply.body_offset, ply.body_line, ply.line_end);
                text::read(source, (plans, num_elements), window, body, progress)
            }
            encoding => {
                let place = (ply.body_offset, encoding == Encoding::BigEndian);
                binary::read(source, &plans[..num_elements], place, body, progress)
            }
        }
    }

    /// What must be known of all points first; there is at least one.
    fn survey(&self, meaning: &Meaning, progress: &Progress) -> Result<Found, ScanError> {
        let plans: Vec<Plan> = self.plans.iter().map(Plan::for_survey).collect();
        let is_points = |plan: &Plan| matches!(plan.purpose, Purpose::Points(_));
        let num_elements = plans.iter().position(is_points).map_or(0, |at| at + 1);
        let mut body = Body::new(Survey::new(meaning, self.header.num_points));
        self.pass(&plans, num_elements, &mut body, progress)?;
        if body.sink.found.num_kept + body.sink.found.num_faint == 0 {
            return Err(self.no_points(body.first_bad_row, body.sink.num_points()));
        }
        Ok(body.sink.found)
    }

    /// The boxes of a compressed splat, for which all elements but these are passed over.
    fn chunks(&self, progress: &Progress) -> Result<Vec<Chunk>, ScanError> {
        if !self.has.chunked {
            return Ok(Vec::new());
        }
        let plans: Vec<Plan> = self.plans.iter().map(Plan::for_chunks).collect();
        let mut body = Body::new(Chunks::default());
        self.pass(&plans, plans.len(), &mut body, progress)?;
        Ok(body.sink.0)
    }

    /// Why there are no points although so many were read.
    fn no_points(&self, first_bad_row: Option<String>, num_read: u64) -> ScanError {
        let announced = self.num_announced;
        let reason = match first_bad_row {
            _ if announced == 0 => "its header announces none".into(),
            Some(row) if row.split_once('"').is_some_and(|(_, text)| text.contains(',')) => format!(
                "its header announces {announced}, none could be read, see {row}: numbers have points, not commas, and \
                 blanks between them; write them so"
            ),
            Some(row) => format!("its header announces {announced}, none could be read, see {row}"),
            None if num_read > 0 => {
                format!(
                    "its header announces {announced}, none has a place within 1e15 of zero; export it again"
                )
            }
            None => {
                let (start, end) = (self.ply.body_offset, self.source.len());
                format!(
                    "{announced} should follow byte {start}, but the file ends at byte {end}; get it again"
                )
            }
        };
        ScanError::NoPoints { path: self.source.path().to_owned(), reason }
    }

    /// Sentences about rows that are announced and not there.
    fn cut_off(&self, num_points: u64, num_faces: u64) -> Vec<String> {
        let end = self.source.len();
        let sentence = |what, announced: u64, read: u64| {
            let announced = counted(announced, what);
            format!("announces {announced}, but only {read} could be read (the file has {end} bytes)")
        };
        let faces =
            self.plans.iter().filter(|plan| matches!(plan.purpose, Purpose::Faces(_) | Purpose::Strips));
        let num_faces_announced = faces.map(|plan| plan.count).fold(0, u64::saturating_add);
        let mut sentences = Vec::new();
        if num_points < self.num_announced {
            sentences.push(sentence("point", self.num_announced, num_points));
        }
        if num_faces < num_faces_announced {
            sentences.push(sentence("face", num_faces_announced, num_faces));
        }
        sentences
    }
}

/// A sentence about text that is no row.
fn bad_rows<S>(body: &Body<S>) -> Option<String> {
    let (num_rows, first) = (body.num_bad_rows, body.first_bad_row.as_ref()?);
    let (lines, were) =
        (counted(num_rows, "line"), agreeing(num_rows, "was left out:", "were left out, first"));
    Some(format!("has {lines} that could not be read and {were} {first}"))
}

/// Sentences about rows that could be read and are of no use.
fn sentences(points: LeftOut, faces: columns::Loss) -> Vec<String> {
    use super::far::{self, left_out};
    let LeftOut { without_place, faint, far } = points;
    let columns::Loss { num_triangles, num_faces } = faces;
    [
        (without_place, left_out(without_place, "point", "without a finite place")),
        (far, far::sentence(far)),
        (faint, left_out(faint, "splat", "nearly transparent")),
        (
            num_triangles,
            format!(
                "has {} of points that are left out; so {}",
                counted(num_triangles, "triangle"),
                agreeing(num_triangles, "was it", "were they")
            ),
        ),
        (
            num_faces,
            format!(
                "has {} with points that are not there; {} left out",
                counted(num_faces, "face"),
                agreeing(num_faces, "it was", "they were")
            ),
        ),
    ]
    .into_iter()
    .filter_map(|(count, sentence)| (count > 0).then_some(sentence))
    .collect()
}

fn describe(source: &Source, ply: &PlyHeader, plans: &[Plan], points: &Plan, has: Kept) -> Header {
    let kind = match ply.encoding {
        Encoding::Ascii => "ascii",
        Encoding::LittleEndian => "binary little-endian",
        Encoding::BigEndian => "binary big-endian",
    };
    let body_bytes = source.len().saturating_sub(ply.body_offset);
    let num_points = match ply.encoding {
        Encoding::Ascii => text::most_rows(points, body_bytes),
        _ => points.count.min(body_bytes / points.row_bytes().0.max(1)),
    };
    let splat = match has.color {
        Color::Harmonics => ", Gaussian splat",
        _ if has.chunked => ", compressed Gaussian splat",
        _ => "",
    };
    Header {
        path: source.path().to_owned(),
        format: format!("PLY, {kind}{splat}"),
        num_points,
        attributes: attributes(plans, points, has),
        up: up::stated(&ply.remarks, &points.extra),
        software: software(&ply.remarks),
        created: created(&ply.remarks),
        warnings: ply.oddities.iter().cloned().chain(texture(ply, has)).collect(),
        ..Header::default()
    }
}

/// A sentence about a texture, which is not read.
fn texture(ply: &PlyHeader, has: Kept) -> Option<String> {
    let file = ply.remarks.iter().find_map(|remark| {
        let (word, name) = remark.split_once(char::is_whitespace)?;
        word.eq_ignore_ascii_case("TextureFile").then(|| name.trim())
    });
    let names = |element: &header::Element| {
        let names = element.properties.iter().map(|property| property.name.to_ascii_lowercase());
        names.collect::<Vec<String>>()
    };
    let is_mapped = |names: Vec<String>| {
        let has = |name: &str| names.iter().any(|other| other == name);
        has("texcoord") || has("texture_u") || has("s") && has("t") || has("u") && has("v")
    };
    let texture = match file {
        Some(name) => format!("its texture ({name}) is not read"),
        None if ply.elements.iter().map(names).any(is_mapped) => "its texture is not read".into(),
        None => return None,
    };
    Some(if has.color == Color::Absent {
        format!("has its colors in a texture: {texture}; bake it into colors of vertices to see them")
    } else {
        format!("has a texture beside the colors of its points: {texture}")
    })
}

fn attributes(plans: &[Plan], points: &Plan, has: Kept) -> Vec<String> {
    let known = [
        (has.color != Color::Absent, "rgb"),
        (has.intensity != Intensity::Absent, "intensity"),
        (has.normal, "normals"),
        (has.opacity != Opacity::Absent, "opacity"),
    ];
    let mut names: Vec<String> =
        known.into_iter().filter(|(is_there, _)| *is_there).map(|(_, name)| name.to_owned()).collect();
    for plan in plans.iter().filter(|plan| plan.count > 0) {
        match plan.purpose {
            Purpose::Faces(color) => {
                names.extend((color != Color::Absent).then(|| "rgb of faces".to_owned()));
                names.push(format!("faces: {}", plan.count));
            }
            Purpose::Strips => names.push("triangle strips".into()),
            Purpose::Points(_) | Purpose::Chunks | Purpose::Unused => {}
        }
    }
    names.extend(points.extra.iter().map(|name| format!("extra:{name}")));
    names
}

/// The program that a remark names: "Created by CloudCompare v2.11.1", "VCGLIB generated".
fn software(remarks: &[String]) -> Option<String> {
    let name_in = |remark: &String| {
        let lower = remark.to_ascii_lowercase();
        let behind = ["generated by ", "created by "].iter().find(|words| lower.starts_with(*words));
        let name = match behind {
            Some(words) => remark.get(words.len()..)?,
            None if lower.ends_with(" generated") => remark.get(..remark.len() - " generated".len())?,
            None => return None,
        };
        Some(name.trim_end_matches('!').trim().to_owned()).filter(|name| !name.is_empty())
    };
    remarks.iter().find_map(name_in)
}

/// The day in "Created 2024/03/21 19:18".
fn created(remarks: &[String]) -> Option<String> {
    remarks.iter().find_map(|remark| {
        let day = remark.strip_prefix("Created ")?.split_whitespace().next()?;
        let is_day = day.len() == 10 && day.split('/').map(str::len).eq([4, 2, 2]);
        (is_day && day.bytes().all(|b| b.is_ascii_digit() || b == b'/')).then(|| day.replace('/', "-"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_word_tells_the_format() {
        for yes in ["ply", "ply\n", "ply \r\nformat", "ply\rformat", "PLY\n", "\u{feff}ply\n", "\nPly\n"] {
            assert!(Ply.recognises(yes.as_bytes()), "{yes:?}");
        }
        for no in ["", "pl", "plywood\n", "PLYWOOD", "#ply\n"] {
            assert!(!Ply.recognises(no.as_bytes()), "{no:?}");
        }
    }

    #[test]
    fn remarks_name_program_and_day() {
        let all = |remarks: &[&str]| {
            let remarks: Vec<String> = remarks.iter().map(|&remark| remark.to_owned()).collect();
            (software(&remarks), created(&remarks))
        };
        let cloud =
            all(&["Created by CloudCompare v2.11.1 (Anoia)", "Created 2024/03/21 19:18", "Generated by x!"]);
        assert_eq!(cloud, (Some("CloudCompare v2.11.1 (Anoia)".into()), Some("2024-03-21".into())));
        assert_eq!(all(&["by hand", "VCGLIB generated"]).0.as_deref(), Some("VCGLIB"));
        assert_eq!(all(&["Generated by CloudCompare!"]).0.as_deref(), Some("CloudCompare"));
        assert_eq!(
            all(&["Created by ", "Created yesterday", "Created 2024/3/211", " generated"]),
            (None, None)
        );
    }
}
