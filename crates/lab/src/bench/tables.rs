//! The papers' tables: which ways take part, which places they draw from, and which figures become rows.

use super::Table;
use super::contestant::{Compute, Counter, FrameCounts, FrameMs, Hardware};
use super::rows::{RowGroup, TimedFrames, gpu_ms, hardware_load, row, row_of_frames};
use super::subject::{Camera, Model, Subject};
use super::way::{CloudForm, Way};
use crate::order::Order;
use crate::report::BenchRow;
use crate::technique::{LabTechnique, Method, tree};
use anyhow::{Result, ensure};
use base::space::View;
use base::task::{Progress, Task};
use cloud::Cloud;
use render::CloudBuffers;
use render::DrawOptions;
use render::gpu::Gpu;
use render::layout::BATCH_POINTS;
use render::options::{Precision, Quality};
use std::sync::Arc;
use timing::STAGES;

/// Turns that do not count.
const WARM_UP: usize = 1;
/// Frames of a turn. Only the last one counts, when caches and scheduler are as its own kind leaves them.
const TURN_FRAMES: u32 = 2;
/// Pixels of the 2021 paper's pictures.
const SIZE_2021_PX: [u32; 2] = [1920, 1080];
/// Pixels of the 2022 paper's pictures.
const SIZE_2022_PX: [u32; 2] = [2560, 1140];
/// Pixels of an eye: the 2022 paper's, 150 % of a Valve Index, and a plain Index.
const SIZES_VR_PX: [[u32; 2]; 2] = [[2478, 2740], [1440, 1600]];
/// Methods of the 2021 paper, that of the poster of 2019, and the frame's own.
const METHODS_2021: [Method; 13] = [
    Method::JustSet,
    Method::BusyLoop,
    Method::ExchangeLoop,
    Method::AtomicMin,
    Method::EarlyZ,
    Method::Reduce,
    Method::ReduceEarlyZ,
    Method::Dedup,
    Method::Hqs,
    Method::Hqs1,
    Method::Hqs1r,
    Method::Fixed40,
    Method::Prefetch,
];

/// Points per node of an octree made with usual settings, and of one made with coarse settings [2021, table 2].
const NODE_POINTS: [(&str, u32); 2] = [("small-nodes", 2_400), ("large-nodes", 49_400)];

/// Device and settings that all tables share.
pub struct Bench<'a> {
    /// Draw options of a headset by default.
    pub headset_options: DrawOptions,
    pub gpu: &'a Arc<Gpu>,
    /// Largest part of the point pool in one binding, in bytes; 0: what the GPU allows.
    pub chunk_limit: u64,
    /// Turns that count.
    pub num_runs: usize,
    /// Size of every picture; `None`: the papers'.
    pub size_px: Option<[u32; 2]>,
    /// Names of the rows that are wanted beside hardware points; empty: all.
    pub methods: &'a [String],
    pub task: &'a Task,
}

/// The ways that a table compares, each with its renderer and the one that counts.
struct TableContestants {
    size_px: [u32; 2],
    ways: Vec<(Way, Compute, Counter)>,
    /// Counter of a method in which every point in the picture asks for its pixel, as hardware points do.
    asked: Counter,
}

/// Clouds that contestants are lent.
#[derive(Default)]
struct Clouds {
    flat: Option<CloudBuffers>,
    layered: Option<CloudBuffers>,
    sequential: Option<CloudBuffers>,
}

impl Clouds {
    fn of(&mut self, way: &Way) -> &mut Option<CloudBuffers> {
        match way.form {
            CloudForm::Flat => &mut self.flat,
            CloudForm::Octree => &mut self.layered,
            CloudForm::Spt => &mut self.sequential,
        }
    }
}

/// Ways of [`Bench::table_2021`].
fn ways_2021() -> Vec<Way> {
    METHODS_2021.into_iter().map(Way::paper_2021).collect()
}

