//! Sequential point trees on the GPU: their runs and batches, and the tolerance that their discs are drawn by.

use base::space::View;
use base::task::Progress;
use bytemuck::{Pod, Zeroable};
use cloud::spt::{self, SequentialCloud};
use render::gpu::Gpu;
use render::layout::{self, Detail, VISIBLE_OTHERS, WORKGROUP_SIZE};
use render::{CloudBuffers, UploadError, Whole};
use wgpu::util::DeviceExt;

/// Name by which shaders bind the uniform.
pub const TREE_NAME: &str = "tree";
/// Name by which shaders bind the runs.
pub const RUNS_NAME: &str = "runs";
/// Name by which shaders bind the column of discs and of words of triangles.
pub const SHAPES_NAME: &str = "shapes";
/// [`Run::flags`]: the run's discs have a back, which is not drawn.
pub const RUN_ONE_SIDED: u32 = 1;
/// [`Run::flags`]: the run's points are corners of triangles.
pub const RUN_TRIANGLES: u32 = 2;
/// [`layout::VisibleBatch::flags`]: points are discs, each with its own size and the tolerances that it is drawn at.
pub const VISIBLE_DISCS: u32 = VISIBLE_OTHERS;
/// [`layout::VisibleBatch::flags`]: points are corners of triangles.
pub const VISIBLE_TRIANGLES: u32 = VISIBLE_OTHERS << 1;
/// Pixels by which a triangle reaches over its edges, so that rounding opens no gap between triangles that meet.
pub const TRIANGLE_SLACK_PX: f32 = 1.0 / 64.0;
/// Pixels for which a batch of triangles gets one more workgroup: [`WORKGROUP_SIZE`] for each thread.
pub const SLICE_PIXELS: u32 = WORKGROUP_SIZE * WORKGROUP_SIZE;

/// A run of batches on the GPU: what the cull of a point tree reads of it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Run {
    /// With [`RUN_ONE_SIDED`]: the axis of the cone of directions in which only backs are seen, and the sine of its
    /// angle.
    pub behind: [f32; 4],
    /// [`RUN_ONE_SIDED`] and [`RUN_TRIANGLES`], where they hold.
    pub flags: u32,
    /// Always 0.
    pub reserved: u32,
    /// Always 0.
    pub reserved_end: [u32; 2],
}

impl Run {
    /// The GPU's form of a run.
    #[must_use]
    pub fn new(run: &spt::BatchRun) -> Self {
        let sided = |behind: &spt::clusters::Cone| {
            let [x, y, z] = behind.axis.to_array();
            [x, y, z, libm::sin(behind.angle)].map(|v| v as f32)
        };
        let side = if run.behind.is_some() { RUN_ONE_SIDED } else { 0 };
        let triangles = if run.has_triangles { RUN_TRIANGLES } else { 0 };
        Self {
            behind: run.behind.as_ref().map_or([0.0; 4], sided),
            flags: side | triangles,
            reserved: 0,
            reserved_end: [0; 2],
        }
    }
}

/// A batch of discs or triangles on the GPU: fields of [`layout::GpuBatch`], its run, and the tolerances that it is drawn
/// at.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct DiscBatch {
    /// Box minimum, coarse part, as [`layout::GpuBatch::min_hi`].
    pub min_hi: [f32; 3],
    /// First point in the chunk's planes.
    pub first_point: u32,
    /// Box minimum, fine part.
    pub min_lo: [f32; 3],
    /// Points in the batch.
    pub num_points: u32,
    /// Edge of a 30-bit cell along each axis.
    pub cell: [f32; 3],
    /// Number of the batch's run.
    pub run: u32,
    /// Coarse steps of the head per world unit.
    pub steps_per_unit: [f32; 3],
    /// Steps of tolerance at which some of the batch is drawn: the first, and from bit [`cloud::format::UNTIL_SHIFT`]
    /// on the first beyond.
    pub interval: u32,
}

impl DiscBatch {
    /// The GPU's form of batch `number`, whose points begin at `first_point` of its chunk.
    #[must_use]
    pub fn new(tree: &SequentialCloud, number: usize, first_point: u32) -> Self {
        let run = tree.runs.partition_point(|run| run.batches.end as usize <= number) as u32;
        let [from, until] = tree.intervals[number].map(u32::from);
        let layout::GpuBatch { min_hi, first_point, min_lo, num_points, cell, node, steps_per_unit, .. } =
            layout::GpuBatch::new(&tree.cloud.split, &tree.cloud.batches[number], run, first_point);
        let interval = from | until << cloud::format::UNTIL_SHIFT;
        Self { min_hi, first_point, min_lo, num_points, cell, run: node, steps_per_unit, interval }
    }
}

