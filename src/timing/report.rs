//! What a frame log says.
