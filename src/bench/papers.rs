//! What the papers measured, to stand beside our rows. Their scans are others: factors can be compared, milliseconds
//! cannot.

/// A figure of a paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperFigure {
    /// Milliseconds of a frame, or of the named part.
    pub ms: f64,
    /// The GPU, and the scan.
    pub device: &'static str,
}

const RETZ: &str = "RTX 3090, Retz, 145 M points";
const OUTSIDE: &str = "RTX 3090, Banyunibo outside, 529 M points";
const INSIDE: &str = "RTX 3090, Banyunibo inside, 529 M points";
const VR: &str = "RTX 3090, Banyunibo, 529 M points, Valve Index at 2 × 2478 × 2740";

/// Columns of [2021, table 5].
const METHODS_2021: [&str; 10] = [
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
const ORDERS: [&str; 4] = ["original", "morton", "shuffled", "shuffled-morton"];
/// [2021, table 5]: Retz from three viewpoints, a row an order.
#[expect(clippy::approx_constant, reason = "a time in milliseconds that looks like π")]
const TABLE_2021: [(&str, [[f64; 10]; 4]); 3] = [
    (
        "outside-frustum",
        [
            [6.13, 2.89, 2.89, 2.96, 2.89, 2.95, 2.88, 2.87, 5.70, 5.74],
            [6.20, 2.90, 2.89, 2.95, 2.89, 2.96, 2.89, 2.87, 5.69, 5.73],
            [6.19, 2.90, 2.90, 2.95, 2.90, 2.96, 2.89, 2.88, 5.68, 5.73],
            [6.21, 2.90, 2.89, 2.95, 2.90, 2.97, 2.90, 2.87, 5.69, 5.75],
        ],
    ),
    (
        "close-up",
        [
            [31.95, 5.07, 3.88, 3.81, 3.37, 3.06, 7.76, 2.92, 8.43, 6.91],
            [32.26, 5.01, 3.85, 3.76, 3.34, 3.07, 7.76, 2.93, 8.38, 6.86],
            [30.71, 8.95, 8.93, 6.10, 5.37, 6.09, 5.59, 4.13, 16.06, 13.50],
            [8.22, 3.75, 3.41, 3.46, 3.30, 3.55, 3.88, 3.16, 7.12, 6.62],
        ],
    ),
    (
        "overview",
        [
            [153.22, 21.45, 4.29, 5.15, 3.33, 3.04, 16.66, 2.92, 12.06, 7.90],
            [152.96, 19.83, 4.28, 5.59, 3.37, 3.05, 20.05, 2.92, 11.85, 7.97],
            [39.52, 10.14, 10.20, 5.64, 5.47, 5.57, 6.30, 6.57, 20.01, 16.23],
            [25.90, 6.13, 3.47, 3.32, 3.24, 3.42, 4.13, 3.14, 8.51, 6.78],
        ],
    ),
];

/// [2022, table 1]: Banyunibo from outside and inside.
const TABLE_2022: [(&str, f64, f64); 6] = [
    ("point-list", 198.3, 67.9),
    ("basic", 4.2, 2.6),
    ("prefetch", 3.3, 2.2),
    ("hqs", 9.0, 6.1),
    ("lod", 1.3, 2.1),
    ("lod-hqs", 3.3, 4.6),
];

/// [2022 §4.3].
const TABLE_VR: [(&str, f64); 7] = [
    ("depth-both-eyes", 1.7),
    ("depth-one-eye", 1.3),
    ("color-both-eyes", 2.5),
    ("color-one-eye", 1.5),
    ("resolve", 2.7),
    ("clear", 0.6),
    ("total", 8.3),
];

/// The paper's figure for a row.
#[must_use]
pub fn figure(table: &str, method: &str, order: &str, viewpoint: &str) -> Option<PaperFigure> {
    match table {
        "2021" => {
            let column = METHODS_2021.iter().position(|&name| name == method)?;
            let row = ORDERS.iter().position(|&name| name == order)?;
            let (_, rows) = TABLE_2021.iter().find(|(name, _)| *name == viewpoint)?;
            Some(PaperFigure { ms: rows[row][column], device: RETZ })
        }
        "2022" => {
            let &(_, outside, inside) = TABLE_2022.iter().find(|(name, ..)| *name == method)?;
            match viewpoint {
                "overview" => Some(PaperFigure { ms: outside, device: OUTSIDE }),
                "close-up" => Some(PaperFigure { ms: inside, device: INSIDE }),
                _ => None,
            }
        }
        // The paper's size alone.
        "vr" if viewpoint.ends_with("2478x2740") => {
            let &(_, ms) = TABLE_VR.iter().find(|(name, _)| *name == method)?;
            Some(PaperFigure { ms, device: VR })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::Method;

    #[test]
    fn figures_are_found_where_the_papers_have_them() {
        let ms = |table, method, order, viewpoint| figure(table, method, order, viewpoint).map(|f| f.ms);
        assert_eq!(ms("2021", "dedup", "morton", "close-up"), Some(3.07));
        assert_eq!(ms("2021", "point-list", "shuffled", "overview"), Some(39.52));
        assert_eq!(ms("2022", "lod-hqs", "morton", "close-up"), Some(4.6));
        assert_eq!(ms("vr", "resolve", "octree", "overview 2478x2740"), Some(2.7));
        assert_eq!(ms("vr", "resolve", "octree", "overview 1440x1600"), None);
        assert_eq!(ms("2021", "hqs1", "morton", "overview"), None);
        assert_eq!(ms("2022", "lod", "morton", "outside-frustum"), None);
    }

    #[test]
    fn names_are_ours() {
        let is_ours = |name: &&str| *name == "point-list" || Method::ALL.iter().any(|m| m.name() == *name);
        assert!(METHODS_2021.iter().all(is_ours));
    }
}
