//! The ten lines before the rows of each scan in a PTX file: how many rows there are, where the scanner stood, and how its
//! points become those of the file.

use base::space::Pose;
use glam::{DMat3, DQuat, DVec3};

/// Numbers on each of the lines.
const SHAPE: [usize; 10] = [1, 1, 3, 3, 3, 3, 4, 4, 4, 4];
/// Lines that must be there for a file to be told by its content.
const TELLING: usize = 4;
/// How far axes may be from being at right angles and of unit length.
const AXES_TOLERANCE: f64 = 1e-3;

/// What stands before the rows of a scan.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PtxHeader {
    /// Rows that are announced.
    pub announced: u64,
    /// Axes of the scan's coordinates in the file's, and their origin.
    pub axes: DMat3,
    pub origin: DVec3,
    /// Where the scanner stood, if its axes are at right angles.
    pub pose: Option<Pose>,
}

/// The lines of a text that are not blank, each with the byte behind it. `is_all` is true if nothing follows the text,
/// so that its last line is whole.
fn lines(text: &[u8], line_end: u8, is_all: bool) -> impl Iterator<Item = (&[u8], usize)> {
    let mut at = 0;
    let lines = text.split_inclusive(move |&byte| byte == line_end).map(move |line| {
        at += line.len();
        (line, at)
    });
    let is_whole = move |line: &&[u8]| is_all || line.last() == Some(&line_end);
    lines.take_while(move |(line, _)| is_whole(line)).filter(|(line, _)| !line.trim_ascii().is_empty())
}

/// The numbers of a line, if there are only numbers.
fn numbers(line: &[u8]) -> Option<Vec<f64>> {
    // The first line may have a byte order mark.
    let words = std::str::from_utf8(line).ok()?.trim_start_matches('\u{feff}').split_ascii_whitespace();
    words.map(|word| word.parse().ok()).collect()
}

/// A number of columns or of rows.
fn count(numbers: &[f64]) -> Option<u64> {
    let [value] = *numbers else { return None };
    // A f64 holds these exactly.
    (value.fract() == 0.0 && (0.0..=1e15).contains(&value)).then_some(value as u64)
}

/// True if a text, of which there may be more, begins with such lines.
pub(super) fn is_ptx(text: &[u8], line_end: u8) -> bool {
    let mut num_lines = 0;
    for ((line, _), num_words) in lines(text, line_end, false).zip(SHAPE) {
        let is_right = numbers(line).is_some_and(|numbers| {
            numbers.len() == num_words && (num_words > 1 || count(&numbers).is_some())
        });
        if !is_right {
            return false;
        }
        num_lines += 1;
    }
    num_lines >= TELLING
}

impl PtxHeader {
    /// Reads a header from the start of a text, and the byte behind it; `None` if there is none.
    pub fn read(text: &[u8], line_end: u8, is_all: bool) -> Option<(Self, usize)> {
        let mut read: Vec<Vec<f64>> = Vec::with_capacity(SHAPE.len());
        let mut end = 0;
        for ((line, behind), num_words) in lines(text, line_end, is_all).zip(SHAPE) {
            read.push(numbers(line).filter(|numbers| numbers.len() == num_words)?);
            end = behind;
        }
        if read.len() < SHAPE.len() {
            return None;
        }
        let announced = count(&read[0])?.saturating_mul(count(&read[1])?);
        // Each line is an axis, or the origin: points are rows, which are multiplied from the left.
        let vector = |at: usize| DVec3::new(read[at][0], read[at][1], read[at][2]);
        let (axes, origin) = (DMat3::from_cols(vector(6), vector(7), vector(8)), vector(9));
        let is_finite = axes.is_finite() && origin.is_finite();
        let (axes, origin) = if is_finite { (axes, origin) } else { (DMat3::IDENTITY, DVec3::ZERO) };
        let stated = pose(DMat3::from_cols(vector(3), vector(4), vector(5)), vector(2));
        // Some programs leave the scanner where it was before its points were moved.
        let pose = stated.filter(|pose| *pose != Pose::IDENTITY).or_else(|| pose(axes, origin));
        Some((Self { announced, axes, origin, pose }, end))
    }
}

/// A pose of axes that are at right angles and of unit length.
fn pose(axes: DMat3, position: DVec3) -> Option<Pose> {
    let off = (axes.transpose() * axes - DMat3::IDENTITY).to_cols_array();
    let is_turn = off.iter().all(|part| part.abs() < AXES_TOLERANCE) && axes.determinant() > 0.0;
    (is_turn && position.is_finite())
        .then(|| Pose { position, orientation: DQuat::from_mat3(&axes).normalize() })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "2\r\n 3 \r\n10 20 30\r\n0 1 0\r\n-1 0 0\r\n0 0 1\r\n0 1 0 0\r\n-1\t0 0 0\r\n\r\n0 0 1 0\r\n10 20 30 1\r\n";

    #[test]
    fn ten_lines_are_a_header() {
        let (header, end) = PtxHeader::read(format!("{HEAD}1 2 3 0.5\r\n").as_bytes(), b'\n', false).unwrap();
        assert_eq!((header.announced, end), (6, HEAD.len()));
        assert_eq!(header.axes * DVec3::X + header.origin, DVec3::new(10.0, 21.0, 30.0));
        let pose = header.pose.unwrap();
        assert_eq!(pose.position, DVec3::new(10.0, 20.0, 30.0));
        assert!((pose.orientation * DVec3::X - DVec3::Y).length() < 1e-15);
        let whole = HEAD.trim_end().as_bytes();
        assert!(PtxHeader::read(whole, b'\n', false).is_none());
        assert!(PtxHeader::read(whole, b'\n', true).is_some());
        for (from, to) in
            [("2\r\n", "2.5\r\n"), (" 3 ", "-3"), ("10 20 30\r\n0 1", "10 20\r\n0 1"), ("30 1", "30 one")]
        {
            assert!(PtxHeader::read(HEAD.replacen(from, to, 1).as_bytes(), b'\n', true).is_none(), "{from}");
        }
    }

    #[test]
    fn a_scanner_that_was_not_moved_goes_with_its_points() {
        let unmoved = HEAD.replacen("10 20 30\r\n0 1 0\r\n-1 0 0\r\n", "0 0 0\r\n1 0 0\r\n0 1 0\r\n", 1);
        let pose = PtxHeader::read(unmoved.as_bytes(), b'\n', true).unwrap().0.pose.unwrap();
        assert_eq!(pose.position, DVec3::new(10.0, 20.0, 30.0));
        let skewed = HEAD.replace("0 1 0", "0 2 0");
        assert_eq!(PtxHeader::read(skewed.as_bytes(), b'\n', true).unwrap().0.pose, None);
        let nowhere = HEAD.replace("30 1", "inf 1");
        assert_eq!(PtxHeader::read(nowhere.as_bytes(), b'\n', true).unwrap().0.origin, DVec3::ZERO);
    }

    #[test]
    fn its_lines_tell_the_format() {
        assert!(is_ptx(HEAD.as_bytes(), b'\n') && is_ptx(&HEAD.as_bytes()[..60], b'\n'));
        for other in [
            "",
            "2\n3\n",
            "10\n1 2 3 4 5 6 7\n",
            "1 2 3\n4 5 6\n",
            "2\n3\n1 2 3\n1 2 3 4\n",
            "2\nx\n1 2 3\n1 2 3\n",
        ] {
            assert!(!is_ptx(other.as_bytes(), b'\n'), "{other}");
        }
    }
}
