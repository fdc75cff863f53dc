//! How overlays show what the frame knows. Colors are in sRGB.

/// Octaves of depth, from the near clip on, that the ramp tells apart: up to 2^14 times as far.
pub const DEPTH_OCTAVES: f32 = 14.0;
/// Points in a pixel, as a power of two, from which on the ramp stays white.
pub const OVERDRAW_OCTAVES: f32 = 6.0;
/// How strongly a ring's color covers the image, inside and at its edge.
pub const RING_ALPHA: [f32; 2] = [0.22, 0.9];
/// How strongly a box's edge covers the image, before and behind surfaces.
pub const EDGE_ALPHA: [f32; 2] = [0.9, 0.2];
/// Steps of the ramp from a color to the next.
pub const RAMP_STEPS: u32 = 5;
/// Colors from little to much, dark to light.
pub const OVERLAY_RAMP: [[f32; 3]; RAMP_STEPS as usize + 1] =
    [[0.05, 0.03, 0.2], [0.2, 0.25, 0.7], [0.6, 0.2, 0.6], [0.9, 0.4, 0.2], [1.0, 0.8, 0.2], [1.0, 1.0, 1.0]];
/// Colors of the palette.
pub const PALETTE_COLORS: u32 = 8;
/// Colors that color-blind people can tell apart too: rings and precisions have the first ones, levels of nodes take
/// turns.
pub const PALETTE: [[f32; 3]; PALETTE_COLORS as usize] = [
    [0.337, 0.706, 0.914],
    [0.0, 0.62, 0.451],
    [0.902, 0.624, 0.0],
    [0.8, 0.475, 0.655],
    [0.941, 0.894, 0.259],
    [0.0, 0.447, 0.698],
    [0.835, 0.369, 0.0],
    [0.9, 0.9, 0.9],
];
