//! The shape of a text: where its rows start, how their values are written, how many there are, and what names them.

use crate::formats::rows::{Dialect, Separator, count, is_passed_over};

/// How values may be written, the likeliest first where a text fits several.
const DIALECTS: [Dialect; 7] = [
    Dialect { separator: Separator::Semicolon, point: b'.' },
    Dialect { separator: Separator::Semicolon, point: b',' },
    Dialect { separator: Separator::Tab, point: b'.' },
    Dialect { separator: Separator::Tab, point: b',' },
    Dialect { separator: Separator::Comma, point: b'.' },
    Dialect::BLANKS,
    Dialect { separator: Separator::Blanks, point: b',' },
];
/// Lines that tell the dialect.
const DIALECT_LINES: usize = 1000;
/// Most lines of words before the rows, in a file whose ending says what it is.
const MOST_TITLES: usize = 20;
/// Least part of the lines from the first row on that must be rows.
const LEAST_ROWS: f64 = 0.5;
/// Words that texts of numbers begin with that are no points: grids of heights, models, drawings, curves of a borehole.
const OTHERS: [&str; 10] = ["ncols", "nrows", "off", "coff", "solid", "mtllib", "v", "vn", "dsaa", "tfw"];

/// A text as far as it was looked at.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TextShape {
    /// Byte of the first row.
    pub start: usize,
    /// Byte that ends a line.
    pub line_end: u8,
    pub dialect: Dialect,
    /// Columns of most rows.
    pub num_columns: usize,
    /// Names of the columns, if a line before the rows has them.
    pub names: Option<Vec<String>>,
    /// Lines before the rows that say something else.
    pub remarks: Vec<String>,
    /// Rows that the first line announces, if it is a number.
    pub announced: Option<u64>,
    /// Values of the first rows, NaN where a word is no number.
    pub rows: Vec<Vec<f64>>,
    /// Bytes of a row on average.
    pub row_bytes: f64,
}

impl TextShape {
    /// The shape of a text that begins so; `None` if it has no rows of three numbers and more. The text ends there if
    /// `is_all`. A file `named_so` may have a few lines of words first.
    pub fn of(head: &[u8], is_all: bool, named_so: bool) -> Option<Self> {
        let mark = if head.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        // Old programs end lines with a carriage return alone.
        let line_end = if head.contains(&b'\n') { b'\n' } else { b'\r' };
        let mut lines = Vec::new();
        let mut at = mark;
        for line in head[mark..].split_inclusive(|&byte| byte == line_end) {
            if is_all || line.last() == Some(&line_end) {
                lines.push((at, line));
            }
            at += line.len();
        }
        let dialect = dialect(lines.iter().map(|(_, line)| *line).take(DIALECT_LINES))?;
        let first = lines.iter().position(|(_, line)| is_row(dialect, line))?;
        let (before, rows) = lines.split_at(first);
        let announced = announced(before)?;
        let titles = before.iter().filter(|(_, line)| !is_passed_over(line) && count(line).is_none());
        let titles: Vec<&[u8]> = titles.map(|(_, line)| *line).collect();
        if titles.iter().any(|title| is_of_others(title)) || titles.len() > MOST_TITLES {
            return None;
        }
        let said: Vec<&&[u8]> =
            rows.iter().map(|(_, line)| line).filter(|line| !is_passed_over(line)).collect();
        let num_rows = said.iter().filter(|line| is_row(dialect, line)).count();
        if (num_rows as f64) < LEAST_ROWS * said.len() as f64 {
            return None;
        }
        let num_columns = most_common(said.iter().map(|line| num_words(dialect, line)))?;
        let names = names(before, dialect, num_columns);
        let num_named = usize::from(names.as_ref().is_some_and(|(_, is_title)| *is_title));
        if !named_so && (titles.len() > num_named || num_rows < 2 && !is_all) {
            return None;
        }
        let remarks = before.iter().map(|(_, line)| String::from_utf8_lossy(line.trim_ascii()).into_owned());
        let num_bytes: usize = rows.iter().map(|(_, line)| line.len()).sum();
        Some(Self {
            start: rows[0].0,
            line_end,
            dialect,
            num_columns,
            names: names.map(|(names, _)| names),
            remarks: remarks.filter(|remark| !remark.is_empty()).collect(),
            announced,
            rows: values(dialect, said.into_iter().copied()),
            row_bytes: num_bytes as f64 / rows.len() as f64,
        })
    }
}

