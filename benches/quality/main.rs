//! Compares the pictures of all ways to draw a scan with the truth, which is a denser scan of the same place with 4 × 4
//! samples a pixel. `docs/bench/quality` says what the figures mean and keeps a run.
//!
//! Pictures do not depend on how fast they are drawn, so figures of a software driver are as good as any.

mod contestant;
mod holes_table;

use anyhow::{Context, Result};
use base::space::View;
use clap::Parser;
use contestant::{CONTESTANTS, EyeContestant, Truth};
use holes_table::HolesArgs;
use kit::picture::write_png;
use kit::quality::figures::{ContestantRecording, Motion, QualityFigures, QualityTable};
use kit::quality::motion;
use kit::quality::picture::EyePicture;
use kit::quality::scene::{self, DrawnScan, SOURCES, ScanSource};
use lab::synth::Viewpoint;
use render::gpu::Gpu;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Draws scans in several ways and compares the pictures with the truth.
#[derive(Debug, Parser)]
struct QualityArgs {
    /// Millions of points of a made-up scan
    #[arg(long, value_name = "M", default_value_t = 4.0)]
    points: f64,
    /// How many times as many points the truth gets
    #[arg(long, value_name = "FACTOR", default_value_t = 8)]
    density: u64,
    /// Frames of the tremor
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u32).range(2..))]
    tremor: u32,
    /// Frames of the walk
    #[arg(long, value_name = "N", default_value_t = 25, value_parser = clap::value_parser!(u32).range(2..))]
    walk: u32,
    /// Steps of level of detail while the head stands still
    #[arg(long, value_name = "N", default_value_t = 49, value_parser = clap::value_parser!(u32).range(2..))]
    approach: u32,
    /// Only scans whose name contains this
    #[arg(long, value_name = "NAME", default_value = "")]
    scan: String,
    /// A small scan and small pictures: shows that it works, not how good they are
    #[arg(long)]
    quick: bool,
    /// Also write the figures as CSV
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Also write the pictures
    #[arg(long, value_name = "FOLDER")]
    pictures: Option<PathBuf>,
    #[command(flatten)]
    holes: HolesArgs,
    /// GPU whose name contains this
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Given by `cargo bench`; without it (`cargo test --benches`) the run is quick
    #[arg(long, hide = true)]
    bench: bool,
}

/// Pixels of the eye, as the simulated headset has them.
const SIZE_PX: [u32; 2] = [960, 1080];
const QUICK_SIZE_PX: [u32; 2] = [96, 108];

fn main() -> Result<()> {
    let mut args = QualityArgs::parse();
    let quick = args.quick || !args.bench;
    if quick {
        (args.points, args.density, args.tremor, args.walk, args.approach) = (0.02, 4, 2, 2, 2);
        args.scan = "terrestrial".into();
    }
    let gpu = Arc::new(Gpu::open(args.adapter.as_deref())?);
    let size_px = if quick { QUICK_SIZE_PX } else { SIZE_PX };

    let mut csv = args.csv.as_deref().map(create).transpose()?;
    if args.holes.is_wanted() {
        let mut nowhere = io::sink();
        let csv: &mut dyn Write = csv.as_mut().map_or(&mut nowhere, |csv| csv);
        let points = (1e6 * args.points).round() as u64;
        return args.holes.run(&gpu, (&args.scan, points), csv, args.pictures.as_ref());
    }
    let mut out = io::stdout().lock();
    if let Some(csv) = &mut csv {
        QualityTable::csv_header(csv)?;
    }
    writeln!(out, "{}, {}; {} × {} pixels", gpu.name(), gpu.driver(), size_px[0], size_px[1])?;
    for source in ScanSource::named(&SOURCES, &args.scan)? {
        for table in measure(&gpu, source, size_px, &args).with_context(|| source.name())? {
            table.print(&mut out)?;
            if let Some(csv) = &mut csv {
                table.csv_rows(csv)?;
                csv.flush()?;
            }
        }
    }
    Ok(())
}

