//! Resolves the settings once, to what each room is told. No room below sees [`Config`].

use crate::config::{Config, NearClip, Setting, ValueKind};
use crate::desktop::{Widget, Widgets, WindowOptions};
use crate::draw::DrawPlan;
use crate::nodes::{CloudOptions, LodMethod};
use crate::walk::WalkOptions;
use crate::walk::governor::GovernorOptions;
use crate::walk::headsets::{HeadsetOptions, Wish};
use crate::walk::kind::ScanKind;
use crate::walk::locomotion::LocomotionOptions;
use crate::walk::simulated::SimulatedOptions;
use crate::walk::state::SpeedFactor;
use base::space::Fov;
use lab::technique::{DISCS_REACH_PX, LabTechnique};
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
        let Config {
            gpu, cloud, frame, lod, governor, headset, surround, simulated, locomotion, window, ..
        } = config;
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
            },
            cloud: CloudOptions {
                lod: lod.enabled.then_some(lod.method),
                order: cloud.order,
                cull_backfaces: lod.cull_backfaces,
                chunk_limit: u64::from(gpu.chunk_mib) << 20,
            },
            draw: DrawPlan {
                options: options(config),
                technique: technique(config),
                tier: gpu.tier,
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
            kind: locomotion.seen_as.kind(),
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
                    vignette: locomotion.vignette as f32,
                },
                governor: GovernorOptions { enabled: governor.enabled, budget: governor.budget as f32 },
                overlay: window.overlay,
                speed: SpeedFactor {
                    at_start: locomotion.speed_factor as f32,
                    range: range("locomotion.speed_factor").map(|limit| limit as f32),
                },
                surround: surround.show.then_some(Surround {
                    sky: surround.sky,
                    horizon: surround.horizon,
                    ground: surround.ground,
                    grid: surround.grid.then_some(surround.line),
                }),
            },
            window: WindowOptions {
                size: window.size,
                panel: window.panel,
                mirror: window.mirror,
                widgets: widgets(),
            },
            digest: config.digest(),
        }
    }

    /// What is asked of headsets.
    #[must_use]
    pub fn headsets(&self, wish: Wish) -> HeadsetOptions {
        HeadsetOptions { wish, real: self.headset, simulated: self.simulated, adapter: self.adapter.clone() }
    }
}

/// What a frame is to look like. A method that is of one quality decides it, so `frame.quality` is read only here.
fn options(config: &Config) -> DrawOptions {
    let Config { gpu, frame, fovea, lod, .. } = config;
    // Discs have sizes of their own and are drawn at these.
    let discs = lod.enabled && lod.method == LodMethod::Spt;
    let reach_px = match frame.dilate {
        Dilate::Off => NO_REACH_PX,
        Dilate::Rings if discs => DISCS_REACH_PX,
        Dilate::Rings => RINGS_REACH_PX,
    };
    let detail = Detail {
        forced_planes: if frame.precision == Precision::Full { ALL_PLANES } else { 0 },
        threshold_px: lod.threshold_px.map(|px| px as f32),
        ring_rad: fovea.ring_deg.map(f64::to_radians),
        smooth: fovea.smooth,
        fade: lod.fade,
        fill_reach_px: ((frame.fill || discs) && !frame.method.draws_pixels()).then_some(reach_px),
    };
    let quality = frame.method.quality().unwrap_or(frame.quality);
    let access = Access { checked: gpu.bounds_checks || Access::default().checked, ..Access::default() };
    DrawOptions { quality, dilate: frame.dilate, background: frame.background, detail, access }
}

/// Technique by which frames are drawn.
fn technique(config: &Config) -> LabTechnique {
    let Config { gpu, frame, lod, .. } = config;
    let discs = lod.enabled && lod.method == LodMethod::Spt;
    LabTechnique {
        method: frame.method,
        early_z_load: gpu.early_z_load,
        keep_unseen: !frame.cull,
        error_px: discs.then_some(lod.error_px as f32),
    }
}

/// A widget for every setting, as the panel would show it.
fn widgets() -> Widgets {
    let widget = |setting: &Setting| Widget {
        title: Widget::title_of(setting.name),
        help: format!("{}: {}", setting.key, setting.help()),
        names: if let ValueKind::Choice(names) = setting.kind() { names } else { &[] },
        range: setting.range,
        unit: setting.unit,
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
    use lab::technique::Method;
    use render::options::{Overlay, Quality};

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
        assert_eq!(Plan::default().walk.locomotion, LocomotionOptions::default());
        let fast = plan(|config| config.locomotion.speed = 3.0);
        assert_eq!(fast.walk.locomotion.speed_m_per_s, Some(3.0));
    }

    #[test]
    fn level_of_detail_is_one_answer() {
        let lod = |enabled, method| {
            let plan = plan(|config| (config.lod.enabled, config.lod.method) = (enabled, method));
            (plan.cloud.lod, plan.draw.technique.error_px.is_some())
        };
        assert_eq!(lod(false, LodMethod::Spt), (None, false));
        assert_eq!(lod(true, LodMethod::Octree), (Some(LodMethod::Octree), false));
        assert_eq!(lod(true, LodMethod::Spt), (Some(LodMethod::Spt), true));
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

    /// Logs, tables and the names of screenshots write what a user writes.
    #[test]
    fn rooms_name_their_choices_as_settings_do() {
        let kinds = [ValueKind::of::<Overlay>(), ValueKind::of::<Quality>(), ValueKind::of::<Method>()];
        let overlays = Overlay::ALL.map(|overlay| (toml::Value::try_from(overlay), overlay.name()));
        let qualities =
            [Quality::Closest, Quality::Hqs].map(|quality| (toml::Value::try_from(quality), quality.name()));
        let methods = Method::ALL.map(|method| (toml::Value::try_from(method), method.name()));
        for (kind, choices) in kinds.into_iter().zip([&overlays[..], &qualities, &methods]) {
            let ValueKind::Choice(names) = kind else { panic!("{kind:?}") };
            assert!(choices.iter().all(|(value, name)| value.as_ref().unwrap().as_str() == Some(name)));
            assert!(choices.iter().map(|(_, name)| name).eq(names));
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
        assert_eq!(speed, SpeedFactor { at_start: 2.0, ..SpeedFactor::default() });
        let widgets = Plan::default().window.widgets;
        assert_eq!(widgets["locomotion.speed_factor"].range, Some(speed.range.map(f64::from)));
    }
}
