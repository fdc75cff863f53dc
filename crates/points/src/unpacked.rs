//! Files that come out of archives: parts of one temporary file, found by the names under which users know them.
//!
//! The temporary file has no name of its own (on Windows it is deleted when it is closed), so that nothing is left of it,
//! however the program ends, and no archive can choose where its members are written. All of an archive's members are in
//! one file, because the system allows fewer open files than an archive may have.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};

/// All members that are unpacked now, by name. Several may have one name, if an archive is opened twice.
static MEMBERS: LazyLock<Mutex<HashMap<PathBuf, Vec<UnpackedMember>>>> = LazyLock::new(Mutex::default);
/// Number of the next room.
static NEXT: AtomicU64 = AtomicU64::new(0);

/// A member of an archive, unpacked.
#[derive(Clone, Debug)]
pub(crate) struct UnpackedMember {
    room: u64,
    /// The file that it is in.
    pub file: Arc<File>,
    /// Its first byte in the file.
    pub start: u64,
    /// Its size in bytes.
    pub len: u64,
    /// What could not be unpacked of it, as a sentence whose subject is the member.
    pub loss: Option<String>,
}

/// Where members are unpacked to. They are gone once it is dropped.
#[derive(Debug)]
pub(crate) struct UnpackRoom {
    number: u64,
    file: Arc<File>,
    /// Bytes that are in use.
    end: u64,
    names: Vec<PathBuf>,
}

impl UnpackRoom {
    /// An empty room, in the system's folder of temporary files.
    ///
    /// # Errors
    /// No file can be made there.
    pub fn new() -> io::Result<Self> {
        let file = Arc::new(tempfile::tempfile()?);
        Ok(Self { number: NEXT.fetch_add(1, Ordering::Relaxed), file, end: 0, names: Vec::new() })
    }

    /// Begins a member behind those that are there.
    ///
    /// # Errors
    /// The system cannot write.
    pub fn begin(&mut self) -> io::Result<MemberWriter<'_>> {
        let mut file = &*self.file;
        // Whatever a member left that was given up.
        file.set_len(self.end)?;
        file.seek(SeekFrom::Start(self.end))?;
        Ok(MemberWriter { room: self, len: 0 })
    }
}

impl Drop for UnpackRoom {
    fn drop(&mut self) {
        let mut all = members();
        for name in &self.names {
            if let Some(of_name) = all.get_mut(name) {
                of_name.retain(|member| member.room != self.number);
            }
            if all.get(name).is_some_and(Vec::is_empty) {
                all.remove(name);
            }
        }
    }
}

/// A member that is being unpacked.
#[derive(Debug)]
pub(crate) struct MemberWriter<'a> {
    room: &'a mut UnpackRoom,
    len: u64,
}

impl MemberWriter<'_> {
    /// Appends bytes.
    ///
    /// # Errors
    /// The system cannot write them.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        (&*self.room.file).write_all(bytes)?;
        self.len += bytes.len() as u64;
        Ok(())
    }

    /// Bytes so far.
    pub fn len(&self) -> u64 {
        self.len
    }

    /// Ends the member, which is found by this name from now on.
    pub fn finish(self, name: &Path, loss: Option<String>) {
        let Self { room, len } = self;
        let (file, start) = (Arc::clone(&room.file), room.end);
        let member = UnpackedMember { room: room.number, file, start, len, loss };
        room.end += len;
        room.names.push(name.to_owned());
        members().entry(name.to_owned()).or_default().push(member);
    }
}

/// The member that was unpacked last under a name.
pub(crate) fn find(name: &Path) -> Option<UnpackedMember> {
    members().get(name)?.last().cloned()
}

fn members() -> MutexGuard<'static, HashMap<PathBuf, Vec<UnpackedMember>>> {
    // The map is whole even if a thread panicked that held it.
    MEMBERS.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;

    #[test]
    fn members_are_found_by_name_until_their_room_is_dropped() {
        let name = Path::new("rooms.zip: a.laz");
        let mut first = UnpackRoom::new().unwrap();
        let mut given_up = first.begin().unwrap();
        given_up.write(b"given up").unwrap();
        let mut writer = first.begin().unwrap();
        writer.write(b"abc").unwrap();
        writer.write(b"def").unwrap();
        assert_eq!(writer.len(), 6);
        writer.finish(name, None);
        first.begin().unwrap().finish(Path::new("rooms.zip: empty"), Some("is empty".into()));
        let mut second = UnpackRoom::new().unwrap();
        let mut writer = second.begin().unwrap();
        writer.write(b"0123456789").unwrap();
        writer.finish(name, None);
        let read = |source: &Source| source.bytes(2, 100).unwrap();
        let source = Source::open(name).unwrap();
        assert_eq!((source.len(), read(&source)), (10, b"23456789".to_vec()));
        drop(second);
        let of_first = Source::open(name).unwrap();
        assert_eq!((of_first.len(), read(&of_first)), (6, b"cdef".to_vec()));
        assert!(of_first.bytes(7, 3).unwrap().is_empty());
        assert_eq!(Source::open(Path::new("rooms.zip: empty")).unwrap().loss(), Some("is empty"));
        drop(first);
        assert!(Source::open(name).is_err());
        // What is open stays readable.
        assert_eq!((read(&source), read(&of_first)), (b"23456789".to_vec(), b"cdef".to_vec()));
    }
}
