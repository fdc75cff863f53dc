//! Reads and compares pictures: what the runtime's compositor shows on the virtual screen.

use std::io;
use std::path::Path;

/// A pixel that is not the same in two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// x, y; 0, 0 is top left.
    pub at: [usize; 2],
    pub here: [u8; 3],
    pub there: [u8; 3],
}

/// A picture, 8 bits a channel.
#[derive(Clone, PartialEq, Eq)]
pub struct Image {
    /// Width, height.
    pub size: [usize; 2],
    /// Red, green, blue, row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

impl Image {
    /// Reads an XWD file of 32 bits a pixel, blue first, as Xvfb keeps its screen.
    pub fn read_xwd(path: &Path) -> io::Result<Self> {
        let bytes = std::fs::read(path)?;
        let field = |index: usize| -> io::Result<usize> {
            let at = bytes.get(4 * index..4 * index + 4).ok_or(io::ErrorKind::UnexpectedEof)?;
            Ok(u32::from_be_bytes([at[0], at[1], at[2], at[3]]) as usize)
        };
        let (header, width, height) = (field(0)?, field(4)?, field(5)?);
        let (bits, row_bytes, num_colors) = (field(11)?, field(12)?, field(19)?);
        assert_eq!(bits, 32, "bits a pixel");
        let data = bytes.get(header + 12 * num_colors..).ok_or(io::ErrorKind::UnexpectedEof)?;
        let mut pixels = Vec::with_capacity(width * height);
        for row in data.chunks_exact(row_bytes).take(height) {
            pixels.extend(row[..4 * width].chunks_exact(4).map(|bgra| [bgra[2], bgra[1], bgra[0]]));
        }
        if pixels.len() != width * height {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        Ok(Self { size: [width, height], pixels })
    }

    /// Makes one from tightly packed red, green, blue, alpha; alpha is dropped.
    pub fn from_rgba(size: [usize; 2], rgba: &[u8]) -> Self {
        let pixels: Vec<_> = rgba.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect();
        assert_eq!(pixels.len(), size[0] * size[1]);
        Self { size, pixels }
    }

    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        self.pixels[y * self.size[0] + x]
    }

    /// The part that begins at `x` and is `width` wide.
    pub fn columns(&self, x: usize, width: usize) -> Self {
        let rows = self.pixels.chunks_exact(self.size[0]);
        Self {
            size: [width, self.size[1]],
            pixels: rows.flat_map(|row| &row[x..x + width]).copied().collect(),
        }
    }

    /// How many pixels differ, and the first that does.
    pub fn differences(&self, other: &Self) -> (usize, Option<Difference>) {
        assert_eq!(self.size, other.size, "sizes");
        let mut different =
            self.pixels.iter().zip(&other.pixels).enumerate().filter(|(_, (here, there))| here != there);
        let first = different.next();
        let count = usize::from(first.is_some()) + different.count();
        let place = |i: usize| [i % self.size[0], i / self.size[0]];
        (count, first.map(|(i, (&here, &there))| Difference { at: place(i), here, there }))
    }
}
