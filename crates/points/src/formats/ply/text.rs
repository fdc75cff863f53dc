//! Reads rows of text: values between blanks or semicolons, wherever lines end.
//!
//! By the format's rules a row may take several lines, or share one with others. Nearly all files have one line per
//! row, so that is tried first, block by block in parallel; where every line is exactly a row, both readings agree. If
//! only most lines are rows, the file is damaged in places or long rows are broken, and the few lines in between are
//! looked at one by one. If fewer lines are rows, ends of lines mean nothing, and values are counted.

use super::body::{Body, RowSink, take, take_bad};
use super::reader::{Purpose, RowReader, RowValues};
use super::value::{Words, parts_words, without_blanks};
use super::window::{self, TextWindow, is_blank};
use crate::ScanError;
use crate::formats::number::number;
use crate::source::Source;
use base::task::{Cancelled, Progress};
use rayon::prelude::*;

/// Bytes of text that are a task for a core.
const BLOCK_BYTES: usize = 1 << 17;

/// Reads all whole rows of the first `num_elements` elements. Empty lines do not count.
///
/// # Errors
/// The user stops it, there is no memory, or nothing can be read.
pub(super) fn read<S: RowSink>(
    source: &Source,
    (readers, num_elements): (&[RowReader], usize),
    window: TextWindow,
    body: &mut Body<'_, S>,
    progress: &Progress,
) -> Result<(), ScanError> {
    let mut text = TextBody { source, window, body, progress };
    let mut num_missing = 0;
    for (at, reader) in readers.iter().enumerate().take(num_elements) {
        if reader.num_properties > 0 && reader.count > 0 {
            let more_follow =
                readers[at + 1..].iter().any(|reader| reader.num_properties > 0 && reader.count > 0);
            let left = text.read_element(reader, more_follow)?;
            num_missing = left.max(num_missing);
        }
    }
    if num_elements == readers.len() && num_missing == 0 && text.has_more()? {
        text.body
            .warnings
            .push("has more values behind its last row than its header announces; they were left out".into());
    }
    Ok(())
}

/// Most rows that this many bytes can hold: a digit and a blank per value.
pub(super) fn most_rows(reader: &RowReader, num_bytes: u64) -> u64 {
    reader.count.min(num_bytes.div_ceil(2 * reader.num_properties.max(1)))
}

struct TextBody<'a, 'b, S> {
    source: &'a Source,
    window: TextWindow,
    body: &'a mut Body<'b, S>,
    progress: &'a Progress,
}

/// What was made of a piece of text.
enum Taken {
    /// A number of rows, in a number of bytes.
    Rows(u64, usize),
    /// The text's lines are no rows.
    NotLines,
    /// A row would need more text.
    TooLittle,
}

/// Rows read from a part of the text.
struct TextRows<S> {
    sink: S,
    num_bad: u64,
    /// Byte of the text at which the first bad row starts.
    first_bad: Option<usize>,
}

impl<S: RowSink> TextRows<S> {
    fn new(sink: S) -> Self {
        Self { sink, num_bad: 0, first_bad: None }
    }

    fn bad_row(&mut self, reader: &RowReader, at: usize) {
        self.num_bad += 1;
        self.first_bad.get_or_insert(at);
        take_bad(reader, &mut self.sink);
    }
}

impl<S: RowSink> TextBody<'_, '_, S> {
    /// Reads the rows of an element, and returns how many are missing. `more_follow` is true if other elements have
    /// rows behind them.
    fn read_element(&mut self, reader: &RowReader, more_follow: bool) -> Result<u64, ScanError> {
        let mut left = reader.count;
        // Packed points need to know their number, which lines do not tell before they are counted.
        let mut by_lines = !matches!(reader.purpose, Purpose::Points(has) if has.chunked);
        while left > 0 {
            if self.progress.is_cancelled() {
                return Err(Cancelled.into());
            }
            let taken = if by_lines {
                self.take_lines(reader, left)
            } else {
                self.take_words(reader, left, more_follow)
            };
            match taken {
                Taken::Rows(num_rows, num_bytes) => {
                    left -= num_rows;
                    self.window.consume(num_bytes);
                    self.body.empty()?;
                    if matches!(reader.purpose, Purpose::Points(_)) {
                        self.progress.add(S::progress(num_rows));
                    }
                }
                Taken::NotLines => by_lines = false,
                Taken::TooLittle if self.window.at_end => break,
                Taken::TooLittle => self.fill()?,
            }
        }
        Ok(left)
    }

