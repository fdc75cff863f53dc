//! OpenXR.
