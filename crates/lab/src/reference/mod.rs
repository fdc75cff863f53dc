//! The CPU reference of the GPU's stages, one file a stage, written to be compared with the shaders: the same f32
//! operations in the same order, so that integer buffers match bit for bit. It uses no GPU API.

pub mod clear;
pub mod color;
pub mod cull;
pub mod depth;
pub mod dilate;
pub mod fixed40;
pub mod lod;
pub mod points;
pub mod resolve;
pub mod rings;
pub mod scenery;
mod sizes;
pub mod tree;

use crate::technique::tree::TreeUniform;
use base::space::View;
use cloud::Cloud;
use cloud::octree::Octree;
use cloud::spt::SequentialCloud;
use render::DrawOptions;
use render::layout::{
    DRAWN_WHOLE, EMPTY_DEPTH, GpuBatch, GpuNode, ID_ODD, ID_SHIFT, Pixel, ViewUniform, VisibleBatch, guarded,
    without_guard,
};
use render::options::{Dilate, Quality};
use tree::Tree;

/// A cloud as the stages see it, in one chunk.
#[derive(Clone, Debug)]
pub struct ReferenceCloud<'a> {
    cloud: &'a Cloud,
    filtered_colors: &'a [u32],
    /// The cloud's nodes; none in a point tree.
    pub nodes: Vec<GpuNode>,
    /// The cloud's batches; none in a point tree.
    pub batches: Vec<GpuBatch>,
    /// A point tree, in place of nodes and batches, and the pixels that its discs may be wrong by.
    tree: Option<(Tree<'a>, f32)>,
}

impl<'a> ReferenceCloud<'a> {
    /// A flat cloud: one node, always drawn whole.
    #[must_use]
    pub fn flat(cloud: &'a Cloud) -> Self {
        let batch = |b: &cloud::Batch| GpuBatch::new(&cloud.split, b, 0, b.first_point);
        let batches = cloud.batches.iter().map(batch).collect();
        let nodes = vec![GpuNode::FLAT];
        Self { cloud, filtered_colors: &cloud.colors, nodes, batches, tree: None }
    }

    /// A layered cloud.
    #[must_use]
    pub fn layered(octree: &'a Octree) -> Self {
        let cloud = &octree.cloud;
        let nodes = (0..octree.nodes.len())
            .map(|number| GpuNode::new(&octree.cloud.split, &octree.nodes, number))
            .collect();
        let batches = octree.nodes.iter().enumerate().flat_map(|(number, node)| {
            cloud.batches[node.batches.start as usize..node.batches.end as usize]
                .iter()
                .map(move |b| GpuBatch::new(&cloud.split, b, number as u32, b.first_point))
        });
        let batches = batches.collect();
        Self { cloud, filtered_colors: &octree.filtered_colors, nodes, batches, tree: None }
    }

    /// A sequential point tree, whose discs may be wrong by `error_px` pixels.
    #[must_use]
    pub fn sequential(spt: &'a SequentialCloud, error_px: f32) -> Self {
        let cloud = &spt.cloud;
        let tree = Some((Tree::new(spt), error_px));
        Self { cloud, filtered_colors: &cloud.colors, nodes: vec![], batches: vec![], tree }
    }

    /// The color that an id stands for.
    #[must_use]
    pub fn color(&self, id: u32) -> u32 {
        let colors = if id & ID_ODD != 0 { self.filtered_colors } else { &self.cloud.colors };
        colors[(id >> ID_SHIFT) as usize]
    }

    /// The color that `hqs` adds to a pixel.
    fn color_put(&self, put: &points::Put) -> u32 {
        let mixed = |mixture: tree::triangles::Mixture| mixture.color(&self.cloud.colors);
        put.mixture.map_or_else(|| self.color(put.id), mixed)
    }
}

/// Results of a frame. Pixels have an entry per eye and are those of the image, without its guard band.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReferenceFrame {
    /// Batches drawn.
    pub visible: Vec<VisibleBatch>,
    /// Number of nodes that the batches drawn belong to.
    pub visible_nodes: u32,
    /// Nodes' states.
    pub states: Vec<u32>,
    /// `closest`: depth ≪ 32 | id.
    pub keys: Vec<Vec<u64>>,
    /// `hqs`: bits of the nearest depth.
    pub depth: Vec<Vec<u32>>,
    /// `hqs`: sums of colors.
    pub sums: Vec<Vec<color::Sum>>,
    /// Depths and colors of the pixels before gaps are filled.
    pub surface: Vec<Vec<Pixel>>,
    /// The finished pixels.
    pub pixels: Vec<Vec<Pixel>>,
    /// The images.
    pub images: Vec<Vec<u32>>,
}

