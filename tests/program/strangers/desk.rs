//! A stranger's desk: a folder with files in it, and the program run there.

use crate::PROGRAM;
use kit::program::{self, RunOutput};
use kit::rows::LogRows;
use serde_json::Value;
use std::path::PathBuf;

/// Pixels of pictures: small, and wider than high.
pub const SIZE: [usize; 2] = [96, 64];

pub struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder") }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn put(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).expect("a file");
    }

    /// Runs the program here, with names relative to the folder.
    pub fn run(&self, args: &[&str]) -> RunOutput {
        program::run(program::command(PROGRAM).args(args).current_dir(self.folder.path()))
    }

    /// Returns what `info --json` says, or how it failed.
    pub fn info(&self, args: &[&str]) -> Result<Info, String> {
        let ran = self.run(&[&["info", "--json"], args].concat());
        match serde_json::from_slice(&ran.out) {
            Ok(json) if ran.code == Some(0) => Ok(Info { json, ran }),
            _ => Err(ran.in_words()),
        }
    }

    /// Returns the picture that `render` makes of these, or how it failed.
    pub fn render(&self, args: &[&str]) -> Result<RenderRun, String> {
        let size = format!("{}x{}", SIZE[0], SIZE[1]);
        let fixed = ["render", "-o", "picture.png", "--size", &size];
        let ran = self.run(&[&fixed[..], args].concat());
        if ran.code != Some(0) {
            return Err(ran.in_words());
        }
        let bytes = std::fs::read(self.path("picture.png")).map_err(|error| error.to_string())?;
        Ok(RenderRun { pixels: decoded(&bytes)?, ran })
    }

    /// Returns where a walk's head is at first, in the coordinates that it walks in, or how it failed.
    pub fn start(&self, args: &[&str]) -> Result<StartRun, String> {
        let fixed = ["view", "--headset", "off", "--window", "off", "--frames", "2", "--log", "frames.csv"];
        let small = ["--set", "simulated.size_px=[64,64]"];
        let ran = self.run(&[&fixed[..], &small, args].concat());
        if ran.code != Some(0) {
            return Err(ran.in_words());
        }
        let rows = LogRows::so_far(&self.path("frames.csv")).ok_or("no log")?;
        let head = ["head_x", "head_y", "head_z"].map(|name| {
            let shown = rows.column(name).into_iter().find(|cell| !cell.is_empty());
            shown.and_then(|cell| cell.parse::<f64>().ok())
        });
        let [Some(x), Some(y), Some(z)] = head else { return Err(format!("the head is at {head:?}")) };
        Ok(StartRun { head: [x, y, z], ran })
    }
}

pub struct Info {
    pub json: Value,
    pub ran: RunOutput,
}

impl Info {
    pub fn points(&self) -> u64 {
        self.json["points"].as_u64().unwrap_or(0)
    }

    /// True if a warning, or a line on stderr, holds all of these words.
    pub fn says(&self, words: &[&str]) -> bool {
        let warnings = self.json["warnings"].as_array().cloned().unwrap_or_default();
        let has_all =
            |text: &str| words.iter().all(|word| text.to_lowercase().contains(&word.to_lowercase()));
        warnings.iter().filter_map(Value::as_str).any(has_all) || self.ran.says(words)
    }

    /// The outcome for a cell of the table.
    pub fn in_words(&self) -> String {
        let warnings = &self.json["warnings"];
        format!("{} points, unit {}, warnings {warnings}", self.points(), self.json["unit_m"])
    }
}

pub struct StartRun {
    pub head: [f64; 3],
    pub ran: RunOutput,
}

impl StartRun {
    /// Distance of the head from a place, and its words for a cell of the table.
    pub fn from(&self, place: [f64; 3]) -> (f64, String) {
        let away: f64 = (0..3).map(|axis| (self.head[axis] - place[axis]).powi(2)).sum();
        (away.sqrt(), format!("{:.2} from the scene, at {:.2?}", away.sqrt(), self.head))
    }
}

/// A picture of [`SIZE`] pixels.
pub struct RenderRun {
    pub pixels: Vec<[u8; 3]>,
    pub ran: RunOutput,
}

impl RenderRun {
    pub fn lit(&self) -> usize {
        self.pixels.iter().filter(|pixel| **pixel != [0; 3]).count()
    }

    /// The brightest of all channels.
    pub fn brightest(&self) -> u8 {
        self.pixels.iter().flatten().copied().max().unwrap_or(0)
    }

    /// Number of pixels of about this color.
    pub fn num_near(&self, color: [u8; 3]) -> usize {
        let near = |pixel: &&[u8; 3]| (0..3).all(|c| pixel[c].abs_diff(color[c]) <= 12);
        self.pixels.iter().filter(near).count()
    }

    pub fn middle_is_lit(&self) -> bool {
        let [width, height] = SIZE;
        let around = |x: usize, y: usize| self.pixels[y * width + x] != [0; 3];
        (height / 2 - 2..height / 2 + 2).any(|y| (width / 2 - 2..width / 2 + 2).any(|x| around(x, y)))
    }

    /// Share of the shorter side that the lit pixels span, across or down, without the last hundredth at each end.
    pub fn span(&self) -> f64 {
        let [width, height] = SIZE;
        let lit = (0..width * height).filter(|at| self.pixels[*at] != [0; 3]);
        let (mut xs, mut ys): (Vec<usize>, Vec<usize>) = lit.map(|at| (at % width, at / width)).unzip();
        let span = |values: &mut Vec<usize>| {
            values.sort_unstable();
            let cut = values.len() / 100;
            values.get(values.len().saturating_sub(1 + cut)).map_or(0, |last| last + 1 - values[cut])
        };
        span(&mut xs).max(span(&mut ys)) as f64 / width.min(height) as f64
    }
}

/// The pixels of a PNG; the error is in words.
pub fn decoded(bytes: &[u8]) -> Result<Vec<[u8; 3]>, String> {
    Ok(kit::picture::Picture::decode(bytes).map_err(|error| error.to_string())?.pixels)
}
