//! Choices that a frame is drawn by, each a type. Their names are those of the settings, the frame log and screenshots.

use serde::{Deserialize, Serialize};

/// What a pixel shows of the points in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Quality {
    /// The nearest point's color.
    #[default]
    Closest,
    /// High-quality shading: the blend of the nearest points.
    Hqs,
}

impl Quality {
    /// Name in the configuration and the frame log.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Closest => "closest",
            Self::Hqs => "hqs",
        }
    }
}

/// How gaps between points are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Dilate {
    /// Not at all.
    #[default]
    Off,
    /// By kernels that grow with the angle from the gaze.
    Rings,
}

/// Coordinate bits read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// 10, 20 or 30 bits by the batch's projected size.
    #[default]
    Auto,
    /// All 30 bits.
    Full,
}

/// What the stages ask of the GPU's atomics (docs/FRAME.md §7). Each tier draws the same picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Tier {
    /// The best that the GPU has.
    #[default]
    Auto,
    /// 64-bit minimum and addition.
    Int64,
    /// 64-bit minimum; sums by 32-bit additions.
    Int64Minmax,
    /// 32-bit minimum and addition.
    Int32,
}

/// What the window draws over the mirror, to see how a frame comes about. The headset never shows it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Overlay {
    /// Nothing.
    #[default]
    None,
    /// The rings round the gaze.
    Rings,
    /// The cubes of the nodes that are drawn, by level.
    Nodes,
    /// How many points a pixel blends.
    Overdraw,
    /// How far away a pixel's surface is.
    Depth,
    /// The boxes of visible batches, by the bits that are read of their points.
    Precision,
}

impl Overlay {
    /// All overlays, in the order that the user steps through them.
    pub const ALL: [Self; 6] =
        [Self::None, Self::Rings, Self::Nodes, Self::Overdraw, Self::Depth, Self::Precision];

    /// Name in the configuration and in the names of screenshots.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Rings => "rings",
            Self::Nodes => "nodes",
            Self::Overdraw => "overdraw",
            Self::Depth => "depth",
            Self::Precision => "precision",
        }
    }

    /// The next overlay; the first comes after the last.
    #[must_use]
    pub fn next(self) -> Self {
        let at = Self::ALL.iter().position(|&overlay| overlay == self).unwrap_or(0);
        Self::ALL[(at + 1) % Self::ALL.len()]
    }
}
