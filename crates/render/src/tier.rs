//! Which tier of atomics the frame uses: the GPU's best, or what the settings say.

use crate::gpu::{Atomics, Gpu};
use crate::options::Tier;

/// The error that the settings ask for more than the GPU has.
#[derive(Debug, thiserror::Error)]
#[error("gpu.tier: the GPU '{name}' has no {wanted}; its best is {best}, and \"auto\" takes that")]
pub struct NoSuchTier {
    /// The GPU.
    name: String,
    /// Name of the tier that was asked for.
    wanted: &'static str,
    /// Name of the GPU's best tier.
    best: &'static str,
}

/// The tier to draw with: `wanted`, if the GPU has it.
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
