//! Arguments of `scanwalk render`.

use super::parse;
use crate::config::{Config, SimulatedConfig};
use clap::Args;
use glam::DVec3;
use lab::LodMethod;
use lab::order::Order;
use lab::technique::Method;
use render::options::{Dilate, Precision, Quality};
use std::path::PathBuf;

/// The preset of pictures unless another is asked for.
const PLAIN: &str = "plain";

/// Draw a picture without a window.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct RenderArgs {
    /// Files that are one scan.
    #[arg(required = true, value_name = "SCAN", help = parse::scans_help())]
    pub scans: Vec<PathBuf>,
    /// Refuse all files if one cannot be read to its end, instead of showing the rest [default: cloud.strict]
    #[arg(long)]
    pub strict: bool,
    /// The picture; with --stereo OUT.left.png and OUT.right.png; - for stdout
    #[arg(short, long, value_name = "OUT.png")]
    pub out: PathBuf,
    /// Where the eye is, in the file's own coordinates, those that `info` prints: degrees if it has degrees; of several
    /// files, the first one's [default: so that all is seen]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::point, allow_hyphen_values = true)]
    pub eye: Option<DVec3>,
    /// What it looks at, in the same coordinates [default: the middle of the scan]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::point, allow_hyphen_values = true)]
    pub target: Option<DVec3>,
    /// Which way is up, along the file's axes [default: what is up in the scan]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::point, allow_hyphen_values = true)]
    pub up: Option<DVec3>,
    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEG", default_value = "60", value_parser = parse::field_of_view)]
    pub fov_y: f64,
    /// Half angles in degrees as a headset's left eye has them, in place of --fov-y; the right eye mirrors them
    #[arg(long, value_name = "OUT,IN,UP,DOWN", value_parser = parse::half_angles, conflicts_with = "fov_y")]
    pub half_angles: Option<[f64; 4]>,
    /// Pixels of the picture
    #[arg(long, value_name = "WxH", default_value = "1920x1080", value_parser = parse::size)]
    pub size: [u32; 2],
    /// Two pictures, one for each eye
    #[arg(long)]
    pub stereo: bool,
    /// Distance of the eyes for --stereo, in meters
    #[arg(long, value_name = "M", default_value_t = SimulatedConfig::default().eye_distance_m, value_parser = parse::eye_distance)]
    pub ipd: f64,
    /// Settings that belong together.
    #[arg(long, value_name = "NAME", default_value = PLAIN, help = parse::presets_help())]
    pub preset: Vec<String>,
    /// What a pixel shows of the points in it.
    #[arg(long, value_name = "HOW", value_parser = parse::choice::<Quality>(), help = parse::setting_help("frame.quality"))]
    pub quality: Option<Quality>,
    /// Level of detail [default: lod.enabled and lod.method]
    #[arg(long, value_name = "HOW", value_parser = parse::lod())]
    pub lod: Option<Lod>,
    /// How gaps between points are filled.
    #[arg(long, value_name = "HOW", value_parser = parse::choice::<Dilate>(), help = parse::setting_help("frame.dilate"))]
    pub dilate: Option<Dilate>,
    /// Coordinate bits that are read.
    #[arg(long, value_name = "HOW", value_parser = parse::choice::<Precision>(), help = parse::setting_help("frame.precision"))]
    pub precision: Option<Precision>,
    /// Also write each pixel's distance, as a NumPy array; - for stdout
    #[arg(long, value_name = "OUT.npy")]
    pub depth: Option<PathBuf>,
    /// Color where no point is.
    #[arg(long, value_name = "R,G,B", value_parser = parse::color, help = parse::setting_help("frame.background"))]
    pub background: Option<[u8; 3]>,
    /// Also write counts and times, as JSON; - for stdout
    #[arg(long, value_name = "OUT.json")]
    pub metrics: Option<PathBuf>,
    /// How points get into pixels.
    #[arg(long, value_name = "NAME", value_parser = parse::choice::<Method>(), help = parse::setting_help("frame.method"), help_heading = LABORATORY, hide_short_help = true)]
    pub method: Option<Method>,
    /// Order of the points in memory.
    #[arg(long, value_name = "NAME", value_parser = parse::choice::<Order>(), help = parse::setting_help("cloud.order"), help_heading = LABORATORY, hide_short_help = true)]
    pub order: Option<Order>,
}

