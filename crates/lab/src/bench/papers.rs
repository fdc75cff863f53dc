//! The papers' own figures, to stand beside our rows. The papers used other scans: factors can be compared,
//! milliseconds cannot. Each of their models stands beside the made-up one that is most like it, seen from a similar
//! place.

use super::subject::Model;
use crate::report::{PaperMs, PaperSays};

/// Times of a paper's table for one model, viewpoint and device, by orders and methods.
struct PaperTimes {
    table: &'static str,
    model: Model,
    viewpoint: &'static str,
    /// The GPU, and the scan.
    device: &'static str,
    methods: &'static [&'static str],
    orders: &'static [&'static str],
    /// One row per order, with one time per method.
    ms: &'static [&'static [f64]],
}

const METHODS_2019: &[&str] = &["fixed40", "hqs", "point-list"];
const METHODS_2021: &[&str] = &[
    "point-list",
    "atomic-min",
    "reduce",
    "early-z",
    "reduce-early-z",
    "dedup",
    "busy-loop",
    "just-set",
    "hqs",
    "hqs1r",
];
/// Methods of the 2022 paper. The last two are the 2021 paper's, which it measured again.
const METHODS_2022: &[&str] = &["point-list", "basic", "prefetch", "hqs", "lod", "lod-hqs", "dedup", "hqs1r"];
const ORIGINAL: &[&str] = &["original"];
const MORTON: &[&str] = &["morton"];
const ORDERS: &[&str] = &["original", "morton", "shuffled", "shuffled-morton"];

const fn of_2019(model: Model, device: &'static str, ms: &'static [&'static [f64]]) -> PaperTimes {
    PaperTimes {
        table: "2019",
        model,
        viewpoint: "overview",
        device,
        methods: METHODS_2019,
        orders: ORIGINAL,
        ms,
    }
}

const fn of_2021(
    model: Model,
    viewpoint: &'static str,
    device: &'static str,
    ms: &'static [&'static [f64]],
) -> PaperTimes {
    PaperTimes { table: "2021", model, viewpoint, device, methods: METHODS_2021, orders: ORDERS, ms }
}

const fn of_2022(
    model: Model,
    viewpoint: &'static str,
    device: &'static str,
    ms: &'static [&'static [f64]],
) -> PaperTimes {
    PaperTimes { table: "2022", model, viewpoint, device, methods: METHODS_2022, orders: MORTON, ms }
}

const RETZ: &str = "RTX 3090, Retz, 145 M points";

