//! Reads XWD files, in which Xvfb keeps its screen: a header of big-endian words, a color table, rows of pixels.

use crate::picture::Picture;
use std::io;
use std::path::Path;

/// Reads a file of 32 bits a pixel, blue first: a whole screen.
pub fn read(path: &Path) -> io::Result<Picture> {
    let bytes = std::fs::read(path)?;
    let word = |index: usize| -> io::Result<usize> {
        let at = bytes.get(4 * index..4 * index + 4).ok_or(io::ErrorKind::UnexpectedEof)?;
        Ok(u32::from_be_bytes([at[0], at[1], at[2], at[3]]) as usize)
    };
    let (header, width, height) = (word(0)?, word(4)?, word(5)?);
    let (bits, row_bytes, num_colors) = (word(11)?, word(12)?, word(19)?);
    assert_eq!(bits, 32, "bits a pixel");
    let rows = bytes.get(header + 12 * num_colors..).ok_or(io::ErrorKind::UnexpectedEof)?;
    let mut pixels = Vec::with_capacity(width * height);
    for row in rows.chunks_exact(row_bytes).take(height) {
        pixels.extend(row[..4 * width].chunks_exact(4).map(|bgra| [bgra[2], bgra[1], bgra[0]]));
    }
    if pixels.len() != width * height {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    Ok(Picture { width, height, pixels })
}
