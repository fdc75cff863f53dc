//! Resolves the settings once, to what each room is told. No room below sees [`Config`].

use crate::config::{self, Config, NearClip, Setting};
use crate::desktop::{Widget, Widgets, WindowOptions};
use crate::draw::DrawPlan;
use crate::nodes::CloudOptions;
use crate::walk::WalkOptions;
use crate::walk::appearance::{PresetOptions, QualityPreset};
use crate::walk::governor::GovernorOptions;
use crate::walk::headsets::{HeadsetOptions, Wish};
use crate::walk::kind::ScanKind;
use crate::walk::locomotion::LocomotionOptions;
use crate::walk::moving::VignetteOptions;
use crate::walk::simulated::SimulatedOptions;
use crate::walk::state::{AppState, SpeedFactor};
use base::space::Fov;
use lab::LabOptions;
use points::ReadOptions;
use render::layout::{ALL_PLANES, Detail};
use render::options::{Dilate, Precision};
use render::scenery::Surround;
use render::{Access, DrawOptions, NO_REACH_PX, RINGS_REACH_PX};
use xr::XrOptions;

/// What the settings come to, a part for each room.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Part of the name of the GPU to open where no headset's runtime chooses it; empty for the fastest kind.
    pub adapter: String,
    /// How files are read.
    pub read: ReadOptions,
    /// How a scan is kept on the GPU.
    pub cloud: CloudOptions,
    /// What frames are drawn with.
    pub draw: DrawPlan,
    /// What a headset's runtime is asked for.
    pub headset: XrOptions,
    /// What the simulated headset is like.
    pub simulated: SimulatedOptions,
    /// What the user says that a scan is of.
    pub kind: Option<ScanKind>,
    /// What a walk goes by.
    pub walk: WalkOptions,
    /// How the window begins.
    pub window: WindowOptions,
    /// Digest of the settings for the frame log.
    pub digest: String,
}

impl Default for Plan {
    /// What the default settings come to.
    fn default() -> Self {
        Self::of(&Config::default())
    }
}

impl Plan {
    /// What `config` comes to.
    #[must_use]
    pub fn of(config: &Config) -> Self {
        let Config { gpu, cloud, frame, headset, surround, simulated, locomotion, window, .. } = config;
        let lab = lab_options(config);
        let [outward, inward, up, down] = simulated.fov_deg.map(f64::to_radians);
        Self {
            adapter: gpu.adapter.clone(),
            read: ReadOptions {
                up: cloud.up,
                unit: cloud.unit,
                vertical_unit: cloud.vertical_unit,
                project: cloud.project,
                strict: cloud.strict,
                show_withheld: cloud.show_withheld,
                columns: cloud.columns.clone(),
            },
            cloud: CloudOptions { lab: lab.cloud(), chunk_limit: u64::from(gpu.chunk_mib) << 20 },
            draw: DrawPlan {
                options: lab.technique().amended(options(config)),
                technique: lab.technique(),
                tier: gpu.tier.0,
                near: frame.near_m.meters(),
                near_yields: frame.near_m == NearClip::Auto,
            },
            headset: XrOptions {
                resolution_scale: headset.resolution_scale,
                refresh_hz: (headset.refresh_hz > 0.0).then_some(headset.refresh_hz),
                depth_layer: headset.depth_layer,
                visibility_mask: headset.visibility_mask,
                hands: headset.hands,
                near_m: frame.near_m.meters(),
            },
            simulated: SimulatedOptions {
                size_px: simulated.size_px,
                left_fov: Fov::from_angles(-outward, inward, up, -down),
                eye_distance_m: simulated.eye_distance_m,
                cant_rad: simulated.cant_deg.to_radians(),
                refresh_hz: simulated.refresh_hz,
                eye_height_m: simulated.eye_height_m,
            },
            kind: locomotion.seen_as.0,
            walk: WalkOptions {
                locomotion: LocomotionOptions {
                    speed_m_per_s: (locomotion.speed > 0.0).then_some(locomotion.speed),
                    fast: locomotion.fast,
                    stride: locomotion.stride,
                    moving_hand: locomotion.moving_hand,
                    turn: locomotion.turn,
                    snap_rad: locomotion.snap_deg.to_radians(),
                    turn_rad_per_s: locomotion.turn_deg_per_s.to_radians(),
                    look_rad_per_px: locomotion.look_deg_per_px.to_radians(),
                    reach_m: locomotion.reach_m,
                    vignette: VignetteOptions {
                        at_start: locomotion.vignette as f32,
                        range: range("locomotion.vignette").map(|limit| limit as f32),
                    },
                },
                governor: governor_options(config),
                overlay: window.overlay,
                labels: locomotion.labels,
                speed: SpeedFactor {
                    at_start: locomotion.speed_factor as f32,
                    range: range("locomotion.speed_factor").map(|limit| limit as f32),
                },
                surround: Surround {
                    sky: surround.sky,
                    horizon: surround.horizon,
                    ground: surround.ground,
                    grid: surround.grid.then_some(surround.line),
                },
                shows_surround: surround.show,
                presets: QualityPreset::ALL.map(|preset| {
                    let config = with_preset(config, preset);
                    let draw = lab.technique().amended(options(&config));
                    PresetOptions { draw, governor: governor_options(&config) }
                }),
            },
            window: WindowOptions {
                size: window.size,
                panel: window.panel,
                mirror: window.mirror,
                recent: window.recent,
                widgets: widgets(),
            },
            digest: config.digest(),
        }
    }

