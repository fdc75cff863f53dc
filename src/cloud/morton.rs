//! Morton codes.
