//! The rows of a log as it is written, by the names of its columns.

use std::path::Path;

/// Names of columns, and rows of text.
pub struct LogRows {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl LogRows {
    /// Reads a file, without the lines that begin with `#`.
    pub fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).expect("a log");
        let cells = |line: &str| line.split(',').map(str::to_owned).collect();
        let mut lines = text.lines().filter(|line| !line.starts_with('#')).map(cells);
        Self { names: lines.next().expect("names of columns"), rows: lines.collect() }
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
