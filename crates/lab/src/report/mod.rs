//! Reports of measurements, as text for people and as HTML pages: a frame log, two logs compared, and benchmark
//! results. Text and page come from the same figures.
//!
//! ```text
//!  FRAMES.csv ──timing::read──▶ Summary ──────▶ text
//!                                  └─ walk_page: timeline · histogram · stack · steps · worst ──▶ Page (HTML)
//!  two of them ────────────────▶ Comparison (bootstrap) ──▶ text, page
//!  RESULTS.json ───────────────▶ BenchResults ──▶ text, bench_page (bars)
//! ```

mod axis;
mod bars;
mod bench_markdown;
mod bench_page;
mod bench_results;
mod bootstrap;
mod compare;
mod histogram;
mod markup;
mod page;
mod reduce;
mod stack;
mod steps;
mod summary;
mod svg;
mod table;
mod timeline;
mod walk_page;
mod worst;

pub use bench_markdown::bench_markdown;
pub use bench_page::bench_page;
pub use bench_results::{BenchError, BenchResults, BenchRow, BytesRead, GpuMs, PaperMs, PaperSays};
pub use bootstrap::Interval;
pub use compare::{Comparison, TimeDifference};
pub use summary::Summary;
pub(crate) use table::in_order;
pub use walk_page::walk_page;
pub use worst::{HOLD_S, worst, worst_poses};
