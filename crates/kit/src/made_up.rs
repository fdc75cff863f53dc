//! Made-up scans: as files, and read.

use crate::reading;
use anyhow::Result;
use base::output::Output;
use base::task::CancelToken;
use lab::synth::{self, SynthKind, SynthOptions};
use points::Scan;
use std::path::Path;

/// Writes a made-up scan to a file that is not there yet, whose ending says its format.
///
/// # Errors
/// If there is no room for it.
pub fn file(path: &Path, kind: SynthKind, points: u64, seed: u64) -> Result<()> {
    let out = Output::new(path, synth::SCAN)?;
    synth::write(&SynthOptions { kind, out, points, seed }, &CancelToken::default())?;
    Ok(())
}

/// A made-up scan, read from a file that was written for it.
///
/// # Errors
/// If there is no room for the file.
pub fn scan(kind: SynthKind, points: u64, seed: u64) -> Result<Scan> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("made-up.las");
    file(&path, kind, points, seed)?;
    Ok(reading::file(&path)?)
}
