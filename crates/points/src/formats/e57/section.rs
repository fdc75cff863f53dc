//! Finds where the points of a scan are: packets, each with some bytes of every stream.
//!
//! The numbers of a stream go on from packet to packet, and packets need not have equally many of all streams. So the
//! packets' heads tell where each byte of a stream is, and any part of the points can be read by itself.

use super::description::E57Scan;
use super::pages::{Content, Pages};
use super::stream::PackedNumbers;
use crate::ScanError;
use base::task::Progress;
use std::ops::Range;

/// Bytes of a section's head.
const SECTION_HEAD_BYTES: u64 = 32;
/// Bytes of a data packet's head, before the sizes of its parts.
const PACKET_HEAD_BYTES: u64 = 6;
/// First byte of a section of points, and of the packets in it.
const SECTION: u8 = 1;
const INDEX_PACKET: u8 = 0;
const DATA_PACKET: u8 = 1;
const IGNORED_PACKET: u8 = 2;
/// Most points of a scan whose streams have no bytes at all, because all values are the same.
pub(super) const MOST_CONSTANT: u64 = 1 << 16;

/// Where the points of a scan are.
#[derive(Clone, Debug, Default)]
pub(super) struct PointSection {
    num_streams: usize,
    /// Logical places of the packets' parts for the first stream.
    starts: Vec<u64>,
    /// For each packet and each stream, the bytes of the stream before the packet; at the end, those of all packets.
    bytes_before: Vec<u64>,
    /// Points of which all streams have their bytes.
    pub num_points: u64,
    /// Why there are no more packets, as the end of a sentence, if there should be.
    pub end: Option<String>,
}

/// Some points' numbers of one stream.
#[derive(Debug)]
pub(super) struct Fetched {
    pub numbers: PackedNumbers,
    /// Points, counted from the first of these, whose numbers are damaged.
    pub damaged: Vec<Range<usize>>,
}

/// Most points that a scan of so many announced can have in a file of this logical size.
pub(super) fn most_points(scan: &E57Scan, file_bytes: u64) -> u64 {
    let bits: u64 = scan.streams.iter().map(|stream| u64::from(stream.encoding.bits())).sum();
    let most = (file_bytes * 8).checked_div(bits).unwrap_or(MOST_CONSTANT);
    scan.announced.min(most)
}

impl PointSection {
    /// A section without points, and why it has none.
    pub fn none(reason: &str) -> Self {
        Self { end: Some(reason.to_owned()), ..Self::default() }
    }

    /// Follows the packets of a scan.
    ///
    /// # Errors
    /// The system cannot read the file, or the user stops it.
    pub fn find(pages: &Pages, scan: &E57Scan, progress: &Progress) -> Result<Self, ScanError> {
        let num_streams = scan.streams.len();
        let mut section = Self { num_streams, ..Self::default() };
        if num_streams == 0 || scan.announced == 0 {
            return Ok(section);
        }
        let mut sizes = vec![0; num_streams];
        let mut totals = vec![0; num_streams];
        match range(pages, scan)? {
            Ok(places) => {
                let mut at = places.start;
                while section.points_of(scan, &totals) < scan.announced {
                    progress.check()?;
                    if at >= places.end {
                        section.end =
                            Some(if at >= pages.len() { "the file ends" } else { "its packets end" }.into());
                        break;
                    }
                    match packet(pages, at, &mut sizes)? {
                        Some(FoundPacket::Data(num_bytes)) => {
                            section.starts.push(at + PACKET_HEAD_BYTES + 2 * num_streams as u64);
                            section.bytes_before.extend_from_slice(&totals);
                            totals
                                .iter_mut()
                                .zip(&sizes)
                                .for_each(|(total, size)| *total += u64::from(*size));
                            at += num_bytes;
                        }
                        Some(FoundPacket::Other(num_bytes)) => at += num_bytes,
                        None if at + PACKET_HEAD_BYTES > pages.len() => at = pages.len(),
                        None => {
                            section.end = Some(format!("a packet at byte {} is damaged", pages.physical(at)));
                            break;
                        }
                    }
                }
            }
            Err(reason) => section.end = Some(reason),
        }
        // A packet that the file cuts off has only some of its bytes.
        if let Some(&start) = section.starts.last() {
            let mut left = pages.len().saturating_sub(start);
            let last = section.bytes_before.len() - num_streams;
            for (total, before) in totals.iter_mut().zip(&section.bytes_before[last..]) {
                let size = *total - before;
                *total = before + size.min(left);
                left = left.saturating_sub(size);
            }
        }
        section.num_points = section.points_of(scan, &totals).min(scan.announced);
        section.bytes_before.extend_from_slice(&totals);
        Ok(section)
    }

    /// Points of which all streams have their bytes, if they have these many.
    fn points_of(&self, scan: &E57Scan, totals: &[u64]) -> u64 {
        let bits = scan.streams.iter().map(|stream| u64::from(stream.encoding.bits()));
        let points =
            totals.iter().zip(bits).filter_map(|(total, bits)| total.saturating_mul(8).checked_div(bits));
        points.min().unwrap_or(MOST_CONSTANT)
    }

    fn num_packets(&self) -> usize {
        self.starts.len()
    }

    /// Bytes of a stream before a packet.
    fn before(&self, packet: usize, stream: usize) -> u64 {
        self.bytes_before[packet * self.num_streams + stream]
    }