/// Times of the papers' tables. Of several blocks for one table, model and viewpoint, the first is shown first.
#[expect(clippy::approx_constant, reason = "a time in milliseconds that looks like π")]
const PAPER_TIMES: &[PaperTimes] = &[
    // [2019, table 1]: AtomicMin with 40-bit depths, splatting, hardware points.
    of_2019(Model::Statue, "RTX 2080 Ti, Heidentor, 26 M points", &[&[1.64, 3.37, 5.71]]),
    of_2019(Model::Statue, "GTX 1060, Heidentor, 26 M points", &[&[4.88, 11.78, 13.60]]),
    of_2019(Model::Courtyard, "RTX 2080 Ti, Retz, 145 M points", &[&[6.41, 12.95, 34.04]]),
    of_2019(Model::Courtyard, "GTX 1060, Retz, 120 M points", &[&[14.32, 31.76, 58.82]]),
    of_2019(Model::Landscape, "RTX 2080 Ti, Morro Bay, 117 M points", &[&[5.87, 15.48, 60.26]]),
    // [2021, table 5]: Retz from three viewpoints, which table 3 shows.
    of_2021(
        Model::Courtyard,
        "outside-frustum",
        RETZ,
        &[
            &[6.13, 2.89, 2.89, 2.96, 2.89, 2.95, 2.88, 2.87, 5.70, 5.74],
            &[6.20, 2.90, 2.89, 2.95, 2.89, 2.96, 2.89, 2.87, 5.69, 5.73],
            &[6.19, 2.90, 2.90, 2.95, 2.90, 2.96, 2.89, 2.88, 5.68, 5.73],
            &[6.21, 2.90, 2.89, 2.95, 2.90, 2.97, 2.90, 2.87, 5.69, 5.75],
        ],
    ),
    of_2021(
        Model::Courtyard,
        "close-up",
        RETZ,
        &[
            &[31.95, 5.07, 3.88, 3.81, 3.37, 3.06, 7.76, 2.92, 8.43, 6.91],
            &[32.26, 5.01, 3.85, 3.76, 3.34, 3.07, 7.76, 2.93, 8.38, 6.86],
            &[30.71, 8.95, 8.93, 6.10, 5.37, 6.09, 5.59, 4.13, 16.06, 13.50],
            &[8.22, 3.75, 3.41, 3.46, 3.30, 3.55, 3.88, 3.16, 7.12, 6.62],
        ],
    ),
    of_2021(
        Model::Courtyard,
        "overview",
        RETZ,
        &[
            &[153.22, 21.45, 4.29, 5.15, 3.33, 3.04, 16.66, 2.92, 12.06, 7.90],
            &[152.96, 19.83, 4.28, 5.59, 3.37, 3.05, 20.05, 2.92, 11.85, 7.97],
            &[39.52, 10.14, 10.20, 5.64, 5.47, 5.57, 6.30, 6.57, 20.01, 16.23],
            &[25.90, 6.13, 3.47, 3.32, 3.24, 3.42, 4.13, 3.14, 8.51, 6.78],
        ],
    ),
    // [2021, table 4], which table 1 shows: four models, of which Retz is close up.
    of_2021(
        Model::Courtyard,
        "close-up",
        "RTX 3090, Retz in table 4, 145 M points",
        &[
            &[31.98, 5.07, 3.91, 3.81, 3.36, 3.07, 7.66, 2.93, 8.40, 6.87],
            &[32.05, 5.01, 3.86, 3.76, 3.35, 3.06, 7.65, 2.93, 8.36, 6.83],
            &[30.57, 8.58, 8.70, 6.10, 5.35, 5.93, 5.55, 4.24, 16.23, 13.18],
            &[8.22, 3.75, 3.39, 3.46, 3.31, 3.44, 3.84, 3.18, 7.08, 6.61],
        ],
    ),
    of_2021(
        Model::Courtyard,
        "stair",
        "RTX 3090, Endeavor, 796 M points",
        &[
            &[71.62, 26.13, 25.79, 19.14, 17.86, 19.00, 21.16, 20.17, 40.35, 37.27],
            &[131.49, 36.09, 21.53, 16.56, 15.86, 15.26, 22.84, 15.05, 35.34, 31.57],
            &[162.37, 43.11, 44.13, 28.72, 25.62, 27.93, 24.30, 22.09, 54.06, 50.51],
            &[35.62, 17.84, 16.62, 17.68, 16.20, 18.01, 16.56, 16.23, 31.50, 31.46],
        ],
    ),
    of_2021(
        Model::Statue,
        "overview",
        "RTX 3090, Lion, 4 M points",
        &[
            &[0.59, 0.28, 0.28, 0.30, 0.30, 0.30, 0.58, 0.25, 0.53, 0.52],
            &[0.70, 0.27, 0.25, 0.27, 0.27, 0.24, 0.46, 0.21, 0.48, 0.47],
            &[1.34, 0.35, 0.35, 0.32, 0.32, 0.32, 0.35, 0.27, 0.89, 0.65],
            &[0.47, 0.28, 0.26, 0.27, 0.27, 0.26, 0.38, 0.21, 0.48, 0.48],
        ],
    ),
    of_2021(
        Model::Statue,
        "face",
        "RTX 3090, Lifeboat, 47 M points",
        &[
            &[9.19, 1.93, 1.71, 1.29, 1.27, 1.23, 2.62, 1.07, 2.82, 2.45],
            &[12.29, 2.14, 1.60, 1.50, 1.30, 1.13, 3.35, 1.06, 2.91, 2.56],
            &[15.00, 5.16, 5.14, 2.64, 2.52, 2.61, 2.42, 1.82, 7.25, 5.67],
            &[5.03, 1.65, 1.38, 1.27, 1.26, 1.24, 2.06, 1.14, 2.56, 2.48],
        ],
    ),
    // [2022, table 1].
    of_2022(
        Model::Statue,
        "overview",
        "RTX 3090, Eclepens, 69 M points",
        &[&[34.9, 1.1, 1.0, 2.8, 0.7, 1.4, 1.9, 7.6]],
    ),
    of_2022(
        Model::Statue,
        "overview",
        "GTX 1060, Eclepens, 69 M points",
        &[&[72.2, 6.5, 5.1, 16.7, 2.1, 5.3, 9.5, 26.2]],
    ),
    of_2022(
        Model::Landscape,
        "overview",
        "RTX 3090, Morro Bay, 279 M points",
        &[&[231.7, 2.7, 2.2, 9.6, 0.8, 1.9, 6.0, 33.5]],
    ),
    of_2022(
        Model::Courtyard,
        "overview",
        "RTX 3090, Banyunibo outside, 529 M points",
        &[&[198.3, 4.2, 3.3, 9.0, 1.3, 3.3, 10.7, 25.4]],
    ),
    of_2022(
        Model::Courtyard,
        "close-up",
        "RTX 3090, Banyunibo inside, 529 M points",
        &[&[67.9, 2.6, 2.2, 6.1, 2.1, 4.6, 11.1, 24.4]],
    ),
    of_2022(
        Model::Courtyard,
        "terrace",
        "RTX 3090, Niederweiden, 1000 M points",
        &[&[873.9, 8.2, 6.4, 20.9, 1.9, 4.5, 19.8, 69.1]],
    ),
    // [2022 §4.2]: scan order beside Morton order.
    of_order("overview", "RTX 3090, Banyunibo's laser scans outside", &[&[5.5], &[3.9]]),
    of_order("close-up", "RTX 3090, Banyunibo's laser scans inside", &[&[7.8], &[2.1]]),
    // [2021, table 2], whose frames a second are 718, 500, 1615 and 2096.
    of_nodes("small-nodes", "RTX 3090, Lion in 1624 nodes", &[&[1000.0 / 718.0, 1000.0 / 500.0]]),
    of_nodes("large-nodes", "RTX 3090, Lion in 80 nodes", &[&[1000.0 / 1615.0, 1000.0 / 2096.0]]),
];

