//! What `scanwalk bench --json` writes and `scanwalk report RESULTS.json` reads: one set of types for both.

use super::table::{TextTable, in_order, ms};
use base::words::{advice, grouped_by};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Bytes of a file at most; a larger one is no benchmark result.
const MAX_BYTES: u64 = 16 << 20;
const MAX_ROWS: usize = 10_000;

/// Results of a run on one machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BenchResults {
    /// GPU name.
    pub device: String,
    /// The GPU's driver and its version.
    pub driver: String,
    /// Bytes read and written by a plain copy in the GPU's memory, 10⁹ a second; `None` if not measured.
    #[serde(default)]
    pub copy_gb_per_s: Option<f64>,
    /// One row per measurement.
    pub rows: Vec<BenchRow>,
}

/// A method measured on one scan in one order from one viewpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BenchRow {
    /// `2019`, `2021`, `2021-nodes`, `2022`, `2022-order`, `vr`, `spt`: the paper's table.
    pub table: String,
    /// What was measured with: `courtyard`, `landscape`, `statue`, which are made up, or `scan`.
    #[serde(default)]
    pub model: String,
    /// Name of the method as in the paper, lower case with hyphens: `point-list`, `reduce-early-z`, ….
    pub method: String,
    /// Order of the points in memory: `original`, `morton`, `shuffled`, `shuffled-morton`.
    pub order: String,
    /// Name of the place that the camera looks from.
    pub viewpoint: String,
    /// Points in the scan.
    pub points: u64,
    /// Points that the method read in a frame.
    pub points_read: u64,
    /// Points that asked for a pixel in a frame; discs of a point tree where these are drawn.
    pub points_drawn: u64,
    /// Pixels that these points asked for: by an atomic, or by a write where there is none. A disc asks for several.
    #[serde(default)]
    pub pixels_asked: Option<u64>,
    /// Batches of the cloud: what the papers call nodes.
    #[serde(default)]
    pub nodes: Option<u64>,
    /// Batches that passed the frustum and level of detail.
    #[serde(default)]
    pub nodes_drawn: Option<u64>,
    /// GPU time of a frame.
    pub gpu_ms: GpuMs,
    /// Median of the stages that read points: a frame without clearing, culling and resolving. `None` for methods
    /// without stages.
    #[serde(default)]
    pub geometry_ms: Option<f64>,
    /// Million points read per second of the median frame.
    pub m_points_per_s: f64,
    /// Bytes that the geometry stages loaded in a frame.
    #[serde(default)]
    pub bytes_read: Option<BytesRead>,
    /// Sum of these bytes, in 10⁹ bytes a second of the median frame.
    #[serde(default)]
    pub gb_per_s: Option<f64>,
    /// Median time of `point-list` (the hardware's points) on the same scan in the same order from the same
    /// viewpoint, divided by this row's: more than 1 is faster than the hardware's. `None` without such a row.
    #[serde(default)]
    pub ratio_to_point_list: Option<f64>,
    /// Share of a point tree's discs that are read but not drawn at the tolerance there.
    #[serde(default)]
    pub culled_share: Option<f64>,
    /// Median time in which the CPU records and sends a frame, as a share of its GPU time.
    #[serde(default)]
    pub cpu_share: Option<f64>,
    /// The paper's milliseconds for this row; `None` if it has none.
    #[serde(default)]
    pub paper_ms: Option<f64>,
    /// The GPU that the paper measured on, and its scan.
    #[serde(default)]
    pub paper_device: Option<String>,
    /// The papers' milliseconds on other GPUs, or of other scans that are like this one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub other_papers: Vec<PaperMs>,
    /// The papers' other figures for this row.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub paper_says: Option<PaperSays>,
}

/// A time that a paper measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PaperMs {
    /// Milliseconds of a frame, or of the named part.
    pub ms: f64,
    /// The GPU, and the scan.
    pub device: String,
}

/// What a paper says of a row beside its time, for its own scan and GPU.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PaperSays {
    /// [`BenchRow::nodes`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes: Option<f64>,
    /// [`BenchRow::nodes_drawn`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes_drawn: Option<f64>,
    /// Share of the nodes that are not drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes_culled_share: Option<f64>,
    /// [`BenchRow::points_read`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points_read: Option<f64>,
    /// [`BenchRow::points_drawn`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points_drawn: Option<f64>,
    /// [`BenchRow::m_points_per_s`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub m_points_per_s: Option<f64>,
    /// Million points drawn per second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub m_drawn_per_s: Option<f64>,
    /// [`BenchRow::culled_share`], from and to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub culled_share: Option<[f64; 2]>,
    /// [`BenchRow::cpu_share`], from and to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cpu_share: Option<[f64; 2]>,
}

/// Bytes that the geometry stages load in a frame. They leave out what clearing, culling and resolving move, and the
/// atomics, which read a pixel where it is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BytesRead {
    /// Coordinates: the planes of each batch that its precision takes, or the whole vertices of hardware points.
    pub planes: u64,
    /// Intervals and diameters of discs.
    pub shapes: u64,
    /// Pixels that are looked at by early-z, and for the depth that a color must be near to.
    pub pixels: u64,
    /// Colors of points that are blended. In `closest` quality `resolve` loads colors, which do not count.
    pub colors: u64,
}

impl BytesRead {
    /// Sum of all kinds.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.planes + self.shapes + self.pixels + self.colors
    }
}

/// Milliseconds over the frames of a measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GpuMs {
    /// As many frames were faster as slower.
    pub median: f64,
    /// The fastest frame.
    pub min: f64,
    /// The slowest frame.
    pub max: f64,
}

