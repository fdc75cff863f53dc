//! Sequential point trees: a tree of averaged discs, flattened into one list that a GPU tests entry by entry, with
//! no traversal [SPT].
//!
//! ```text
//!  Scan ──neighbors──▶ leaves: normal, diameter ──tree──▶ PointTree: discs with errors, children before parents
//!                                                  │ bottom-up: mean, bounding sphere, error
//!                                                  ▼
//!                                  Sequence: intervals of tolerance, sorted by their upper ends
//! ```
//!
//! The tree is an octree down to single points in which a node with one child is that child [SPT §3.1]. A node
//! stands for the points below it as one disc: mean position, color and normal, and a diameter that covers the
//! children's spheres. Its error says how far that is from the truth ([`error`], [SPT §3.2–3.4, 3.9]).
//!
//! **Tolerance.** The paper keeps distances, `rmin = error / ε`, and takes ε, the pixels that an error may have in
//! the image, to be constant. Eyes differ in pixels per radian and the governor changes ε, so what is kept here is
//! the error itself, a length; it is compared with the *tolerance*, the length that ε pixels have at the point's
//! distance: `tolerance = ε · distance / pixels per radian`. A disc is drawn while `min ≤ tolerance < max`, where
//! `min` is its own error and `max` its parent's, and the overlap of [SPT §3.6]. See [`Sequence`].
//!
//! **Order.** Sorted by `max`, entries lose their neighbors: any stretch of them is spread all over the cloud, and none
//! can be culled [SPT §3.7]. The list is therefore sorted by the octave of `max` alone, and in Morton order inside of
//! each: a batch of it has a small box and an interval of its own, and is culled by both. In a scan of four million
//! points seen from within, half as many are read as in the paper's order. Discs without a lower end, which are drawn
//! at any nearness, have batches of their own ([`parts`]). Lengths are kept in steps of an eighth of an octave
//! ([`StepScale`]), so that a disc's interval and size are three bytes.
//!
//! **Fovea.** Between the inner and the middle ring's ends ε grows by as much as the octree's thresholds do, smoothly,
//! whatever the settings say of rings: a step in it would be a hole, for which no overlap is wide enough.
//!
//! **Sides.** A point's normal is its file's; else the mean of its triangles', by their areas; else estimated from
//! neighbors ([`normals`]), and then which side of a surface was seen is unknown: the normal is an axis. Axes are
//! turned into one hemisphere before they are averaged, and nothing is culled for facing away. Where sides are known
//! and wanted, batches are of one of the clusters of [SPT §3.10] where they have enough discs of it, see [`clusters`]
//! and [`parts`]; the paper cuts the whole list by them, which from afar reads a batch for each. Files with and without
//! may mix: a disc has a side if all of its points have. Sides are used only on request, since files' normals are often
//! wrong; without the request all normals are axes.
//!
//! **Triangles** of meshes are drawn where they are larger than the tolerance, and the discs there are not [SPT §3.8]:
//! see [`mesh`]. They are batches beside those of the discs, culled in the same way, and the stages that draw points
//! draw them into the same pixels. A triangle is tested as a whole, at its corner nearest to the eye, where the paper
//! tests each corner and lets the hardware cut the triangle: too many are drawn rather than too few. Both faces of a
//! triangle are always drawn.
//!
//! **Fuzzy blending.** The depth test with a tolerance and running average that [SPT §5] asks of future hardware is
//! what `hqs` does in two dispatches: the nearest depth first, then the mean of all within a tolerance of it. Where the
//! nearest comes first the two are the same except for rounding; the proposal depends on the order, and in the list's a
//! tenth of a courtyard's pixels differ, on the mean of all by 0.9 of 255 (`tests/gpu/fuzzy.rs`).
//!
//! Left out: the test with view-dependent error, which the paper found to gain nothing [SPT §3.7].

mod batches;
pub mod clusters;
mod cubes;
pub mod error;
pub mod mesh;
#[cfg(test)]
mod mesh_tests;
mod meshlets;
mod neighbors;
pub mod normals;
mod parts;
mod sequence;
mod steps;
#[cfg(test)]
mod tests;
mod tree;

pub use batches::{BatchRun, SequentialCloud};
pub use mesh::Triangle;
pub use sequence::{DiscShape, ListPart, Sequence};
pub use steps::StepScale;
pub use tree::{PointTree, PointTreeNode};

use super::BuildError;
use super::build::{Checked, CodedPoint, check, sort};
use super::index::Index;
use base::task::{Cancelled, Progress};
use points::Scan;

/// Largest angle that the tolerance may span where the eye looks, in radians: ε / pixels per radian.
pub const MAX_TOLERANCE_RAD: f64 = 1.0 / 128.0;

/// The most that the tolerance may grow by from one place to another, as a share of their distance: it grows with the
/// distance from the eye, and with the angle from the gaze. The overlap of neighboring intervals is made for it, so
/// that a surface seen at different distances and angles has no holes [SPT §3.6].
pub const MAX_TOLERANCE_SLOPE: f64 = 1.0 / 64.0;

/// Largest number of points: they make at most twice as many discs, and a disc has two ids of 32 bits.
const MAX_POINTS: usize = 1_000_000_000;

/// Points by Morton code.
struct SortedPoints<'a> {
    index: Index<'a>,
    /// (code, number in the index), ascending.
    keys: Vec<CodedPoint>,
}

/// Builds the sequential point tree of a scan, ready for the GPU; see [`build_point_tree`]. With `cull_backfaces`,
/// discs whose sides are known are not read where they show the eye their backs.
///
/// `progress` counts each point twice and each disc once: in all about three and a half times the number of points.
///
/// Peak memory above the scan: 110 B a point, where inner nodes are half as many as points, and 56 B a triangle.
///
/// # Errors
/// See [`BuildError`].
pub fn build_spt(
    scan: &Scan,
    cull_backfaces: bool,
    progress: &Progress,
) -> Result<SequentialCloud, BuildError> {
    let tree = build_point_tree(scan, cull_backfaces, progress)?;
    let sequence = Sequence::new(&tree, MAX_TOLERANCE_SLOPE);
    SequentialCloud::new(&tree, &sequence, progress)
}

/// Builds the point tree of a scan, on all cores. If `with_sides`, normals from files or triangles have a side and are
/// no axes.
///
/// `progress` counts each point twice: once its normal is known, once it is in the tree.
///
/// Peak memory above the scan: 28 B a point for keys and leaves, and 60 B for the tree, where inner nodes are half as
/// many as points; 56 B while leaves are made. With triangles, 32 B a point meanwhile, and 16 B a triangle.
///
/// # Errors
/// See [`BuildError`].
pub fn build_point_tree(scan: &Scan, with_sides: bool, progress: &Progress) -> Result<PointTree, BuildError> {
    let Checked { num_points, bounds, scene } = check(scan)?;
    if num_points > MAX_POINTS {
        return Err(BuildError::TooManyDiscs(num_points));
    }
    let index = Index::new(scan);
    let keys = sort(&index, &bounds, &scene.bounds);
    let sorted = SortedPoints { index, keys };
    let mut leaves = neighbors::leaves(&sorted, progress);
    mesh::inform(&mut leaves, &sorted, scan, with_sides);
    if progress.is_cancelled() {
        return Err(Cancelled.into());
    }
    let mut tree = tree::build(&sorted, &leaves, bounds, scene, progress);
    if progress.is_cancelled() {
        return Err(Cancelled.into());
    }
    tree.triangles = mesh::triangles(scan, &sorted, &tree);
    Ok(tree)
}