const fn of_order(
    viewpoint: &'static str,
    device: &'static str,
    ms: &'static [&'static [f64]],
) -> PaperTimes {
    let (table, model) = ("2022-order", Model::Courtyard);
    PaperTimes {
        table,
        model,
        viewpoint,
        device,
        methods: &["prefetch"],
        orders: &["original", "morton"],
        ms,
    }
}

const fn of_nodes(
    viewpoint: &'static str,
    device: &'static str,
    ms: &'static [&'static [f64]],
) -> PaperTimes {
    let (table, model) = ("2021-nodes", Model::Statue);
    PaperTimes {
        table,
        model,
        viewpoint,
        device,
        methods: &["point-list", "reduce-early-z"],
        orders: MORTON,
        ms,
    }
}

/// Milliseconds of the parts of a frame [2022 §4.3], for the paper's image size alone.
const TABLE_VR: [(&str, f64); 7] = [
    ("depth-both-eyes", 1.7),
    ("depth-one-eye", 1.3),
    ("color-both-eyes", 2.5),
    ("color-one-eye", 1.5),
    ("resolve", 2.7),
    ("clear", 0.6),
    ("total", 8.3),
];
const VR: &str = "RTX 3090, Banyunibo, 529 M points, Valve Index at 2 × 2478 × 2740";

