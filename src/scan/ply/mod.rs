//! PLY: points and meshes as scanners' programs and photogrammetry write them, as text or binary.
//!
//! ```text
//!  header ──▶ a Plan an element ──binary | ascii──▶ Body: Rows, f64 ──columns──▶ lattice, 16 bits
//! ```
//!
//! Memory: the columns, and for each point a f64 position (24 bytes) while they are being read.

mod ascii;
mod binary;
mod body;
mod columns;
mod grid;
mod header;
mod plan;
mod rows;
mod value;

use super::source::Source;
use super::{Columns, Format, Header, Reader, ScanError};
use crate::progress::Progress;
use body::Body;
use header::{Encoding, PlyHeader};
use plan::{Color, Intensity, Kept, Plan, Purpose};

/// The format.
pub(super) struct Ply;

impl Format for Ply {
    fn recognises(&self, head: &[u8]) -> bool {
        head.strip_prefix(b"ply").is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
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

/// What is done with each element; the first that is named vertex has the points.
fn plans(source: &Source, ply: &PlyHeader) -> Result<Vec<Plan>, ScanError> {
    let vertex = ply.elements.iter().position(|element| element.name == "vertex");
    let plan = |(at, element): (usize, &header::Element)| {
        if Some(at) != vertex {
            return Ok(Plan::of_others(element));
        }
        let fail = |missing| ScanError::Line {
            path: source.path().to_owned(),
            line: element.line,
            problem: format!("the element vertex has no {missing}: export the file again, with x, y and z"),
        };
        Plan::of_points(element).map_err(fail)
    };
    ply.elements.iter().enumerate().map(plan).collect()
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

    fn read(&self, progress: &Progress) -> Result<Columns, ScanError> {
        let Self { source, ply, plans, .. } = self;
        let mut body = match ply.encoding {
            Encoding::Ascii => ascii::read(source, ply, plans, progress)?,
            encoding => {
                let big_endian = encoding == Encoding::BigEndian;
                binary::read(source, plans, ply.body_offset, big_endian, progress)?
            }
        };
        let (num_read, num_faces_read) = (body.rows.places.len() as u64, body.rows.num_faces);
        let loss = columns::leave_out(&mut body.rows);
        if body.rows.places.is_empty() {
            return Err(ScanError::NoPoints {
                path: source.path().to_owned(),
                reason: self.why_none(&body, num_read),
            });
        }
        let mut warnings = std::mem::take(&mut body.warnings);
        warnings.extend(self.cut_off(num_read, num_faces_read));
        warnings.extend(left_out(&body, &loss));
        Ok(columns::columns(body.rows, self.has, warnings))
    }
}

impl PlyFile {
    /// Why there are no points although so many were read.
    fn why_none(&self, body: &Body, num_read: u64) -> String {
        let announced = self.num_announced;
        match &body.first_bad_line {
            _ if announced == 0 => "its header announces none".into(),
            Some(line) => format!("its header announces {announced}, none could be read, see {line}"),
            None if num_read > 0 => {
                format!("its header announces {announced}, none has a finite place; export it again")
            }
            None => {
                let (start, end) = (self.ply.body_offset, self.source.len());
                format!(
                    "{announced} should follow byte {start}, but the file ends at byte {end}; get it again"
                )
            }
        }
    }

    /// Sentences about rows that are announced and not there.
    fn cut_off(&self, num_points: u64, num_faces: u64) -> Vec<String> {
        let end = self.source.len();
        let sentence = |what, announced: u64, read: u64| {
            format!("announces {announced} {what}, but only {read} could be read (the file has {end} bytes)")
        };
        let faces = self.plans.iter().filter(|plan| matches!(plan.purpose, Purpose::Faces | Purpose::Strips));
        let num_faces_announced = faces.map(|plan| plan.count).fold(0, u64::saturating_add);
        let mut sentences = Vec::new();
        if num_points < self.num_announced {
            sentences.push(sentence("points", self.num_announced, num_points));
        }
        if num_faces < num_faces_announced {
            sentences.push(sentence("faces", num_faces_announced, num_faces));
        }
        sentences
    }
}

/// Sentences about rows that are there and of no use.
fn left_out(body: &Body, loss: &columns::Loss) -> Vec<String> {
    let mut sentences = Vec::new();
    if let Some(line) = &body.first_bad_line {
        let num_lines = body.num_bad_lines;
        sentences
            .push(format!("has {num_lines} lines that could not be read and were left out, first {line}"));
    }
    let without_place = loss.num_points.saturating_sub(body.num_bad_points);
    if without_place > 0 {
        sentences.push(format!("has {without_place} points without a finite place; they were left out"));
    }
    if loss.num_triangles > 0 {
        let num_triangles = loss.num_triangles;
        sentences.push(format!("has {num_triangles} triangles of points that are left out; so were they"));
    }
    if body.rows.num_bad_faces > 0 {
        let num_faces = body.rows.num_bad_faces;
        sentences
            .push(format!("has {num_faces} faces that name points which are not there; they were left out"));
    }
    sentences
}

fn describe(source: &Source, ply: &PlyHeader, plans: &[Plan], points: &Plan, has: Kept) -> Header {
    let kind = match ply.encoding {
        Encoding::Ascii => "ascii",
        Encoding::LittleEndian => "binary little-endian",
        Encoding::BigEndian => "binary big-endian",
    };
    let body_bytes = source.len().saturating_sub(ply.body_offset);
    let num_points = match ply.encoding {
        Encoding::Ascii => ascii::most_rows(points, body_bytes),
        _ => points.count.min(body_bytes / points.row_bytes().0.max(1)),
    };
    Header {
        path: source.path().to_owned(),
        format: format!("PLY, {kind}"),
        num_points,
        attributes: attributes(plans, points, has),
        crs: None,
        unit_m: None,
        software: software(&ply.remarks),
        created: created(&ply.remarks),
        warnings: ply.oddities.clone(),
    }
}

fn attributes(plans: &[Plan], points: &Plan, has: Kept) -> Vec<String> {
    let known = [
        (has.color != Color::Absent, "rgb"),
        (has.intensity != Intensity::Absent, "intensity"),
        (has.normal, "normals"),
    ];
    let mut names: Vec<String> =
        known.into_iter().filter(|(is_there, _)| *is_there).map(|(_, name)| name.to_owned()).collect();
    for plan in plans.iter().filter(|plan| plan.count > 0) {
        match plan.purpose {
            Purpose::Faces => names.push(format!("faces: {}", plan.count)),
            Purpose::Strips => names.push("triangle strips".into()),
            Purpose::Points(_) | Purpose::Unused => {}
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
        for yes in ["ply", "ply\n", "ply \r\nformat", "ply\rformat"] {
            assert!(Ply.recognises(yes.as_bytes()), "{yes:?}");
        }
        for no in ["", "pl", "plywood\n", "PLY\n", "#ply\n"] {
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
