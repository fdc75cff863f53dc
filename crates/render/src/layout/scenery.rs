//! What the stage `scenery` is told of an eye.

use bytemuck::{Pod, Zeroable};

/// An eye's scenery. Lengths are meters of the stage; directions and places have the axes of the grid, which stands
/// upright in the stage. Colors are linear light.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SceneryUniform {
    /// Clip coordinates of places in the stage, column by column; z is the near plane's distance.
    pub clip_from_stage: [[f32; 4]; 4],
    /// Direction through the image's top left corner, of the length that reaches depth 1.
    pub ray: [f32; 3],
    /// 1: the finished pixels hold points; 0: there is no scan.
    pub has_points: u32,
    /// How the direction changes from a pixel to the next one to the right.
    pub ray_right: [f32; 3],
    /// World units a meter: depths of points are in world units.
    pub units_per_m: f32,
    /// How the direction changes from a pixel to the next one below.
    pub ray_down: [f32; 3],
    /// How much of the edge of sight is dark, 0 to 1.
    pub vignette: f32,
    /// Direction in which the eye looks, of length 1.
    pub ahead: [f32; 3],
    /// Pixels from a row of finished pixels to the next.
    pub pitch_px: u32,
    /// Place of the eye over the grid: y is its height.
    pub eye_in_grid: [f32; 3],
    /// 1: pixels without a point show the surround.
    pub has_surround: u32,
    /// Color straight up.
    pub sky: [f32; 3],
    /// 1: the surround has a grid on its floor.
    pub has_grid: u32,
    /// Color of the horizon.
    pub horizon: [f32; 3],
    /// Always 0.
    pub reserved: u32,
    /// Color straight down.
    pub ground: [f32; 3],
    /// Always 0.
    pub reserved_ground: u32,
    /// Color of the grid's lines.
    pub line: [f32; 3],
    /// Always 0.
    pub reserved_end: u32,
}