/// A row of [2022, table 2]: nodes processed and rendered, points processed and rendered, first of all points, then of
/// an octree. The last number is the throughput of `prefetch` [2022 §4.1], in million points a second.
type PaperCounts = (Model, &'static str, [f64; 4], [f64; 4], f64);
const TABLE_COUNTS: [PaperCounts; 5] = [
    (Model::Statue, "overview", [6.7e3, 6.7e3, 68.7e6, 13.0e6], [23.5e3, 422.0, 3.9e6, 1.4e6], 69_000.0),
    (
        Model::Landscape,
        "overview",
        [27.2e3, 27.2e3, 278.5e6, 12.2e6],
        [93.5e3, 577.0, 5.6e6, 1.9e6],
        126_800.0,
    ),
    (
        Model::Courtyard,
        "overview",
        [51.7e3, 46.6e3, 477.6e6, 13.7e6],
        [195.7e3, 3.3e3, 26.9e6, 4.4e6],
        144_700.0,
    ),
    (
        Model::Courtyard,
        "close-up",
        [51.7e3, 20.9e3, 214.5e6, 19.1e6],
        [195.7e3, 8.2e3, 67.1e6, 12.5e6],
        97_500.0,
    ),
    (
        Model::Courtyard,
        "terrace",
        [97.7e3, 88.9e3, 910.7e6, 51.6e6],
        [346.6e3, 2.1e3, 27.3e6, 6.4e6],
        142_300.0,
    ),
];

/// Looks up what the papers say of a row.
#[must_use]
pub fn figures(table: &str, model: Model, method: &str, order: &str, viewpoint: &str) -> Paper {
    let mut ms: Vec<PaperMs> = PAPER_TIMES
        .iter()
        .filter(|b| (b.table, b.model, b.viewpoint) == (table, model, viewpoint))
        .filter_map(|block| {
            let column = block.methods.iter().position(|&name| name == method)?;
            let row = block.orders.iter().position(|&name| name == order)?;
            Some(PaperMs { ms: block.ms[row][column], device: block.device.into() })
        })
        .collect();
    // The paper measured this image size alone.
    if table == "vr"
        && viewpoint.ends_with("2478x2740")
        && let Some(&(_, part)) = TABLE_VR.iter().find(|(name, _)| *name == method)
    {
        ms.push(PaperMs { ms: part, device: VR.into() });
    }
    Paper { ms, says: says(table, model, method, order, viewpoint) }
}

/// What the papers say of a row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Paper {
    /// Times; the first is of the model that is most like ours.
    pub ms: Vec<PaperMs>,
    /// The papers' other figures.
    pub says: Option<PaperSays>,
}

