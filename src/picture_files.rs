//! Pictures as files: colors as PNG, depths as NumPy's arrays. No file has its name yet when it comes from here.

use base::output::{Output, OutputError, OutputFile};
use render::gpu::Gpu;
use render::gpu::readback::{self, ReadbackError};
use std::io::{self, BufWriter, Write};

/// The pixels of an sRGB texture, row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RgbImage {
    size_px: [u32; 2],
    /// Red, green, blue of each pixel.
    bytes: Vec<u8>,
}

impl RgbImage {
    /// Reads a texture back from the GPU, and waits for it.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn read(gpu: &Gpu, image: &wgpu::Texture) -> Result<Self, ReadbackError> {
        let pixels = readback::read_texture(gpu, image)?;
        let [r, g, b] =
            if image.format() == wgpu::TextureFormat::Bgra8UnormSrgb { [2, 1, 0] } else { [0, 1, 2] };
        let bytes = pixels.chunks_exact(4).flat_map(|p| [p[r], p[g], p[b]]).collect();
        Ok(Self { size_px: [image.width(), image.height()], bytes })
    }
}

/// Writes colors as an 8-bit RGB PNG.
///
/// # Errors
/// If the file cannot be written.
pub fn write_png(output: &Output, image: &RgbImage) -> Result<OutputFile, OutputError> {
    write_with(output, |file| {
        let [width, height] = image.size_px;
        let mut encoder = png::Encoder::new(file, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let written = || {
            let mut writer = encoder.write_header()?;
            writer.write_image_data(&image.bytes)?;
            writer.finish()
        };
        written().map_err(io_error)
    })
}

/// The system's own error, if writing failed: whether a pipe is closed shows in it.
fn io_error(error: png::EncodingError) -> io::Error {
    match error {
        png::EncodingError::IoError(error) => error,
        error => io::Error::other(error),
    }
}

/// Writes linear depths as a NumPy array of float32, shape (H, W).
///
/// # Errors
/// If the file cannot be written.
pub fn write_npy(
    output: &Output,
    [width, height]: [u32; 2],
    depths: &[f32],
) -> Result<OutputFile, OutputError> {
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({height}, {width}), }}");
    // NumPy's format 1.0 begins with magic, version, length and dictionary. This head is padded to 64 bytes and ends
    // in a newline.
    let padded = (10 + header.len() + 1).next_multiple_of(64) - 10;
    header.push_str(&" ".repeat(padded - header.len() - 1));
    header.push('\n');
    write_with(output, |file| {
        file.write_all(b"\x93NUMPY\x01\x00")?;
        file.write_all(&(padded as u16).to_le_bytes())?;
        file.write_all(header.as_bytes())?;
        depths.iter().try_for_each(|depth| file.write_all(&depth.to_le_bytes()))
    })
}

/// Writes a whole file.
///
/// # Errors
/// If the file cannot be written.
pub fn write_with(
    output: &Output,
    write: impl FnOnce(&mut BufWriter<&mut OutputFile>) -> io::Result<()>,
) -> Result<OutputFile, OutputError> {
    let mut file = output.begin()?;
    let mut buffered = BufWriter::new(&mut file);
    let written = write(&mut buffered).and_then(|()| buffered.flush());
    drop(buffered);
    written.map(|()| file).map_err(|source| output.failed(source))
}
