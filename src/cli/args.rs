//! Arguments of the smaller commands.

use super::parse;
use clap::Args;
use lab::bench::Table;
use lab::synth::SynthKind;
use std::path::PathBuf;

/// Say what is in the files.
#[derive(Clone, Debug, Args)]
pub struct InfoArgs {
    /// Files that are one scan.
    #[arg(required = true, value_name = "SCAN", help = parse::scans_help())]
    pub scans: Vec<PathBuf>,
    /// Refuse all files if one cannot be read to its end, instead of showing the rest [default: cloud.strict]
    #[arg(long)]
    pub strict: bool,
    /// Say which values each attribute has, and at how many points, instead of where the points lie; the files may be
    /// larger than memory
    #[arg(long)]
    pub attributes: bool,
    /// For programs: one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Write scans as a level-of-detail octree.
#[derive(Clone, Debug, Args)]
pub struct ConvertArgs {
    /// Files that are one scan.
    #[arg(required = true, value_name = "SCAN", help = parse::scans_help())]
    pub scans: Vec<PathBuf>,
    /// OUT.copc.laz, or a folder for Potree 2
    #[arg(short, long, value_name = "OUT")]
    pub out: PathBuf,
}

/// Write a made-up scan.
#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  scanwalk synth terrestrial -o yard.laz
  scanwalk synth aerial -o land.las --points 50000000 --seed 7
  scanwalk synth photogrammetry -o statue.ply          a mesh: triangles between about that many points

The same kind, points and seed give the same bytes on every machine.")]
pub struct SynthArgs {
    /// What to make, each in the point order that such a device writes
    #[arg(value_name = "KIND", value_parser = parse::choice::<SynthKind>())]
    pub kind: SynthKind,
    /// The file to write.
    #[arg(short, long, value_name = "OUT", help = lab::synth::out_help())]
    pub out: PathBuf,
    /// How many points
    #[arg(long, value_name = "N", default_value = "4000000", value_parser = clap::value_parser!(u64).range(1..))]
    pub points: u64,
    /// Another seed, another scan
    #[arg(long, value_name = "S", default_value = "1")]
    pub seed: u64,
}

/// Measure this machine.
#[derive(Clone, Debug, Args)]
pub struct BenchArgs {
    /// A file to measure with.
    #[arg(value_name = "SCAN", help = parse::scan_help())]
    pub scan: Option<PathBuf>,
    /// Which paper's table [default: all]
    #[arg(long, value_name = "TABLE", value_parser = parse::choice::<Table>())]
    pub table: Option<Table>,
    /// Millions of points of the made-up scans, one after the other [default: on a GPU 145, or what memory holds; on a
    /// software driver 1]
    #[arg(long, value_name = "M,M,…", value_delimiter = ',', conflicts_with = "scan", value_parser = parse::millions)]
    pub points: Vec<f64>,
    /// Only these rows, beside hardware points: methods as the tables name them [default: all]
    #[arg(long, value_name = "NAME,NAME,…", value_delimiter = ',')]
    pub method: Vec<String>,
    /// Measured frames of each row
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub runs: usize,
    /// Pixels of every picture [default: the papers']
    #[arg(long, value_name = "WxH", value_parser = parse::size)]
    pub size: Option<[u32; 2]>,
    /// Also write a page with plots
    #[arg(short, long, value_name = "PAGE.html")]
    pub out: Option<PathBuf>,
    /// For programs: one JSON object
    #[arg(long, conflicts_with = "csv")]
    pub json: bool,
    /// For programs: a row a line
    #[arg(long)]
    pub csv: bool,
}

/// Say what measurements show.
#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  scanwalk report frames.csv                        percentiles, misses, the stage that costs
  scanwalk report frames.csv -o report.html         the same with plots, and the worst frames
  scanwalk report before.csv after.csv              is the second faster, and by how much?
  scanwalk report results.json -o bench.html        what `scanwalk bench --json` measured
  scanwalk report 1.json 4.json 16.json -o bench.md its tables as Markdown
  scanwalk report frames.csv --worst-poses worst.poses
  scanwalk view castle.laz --pose-path worst.poses  see the worst frames again

Text goes to stdout in any case. Logs that are compared should replay one pose path.")]
pub struct ReportArgs {
    /// FRAMES.csv: what `scanwalk view --log` wrote; two are compared. RESULTS.json: what `scanwalk bench --json`
    /// wrote; several of one GPU are shown together
    #[arg(value_name = "FRAMES.csv|RESULTS.json", required = true, num_args = 1..)]
    pub files: Vec<PathBuf>,
    /// Write a page with plots: one file that opens without a network; of benchmark results .md too, tables as Markdown
    #[arg(short, long, value_name = "REPORT.html")]
    pub out: Option<PathBuf>,
    /// Write the worst frames as a path of the head, worst first, for `scanwalk view --pose-path`
    #[arg(long, value_name = "OUT.poses")]
    pub worst_poses: Option<PathBuf>,
}

/// List settings with their meanings and values, as a file for --config.
#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples:
  scanwalk settings                             those that most users need, with their defaults
  scanwalk settings fovea                       those of one section
  scanwalk settings near_m                      what one means, and which values it takes
  scanwalk settings --preset performance > my.toml
                                                a file to change and pass with --config

What --preset, --config and --set say is in the values; without words and --laboratory all of it is listed.")]
pub struct SettingsArgs {
    /// Only those whose key has one of these words in it, those of the laboratory too: frame, near_m, lod.fade
    #[arg(value_name = "WORD")]
    pub words: Vec<String>,
    /// Only those of the laboratory: the papers' methods, and what one needs to compare, to measure and to look for faults
    #[arg(long, conflicts_with = "words")]
    pub laboratory: bool,
    /// Settings that belong together, as `view` and `render` take them.
    #[arg(long, value_name = "NAME", help = parse::presets_help())]
    pub preset: Vec<String>,
}

/// Say what this machine has and lacks.
#[derive(Clone, Debug, Args)]
pub struct DoctorArgs {
    /// For programs: a list of checks
    #[arg(long)]
    pub json: bool,
}
