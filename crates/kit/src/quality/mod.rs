//! How good pictures are: figures of a picture beside the truth, while the head moves, and holes by the angle from the
//! gaze. The benchmark `quality` prints them, tests bound them.

pub mod figures;
pub mod holes;
pub mod metrics;
pub mod motion;
pub mod picture;
pub mod scene;
pub mod supersample;

#[cfg(test)]
mod figures_tests;
#[cfg(test)]
mod metrics_tests;
#[cfg(test)]
mod motion_tests;
#[cfg(test)]
mod supersample_tests;
