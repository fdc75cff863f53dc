//! Scan to cloud.
use super::{Cloud, Order};
use crate::progress::Progress;
use crate::scan::Scan;
/// Builds the cloud.
pub fn build(_scan: Scan, _order: Order, _progress: &Progress) -> Option<Cloud> {
    None
}
