//! How a scan is kept on the GPU, and how it is sent there: its octree node by node as it is built.

use base::task::{Progress, Task};
use cloud::octree::build_nodes;
use cloud::{self, BuildError};
use lab::LabCloud;
use points::{Scan, Scene};
use render::gpu::Gpu;
use render::{CloudBuffers, CloudUpload, UploadError};
use std::borrow::Borrow;

/// How a scan is kept on the GPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CloudOptions {
    /// What the laboratory keeps in place of an octree.
    pub lab: Option<LabCloud>,
    /// Bytes of the point pool that one binding holds at most; 0 for as much as the GPU allows.
    pub chunk_limit: u64,
}

impl CloudOptions {
    /// True for an octree.
    #[must_use]
    pub fn is_octree(&self) -> bool {
        self.lab.is_none()
    }
}

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
    gpu.unless_lost(|| send_unguarded(gpu, scan, options, task, came))
        .map_err(|lost| E::from(UploadError::Lost(lost.into())))?
}

/// What [`send`] does, on a GPU that is not lost.
fn send_unguarded<E: From<BuildError> + From<UploadError>>(
    gpu: &Gpu,
    scan: impl Borrow<Scan>,
    options: &CloudOptions,
    task: &Task,
    came: impl FnOnce(CloudBuffers, &Scene),
) -> Result<(), E> {
    let CloudOptions { lab, chunk_limit } = *options;
    let Some(lab) = lab else { return send_octree(gpu, scan.borrow(), chunk_limit, task, came) };
    let (buffers, scene) = lab.send::<E>(gpu, scan, chunk_limit, task)?;
    came(buffers, &scene);
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
    let building =
        task.begin("building the octree", "points in several passes", 3 * scan.num_points() as u64);
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