    /// Reads the numbers of one stream for some points.
    ///
    /// # Errors
    /// The system cannot read the file.
    pub fn fetch(
        &self,
        pages: &Pages,
        scan: &E57Scan,
        stream: usize,
        points: Range<u64>,
    ) -> Result<Fetched, ScanError> {
        let encoding = scan.streams[stream].encoding;
        let bits = u64::from(encoding.bits());
        let (first_bit, end_bit) = (points.start * bits, points.end * bits);
        let (mut at, end) = (first_bit / 8, end_bit.div_ceil(8));
        let mut bytes: Vec<u8> = Vec::with_capacity((end - at) as usize);
        let (first_byte, mut damaged_bytes) = (at, Vec::new());
        // The first packet that has bytes behind `at`.
        let is_before = |packet: usize| self.before(packet + 1, stream) <= at;
        let mut packet = first_that_is_not(self.num_packets(), is_before);
        while at < end && packet < self.num_packets() {
            let (from, to) = (self.before(packet, stream), self.before(packet + 1, stream));
            let num_bytes = to.min(end) - at;
            if num_bytes > 0 {
                let sizes_before =
                    (0..stream).map(|other| self.before(packet + 1, other) - self.before(packet, other));
                let place = self.starts[packet] + sizes_before.sum::<u64>() + at - from;
                let Content { bytes: read, damaged } = pages.read(place, num_bytes)?;
                let before = bytes.len();
                damaged_bytes.extend(damaged.iter().map(|range| before + range.start..before + range.end));
                let num_read = read.len();
                bytes.extend(read);
                // The file was longer when it was opened.
                if (num_read as u64) < num_bytes {
                    bytes.resize(before + num_bytes as usize, 0);
                    damaged_bytes.push(before + num_read..bytes.len());
                }
                at += num_bytes;
            }
            packet += 1;
        }
        let num_points = (points.end - points.start) as usize;
        let of_point = |bit: u64| bit.saturating_sub(first_bit).checked_div(bits).unwrap_or(0) as usize;
        let damaged = damaged_bytes.into_iter().map(|range| {
            let [start, end] = [range.start, range.end].map(|byte| 8 * (first_byte + byte as u64));
            of_point(start)..(of_point(end.saturating_sub(1)) + 1).min(num_points)
        });
        let damaged = damaged.collect();
        Ok(Fetched {
            numbers: PackedNumbers::new(encoding, bytes, (first_bit % 8) as usize, num_points),
            damaged,
        })
    }
}

/// The first number up to `num` for which `is_before` is false, which it stays from there on.
fn first_that_is_not(num: usize, is_before: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, num);
    while low < high {
        let middle = low + (high - low) / 2;
        if is_before(middle) { low = middle + 1 } else { high = middle }
    }
    low
}

/// Logical places of a scan's packets, or why there are none.
fn range(pages: &Pages, scan: &E57Scan) -> Result<Result<Range<u64>, String>, ScanError> {
    let behind = |what: &str, place: u64| {
        Ok(Err(format!(
            "{what} (byte {place}) {}",
            if place >= pages.source.len() { "is behind the file's end" } else { "makes no sense" }
        )))
    };
    let Some(start) = pages.logical(scan.offset) else {
        return behind("the place of its points", scan.offset);
    };
    let head = pages.read(start, SECTION_HEAD_BYTES)?;
    if (head.bytes.len() as u64) < SECTION_HEAD_BYTES {
        return Ok(Err("the file ends".into()));
    }
    let long = |at: usize| head.bytes[at..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
    if head.bytes[0] != SECTION {
        return Ok(Err(format!("byte {} does not begin a section of points", scan.offset)));
    }
    // Packets follow the head, if the head does not say where they are.
    let first = match long(16) {
        0 => start + SECTION_HEAD_BYTES,
        physical => match pages.logical(physical) {
            Some(first) => first,
            None => return behind("the place of its first packet", physical),
        },
    };
    let stated = start.saturating_add(long(8));
    let end = if stated > first && stated <= pages.len() { stated } else { pages.len() };
    Ok(Ok(first..end))
}

/// A packet that was found, and its size.
enum FoundPacket {
    Data(u64),
    Other(u64),
}

/// Reads the head of a packet, and the sizes of its parts; `None` if there is none.
fn packet(pages: &Pages, at: u64, sizes: &mut [u16]) -> Result<Option<FoundPacket>, ScanError> {
    let head_bytes = PACKET_HEAD_BYTES + 2 * sizes.len() as u64;
    let Content { bytes, damaged } = pages.read(at, head_bytes)?;
    let Some([kind, _, low, high]) = bytes.first_chunk() else { return Ok(None) };
    let num_bytes = u64::from(u16::from_le_bytes([*low, *high])) + 1;
    if !num_bytes.is_multiple_of(4) {
        return Ok(None);
    }
    match *kind {
        INDEX_PACKET | IGNORED_PACKET => return Ok(Some(FoundPacket::Other(num_bytes))),
        DATA_PACKET if bytes.len() as u64 == head_bytes => {}
        _ => return Ok(None),
    }
    let mut words = bytes[4..].chunks_exact(2).map(|word| u16::from_le_bytes([word[0], word[1]]));
    let num_parts = words.next();
    sizes.iter_mut().zip(words).for_each(|(size, word)| *size = word);
    let needed = head_bytes + sizes.iter().map(|size| u64::from(*size)).sum::<u64>();
    // A head whose page is damaged is believed if its numbers agree.
    let is_right =
        if damaged.is_empty() { needed <= num_bytes } else { needed.next_multiple_of(4) == num_bytes };
    Ok((num_parts.map(usize::from) == Some(sizes.len()) && is_right).then_some(FoundPacket::Data(num_bytes)))
}