fn create(path: &Path) -> Result<BufWriter<File>> {
    Ok(BufWriter::new(File::create(path).with_context(|| format!("{}: cannot be written", path.display()))?))
}

/// A place, and the frames that are drawn there.
struct PlaceFrames {
    place: Viewpoint,
    tremor: Vec<View>,
    walk: Vec<View>,
    approach: Vec<f32>,
}

impl PlaceFrames {
    /// The frames that a contestant draws. The truth, which has no level of detail, draws two of the walk.
    fn motion(&self, is_truth: bool) -> Motion<'_> {
        let (walk, approach) =
            if is_truth { (&self.walk[..2], &[][..]) } else { (&self.walk[..], &self.approach[..]) };
        Motion { tremor: &self.tremor, walk, approach }
    }
}

/// The figures of a scan from each viewpoint.
fn measure(
    gpu: &Arc<Gpu>,
    source: ScanSource,
    size_px: [u32; 2],
    args: &QualityArgs,
) -> Result<Vec<QualityTable>> {
    let stand = |place: Viewpoint| {
        let view = scene::view(&place, size_px);
        let tremor = motion::tremor(&view, args.tremor as usize);
        let walk = motion::walk(&view, place.target, args.walk as usize);
        PlaceFrames { place, tremor, walk, approach: motion::approach(args.approach as usize) }
    };
    let stands: Vec<PlaceFrames> = source.places().into_iter().map(stand).collect();
    let points = (1e6 * args.points).round() as u64;

    // The dense scan is dropped before the other is made.
    let (truths, num_true_points) = {
        let dense = scene::flat(&source.dense_scan(args.density * points)?)?;
        let truths = recordings(&mut Truth::new(gpu, &dense, size_px)?, &stands, true)?;
        (truths, dense.num_points)
    };
    let scene = DrawnScan::new(source.scan(points)?)?;
    let mut tables = Vec::new();
    for (stand, truth) in stands.iter().zip(&truths) {
        let figures = QualityFigures::new(&stand.tremor[0], truth, truth);
        keep(args, source, stand, "truth", truth.still())?;
        tables.push(QualityTable {
            scan: source.name(),
            viewpoint: stand.place.name,
            num_points: scene.cloud.num_points,
            num_true_points,
            rows: vec![("truth", figures)],
        });
    }
    for (name, make) in CONTESTANTS {
        let drawn = recordings(make(gpu, &scene, size_px)?.as_mut(), &stands, false)?;
        for (((table, stand), drawn), truth) in tables.iter_mut().zip(&stands).zip(&drawn).zip(&truths) {
            table.rows.push((name, QualityFigures::new(&stand.tremor[0], drawn, truth)));
            keep(args, source, stand, name, drawn.still())?;
        }
    }
    Ok(tables)
}

fn recordings(
    contestant: &mut dyn EyeContestant,
    stands: &[PlaceFrames],
    is_truth: bool,
) -> Result<Vec<ContestantRecording>> {
    let recording = |stand: &PlaceFrames| {
        ContestantRecording::new(stand.motion(is_truth), |view, lod_scale| contestant.draw(view, lod_scale))
    };
    stands.iter().map(recording).collect()
}

/// Writes the picture as a PNG, if pictures are wanted.
fn keep(
    args: &QualityArgs,
    source: ScanSource,
    stand: &PlaceFrames,
    name: &str,
    picture: &EyePicture,
) -> Result<()> {
    let Some(folder) = &args.pictures else { return Ok(()) };
    let path = folder.join(format!("{}-{}-{name}.png", source.name(), stand.place.name));
    save(&path, picture.size_px, &picture.rgb)
}

fn save(path: &Path, size_px: [u32; 2], rgb: &[[u8; 3]]) -> Result<()> {
    write_png(path, size_px, rgb).with_context(|| format!("{}: cannot be written", path.display()))
}
