//! A drawn eye, on the CPU.

use base::space::{Eye, Pose, View};

/// What an eye sees. Pixels row by row, the top left first.
#[derive(Clone, Debug, PartialEq)]
pub struct EyePicture {
    /// Width, height.
    pub size_px: [u32; 2],
    /// Colors, sRGB as stored.
    pub rgb: Vec<[u8; 3]>,
    /// Linear depth in world units; infinite where there is no point.
    pub depth: Vec<f32>,
}

impl EyePicture {
    /// A picture whose depths nobody asks for, from colors as images hold them.
    pub fn of_colors(size_px: [u32; 2], colors: impl IntoIterator<Item = u32>) -> Self {
        let rgb = |color: u32| {
            let [red, green, blue, _] = color.to_le_bytes();
            [red, green, blue]
        };
        Self { size_px, rgb: colors.into_iter().map(rgb).collect(), depth: Vec::new() }
    }
}

/// The one eye of a view; every view here has one.
pub fn only_eye(view: &View) -> &Eye {
    &view.eyes[0]
}

/// The view from another pose.
pub fn seen_from(view: &View, world_from_view: Pose) -> View {
    View { eyes: vec![Eye { world_from_view, ..*only_eye(view) }], near: view.near }
}