/// The tolerance of a frame's eyes, left and right, and the tree's lengths.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct TreeUniform {
    /// Angle that an error may have in the inner ring, radians: the tolerance at a distance of 1.
    pub tolerance_rad: [f32; 2],
    /// Radians by which the tolerance grows while the cosine of the angle from the gaze falls by 1, between the ends of
    /// the inner and the middle ring.
    pub tolerance_growth: [f32; 2],
    /// Base of the tree's lengths; see [`spt::Scale::base`].
    pub step_base: u32,
    /// Always 0.
    pub reserved: u32,
    /// Always 0.
    pub reserved_end: [u32; 2],
}

impl TreeUniform {
    /// Makes the uniform for a view of one or two eyes, in which discs may be wrong by `error_px` pixels.
    ///
    /// # Panics
    /// If the view has no eye.
    #[must_use]
    pub fn new(view: &View, detail: &Detail, error_px: f32, step_base: u32) -> Self {
        let error_rad = [0, 1].map(|index: usize| {
            let eye = &view.eyes[index.min(view.eyes.len() - 1)];
            (f64::from(error_px) / eye.pixels_per_radian()).min(spt::MAX_TOLERANCE_RAD)
        });
        Self {
            tolerance_rad: error_rad.map(|rad| rad as f32),
            tolerance_growth: error_rad.map(|rad| tolerance_growth(detail, rad)),
            step_base,
            reserved: 0,
            reserved_end: [0; 2],
        }
    }

    /// The bytes of the fields that depend on the view.
    pub(super) fn tolerance_bytes(&self) -> [u8; 16] {
        bytemuck::cast([self.tolerance_rad, self.tolerance_growth])
    }
}

/// [`TreeUniform::tolerance_growth`] for a tolerance of `error_rad` in the inner ring. In the outer ring the tolerance
/// is larger by the ratio of the two rings' thresholds, or by less where that would be too steep for the intervals'
/// overlap ([`spt::MAX_TOLERANCE_SLOPE`]).
fn tolerance_growth(detail: &Detail, error_rad: f64) -> f32 {
    let [inner, middle] = detail.ring_rad.map(f64::cos);
    let ratio = f64::from(detail.threshold_px[2] / detail.threshold_px[0]);
    let wanted = error_rad * (ratio - 1.0).max(0.0) / (inner - middle).max(1e-6);
    // The tolerance grows fastest where the middle ring ends: by `error_rad` with the distance, and by this many times
    // the growth away from the gaze.
    let steepness = (inner * inner + 1.0 - 2.0 * inner * middle).max(0.0).sqrt().max(1e-3);
    let spare = spt::MAX_TOLERANCE_SLOPE - error_rad;
    // Beyond the middle ring the tolerance grows with the distance alone.
    wanted.min(spare / steepness).min(spare / (inner - middle).max(1e-6)) as f32
}

/// Sends a sequential point tree to the GPU, all at once; see [`CloudBuffers::upload`].
///
/// # Errors
/// See [`UploadError`].
pub fn upload(
    gpu: &Gpu,
    tree: &SequentialCloud,
    chunk_limit: u64,
    progress: &Progress,
) -> Result<CloudBuffers, UploadError> {
    let uniform = TreeUniform { step_base: tree.scale.base, ..TreeUniform::zeroed() };
    let runs: Vec<Run> = tree.runs.iter().map(Run::new).collect();
    let buffer = |label, contents: &[u8], usage| {
        let contents = wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage };
        (label, gpu.device.create_buffer_init(&contents))
    };
    let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
    let uniform = buffer(TREE_NAME, bytemuck::bytes_of(&uniform), usage);
    let runs_buffer = buffer(RUNS_NAME, bytemuck::cast_slice(&runs), wgpu::BufferUsages::STORAGE);
    let whole = Whole {
        cloud: &tree.cloud,
        num_points: tree.num_points,
        num_nodes: runs.len(),
        batch: &|number, first_point| DiscBatch::new(tree, number, first_point),
        column: (SHAPES_NAME, &tree.shapes),
        besides: vec![uniform, runs_buffer],
    };
    CloudBuffers::upload_whole(gpu, whole, chunk_limit, progress)
}
