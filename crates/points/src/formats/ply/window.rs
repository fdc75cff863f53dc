//! The part of a text file that is in memory, and where lines and words end in it.

use super::value::parts_words;
use crate::ScanError;
use crate::source::Source;
use std::ops::Range;

/// Bytes of text that are read at once.
pub(super) const GROUP_BYTES: u64 = 4 << 20;
/// Most characters of a bad row that are quoted.
const MOST_QUOTED: usize = 40;

/// Text that was read and not yet used.
#[derive(Debug)]
pub(super) struct TextWindow {
    buffer: Vec<u8>,
    /// Where in the buffer the unused part starts.
    start: usize,
    /// Byte of the file that follows the buffer.
    pub next: u64,
    /// Number of the line that the unused part starts in.
    line: u64,
    /// Byte that ends a line.
    pub line_end: u8,
    /// True if the file has nothing more.
    pub at_end: bool,
}

impl TextWindow {
    /// A window from byte `next` on, which is in line `line`.
    pub fn new(next: u64, line: u64, line_end: u8) -> Self {
        Self { buffer: Vec::new(), start: 0, next, line, line_end, at_end: false }
    }

    /// Text that is there to be used.
    pub fn text(&self) -> &[u8] {
        &self.buffer[self.start..]
    }

    /// Reads as much text again as is there, so that a row of any length takes few attempts.
    ///
    /// # Errors
    /// The system cannot read the file; no text is lost then.
    pub fn fill(&mut self, source: &Source) -> Result<(), ScanError> {
        self.buffer.drain(..self.start);
        self.start = 0;
        let more = source.bytes(self.next, GROUP_BYTES.max(self.buffer.len() as u64))?;
        self.at_end = more.is_empty();
        self.next += more.len() as u64;
        self.buffer.extend(more);
        Ok(())
    }

    /// Passes over the first bytes of the text.
    pub fn consume(&mut self, num_bytes: usize) {
        self.line += self.count_line_ends(num_bytes);
        self.start += num_bytes;
    }

    fn count_line_ends(&self, num_bytes: usize) -> u64 {
        self.text()[..num_bytes].iter().filter(|&&byte| byte == self.line_end).count() as u64
    }

    /// The first byte behind the last line that has its end.
    pub fn last_line_end(&self) -> usize {
        self.text().iter().rposition(|&byte| byte == self.line_end).map_or(0, |at| at + 1)
    }

    /// The first byte behind the last word that is whole.
    pub fn last_word_end(&self) -> usize {
        let text = self.text();
        if self.at_end { text.len() } else { text.iter().rposition(parts_words).map_or(0, |at| at + 1) }
    }

    /// The first byte behind the first `most` lines that are not blank, of the lines before byte `end`.
    pub fn end_of_lines(&self, end: usize, most: u64) -> usize {
        if self.count_line_ends(end) <= most {
            return end;
        }
        let (mut at, mut num_lines) = (0, 0);
        for line in self.text()[..end].split_inclusive(|&byte| byte == self.line_end) {
            if num_lines == most {
                break;
            }
            num_lines += u64::from(!is_blank(line));
            at += line.len();
        }
        at
    }

    /// The line that byte `at` of the text is in, and what stands there.
    pub fn quote(&self, at: usize) -> String {
        let number = self.line + self.count_line_ends(at);
        let rest = &self.text()[at..];
        let end = rest.iter().position(|&byte| byte == self.line_end).unwrap_or(rest.len());
        let text = String::from_utf8_lossy(rest[..end].trim_ascii());
        format!("line {number}, {:?}", text.chars().take(MOST_QUOTED).collect::<String>())
    }
}

/// True if there are no words.
#[inline]
pub(super) fn is_blank(text: &[u8]) -> bool {
    text.iter().all(parts_words)
}

/// Cuts text into pieces of about `num_bytes` that end where `is_end` says, or with the text.
pub(super) fn cut(text: &[u8], num_bytes: usize, is_end: impl Fn(u8) -> bool) -> Vec<Range<usize>> {
    let mut pieces = Vec::new();
    let mut start = 0;
    while start < text.len() {
        let least = (start + num_bytes).min(text.len());
        let end = text[least - 1..].iter().position(|&byte| is_end(byte)).map_or(text.len(), |at| least + at);
        pieces.push(start..end);
        start = end;
    }
    pieces
}

/// Number of words of a text that starts with a word or a blank.
pub(super) fn count_words(text: &[u8]) -> u64 {
    let mut in_word = false;
    let mut count = 0;
    for byte in text {
        let is_part = !parts_words(byte);
        count += u64::from(is_part && !in_word);
        in_word = is_part;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(text: &str) -> TextWindow {
        TextWindow { buffer: text.into(), ..TextWindow::new(0, 5, b'\n') }
    }

    #[test]
    fn pieces_end_where_lines_do() {
        let text = b"one\ntwo\n\nthree";
        let pieces = |num_bytes| cut(text, num_bytes, |byte| byte == b'\n');
        assert_eq!(pieces(1), [0..4, 4..8, 8..9, 9..14]);
        assert_eq!(pieces(4), [0..4, 4..8, 8..14]);
        assert_eq!(pieces(5), [0..8, 8..14]);
        assert_eq!((pieces(99).len(), &pieces(99)[0]), (1, &(0..14)));
        assert!(cut(b"", 5, |_| true).is_empty());
    }

    #[test]
    fn words_are_counted_wherever_lines_end() {
        assert_eq!(
            ["", " \n", "a", " a b\r\n\tc ", "a\nb"].map(|text| count_words(text.as_bytes())),
            [0, 0, 1, 3, 2]
        );
    }

    #[test]
    fn lines_are_found_and_quoted() {
        let mut window = window("1 2\n\n 3\n4 5");
        assert_eq!((window.last_line_end(), window.last_word_end()), (8, 10));
        assert_eq!([0, 1, 2, 9].map(|most| window.end_of_lines(8, most)), [0, 4, 8, 8]);
        assert_eq!(window.quote(5), "line 7, \"3\"");
        window.consume(5);
        assert_eq!((window.text(), window.quote(0)), (&b" 3\n4 5"[..], "line 7, \"3\"".into()));
        window.at_end = true;
        assert_eq!(window.last_word_end(), 6);
    }
}