/// Why a file is no benchmark result.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The file cannot be read.
    #[error("{} cannot be read: {source}{advice}", path.display(), advice = advice(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The file holds something else.
    #[error("{} is no benchmark result: {problem}; `scanwalk bench --json` writes one", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        problem: String,
    },
}

impl BenchResults {
    /// Reads a file.
    ///
    /// # Errors
    /// An unreadable file, other JSON or none, or impossible times.
    pub fn read(path: &Path) -> Result<Self, BenchError> {
        let unreadable = |source| BenchError::Io { path: path.to_owned(), source };
        let format = |problem| BenchError::Format { path: path.to_owned(), problem };
        let mut text = Vec::new();
        let file = File::open(path).map_err(unreadable)?;
        file.take(MAX_BYTES + 1).read_to_end(&mut text).map_err(unreadable)?;
        if text.len() as u64 > MAX_BYTES {
            return Err(format(format!("it is larger than {} MiB", MAX_BYTES >> 20)));
        }
        let results: Self = serde_json::from_slice(&text).map_err(|error| format(error.to_string()))?;
        if results.rows.len() > MAX_ROWS {
            return Err(format(format!("it has more than {MAX_ROWS} rows")));
        }
        match results.rows.iter().position(|row| !row.is_possible()) {
            None => Ok(results),
            Some(at) => Err(format(format!("the times of row {} cannot be", at + 1))),
        }
    }

    /// Merges several runs on one device into one.
    ///
    /// # Errors
    /// The names of two devices that differ.
    pub fn merged(runs: impl IntoIterator<Item = Self>) -> Result<Self, [String; 2]> {
        let mut runs = runs.into_iter();
        let mut all = runs.next().unwrap_or_default();
        for run in runs {
            if run.device != all.device {
                return Err([all.device, run.device]);
            }
            all.rows.extend(run.rows);
        }
        // Rows are sorted by table, in the tables' order, then by the size of the scan.
        let tables: Vec<String> = all.tables().into_iter().map(String::from).collect();
        let place = |row: &BenchRow| tables.iter().position(|table| *table == row.table);
        all.rows.sort_by_key(|row| (place(row), row.points));
        Ok(all)
    }

    /// The tables that rows are of, in the order in which they first appear.
    #[must_use]
    pub fn tables(&self) -> Vec<&str> {
        in_order(self.rows.iter().map(|row| row.table.as_str()))
    }

    /// Facts about the device, name and value.
    pub(super) fn facts(&self) -> Vec<(&'static str, String)> {
        let mut facts = vec![("device", self.device.clone()), ("driver", self.driver.clone())];
        if let Some(gb_per_s) = self.copy_gb_per_s {
            facts.push(("memory", format!("{gb_per_s:.1} GB/s, read and written by a plain copy")));
        }
        facts
    }

    /// The rows of one table.
    pub(super) fn text_table(&self, table: &str) -> TextTable {
        let mut text = TextTable::new([
            "method",
            "model",
            "order",
            "viewpoint",
            "points",
            "read",
            "drawn",
            "pixels",
            "nodes",
            "median ms",
            "min",
            "max",
            "geometry",
            "M points/s",
            "GB/s",
            "x point list",
            "paper ms",
            "paper's GPU",
        ]);
        for row in self.rows.iter().filter(|row| row.table == table) {
            let times = [row.gpu_ms.median, row.gpu_ms.min, row.gpu_ms.max].map(|time| ms(Some(time)));
            let [median, min, max] = times;
            text.row(
                row.method.clone(),
                [
                    row.model.clone(),
                    row.order.clone(),
                    row.viewpoint.clone(),
                    count(row.points),
                    count(row.points_read),
                    count(row.points_drawn),
                    row.pixels_asked.map_or_else(|| "-".into(), count),
                    row.nodes_drawn.zip(row.nodes).map_or_else(
                        || "-".into(),
                        |(drawn, all)| format!("{}/{}", count(drawn), count(all)),
                    ),
                    median,
                    min,
                    max,
                    ms(row.geometry_ms),
                    format!("{:.0}", row.m_points_per_s),
                    row.gb_per_s.map_or_else(|| "-".into(), |rate| format!("{rate:.1}")),
                    row.ratio_to_point_list.map_or_else(|| "-".into(), |ratio| format!("{ratio:.2}")),
                    ms(row.paper_ms),
                    row.paper_device.clone().unwrap_or_else(|| "-".into()),
                ],
            );
        }
        text
    }
}

impl BenchRow {
    /// True if the times are in order and nothing is negative, as with a real clock.
    fn is_possible(&self) -> bool {
        let GpuMs { median, min, max } = self.gpu_ms;
        let others = [self.ratio_to_point_list, self.paper_ms, self.geometry_ms, Some(self.m_points_per_s)];
        let is_amount = |value: f64| (0.0..=1e12).contains(&value);
        is_amount(min)
            && min <= median
            && median <= max
            && is_amount(max)
            && others.into_iter().flatten().all(is_amount)
    }
}

impl fmt::Display for BenchResults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, value) in self.facts() {
            writeln!(f, "{name:<11} {value}")?;
        }
        for table in self.tables() {
            write!(f, "\ntable {table}\n{}", self.text_table(table))?;
        }
        if self.rows.is_empty() {
            writeln!(f, "Nothing was measured.")?;
        }
        Ok(())
    }
}

/// A count with its thousands separated.
pub(super) fn count(num: u64) -> String {
    grouped_by(num, ' ')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_stand_apart() {
        assert_eq!([0, 999, 1000, 12_345_678].map(count), ["0", "999", "1 000", "12 345 678"]);
    }
}
