//! PLY: points and meshes as scanners' programs and photogrammetry write them, as text or binary.
//!
//! ```text
//!  header ──▶ RowReaders ──binary | text──▶ Survey: box, ranges ──▶ Grid ──binary | text──▶ Rows: columns
//! ```
//!
//! A file is read twice, because the grid of its coordinates and the ranges of its intensities and colors are known
//! only after the last point. So only the columns and the blocks in work are held.

mod binary;
mod body;
mod columns;
mod describe;
mod faces;
mod header;
mod names;
mod point;
mod reader;
mod rows;
mod survey;
mod text;
mod value;
mod window;

use super::{Candidate, Dataset, Format, OpenHints, Take, rows as rows_of_text};
use crate::block::Trailer;
use crate::column::Type;
use crate::source::Source;
use crate::{Attribute, Field, Header, Projection, ScanError, Schema, uncolored};
use base::task::Progress;
use base::words::{agreeing, counted};
use body::{Body, RowSink};
use header::{BYTE_ORDER_MARK, Encoding, PlyHeader};
use point::{Meaning, SplatBox};
use reader::{Color, Intensity, Kept, Opacity, Purpose, RowReader};
use rows::{LeftOut, Rows};
use std::path::Path;
use survey::{Found, SplatBoxes, Survey};
use window::TextWindow;

/// The format PLY.
pub(super) struct Ply;

impl Format for Ply {
    fn names(&self) -> &'static [&'static str] {
        &["PLY"]
    }

    fn has_splats(&self) -> bool {
        true
    }

    fn probe(&self, candidate: &Candidate) -> bool {
        let head = candidate.head;
        let text = head.strip_prefix(BYTE_ORDER_MARK).unwrap_or(head).trim_ascii_start();
        let is_ply = text.get(..3).is_some_and(|word| word.eq_ignore_ascii_case(b"ply"));
        is_ply && text.get(3).is_none_or(u8::is_ascii_whitespace)
    }

    fn open(&self, path: &Path, _: &OpenHints) -> Result<Box<dyn Dataset>, ScanError> {
        let source = Source::open(path)?;
        let ply = PlyHeader::read(&source)?;
        let mut choices = vec![readers(&source, &ply, 0)?];
        let no_points = || ScanError::NoPoints {
            path: source.path().to_owned(),
            reason: "its header has no element named vertex; export it again, with points".into(),
        };
        let (points, has) = points(&choices[0]).ok_or_else(no_points)?;
        let schema = schema(&choices[0], (points, has), ply.encoding == Encoding::Ascii);
        let header = describe::header(&source, &ply, &choices[0], (points, has), schema);
        while has_color(&choices[choices.len() - 1]) {
            choices.push(readers(&source, &ply, choices.len())?);
        }
        // The last choice is without the points' own colors, so that the colors of faces count.
        if choices.len() > 1 && color_of_faces(&choices[choices.len() - 1]) == Color::Absent {
            choices.pop();
        }
        Ok(Box::new(PlyFile { source, ply, choices, header }))
    }
}

/// The element that has the points, and what they have.
fn points(readers: &[RowReader]) -> Option<(&RowReader, Kept)> {
    readers.iter().find_map(|reader| match reader.purpose {
        Purpose::Points(has) => Some((reader, has)),
        _ => None,
    })
}

/// The reader that passes over faces.
fn without_faces(reader: &RowReader) -> RowReader {
    match reader.purpose {
        Purpose::Faces(_) | Purpose::Strips => reader.for_survey(false),
        Purpose::Points(_) | Purpose::Chunks | Purpose::Unused => reader.clone(),
    }
}

/// Number of elements up to the one that has the points.
fn num_up_to_points(readers: &[RowReader]) -> usize {
    let is_points = |reader: &RowReader| matches!(reader.purpose, Purpose::Points(_));
    readers.iter().position(is_points).map_or(0, |at| at + 1)
}

fn has_color(readers: &[RowReader]) -> bool {
    points(readers).is_some_and(|(_, has)| has.color != Color::Absent)
}

/// Attributes that are stored for each point.
fn schema(readers: &[RowReader], (points, has): (&RowReader, Kept), is_text: bool) -> Schema {
    let has_color = has.color != Color::Absent || color_of_faces(readers) != Color::Absent;
    let standard = [
        (has_color, Attribute::Color, Type::U16x3),
        (has.intensity != Intensity::Absent, Attribute::Intensity, Type::U16),
        (has.normal, Attribute::Normal, Type::F32x3),
        (has.opacity != Opacity::Absent, Attribute::Opacity, Type::F32),
    ];
    let standard = standard.into_iter().filter(|(is_there, ..)| *is_there);
    let standard = standard.map(|(_, attribute, kind)| Field::plain(attribute, kind));
    let named = points.scalars.iter().map(|scalar| Field {
        is_detail: scalar.is_detail,
        ..Field::plain(Attribute::Named(scalar.name.clone()), scalar.kind.column(is_text))
    });
    Schema { fields: standard.chain(named).collect(), unread: points.unread.clone() }
}

