//! The table of holes: scene × headset × preset × smooth × step of the governor.

use anyhow::{Context, Result};
use base::space::View;
use base::task::Progress;
use cloud::octree::build_octree;
use kit::quality::holes::{self, Drawer, EyeFrame, INSIDE, OUTLINE_PX, RINGS_DEG, sphere, unreduced};
use kit::quality::scene::ScanSource;
use lab::synth::{SynthKind, Viewpoint};
use points::Scan;
use render::gpu::Gpu;
use render::{CloudBuffers, DrawOptions};
use scanwalk::config;
use scanwalk::resolve::Plan;
use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;

const HEADSETS: [&str; 3] = ["valve-index", "meta-quest-3", "bigscreen-beyond-2"];
const PRESETS: [&str; 3] = ["quality", "balanced", "performance"];
const LOD_SCALES: [f32; 3] = [1.0, 2.0, 3.0];

/// What is measured; each list empty for all.
#[derive(Debug, clap::Args)]
pub struct HolesArgs {
    /// Measure holes by angle, and nothing else
    #[arg(long)]
    holes: bool,
    /// Only headsets whose preset's name contains this
    #[arg(long, value_name = "NAME", default_value = "", requires = "holes")]
    headset: String,
    /// Only presets whose name contains this
    #[arg(long, value_name = "NAME", default_value = "", requires = "holes")]
    preset: String,
    /// Steps of the governor: factors on the thresholds
    #[arg(long, value_name = "FACTOR", value_delimiter = ',', default_values_t = LOD_SCALES, requires = "holes")]
    lod_scale: Vec<f32>,
    /// Whether thresholds grow smoothly: false, true or both
    #[arg(long, value_name = "BOOL", value_delimiter = ',', default_values_t = [false, true], requires = "holes")]
    smooth: Vec<bool>,
    /// Share of the width and height that an eye's image would have
    #[arg(long, value_name = "SHARE", default_value_t = 1.0, requires = "holes")]
    share: f64,
    /// Pixels from what is empty without level of detail within which a filled one belongs to an outline
    #[arg(long, value_name = "PX", default_value_t = OUTLINE_PX, requires = "holes")]
    outline_px: usize,
    /// More settings, KEY=VALUE
    #[arg(long = "set", value_name = "KEY=VALUE", requires = "holes")]
    sets: Vec<String>,
}

impl HolesArgs {
    /// True if the table is asked for.
    pub fn is_wanted(&self) -> bool {
        self.holes
    }

    /// Prints the table of the scenes whose name contains `scan`, and writes each row as a line of CSV to `csv`. Keeps
    /// pictures if there is a folder for them; black pixels in them are no holes.
    pub fn run(
        &self,
        gpu: &Arc<Gpu>,
        (scan, points): (&str, u64),
        csv: &mut dyn Write,
        pictures: Option<&PathBuf>,
    ) -> Result<()> {
        let sources =
            ScanSource::named(&[ScanSource::Synth(SynthKind::Terrestrial), ScanSource::Room], scan)?;
        let mut kept = RowsKept { csv, pictures };
        kept.header()?;
        if "sphere".contains(scan) {
            self.scene(gpu, ("sphere", false), &sphere(points), &[INSIDE], &mut kept)?;
        }
        for source in sources {
            let scan = source.dense_scan(points)?;
            self.scene(gpu, (source.name(), true), &scan, &source.places(), &mut kept)?;
        }
        Ok(())
    }

