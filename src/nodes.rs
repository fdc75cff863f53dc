//! How a scan is kept on the GPU, and how its octree is sent there, node by node as it is built.

use base::task::{Progress, Task};
use cloud::octree::{Hierarchy, build_nodes};
use cloud::{BuildError, Order};
use points::Scan;
use render::gpu::Gpu;
use render::{CloudBuffers, CloudUpload, UploadError};
use serde::{Deserialize, Serialize};

/// How a scan is kept on the GPU.
#[derive(Clone, Debug, PartialEq)]
pub struct CloudOptions {
    /// What level of detail goes by; `None` if every point is always drawn.
    pub lod: Option<LodMethod>,
    /// The order of points that have no level of detail.
    pub order: Order,
    /// True if discs of a point tree that show the eye their backs are left out.
    pub cull_backfaces: bool,
    /// Bytes of the point pool that one binding holds at most; 0 for as much as the GPU allows.
    pub chunk_limit: u64,
}

/// What level of detail goes by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LodMethod {
    /// A layered octree: nodes by their projected size.
    #[default]
    Octree,
    /// A sequential point tree: discs by their projected error.
    Spt,
}

/// Unit of a count that has each point several times.
pub const PASSES: &str = "points in several passes";

/// Builds the octree of a scan and sends its nodes to the GPU as they come. `root_came` is called once, when the root
/// is there; all later nodes are drawn from the same buffers.
///
/// # Errors
/// See [`BuildError`] and [`UploadError`].
pub fn send<E: From<BuildError> + From<UploadError>>(
    gpu: &Gpu,
    scan: &Scan,
    chunk_limit: u64,
    task: &Task,
    mut root_came: impl FnMut(CloudBuffers, &Hierarchy),
) -> Result<(), E> {
    // Points are counted twice as the octree is built, and once as they are sent.
    let building = task.begin("building the octree", PASSES, 3 * scan.num_points() as u64);
    let sending = Progress::silent(task.cancel_token());
    let mut upload: Option<CloudUpload> = None;
    build_nodes(scan, &building, &mut |hierarchy, blocks| {
        let is_first = upload.is_none();
        let upload = match &mut upload {
            Some(upload) => upload,
            None => upload.insert(CloudUpload::layered(gpu, hierarchy, chunk_limit, &sending)?),
        };
        upload.write_blocks(hierarchy, &blocks)?;
        building.add(blocks.iter().map(|block| block.colors.len() as u64).sum());
        if is_first {
            root_came(upload.buffers(), hierarchy);
        }
        Ok::<(), E>(())
    })?;
    Ok(())
}
