//! The table of holes: scene × headset × preset × smooth × step of the governor.

use super::holes::{Drawer, RINGS_DEG, holes, left_eye, settings, sphere, unreduced};
use super::scene::{SOURCES, Source};
use anyhow::{Context, Result};
use glam::DVec3;
use scanwalk::cloud::octree::build_octree;
use scanwalk::gpu::Gpu;
use scanwalk::progress::Progress;
use scanwalk::render::CloudBuffers;
use scanwalk::scan::Scan;
use scanwalk::synth::{Kind, Viewpoint};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const HEADSETS: [&str; 3] = ["valve-index", "meta-quest-3", "bigscreen-beyond-2"];
const PRESETS: [&str; 3] = ["quality", "balanced", "performance"];
const LOD_SCALES: [f32; 3] = [1.0, 2.0, 3.0];
/// In the middle of the sphere.
const INSIDE: Viewpoint = Viewpoint { name: "inside", eye: DVec3::ZERO, target: DVec3::new(3.0, 4.0, 0.5) };

/// What is measured; each list empty for all.
#[derive(Debug, clap::Args)]
pub struct Holes {
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
    /// More settings, KEY=VALUE
    #[arg(long = "set", value_name = "KEY=VALUE", requires = "holes")]
    sets: Vec<String>,
}

impl Holes {
    /// True if it is asked for.
    pub fn is_wanted(&self) -> bool {
        self.holes
    }

    /// Prints the table of the scenes whose name contains `scan`, each row as a line of CSV, to `out` and to `csv`; keeps
    /// pictures if there is a folder for them.
    pub fn run(
        &self,
        gpu: &Arc<Gpu>,
        (scan, points): (&str, u64),
        csv: &mut dyn Write,
        pictures: Option<&PathBuf>,
    ) -> Result<()> {
        let rings =
            ["0-20", "20-38", "38-50", "50-55", "55-"].map(|ring| format!(",empty_{ring},judged_{ring}"));
        let header = format!("scene,headset,preset,smooth,lod_scale,points_read{}", rings.concat());
        println!("{header}");
        writeln!(csv, "{header}")?;
        if "sphere".contains(scan) {
            self.scene(gpu, ("sphere", false), &sphere(points), &[INSIDE], csv, pictures)?;
        }
        let sources = [Source::Synth(Kind::Terrestrial), Source::Room];
        debug_assert!(sources.iter().all(|source| SOURCES.contains(source)));
        for source in sources.into_iter().filter(|source| source.name().contains(scan) && source.is_here()) {
            let scan = source.dense_scan(points)?;
            self.scene(gpu, (source.name(), true), &scan, &source.places(), csv, pictures)?;
        }
        Ok(())
    }

    /// `is_open`: what is empty without level of detail counts for no hole.
    fn scene(
        &self,
        gpu: &Arc<Gpu>,
        (name, is_open): (&str, bool),
        scan: &Scan,
        places: &[Viewpoint],
        csv: &mut dyn Write,
        pictures: Option<&PathBuf>,
    ) -> Result<()> {
        let octree = build_octree(scan, &Progress::hidden(), &mut |_, _| ())?;
        let mut cloud = Some(CloudBuffers::upload_layered(gpu, &octree, 0, &Progress::hidden())?);
        for place in places {
            for headset in HEADSETS.into_iter().filter(|headset| headset.contains(&self.headset)) {
                for preset in PRESETS.into_iter().filter(|preset| preset.contains(&self.preset)) {
                    let config = settings(&[preset, headset], &self.sets)?;
                    let view = left_eye(&config, place.eye, place.target, self.share);
                    let size_px = view.eyes[0].size_px;
                    let buffers = cloud.take().context("no cloud to draw")?;
                    let mut drawer = Drawer::new(gpu, buffers, &config, size_px)?;
                    let whole =
                        if is_open { Some(drawer.draw(&unreduced(&config), &view, 1.0)?) } else { None };
                    for &smooth in &self.smooth {
                        let mut config = config.clone();
                        config.fovea.smooth = smooth;
                        for &lod_scale in &self.lod_scale {
                            let drawn = drawer.draw(&config, &view, lod_scale)?;
                            let rings = holes(&view, &drawn, whole.as_ref());
                            let row =
                                format!("{name} {},{headset},{preset},{smooth},{lod_scale}", place.name);
                            let counts =
                                rings.map(|ring| format!(",{},{}", ring.empty, ring.judged)).concat();
                            let percents = rings.map(|ring| format!(" {:>8.4}", ring.percent())).concat();
                            println!("{row:<60} {:>9} read {percents} %", drawn.points_read);
                            writeln!(csv, "{row},{}{counts}", drawn.points_read)?;
                            csv.flush()?;
                            if let Some(folder) = pictures {
                                let file = format!("{}.png", row.replace([',', ' '], "-"));
                                save(&folder.join(file), drawn.size_px, &drawn.rgb)?;
                            }
                        }
                    }
                    cloud = drawer.finish();
                }
            }
        }
        Ok(())
    }
}

fn save(path: &Path, [width, height]: [u32; 2], rgb: &[[u8; 3]]) -> Result<()> {
    let mut encoder = png::Encoder::new(super::create(path)?, width, height);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb.as_flattened())?;
    Ok(writer.finish()?)
}

const _: () = assert!(RINGS_DEG.len() == 5);
