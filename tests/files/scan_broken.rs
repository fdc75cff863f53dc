//! Broken input gives a clear error or the part that can be read; never a panic, a hang, or memory that is only
//! claimed.

use crate::bytes::{assert_refused, read_bytes};
use kit::damage::{MOST_KIB, assert_sound, damaged, peak_kib};
use kit::las_files::Fixture;
use kit::reading;
use proptest::prelude::*;
use std::path::Path;

/// The name by which bytes are read here.
const NAME: &str = "scan.las";

/// A copy with some bytes replaced.
fn patched(bytes: &[u8], at: usize, new: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[at..at + new.len()].copy_from_slice(new);
    bytes
}

#[test]
fn other_files_are_named_for_what_they_are() {
    assert_refused(NAME, b"", "it is empty");
    assert_refused(
        NAME,
        b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1\n",
        "git lfs pull",
    );
    assert_refused(
        NAME,
        b"ASTM-E57\x01\x00\x00\x00",
        "ends at byte 12, within its header, which needs 48 bytes",
    );
    assert_refused(NAME, b"glTF\x02\0\0\0", "glTF model; this is not supported yet");
    assert_refused(NAME, b"Not a scan\n", "it is text");
    assert_refused(NAME, &[0x8f, 1, 2, 3, 0, 0], "8f 01 02 03");
}

#[test]
fn headers_that_make_no_sense_name_their_field() {
    let good = Fixture::new(3).bytes();
    assert_refused(NAME, &good[..4], "ends at byte 4, within its header, which needs 227 bytes");
    assert_refused(NAME, &good[..226], "ends at byte 226");
    for value in [f64::NAN, f64::INFINITY, 0.0] {
        assert_refused(NAME, &patched(&good, 139, &value.to_le_bytes()), "Y Scale Factor (byte 139)");
    }
    assert_refused(NAME, &patched(&good, 171, &f64::NAN.to_le_bytes()), "Z Offset (byte 171)");
    assert_refused(NAME, &patched(&good, 131, &1e308f64.to_le_bytes()), "X Offset (byte 155)");
    assert_refused(NAME, &patched(&good, 104, &[11]), "Point Data Record Format (byte 104) is 11");
    assert_refused(NAME, &patched(&good, 105, &[0, 0]), "Point Data Record Length (byte 105) is 0");
    assert_refused(NAME, &patched(&good, 105, &[33, 0]), "which needs 34");
    assert_refused(NAME, &patched(&good, 96, &[5, 0, 0, 0]), "Offset to Point Data (byte 96) is 5");
    assert_refused(NAME, &patched(&good, 24, &[2]), "Version (byte 24) is 2.2");
    assert_refused(NAME, &patched(&good, 104, &[0x83]), "laszip encoded");
}

#[test]
fn no_points_is_an_error() {
    let empty = Fixture::new(3).with_points(0).bytes();
    assert_refused(NAME, &empty, "holds no points");
    let promised = patched(&empty, 107, &1065u32.to_le_bytes());
    assert_refused(NAME, &promised, "1065 should start at byte");
    assert_refused(NAME, &Fixture::new(3).compressed().with_points(0).bytes(), "holds no points");
}

#[test]
fn counts_that_lie_cost_nothing() {
    for fixture in [Fixture::new(6), Fixture::new(6).compressed()] {
        let lying = patched(&fixture.bytes(), 247, &1_000_000_000_000u64.to_le_bytes());
        let scan = read_bytes(NAME, &lying).unwrap();
        assert_eq!(scan.num_points(), 1000, "{fixture:?}");
        assert!(scan.warnings[0].contains("announces 1000000000000 points"), "{:?}", scan.warnings);
    }
    let old = Fixture::new(1).bytes();
    for count in [0u32, 1, 999, 1001, u32::MAX] {
        let scan = read_bytes(NAME, &patched(&old, 107, &count.to_le_bytes())).unwrap();
        assert_eq!((scan.num_points(), scan.warnings.len()), (1000, 1), "header says {count}");
    }
    let vlrs = patched(&old, 100, &1_069_128_089u32.to_le_bytes());
    assert_eq!(read_bytes(NAME, &vlrs).unwrap().num_points(), 1000);
}

#[test]
fn las_cut_anywhere_gives_its_whole_points() {
    let fixture = Fixture::new(3).with_points(20);
    let bytes = fixture.bytes();
    let all = read_bytes(NAME, &bytes).unwrap().files[0].points.clone();
    let start = bytes.len() - 20 * 34;
    for len in 0..bytes.len() {
        match read_bytes(NAME, &bytes[..len]) {
            Ok(scan) => {
                let points = &scan.files[0].points;
                assert_eq!(points.xyz.len(), (len - start) / 34, "cut at {len}");
                assert!(all.xyz.starts_with(&points.xyz) && all.rgb.starts_with(&points.rgb));
                assert_eq!(scan.warnings.len(), 1, "{:?}", scan.warnings);
                assert!(scan.warnings[0].ends_with("get or export it again"), "{:?}", scan.warnings);
            }
            Err(error) => assert!(len < start + 34, "cut at {len}: {error}"),
        }
    }
}