    /// A walk's state at start.
    #[must_use]
    pub fn state_at_start(&self) -> AppState {
        self.walk.state_at_start(self.draw.options)
    }

    /// What is asked of headsets.
    #[must_use]
    pub fn headsets(&self, wish: Wish) -> HeadsetOptions {
        HeadsetOptions { wish, real: self.headset, simulated: self.simulated, adapter: self.adapter.clone() }
    }
}

/// What a frame of the program's own is to look like.
fn options(config: &Config) -> DrawOptions {
    let Config { gpu, frame, fovea, lod, .. } = config;
    let reach_px = match frame.dilate {
        Dilate::Off => NO_REACH_PX,
        Dilate::Rings => RINGS_REACH_PX,
    };
    let detail = Detail {
        forced_planes: if frame.precision == Precision::Full { ALL_PLANES } else { 0 },
        threshold_px: lod.threshold_px.map(|px| px as f32),
        ring_rad: fovea.ring_deg.map(f64::to_radians),
        smooth: fovea.smooth,
        fade: lod.fade,
        fill_reach_px: frame.fill.then_some(reach_px),
    };
    let access = Access { checked: gpu.bounds_checks || Access::default().checked, ..Access::default() };
    DrawOptions { quality: frame.quality, dilate: frame.dilate, background: frame.background, detail, access }
}

/// How frames are kept within their time.
fn governor_options(config: &Config) -> GovernorOptions {
    let governor = &config.governor;
    GovernorOptions { enabled: governor.enabled, budget: governor.budget as f32 }
}

/// The same settings with those of a preset.
fn with_preset(config: &Config, preset: QualityPreset) -> Config {
    // The presets come with the program, and a test loads each.
    config::with_preset(config, preset.name()).expect("a preset")
}

/// What the laboratory's settings say.
fn lab_options(config: &Config) -> LabOptions {
    let Config { gpu, cloud, frame, lod, .. } = config;
    LabOptions {
        method: frame.method,
        early_z_load: gpu.early_z_load,
        cull: frame.cull,
        lod: lod.enabled.then_some(lod.method),
        order: cloud.order,
        error_px: lod.error_px as f32,
        cull_backfaces: lod.cull_backfaces,
    }
}

/// A widget for every setting, as the panel would show it.
fn widgets() -> Widgets {
    let widget = |setting: &Setting| {
        let kind = setting.kind();
        Widget {
            title: Widget::title_of(setting.name),
            help: format!("{}: {}", setting.key, setting.help()),
            names: kind.names(),
            range: setting.range.or(kind.range()),
            unit: setting.unit,
        }
    };
    Setting::all().map(|setting| (setting.key, widget(setting))).collect()
}

