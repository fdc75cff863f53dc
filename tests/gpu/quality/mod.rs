//! The image-quality benchmark's arithmetic. A benchmark has no tests of its own, so its files are taken in here.

#[path = "../../../benches/quality/figures.rs"]
mod figures;
#[path = "../../../benches/quality/metrics.rs"]
mod metrics;
#[path = "../../../benches/quality/motion.rs"]
mod motion;
#[path = "../../../benches/quality/picture.rs"]
mod picture;
#[path = "../../../benches/quality/supersample.rs"]
mod supersample;

mod figures_tests;
mod metrics_tests;
mod motion_tests;
mod supersample_tests;
