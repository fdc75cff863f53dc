//! Reads and compares pictures that the runtime's compositor shows on the virtual screen.

use std::io;
use std::path::Path;

/// A pixel that is not the same in two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Place of the pixel: x, y from the top left.
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
    /// Reads an XWD file, as Xvfb keeps its screen.
    pub fn read_xwd(path: &Path) -> io::Result<Self> {
        let crate::xwd::Xwd { size, pixels } = crate::xwd::read(path)?;
        Ok(Self { size, pixels })
    }

    /// Makes a picture from tightly packed red, green, blue, alpha; alpha is dropped.
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
