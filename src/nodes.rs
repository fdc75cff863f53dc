//! How a scan is kept on the GPU, and how it is sent there: its octree node by node as it is built.

use base::task::{Progress, Task};
use cloud::octree::build_nodes;
use cloud::spt::build_spt;
use cloud::{self, BuildError, Order};
use lab::technique::tree;
use points::{Scan, Scene};
use render::gpu::Gpu;
use render::{CloudBuffers, CloudUpload, UploadError};
use serde::{Deserialize, Serialize};
use std::borrow::Borrow;

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
const PASSES: &str = "points in several passes";
/// Work on points that are ready, as people read it.
const SENDING: &str = "sending to the GPU";

/// Makes of a scan what `options` say and sends it to the GPU. `came` is called once, as soon as something can be drawn:
/// of an octree the root, all later nodes of which are drawn from the same buffers; else all of it. A scan that is handed
/// over is given up before anything without an octree is sent.
///
/// # Errors
/// See [`BuildError`] and [`UploadError`].
pub fn send<E: From<BuildError> + From<UploadError>>(
    gpu: &Gpu,
    scan: impl Borrow<Scan>,
    options: &CloudOptions,
    task: &Task,
    came: impl FnOnce(CloudBuffers, &Scene),
) -> Result<(), E> {
    let CloudOptions { lod, order, cull_backfaces, chunk_limit } = *options;
    let num_points = scan.borrow().num_points() as u64;
    match lod {
        Some(LodMethod::Octree) => return send_octree(gpu, scan.borrow(), chunk_limit, task, came),
        Some(LodMethod::Spt) => {
            // Points are counted twice, discs once.
            let building = task.begin("building the point tree", PASSES, 7 * num_points / 2);
            let spt = build_spt(scan.borrow(), cull_backfaces, &building)?;
            drop((scan, building));
            // The bytes are those of three planes, colors and shapes.
            let num_bytes = 5 * size_of_val(&spt.cloud.planes[0][..]) as u64;
            let sending = task.begin(SENDING, "bytes", num_bytes);
            came(tree::upload(gpu, &spt, chunk_limit, &sending)?, &spt.cloud.scene);
        }
        None => {
            let sorting = task.begin("sorting", "points", num_points);
            let cloud = cloud::build(scan.borrow(), order, &sorting)?;
            drop((scan, sorting));
            // The bytes are those of three planes and colors.
            let sending = task.begin(SENDING, "bytes", 16 * num_points);
            came(CloudBuffers::upload(gpu, &cloud, chunk_limit, &sending)?, &cloud.scene);
        }
    }
    Ok(())
}

/// Builds the octree of a scan and sends its nodes to the GPU as they come.
fn send_octree<E: From<BuildError> + From<UploadError>>(
    gpu: &Gpu,
    scan: &Scan,
    chunk_limit: u64,
    task: &Task,
    root_came: impl FnOnce(CloudBuffers, &Scene),
) -> Result<(), E> {
    // Points are counted twice as the octree is built, and once as they are sent.
    let building = task.begin("building the octree", PASSES, 3 * scan.num_points() as u64);
    let sending = Progress::silent(task.cancel_token());
    let (mut upload, mut root_came): (Option<CloudUpload>, _) = (None, Some(root_came));
    build_nodes(scan, &building, &mut |hierarchy, blocks| {
        let upload = match &mut upload {
            Some(upload) => upload,
            None => upload.insert(CloudUpload::layered(gpu, hierarchy, chunk_limit, &sending)?),
        };
        upload.write_blocks(hierarchy, &blocks)?;
        building.add(blocks.iter().map(|block| block.colors.len() as u64).sum());
        if let Some(root_came) = root_came.take() {
            root_came(upload.buffers(), &hierarchy.scene);
        }
        Ok::<(), E>(())
    })?;
    Ok(())
}
