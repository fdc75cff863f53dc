//! Tests that a file is known again by any name, and that what was there stays whatever goes wrong.

use super::*;
use std::fs;
use std::io::Write;

/// The part of an earlier run's metrics by which they are known.
const OLD: &str = r#"{"gpu_bytes": 7}"#;

const SCAN: OutputKind = OutputKind::Scan(&["las", "laz"]);

/// A folder with a scan, `a.las`.
struct Lab(tempfile::TempDir);

impl Lab {
    fn new() -> Self {
        let lab = Self(tempfile::tempdir().unwrap());
        fs::write(lab.path("a.las"), "the scan").unwrap();
        lab
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The refusal of outputs while `a.las` is read; nothing is written by a check.
    fn refusal(&self, writes: &[(&str, OutputKind)]) -> Option<OutputError> {
        let before = self.names();
        let mut files = Files::default();
        files.reads("a scan", &self.path("a.las"));
        files.scans_end_in(["las", "laz", "e57"].map(String::from));
        for (name, kind) in writes {
            files.writes("-o", &self.path(name), *kind);
        }
        let refusal = files.check(&Partials::default()).err();
        assert_eq!(self.names(), before);
        refusal
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }
}

/// Writes `text` and keeps it.
fn written(output: &Output, text: &str) -> Result<(), OutputError> {
    output.write(text.as_bytes())
}

#[test]
fn what_is_read_is_known_by_any_name() {
    let lab = Lab::new();
    fs::create_dir(lab.path("inner")).unwrap();
    for name in ["a.las", "./a.las", "inner/../a.las", "inner/.././//a.las"] {
        let refusal = lab.refusal(&[(name, SCAN)]);
        assert!(matches!(refusal, Some(OutputError::IsRead { .. })), "{name}: {refusal:?}");
    }
    assert!(lab.refusal(&[("b.las", SCAN)]).is_none(), "another file is no other's concern");
}

#[test]
#[cfg(unix)]
fn what_is_read_is_known_through_links() {
    use std::os::unix::fs::symlink;
    let lab = Lab::new();
    symlink("a.las", lab.path("link.png")).unwrap();
    symlink("link.png", lab.path("link to link.png")).unwrap();
    symlink(lab.path("a.las"), lab.path("absolute.png")).unwrap();
    fs::hard_link(lab.path("a.las"), lab.path("hard.png")).unwrap();
    symlink(".", lab.path("folder")).unwrap();
    fs::create_dir(lab.path("inner")).unwrap();
    symlink("../hard.png", lab.path("inner/out.png")).unwrap();
    for name in [
        "link.png",
        "link to link.png",
        "absolute.png",
        "hard.png",
        "folder/a.las",
        "folder/folder/link.png",
        "inner/out.png",
    ] {
        let refusal = lab.refusal(&[(name, OutputKind::Picture)]).expect(name);
        assert!(matches!(refusal, OutputError::IsRead { .. }) && refusal.is_usage(), "{name}: {refusal}");
        let sentence = refusal.to_string();
        assert!(sentence.contains(name) && sentence.contains("a.las, which is read as a scan"), "{sentence}");
    }
    // Here a link is read, and the file that it leads to is written.
    let mut files = Files::default();
    files.reads("the settings", &lab.path("link.png"));
    files.writes("-o", &lab.path("a.las"), SCAN);
    assert!(matches!(files.check(&Partials::default()), Err(OutputError::IsRead { .. })));
}

#[test]
fn outputs_are_compared_before_they_exist() {
    let lab = Lab::new();
    fs::create_dir(lab.path("inner")).unwrap();
    let twice = |a: &str, b: &str| {
        let refusal = lab.refusal(&[(a, OutputKind::Poses), (b, OutputKind::Poses)]);
        match refusal {
            None => false,
            Some(OutputError::Twice { .. }) => true,
            Some(other) => panic!("{other}"),
        }
    };
    assert!(twice("x", "x") && twice("x", "inner/../x") && twice("x.poses", "./x.poses"));
    assert!(twice("x", "X"), "one file on some disks");
    assert!(!twice("x", "y") && !twice("x", "inner/x"));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("not there yet", lab.path("link")).unwrap();
        assert!(twice("link", "not there yet") && !twice("link", "x"));
    }
}

