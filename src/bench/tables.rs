//! The papers' tables: who takes part, from where, and what of it becomes a row.

use super::contestant::{Compute, Hardware, Load, Sample};
use super::subject::{Place, Subject};
use super::way::{Form, Way};
use super::{Table, papers};
use crate::cloud::Order;
use crate::config::{Config, Precision, Quality};
use crate::gpu::Gpu;
use crate::look::Look;
use crate::method::Method;
use crate::progress::{Progress, Stop};
use crate::render::CloudBuffers;
use crate::report::{BenchRow, GpuMs};
use crate::space::View;
use crate::timing::STAGES;
use crate::timing::percentile::Sorted;
use anyhow::{Result, ensure};
use std::sync::Arc;

/// Turns that do not count.
const WARM_UP: usize = 1;
/// Frames of a turn: the last one counts, when caches and scheduler are as its own kind leaves them.
const TURN_FRAMES: u32 = 2;
/// Pixels of the 2021 paper's pictures.
const SIZE_2021_PX: [u32; 2] = [1920, 1080];
/// Pixels of the 2022 paper's pictures.
const SIZE_2022_PX: [u32; 2] = [2560, 1140];
/// Pixels of an eye: the 2022 paper's, 150 % of a Valve Index, and a plain Index.
const SIZES_VR_PX: [[u32; 2]; 2] = [[2478, 2740], [1440, 1600]];
/// Orders of the 2021 paper.
const ORDERS: [(Order, &str); 4] = [
    (Order::Original, "original"),
    (Order::Morton, "morton"),
    (Order::Shuffled, "shuffled"),
    (Order::ShuffledMorton, "shuffled-morton"),
];
/// Methods of the 2021 paper, that of the poster of 2019, and the frame's own.
const METHODS_2021: [Method; 12] = [
    Method::JustSet,
    Method::BusyLoop,
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

/// What all tables need.
pub struct Bench<'a> {
    pub gpu: &'a Arc<Gpu>,
    /// Bytes of the pool in one binding at most; 0: what the GPU allows.
    pub chunk_limit: u64,
    /// Turns that count.
    pub num_runs: usize,
    /// Of every picture; `None`: the papers'.
    pub size_px: Option<[u32; 2]>,
    /// Only these, beside hardware points; empty: all.
    pub methods: &'a [String],
    pub stop: &'a Stop,
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
            Form::Flat => &mut self.flat,
            Form::Octree => &mut self.layered,
            Form::Spt => &mut self.sequential,
        }
    }
}

/// A row's frames.
struct Timed {
    name: String,
    load: Load,
    samples: Vec<Sample>,
    /// Geometry stages that load every point's coordinates.
    num_passes: u64,
}

/// Those of [`Bench::table_2021`].
fn ways_2021() -> Vec<Way> {
    METHODS_2021.into_iter().map(Way::paper_2021).collect()
}

/// Those of [`Bench::table_2022`].
fn ways_2022() -> Vec<Way> {
    let flat = |name, method| Way::paper_2022(name, method, Quality::Closest, Form::Flat);
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
        Way::paper_2022("hqs", Method::Prefetch, Quality::Hqs, Form::Flat),
        Way::paper_2022("lod", Method::Prefetch, Quality::Closest, Form::Octree),
        Way::paper_2022("lod-hqs", Method::Prefetch, Quality::Hqs, Form::Octree),
    ]
}

/// Those of [`Bench::table_spt`].
fn ways_spt() -> Vec<Way> {
    let way = |name, quality, form| Way::paper_2022(name, Method::Prefetch, quality, form);
    vec![
        way("prefetch", Quality::Closest, Form::Flat),
        way("lod", Quality::Closest, Form::Octree),
        way("spt", Quality::Closest, Form::Spt),
        way("hqs", Quality::Hqs, Form::Flat),
        way("lod-hqs", Quality::Hqs, Form::Octree),
        way("spt-hqs", Quality::Hqs, Form::Spt),
    ]
}

/// Names that rows of a table have, beside hardware points; none for one whose rows are no methods.
pub fn names(table: Table) -> Vec<&'static str> {
    let ways = match table {
        Table::Paper2021 => ways_2021(),
        Table::Paper2022 => ways_2022(),
        Table::Spt => ways_spt(),
        Table::Vr => vec![],
    };
    ways.into_iter().map(|way| way.name).collect()
}

