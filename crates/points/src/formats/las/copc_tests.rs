//! Small made-up COPC files, whole and broken: whatever their hierarchy says, no point is lost.

use crate::block::{Block, Trailer};
use crate::column::Column;
use crate::{Attribute, OpenHints, Projection, open};
use base::random::Rng;
use base::task::Progress;
use laz::{LasZipCompressor, LazVlrBuilder};
use std::io::Cursor;

/// First byte of the points.
const POINTS_OFFSET: usize = 1000;
/// Bytes of a header of LAS 1.4, of what comes before a record's payload, and of the info record.
const HEADER_BYTES: usize = 375;
const VLR_BYTES: usize = 54;
const INFO_BYTES: usize = 160;
/// Points of the nodes of the file, in the order of the file: the root comes last.
const NODES: [([i32; 4], usize); 4] =
    [([2, 1, 0, 3], 30), ([1, 0, 0, 1], 50), ([1, 1, 0, 0], 20), ([0, 0, 0, 0], 100)];

/// Where parts of the file lie.
#[derive(Clone, Copy)]
struct CopcPlaces {
    root_page: usize,
    further_page: usize,
    table: usize,
}

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    bytes[at..at + value.len()].copy_from_slice(value);
}

/// A point of format 6 whose x and intensity are a number.
fn point(number: usize) -> Vec<u8> {
    let mut record = vec![0; 30];
    put(&mut record, 0, &(number as i32).to_le_bytes());
    put(&mut record, 4, &(number as i32 % 7).to_le_bytes());
    put(&mut record, 12, &(number as u16).to_le_bytes());
    record[14] = 0x11;
    record
}

fn vlr(user: &str, record: u16, payload: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0; VLR_BYTES];
    put(&mut bytes, 2, user.as_bytes());
    put(&mut bytes, 18, &record.to_le_bytes());
    put(&mut bytes, 20, &(payload.len() as u16).to_le_bytes());
    [&bytes[..], payload].concat()
}

fn entry(key: [i32; 4], offset: usize, num_bytes: usize, num_points: i32) -> Vec<u8> {
    let mut bytes: Vec<u8> = key.iter().flat_map(|number| number.to_le_bytes()).collect();
    bytes.extend((offset as u64).to_le_bytes());
    bytes.extend((num_bytes as i32).to_le_bytes());
    bytes.extend(num_points.to_le_bytes());
    bytes
}

/// The file: points, table of chunks, and a hierarchy of two pages.
fn copc() -> (Vec<u8>, CopcPlaces) {
    let laz = LazVlrBuilder::default().with_point_format(6, 0).unwrap().with_variable_chunk_size().build();
    let mut laz_payload = Vec::new();
    laz.write_to(&mut laz_payload).unwrap();
    let mut packing = LasZipCompressor::new(Cursor::new(vec![0; POINTS_OFFSET]), laz).unwrap();
    packing.get_mut().set_position(POINTS_OFFSET as u64);
    let (mut first, mut ends) = (0, vec![POINTS_OFFSET + 8]);
    for (_, num) in NODES {
        let records: Vec<u8> = (first..first + num).flat_map(point).collect();
        packing.compress_many(&records).unwrap();
        packing.finish_current_chunk().unwrap();
        ends.push(packing.get().position() as usize);
        first += num;
    }
    packing.done().unwrap();
    let mut bytes = packing.into_inner().into_inner();
    let table = *ends.last().unwrap();
    let node = |at: usize| {
        let (key, num) = NODES[at];
        entry(key, ends[at], ends[at + 1] - ends[at], num as i32)
    };
    let further_page = bytes.len();
    bytes.extend([node(1), node(0)].concat());
    let root_page = bytes.len();
    bytes.extend([node(3), node(2), entry([1, 0, 0, 1], further_page, 64, -1)].concat());
    bytes.extend(entry([1, 1, 1, 1], 0, 0, 0));
    let mut header = vec![0; HEADER_BYTES];
    put(&mut header, 0, b"LASF");
    put(&mut header, 24, &[1, 4]);
    put(&mut header, 94, &(HEADER_BYTES as u16).to_le_bytes());
    put(&mut header, 96, &(POINTS_OFFSET as u32).to_le_bytes());
    put(&mut header, 100, &2u32.to_le_bytes());
    put(&mut header, 104, &[6 | 0x80, 30, 0]);
    (0..3).for_each(|axis| put(&mut header, 131 + 8 * axis, &0.01f64.to_le_bytes()));
    put(&mut header, 247, &(first as u64).to_le_bytes());
    let mut info = vec![0; INFO_BYTES];
    put(&mut info, 32, &1f64.to_le_bytes());
    put(&mut info, 40, &(root_page as u64).to_le_bytes());
    put(&mut info, 48, &128u64.to_le_bytes());
    let head = [header, vlr("copc", 1, &info), vlr("laszip encoded", 22204, &laz_payload)].concat();
    assert!(head.len() <= POINTS_OFFSET);
    put(&mut bytes, 0, &head);
    (bytes, CopcPlaces { root_page, further_page, table })
}