impl ReferenceFrame {
    /// Points in the batches drawn.
    #[must_use]
    pub fn points_read(&self) -> u64 {
        let batches = self.visible.chunk_by(|a, b| a.first_point == b.first_point);
        batches.map(|slices| u64::from(slices[0].num_points)).sum()
    }
}

/// Draws `scene` as the GPU does; `states` are its nodes' states of the frame before, `None` in the first frame.
#[must_use]
pub fn frame(
    scene: &ReferenceCloud,
    view: &View,
    options: &DrawOptions,
    states: Option<&[u32]>,
) -> ReferenceFrame {
    let uniform = ViewUniform::new(view, &scene.cloud.split, &options.detail);
    let num_eyes = view.eyes.len();
    let tree = scene.tree.as_ref().map(|(tree, error_px)| {
        let uniform = TreeUniform::new(view, &options.detail, *error_px, tree.uniform.step_base);
        Tree { uniform, ..tree.clone() }
    });
    let (states, visible, visible_nodes) = match &tree {
        Some(tree) => {
            let visible = tree::cull::cull(&uniform, num_eyes, tree);
            let run_of = |point| tree.batches[tree.batches.partition_point(|b| b.first_point < point)].run;
            let num_runs = cull::num_nodes(&visible, run_of);
            (vec![DRAWN_WHOLE; tree.runs.len()], visible, num_runs)
        }
        None => {
            let mut states = states.map_or_else(|| vec![0; scene.nodes.len()], <[u32]>::to_vec);
            lod::lod(&uniform, num_eyes, &scene.nodes, &mut states);
            let visible = cull::cull(&uniform, num_eyes, &scene.batches, &scene.nodes, &states);
            let node_of =
                |point| scene.batches[scene.batches.partition_point(|b| b.first_point < point)].node;
            let num_nodes = cull::num_nodes(&visible, node_of);
            (states, visible, num_nodes)
        }
    };
    let [hi, mid, lo] = &scene.cloud.planes;
    let points = |put: &mut dyn FnMut(points::Put)| {
        let fill = options.detail.fill_reach_px.is_some();
        points::points(&uniform, num_eyes, &visible, [hi, mid, lo], tree.as_ref(), fill, put);
    };
    let sizes_px: Vec<[u32; 2]> = view.eyes.iter().map(|eye| guarded(eye.size_px)).collect();
    let mut frame = ReferenceFrame::default();
    match options.quality {
        Quality::Closest => {
            frame.keys = sizes_px.iter().map(|&size_px| clear::pixels(size_px, clear::EMPTY)).collect();
            points(&mut |put| depth::key(&mut frame.keys, put));
            let shade = |keys: &Vec<u64>| resolve::shade(keys, &|id| scene.color(id));
            frame.surface = frame.keys.iter().map(shade).collect();
        }
        Quality::Hqs => {
            frame.depth = sizes_px.iter().map(|&size_px| clear::pixels(size_px, EMPTY_DEPTH)).collect();
            frame.sums = sizes_px.iter().map(|&size_px| clear::pixels(size_px, [0; 4])).collect();
            points(&mut |put| depth::nearest(&mut frame.depth, put));
            points(&mut |put| color::add(&mut frame.sums, &frame.depth, put, scene.color_put(&put)));
            let eyes = frame.depth.iter().zip(&frame.sums);
            frame.surface = eyes.map(|(depth, sums)| resolve::blend(depth, sums)).collect();
        }
    }
    let dilated = |(eye, surface): (usize, &Vec<Pixel>)| match options.dilate {
        Dilate::Off => surface.clone(),
        Dilate::Rings => dilate::dilate(&uniform, eye, surface),
    };
    frame.pixels = frame.surface.iter().enumerate().map(dilated).collect();
    let image = |pixels: &Vec<Pixel>| resolve::image(pixels, options.background_word());
    frame.images = frame.pixels.iter().map(image).collect();
    ReferenceFrame {
        visible_nodes,
        visible,
        states,
        keys: images_of(&frame.keys, view),
        depth: images_of(&frame.depth, view),
        sums: images_of(&frame.sums, view),
        surface: images_of(&frame.surface, view),
        pixels: images_of(&frame.pixels, view),
        images: images_of(&frame.images, view),
    }
}

/// The eyes' pixels without their guard bands.
fn images_of<T: Clone>(eyes: &[Vec<T>], view: &View) -> Vec<Vec<T>> {
    eyes.iter().zip(&view.eyes).map(|(pixels, eye)| without_guard(pixels, eye.size_px)).collect()
}
