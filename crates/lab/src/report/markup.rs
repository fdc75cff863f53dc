//! Markup, HTML and SVG alike, that cannot come out malformed: text and attribute values are escaped on their way
//! in, elements are closed. XML's rules are kept too, so that a test can check a page with an XML parser.

use std::fmt::{Display, Write};

/// A piece of well-formed markup.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Markup(String);

/// HTML elements without content and end tag.
const VOID: [&str; 1] = ["meta"];

impl Markup {
    /// Markup of text, which is escaped.
    pub(super) fn text(text: impl Display) -> Self {
        Self(escaped(&text.to_string()))
    }

    /// The program's own style sheet, which is not escaped.
    pub(super) fn style(css: &'static str) -> Self {
        Self(format!("<style>\n{css}</style>"))
    }

    /// An element with attributes and content.
    pub(super) fn element(
        tag: &str,
        attributes: &[(&str, &dyn Display)],
        content: impl Into<Markup>,
    ) -> Self {
        let mut markup = format!("<{tag}");
        for (name, value) in attributes {
            // Writing to a string cannot fail.
            let _ = write!(markup, " {name}=\"{}\"", escaped(&value.to_string()));
        }
        if VOID.contains(&tag) {
            return Self(markup + "/>\n");
        }
        let Markup(content) = content.into();
        // The line ends after elements that no words stand beside, where a line break adds no space.
        let end = if BLOCKS.contains(&tag) { "\n" } else { "" };
        Self(markup + ">" + &content + "</" + tag + ">" + end)
    }

    /// Appends markup.
    pub(super) fn push(&mut self, next: impl Into<Markup>) {
        self.0.push_str(&next.into().0);
    }

    /// The whole as text.
    pub(super) fn into_string(self) -> String {
        self.0
    }
}

/// Elements that end a line of the file.
const BLOCKS: [&str; 18] = [
    "head",
    "title",
    "body",
    "header",
    "section",
    "figure",
    "figcaption",
    "table",
    "tr",
    "svg",
    "path",
    "rect",
    "line",
    "text",
    "p",
    "h1",
    "h2",
    "ul",
];

impl From<&str> for Markup {
    fn from(text: &str) -> Self {
        Self::text(text)
    }
}

impl From<String> for Markup {
    fn from(text: String) -> Self {
        Self::text(text)
    }
}

impl FromIterator<Markup> for Markup {
    fn from_iter<T: IntoIterator<Item = Markup>>(parts: T) -> Self {
        parts.into_iter().fold(Self::default(), |mut all, part| {
            all.push(part);
            all
        })
    }
}

impl<const N: usize> From<[Markup; N]> for Markup {
    fn from(parts: [Markup; N]) -> Self {
        parts.into_iter().collect()
    }
}

/// Escapes the characters that have a meaning in markup. Characters that XML forbids become the replacement character.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' => escaped.push(c),
            '\u{fffe}' | '\u{ffff}' => escaped.push(char::REPLACEMENT_CHARACTER),
            c if c.is_control() => escaped.push(char::REPLACEMENT_CHARACTER),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_from_files_stays_text() {
        let hostile = "</td><script>alert('x')</script>\" onload=\"&\0";
        let cell = Markup::element("td", &[("title", &hostile)], hostile).into_string();
        assert_eq!(cell.matches('<').count(), 2, "{cell}");
        assert_eq!(cell.matches('"').count(), 2, "{cell}");
        assert!(cell.contains("&lt;script&gt;") && cell.contains("&amp;\u{fffd}"), "{cell}");
    }

    #[test]
    fn elements_nest_and_close() {
        let list: Markup = ["a", "b"].into_iter().map(|t| Markup::element("li", &[], t)).collect();
        assert_eq!(Markup::element("ol", &[], list).into_string(), "<ol><li>a</li><li>b</li></ol>");
        let meta = Markup::element("meta", &[("charset", &"utf-8")], "").into_string();
        assert_eq!(meta, "<meta charset=\"utf-8\"/>\n");
    }
}