/// How the colors of faces are stored, if there are any.
fn color_of_faces(readers: &[RowReader]) -> Color {
    let mut colors =
        readers.iter().filter(|reader| reader.count > 0).filter_map(|reader| match reader.purpose {
            Purpose::Faces(color) => Some(color),
            _ => None,
        });
    colors.next().unwrap_or(Color::Absent)
}

/// Plans what is done with each element. The first element named vertex has the points, or else the first that has x, y
/// and z. Number `color` of the points' colors counts.
fn readers(source: &Source, ply: &PlyHeader, color: usize) -> Result<Vec<RowReader>, ScanError> {
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
        RowReader::of_points(element, color).map_err(fail)
    });
    let mut points = points.transpose()?;
    let has_color = points.as_ref().is_some_and(|points| has_color(std::slice::from_ref(points)));
    let reader = |(at, element): (usize, &header::Element)| {
        let points = if Some(at) == vertex { points.take() } else { None };
        points.unwrap_or_else(|| RowReader::of_others(element, has_color))
    };
    Ok(ply.elements.iter().enumerate().map(reader).collect())
}

/// An opened file.
struct PlyFile {
    source: Source,
    ply: PlyHeader,
    /// Plans for all elements, for each of the colors that points have. There is at least one choice, and it has
    /// points.
    choices: Vec<Vec<RowReader>>,
    header: Header,
}

/// A file once it was surveyed.
struct Surveyed<'a> {
    readers: &'a [RowReader],
    meaning: Meaning,
    found: Found,
    /// A sentence about the choice of colors.
    sentence: Option<&'static str>,
}

impl Dataset for PlyFile {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, want: &Projection, take: &mut Take, progress: &Progress) -> Result<Trailer, ScanError> {
        let project =
            |readers: &Vec<RowReader>| readers.iter().map(|reader| reader.projected(want)).collect();
        // There is nothing to choose if no colors are wanted.
        let num_choices = if want.wants(&Attribute::Color) { self.choices.len() } else { 1 };
        let choices: Vec<Vec<RowReader>> = self.choices[..num_choices].iter().map(project).collect();
        let Surveyed { readers, meaning, found, sentence } = self.survey_best(&choices, progress)?;
        // Colors of faces are known only behind the last point.
        let of_faces = color_of_faces(readers);
        let awaits_faces = meaning.has.color == Color::Absent && of_faces != Color::Absent;
        let takes_faces = want.wants_triangles() || awaits_faces;
        let passed: Vec<RowReader> = readers.iter().map(without_faces).collect();
        let (readers, num_elements) =
            if takes_faces { (readers, readers.len()) } else { (&passed[..], num_up_to_points(readers)) };
        let mut faces = readers.iter().filter(|reader| reader.count > 0);
        let has_faces = faces.any(|reader| matches!(reader.purpose, Purpose::Faces(_) | Purpose::Strips));
        let has_opacity = want.wants(&Attribute::Opacity) && meaning.has.opacity != Opacity::Absent;
        let how = columns::how(
            &meaning,
            &found,
            self.extras(readers),
            (has_opacity, has_faces),
            self.num_announced(),
        );
        let block_points = if awaits_faces { usize::MAX } else { want.block_points() };
        let mut rows = Rows::new(&how);
        let memory =
            |_| ScanError::Memory { path: self.source.path().to_owned(), num_points: found.num_kept };
        rows.reserve(found.num_kept.min(block_points as u64)).map_err(memory)?;
        let mut hand_over = |rows: &mut Rows| match rows.xyz.len() {
            num if num < block_points => Ok(()),
            _ => take(rows.hand_over()),
        };
        let mut body = Body::emptied_by(rows, &mut hand_over);
        self.pass(readers, num_elements, &mut body, progress)?;
        let bad_rows = bad_rows(&body);
        let Body { sink: mut rows, mut losses, mut warnings, .. } = body;
        losses.extend(self.cut_off(rows.num_points(), takes_faces.then_some(rows.faces.num_faces)));
        losses.extend(bad_rows);
        let loss = columns::settle_faces(&mut rows);
        if rows.num_kept() == 0 {
            // No point can be held, or the file changed since the survey.
            return Err(self.no_points(None, rows.left_out.far));
        }
        warnings.extend(sentences(rows.left_out, loss, meaning.has.is_splat));
        warnings.extend(sentence.map(str::to_owned));
        if !rows.xyz.is_empty() {
            take(rows.hand_over())?;
        }
        let (triangles, white) = (rows.faces.triangles, columns::white(&meaning, &found, of_faces));
        Ok(Trailer { triangles, white, losses, warnings })
    }
}

