//! Writes E57 files for tests: scans of any streams, in packets of any size.

use super::super::crc::crc32c;

/// A stream of a made scan.
#[derive(Clone, Debug)]
pub struct MadeE57Stream {
    /// Its element in the prototype: `cartesianX type="Float"`.
    pub element: String,
    pub bits: u32,
    /// The bits of each number.
    pub numbers: Vec<u64>,
}

/// A scan that is to be written.
#[derive(Clone, Debug, Default)]
pub struct MadeE57Scan {
    /// What its description has beside its points.
    pub inner: String,
    pub streams: Vec<MadeE57Stream>,
    /// Points that the description announces, if that is not the number that there are.
    pub announced: Option<u64>,
}

/// A stream of floats of 64 bits.
pub fn doubles(name: &str, values: impl IntoIterator<Item = f64>) -> MadeE57Stream {
    let numbers = values.into_iter().map(f64::to_bits).collect();
    MadeE57Stream { element: format!("{name} type=\"Float\""), bits: 64, numbers }
}

/// A stream of floats of 32 bits.
pub fn singles(name: &str, values: impl IntoIterator<Item = f32>) -> MadeE57Stream {
    let numbers = values.into_iter().map(|value| value.to_bits().into()).collect();
    MadeE57Stream { element: format!("{name} type=\"Float\" precision=\"single\""), bits: 32, numbers }
}

/// A stream of whole numbers from `min` to `max`, whose values are these times `scale`.
pub fn whole(
    name: &str,
    (min, max): (i64, i64),
    scale: f64,
    values: impl IntoIterator<Item = i64>,
) -> MadeE57Stream {
    let kind = if scale == 1.0 { "Integer".to_owned() } else { format!("ScaledInteger\" scale=\"{scale}") };
    MadeE57Stream {
        element: format!("{name} minimum=\"{min}\" maximum=\"{max}\" type=\"{kind}\""),
        bits: u64::BITS - max.abs_diff(min).leading_zeros(),
        numbers: values.into_iter().map(|value| value.wrapping_sub(min) as u64).collect(),
    }
}

impl MadeE57Stream {
    fn bytes(&self) -> Vec<u8> {
        let (mut bytes, mut word, mut held) = (Vec::new(), 0u128, 0);
        for &number in &self.numbers {
            word |= u128::from(number) << held;
            held += self.bits;
            while held >= 8 {
                bytes.push(word as u8);
                word >>= 8;
                held -= 8;
            }
        }
        if held > 0 {
            bytes.push(word as u8);
        }
        bytes
    }
}

/// The logical content of a file, and where its description starts in it.
pub fn content(scans: &[MadeE57Scan], outer: &str, packet_bytes: usize) -> (Vec<u8>, usize) {
    let mut file = vec![0; 48];
    let mut data = String::new();
    for scan in scans {
        let start = file.len();
        let physical = start as u64 / 1020 * 1024 + start as u64 % 1020;
        let mut section = vec![0; 32];
        section[0] = 1;
        let first = start + 32;
        section[16..24].copy_from_slice(&(first as u64 / 1020 * 1024 + first as u64 % 1020).to_le_bytes());
        let streams: Vec<Vec<u8>> = scan.streams.iter().map(MadeE57Stream::bytes).collect();
        let mut at = vec![0; streams.len()];
        let mut packet = 0;
        while at.iter().zip(&streams).any(|(at, bytes)| *at < bytes.len()) {
            // Streams get unequal parts of a packet, and each third packet is no data.
            let mut sizes: Vec<usize> = Vec::new();
            for (number, (at, bytes)) in at.iter().zip(&streams).enumerate() {
                let share = packet_bytes / streams.len() * (1 + (number + packet) % 3) / 2;
                sizes.push(share.max(1).min(bytes.len() - at));
            }
            let unpadded = 6 + 2 * sizes.len() + sizes.iter().sum::<usize>();
            let padded = unpadded.next_multiple_of(4);
            section.extend([1, 0]);
            section.extend((padded as u16 - 1).to_le_bytes());
            section.extend((sizes.len() as u16).to_le_bytes());
            sizes.iter().for_each(|size| section.extend((*size as u16).to_le_bytes()));
            for ((at, bytes), size) in at.iter_mut().zip(&streams).zip(sizes) {
                section.extend(&bytes[*at..*at + size]);
                *at += size;
            }
            section.resize(section.len() + padded - unpadded, 0);
            if packet % 3 == 2 {
                section.extend([2, 0, 7, 0, 9, 9, 9, 9]);
            }
            packet += 1;
        }
        let num_bytes = section.len() as u64;
        section[8..16].copy_from_slice(&num_bytes.to_le_bytes());
        file.extend(section);
        let num_points = scan.announced.unwrap_or(scan.streams[0].numbers.len() as u64);
        let fields: String = scan.streams.iter().map(|stream| format!("<{}/>", stream.element)).collect();
        data += &format!(
            "<vectorChild type=\"Structure\">{}<points type=\"CompressedVector\" fileOffset=\"{physical}\" \
             recordCount=\"{num_points}\"><prototype type=\"Structure\">{fields}</prototype></points></vectorChild>",
            scan.inner
        );
    }
    let text = format!(
        "<?xml version=\"1.0\"?><e57Root type=\"Structure\" xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" \
         xmlns:nor=\"http://www.libe57.org/E57_NOR_surface_normals.txt\"><data3D type=\"Vector\">{data}</data3D>{outer}\
         </e57Root>\n"
    );
    let start = file.len();
    file.extend(text.as_bytes());
    let num_pages = file.len().div_ceil(1020) as u64;
    file[..8].copy_from_slice(b"ASTM-E57");
    file[8] = 1;
    let words = [1024 * num_pages, start as u64 / 1020 * 1024 + start as u64 % 1020, text.len() as u64, 1024];
    words
        .iter()
        .enumerate()
        .for_each(|(at, word)| file[16 + 8 * at..24 + 8 * at].copy_from_slice(&word.to_le_bytes()));
    (file, start)
}

/// The content in pages with checksums.
pub fn paged(content: &[u8]) -> Vec<u8> {
    let pages = content.chunks(1020).flat_map(|page| {
        let mut page = page.to_vec();
        page.resize(1020, 0);
        let sum = crc32c(&page).to_be_bytes();
        page.extend(sum);
        page
    });
    pages.collect()
}

/// A file of these scans.
pub fn file(scans: &[MadeE57Scan]) -> Vec<u8> {
    paged(&content(scans, "", 900).0)
}
