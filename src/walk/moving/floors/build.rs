//! Makes floors of a scan: one pass over its points, on all cores, within a bounded memory.

use super::cells::{FINE_BITS, FloorCells, MOST_COLUMNS, MOST_LAYERS};
use super::{Cell, FloorColumn, Floors, LAYERS_PER_EDGE};
use base::space::Bounds;
use base::task::{Cancelled, Progress};
use glam::DVec3;
use points::{Scan, ScanFile};
use rayon::prelude::*;
use std::sync::Mutex;

/// Edge of a column, meters, where points are dense enough.
const EDGE_M: f64 = 0.1;
/// Most cells: with their columns they take at most 60 MB.
const MOST_CELLS: usize = 3_000_000;
/// Least number of points that a column has on average.
const MEAN_COLUMN_POINTS: u64 = 4;
/// Columns are not made larger if there are no more than these.
const FEW_COLUMNS: u64 = 64;
/// Most points that are looked at; of a larger scan one of each run of points is.
const MOST_POINTS: usize = 1 << 27;
/// Points that are a task for a core.
const BLOCK: usize = 1 << 16;

/// Fine steps from world units.
struct FloorGrid {
    bounds: Bounds,
    origin: DVec3,
    /// Fine steps a world unit.
    per_unit: DVec3,
}

impl FloorGrid {
    fn fine(&self, p_in_world: DVec3) -> Option<[u64; 3]> {
        // Points outside the scene are strays.
        let inside = self.bounds.contains(p_in_world);
        inside.then(|| ((p_in_world - self.origin) * self.per_unit).to_array().map(|steps| steps as u64))
    }
}

impl Floors {
    /// Makes the floors of a scan's scene, where `units_per_m` world units are a meter of the user's.
    ///
    /// # Errors
    /// Somebody asked for an end.
    pub fn of(scan: &Scan, units_per_m: f64, progress: &Progress) -> Result<Self, Cancelled> {
        Self::with_limit(scan, units_per_m, MOST_CELLS, progress)
    }

    pub(super) fn with_limit(
        scan: &Scan,
        units_per_m: f64,
        most_cells: usize,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let bounds = if scan.scene.is_empty() { scan.bounds() } else { scan.scene.bounds };
        if bounds.is_empty() || !(bounds.size() / units_per_m).is_finite() {
            return Ok(Self::none(units_per_m));
        }
        let edge = EDGE_M * units_per_m;
        let fine_per_edge = f64::from(1 << FINE_BITS);
        let per_unit = DVec3::new(1.0, 1.0, LAYERS_PER_EDGE) * fine_per_edge / edge;
        let grid = FloorGrid { bounds, origin: bounds.min - edge, per_unit };
        let size = bounds.size() / edge + 2.0;
        let is_too_large = |level: u32| {
            let smaller = size / 2f64.powi(level as i32);
            smaller.x.max(smaller.y) > MOST_COLUMNS || smaller.z * LAYERS_PER_EDGE > MOST_LAYERS
        };
        let Some(level) = (0..40).find(|&level| !is_too_large(level)) else {
            return Ok(Self::none(units_per_m));
        };
        let cells = Mutex::new(FloorCells::new(level));
        let run = scan.num_points().div_ceil(MOST_POINTS).max(1);
        for file in &scan.files {
            add(file, &grid, run, &cells, most_cells, progress)?;
        }
        progress.check()?;
        // No thread has panicked while it had the lock, or the panic would have come here.
        let cells = cells.into_inner().expect("no thread has panicked");
        let (level, sorted) = cells.sorted(MEAN_COLUMN_POINTS, FEW_COLUMNS);
        let edge = edge * 2f64.powi(level as i32);
        let mut floors = Self { origin: grid.origin, edge, ..Self::none(units_per_m) };
        let mut last_column = None;
        let steps = (1u64 << (FINE_BITS + level)) as f64;
        for (key, sums) in sorted {
            let [x, y, layer] = key.xyz();
            if last_column != Some(key.column()) {
                last_column = Some(key.column());
                while floors.rows.len() as u64 <= y {
                    floors.rows.push(floors.columns.len() as u32);
                }
                floors.columns.push(FloorColumn { x: x as u32, first: floors.cells.len() as u32, peak: 0.0 });
            }
            // Coordinates were rounded down to steps.
            let share = |axis: usize| (sums.offset[axis] as f64 / sums.num as f64 + 0.5) / steps;
            floors.cells.push(Cell {
                layer: layer as u16,
                z: (share(2) * 65_536.0) as u16,
                x: (share(0) * 256.0) as u8,
                y: (share(1) * 256.0) as u8,
                num: sums.num.min(u16::MAX.into()) as u16,
            });
        }
        floors.rows.push(floors.columns.len() as u32);
        floors.top_layer = floors.cells.iter().map(|cell| i64::from(cell.layer)).max().unwrap_or(0);
        floors.find_peaks();
        Ok(floors)
    }

    /// Finds how many points each column has in its densest two layers.
    fn find_peaks(&mut self) {
        let ends: Vec<usize> = self.columns.iter().skip(1).map(|column| column.first as usize).collect();
        let ends = ends.into_iter().chain([self.cells.len()]);
        for (column, end) in self.columns.iter_mut().zip(ends) {
            let cells = &self.cells[column.first as usize..end];
            let alone = cells.iter().map(|cell| u32::from(cell.num)).max().unwrap_or(0);
            let pairs = cells.windows(2).filter(|pair| pair[1].layer == pair[0].layer + 1);
            let pairs = pairs.map(|pair| u32::from(pair[0].num) + u32::from(pair[1].num));
            column.peak = pairs.max().unwrap_or(0).max(alone) as f32;
        }
    }
}

/// Adds a file's points to the cells: one of each `run` of them, and none of noise.
fn add(
    file: &ScanFile,
    grid: &FloorGrid,
    run: usize,
    cells: &Mutex<FloorCells>,
    most_cells: usize,
    progress: &Progress,
) -> Result<(), Cancelled> {
    let xyz = &file.points.xyz;
    let golden = |number: usize| (number as f64 * 0.618_033_988_749_895).fract();
    let at = |number: usize| (number * run + (golden(number) * run as f64) as usize).min(xyz.len() - 1);
    let num = xyz.len().div_ceil(run);
    let num_blocks = num.div_ceil(BLOCK);
    (0..num_blocks).into_par_iter().try_for_each(|block| {
        progress.check()?;
        // A thread that panicked while it had the lock would have ended all.
        let level = cells.lock().expect("no thread has panicked").level;
        let mut own = FloorCells::new(level);
        let numbers = (block * BLOCK..num.min((block + 1) * BLOCK)).map(at);
        for number in numbers.filter(|&number| !file.points.noise.get(number)) {
            if let Some(fine) = grid.fine(file.grid.p_in_world(xyz[number])) {
                own.add(fine);
            }
        }
        progress.add(BLOCK.min(num - block * BLOCK) as u64);
        cells.lock().expect("no thread has panicked").merge(&own, most_cells);
        Ok(())
    })
}
