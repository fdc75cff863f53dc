//! Which tier of atomics the frame uses: the GPU's best, or what the settings say.

use crate::gpu::{Atomics, Gpu};
use crate::look::Look;
use crate::method::Method;
use crate::options::Tier;

/// What the settings ask for is more than the GPU has.
#[derive(Debug, thiserror::Error)]
pub enum NoSuchTier {
    /// The tier.
    #[error("gpu.tier: the GPU '{name}' has no {wanted}; its best is {best}, and \"auto\" takes that")]
    Tier {
        /// The GPU.
        name: String,
        /// Asked for.
        wanted: &'static str,
        /// What there is.
        best: &'static str,
    },
    /// The method's arithmetic.
    #[error("frame.method: {method} counts in f64, which the shaders of the GPU '{name}' cannot")]
    F64 {
        /// The GPU.
        name: String,
        /// Asked for.
        method: &'static str,
    },
    /// The method and what it is to draw.
    #[error(
        "frame.method: {method} draws points of one pixel, and a point tree has discs and triangles; set lod.method = \"octree\""
    )]
    Sizes {
        /// Asked for.
        method: &'static str,
    },
    /// The method.
    #[error("frame.method: {method} needs the tier int64, and this is {tier}; prefetch runs in every tier")]
    Method {
        /// Asked for.
        method: &'static str,
        /// What there is.
        tier: &'static str,
    },
}

/// The tier to draw with: `wanted`, if the GPU has it and `look` can be drawn in it.
///
/// # Errors
/// If the GPU does not have the one that is asked for, or the method needs a better one.
pub fn tier(gpu: &Gpu, wanted: Tier, look: &Look) -> Result<Atomics, NoSuchTier> {
    let best = gpu.atomics();
    let wanted = match wanted {
        Tier::Auto => best,
        Tier::Int64 => Atomics::Int64,
        Tier::Int64Minmax => Atomics::Int64Minmax,
        Tier::Int32 => Atomics::Int32,
    };
    if wanted > best {
        return Err(NoSuchTier::Tier { name: gpu.name(), wanted: wanted.name(), best: best.name() });
    }
    let method = look.method;
    if wanted < Atomics::Int64 && method.needs_int64() {
        return Err(NoSuchTier::Method { method: method.name(), tier: wanted.name() });
    }
    if method == Method::PointList && look.draws_discs() {
        return Err(NoSuchTier::Sizes { method: method.name() });
    }
    if method == Method::Fixed40 && !gpu.has_f64() {
        return Err(NoSuchTier::F64 { name: gpu.name(), method: method.name() });
    }
    Ok(wanted)
}