    fn fill(&mut self) -> Result<(), ScanError> {
        match self.window.fill(self.source) {
            Err(ScanError::Io { error, .. }) => {
                self.window.at_end = true;
                self.body.fail(self.source, self.window.next, Some(error))
            }
            other => other,
        }
    }

    /// True if anything is left except blanks.
    fn has_more(&mut self) -> Result<bool, ScanError> {
        while is_blank(self.window.text()) {
            if self.window.at_end {
                return Ok(false);
            }
            self.window.consume(self.window.text().len());
            self.fill()?;
        }
        Ok(true)
    }

    /// Takes at most `left` rows, from whole lines.
    fn take_lines(&mut self, reader: &RowReader, left: u64) -> Taken {
        let text = self.window.text();
        let end = self.window.last_line_end();
        if end == 0 {
            // The last line has no end, or a line is endless.
            let is_long = text.len() as u64 >= window::GROUP_BYTES;
            return if self.window.at_end || is_long { Taken::NotLines } else { Taken::TooLittle };
        }
        let text = &text[..self.window.end_of_lines(end, left)];
        let line_end = self.window.line_end;
        let blocks = window::cut(text, BLOCK_BYTES, |byte| byte == line_end);
        let empty = self.body.sink.part(0, 0);
        let parts: Vec<Lines<S>> = blocks
            .into_par_iter()
            .map_init(RowValues::default, |row, block| {
                Lines::read(reader, &text[block], line_end, empty.part(0, 0), row)
            })
            .collect();
        let sum = |count: fn(&Lines<S>) -> u64| parts.iter().map(count).sum::<u64>();
        let (num_lines, num_exact, num_wordy) =
            (sum(|part| part.num_lines), sum(|part| part.num_exact), sum(|part| part.num_wordy));
        if num_exact == num_lines {
            let num_bytes = text.len();
            parts.into_iter().for_each(|part| self.body.sink.append(part.sink));
            return Taken::Rows(num_lines, num_bytes);
        }
        // If a quarter to a half of the lines are rows, the text is damaged if words that are no numbers stand in the
        // way of the other reading.
        let num_rows = num_exact + num_wordy;
        let is_damaged = 2 * num_rows >= num_lines
            || 4 * num_rows >= num_lines
                && self.read_words(reader, text, left, false).0.iter().any(|part| part.num_bad > 0);
        if !is_damaged {
            return Taken::NotLines;
        }
        let (part, num_rows, num_bytes) = self.read_damaged(reader, text, left, empty);
        self.add(part);
        Taken::Rows(num_rows, num_bytes)
    }

    /// Reads lines of which most are rows, one after the other. Returns the rows, their number, and the bytes that they
    /// take.
    fn read_damaged(
        &self,
        reader: &RowReader,
        text: &[u8],
        left: u64,
        empty: S,
    ) -> (TextRows<S>, u64, usize) {
        let (mut part, mut num_rows) = (TextRows::new(empty), 0);
        // Starts of the lines that are no rows.
        let mut odd: Vec<usize> = Vec::new();
        let mut row = RowValues::default();
        let mut at = 0;
        for line in text.split_inclusive(|&byte| byte == self.window.line_end) {
            let start = at;
            at += line.len();
            if is_blank(line) {
                continue;
            }
            if read_exactly(reader, line, &mut row) == Some(true) {
                num_rows += self.settle(reader, &text[..start], &odd, left - num_rows, &mut part);
                odd.clear();
                // The element may be complete before its lines are used up, because odd lines may hold several rows.
                if num_rows == left {
                    return (part, num_rows, start);
                }
                take(reader, &row, &mut part.sink);
                num_rows += 1;
            } else {
                odd.push(start);
            }
        }
        // A broken row may go on in text that is still to come.
        match odd.first() {
            Some(&first) if first > 0 && !self.window.at_end => (part, num_rows, first),
            _ => {
                num_rows += self.settle(reader, text, &odd, left - num_rows, &mut part);
                (part, num_rows, text.len())
            }
        }
    }

