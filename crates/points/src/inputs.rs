//! Chooses which of the named files are read: each once, and no sidecars.

use super::ScanError;
use super::formats::{main_file, sidecar_endings};
use std::collections::HashMap;
use std::ffi::OsStr;
use std::hash::Hash;
use std::path::{Path, PathBuf};

/// Endings of files that lie beside scans of any format and hold no points: indexes, coordinate systems, world files,
/// statistics, and tables of tiles. Formats know those that lie beside their own files.
const SIDECARS: [&str; 17] = [
    "index", "idx", "prj", "wkt", "tfw", "jgw", "pgw", "wld", "xml", "ovr", "shp", "shx", "dbf", "cpg",
    "qix", "sbn", "sbx",
];
/// Most names that a sentence gives before it counts the rest.
const MOST_NAMED: usize = 3;

/// What is read, and what a user should know about the rest.
#[derive(Debug, Default)]
pub(super) struct Inputs {
    /// Files to read, in the order given.
    pub paths: Vec<PathBuf>,
    /// Sentences about files that are not read.
    pub remarks: Vec<String>,
}

/// Chooses among the named files.
///
/// # Errors
/// No file was named, or only sidecars.
pub(super) fn choose(named: &[PathBuf]) -> Result<Inputs, ScanError> {
    let (sidecars, mut paths): (Vec<PathBuf>, Vec<PathBuf>) =
        named.iter().cloned().partition(|path| is_sidecar(path));
    if paths.is_empty() {
        let first = sidecars.into_iter().next().ok_or(ScanError::NoFiles)?;
        return Err(ScanError::OnlySidecars { path: first });
    }
    let mut remarks = Vec::new();
    if !sidecars.is_empty() {
        let names = names(&sidecars);
        remarks.push(format!(
            "{names}: passed over, files beside scans (indexes, coordinate systems) hold no points"
        ));
    }
    let again = take_once(&mut paths);
    if !again.is_empty() {
        remarks.push(format!("{}: named twice, also as a link perhaps; taken once", names(&again)));
    }
    Ok(Inputs { paths, remarks })
}

fn is_sidecar(path: &Path) -> bool {
    let ending = path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase);
    ending.is_some_and(|ending| SIDECARS.into_iter().chain(sidecar_endings()).any(|known| known == ending))
}

/// Names of files in a sentence: "a.lax, b.lax, c.lax and 4 more".
fn names(paths: &[PathBuf]) -> String {
    let named: Vec<String> = paths.iter().take(MOST_NAMED).map(|path| path.display().to_string()).collect();
    match paths.len().saturating_sub(MOST_NAMED) {
        0 => named.join(", "),
        more => format!("{} and {more} more", named.join(", ")),
    }
}

/// Removes paths to files that an earlier path names, and links to files that are themselves named; returns what it
/// removed. Links to a file that is not itself named stay, each once: a folder of links is a way to put a scan
/// together.
fn take_once(paths: &mut Vec<PathBuf>) -> Vec<PathBuf> {
    /// What is known of a file: whether a path names it without a link, and the links that are kept.
    #[derive(Default)]
    struct FileNames {
        itself: bool,
        taken: bool,
        links: Vec<PathBuf>,
    }
    let mut seen = HashMap::<_, FileNames>::new();
    // A folder and the files in it may name the same scan.
    let identities: Vec<_> =
        paths.iter().map(|path| identity(main_file(path).as_deref().unwrap_or(path))).collect();
    for (path, identity) in paths.iter().zip(&identities) {
        if let Some(identity) = identity {
            seen.entry(identity).or_default().itself |= !path.is_symlink();
        }
    }
    let mut removed = Vec::new();
    let mut of_paths = identities.iter();
    paths.retain(|path| {
        // A file that cannot be looked at is read, so that the error says why.
        let Some(seen) = of_paths.next().and_then(|identity| seen.get_mut(identity.as_ref()?)) else {
            return true;
        };
        let keep = if seen.itself {
            !std::mem::replace(&mut seen.taken, true)
        } else {
            let link = own_place(path);
            let is_new = !seen.links.contains(&link);
            seen.links.push(link);
            is_new
        };
        if !keep {
            removed.push(path.clone());
        }
        keep
    });
    removed
}

/// Where a link itself lies, not what it points to.
fn own_place(link: &Path) -> PathBuf {
    let folder = link.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = std::fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    folder.join(link.file_name().unwrap_or_default())
}

/// Device and inode: equal for all names of a file, hard links too.
#[cfg(unix)]
fn identity(path: &Path) -> Option<impl Eq + Hash + use<>> {
    use std::os::unix::fs::MetadataExt;
    std::fs::metadata(path).ok().map(|metadata| (metadata.dev(), metadata.ino()))
}

/// The path without links and dots; hard links look like two files.
#[cfg(not(unix))]
fn identity(path: &Path) -> Option<impl Eq + Hash + use<>> {
    std::fs::canonicalize(path).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(names: &[&str]) -> Vec<PathBuf> {
        names.iter().map(PathBuf::from).collect()
    }

    #[test]
    fn sidecars_are_passed_over_by_name() {
        let named =
            ["a.laz", "a.LAX", "b.copc.laz", "b.prj", "c.aux.xml", "c.copc", "d.las.index", "x.tfw", "noend"];
        let inputs = choose(&paths(&named)).unwrap();
        assert_eq!(inputs.paths, paths(&["a.laz", "b.copc.laz", "noend"]));
        let [remark] = &inputs.remarks[..] else { panic!("{:?}", inputs.remarks) };
        assert!(remark.starts_with("a.LAX, b.prj, c.aux.xml and 3 more: passed over"), "{remark}");
        assert!(choose(&paths(&["a.laz"])).unwrap().remarks.is_empty());
        assert!(matches!(choose(&[]), Err(ScanError::NoFiles)));
        let error = choose(&paths(&["b.prj", "a.lax"])).unwrap_err().to_string();
        assert!(error.starts_with("b.prj: ") && error.contains("name the scan"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_file_is_taken_once_by_whatever_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("a.las"), b"a").unwrap();
        std::fs::write(at("b.las"), b"a").unwrap();
        std::fs::hard_link(at("a.las"), at("hard.las")).unwrap();
        std::os::unix::fs::symlink(at("a.las"), at("link.las")).unwrap();
        std::os::unix::fs::symlink(at("b.las"), at("one.las")).unwrap();
        std::os::unix::fs::symlink(at("b.las"), at("two.las")).unwrap();
        let taken = |names: &[&str]| {
            let inputs = choose(&names.iter().map(|name| at(name)).collect::<Vec<_>>()).unwrap();
            let name = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
            (inputs.paths.iter().map(name).collect::<Vec<_>>().join(" "), inputs.remarks.len())
        };
        assert_eq!(taken(&["a.las", "b.las"]), ("a.las b.las".into(), 0));
        assert_eq!(taken(&["a.las", "b.las", "./a.las"]), ("a.las b.las".into(), 1));
        assert_eq!(taken(&["link.las", "a.las", "hard.las"]), ("link.las".into(), 1));
        // Links whose file is not named are tiles of their own, each taken once.
        assert_eq!(taken(&["one.las", "two.las", "./one.las"]), ("one.las two.las".into(), 1));
        assert_eq!(taken(&["missing.las", "missing.las"]), ("missing.las missing.las".into(), 0));
    }
}
