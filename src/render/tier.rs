//! Which tier of atomics the frame uses: the GPU's best, or what the settings say.

use crate::config::Tier;
use crate::gpu::{Atomics, Gpu};

/// A tier was asked for that the GPU does not have.
#[derive(Debug, thiserror::Error)]
#[error("gpu.tier: the GPU '{name}' has no {wanted}; its best is {best}, and \"auto\" takes that")]
pub struct NoSuchTier {
    name: String,
    wanted: &'static str,
    best: &'static str,
}

/// The tier to draw with.
///
/// # Errors
/// If the GPU does not have the one that is asked for.
pub fn tier(gpu: &Gpu, wanted: Tier) -> Result<Atomics, NoSuchTier> {
    let best = gpu.atomics();
    let wanted = match wanted {
        Tier::Auto => best,
        Tier::Int64 => Atomics::Int64,
        Tier::Int64Minmax => Atomics::Int64Minmax,
        Tier::Int32 => Atomics::Int32,
    };
    if wanted > best {
        return Err(NoSuchTier { name: gpu.name(), wanted: wanted.name(), best: best.name() });
    }
    Ok(wanted)
}