/// The limits of a setting that a walk changes.
fn range(key: &str) -> [f64; 2] {
    // A setting without limits is a mistake of this file, which every test of a plan shows.
    Setting::find(key).and_then(|setting| setting.range).expect("limits")
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::order::Order;
    use lab::technique::Method;
    use lab::{LabCloud, LodMethod};
    use render::options::Quality;

    fn plan(change: impl FnOnce(&mut Config)) -> Plan {
        let mut config = Config::default();
        change(&mut config);
        Plan::of(&config)
    }

    #[test]
    fn a_method_of_one_quality_decides_it() {
        for method in Method::ALL {
            for asked in [Quality::Closest, Quality::Hqs] {
                let options =
                    plan(|config| (config.frame.method, config.frame.quality) = (method, asked)).draw.options;
                assert_eq!(options.quality, method.quality().unwrap_or(asked), "{method:?}, {asked:?}");
            }
        }
    }

    #[test]
    fn angles_become_radians_and_nothing_becomes_none() {
        let Plan { walk, simulated, .. } = plan(|config| {
            config.locomotion.snap_deg = 180.0;
            config.simulated.fov_deg = [45.0, -10.0, 45.0, 45.0];
        });
        assert_eq!(walk.locomotion.snap_rad, std::f64::consts::PI);
        let Fov { left, right, up, down } = simulated.left_fov;
        assert!((left + 1.0).abs() + (up - 1.0).abs() + (down + 1.0).abs() < 1e-12 && right < 0.0);
        assert_eq!(walk.locomotion.speed_m_per_s, None);
        let fast = plan(|config| config.locomotion.speed = 3.0);
        assert_eq!(fast.walk.locomotion.speed_m_per_s, Some(3.0));
    }

    #[test]
    fn level_of_detail_is_one_answer() {
        let lod = |enabled, method| {
            let plan = plan(|config| (config.lod.enabled, config.lod.method) = (enabled, method));
            (plan.cloud.lab, plan.draw.technique.error_px.is_some())
        };
        assert_eq!(lod(false, LodMethod::Spt), (Some(LabCloud::Flat(Order::Morton)), false));
        assert_eq!(lod(true, LodMethod::Octree), (None, false));
        let tree = LabCloud::Tree { cull_backfaces: false };
        assert_eq!(lod(true, LodMethod::Spt), (Some(tree), true));
    }

    #[test]
    fn a_walk_changes_to_what_a_preset_begins_with() {
        let changed = Plan::default().walk.presets;
        for (preset, options) in QualityPreset::ALL.into_iter().zip(changed) {
            let begun = Plan::of(&config::load(&[preset.name().into()], None, &[]).unwrap());
            assert_eq!(
                (options.draw, options.governor),
                (begun.draw.options, begun.walk.governor),
                "{preset:?}"
            );
        }
        assert!(changed[0] != changed[1] && changed[1] != changed[2]);
    }

    #[test]
    fn only_a_near_clip_that_nobody_chose_yields() {
        let auto = Plan::default();
        assert!(auto.draw.near_yields);
        // The user's number may be that of nobody's choice.
        for near_m in [0.04, auto.draw.near] {
            let set = plan(|config| config.frame.near_m = NearClip::Meters(near_m));
            assert!(!set.draw.near_yields && set.draw.near == near_m && set.headset.near_m == near_m);
        }
    }

    /// Tests of the panel draw its rows with a sample of widgets, so its keys are those of settings.
    #[test]
    fn the_panel_offers_what_the_settings_take() {
        let widgets = Plan::default().window.widgets;
        let sample = WindowOptions::sample().widgets;
        assert!(sample.contains_key("locomotion.speed_factor"));
        for (key, made_up) in sample {
            let widget = widgets.get(key).unwrap_or_else(|| panic!("{key} is no setting"));
            assert_eq!(Widget { help: made_up.help.clone(), ..widget.clone() }, made_up, "{key}");
            assert!(
                widget.help.starts_with(&format!("{key}: ")) && widget.help.ends_with('.'),
                "{}",
                widget.help
            );
        }
        assert_eq!(widgets.len(), Setting::all().count());
    }

    #[test]
    fn the_walk_keeps_to_the_limits_of_the_settings() {
        let speed = plan(|config| config.locomotion.speed_factor = 2.0).walk.speed;
        assert_eq!(speed, SpeedFactor { at_start: 2.0, ..Plan::default().walk.speed });
        let widgets = Plan::default().window.widgets;
        assert_eq!(widgets["locomotion.speed_factor"].range, Some(speed.range.map(f64::from)));
        let vignette = plan(|config| config.locomotion.vignette = 0.25).walk.locomotion.vignette;
        assert_eq!((vignette.at_start, vignette.range), (0.25, [0.0, 1.0]));
        assert_eq!(widgets["locomotion.vignette"].range, Some(vignette.range.map(f64::from)));
    }
}
