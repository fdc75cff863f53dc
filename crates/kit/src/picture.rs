//! Pictures as files and screens hold them. PNG files are read and written here alone.

use std::io::{self, BufWriter, Cursor};
use std::path::{Path, PathBuf};

/// Red, green, blue, 0–255.
pub type Rgb = [u8; 3];

/// A picture, 8 bits a channel; rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<Rgb>,
}

/// A pixel that is not the same in two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelDifference {
    /// Place of the pixel: x, y from the top left.
    pub at: [usize; 2],
    pub here: Rgb,
    pub there: Rgb,
}

impl Picture {
    /// Reads a PNG file, as the program writes them.
    ///
    /// # Errors
    /// If it is not there, or not whole.
    pub fn read(path: &Path) -> io::Result<Self> {
        Self::decode(&std::fs::read(path)?)
    }

    /// Reads a PNG file's bytes: red, green, blue and nothing else, to the last byte.
    ///
    /// # Errors
    /// If they are not that.
    pub fn decode(bytes: &[u8]) -> io::Result<Self> {
        let mut left = Cursor::new(bytes);
        let mut reader = png::Decoder::new(&mut left).read_info()?;
        let mut rgb = vec![0; reader.output_buffer_size().ok_or(io::ErrorKind::FileTooLarge)?];
        let info = reader.next_frame(&mut rgb)?;
        reader.finish()?;
        if (info.color_type, info.bit_depth) != (png::ColorType::Rgb, png::BitDepth::Eight) {
            return Err(io::Error::other(format!(
                "a PNG of {:?}, {:?} bits",
                info.color_type, info.bit_depth
            )));
        }
        drop(reader);
        if left.position() < bytes.len() as u64 {
            return Err(io::Error::other("more follows the picture"));
        }
        let pixels = rgb.as_chunks::<3>().0.to_vec();
        Ok(Self { width: info.width as usize, height: info.height as usize, pixels })
    }

    /// Makes a picture from tightly packed red, green, blue, alpha; alpha is dropped.
    pub fn from_rgba([width, height]: [usize; 2], rgba: &[u8]) -> Self {
        let pixels: Vec<Rgb> = rgba.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect();
        assert_eq!(pixels.len(), width * height);
        Self { width, height, pixels }
    }

    pub fn at(&self, x: usize, y: usize) -> Rgb {
        self.pixels[y * self.width + x]
    }

    /// The part that begins at `x` and is `width` wide.
    pub fn columns(&self, x: usize, width: usize) -> Self {
        self.part([x, 0], [width, self.height])
    }

    /// The part that begins at `x`, `y` and is this large.
    pub fn part(&self, [x, y]: [usize; 2], [width, height]: [usize; 2]) -> Self {
        let rows = self.pixels.chunks_exact(self.width).skip(y).take(height);
        Self { width, height, pixels: rows.flat_map(|row| &row[x..x + width]).copied().collect() }
    }

    /// How many pixels of `self` differ from `other` (all, if the sizes do).
    pub fn num_different(&self, other: &Self) -> usize {
        if (self.width, self.height) != (other.width, other.height) {
            return self.pixels.len();
        }
        self.pixels.iter().zip(&other.pixels).filter(|(a, b)| a != b).count()
    }

    /// How many pixels differ from a picture of the same size, and the first that does.
    pub fn differences(&self, other: &Self) -> (usize, Option<PixelDifference>) {
        assert_eq!((self.width, self.height), (other.width, other.height), "sizes");
        let mut pairs = self.pixels.iter().zip(&other.pixels).enumerate();
        let first = pairs.find(|(_, (here, there))| here != there).map(|(i, (&here, &there))| {
            PixelDifference { at: [i % self.width, i / self.width], here, there }
        });
        (self.num_different(other), first)
    }

    /// Keeps the picture for people if SCANWALK_TEST_PICTURES names a folder.
    pub fn keep(&self, name: &str) {
        let Some(folder) = std::env::var_os("SCANWALK_TEST_PICTURES") else { return };
        let path = PathBuf::from(folder).join(format!("{name}.png"));
        write_png(&path, [self.width, self.height].map(|px| px as u32), &self.pixels).unwrap();
    }
}

/// Writes a PNG file.
///
/// # Errors
/// If the folder is not there or the disk is full.
pub fn write_png(path: &Path, [width, height]: [u32; 2], pixels: &[Rgb]) -> io::Result<()> {
    let file = BufWriter::new(std::fs::File::create(path)?);
    let mut encoder = png::Encoder::new(file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels.as_flattened())?;
    Ok(writer.finish()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_nothing_may_follow_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        let picture = Picture { width: 3, height: 2, pixels: (0..6).map(|i| [i, 2 * i, 255 - i]).collect() };
        write_png(&path, [3, 2], &picture.pixels).unwrap();
        assert_eq!(Picture::read(&path).unwrap(), picture);
        let mut bytes = std::fs::read(&path).unwrap();
        assert!(Picture::decode(&bytes[..bytes.len() - 1]).is_err(), "it is cut off");
        bytes.push(0);
        assert_eq!(Picture::decode(&bytes).unwrap_err().to_string(), "more follows the picture");
    }

    #[test]
    fn a_single_changed_bit_is_found() {
        let picture = Picture::from_rgba([3, 2], &[7; 24]);
        assert_eq!(picture.differences(&picture), (0, None));
        let mut changed = picture.clone();
        changed.pixels[4][1] ^= 1;
        let difference = PixelDifference { at: [1, 1], here: [7, 7, 7], there: [7, 6, 7] };
        assert_eq!(picture.differences(&changed), (1, Some(difference)));
        assert_eq!(changed.part([1, 1], [2, 1]).pixels, [[7, 6, 7], [7; 3]]);
    }
}
