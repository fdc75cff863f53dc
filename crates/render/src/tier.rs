//! Which tier of atomics the frame uses: the GPU's best, or what is asked for.

use crate::gpu::{Atomics, Gpu};

/// The error that more is asked for than the GPU has.
#[derive(Debug, thiserror::Error)]
#[error("the GPU '{name}' has no {wanted}; its best is {best}")]
pub struct NoSuchTier {
    /// The GPU.
    name: String,
    /// Name of the tier that was asked for.
    wanted: &'static str,
    /// Name of the GPU's best tier.
    best: &'static str,
}

/// The tier to draw with: `wanted`, if the GPU has it; the GPU's best if none is wanted.
///
/// # Errors
/// If the GPU does not have the one that is asked for.
pub fn tier(gpu: &Gpu, wanted: Option<Atomics>) -> Result<Atomics, NoSuchTier> {
    let best = gpu.atomics();
    let wanted = wanted.unwrap_or(best);
    if wanted > best {
        return Err(NoSuchTier { name: gpu.name(), wanted: wanted.name(), best: best.name() });
    }
    Ok(wanted)
}