#[test]
fn an_input_that_is_missing_is_not_made_by_its_output() {
    let lab = Lab::new();
    let mut files = Files::default();
    files.reads("the pose path", &lab.path("missing"));
    files.writes("--log", &lab.path("./missing"), OutputKind::FrameLog);
    assert!(matches!(files.check(&Partials::default()), Err(OutputError::IsRead { .. })));
}

#[test]
fn endings_say_what_is_written() {
    use OutputKind::*;
    let lab = Lab::new();
    fs::write(lab.path("b.las"), "").unwrap();
    for (name, kind) in [
        ("b.las", Picture),
        ("x.jpg", Picture),
        ("x", Picture),
        ("x.png.las", Picture),
        ("b.las", Depth),
        ("b.las", Metrics),
        ("x.E57", Metrics),
        ("b.las", FrameLog),
        ("x.png", FrameLog),
        ("x.csv", Page),
        ("x", Page),
        ("x.csv", Poses),
        ("x.toml", Metrics),
        ("x.e57", SCAN),
        ("x", SCAN),
    ] {
        let refusal = lab.refusal(&[(name, kind)]).unwrap_or_else(|| panic!("{name}"));
        assert!(matches!(refusal, OutputError::Ending { .. }) && refusal.is_usage(), "{name}: {refusal}");
        let hinted = refusal.to_string().contains("the shell put its first match here");
        assert_eq!(hinted, name == "b.las", "{refusal}");
    }
    let refusal = lab.refusal(&[("/dev/null", SCAN)]).unwrap().to_string();
    assert!(!refusal.contains("the shell"), "a device is no match of a pattern: {refusal}");
    for (name, kind) in [
        ("x.png", Picture),
        ("x.PNG", Picture),
        ("x.npy", Depth),
        ("x.depth", Depth),
        ("x", Metrics),
        ("x.JSON", Metrics),
        ("x.log", FrameLog),
        ("x.Csv", FrameLog),
        ("x.htm", Page),
        ("x.txt", Poses),
        ("x.LAZ", SCAN),
    ] {
        assert!(lab.refusal(&[(name, kind)]).is_none(), "{name}");
    }
}

#[test]
fn a_name_that_no_file_can_have_is_not_there_already() {
    let lab = Lab::new();
    let mut files = Files::default();
    files.writes("-o", &lab.path(&format!("{}.png", "x".repeat(300))), OutputKind::Picture);
    let error = files.check(&Partials::default()).unwrap_err().to_string();
    assert!(!error.contains("already") && error.contains("too long"), "{error}");
}

#[test]
fn what_has_the_name_is_replaced_only_if_it_is_of_the_kind() {
    use OutputKind::*;
    let lab = Lab::new();
    let refused = |name: &str, kind, forced: bool| {
        let mut files = Files::default();
        if forced {
            files.force();
        }
        files.writes("-o", &lab.path(name), kind);
        match files.check(&Partials::default()) {
            Ok(_) => false,
            Err(error @ OutputError::Exists { .. }) => error.is_usage(),
            Err(other) => panic!("{name}: {other}"),
        }
    };
    for (name, bytes, kind, right) in [
        ("x.png", &b"\x89PNG\r\n\x1a\n\0\0"[..], Picture, true),
        ("x.png", b"\xff\xd8\xff", Picture, false),
        ("x.png", b"LASF", Picture, false),
        (
            "x.npy",
            b"\x93NUMPY\x01\0v\0{'descr': '<f4', 'fortran_order': False, 'shape': (4, 3), }",
            Depth,
            true,
        ),
        (
            "x.npy",
            b"\x93NUMPY\x01\0v\0{'descr': '<f8', 'fortran_order': False, 'shape': (4, 3), }",
            Depth,
            false,
        ),
        ("x.npy", b"ply\n", Depth, false),
        ("x.json", OLD.as_bytes(), Metrics, true),
        ("x.json", b"{}", Metrics, false),
        ("x.csv", b"# scanwalk frame log, version 9\n", FrameLog, true),
        ("x.csv", b"frame,time\n", FrameLog, false),
        ("x.html", b"<!DOCTYPE html><html>", Page, false),
        ("x.poses", b"time_s,x,y,z,qx,qy,qz,qw\n", Poses, true),
        ("x.poses", b"# by hand\n", Poses, false),
        ("x.las", b"LASF", SCAN, false),
        ("x.las", b"nothing known", SCAN, false),
        ("x.las", b"", SCAN, true),
        ("x.png", b"", Picture, true),
    ] {
        fs::write(lab.path(name), bytes).unwrap();
        assert_eq!(refused(name, kind, false), !right, "{name}: {}", bytes.escape_ascii());
        assert!(!refused(name, kind, true), "{name}: by force");
    }
}