/// Ways of [`Bench::table_2022`].
fn ways_2022() -> Vec<Way> {
    let flat = |name, method| Way::paper_2022(name, method, Quality::Closest, CloudForm::Flat);
    let (basic, prefetch) = (flat("basic", Method::Basic), flat("prefetch", Method::Prefetch));
    let full = |name, way| Way { name, precision: Precision::Full, ..way };
    let unculled = |name, way| Way { name, cull: false, ..way };
    vec![
        basic,
        full("basic-full-precision", basic),
        unculled("basic-no-cull", basic),
        prefetch,
        full("prefetch-full-precision", prefetch),
        unculled("prefetch-no-cull", prefetch),
        Way { name: "just-set", method: Some(Method::JustSet), ..basic },
        flat("prefetch-just-set", Method::PrefetchJustSet),
        Way::paper_2022("hqs", Method::Prefetch, Quality::Hqs, CloudForm::Flat),
        Way::paper_2022("lod", Method::Prefetch, Quality::Closest, CloudForm::Octree),
        Way::paper_2022("lod-hqs", Method::Prefetch, Quality::Hqs, CloudForm::Octree),
        // The paper compares with these earlier methods of its authors.
        Way::paper_2021(Method::Dedup),
        Way::paper_2021(Method::Hqs1r),
    ]
}

/// Ways of [`Bench::table_2019`].
fn ways_2019() -> Vec<Way> {
    [Method::Fixed40, Method::Hqs].map(Way::paper_2021).to_vec()
}

/// Ways of [`Bench::table_spt`].
fn ways_spt() -> Vec<Way> {
    let way = |name, quality, form| Way::paper_2022(name, Method::Prefetch, quality, form);
    vec![
        way("prefetch", Quality::Closest, CloudForm::Flat),
        way("lod", Quality::Closest, CloudForm::Octree),
        way("spt", Quality::Closest, CloudForm::Spt),
        way("hqs", Quality::Hqs, CloudForm::Flat),
        way("lod-hqs", Quality::Hqs, CloudForm::Octree),
        way("spt-hqs", Quality::Hqs, CloudForm::Spt),
    ]
}

/// Names of a table's rows beside hardware points; none for a table whose rows are no methods.
pub fn names(table: Table) -> Vec<&'static str> {
    let ways = match table {
        Table::Paper2019 => ways_2019(),
        Table::Paper2021 => ways_2021(),
        Table::Paper2022 => ways_2022(),
        Table::Spt => ways_spt(),
        Table::Vr => vec![],
    };
    ways.into_iter().map(|way| way.name).collect()
}

/// The made-up scans that a table is measured with, in this order.
pub fn models(table: Table) -> &'static [Model] {
    match table {
        Table::Paper2019 | Table::Paper2022 => &[Model::Courtyard, Model::Landscape, Model::Statue],
        Table::Paper2021 => &[Model::Courtyard, Model::Statue],
        Table::Vr | Table::Spt => &[Model::Courtyard],
    }
}

/// Names of the places that a table looks at a model from, the papers' first.
fn places(table: Table, model: Model) -> &'static [&'static str] {
    match (table, model) {
        (Table::Paper2021, Model::Statue) => &["overview", "face"],
        (Table::Paper2021, _) => &["overview", "close-up", "outside-frustum", "stair"],
        (Table::Paper2022, Model::Courtyard | Model::Scan) => &["overview", "close-up", "terrace"],
        (Table::Spt, _) => &["overview", "close-up"],
        (Table::Paper2019 | Table::Paper2022 | Table::Vr, _) => &["overview"],
    }
}