impl PlyFile {
    /// Goes once over the rows of the first elements.
    fn pass<S: RowSink>(
        &self,
        readers: &[RowReader],
        num_elements: usize,
        body: &mut Body<'_, S>,
        progress: &Progress,
    ) -> Result<(), ScanError> {
        let Self { source, ply, .. } = self;
        match ply.encoding {
            Encoding::Ascii => {
                let window = TextWindow::new(ply.body_offset, ply.body_line, ply.line_end);
                text::read(source, (readers, num_elements), window, body, progress)
            }
            encoding => {
                let place = (ply.body_offset, encoding == Encoding::BigEndian);
                binary::read(source, &readers[..num_elements], place, body, progress)
            }
        }
    }

    /// Attributes that are wanted by the file's own names, and the types of their columns.
    fn extras(&self, readers: &[RowReader]) -> Vec<(Attribute, Type)> {
        let is_text = self.ply.encoding == Encoding::Ascii;
        let wanted = points(readers).map(|(reader, _)| &reader.wanted[..]).unwrap_or_default();
        wanted.iter().map(|(attribute, kind)| (attribute.clone(), kind.column(is_text))).collect()
    }

    fn num_announced(&self) -> u64 {
        points(&self.choices[0]).map_or(0, |(reader, _)| reader.count)
    }

