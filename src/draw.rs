//! What frames are drawn with, those of a walk and those of pictures.

use points::Scene;
use render::Look;
use render::options::Tier;

/// The near clip of a picture as a share of the scene's longest edge, at most, unless the user has chosen it.
pub const NEAR_SHARE: f64 = 0.02;

/// What frames are drawn with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawOptions {
    /// What they are to look like.
    pub look: Look,
    /// What the stages ask of the GPU's atomics.
    pub tier: Tier,
    /// Points nearer than this are not drawn: metres in a headset, world units in a picture.
    pub near: f64,
    /// Nobody has chosen [`Self::near`]: in a picture it becomes less where it would cut a small scene.
    pub near_yields: bool,
}

impl DrawOptions {
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
            let options = DrawOptions { look: Look::default(), tier: Tier::Auto, near: 0.05, near_yields };
            let samples = vec![DVec3::ZERO, DVec3::X * edge];
            options.near_in(&Scene { bounds: Bounds::around(&samples), samples })
        };
        assert_eq!(near_in(true, 1.0), 0.02);
        assert_eq!(near_in(false, 1.0), 0.05);
        assert_eq!([near_in(true, 2.5), near_in(true, 100.0)], [0.05; 2]);
        assert_eq!(near_in(true, 0.0), 0.05, "a point has no size that could be cut");
    }
}
