//! The rows of a log as it is written, by the names of its columns.

use std::path::Path;

/// Names of columns, and rows of text.
pub struct LogRows {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl LogRows {
    /// Reads a file that is whole.
    pub fn read(path: &Path) -> Self {
        Self::so_far(path).expect("a log")
    }

    /// Reads the whole lines that a file has so far, without those that begin with `#`; `None` if it does not name its
    /// columns yet.
    pub fn so_far(path: &Path) -> Option<Self> {
        let text = std::fs::read_to_string(path).ok()?;
        let whole = &text[..=text.rfind('\n')?];
        let cells = |line: &str| line.split(',').map(str::to_owned).collect();
        let mut lines = whole.lines().filter(|line| !line.starts_with('#')).map(cells);
        Some(Self { names: lines.next()?, rows: lines.collect() })
    }

    /// A column's texts.
    pub fn column(&self, name: &str) -> Vec<&str> {
        let at = self.names.iter().position(|own| own == name).unwrap_or_else(|| panic!("a column {name}"));
        self.rows.iter().map(|row| &*row[at]).collect()
    }

    /// A column's numbers.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        self.column(name).into_iter().map(|cell| cell.parse().expect("a number")).collect()
    }
}
