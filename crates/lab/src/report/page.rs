//! One HTML page in one file: it opens without a network, on a phone too, and is dark where the system is dark.

use super::markup::Markup;

/// A page being written.
#[derive(Clone, Debug)]
pub(super) struct Page {
    title: String,
    body: Markup,
}

impl Page {
    /// A page with a heading.
    pub(super) fn new(title: &str) -> Self {
        Self { title: title.into(), body: Markup::element("h1", &[], title) }
    }

    /// Adds content to the section begun last.
    pub(super) fn add(&mut self, content: impl Into<Markup>) {
        self.body.push(content);
    }

    /// Begins a section.
    pub(super) fn section(&mut self, heading: &str) {
        self.add(Markup::element("h2", &[], heading));
    }

    /// The file's text.
    pub(super) fn finish(self) -> String {
        let meta = |name: &str, content: &str| {
            Markup::element("meta", &[("name", &name), ("content", &content)], "")
        };
        let head = [
            Markup::element("meta", &[("charset", &"utf-8")], ""),
            meta("viewport", "width=device-width, initial-scale=1"),
            meta("generator", concat!("scanwalk ", env!("CARGO_PKG_VERSION"))),
            Markup::element("title", &[], self.title),
            Markup::style(include_str!("page.css")),
        ];
        let html = [Markup::element("head", &[], head), Markup::element("body", &[], self.body)];
        let html = Markup::element("html", &[("lang", &"en")], html).into_string();
        format!("<!DOCTYPE html>\n{html}\n")
    }
}

/// A paragraph.
pub(super) fn paragraph(text: &str) -> Markup {
    Markup::element("p", &[], text)
}

/// A paragraph that must not be passed over.
pub(super) fn note(text: &str) -> Markup {
    Markup::element("p", &[("class", &"note")], text)
}

/// A figure and what it shows.
pub(super) fn figure(content: impl Into<Markup>, caption: &str) -> Markup {
    Markup::element("figure", &[], [content.into(), Markup::element("figcaption", &[], caption)])
}

/// Names with their values.
pub(super) fn facts<'a>(facts: impl IntoIterator<Item = (&'a str, &'a str)>) -> Markup {
    let pair = |(name, value): (&str, &str)| {
        [Markup::element("dt", &[], name), Markup::element("dd", &[], value)].into()
    };
    Markup::element("dl", &[], facts.into_iter().map(pair).collect::<Markup>())
}

/// Legend of a figure's colors: class and name.
pub(super) fn keys<'a>(keys: impl IntoIterator<Item = (&'a str, &'a str)>) -> Markup {
    let key = |(class, name): (&str, &str)| {
        Markup::element("li", &[], [Markup::element("span", &[("class", &class)], ""), name.into()])
    };
    Markup::element("ul", &[("class", &"keys")], keys.into_iter().map(key).collect::<Markup>())
}
