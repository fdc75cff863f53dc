//! Small made-up archives, whole and broken, and what is read of them.

use crate::{OpenHints, ReadOptions, Scan, peek, read};
use base::random::Rng;
use base::task::{CancelToken, Task};
use flate2::Compression;
use flate2::write::{DeflateEncoder, GzEncoder};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::io::Write;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use tempfile::TempDir;

/// A scan of so many points.
fn ply(num: u32) -> Vec<u8> {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {num}\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    );
    (0..num).for_each(|i| text += &format!("{i} {} {}\n", i * 7 % 13, i * 5 % 11));
    text.into_bytes()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packing = GzEncoder::new(Vec::new(), Compression::fast());
    packing.write_all(bytes).unwrap();
    packing.finish().unwrap()
}

/// A member of an archive: name, method, flags, bytes.
type TestMember<'a> = (&'a str, u16, u16, Vec<u8>);

/// A ZIP archive of these members.
fn zip(members: &[TestMember]) -> Vec<u8> {
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    for (name, method, flags, bytes) in members {
        let packed = match method {
            8 => {
                let mut packing = DeflateEncoder::new(Vec::new(), Compression::fast());
                packing.write_all(bytes).unwrap();
                packing.finish().unwrap()
            }
            93 => compress_to_vec(&bytes[..], CompressionLevel::Fastest),
            _ => bytes.clone(),
        };
        let mut sum = flate2::Crc::new();
        sum.update(bytes);
        let mut common = vec![20, 0];
        [*flags, *method, 0, 0].iter().for_each(|word| common.extend(word.to_le_bytes()));
        [sum.sum(), packed.len() as u32, bytes.len() as u32]
            .iter()
            .for_each(|n| common.extend(n.to_le_bytes()));
        common.extend((name.len() as u16).to_le_bytes());
        common.extend([0, 0]);
        let offset = archive.len() as u32;
        directory.extend([&b"PK\x01\x02\x14\0"[..], &common, &[0; 10]].concat());
        directory.extend(offset.to_le_bytes());
        directory.extend(name.as_bytes());
        archive.extend([&b"PK\x03\x04"[..], &common, name.as_bytes(), &packed].concat());
    }
    let start = archive.len() as u32;
    archive.extend(&directory);
    archive.extend(b"PK\x05\x06\0\0\0\0");
    [members.len() as u16; 2].iter().for_each(|num| archive.extend(num.to_le_bytes()));
    [directory.len() as u32, start].iter().for_each(|number| archive.extend(number.to_le_bytes()));
    archive.extend([0, 0]);
    archive
}

