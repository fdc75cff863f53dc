//! What the stage `scenery` is told of an eye.

use bytemuck::{Pod, Zeroable};

/// Length of a cell of the grid, meters.
pub const GRID_CELL_M: f32 = 1.0;
/// Length of ten cells: their lines are wider.
pub const GRID_WIDE_CELL_M: f32 = 10.0;
/// Half the width of a line of the grid, meters.
pub const GRID_LINE_M: f32 = 0.008;
/// Half the width of every tenth line, meters.
pub const GRID_WIDE_LINE_M: f32 = 0.02;
/// How strongly a line is seen against every tenth.
pub const GRID_LINE_ALPHA: f32 = 0.6;
/// Distance at which the grid is faint, meters.
pub const GRID_REACH_M: f32 = 14.0;
/// Least width that a pixel counts as having on the grid, meters.
pub const GRID_LEAST_WIDTH_M: f32 = 1e-4;
/// Least number of cells that a pixel counts as holding.
pub const GRID_LEAST_CELLS: f32 = 1e-6;
/// How fast the horizon's color gives way to the sky's and the ground's.
pub const HORIZON_FALLOFF: f32 = 4.0;
/// How strongly a card that lies behind points covers them: it is to be read all the same.
pub const CARD_BEHIND_ALPHA: f32 = 0.85;
/// A card's color in a pixel is the mean of four places, this part of a pixel from its middle along one axis …
pub const CARD_STEP: f32 = 0.25;
/// … and this part of that along the other.
pub const CARD_TURN: f32 = 0.5;
/// Cosine of the angle from the direction of view at which the vignette begins when it is strongest.
pub const VIGNETTE_NARROW_COS: f32 = 0.9;
/// Cosine of the angle at which it begins when it is weakest.
pub const VIGNETTE_WIDE_COS: f32 = 0.55;
/// Width of its edge, in cosines.
pub const VIGNETTE_EDGE_COS: f32 = 0.12;
/// How fast it becomes black as it sets in.
pub const VIGNETTE_RISE: f32 = 4.0;

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