#[test]
fn a_place_where_nothing_can_be_written_is_found_first() {
    let lab = Lab::new();
    fs::create_dir(lab.path("x.png")).unwrap();
    for (name, words) in [
        ("x.png", "is a folder"),
        ("new.png/", "is a folder"),
        (".", "is a folder"),
        ("no/such/x.png", "no/such"),
        ("a.las/x.png", "there is no folder"),
    ] {
        let refusal = lab.refusal(&[(name, OutputKind::Picture)]).expect(name);
        assert!(!refusal.is_usage() && refusal.to_string().contains(words), "{name}: {refusal}");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("loop.png", lab.path("loop.png")).unwrap();
        assert!(matches!(
            lab.refusal(&[("loop.png", OutputKind::Picture)]),
            Some(OutputError::Locked { .. })
        ));
    }
}

#[test]
fn the_old_file_stays_until_the_new_one_is_whole() {
    let lab = Lab::new();
    let output = Output::new(lab.path("x.json"), OutputKind::Metrics).unwrap();
    written(&output, OLD).unwrap();
    let mut file = output.begin().unwrap();
    file.write_all(b"half").unwrap();
    assert_eq!((lab.text("x.json").as_str(), lab.names().len()), (OLD, 3));
    drop(file);
    assert_eq!((lab.text("x.json").as_str(), lab.names().len()), (OLD, 2), "given up");
    written(&output, "new").unwrap();
    assert_eq!((lab.text("x.json").as_str(), lab.names().len()), ("new", 2));
}

/// What a second Ctrl-C does, at any moment.
#[test]
fn a_program_that_is_ended_leaves_nothing_behind() {
    let lab = Lab::new();
    fs::write(lab.path("x.json"), OLD).unwrap();
    let partials = Partials::default();
    let mut files = Files::default();
    files.writes("--metrics", &lab.path("x.json"), OutputKind::Metrics);
    let output = files.check(&partials).unwrap().take_one(OutputKind::Metrics).unwrap();
    let mut file = output.begin().unwrap();
    file.write_all(b"half").unwrap();
    partials.discard();
    assert_eq!((lab.text("x.json").as_str(), lab.names().len()), (OLD, 2));
    assert!(output.keep(file).is_err() && output.begin().is_err(), "nothing after the end");
    assert_eq!((lab.text("x.json").as_str(), lab.names().len()), (OLD, 2));
    // A file that has its name is no longer partial.
    let partials = Partials::default();
    let mut files = Files::default();
    files.writes("--metrics", &lab.path("x.json"), OutputKind::Metrics);
    let output = files.check(&partials).unwrap().take_one(OutputKind::Metrics).unwrap();
    let mut file = output.begin().unwrap();
    file.publish().unwrap();
    file.write_all(b"growing").unwrap();
    partials.discard();
    assert_eq!(lab.text("x.json"), "growing");
}

#[test]
fn a_fresh_file_takes_no_others_place() {
    let lab = Lab::new();
    let output = Output::fresh(lab.path("x.png"), OutputKind::Picture).unwrap();
    written(&output, "first").unwrap();
    let error = written(&output, "second").unwrap_err();
    assert!(error.to_string().contains("x.png"), "{error}");
    assert_eq!((lab.text("x.png").as_str(), lab.names().len()), ("first", 2));
}

