//! The laboratory's place in the program: what its settings change of how frames are drawn, and of how a scan is kept on
//! the GPU.

use crate::order::Order;
use crate::technique::{EarlyZLoad, LabTechnique, Method, tree};
use base::task::Task;
use cloud::BuildError;
use cloud::spt::build_spt;
use points::{Scan, Scene};
use render::gpu::Gpu;
use render::{CloudBuffers, UploadError};
use std::borrow::Borrow;

base::choice! {
    /// What level of detail goes by.
    pub enum LodMethod {
        /// Nodes of an octree, drawn by their projected size.
        Octree = "octree",
        /// Discs of a sequential point tree, which stand for points and are drawn by their projected error, and a mesh's
        /// triangles.
        Spt = "spt",
    }
}

/// What the laboratory's settings say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabOptions {
    /// How points get into pixels.
    pub method: Method,
    /// How early-z looks at a pixel.
    pub early_z_load: EarlyZLoad,
    /// True if batches that neither eye sees are left out.
    pub cull: bool,
    /// What level of detail goes by; `None` if every point is always drawn.
    pub lod: Option<LodMethod>,
    /// Order of points without level of detail.
    pub order: Order,
    /// Pixels by which discs of a point tree may be wrong.
    pub error_px: f32,
    /// True if discs of a point tree that show the eye their backs are left out.
    pub cull_backfaces: bool,
}

impl LabOptions {
    /// Technique by which frames are drawn.
    #[must_use]
    pub fn technique(&self) -> LabTechnique {
        LabTechnique {
            method: self.method,
            early_z_load: self.early_z_load,
            keep_unseen: !self.cull,
            error_px: (self.lod == Some(LodMethod::Spt)).then_some(self.error_px),
        }
    }

    /// The form in which a scan is kept in place of an octree; `None` if it is that.
    #[must_use]
    pub fn cloud(&self) -> Option<LabCloud> {
        match (self.lod, self.order) {
            (Some(LodMethod::Spt), _) => Some(LabCloud::Tree { cull_backfaces: self.cull_backfaces }),
            (Some(LodMethod::Octree), _) => None,
            (None, order) => Some(LabCloud::Flat(order)),
        }
    }
}

/// A form in which a scan is kept on the GPU in place of an octree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabCloud {
    /// All points, which are always drawn, in an order of the papers.
    Flat(Order),
    /// A sequential point tree.
    Tree {
        /// True if discs that show the eye their backs are left out.
        cull_backfaces: bool,
    },
}

impl LabCloud {
    /// Makes it of a scan and sends it to the GPU, in chunks of `chunk_limit` bytes at most. A scan that is handed over is
    /// given up before anything is sent.
    ///
    /// # Errors
    /// See [`BuildError`] and [`UploadError`].
    pub fn send<E: From<BuildError> + From<UploadError>>(
        self,
        gpu: &Gpu,
        scan: impl Borrow<Scan>,
        chunk_limit: u64,
        task: &Task,
    ) -> Result<(CloudBuffers, Scene), E> {
        let num_points = scan.borrow().num_points() as u64;
        match self {
            Self::Flat(order) => {
                let sorting = task.begin("sorting", "points", num_points);
                let cloud = order.build(scan.borrow(), &sorting)?;
                drop((scan, sorting));
                // The bytes are those of three planes and colors.
                let sending = task.begin("sending to the GPU", "bytes", 16 * num_points);
                Ok((CloudBuffers::upload(gpu, &cloud, chunk_limit, &sending)?, cloud.scene))
            }
            Self::Tree { cull_backfaces } => {
                // Points are counted twice, discs once.
                let building =
                    task.begin("building the point tree", "points in several passes", 7 * num_points / 2);
                let spt = build_spt(scan.borrow(), cull_backfaces, &building)?;
                drop((scan, building));
                // The bytes are those of three planes, colors and shapes.
                let num_bytes = 5 * size_of_val(&spt.cloud.planes[0][..]) as u64;
                let sending = task.begin("sending to the GPU", "bytes", num_bytes);
                Ok((tree::upload(gpu, &spt, chunk_limit, &sending)?, spt.cloud.scene))
            }
        }
    }
}
