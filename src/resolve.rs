//! Settings to what each room is told: nobody below sees [`Config`].

use crate::config::{Config, LodMethod};
use lab::technique::{DISCS_REACH_PX, LabTechnique, NoSuchMethod};
use points::ReadOptions;
use render::gpu::{Atomics, Gpu};
use render::layout::Detail;
use render::options::{Dilate, Precision};
use render::{Access, Look, NO_REACH_PX, NoSuchTier, RINGS_REACH_PX, tier};
use xr::XrOptions;

/// How files are read.
#[must_use]
pub fn read(config: &Config) -> ReadOptions {
    let cloud = &config.cloud;
    ReadOptions {
        up: cloud.up,
        unit: cloud.unit,
        vertical_unit: cloud.vertical_unit,
        project: cloud.project,
        strict: cloud.strict,
        show_withheld: cloud.show_withheld,
    }
}

/// What a headset's runtime is asked for.
#[must_use]
pub fn headset(config: &Config) -> XrOptions {
    let headset = &config.headset;
    XrOptions {
        resolution_scale: headset.resolution_scale,
        depth_layer: headset.depth_layer,
        visibility_mask: headset.visibility_mask,
        near_m: config.frame.near_m,
    }
}

/// Bytes of the point pool that one binding holds at most; 0: as much as the GPU allows.
#[must_use]
pub fn chunk_limit(config: &Config) -> u64 {
    u64::from(config.gpu.chunk_mib) << 20
}

/// What a frame is to look like. A method that is of one quality decides it: nobody else reads `frame.quality`.
#[must_use]
pub fn look(config: &Config) -> Look {
    let frame = &config.frame;
    // Discs have their sizes, and are drawn so.
    let discs = config.lod.enabled && config.lod.method == LodMethod::Spt;
    let reach_px = match frame.dilate {
        Dilate::Off => NO_REACH_PX,
        Dilate::Rings if discs => DISCS_REACH_PX,
        Dilate::Rings => RINGS_REACH_PX,
    };
    let detail = Detail {
        forced_planes: if frame.precision == Precision::Full { 3 } else { 0 },
        threshold_px: config.lod.threshold_px.map(|px| px as f32),
        ring_rad: config.fovea.ring_deg.map(f64::to_radians),
        smooth: config.fovea.smooth,
        fade: config.lod.fade,
        fill_reach_px: ((frame.fill || discs) && !frame.method.draws_pixels()).then_some(reach_px),
    };
    let quality = frame.method.quality().unwrap_or(frame.quality);
    let access =
        Access { checked: config.gpu.bounds_checks || Access::default().checked, ..Access::default() };
    Look { quality, dilate: frame.dilate, background: frame.background, detail, access }
}

/// By which technique it is drawn.
#[must_use]
pub fn technique(config: &Config) -> LabTechnique {
    let discs = config.lod.enabled && config.lod.method == LodMethod::Spt;
    LabTechnique {
        method: config.frame.method,
        early_z_load: config.gpu.early_z_load,
        keep_unseen: !config.frame.cull,
        error_px: discs.then_some(config.lod.error_px as f32),
    }
}

/// Why a frame cannot be drawn as the settings ask for.
#[derive(Debug, thiserror::Error)]
pub enum CannotDraw {
    /// The GPU lacks the tier.
    #[error(transparent)]
    Tier(#[from] NoSuchTier),
    /// The GPU, or what is drawn, is not of the method.
    #[error(transparent)]
    Method(#[from] NoSuchMethod),
}

/// The tier of atomics to draw with.
///
/// # Errors
/// If the GPU does not have the one that is asked for, or not what the technique needs.
pub fn atomics(config: &Config, gpu: &Gpu) -> Result<Atomics, CannotDraw> {
    let atomics = tier(gpu, config.gpu.tier)?;
    technique(config).check(gpu, atomics)?;
    Ok(atomics)
}