    /// Settles what lines that are no rows are, up to the end of `text`: broken rows if together they make whole rows,
    /// otherwise each a row with something behind it, or bad. Returns how many rows they are.
    fn settle(
        &self,
        reader: &RowReader,
        text: &[u8],
        odd: &[usize],
        left: u64,
        part: &mut TextRows<S>,
    ) -> u64 {
        let Some(&first) = odd.first() else { return 0 };
        let mut row = RowValues::default();
        let mut together = part.sink.part(part.sink.num_points(), 0);
        let (mut words, mut num_rows) = (Words(&text[first..]), 0);
        while num_rows < left && !is_blank(words.0) && reader.read_row(&mut words, &mut row).is_some() {
            take(reader, &row, &mut together);
            num_rows += 1;
        }
        if num_rows > 0 && is_blank(words.0) {
            part.sink.append(together);
            return num_rows;
        }
        for (i, &start) in odd.iter().enumerate().take(usize::try_from(left).unwrap_or(usize::MAX)) {
            let end = odd.get(i + 1).copied().unwrap_or(text.len());
            match reader.read_row(&mut Words(&text[start..end]), &mut row) {
                Some(()) => take(reader, &row, &mut part.sink),
                None => part.bad_row(reader, start),
            }
        }
        (odd.len() as u64).min(left)
    }

    /// Takes at most `left` rows, wherever lines end.
    fn take_words(&mut self, reader: &RowReader, left: u64, more_follow: bool) -> Taken {
        let text = &self.window.text()[..self.window.last_word_end()];
        let (parts, num_rows, num_bytes) = self.read_words(reader, text, left, more_follow);
        if num_rows == 0 {
            return Taken::TooLittle;
        }
        parts.into_iter().for_each(|part| self.add(part));
        Taken::Rows(num_rows, num_bytes)
    }

    fn read_words(&self, reader: &RowReader, text: &[u8], left: u64, more_follow: bool) -> RowsRead<S> {
        // The last word of all is whole only if nothing more is announced: a number could have lost digits.
        let last_is_doubtful = self.window.at_end && text.last().is_some_and(|byte| !parts_words(byte));
        let empty = self.body.sink.part(0, 0);
        let first_point = self.body.sink.num_points();
        match reader.num_words() {
            Some(num_words) => {
                let doubt = last_is_doubtful.then_some(more_follow);
                read_counted(reader, num_words, text, (left, doubt), |row| empty.part(first_point + row, 0))
            }
            None => {
                let doubt = |num_rows| last_is_doubtful && (more_follow || num_rows < left);
                read_lists(reader, text, (left, self.window.at_end), doubt, self.window.line_end, empty)
            }
        }
    }

    fn add(&mut self, part: TextRows<S>) {
        self.body.sink.append(part.sink);
        self.body.num_bad_rows += part.num_bad;
        if let Some(at) = part.first_bad
            && self.body.first_bad_row.is_none()
        {
            self.body.first_bad_row = Some(self.window.quote(at));
        }
    }
}

/// Reads a line as a row. Returns `Some(true)` if nothing stands behind the row, `Some(false)` if a word stands there
/// that is no number.
fn read_exactly(reader: &RowReader, line: &[u8], row: &mut RowValues) -> Option<bool> {
    let mut words = Words(line);
    reader.read_row(&mut words, row)?;
    if is_blank(words.0) {
        return Some(true);
    }
    let mut is_wordy = false;
    while let Some(word) = words.word() {
        is_wordy |= number(word).is_none();
    }
    is_wordy.then_some(false)
}

/// Lines read as rows.
struct Lines<S> {
    sink: S,
    /// Lines that are not blank.
    num_lines: u64,
    /// Lines that are exactly a row.
    num_exact: u64,
    /// Lines that are a row with words behind it.
    num_wordy: u64,
}

impl<S: RowSink> Lines<S> {
    fn read(reader: &RowReader, text: &[u8], line_end: u8, sink: S, row: &mut RowValues) -> Self {
        let mut lines = Self { sink, num_lines: 0, num_exact: 0, num_wordy: 0 };
        for line in text.split(|&byte| byte == line_end) {
            match read_exactly(reader, line, row) {
                Some(true) => {
                    lines.num_exact += 1;
                    take(reader, row, &mut lines.sink);
                }
                Some(false) => lines.num_wordy += 1,
                None if is_blank(line) => continue,
                None => {}
            }
            lines.num_lines += 1;
        }
        lines
    }
}