    /// Measures a scene; if it `is_open`, pixels that are empty without level of detail are no holes.
    fn scene(
        &self,
        gpu: &Arc<Gpu>,
        (name, is_open): (&str, bool),
        scan: &Scan,
        places: &[Viewpoint],
        kept: &mut RowsKept,
    ) -> Result<()> {
        let octree = build_octree(scan, &Progress::hidden())?;
        let num_points = octree.cloud.num_points;
        let mut cloud = Some(CloudBuffers::upload_layered(gpu, &octree, 0, &Progress::hidden())?);
        for place in places {
            for headset in HEADSETS.into_iter().filter(|headset| headset.contains(&self.headset)) {
                for preset in PRESETS.into_iter().filter(|preset| preset.contains(&self.preset)) {
                    let presets = [preset, headset].map(str::to_owned);
                    let plan = Plan::of(&config::load(&presets, None, &self.sets)?);
                    let share = self.share * plan.headset.resolution_scale;
                    let size_px = (plan.simulated.size_px, share);
                    let view = holes::left_eye(place, plan.simulated.left_fov, size_px, plan.draw.near);
                    let buffers = cloud.take().context("no cloud to draw")?;
                    let mut drawer = Drawer::new(
                        gpu,
                        buffers,
                        plan.draw.atomics(gpu)?,
                        plan.draw.options,
                        view.eyes[0].size_px,
                    )?;
                    let names = format!("{name} {},{headset},{preset}", place.name);
                    self.frames(&mut drawer, (&names, num_points, is_open), plan.draw.options, &view, kept)?;
                    cloud = drawer.finish();
                }
            }
        }
        Ok(())
    }

    /// Measures frames from one place, with one headset and preset.
    fn frames(
        &self,
        drawer: &mut Drawer,
        (names, num_points, is_open): (&str, u64, bool),
        mut options: DrawOptions,
        view: &View,
        kept: &mut RowsKept,
    ) -> Result<()> {
        let whole = if is_open { Some(drawer.draw(unreduced(options), view, 1.0)?) } else { None };
        for &smooth in &self.smooth {
            options.detail.smooth = smooth;
            for &lod_scale in &self.lod_scale {
                let drawn = drawer.draw(options, view, lod_scale)?;
                let holes = holes::holes(view, &drawn, whole.as_ref(), self.outline_px);
                let names = format!("{names},{smooth},{lod_scale}");
                kept.row(&names, num_points, &drawn, &holes)?;
                kept.picture(&names, &drawn.marked(whole.as_ref(), self.outline_px), drawn.size_px)?;
            }
        }
        Ok(())
    }
}

/// Destinations of rows and pictures.
struct RowsKept<'a> {
    csv: &'a mut dyn Write,
    pictures: Option<&'a PathBuf>,
}

impl RowsKept<'_> {
    fn header(&mut self) -> Result<()> {
        let ring = |ring: &str| format!(",empty_{ring},judged_{ring}");
        let rings = ["0-20", "20-38", "38-50", "50-55", "55-"].map(ring).concat();
        let names = "scene,headset,preset,smooth,lod_scale";
        let header =
            format!("{names},num_points,width_px,height_px,points_read{rings},empty_outline,judged_outline");
        println!("{header}");
        Ok(writeln!(self.csv, "{header}")?)
    }

    /// Writes a row, which begins with `names`.
    fn row(
        &mut self,
        names: &str,
        num_points: u64,
        drawn: &EyeFrame,
        holes: &holes::RingHoles,
    ) -> Result<()> {
        let ([width, height], num_read) = (drawn.size_px, drawn.points_read);
        let all = || holes.rings.iter().chain([&holes.outline]);
        let counts: String = all().map(|part| format!(",{},{}", part.empty, part.judged)).collect();
        let percents: String = all().map(|part| format!(" {:>8.4}", part.percent())).collect();
        println!("{names:<60} {num_read:>9} read {percents} %");
        writeln!(self.csv, "{names},{num_points},{width},{height},{num_read}{counts}")?;
        Ok(self.csv.flush()?)
    }

    fn picture(&self, names: &str, rgb: &[[u8; 3]], size_px: [u32; 2]) -> Result<()> {
        let Some(folder) = self.pictures else { return Ok(()) };
        crate::save(&folder.join(format!("{}.png", names.replace([',', ' '], "-"))), size_px, rgb)
    }
}

const _: () = assert!(RINGS_DEG.len() == 5);