impl Bench<'_> {
    /// Methods × orders × viewpoints [2021, tables 4 and 5].
    pub fn table_2021(&self, subject: &Subject) -> Result<Vec<BenchRow>> {
        let mut ways = ways_2021();
        ways.retain(|way| way.method != Some(Method::Fixed40) || self.gpu.has_f64());
        let mut rows = Vec::new();
        for (order, name) in ORDERS {
            let cloud = subject.flat(order, self.stop)?;
            let size_px = self.size_px.unwrap_or(SIZE_2021_PX);
            let mut hardware = Hardware::new(self.gpu, &cloud, size_px)?;
            let flat =
                CloudBuffers::upload(self.gpu, &cloud, self.chunk_limit, &Progress::silent(self.stop))?;
            drop(cloud);
            let mut clouds = Clouds { flat: Some(flat), ..Clouds::default() };
            let views = subject.places.map(|place| (place, place.mono(size_px)));
            rows.extend(self.rows("2021", name, subject, &ways, &mut hardware, &mut clouds, &views)?);
        }
        Ok(rows)
    }

    /// Flat clouds and octrees, with and without what makes them fast [2022, tables 1 and 2].
    pub fn table_2022(&self, subject: &Subject) -> Result<Vec<BenchRow>> {
        let ways = ways_2022();
        let cloud = subject.flat(Order::Morton, self.stop)?;
        let size_px = self.size_px.unwrap_or(SIZE_2022_PX);
        let mut hardware = Hardware::new(self.gpu, &cloud, size_px)?;
        let silent = Progress::silent(self.stop);
        let flat = CloudBuffers::upload(self.gpu, &cloud, self.chunk_limit, &silent)?;
        drop(cloud);
        let layered =
            CloudBuffers::upload_layered(self.gpu, &subject.layered(self.stop)?, self.chunk_limit, &silent)?;
        let mut clouds = Clouds { flat: Some(flat), layered: Some(layered), sequential: None };
        let views = [0, 1].map(|number| {
            let place: Place = subject.places[number];
            (place, place.mono(size_px))
        });
        self.rows("2022", "morton", subject, &ways, &mut hardware, &mut clouds, &views)
    }

    /// Sequential point trees beside octrees and every point [SPT §6].
    pub fn table_spt(&self, subject: &Subject) -> Result<Vec<BenchRow>> {
        let ways = ways_spt();
        let size_px = self.size_px.unwrap_or(SIZE_2022_PX);
        let silent = Progress::silent(self.stop);
        let cloud = subject.flat(Order::Morton, self.stop)?;
        let mut hardware = Hardware::new(self.gpu, &cloud, size_px)?;
        let flat = CloudBuffers::upload(self.gpu, &cloud, self.chunk_limit, &silent)?;
        drop(cloud);
        let octree = subject.layered(self.stop)?;
        let layered = CloudBuffers::upload_layered(self.gpu, &octree, self.chunk_limit, &silent)?;
        drop(octree);
        let spt = subject.sequential(self.stop)?;
        let sequential = CloudBuffers::upload_sequential(self.gpu, &spt, self.chunk_limit, &silent)?;
        drop(spt);
        let mut clouds = Clouds { flat: Some(flat), layered: Some(layered), sequential: Some(sequential) };
        let views = [0, 1].map(|number| {
            let place: Place = subject.places[number];
            (place, place.mono(size_px))
        });
        self.rows("spt", "morton", subject, &ways, &mut hardware, &mut clouds, &views)
    }

    /// A row for each way and hardware points from each viewpoint.
    #[expect(clippy::too_many_arguments, reason = "a table is a product of as many things")]
    fn rows(
        &self,
        table: &str,
        order: &str,
        subject: &Subject,
        ways: &[Way],
        hardware: &mut Hardware,
        clouds: &mut Clouds,
        views: &[(Place, View)],
    ) -> Result<Vec<BenchRow>> {
        let mut rows = Vec::new();
        let size_px = views[0].1.eyes[0].size_px;
        let is_wanted =
            |way: &&Way| self.methods.is_empty() || self.methods.iter().any(|name| name == way.name);
        let ways: Vec<&Way> = ways.iter().filter(is_wanted).collect();
        let mut contestants = Vec::new();
        for &way in &ways {
            contestants.push((way, Compute::new(self.gpu, &[size_px], way)?));
        }
        for (place, view) in views {
            let mut all = vec![Timed {
                name: Way::POINT_LIST.name.into(),
                load: hardware_load(subject, self.load(&Way::paper_2021(Method::EarlyZ), clouds, view)?),
                samples: Vec::new(),
                num_passes: 1,
            }];
            for way in &ways {
                let num_passes = if way.quality == Quality::Hqs { 2 } else { 1 };
                let load = self.load(way, clouds, view)?;
                all.push(Timed { name: way.name.into(), load, samples: Vec::new(), num_passes });
            }
            for turn in 0..WARM_UP + self.num_runs {
                ensure!(!self.stop.requested(), "interrupted");
                let mut samples = vec![hardware.draw(view, TURN_FRAMES)?];
                for (way, contestant) in &mut contestants {
                    samples.push(contestant.draw(clouds.of(way), view, TURN_FRAMES)?);
                }
                if turn >= WARM_UP {
                    all.iter_mut().zip(samples).for_each(|(timed, sample)| timed.samples.push(sample));
                }
            }
            let rows_here = all.iter().map(|timed| {
                let ms = gpu_ms(timed.samples.iter().map(|sample| sample.gpu_ms));
                let geometry = gpu_ms(timed.samples.iter().map(geometry_ms)).median;
                let row = row(table, order, place.name, subject.num_points(), timed, ms);
                BenchRow { geometry_ms: Some(geometry).filter(|ms| *ms > 0.0), ..row }
            });
            let mut rows_here: Vec<BenchRow> = rows_here.collect();
            let point_list_ms = rows_here[0].gpu_ms.median;
            rows_here
                .iter_mut()
                .for_each(|row| row.ratio_to_point_list = Some(point_list_ms / row.gpu_ms.median));
            rows.extend(rows_here);
            eprintln!("scanwalk: table {table}, {order}, {}: measured", place.name);
        }
        Ok(rows)
    }

    fn load(&self, way: &Way, clouds: &mut Clouds, view: &View) -> Result<Load> {
        Compute::load(self.gpu, way, clouds.of(way), view)
    }

    /// Where the time of a headset's frame goes, one eye and both [2022 §4.3].
    pub fn table_vr(&self, subject: &Subject) -> Result<Vec<BenchRow>> {
        let octree = subject.layered(self.stop)?;
        let silent = Progress::silent(self.stop);
        let mut cloud = Some(CloudBuffers::upload_layered(self.gpu, &octree, self.chunk_limit, &silent)?);
        drop(octree);
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
        // The frame as the program draws it unless told otherwise.
        let look = Look::of(&Config::default());
        let place = subject.places[0];
        let both_eyes = place.stereo(size_px);
        let one_eye = View { eyes: both_eyes.eyes[..1].to_vec(), near: both_eyes.near };
        let mut both = Compute::with_look(self.gpu, &[size_px; 2], look)?;
        let mut one = Compute::with_look(self.gpu, &[size_px], look)?;
        let way = Way::paper_2022("lod-hqs", Method::Prefetch, Quality::Hqs, Form::Octree);
        let load = Compute::load(self.gpu, &way, cloud, &both_eyes)?;
        let load_one = Compute::load(self.gpu, &way, cloud, &one_eye)?;
        let (mut of_both, mut of_one) = (Vec::new(), Vec::new());
        for turn in 0..WARM_UP + self.num_runs {
            ensure!(!self.stop.requested(), "interrupted");
            let samples =
                (both.draw(cloud, &both_eyes, TURN_FRAMES)?, one.draw(cloud, &one_eye, TURN_FRAMES)?);
            if turn >= WARM_UP {
                of_both.push(samples.0);
                of_one.push(samples.1);
            }
        }
        let viewpoint = format!("{} {}x{}", place.name, size_px[0], size_px[1]);
        let part = |name: &str, samples: &[Sample], load: Load, value: &dyn Fn(&Sample) -> f64| {
            let timed = Timed { name: name.into(), load, samples: vec![], num_passes: 1 };
            row("vr", "octree", &viewpoint, subject.num_points(), &timed, gpu_ms(samples.iter().map(value)))
        };
        let mut rows = vec![
            part("total", &of_both, load, &|sample| sample.gpu_ms),
            part("total-one-eye", &of_one, load_one, &|sample| sample.gpu_ms),
        ];
        for (number, stage) in STAGES.iter().enumerate() {
            let time = move |sample: &Sample| sample.stage_ms[number];
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

/// Hardware reads every point, 16 bytes each.
fn hardware_load(subject: &Subject, drawn: Load) -> Load {
    let points_read = subject.num_points();
    Load { points_read, plane_bytes: 16 * points_read, num_batches_drawn: drawn.num_batches, ..drawn }
}

/// What the stages take that read points; NaN for hardware points.
fn geometry_ms(sample: &Sample) -> f64 {
    let of_points = |(stage, _): &(&&str, &f64)| matches!(**stage, "depth" | "color");
    STAGES.iter().zip(&sample.stage_ms).filter(of_points).map(|(_, ms)| ms).sum()
}

fn gpu_ms(values: impl Iterator<Item = f64>) -> GpuMs {
    let sorted = Sorted::new(values);
    let [min, median, max] = [0, 500, 1000].map(|per_mille| sorted.percentile(per_mille).unwrap_or(0.0));
    GpuMs { median, min, max }
}

fn row(table: &str, order: &str, viewpoint: &str, points: u64, timed: &Timed, gpu_ms: GpuMs) -> BenchRow {
    let paper = papers::figure(table, &timed.name, order, viewpoint);
    let per_s = |amount: u64| if gpu_ms.median > 0.0 { amount as f64 * 1e3 / gpu_ms.median } else { 0.0 };
    BenchRow {
        table: table.into(),
        method: timed.name.clone(),
        order: order.into(),
        viewpoint: viewpoint.into(),
        points,
        points_read: timed.load.points_read,
        points_drawn: timed.load.points_drawn,
        nodes: Some(timed.load.num_batches),
        nodes_drawn: Some(timed.load.num_batches_drawn),
        gpu_ms,
        geometry_ms: None,
        m_points_per_s: per_s(timed.load.points_read) / 1e6,
        gb_per_s: Some(per_s(timed.num_passes * timed.load.plane_bytes) / 1e9),
        ratio_to_point_list: None,
        paper_ms: paper.map(|figure| figure.ms),
        paper_device: paper.map(|figure| figure.device.into()),
    }
}