/// The values of the lines that are rows.
pub(super) fn values<'a>(dialect: Dialect, lines: impl Iterator<Item = &'a [u8]>) -> Vec<Vec<f64>> {
    let row = |line: &[u8]| {
        let mut cells = dialect.cells(line);
        let words = std::iter::from_fn(|| cells.word());
        words.map(|word| dialect.number(word).unwrap_or(f64::NAN)).collect()
    };
    lines.filter(|line| is_row(dialect, line)).map(row).collect()
}

/// The dialect in which most lines are rows.
fn dialect<'a>(lines: impl Iterator<Item = &'a [u8]> + Clone) -> Option<Dialect> {
    let mut best = None;
    for dialect in DIALECTS {
        let num_rows = lines.clone().filter(|line| is_row(dialect, line)).count();
        if num_rows > best.map_or(0, |(_, most)| most) {
            best = Some((dialect, num_rows));
        }
    }
    best.map(|(dialect, _)| dialect)
}

/// True for a line that begins with three numbers, or with words for none such as "nan". Between separators other than
/// blanks, words may stand among the numbers: names, times of day.
fn is_row(dialect: Dialect, line: &[u8]) -> bool {
    let mut cells = dialect.cells(line);
    if dialect.separator == Separator::Blanks {
        return (0..3).all(|_| cells.word().is_some_and(|word| is_number(dialect, word)));
    }
    let (mut num_numbers, mut num_words) = (0, 0);
    while let Some(word) = cells.word() {
        let is_number = is_number(dialect, word);
        num_numbers += usize::from(is_number);
        num_words += usize::from(!is_number && !word.is_empty());
    }
    num_numbers >= 3 && num_numbers >= num_words
}

fn is_number(dialect: Dialect, word: &[u8]) -> bool {
    let first = word.iter().find(|byte| !matches!(byte, b'-' | b'+' | b'.' | b','));
    let is_none = || [&b"nan"[..], b"inf"].iter().any(|none| first_letters(word).eq_ignore_ascii_case(none));
    first.is_some_and(|first| first.is_ascii_digit() || is_none()) && dialect.number(word).is_some()
}

/// The first three letters of a word behind its sign.
fn first_letters(word: &[u8]) -> &[u8] {
    let word = word.strip_prefix(b"-").unwrap_or(word);
    word.get(..3).unwrap_or(word)
}

fn num_words(dialect: Dialect, line: &[u8]) -> usize {
    let mut cells = dialect.cells(line);
    std::iter::from_fn(|| cells.word()).count()
}

fn most_common(numbers: impl Iterator<Item = usize>) -> Option<usize> {
    let mut counts = std::collections::BTreeMap::new();
    numbers.for_each(|number| *counts.entry(number).or_insert(0) += 1);
    let columns = counts.into_iter().filter(|(number, _)| *number >= 3);
    columns.max_by_key(|(_, count)| *count).map(|(number, _)| number)
}

/// The number of rows that a line before them announces, if one does; `None` if lines of numbers tell a scan of rows and
/// columns, which is PTX.
fn announced(before: &[(usize, &[u8])]) -> Option<Option<u64>> {
    let said = before.iter().map(|(_, line)| *line).filter(|line| !is_passed_over(line));
    let counts: Vec<Option<u64>> = said.map(count).collect();
    match counts[..] {
        [Some(_), Some(_), ..] => None,
        _ => Some(counts.into_iter().flatten().next()),
    }
}

/// True for a line of a known kind of text that is no table of points.
fn is_of_others(line: &[u8]) -> bool {
    let text = String::from_utf8_lossy(line).to_ascii_lowercase();
    let first = text.split_whitespace().next().unwrap_or_default();
    first.starts_with('~') || OTHERS.contains(&first)
}

