//! GPU to CPU.
