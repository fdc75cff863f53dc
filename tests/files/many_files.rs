//! Many files at once: more than a process may open, a bad one among good ones, one named twice, and files that only
//! lie beside scans.

use crate::PROGRAM;
use base::task::CancelToken;
use kit::las_files::Fixture;
use kit::program::{self, RunOutput};
use kit::reading;
use points::{ReadOptions, read};
use std::path::PathBuf;

fn strict() -> ReadOptions {
    ReadOptions { strict: true, ..ReadOptions::AS_FILES_SAY }
}

/// A folder with a file for each name.
fn folder(files: &[(&str, &[u8])]) -> (tempfile::TempDir, Vec<PathBuf>) {
    let folder = tempfile::tempdir().unwrap();
    let paths = files.iter().map(|(name, bytes)| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    });
    let paths = paths.collect();
    (folder, paths)
}

fn tile() -> Vec<u8> {
    Fixture::new(3).with_points(5).bytes()
}

fn info(options: &[&str], paths: &[PathBuf]) -> RunOutput {
    program::run(program::command(PROGRAM).arg("info").args(options).args(paths))
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_among_good_tiles_is_named_and_the_rest_is_read() {
    let (folder, mut paths) = folder(&[("good.las", &tile())]);
    let link = folder.path().join("gone.las");
    std::os::unix::fs::symlink("elsewhere.las", &link).unwrap();
    paths.push(link.clone());
    let scan = reading::files(&paths).unwrap();
    assert_eq!((scan.num_points(), scan.warnings.len()), (5, 1));
    let warning = &scan.warnings[0];
    assert!(
        warning.contains("gone.las") && warning.contains("link to a file that is not there"),
        "{warning}"
    );
    let alone = reading::files(&[link]).unwrap_err().to_string();
    assert!(alone.contains("gone.las") && alone.contains("link"), "{alone}");
}

#[test]
fn a_bad_tile_among_good_ones_is_named_and_the_rest_is_read() {
    let tile = tile();
    let cut = &tile[..100];
    let (folder, paths) =
        folder(&[("bad_1.las", cut), ("good_1.las", &tile), ("bad_2.ply", b"ply\n"), ("good_2.las", &tile)]);
    let scan = reading::files(&paths).unwrap();
    assert_eq!((scan.num_points(), scan.files.len(), scan.warnings.len()), (10, 2, 2));
    for (warning, name) in scan.warnings.iter().zip(["bad_1.las: ", "bad_2.ply: "]) {
        assert!(warning.contains(name) && warning.contains("left out"), "{warning}");
    }
    // The files are read in both orders: the order of good and bad does not matter.
    let (bad, good) = (&paths[0], &paths[1]);
    for (paths, num_points) in [([good, bad], 5), ([bad, good], 5)] {
        assert_eq!(reading::files(&paths.map(Clone::clone)).unwrap().num_points(), num_points);
    }
    let refused = |paths: &[PathBuf], options: &ReadOptions| {
        read(paths, options, &CancelToken::default()).map(|scan| scan.num_points()).unwrap_err().to_string()
    };
    assert!(refused(&paths, &strict()).contains("bad_1.las: "));
    let bad = [paths[2].clone(), paths[0].clone()];
    assert!(refused(&bad, &ReadOptions::AS_FILES_SAY).contains("bad_2.ply: "), "nothing can be read");
    assert!(refused(&paths[..1], &ReadOptions::AS_FILES_SAY).contains("bad_1.las: "), "one alone");
    // A name that no file has is a slip in the command, not a bad tile.
    let missing = [paths[1].clone(), folder.path().join("missing.las")];
    assert!(refused(&missing, &ReadOptions::AS_FILES_SAY).contains("missing.las: "));
}

/// What is left of files that end too early, or hold a row that is none, is shown, unless strict reading is asked
/// for.
#[test]
fn what_is_not_whole_is_refused_when_told_to_be_strict() {
    let tile = tile();
    let rows = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    let (whole_ply, cut_ply) = (format!("{rows}0 0 0\n1 0 0\n0 1 0\n"), format!("{rows}0 0 0\n1 0 0\n"));
    let bad_row = format!("{rows}0 0 0\n1 zero 0\n0 1 0\n");
    let (_folder, paths) = folder(&[
        ("whole.las", &tile),
        ("whole.ply", whole_ply.as_bytes()),
        ("cut.las", &tile[..tile.len() - 10]),
        ("cut.ply", cut_ply.as_bytes()),
        ("row.ply", bad_row.as_bytes()),
    ]);
    let strictly = |paths: &[PathBuf]| {
        let scan = read(paths, &strict(), &CancelToken::default());
        scan.map(|scan| scan.num_points()).map_err(|error| error.to_string())
    };
    let [las, ply, parts @ ..] = &paths[..] else { panic!("{paths:?}") };
    assert_eq!(strictly(&[las.clone(), ply.clone()]), Ok(8));
    for ((whole, part), num_points) in [las, ply, ply].into_iter().zip(parts).zip([9, 5, 5]) {
        let both = [whole.clone(), part.clone()];
        let scan = reading::files(&both).unwrap();
        assert_eq!((scan.num_points(), scan.warnings.len()), (num_points, 1), "{:?}", scan.warnings);
        let refused = strictly(&both).unwrap_err();
        assert!(refused.contains(&part.display().to_string()) && refused.contains("--strict"), "{refused}");
    }
}

#[test]
fn the_commands_refuse_when_told_to_be_strict() {
    let tile = tile();
    let (_folder, paths) = folder(&[("a.las", &tile), ("b.las", b"no scan")]);
    let lenient = info(&[], &paths);
    assert!(lenient.ok().text().contains("b.las: is not a LAS"));
    for options in [&["--strict"][..], &["--set", "cloud.strict=true"]] {
        let strict = info(options, &paths);
        assert_eq!((strict.code, strict.out.len()), (Some(1), 0));
        assert!(strict.err.contains("b.las: is not a LAS"));
    }
}

/// There are as many tiles as a state's survey has. A shell allows 1024 open files; here it is 64, to be quick.
#[cfg(unix)]
#[test]
fn more_tiles_than_open_files_are_read() {
    let tile = tile();
    let names: Vec<String> = (0..100).map(|i| format!("tile_{i}.las")).collect();
    let files: Vec<(&str, &[u8])> = names.iter().map(|name| (name.as_str(), &tile[..])).collect();
    let (folder, _) = folder(&files);
    let command = "ulimit -n 64 && exec \"$0\" info --json \"$1\"/*.las";
    let mut shell = program::command("sh");
    let json = program::run(shell.args(["-c", command, PROGRAM]).arg(folder.path())).ok().json();
    assert_eq!((&json["points"], &json["warnings"]), (&500.into(), &serde_json::json!([])));
}

#[test]
fn what_lies_beside_scans_and_what_is_named_twice_is_said() {
    let tile = tile();
    let (folder, mut paths) =
        folder(&[("a.las", &tile), ("a.lax", b"LASX"), ("a.prj", b"PROJCS"), ("b.las", &tile)]);
    paths.push(folder.path().join(".").join("b.las"));
    let scan = reading::files(&paths).unwrap();
    assert_eq!((scan.num_points(), scan.warnings.len()), (10, 2));
    assert!(scan.warnings[0].contains("a.prj: passed over"), "{:?}", scan.warnings);
    assert!(scan.warnings[1].contains("b.las: named twice"), "{:?}", scan.warnings);
    let error = reading::files(&paths[1..3]).map(|scan| scan.num_points()).unwrap_err().to_string();
    assert!(error.contains("a.lax: lies beside a scan"), "{error}");
}

#[test]
fn a_well_log_says_that_it_is_one() {
    let (_folder, paths) =
        folder(&[("log.las", b"~VERSION INFORMATION\n VERS. 2.0 : CWLS\n~ASCII\n1670.0 123.45\n")]);
    let error = reading::files(&paths).map(|scan| scan.num_points()).unwrap_err().to_string();
    assert!(error.contains("log.las: ") && error.contains("well log"), "{error}");
}