#[test]
#[cfg(unix)]
fn a_link_stays_one_and_permissions_are_a_plain_files() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
    let lab = Lab::new();
    fs::create_dir(lab.path("inner")).unwrap();
    symlink("inner/x.json", lab.path("link.json")).unwrap();
    let output = Output::new(lab.path("link.json"), OutputKind::Metrics).unwrap();
    written(&output, "one").unwrap();
    assert_eq!(
        (lab.text("inner/x.json"), fs::read_link(lab.path("link.json")).unwrap()),
        ("one".into(), "inner/x.json".into())
    );
    fs::File::create(lab.path("plain")).unwrap();
    let mode = |name: &str| fs::metadata(lab.path(name)).unwrap().mode();
    assert_eq!(mode("inner/x.json"), mode("plain"), "the system's mask decides");
    fs::set_permissions(lab.path("inner/x.json"), fs::Permissions::from_mode(0o640)).unwrap();
    written(&output, "two").unwrap();
    assert_eq!((lab.text("link.json").as_str(), mode("inner/x.json") & 0o777), ("two", 0o640));
}

#[test]
#[cfg(target_os = "linux")]
fn devices_and_pipes_are_written_as_they_are() {
    let lab = Lab::new();
    let null = Output::new("/dev/null", OutputKind::Picture).unwrap();
    written(&null, "gone").unwrap();
    use std::os::unix::fs::FileTypeExt;
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device(), "it is still there");
    // Writing to it twice loses nothing.
    assert!(lab.refusal(&[]).is_none());
    let mut files = Files::default();
    files.reads("a scan", Path::new("/dev/null"));
    files.writes("-o", Path::new("/dev/null"), OutputKind::Picture);
    files.writes("--depth", Path::new("/dev/null"), OutputKind::Depth);
    assert!(files.check(&Partials::default()).is_ok());
    let full = Output::new("/dev/full", OutputKind::Metrics).unwrap();
    let error = written(&full, "x").unwrap_err().to_string();
    assert!(error.contains("/dev/full") && error.contains("free space"), "{error}");
    // A file that the shell opened for us is written, not replaced.
    use std::os::fd::AsRawFd;
    let opened = fs::File::create(lab.path("opened")).unwrap();
    let by_number = format!("/proc/self/fd/{}", opened.as_raw_fd());
    let output = Output::new(&by_number, OutputKind::Metrics).unwrap();
    written(&output, "through").unwrap();
    assert_eq!((lab.text("opened").as_str(), opened.metadata().unwrap().len()), ("through", 7));
    // A file that is read is not written, even if the shell opened it.
    let scan = fs::File::options().append(true).open(lab.path("a.las")).unwrap();
    let by_number = PathBuf::from(format!("/proc/self/fd/{}", scan.as_raw_fd()));
    let mut files = Files::default();
    files.reads("a scan", &lab.path("a.las"));
    files.writes("-o", &by_number, OutputKind::Picture);
    assert!(matches!(files.check(&Partials::default()), Err(OutputError::IsRead { .. })));
}

#[test]
fn stdout_takes_one_output_and_no_scan() {
    let check = |writes: &[(&'static str, &str, OutputKind)], prints: bool| {
        let mut files = Files::default();
        writes.iter().for_each(|(option, path, kind)| files.writes(option, Path::new(path), *kind));
        if prints {
            files.prints();
        }
        files.check(&Partials::default()).map(drop)
    };
    let metrics = ("--metrics", "-", OutputKind::Metrics);
    assert!(check(&[metrics], false).is_ok());
    for (writes, prints) in [
        (&[metrics, ("--depth", "/dev/stdout", OutputKind::Depth)][..], false),
        (&[("-o", "-", OutputKind::Page)], true),
        (&[("-o", "-", SCAN)], false),
    ] {
        let refusal = check(writes, prints).expect_err("refused");
        assert!(refusal.is_usage(), "{refusal}");
    }
}