fn save(name: &str, bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

/// Reads a file of this name and these bytes; the folder is left out of all sentences.
fn read_as(name: &str, bytes: &[u8]) -> Result<Scan, String> {
    let (folder, path) = save(name, bytes);
    let without = |text: &str| text.replace(&format!("{}/", folder.path().display()), "");
    let mut scan = read(&[path], &ReadOptions::AS_FILES_SAY, &CancelToken::default())
        .map_err(|error| without(&error.to_string()))?;
    scan.warnings.iter_mut().for_each(|warning| *warning = without(warning));
    Ok(scan)
}

fn names(scan: &Scan) -> Vec<String> {
    let name = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
    scan.files.iter().map(|file| name(&file.path)).collect()
}

#[test]
fn a_packed_file_is_read_as_if_it_were_unpacked() {
    let whole = read_as("a.ply", &ply(500)).unwrap();
    let zstd = compress_to_vec(&ply(500)[..], CompressionLevel::Fastest);
    let two_parts = [gzip(&ply(500)[..900]), gzip(&ply(500)[900..])].concat();
    for (name, bytes, member) in [
        ("a.ply.gz", gzip(&ply(500)), "a.ply.gz: a.ply"),
        ("a.ply.gz", two_parts, "a.ply.gz: a.ply"),
        ("a.ply.zst", zstd, "a.ply.zst: a.ply"),
        ("a.zip", zip(&[("a.ply", 8, 0, ply(500))]), "a.zip: a.ply"),
        ("a.zip", zip(&[("a.ply", 0, 0, ply(500))]), "a.zip: a.ply"),
        ("a.zip", zip(&[("a.ply", 93, 0, ply(500))]), "a.zip: a.ply"),
        // Something that unpacks itself stands before the archive, a remark behind.
        ("a", [b"PK\x03\x04 me".to_vec(), zip(&[("a.ply", 8, 0, ply(500))])].concat(), "a: a.ply"),
    ] {
        let scan = read_as(name, &bytes).unwrap();
        assert_eq!(scan.files[0].points, whole.files[0].points, "{name}");
        assert_eq!((names(&scan), scan.warnings), (vec![member.to_owned()], vec![]));
    }
}

#[test]
fn all_scans_in_an_archive_are_one_cloud_by_name() {
    let members = [
        ("tiles/b.ply", 8, 0, ply(30)),
        ("readme.txt", 8, 0, b"Meeting on 1 2 3".to_vec()),
        ("tiles/a.ply", 0, 0, ply(20)),
        ("tiles/", 0, 0, vec![]),
        ("../../up.ply", 8, 0, ply(10)),
        ("__MACOSX/tiles/._a.ply", 0, 0, ply(5)),
        ("secret.ply", 8, 1, ply(40)),
        ("odd.ply", 14, 0, ply(40)),
        ("packed.ply.gz", 0, 0, gzip(&ply(40))),
    ];
    let scan = read_as("all.zip", &zip(&members)).unwrap();
    let sizes: Vec<usize> = scan.files.iter().map(|file| file.points.xyz.len()).collect();
    assert_eq!((names(&scan).join(" "), sizes), ("a.ply b.ply all.zip: up.ply".into(), vec![20, 30, 10]));
    let said = scan.warnings.join("\n");
    assert!(said.contains("all.zip: odd.ply: is packed by method 14"), "{said}");
    assert!(said.contains("all.zip: secret.ply: is encrypted"), "{said}");
    let (_folder, path) = save("all.zip", &zip(&members));
    let headers = peek(std::slice::from_ref(&path), &ReadOptions::AS_FILES_SAY).unwrap();
    assert_eq!(headers.iter().map(|header| header.num_points).collect::<Vec<_>>(), [20, 30, 10]);
    let first = crate::open(&path, &OpenHints::default()).unwrap();
    assert!(first.header().path.ends_with("all.zip: tiles/a.ply"), "{:?}", first.header().path);
    assert!(first.header().warnings[0].contains("2 more scans"), "{:?}", first.header().warnings);
}

#[test]
fn what_cannot_be_unpacked_is_said() {
    let said = |name: &str, bytes: &[u8]| read_as(name, bytes).unwrap_err();
    for (name, bytes, words) in [
        (
            "a.zip",
            zip(&[("readme.txt", 8, 0, b"hello".to_vec())]),
            "a.zip: cannot be unpacked: it has no LAS",
        ),
        ("a.zip", zip(&[]), "it has no LAS"),
        ("a.zip", zip(&[("a.ply", 8, 1, ply(9))]), "a.zip: a.ply: is encrypted"),
        ("a.zip", b"PK\x03\x04 cut off".to_vec(), "its directory is missing"),
        ("a.tar.gz", gzip(&[&[b'a'; 257][..], b"ustar\x0000"].concat()), "a.tar.gz: a.tar: is not a"),
        ("a.gz", gzip(&[]), "it is empty"),
        ("a.gz", b"\x1f\x8b\x08\0nothing".to_vec(), "a.gz: cannot be unpacked: it is damaged"),
        ("a.zst", b"\x28\xb5\x2f\xfdnothing".to_vec(), "a.zst: cannot be unpacked: it is damaged"),
        ("a.gz", gzip(&gzip(&ply(9))), "it is a gzip archive; unpack it"),
        ("a.spz", gzip(&ply(9)), "Gaussian splat"),
    ] {
        let error = said(name, &bytes);
        assert!(error.contains(words), "{name}: {error}");
    }
}

#[test]
fn what_a_damaged_archive_still_has_is_read() {
    let packed = gzip(&ply(5000));
    let scan = read_as("a.ply.gz", &packed[..packed.len() / 2]).unwrap();
    let num = scan.num_points();
    assert!((1000..4900).contains(&num), "{num}");
    assert!(
        scan.warnings[0].contains("a.ply.gz: a.ply: could be unpacked up to byte"),
        "{:?}",
        scan.warnings
    );
    let mut stored = zip(&[("a.ply", 0, 0, ply(50))]);
    let at = stored.windows(4).position(|bytes| bytes == b"\n7 1").unwrap();
    stored[at + 1] = b'8';
    let scan = read_as("a.zip", &stored).unwrap();
    assert_eq!(scan.num_points(), 50);
    assert!(scan.warnings[0].contains("checksum"), "{:?}", scan.warnings);
}

#[test]
fn an_archive_does_not_unfold_without_end() {
    let mut packing = GzEncoder::new(Vec::new(), Compression::best());
    packing.write_all(&ply(9)).unwrap();
    let blanks = vec![b'\n'; 1 << 20];
    (0..80).for_each(|_| packing.write_all(&blanks).unwrap());
    let error = read_as("a.ply.gz", &packing.finish().unwrap()).unwrap_err();
    assert!(error.contains("it unfolds to more than 67108864 bytes"), "{error}");
}

#[test]
fn unpacking_is_counted_and_stops_when_asked() {
    let (_folder, path) = save("a.ply.gz", &gzip(&ply(5000)));
    let cancel = CancelToken::default();
    let seen: Arc<Mutex<Vec<_>>> = Arc::default();
    let observed = Arc::clone(&seen);
    let task = Task::new(&cancel).observed(move |count| observed.lock().unwrap().push(Arc::clone(count)));
    let paths = [path];
    assert!(read(&paths, &ReadOptions::AS_FILES_SAY, &task).is_ok());
    let count = seen.lock().unwrap()[0].now();
    assert_eq!((count.what, count.unit), ("unpacking", "bytes"));
    assert_eq!((count.done, count.total), (count.total, std::fs::metadata(&paths[0]).unwrap().len()));
    cancel.cancel();
    let error = read(&paths, &ReadOptions::AS_FILES_SAY, &task).unwrap_err().to_string();
    assert!(error.contains("stopped"), "{error}");
}

#[test]
fn broken_archives_never_panic() {
    let mut random = Rng::new(11, 0);
    let mut below = |end: usize| (random.bits() % end as u64) as usize;
    let zstd = compress_to_vec(&ply(300)[..], CompressionLevel::Fastest);
    let zip = zip(&[("a.ply", 8, 0, ply(300)), ("b.ply", 93, 0, ply(200))]);
    for (name, whole) in [("a.gz", gzip(&ply(300))), ("a.zst", zstd), ("a.zip", zip)] {
        for sixteenth in 0..16 {
            let _ = read_as(name, &whole[..whole.len() * sixteenth / 16]);
        }
        for _ in 0..300 {
            let mut bytes = whole.clone();
            for _ in 0..1 + below(4) {
                let at = below(bytes.len());
                bytes[at] ^= 1 << below(8);
            }
            let _ = read_as(name, &bytes);
        }
    }
}