impl Bench<'_> {
    /// Measures 40-bit depths, two passes, and hardware points [2019, table 1].
    pub fn table_2019(&self, subject: &Subject) -> Result<Vec<BenchRow>> {
        let mut contestants = self.contestants(ways_2019(), SIZE_2021_PX)?;
        let of = RowGroup { table: "2019", order: "original", subject };
        let places = subject.places(places(Table::Paper2019, subject.model));
        self.flat_rows(of, Order::Original, &mut contestants, &places)
    }

    /// Measures methods × orders × viewpoints [2021, tables 1 and 3 to 5], and what small nodes cost [2021, table 2].
    pub fn table_2021(&self, subject: &Subject) -> Result<Vec<BenchRow>> {
        let mut contestants = self.contestants(ways_2021(), SIZE_2021_PX)?;
        let places = subject.places(places(Table::Paper2021, subject.model));
        let mut rows = Vec::new();
        for order in Order::ALL {
            let of = RowGroup { table: "2021", order: order.name(), subject };
            rows.extend(self.flat_rows(of, order, &mut contestants, &places)?);
        }
        if subject.model == Model::Statue {
            rows.extend(self.rows_of_nodes(subject)?);
        }
        Ok(rows)
    }

    /// Measures all points as nodes of an octree: hardware points with a draw per node, compute shaders with batches no
    /// larger than a node [2021, table 2].
    fn rows_of_nodes(&self, subject: &Subject) -> Result<Vec<BenchRow>> {
        let mut contestants = self.contestants(vec![Way::paper_2021(Method::ReduceEarlyZ)], SIZE_2021_PX)?;
        let mut rows = Vec::new();
        for (name, node_points) in NODE_POINTS {
            let cloud = subject.in_batches(node_points.min(BATCH_POINTS), self.task)?;
            let (mut hardware, mut clouds) = self.flat(&cloud, contestants.size_px)?;
            drop(cloud);
            hardware.set_draw_points(node_points);
            let of = RowGroup { table: "2021-nodes", order: "morton", subject };
            // All rows are of one place; they differ in the nodes.
            let places: Vec<Camera> =
                subject.places(&["overview"]).into_iter().map(|place| Camera { name, ..place }).collect();
            rows.extend(self.rows(of, &mut contestants, &mut hardware, &mut clouds, &places)?);
        }
        Ok(rows)
    }

    /// Measures flat clouds and octrees, with and without what makes them fast [2022, tables 1 and 2], and what the
    /// order of a scanner costs [2022 §4.2].
    pub fn table_2022(&self, subject: &Subject) -> Result<Vec<BenchRow>> {
        let mut contestants = self.contestants(ways_2022(), SIZE_2022_PX)?;
        let cloud = subject.flat(Order::Morton, self.task)?;
        let (mut hardware, mut clouds) = self.flat(&cloud, contestants.size_px)?;
        drop(cloud);
        clouds.layered = Some(self.layered(subject)?);
        let places = subject.places(places(Table::Paper2022, subject.model));
        let of = RowGroup { table: "2022", order: "morton", subject };
        let mut rows = self.rows(of, &mut contestants, &mut hardware, &mut clouds, &places)?;
        drop((hardware, clouds));
        if subject.model == Model::Courtyard {
            let prefetch = Way::paper_2022("prefetch", Method::Prefetch, Quality::Closest, CloudForm::Flat);
            let mut contestants = self.contestants(vec![prefetch], SIZE_2022_PX)?;
            let places = subject.places(&["overview", "close-up"]);
            for order in [Order::Original, Order::Morton] {
                let of = RowGroup { table: "2022-order", order: order.name(), subject };
                rows.extend(self.flat_rows(of, order, &mut contestants, &places)?);
            }
        }
        Ok(rows)
    }

    /// Measures sequential point trees beside octrees and every point [SPT §4].
    pub fn table_spt(&self, subject: &Subject) -> Result<Vec<BenchRow>> {
        let mut contestants = self.contestants(ways_spt(), SIZE_2022_PX)?;
        let cloud = subject.flat(Order::Morton, self.task)?;
        let (mut hardware, mut clouds) = self.flat(&cloud, contestants.size_px)?;
        drop(cloud);
        clouds.layered = Some(self.layered(subject)?);
        let spt = subject.sequential(self.task)?;
        let silent = Progress::silent(self.task.cancel_token());
        clouds.sequential = Some(tree::upload(self.gpu, &spt, self.chunk_limit, &silent)?);
        drop(spt);
        let places = subject.places(places(Table::Spt, subject.model));
        let of = RowGroup { table: "spt", order: "morton", subject };
        self.rows(of, &mut contestants, &mut hardware, &mut clouds, &places)
    }

    /// Makes contestants of the ways that are wanted and that this GPU can draw.
    fn contestants(&self, mut ways: Vec<Way>, paper_px: [u32; 2]) -> Result<TableContestants> {
        let size_px = self.size_px.unwrap_or(paper_px);
        let is_wanted =
            |way: &Way| self.methods.is_empty() || self.methods.iter().any(|name| name == way.name);
        ways.retain(|way| is_wanted(way) && (way.method != Some(Method::Fixed40) || self.gpu.has_f64()));
        let contestant = |way: Way| {
            let (options, technique) = (way.options(&self.headset_options.detail), way.technique());
            let compute = Compute::new(self.gpu, &[size_px], options, technique)?;
            Ok((way, compute, Counter::new(self.gpu, &[size_px], options, technique)?))
        };
        let asks = Way::paper_2021(Method::AtomicMin);
        Ok(TableContestants {
            size_px,
            ways: ways.into_iter().map(contestant).collect::<Result<_>>()?,
            asked: Counter::new(
                self.gpu,
                &[size_px],
                asks.options(&self.headset_options.detail),
                asks.technique(),
            )?,
        })
    }

    /// Uploads a flat cloud twice: for hardware points, and for all other ways.
    fn flat(&self, cloud: &Cloud, size_px: [u32; 2]) -> Result<(Hardware, Clouds)> {
        let hardware = Hardware::new(self.gpu, cloud, size_px)?;
        let flat = CloudBuffers::upload(
            self.gpu,
            cloud,
            self.chunk_limit,
            &Progress::silent(self.task.cancel_token()),
        )?;
        Ok((hardware, Clouds { flat: Some(flat), ..Clouds::default() }))
    }

    fn layered(&self, subject: &Subject) -> Result<CloudBuffers> {
        let octree = subject.layered(self.task)?;
        let silent = Progress::silent(self.task.cancel_token());
        Ok(CloudBuffers::upload_layered(self.gpu, &octree, self.chunk_limit, &silent)?)
    }

    /// Measures the rows of all points in an order.
    fn flat_rows(
        &self,
        of: RowGroup,
        order: Order,
        contestants: &mut TableContestants,
        places: &[Camera],
    ) -> Result<Vec<BenchRow>> {
        let cloud = of.subject.flat(order, self.task)?;
        let (mut hardware, mut clouds) = self.flat(&cloud, contestants.size_px)?;
        drop(cloud);
        self.rows(of, contestants, &mut hardware, &mut clouds, places)
    }

    /// Measures a row for each way, and for hardware points, from each place.
    fn rows(
        &self,
        of: RowGroup,
        contestants: &mut TableContestants,
        hardware: &mut Hardware,
        clouds: &mut Clouds,
        places: &[Camera],
    ) -> Result<Vec<BenchRow>> {
        let mut rows = Vec::new();
        for place in places {
            let view = place.mono(contestants.size_px);
            let asked = contestants.asked.load(&mut clouds.flat, &view)?;
            let mut all = vec![TimedFrames {
                name: Way::POINT_LIST.name.into(),
                load: hardware_load(of.subject, asked),
                samples: Vec::new(),
            }];
            for (way, _, counter) in &mut contestants.ways {
                let load = counter.load(clouds.of(way), &view)?;
                all.push(TimedFrames { name: way.name.into(), load, samples: Vec::new() });
            }
            for turn in 0..WARM_UP + self.num_runs {
                ensure!(!self.task.cancel_token().is_cancelled(), "interrupted");
                let mut samples = vec![hardware.draw(&view, TURN_FRAMES)?];
                for (way, compute, _) in &mut contestants.ways {
                    samples.push(compute.draw(clouds.of(way), &view, TURN_FRAMES)?);
                }
                if turn >= WARM_UP {
                    all.iter_mut().zip(samples).for_each(|(timed, sample)| timed.samples.push(sample));
                }
            }
            let mut rows_here: Vec<BenchRow> =
                all.iter().map(|timed| row_of_frames(of, place.name, timed)).collect();
            let point_list_ms = rows_here[0].gpu_ms.median;
            rows_here
                .iter_mut()
                .for_each(|row| row.ratio_to_point_list = Some(point_list_ms / row.gpu_ms.median));
            rows.extend(rows_here);
            eprintln!(
                "scanwalk: table {}, {}, {}, {}: measured",
                of.table,
                of.subject.model.name(),
                of.order,
                place.name
            );
        }
        Ok(rows)
    }

    /// Measures where the time of a headset's frame goes, for one eye and for both [2022 §4.3].
    pub fn table_vr(&self, subject: &Subject) -> Result<Vec<BenchRow>> {
        let mut cloud = Some(self.layered(subject)?);
        let mut rows = Vec::new();
        for size_px in self.size_px.map_or(SIZES_VR_PX.to_vec(), |size_px| vec![size_px]) {
            rows.extend(self.vr_rows(subject, &mut cloud, size_px)?);
        }
        Ok(rows)
    }

    fn vr_rows(
        &self,
        subject: &Subject,
        cloud: &mut Option<CloudBuffers>,
        size_px: [u32; 2],
    ) -> Result<Vec<BenchRow>> {
        // The program draws with these options unless told otherwise.
        let options = self.headset_options;
        let place = subject.places(places(Table::Vr, subject.model))[0];
        let both_eyes = place.stereo(size_px);
        let one_eye = View { eyes: both_eyes.eyes[..1].to_vec(), near: both_eyes.near };
        let own = LabTechnique::OWN;
        let mut both = Compute::new(self.gpu, &[size_px; 2], options, own)?;
        let mut one = Compute::new(self.gpu, &[size_px], options, own)?;
        let load = Counter::new(self.gpu, &[size_px; 2], options, own)?.load(cloud, &both_eyes)?;
        let load_one = Counter::new(self.gpu, &[size_px], options, own)?.load(cloud, &one_eye)?;
        let (mut of_both, mut of_one) = (Vec::new(), Vec::new());
        for turn in 0..WARM_UP + self.num_runs {
            ensure!(!self.task.cancel_token().is_cancelled(), "interrupted");
            let samples =
                (both.draw(cloud, &both_eyes, TURN_FRAMES)?, one.draw(cloud, &one_eye, TURN_FRAMES)?);
            if turn >= WARM_UP {
                of_both.push(samples.0);
                of_one.push(samples.1);
            }
        }
        let viewpoint = format!("{} {}x{}", place.name, size_px[0], size_px[1]);
        let part = |name: &str, samples: &[FrameMs], load: FrameCounts, value: &dyn Fn(&FrameMs) -> f64| {
            let timed = TimedFrames { name: name.into(), load, samples: vec![] };
            let ms = gpu_ms(samples.iter().map(value));
            let row = row(RowGroup { table: "vr", order: "octree", subject }, &viewpoint, &timed, ms);
            // The bytes read are those of the whole frame.
            let is_whole = name.starts_with("total");
            let (bytes_read, gb_per_s) = if is_whole { (row.bytes_read, row.gb_per_s) } else { (None, None) };
            BenchRow { bytes_read, gb_per_s, ..row }
        };
        let mut rows = vec![
            part("total", &of_both, load, &|sample| sample.gpu_ms),
            part("total-one-eye", &of_one, load_one, &|sample| sample.gpu_ms),
        ];
        for (number, stage) in STAGES.iter().enumerate() {
            let time = move |sample: &FrameMs| sample.stage_ms[number];
            if matches!(*stage, "depth" | "color") {
                rows.push(part(&format!("{stage}-both-eyes"), &of_both, load, &time));
                rows.push(part(&format!("{stage}-one-eye"), &of_one, load_one, &time));
            } else {
                rows.push(part(stage, &of_both, load, &time));
            }
        }
        eprintln!("scanwalk: table vr, {viewpoint}: measured");
        Ok(rows)
    }
}