/// The names of the columns in the last line before the rows that may have them, and whether it is no comment. A comment
/// has names only if it names places, as CloudCompare writes it: "//X,Y,Z,R,G,B".
fn names(before: &[(usize, &[u8])], dialect: Dialect, num_columns: usize) -> Option<(Vec<String>, bool)> {
    for (_, line) in before.iter().rev() {
        let is_title = !is_passed_over(line);
        let text = String::from_utf8_lossy(line);
        let text = text.trim().trim_start_matches(['#', '/', '%', '!']).trim();
        if text.is_empty() || count(text.as_bytes()).is_some() {
            continue;
        }
        let separators =
            [dialect.separator, Separator::Comma, Separator::Semicolon, Separator::Tab, Separator::Blanks];
        for separator in separators {
            let mut cells = Dialect { separator, point: b'.' }.cells(text.as_bytes());
            let words = std::iter::from_fn(|| cells.word());
            let names: Vec<String> = words.map(|word| String::from_utf8_lossy(word).into_owned()).collect();
            let bare: Vec<&str> = names.iter().map(|name| super::units::bare(name)).collect();
            let has_place = crate::formats::names::place(&bare).is_some();
            let is_exact = names.len() == num_columns;
            let are_words = names.iter().all(|name| name.parse::<f64>().is_err());
            if are_words && (has_place && names.len() >= 3 || is_title && is_exact) {
                return Some((names, is_title));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(text: &str) -> Option<TextShape> {
        TextShape::of(text.as_bytes(), true, false)
    }

    #[test]
    fn dialects_are_told_by_most_lines() {
        let dialect = |text: &str| shape(text).map(|shape| (shape.dialect.separator, shape.dialect.point));
        for (text, separator, point) in [
            ("1 2 3\n", Separator::Blanks, b'.'),
            ("1\t2 \t3\n", Separator::Tab, b'.'),
            ("1, 2, 3\n", Separator::Comma, b'.'),
            ("1,5 2,5 3,5\n", Separator::Blanks, b','),
            ("1;2;3\n1,5;2;3\n", Separator::Semicolon, b','),
            ("1;2;3\r\n1.5;2;3\r\n", Separator::Semicolon, b'.'),
            ("1,5\t2\t3\r1,5\t2\t3\r", Separator::Tab, b','),
            ("1  2\t3\n", Separator::Blanks, b'.'),
            ("nan nan nan\n1 2 3\n", Separator::Blanks, b'.'),
        ] {
            assert_eq!(dialect(text), Some((separator, point)), "{text:?}");
        }
    }

    #[test]
    fn names_stand_before_rows() {
        let names = |text: &str| shape(text).unwrap().names.map(|names| names.join("|"));
        assert_eq!(names("X,Y,Z\n1,2,3\n").as_deref(), Some("X|Y|Z"));
        assert_eq!(names("\"X\";\"Y\";\"Z [m]\"\n1;2;3\n").as_deref(), Some("X|Y|Z [m]"));
        assert_eq!(names("//X,Y,Z,R,G,B\n3\n1 2 3 4 5 6\n").as_deref(), Some("X|Y|Z|R|G|B"));
        assert_eq!(names("# made by hand, in a hurry\n# x y z\n1 2 3\n").as_deref(), Some("x|y|z"));
        assert_eq!(names("# made by hand, in a hurry\n1 2 3\n"), None);
        assert_eq!(names("a b c\n1 2 3\n").as_deref(), Some("a|b|c"));
        let pts = shape("2\n1 2 3 4\n5 6 7 8\n").unwrap();
        assert_eq!((pts.announced, pts.num_columns, pts.start, pts.rows.len()), (Some(2), 4, 2, 2));
    }

    #[test]
    fn other_texts_are_no_tables_of_points() {
        for none in [
            "",
            "Meeting on 1 2 3\nNothing decided\n",
            "1 2\n3 4\n",
            "Some words\nand more\n1 2 3\n4 5 6\n",
            "~V\nVERS. 3.0\n~A\n1 2 3\n",
            "# converted\n\n~V\nVERS. 3.0\n~A\n1 2 3\n4 5 6\n",
            "mtllib a.mtl\nv 1 2 3\n",
            "OFF\n8 6 12\n0 0 0\n0 0 1\n",
            "ncols 3\nnrows 2\n1 2 3\n4 5 6\n",
            "2\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n",
            "3\nwater\nO 0.0 0.1 0.2\nH 0.3 0.2 0.1\n",
            "1 2 3 go\nthen walk on\nand on\nand on\n",
            "2024-05-01 10:00 3 4\n",
            "We met on May 1, 2, 3 and 4\nOn 5, 6 and 7, too\n",
        ] {
            assert_eq!(shape(none), None, "{none:?}");
        }
        let titled = "A survey\nof a house\n1 2 3\n4 5 6\n";
        assert!(TextShape::of(titled.as_bytes(), true, true).is_some());
        // Two rows are needed where more may follow.
        assert!(TextShape::of(b"1 2 3\n4 5", false, false).is_none());
        assert!(TextShape::of(b"1 2 3\n4 5 6\n7", false, false).is_some());
    }
}
