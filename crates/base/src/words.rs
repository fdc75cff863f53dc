//! Words that messages of all parts share: counts as people read them, and what to do about a file that cannot be read.

use std::fmt::Display;
use std::io;

/// A count, however it is written, and what is counted: "1 point", "1,000 points".
pub fn counted(count: impl Display, thing: &str) -> String {
    let count = count.to_string();
    let ending = agreeing(&count, "", "s");
    format!("{count} {thing}{ending}")
}

/// The form that agrees with a count: `one` with 1, `many` with all others.
pub fn agreeing<'a>(count: impl Display, one: &'a str, many: &'a str) -> &'a str {
    if count.to_string() == "1" { one } else { many }
}

/// `num` files, at least one, by the name of the first: "a.las", "a.las and 3 more files".
pub fn files(first: impl Display, num: usize) -> String {
    match num {
        ..=1 => first.to_string(),
        _ => format!("{first} and {}", counted(num - 1, "more file")),
    }
}

/// A count with its thousands grouped: 1234567 as 1,234,567.
pub fn grouped(count: usize) -> String {
    grouped_by(count as u64, ',')
}

/// A count whose thousands have `separator` between them.
pub fn grouped_by(count: u64, separator: char) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(separator);
        }
        text.push(digit);
    }
    text
}

/// What to do about a file that cannot be read, as the end of a sentence; nothing where that is not known.
pub fn advice(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::NotFound => "; check its name and folder",
        io::ErrorKind::PermissionDenied => "; ask its owner for the right to read it (chmod +r)",
        io::ErrorKind::IsADirectory => "; name a file in that folder",
        io::ErrorKind::InvalidData => "; name a file of text",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_grouped() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn one_is_singular() {
        let counts = [0, 1, 2, 1001].map(|count| counted(grouped(count), "more line"));
        assert_eq!(counts, ["0 more lines", "1 more line", "2 more lines", "1,001 more lines"]);
        assert_eq!(
            [0, 1, 11].map(|count| agreeing(count, "it is", "they are")),
            ["they are", "it is", "they are"]
        );
    }
}