#[test]
fn laz_cut_anywhere_gives_a_prefix_or_a_clear_error() {
    for point_format in [1, 7] {
        let bytes = Fixture::new(point_format).compressed().with_points(200).bytes();
        let all = read_bytes(NAME, &bytes).unwrap().files[0].points.clone();
        let mut num_partial = 0;
        for len in 0..bytes.len() {
            if let Ok(scan) = read_bytes(NAME, &bytes[..len]) {
                assert!(all.xyz.starts_with(&scan.files[0].points.xyz), "format {point_format} cut at {len}");
                let is_told = scan.warnings.iter().any(|warning| warning.ends_with("get or export it again"));
                assert!(is_told || scan.num_points() == 200, "{:?}", scan.warnings);
                assert!(!scan.warnings.is_empty());
                num_partial += 1;
            }
        }
        assert!(num_partial > 0, "format {point_format}: no cut left anything");
    }
}

/// First byte of the points of a file.
fn points_offset(bytes: &[u8]) -> usize {
    u32::from_le_bytes(*bytes[96..].first_chunk().unwrap()) as usize
}

#[test]
fn a_broken_chunk_loses_only_itself() {
    // The file has three chunks, of 50 000, 50 000 and 20 000 points.
    let bytes = Fixture::new(1).compressed().with_points(120_000).bytes();
    let all = read_bytes(NAME, &bytes).unwrap().files[0].points.clone();
    let middle = points_offset(&bytes) + (bytes.len() - points_offset(&bytes)) * 5 / 8;
    let mut broken = bytes.clone();
    broken[middle..middle + 4000].fill(0xff);
    let scan = read_bytes(NAME, &broken).unwrap();
    let points = &scan.files[0].points;
    assert_eq!(points.xyz.len(), 70_000);
    assert!(points.xyz[..50_000] == all.xyz[..50_000]);
    assert!(points.xyz[50_000..] == all.xyz[100_000..]);
    let warning = &scan.warnings[0];
    assert!(warning.contains("scan.las: chunk 2 of 3 (points 50001 to 100000)"), "{warning}");
}

#[test]
fn a_lost_chunk_table_loses_nothing() {
    for point_format in [1, 7] {
        let bytes = Fixture::new(point_format).compressed().with_points(60_000).bytes();
        let all = read_bytes(NAME, &bytes).unwrap().files[0].points.clone();
        let table = u64::from_le_bytes(*bytes[points_offset(&bytes)..].first_chunk().unwrap()) as usize;
        let without = [&bytes[..table], &[0u8; 8]].concat();
        let garbled = patched(&bytes, table + 4, &u32::MAX.to_le_bytes());
        for (what, bytes) in [("cut off", without), ("garbled", garbled)] {
            let scan = read_bytes(NAME, &bytes).unwrap();
            assert!(scan.files[0].points == all, "format {point_format}, table {what}");
            assert!(scan.warnings[0].contains("chunk table"), "{:?}", scan.warnings);
        }
    }
}

#[test]
fn what_is_no_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refusal = |path: &Path| reading::file(path).unwrap_err().to_string();
    assert!(refusal(folder.path()).contains("is a folder"));
    let missing = refusal(&folder.path().join("missing.laz"));
    assert!(missing.contains("missing.laz") && missing.contains("No such file"), "{missing}");
    assert!(reading::files(&[]).unwrap_err().to_string().contains("no scan was named"));
    #[cfg(unix)]
    assert!(refusal(Path::new("/dev/null")).contains("a pipe or device"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_end_well(bytes in proptest::collection::vec(any::<u8>(), 0..2000), signed in any::<bool>()) {
        let mut bytes = bytes;
        if signed && bytes.len() > 26 {
            bytes[..4].copy_from_slice(b"LASF");
            bytes[24] = 1;
            bytes[25] %= 5;
        }
        let _ = read_bytes(NAME, &bytes);
        prop_assert!(peak_kib().unwrap_or(0) < MOST_KIB);
    }

    #[test]
    fn damaged_files_end_well(
        point_format in 0u8..=8,
        compressed in any::<bool>(),
        damage in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        cut in any::<prop::sample::Index>(),
        cutting in any::<bool>(),
    ) {
        let fixture = Fixture { compressed, ..Fixture::new(point_format) }.with_points(300);
        let bytes = damaged(fixture.bytes(), &damage, cutting.then_some(cut));
        if let Ok(scan) = read_bytes(NAME, &bytes) {
            assert_sound(&scan);
            let points = &scan.files[0].points;
            prop_assert_eq!(points.intensity.len(), points.xyz.len());
        }
        prop_assert!(peak_kib().unwrap_or(0) < MOST_KIB);
    }
}
