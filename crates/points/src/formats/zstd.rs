//! Zstandard data, frame after frame, as one stream.

use crate::guard;
use ruzstd::decoding::BlockDecodingStrategy;
use ruzstd::decoding::FrameDecoder;
use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use std::io::{self, BufRead, Read};

/// Largest window of earlier bytes that a frame may ask to be kept; `zstd` without `--long` asks for 8 MiB at most.
pub(super) const MOST_WINDOW: u64 = 128 << 20;

/// Unpacks what a reader has. The decoder's own panics become errors.
pub(super) struct ZstdReader<R> {
    packed: R,
    decoder: FrameDecoder,
    is_in_frame: bool,
}

impl<R: BufRead> ZstdReader<R> {
    /// A reader of all frames, which may ask for windows of so many bytes.
    pub fn new(packed: R, most_window: u64) -> Self {
        let mut decoder = FrameDecoder::new();
        decoder.set_max_window_size(most_window.min(MOST_WINDOW));
        Self { packed, decoder, is_in_frame: false }
    }

    /// Begins the next frame; false if there is none.
    fn begin(&mut self) -> io::Result<bool> {
        loop {
            if self.packed.fill_buf()?.is_empty() {
                return Ok(false);
            }
            match self.decoder.reset(&mut self.packed) {
                Ok(()) => return Ok(true),
                Err(FrameDecoderError::ReadFrameHeaderError(ReadFrameHeaderError::SkipFrame {
                    length,
                    ..
                })) => {
                    io::copy(&mut (&mut self.packed).take(length.into()), &mut io::sink())?;
                }
                Err(error) => return Err(io::Error::other(error)),
            }
        }
    }

    fn next(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if buffer.is_empty() {
            return Ok(0);
        }
        loop {
            if !self.is_in_frame {
                if !self.begin()? {
                    return Ok(0);
                }
                self.is_in_frame = true;
            }
            if self.decoder.can_collect() > 0 {
                return self.decoder.read(buffer);
            }
            if self.decoder.is_finished() {
                self.is_in_frame = false;
                let sums = (self.decoder.get_checksum_from_data(), self.decoder.get_calculated_checksum());
                if let (Some(stated), Some(found)) = sums
                    && stated != found
                {
                    return Err(io::Error::other("its checksum does not match"));
                }
                continue;
            }
            let blocks = BlockDecodingStrategy::UptoBlocks(1);
            self.decoder.decode_blocks(&mut self.packed, blocks).map_err(io::Error::other)?;
        }
    }
}

impl<R: BufRead> Read for ZstdReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        guard::catch(|| self.next(buffer)).unwrap_or_else(|panic| Err(io::Error::other(panic)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};

    fn unpacked(packed: &[u8]) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        ZstdReader::new(packed, MOST_WINDOW).take(1 << 24).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    #[test]
    fn frames_follow_each_other_and_notes_are_skipped() {
        let text: Vec<u8> = (0..300_000u32).map(|number| (number / 7) as u8).collect();
        let frame = compress_to_vec(&text[..], CompressionLevel::Fastest);
        let note = [&[0x50, 0x2a, 0x4d, 0x18, 3, 0, 0, 0][..], b"abc"].concat();
        let packed = [&frame[..], &note, &frame].concat();
        assert_eq!(unpacked(&packed).unwrap(), [&text[..], &text].concat());
        assert!(unpacked(&[]).unwrap().is_empty());
        assert!(unpacked(&frame[..frame.len() / 2]).is_err());
        assert!(unpacked(b"no frame at all").is_err());
        // Damage never panics.
        for at in 0..frame.len().min(2000) {
            let mut damaged = frame.clone();
            damaged[at] ^= 0x41;
            let _ = unpacked(&damaged);
        }
    }
}
