//! Unpacks a member, within bounds: no archive may take all of a disk, or unfold without end.

use crate::ScanError;
use crate::unpacked::UnpackRoom;
use base::task::Progress;
use base::words::counted;
use std::io::{self, BufRead, Read};
use std::path::Path;

/// Times its own size that an archive may unfold to: text of points unfolds to some ten, pictures of nothing to a
/// thousand.
const MOST_RATIO: u64 = 250;
/// Bytes that any archive may unfold to.
const BYTES_FOR_FREE: u64 = 64 << 20;
/// Bytes of the disk of temporary files that are left to others.
const RESERVE: u64 = 1 << 28;
/// Bytes from one look at the disk to the next.
const LOOK_EVERY: u64 = 64 << 20;
/// Bytes that are unpacked at once.
const PART: usize = 1 << 18;

/// How much an archive may unfold to.
#[derive(Clone, Debug)]
pub(super) struct PourLimit {
    most: u64,
    done: u64,
    looked_at: u64,
    /// Says how many bytes the disk of temporary files has left, if anybody knows.
    free: fn() -> Option<u64>,
}

impl PourLimit {
    /// The limit of an archive of so many bytes.
    pub fn of(archive_bytes: u64) -> Self {
        let most = archive_bytes.saturating_mul(MOST_RATIO).max(BYTES_FOR_FREE);
        Self { most, done: 0, looked_at: 0, free: free_bytes }
    }

    /// Counts bytes that are about to be written.
    fn add(&mut self, num_bytes: u64) -> Result<(), String> {
        self.done += num_bytes;
        if self.done > self.most {
            return Err(format!(
                "it unfolds to more than {}, {MOST_RATIO} times its size, as no scan does; unpack it yourself",
                counted(self.most, "byte")
            ));
        }
        if self.looked_at == 0 || self.done - self.looked_at > LOOK_EVERY {
            self.looked_at = self.done;
            if (self.free)().is_some_and(|free| free < RESERVE.saturating_add(num_bytes)) {
                return Err(full());
            }
        }
        Ok(())
    }
}

/// The sentence about a full disk.
fn full() -> String {
    let folder = std::env::temp_dir();
    let folder = folder.display();
    format!(
        "the disk of temporary files ({folder}) has no room for it; free some, or name another folder in TMPDIR"
    )
}

#[cfg(unix)]
fn free_bytes() -> Option<u64> {
    let disk = rustix::fs::statvfs(std::env::temp_dir()).ok()?;
    Some(disk.f_bavail.saturating_mul(disk.f_frsize))
}

#[cfg(not(unix))]
fn free_bytes() -> Option<u64> {
    None
}

/// What is to be unpacked.
pub(super) struct Poured<'a> {
    pub archive: &'a Path,
    /// Name under which the member is found.
    pub name: &'a Path,
    /// Checksum of its bytes, where the archive states it.
    pub crc: Option<u32>,
    /// Its first bytes, which were unpacked already.
    pub head: &'a [u8],
}

impl Poured<'_> {
    /// Unpacks the member. What can be unpacked of a damaged one is kept.
    ///
    /// # Errors
    /// The user stops it, it is too large, nothing can be unpacked, or the system cannot write.
    pub fn into(
        self,
        room: &mut UnpackRoom,
        rest: &mut dyn Read,
        limit: &mut PourLimit,
        progress: &Progress,
    ) -> Result<(), ScanError> {
        let Self { archive, name, crc, head } = self;
        let fail = |problem| ScanError::Archive { path: archive.to_owned(), problem };
        let failed_to_write = |error: io::Error| {
            fail(match error.kind() {
                io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => full(),
                _ => format!("its members cannot be written to {}: {error}", std::env::temp_dir().display()),
            })
        };
        let mut writer = room.begin().map_err(failed_to_write)?;
        let mut sum = flate2::Crc::new();
        let mut part = vec![0; PART];
        part[..head.len()].copy_from_slice(head);
        let mut num_read = head.len();
        let mut loss = None;
        while num_read > 0 {
            progress.check()?;
            limit.add(num_read as u64).map_err(fail)?;
            sum.update(&part[..num_read]);
            writer.write(&part[..num_read]).map_err(failed_to_write)?;
            num_read = match rest.read(&mut part) {
                Ok(num_read) => num_read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => {
                    loss = Some(format!("could be unpacked up to byte {} only: {error}", writer.len()));
                    break;
                }
            };
        }
        if loss.is_none() && crc.is_some_and(|crc| crc != sum.sum()) {
            loss = Some("was damaged in its archive: its checksum does not match".into());
        }
        writer.finish(name, loss);
        Ok(())
    }
}

/// Counts the packed bytes that are read.
pub(super) struct CountedReader<'a, R> {
    pub packed: R,
    pub progress: &'a Progress,
}

impl<R: BufRead> Read for CountedReader<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let num_read = self.packed.read(buffer)?;
        self.progress.add(num_read as u64);
        Ok(num_read)
    }
}

impl<R: BufRead> BufRead for CountedReader<'_, R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.packed.fill_buf()
    }

    fn consume(&mut self, num_bytes: usize) {
        self.progress.add(num_bytes as u64);
        self.packed.consume(num_bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_takes_all_of_a_disk_or_unfolds_without_end() {
        let mut limit = PourLimit { free: || Some(1 << 40), ..PourLimit::of(1 << 20) };
        assert_eq!(limit.add(250 << 20), Ok(()));
        assert!(limit.add(1).unwrap_err().contains("250 times its size"));
        let mut small = PourLimit { free: || None, ..PourLimit::of(10) };
        assert_eq!(small.add(64 << 20), Ok(()));
        assert!(small.add(1).is_err());
        let mut full = PourLimit { free: || Some(RESERVE + 5), ..PourLimit::of(1 << 40) };
        assert!(full.clone().add(6).unwrap_err().contains("has no room for it"));
        // The disk is looked at again.
        assert_eq!(full.add(5), Ok(()));
        full.free = || Some(0);
        assert_eq!(full.add(LOOK_EVERY), Ok(()));
        assert!(full.add(1).is_err());
    }
}