fn says(table: &str, model: Model, method: &str, order: &str, viewpoint: &str) -> Option<PaperSays> {
    let of_counts = |[nodes, nodes_drawn, points_read, points_drawn]: [f64; 4]| PaperSays {
        nodes: Some(nodes),
        nodes_drawn: Some(nodes_drawn),
        points_read: Some(points_read),
        points_drawn: Some(points_drawn),
        ..PaperSays::default()
    };
    match (table, method) {
        ("2022", "basic" | "prefetch" | "lod") => {
            let is_here = |counts: &&PaperCounts| (counts.0, counts.1) == (model, viewpoint);
            let &(_, _, flat, octree, m_points_per_s) = TABLE_COUNTS.iter().find(is_here)?;
            let says = of_counts(if method == "lod" { octree } else { flat });
            let m_points_per_s = (method == "prefetch").then_some(m_points_per_s);
            Some(PaperSays { m_points_per_s, ..says })
        }
        // [2022 §4.2]
        ("2022-order", "prefetch") if viewpoint == "close-up" => {
            let share = if order == "morton" { 0.68 } else { 0.35 };
            Some(PaperSays { nodes_culled_share: Some(share), ..PaperSays::default() })
        }
        ("vr", "total") if viewpoint.ends_with("2478x2740") => Some(of_counts([195e3, 2e3, 21.4e6, 8e6])),
        // [SPT §4]: points sent and drawn a second with textures on a Radeon 9700, and the CPU's load.
        ("spt", "spt") => Some(PaperSays {
            m_points_per_s: Some(77.0),
            m_drawn_per_s: Some(50.0),
            culled_share: Some([0.1, 0.4]),
            cpu_share: Some([0.05, 0.15]),
            ..PaperSays::default()
        }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::Method;

    #[test]
    fn figures_are_found_where_the_papers_have_them() {
        let ms = |table, model, method, order, viewpoint| {
            figures(table, model, method, order, viewpoint).ms.first().map(|paper| paper.ms)
        };
        assert_eq!(ms("2021", Model::Courtyard, "dedup", "morton", "close-up"), Some(3.07));
        assert_eq!(ms("2021", Model::Courtyard, "point-list", "shuffled", "overview"), Some(39.52));
        assert_eq!(ms("2021", Model::Courtyard, "busy-loop", "original", "stair"), Some(21.16));
        assert_eq!(ms("2021", Model::Statue, "hqs1r", "shuffled-morton", "overview"), Some(0.48));
        assert_eq!(ms("2022", Model::Courtyard, "lod-hqs", "morton", "close-up"), Some(4.6));
        assert_eq!(ms("2022", Model::Courtyard, "dedup", "morton", "terrace"), Some(19.8));
        assert_eq!(ms("2022", Model::Landscape, "hqs", "morton", "overview"), Some(9.6));
        assert_eq!(ms("2019", Model::Landscape, "fixed40", "original", "overview"), Some(5.87));
        assert_eq!(ms("2022-order", Model::Courtyard, "prefetch", "original", "close-up"), Some(7.8));
        assert_eq!(ms("vr", Model::Courtyard, "resolve", "octree", "overview 2478x2740"), Some(2.7));
        assert_eq!(ms("vr", Model::Courtyard, "resolve", "octree", "overview 1440x1600"), None);
        assert_eq!(ms("2021", Model::Courtyard, "hqs1", "morton", "overview"), None);
        assert_eq!(ms("2022", Model::Courtyard, "lod", "morton", "outside-frustum"), None);
        assert_eq!(ms("2022", Model::Statue, "lod", "morton", "close-up"), None);
        // Table 4 has the same view again.
        let twice = figures("2021", Model::Courtyard, "dedup", "original", "close-up").ms;
        assert_eq!(twice.iter().map(|paper| paper.ms).collect::<Vec<_>>(), [3.06, 3.07]);
        let says = |method, viewpoint| figures("2022", Model::Courtyard, method, "morton", viewpoint).says;
        assert_eq!(says("lod", "overview").and_then(|says| says.points_drawn), Some(4.4e6));
        assert_eq!(says("prefetch", "overview").and_then(|says| says.m_points_per_s), Some(144_700.0));
        assert_eq!(says("hqs", "overview"), None);
    }

    /// A throughput is the points processed over the time, as the paper says.
    #[test]
    fn throughputs_are_of_table_1_and_2() {
        for (model, viewpoint, flat, _, m_points_per_s) in TABLE_COUNTS {
            let ms = figures("2022", model, "prefetch", "morton", viewpoint).ms[0].ms;
            // The paper's times have two digits.
            let ratio = flat[2] / ms / 1e3 / m_points_per_s;
            assert!((ratio - 1.0).abs() < 0.05, "{viewpoint}: {ratio}");
        }
    }

    #[test]
    fn names_are_ours_and_blocks_are_whole() {
        let is_ours = |name: &&str| {
            ["point-list", "lod", "lod-hqs"].contains(name) || Method::ALL.iter().any(|m| m.name() == *name)
        };
        for block in PAPER_TIMES {
            assert!(block.methods.iter().all(is_ours));
            assert_eq!(block.ms.len(), block.orders.len(), "{}", block.device);
            assert!(block.ms.iter().all(|row| row.len() == block.methods.len()), "{}", block.device);
        }
    }
}