/// Heading over the options that compare the papers' methods.
const LABORATORY: &str = "For the laboratory";

const EXAMPLES: &str = "Examples:
  scanwalk render castle.laz -o castle.png
  scanwalk render castle.laz -o gate.png --eye 12,-4,1.7 --target 0,0,2 --fov-y 75
  scanwalk render castle.laz -o castle.png --preset balanced
  scanwalk render castle.laz -o castle.png --stereo --ipd 0.065 --depth castle.npy";

/// What level of detail goes by; `None` if every point is drawn.
pub type Lod = Option<LodMethod>;

impl RenderArgs {
    /// Writes the command's own options over the settings: afterwards the configuration is the one place to look for
    /// them.
    pub fn apply_to(&self, config: &mut Config) {
        let Config { cloud, frame, lod, .. } = config;
        frame.method = self.method.unwrap_or(frame.method);
        cloud.order = self.order.unwrap_or(cloud.order);
        frame.quality = self.quality.unwrap_or(frame.quality);
        frame.dilate = self.dilate.unwrap_or(frame.dilate);
        frame.precision = self.precision.unwrap_or(frame.precision);
        frame.background = self.background.unwrap_or(frame.background);
        if let Some(wanted) = self.lod {
            lod.enabled = wanted.is_some();
            lod.method = wanted.unwrap_or(lod.method);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Cli, commands};
    use super::*;
    use clap::Parser;

    fn settings(options: &[&str]) -> Config {
        let words = ["scanwalk", "render", "a.laz", "-o", "a.png"].iter().chain(options);
        commands::config(&Cli::try_parse_from(words).unwrap()).unwrap()
    }

    /// Quality, level of detail, dilation, fill, fade.
    fn stages(config: &Config) -> (Quality, bool, Dilate, bool, bool) {
        let Config { frame, lod, .. } = config;
        (frame.quality, lod.enabled, frame.dilate, frame.fill, lod.fade)
    }

    #[test]
    fn pictures_are_plain_unless_a_preset_is_given() {
        let plain = (Quality::Closest, false, Dilate::Off, false, false);
        assert_eq!(stages(&settings(&[])), plain);
        assert_eq!(stages(&settings(&["--preset", "plain"])), plain);
        let headset = (Quality::Hqs, true, Dilate::Rings, true, true);
        assert_eq!(stages(&Config::default()), headset);
        for preset in ["quality", "balanced", "valve-index"] {
            assert_eq!(stages(&settings(&["--preset", preset])), headset, "{preset}");
        }
    }

    #[test]
    fn options_win_over_settings_and_settings_over_presets() {
        let asked = ["--quality", "hqs", "--lod", "on", "--dilate", "rings"];
        assert_eq!(stages(&settings(&asked)), (Quality::Hqs, true, Dilate::Rings, false, false));
        let refused = ["--preset", "quality", "--quality", "closest", "--lod", "off", "--dilate", "off"];
        assert_eq!(stages(&settings(&refused)), (Quality::Closest, false, Dilate::Off, true, true));
        let set = settings(&["--set", "frame.quality=hqs", "--set", "lod.enabled=true"]);
        assert_eq!(stages(&set), (Quality::Hqs, true, Dilate::Off, false, false));
        let method = |lod: &str| settings(&["--set", "lod.method=spt", "--lod", lod]).lod.method;
        assert_eq!(["on", "octree"].map(method), [LodMethod::Octree; 2]);
        assert_eq!(method("spt"), LodMethod::Spt);
        let over = settings(&["--set", "frame.quality=hqs", "--quality", "closest"]);
        assert_eq!(over.frame.quality, Quality::Closest);
    }
}
