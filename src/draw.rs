//! What frames are drawn with, those of a walk and those of pictures.

use lab::technique::{LabTechnique, NoSuchMethod};
use points::Scene;
use render::gpu::{Atomics, Gpu, GpuError};
use render::{DrawOptions, NoSuchTier, tier};

/// Near clip that nobody chose: meters in a headset, world units in a picture.
pub const NEAR: f64 = 0.05;
/// Largest such near clip of a picture, as a share of the scene's longest edge.
pub const NEAR_SHARE: f64 = 0.02;

/// What frames are drawn with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawPlan {
    /// What frames are to look like.
    pub options: DrawOptions,
    /// Technique by which frames are drawn.
    pub technique: LabTechnique,
    /// What the stages ask of the GPU's atomics; `None` for the best that there is.
    pub tier: Option<Atomics>,
    /// Points nearer than this are not drawn: meters in a headset, world units in a picture.
    pub near: f64,
    /// True if nobody chose [`Self::near`], which then becomes less in a picture where it would cut a small scene.
    pub near_yields: bool,
}

/// Why frames cannot be drawn with these options.
#[derive(Debug, thiserror::Error)]
pub enum CannotDraw {
    /// The GPU lacks the tier.
    #[error("gpu.tier: {0}, and \"auto\" takes that")]
    Tier(#[from] NoSuchTier),
    /// The method does not fit the GPU or what is drawn.
    #[error("frame.method: {0}{advice}", advice = another_form(.0))]
    Method(#[from] NoSuchMethod),
}

/// Which setting lets the method draw after all.
fn another_form(error: &NoSuchMethod) -> &'static str {
    if matches!(error, NoSuchMethod::Sizes { .. }) { "; set lod.method = \"octree\"" } else { "" }
}

/// Why no GPU could be opened, and which option chooses another.
pub fn no_gpu(error: &GpuError) -> String {
    let advice =
        if matches!(error, GpuError::Lacking { .. }) { "; choose another with --adapter" } else { "" };
    format!("{error}{advice}")
}

impl DrawPlan {
    /// Checks whether any GPU could draw this way.
    ///
    /// # Errors
    /// Settings that contradict each other.
    pub fn check(&self) -> Result<(), CannotDraw> {
        Ok(self.technique.check_itself()?)
    }

    /// The tier of atomics to draw with.
    ///
    /// # Errors
    /// The GPU lacks the tier that is asked for, or something that the technique needs.
    pub fn atomics(&self, gpu: &Gpu) -> Result<Atomics, CannotDraw> {
        let atomics = tier(gpu, self.tier)?;
        self.technique.check(gpu, atomics)?;
        Ok(atomics)
    }

    /// The near clip of a picture of `scene`, world units.
    #[must_use]
    pub fn near_in(&self, scene: &Scene) -> f64 {
        let yields = self.near_yields && !scene.is_a_point();
        if yields { self.near.min(NEAR_SHARE * scene.bounds.edge()) } else { self.near }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use kit::frames::sample_options;

    #[test]
    fn refusals_name_the_settings() {
        let refusal = CannotDraw::from(NoSuchMethod::Sizes { method: "point-list" }).to_string();
        assert!(refusal.starts_with("frame.method: point-list draws"), "{refusal}");
        assert!(refusal.ends_with("triangles; set lod.method = \"octree\""), "{refusal}");
        let lacking = GpuError::Lacking { name: "Old".into(), missing: "64-bit integers".into() };
        assert!(no_gpu(&lacking).ends_with("lacks 64-bit integers; choose another with --adapter"));
        assert!(!no_gpu(&GpuError::NoDriver).contains("--adapter"));
    }

    #[test]
    fn only_a_near_clip_that_nobody_chose_yields_and_only_to_small_scenes() {
        let near_in = |near_yields, edge: f64| {
            let (options, technique) = (sample_options(), LabTechnique::OWN);
            let options = DrawPlan { options, technique, tier: None, near: NEAR, near_yields };
            let samples = vec![DVec3::ZERO, DVec3::X * edge];
            options.near_in(&Scene::around(samples))
        };
        assert_eq!(near_in(true, 1.0), 0.02);
        assert_eq!(near_in(false, 1.0), NEAR);
        assert_eq!([near_in(true, 2.5), near_in(true, 100.0)], [NEAR; 2]);
        assert_eq!(near_in(true, 0.0), NEAR, "a point has no size that could be cut");
    }
}
