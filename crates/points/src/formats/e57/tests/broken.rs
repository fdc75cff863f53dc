//! Tests of E57 files that are damaged, cut off, or say what is not so.

use super::made::{content, paged};
use super::*;

fn small() -> Vec<MadeE57Scan> {
    let mut streams = xyz(3000, doubles);
    streams.push(whole("rowIndex", (0, 70_000), 1.0, 0..3000));
    vec![MadeE57Scan { streams, inner: POSE.into(), announced: None }]
}

fn rows(read: &ReadE57) -> Vec<i32> {
    match read.named("rowIndex") {
        Column::U32(rows) => rows.iter().map(|&row| row as i32).collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_damaged_page_costs_only_its_points() {
    let mut bytes = file(&small());
    bytes[20 * 1024 + 500] ^= 4;
    let read = read(&bytes).unwrap();
    let rows = rows(&read);
    // A page has 1020 bytes, which are of several streams and so of different points, 8 bytes of each. Each point that is
    // left is whole.
    assert!((2750..2990).contains(&rows.len()), "{}", rows.len());
    for (p, row) in read.places().into_iter().zip(rows) {
        assert_eq!(p, posed(DVec3::from_array(place(row as usize))));
    }
    let loss = &read.trailer.losses[..];
    assert!(loss.len() == 1 && loss[0].contains("in pages whose checksum is wrong, first point"), "{loss:?}");
    // Places alone lose no points of pages that have other streams alone.
    let all_wrong: Vec<u8> =
        (0..).zip(file(&small())).map(|(at, byte)| if at % 1024 > 1019 { 0 } else { byte }).collect();
    let read = super::read(&all_wrong).unwrap();
    assert_eq!(read.block.xyz.len(), 3000);
    assert!(read.header.warnings[0].contains("wrong checksums throughout"), "{:?}", read.header.warnings);
}

#[test]
fn a_damaged_description_is_said_or_refused() {
    let (mut made, start) = content(&small(), "", 900);
    let text_at = start + 60;
    made[text_at] = b'<';
    let error = read(&paged(&made)).err().unwrap();
    assert!(
        error.contains("description (XML) that cannot be read") && error.contains("get the file again"),
        "{error}"
    );
    let mut bytes = file(&small());
    let num_bytes = bytes.len();
    bytes[num_bytes - 1] ^= 1;
    let read = read(&bytes).unwrap();
    assert_eq!((read.block.xyz.len(), read.header.warnings.len()), (3000, 1));
}

#[test]
fn what_is_announced_and_not_there_is_said() {
    for announced in [3001, 1 << 40, u64::MAX] {
        let mut scans = small();
        scans[0].announced = Some(announced);
        let read = read(&file(&scans)).unwrap();
        assert_eq!(read.block.xyz.len(), 3000);
        let loss = &read.trailer.losses[0];
        assert!(loss.starts_with("announces ") && loss.contains("of which 3000 could be found"), "{loss}");
        assert!(read.header.num_points < 20_000);
    }
    let mut scans = small();
    scans[0].announced = Some(100);
    assert_eq!(read(&file(&scans)).unwrap().block.xyz.len(), 100);
    scans[0].announced = Some(0);
    let error = |scans: &[MadeE57Scan]| read(&file(scans)).err().unwrap();
    assert!(error(&scans).contains("holds no points: its only scan announces none"), "{}", error(&scans));
    assert!(error(&[]).contains("it has no scans"), "{}", error(&[]));
    let flat = MadeE57Scan { streams: vec![doubles("cartesianX", [1.0])], ..MadeE57Scan::default() };
    assert!(error(&[flat]).contains("no coordinates are stored"));
}

#[test]
fn points_without_a_byte_are_not_believed_without_end() {
    let streams = attributes::CARTESIAN.map(|name| whole(name, (5, 5), 1.0, [5]));
    let scan = MadeE57Scan { streams: streams.to_vec(), inner: String::new(), announced: Some(u64::MAX) };
    let read = read(&file(&[scan])).unwrap();
    assert_eq!(read.block.xyz.len() as u64, section::MOST_CONSTANT);
}

#[test]
fn places_that_make_no_sense_are_said() {
    let (made, _) = content(&small(), "", 900);
    for (from, to, expected) in [
        ("fileOffset=\"48\"", "fileOffset=\"1\"", "does not begin a section"),
        ("fileOffset=\"48\"", "fileOffset=\"9999999999\"", "is behind the file's end"),
        ("fileOffset=\"48\"", "fileOffset=\"1022\"", "makes no sense"),
    ] {
        let at = made.windows(from.len()).position(|text| text == from.as_bytes()).unwrap();
        let changed = [&made[..at], to.as_bytes(), &made[at + from.len()..], &[b' '; 9]].concat();
        let mut changed = changed;
        let num_bytes = (made.len() as u64).to_le_bytes();
        changed[32..40].copy_from_slice(&num_bytes);
        let error = read(&paged(&changed)).err().unwrap();
        assert!(error.contains(expected), "{error}");
    }
    let header = |at: usize, value: u64| {
        let mut changed = made.clone();
        changed[at..at + 8].copy_from_slice(&value.to_le_bytes());
        read(&paged(&changed)).map(|read| read.block.xyz.len())
    };
    assert_eq!(header(40, 7), Ok(3000));
    assert_eq!(header(32, u64::MAX), Ok(3000));
    assert!(header(24, 1 << 50).unwrap_err().contains("within its description (XML)"));
    assert!(header(24, 3).unwrap_err().contains("xmlPhysicalOffset"));
}

#[test]
fn no_length_and_no_damage_breaks_it() {
    let mut scans = two_scans();
    for scan in &mut scans {
        scan.streams.iter_mut().for_each(|stream| stream.numbers.truncate(700));
    }
    let (made, _) = content(&scans, "<images2D><i/></images2D>", 300);
    let bytes = paged(&made);
    for part in 0..16 {
        let _ = read(&bytes[..bytes.len() * part / 16 + part]);
    }
    // The checksums are made again, so that they hide nothing.
    let mut random = base::random::Rng::new(5, 0);
    for _ in 0..400 {
        let mut changed = made.clone();
        for _ in 0..=random.bits() % 8 {
            let at = (random.bits() % made.len() as u64) as usize;
            // Heads of the file, of the section and of packets are hit as often as all the rest.
            let at = if random.bits().is_multiple_of(2) { at % 120 } else { at };
            changed[at] ^= 1 << (random.bits() % 8);
        }
        let _ = read(&paged(&changed));
    }
}
