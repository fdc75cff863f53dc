//! Choices that a frame is drawn by.

base::choice! {
    /// What a pixel shows of the points in it.
    pub enum Quality {
        /// The nearest point's color.
        Closest = "closest",
        /// The blend of the nearest points, which is high-quality shading.
        Hqs = "hqs",
    }
}

base::choice! {
    /// How gaps between points are filled.
    pub enum Dilate {
        /// Not at all.
        Off = "off",
        /// By kernels of 3 × 3, 5 × 5 and 7 × 7 pixels, from the gaze outwards.
        Rings = "rings",
    }
}

base::choice! {
    /// Coordinate bits read.
    pub enum Precision {
        /// 10, 20 or 30, by the batch's projected size.
        Auto = "auto",
        /// Always 30.
        Full = "full",
    }
}

base::choice! {
    /// What the window draws over the mirror, to see how a frame comes about. The headset never shows it.
    pub enum Overlay {
        /// Nothing.
        None = "none",
        /// The rings round the gaze.
        Rings = "rings",
        /// The cubes of the octree's nodes that are drawn, by level.
        Nodes = "nodes",
        /// How many points a pixel blends.
        Overdraw = "overdraw",
        /// How far away a pixel's surface is.
        Depth = "depth",
        /// The boxes of visible batches, by the bits that are read of their points.
        Precision = "precision",
    }
}

impl Overlay {
    /// The next overlay; the first comes after the last.
    #[must_use]
    pub fn next(self) -> Self {
        let at = Self::ALL.iter().position(|&overlay| overlay == self).unwrap_or(0);
        Self::ALL[(at + 1) % Self::ALL.len()]
    }
}
