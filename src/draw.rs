//! What frames are drawn with, those of a walk and those of pictures.

use lab::technique::{LabTechnique, NoSuchMethod};
use points::Scene;
use render::gpu::{Atomics, Gpu};
use render::options::Tier;
use render::{DrawOptions, NoSuchTier, tier};

/// Largest default near clip of a picture, as a share of the scene's longest edge.
pub const NEAR_SHARE: f64 = 0.02;

/// What frames are drawn with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawPlan {
    /// What frames are to look like.
    pub options: DrawOptions,
    /// Technique by which frames are drawn.
    pub technique: LabTechnique,
    /// What the stages ask of the GPU's atomics.
    pub tier: Tier,
    /// Points nearer than this are not drawn: meters in a headset, world units in a picture.
    pub near: f64,
    /// True if nobody chose [`Self::near`], which then becomes less in a picture where it would cut a small scene.
    pub near_yields: bool,
}

/// Why frames cannot be drawn with these options.
#[derive(Debug, thiserror::Error)]
pub enum CannotDraw {
    /// The GPU lacks the tier.
    #[error(transparent)]
    Tier(#[from] NoSuchTier),
    /// The method does not fit the GPU or what is drawn.
    #[error(transparent)]
    Method(#[from] NoSuchMethod),
}

impl DrawPlan {
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
    use base::space::Bounds;
    use glam::DVec3;

    #[test]
    fn only_a_near_clip_that_nobody_chose_yields_and_only_to_small_scenes() {
        let near_in = |near_yields, edge: f64| {
            let (options, technique) = (DrawOptions::default(), LabTechnique::default());
            let options = DrawPlan { options, technique, tier: Tier::Auto, near: 0.05, near_yields };
            let samples = vec![DVec3::ZERO, DVec3::X * edge];
            options.near_in(&Scene { bounds: Bounds::around(&samples), samples })
        };
        assert_eq!(near_in(true, 1.0), 0.02);
        assert_eq!(near_in(false, 1.0), 0.05);
        assert_eq!([near_in(true, 2.5), near_in(true, 100.0)], [0.05; 2]);
        assert_eq!(near_in(true, 0.0), 0.05, "a point has no size that could be cut");
    }
}