    /// Surveys with the one of the points' colors that most points have, or with the colors of faces if all points have
    /// the same color.
    fn survey_best<'a>(
        &self,
        choices: &'a [Vec<RowReader>],
        progress: &Progress,
    ) -> Result<Surveyed<'a>, ScanError> {
        let mut best: Option<(f64, Surveyed)> = None;
        for (number, readers) in choices.iter().enumerate() {
            let is_of_points = has_color(readers);
            let least = best.as_ref().map(|(least, _)| *least);
            if !is_of_points && least.is_some_and(|least| least < 1.0) {
                break;
            }
            let (meaning, found) = self.survey_one(readers, choices.len() > 1, progress)?;
            let lacking = uncolored::part_without(&found.colors, meaning.white());
            if least.is_none_or(|least| lacking < least || !is_of_points) {
                let sentence = match number {
                    0 => None,
                    _ if is_of_points => {
                        Some("has several colors a point: those that most points have are shown")
                    }
                    _ => Some("has the same color at all points: those of its faces are shown"),
                };
                best = Some((lacking, Surveyed { readers, meaning, found, sentence }));
            }
            if lacking == 0.0 {
                break;
            }
        }
        // There is at least one choice.
        let (_, mut surveyed) = best.ok_or_else(|| self.no_points(None, 0))?;
        let is_of_faces =
            |readers: &Vec<RowReader>| !has_color(readers) && color_of_faces(readers) != Color::Absent;
        if has_color(surveyed.readers) && choices.last().is_some_and(is_of_faces) {
            surveyed.sentence =
                Some("has colors of faces beside those of its points: those of faces are not read");
        }
        Ok(surveyed)
    }

    /// Surveys with opacities understood, and leaves nearly transparent points out unless all points are.
    fn survey_one(
        &self,
        readers: &[RowReader],
        with_colors: bool,
        progress: &Progress,
    ) -> Result<(Meaning, Found), ScanError> {
        let has = points(readers).map(|(_, has)| has).ok_or_else(|| self.no_points(None, 0))?;
        let chunks = self.chunks(readers, has, progress)?;
        let mut meaning = Meaning { has, chunks, leaves_faint_out: true };
        let mut found = self.survey(readers, &meaning, with_colors, progress)?;
        if has.opacity == Opacity::Unclear {
            let (low, high) = found.opacity;
            let is_part = low >= 0.0 && high <= 1.0;
            meaning.has.opacity = if is_part { Opacity::PartOf(1) } else { Opacity::Logit };
            found = self.survey(readers, &meaning, with_colors, progress)?;
        }
        if found.num_kept == 0 && found.num_faint > 0 {
            meaning.leaves_faint_out = false;
            found = self.survey(readers, &meaning, with_colors, progress)?;
        }
        Ok((meaning, found))
    }

    /// Finds what must be known of all points first. There is at least one point.
    fn survey(
        &self,
        readers: &[RowReader],
        meaning: &Meaning,
        with_colors: bool,
        progress: &Progress,
    ) -> Result<Found, ScanError> {
        let readers: Vec<RowReader> = readers.iter().map(|reader| reader.for_survey(with_colors)).collect();
        let num_elements = num_up_to_points(&readers);
        let mut body = Body::new(Survey::new(meaning, self.header.num_points, with_colors));
        self.pass(&readers, num_elements, &mut body, progress)?;
        if body.sink.found.num_kept + body.sink.found.num_faint == 0 {
            return Err(self.no_points(body.first_bad_row, body.sink.num_points()));
        }
        Ok(body.sink.found)
    }

    /// Reads the boxes of a compressed splat, and passes over all other elements.
    fn chunks(
        &self,
        readers: &[RowReader],
        has: Kept,
        progress: &Progress,
    ) -> Result<Vec<SplatBox>, ScanError> {
        if !has.chunked {
            return Ok(Vec::new());
        }
        let readers: Vec<RowReader> = readers.iter().map(RowReader::for_chunks).collect();
        let mut body = Body::new(SplatBoxes::default());
        self.pass(&readers, readers.len(), &mut body, progress)?;
        Ok(body.sink.0)
    }

    /// The error that says why there are no points although this many were read.
    fn no_points(&self, first_bad_row: Option<String>, num_read: u64) -> ScanError {
        let announced = self.num_announced();
        let reason = match first_bad_row {
            _ if announced == 0 => "its header announces none; choose another file".into(),
            Some(row) => format!(
                "its header announces {announced}, none could be read, see {row}: numbers have points, not commas, and \
                 blanks or semicolons between them; write them so"
            ),
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

    /// Sentences about rows that are announced and not there; nothing about faces if they were passed over.
    fn cut_off(&self, num_points: u64, num_faces: Option<u64>) -> Vec<String> {
        let end = self.source.len();
        let sentence = |what, announced: u64, read: u64| {
            let announced = counted(announced, what);
            format!("announces {announced}, but only {read} could be read (the file has {end} bytes)")
        };
        let faces = self.choices[0]
            .iter()
            .filter(|reader| matches!(reader.purpose, Purpose::Faces(_) | Purpose::Strips));
        let num_faces_announced = faces.map(|reader| reader.count).fold(0, u64::saturating_add);
        let mut sentences = Vec::new();
        if num_points < self.num_announced() {
            sentences.push(sentence("point", self.num_announced(), num_points));
        }
        if let Some(num_faces) = num_faces
            && num_faces < num_faces_announced
        {
            sentences.push(sentence("face", num_faces_announced, num_faces));
        }
        sentences
    }
}

/// A sentence about text that is no row.
fn bad_rows<S>(body: &Body<S>) -> Option<String> {
    let (num_rows, first) = (body.num_bad_rows, body.first_bad_row.as_ref()?);
    Some(rows_of_text::bad_rows(num_rows, first))
}

/// Sentences about rows that could be read and are of no use.
fn sentences(points: LeftOut, faces: columns::Loss, are_splats: bool) -> Vec<String> {
    use crate::far::{self, left_out};
    let LeftOut { without_place, faint, far, colors } = points;
    let columns::Loss { num_triangles, num_faces, num_colors } = faces;
    let faint_thing = if are_splats { "splat" } else { "point" };
    let list = |count: u64, thing| {
        let things = counted(count, thing);
        format!("has {things} with a list of colors of other than 3 or 4 values, which is not read")
    };
    [
        (without_place, left_out(without_place, "point", "without a finite place")),
        (far, far::sentence(far)),
        (faint, left_out(faint, faint_thing, "nearly transparent")),
        (colors, list(colors, "point")),
        (num_colors, list(num_colors, "face")),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_word_tells_the_format() {
        let is_ply = |head: &str| {
            Ply.probe(&Candidate { path: Path::new("a"), is_folder: false, head: head.as_bytes() })
        };
        for yes in ["ply", "ply\n", "ply \r\nformat", "ply\rformat", "PLY\n", "\u{feff}ply\n", "\nPly\n"] {
            assert!(is_ply(yes), "{yes:?}");
        }
        for no in ["", "pl", "plywood\n", "PLYWOOD", "#ply\n"] {
            assert!(!is_ply(no), "{no:?}");
        }
    }
}