/// Rows of parts of a text, their number, and the bytes that they take.
type RowsRead<S> = (Vec<TextRows<S>>, u64, usize);

/// Reads at most `left` rows of `num_words` words each, in parallel. The text's last word is doubtful if there is a
/// `doubt`; its row is then not read if rows are left or `doubt` says that others follow.
fn read_counted<S: RowSink>(
    reader: &RowReader,
    num_words: u64,
    text: &[u8],
    (left, doubt): (u64, Option<bool>),
    part_from: impl Fn(u64) -> S + Sync,
) -> RowsRead<S> {
    let blocks = window::cut(text, BLOCK_BYTES, |byte| parts_words(&byte));
    let counts: Vec<u64> = blocks.par_iter().map(|block| window::count_words(&text[block.clone()])).collect();
    let total: u64 = counts.iter().sum();
    let mut num_rows = left.min(total / num_words);
    let uses_last = num_rows > 0 && num_rows * num_words == total;
    if uses_last && doubt.is_some_and(|more_follow| more_follow || num_rows < left) {
        num_rows -= 1;
    }
    let first_words = counts.iter().scan(0, |sum, count| Some(std::mem::replace(sum, *sum + count)));
    let tasks: Vec<(usize, u64, u64)> = blocks
        .iter()
        .zip(first_words)
        .zip(&counts)
        .map(|((block, first), count)| (block.start, first, *count))
        .collect();
    let read = |(start, first_word, count): (usize, u64, u64)| {
        // Rows that start in this block.
        let rows = first_word.div_ceil(num_words)..num_rows.min((first_word + count).div_ceil(num_words));
        let mut part = TextRows::new(part_from(rows.start));
        let mut words = Words(&text[start..]);
        let mut row = RowValues::default();
        if !rows.is_empty() {
            skip(&mut words, rows.start * num_words - first_word);
        }
        for _ in rows.clone() {
            let whole = words;
            match reader.read_row(&mut words, &mut row) {
                Some(()) => take(reader, &row, &mut part.sink),
                None => {
                    part.bad_row(reader, text.len() - without_blanks(whole.0).len());
                    words = whole;
                    skip(&mut words, num_words);
                }
            }
        }
        (part, (rows.end == num_rows && !rows.is_empty()).then(|| text.len() - words.0.len()))
    };
    let parts: Vec<(TextRows<S>, Option<usize>)> = tasks.into_par_iter().map(read).collect();
    let num_bytes = parts.iter().filter_map(|(_, end)| *end).max().unwrap_or(0);
    (parts.into_iter().map(|(part, _)| part).collect(), num_rows, num_bytes)
}

fn skip(words: &mut Words, count: u64) {
    for _ in 0..count {
        words.word();
    }
}

/// Reads at most `left` rows with lists, one after the other. `doubt` says whether the row of this number is not whole
/// if it uses up the text. A bad row ends where its line does.
fn read_lists<S: RowSink>(
    reader: &RowReader,
    text: &[u8],
    (left, at_end): (u64, bool),
    doubt: impl Fn(u64) -> bool,
    line_end: u8,
    empty: S,
) -> RowsRead<S> {
    let (mut part, mut words, mut row) = (TextRows::new(empty), Words(text), RowValues::default());
    let mut num_rows = 0;
    while num_rows < left && !is_blank(words.0) {
        let whole = words;
        let is_read = reader.read_row(&mut words, &mut row).is_some();
        let used_up = is_blank(words.0);
        if used_up && (!is_read || at_end && doubt(num_rows + 1)) {
            // The row is not whole, or nobody knows yet.
            words = whole;
            break;
        }
        num_rows += 1;
        if is_read {
            take(reader, &row, &mut part.sink);
        } else {
            let start = text.len() - without_blanks(whole.0).len();
            part.bad_row(reader, start);
            let line = text[start..].iter().position(|&byte| byte == line_end);
            words = Words(&text[line.map_or(text.len(), |end| start + end)..]);
        }
    }
    (vec![part], num_rows, text.len() - words.0.len())
}