fn read(bytes: &[u8]) -> Result<(Vec<Block>, Trailer), String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.copc.laz");
    std::fs::write(&path, bytes).unwrap();
    let mut blocks = Vec::new();
    let mut take = |block| {
        blocks.push(block);
        Ok(())
    };
    let want = Projection::of([Attribute::Intensity]);
    let end = open(&path, &OpenHints::default())
        .and_then(|dataset| dataset.read(&want, &mut take, &Progress::hidden()));
    end.map(|end| (blocks, end)).map_err(|error| error.to_string())
}

/// First x of each block.
fn firsts(blocks: &[Block]) -> Vec<i32> {
    blocks.iter().map(|block| block.xyz[0][0]).collect()
}

/// True if all points are there, each once, with its intensity.
fn has_all(blocks: &[Block]) -> bool {
    let mut all = [false; 200];
    for block in blocks {
        let Some(Column::U16(intensity)) = block.column(&Attribute::Intensity) else { return false };
        for (xyz, intensity) in block.xyz.iter().zip(intensity) {
            let is_new = !std::mem::replace(&mut all[xyz[0] as usize], true);
            if !is_new || xyz[0] != i32::from(*intensity) {
                return false;
            }
        }
    }
    all.iter().all(|found| *found)
}

#[test]
fn nodes_come_breadth_first_from_all_pages() {
    let (blocks, end) = read(&copc().0).unwrap();
    assert!(has_all(&blocks) && end.losses.is_empty() && end.warnings.is_empty(), "{end:?}");
    assert_eq!(firsts(&blocks), [100, 30, 80, 0]);
}

#[test]
fn a_damaged_hierarchy_costs_the_order_and_no_point() {
    let (whole, CopcPlaces { root_page, further_page, .. }) = copc();
    let root = (root_page as u64).to_le_bytes();
    let info = HEADER_BYTES + VLR_BYTES;
    let cases: [(usize, &[u8], &str); 11] = [
        // The root page is elsewhere or of another size, or has a node twice.
        (info + 40, &u64::MAX.to_le_bytes(), "not in the file"),
        (info + 48, &100u64.to_le_bytes(), "a page of 100 bytes"),
        (info + 48, &u64::MAX.to_le_bytes(), "not in the file"),
        (root_page + 32, &[0; 16], "node 0-0-0-0 twice"),
        // The further page is the root page, or of no size.
        (root_page + 64 + 16, &root, "twice"),
        (root_page + 64 + 24, &[0; 4], "has 120 of 200 points"),
        (root_page + 64 + 28, &[0; 4], "has 120 of 200 points"),
        // Nodes that cannot be, that overlap, and that are too long.
        (further_page, &[0xff; 4], "which cannot be"),
        (further_page + 16, &(POINTS_OFFSET as u64 + 9).to_le_bytes(), "overlap"),
        (root_page + 24, &i32::MAX.to_le_bytes(), "beyond the file's end"),
        (root_page + 28, &(-5i32).to_le_bytes(), "points of -5"),
    ];
    for (at, value, words) in cases {
        let mut bytes = whole.clone();
        put(&mut bytes, at, value);
        let (blocks, end) = read(&bytes).unwrap();
        assert!(has_all(&blocks) && end.losses.is_empty(), "{words}: {end:?}");
        assert_eq!(firsts(&blocks), [0, 30, 80, 100], "{words}");
        assert!(end.warnings[0].starts_with("is COPC, but its hierarchy"), "{end:?}");
        assert!(end.warnings[0].contains(words), "{words}: {end:?}");
    }
}

#[test]
fn the_hierarchy_takes_the_place_of_a_lost_table() {
    let (mut bytes, CopcPlaces { table, .. }) = copc();
    put(&mut bytes, POINTS_OFFSET, &[0xff; 8]);
    put(&mut bytes, table, &[0xff; 8]);
    let (blocks, end) = read(&bytes).unwrap();
    assert!(has_all(&blocks), "{end:?}");
    assert_eq!(firsts(&blocks), [100, 30, 80, 0]);
    assert!(end.warnings[0].contains("table is missing; the hierarchy"), "{end:?}");
}

#[test]
fn broken_files_never_panic() {
    let (whole, CopcPlaces { table, .. }) = copc();
    for sixteenth in 0..16 {
        let _ = read(&whole[..whole.len() * sixteenth / 16]);
    }
    let mut random = Rng::new(3, 0);
    let mut below = |end: usize| (random.bits() % end as u64) as usize;
    for number in 0..400 {
        let mut bytes = whole.clone();
        for _ in 0..1 + below(3) {
            // Half of the damage is in the hierarchy.
            let first = if number % 2 == 0 { table } else { 0 };
            let at = first + below(bytes.len() - first);
            bytes[at] ^= 1 << below(8);
        }
        let _ = read(&bytes);
    }
}
