//! Rows of kind 9: many files, and files that are no scans.

use super::desk::Desk;
use super::las::{StrangeLas, place};
use super::{StrangerRow, judged, row};

const LINE: u8 = 9;

fn tile(number: usize) -> Vec<u8> {
    let at = [20.0 * number as f64, 0.0, 0.0];
    StrangeLas::new(2, place(100, at, 20.0)).bytes()
}

fn tiles(desk: &Desk, num: usize) -> Vec<String> {
    let name = |number: usize| {
        let name = format!("tile_{number}.las");
        desk.put(&name, tile(number));
        name
    };
    (0..num).map(name).collect()
}

fn refused_with(
    name: &'static str,
    bytes: fn() -> Vec<u8>,
    words: &'static [&'static str],
    not: &'static str,
) -> StrangerRow {
    row(LINE, name, format!("exit 1, a sentence with {words:?}, not \"{not}\""), move |desk| {
        desk.put("odd.las", bytes());
        let ran = desk.run(&["info", "odd.las"]);
        judged(ran.code == Some(1) && ran.says(words) && !ran.says(&[not]), ran.in_words())
    })
}

pub fn rows() -> Vec<StrangerRow> {
    let mut rows = vec![
        row(LINE, "1 200 tiles, 1 024 open files allowed", "all points", |desk| {
            let one = tile(0);
            desk.put("tile.las", one);
            let names: Vec<String> = (0..1200).map(|number| format!("copy_{number}.las")).collect();
            names.iter().for_each(|name| {
                std::fs::copy(desk.path("tile.las"), desk.path(name)).expect("a copy");
            });
            let args: Vec<&str> = names.iter().map(String::as_str).collect();
            let info = desk.info(&args)?;
            judged(info.points() == 120_000, format!("{} points", info.points()))
        }),
        row(
            LINE,
            "6 tiles, one of them cut off in its header",
            "a warning with its name; 5 are shown",
            |desk| {
                let names = tiles(desk, 6);
                desk.put("tile_3.las", &tile(3)[..100]);
                let info = desk.info(&names.iter().map(String::as_str).collect::<Vec<_>>())?;
                judged(info.points() == 500 && info.says(&["tile_3.las"]), info.in_words())
            },
        ),
        row(LINE, "the same, --strict", "exit 1, its name", |desk| {
            let names = tiles(desk, 6);
            desk.put("tile_3.las", "nothing of the kind");
            let args: Vec<&str> =
                ["info", "--strict"].into_iter().chain(names.iter().map(String::as_str)).collect();
            let ran = desk.run(&args);
            judged(ran.code == Some(1) && ran.says(&["tile_3.las"]), ran.in_words())
        }),
        row(LINE, "one file, and nothing of it can be read", "exit 1, its name", |desk| {
            desk.put("tile_3.las", &tile(3)[..100]);
            let ran = desk.run(&["info", "tile_3.las"]);
            judged(ran.code == Some(1) && ran.says(&["tile_3.las"]), ran.in_words())
        }),
        row(LINE, "a file twice, by another way and by a link", "once, and a sentence", |desk| {
            desk.put("a.las", tile(0));
            std::os::unix::fs::symlink("a.las", desk.path("link.las")).expect("a link");
            let info = desk.info(&["a.las", "./a.las", "link.las"])?;
            judged(info.points() == 100 && info.says(&["a.las", "once"]), info.in_words())
        }),
        row(LINE, "sidecars beside the scans", "passed over by name", |desk| {
            let mut names = tiles(desk, 2);
            for name in ["tile_0.lax", "tile_1.prj", "all.tfw", "tile_1.aux.xml"] {
                desk.put(name, "PROJCS[]");
                names.push(name.into());
            }
            let info = desk.info(&names.iter().map(String::as_str).collect::<Vec<_>>())?;
            judged(info.points() == 200 && info.says(&["tile_0.lax", "tile_1.prj"]), info.in_words())
        }),
        row(LINE, "a header of 3 MiB", "read, not called cut off", |desk| {
            let comments =
                "comment as some exporters keep their whole history in here, line by line\n".repeat(45_000);
            let head = format!("ply\nformat ascii 1.0\n{comments}element vertex 4\n");
            desk.put("long.ply", head + "property float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
            let ran = desk.run(&["info", "--json", "long.ply"]);
            judged(ran.code == Some(0) && !ran.says(&["cut off"]), ran.in_words())
        }),
    ];
    let well_log = || {
        b"~Version information\n VERS. 2.0 : CWLS log ASCII Standard\n~Well\n~A DEPTH GR\n100.0 55.2\n"
            .to_vec()
    };
    rows.extend([
        refused_with("a well log", well_log, &["odd.las", "well log"], "convert it to LAS"),
        refused_with(
            "a ZIP archive",
            || b"PK\x03\x04\x14\0\0\0\x08\0".repeat(30),
            &["odd.las", "unpack"],
            "convert it",
        ),
        refused_with(
            "a gzip archive",
            || b"\x1f\x8b\x08\0\0\0\0\0\0\x03".repeat(30),
            &["odd.las", "unpack"],
            "convert it",
        ),
        refused_with(
            "a 7-Zip archive",
            || b"7z\xbc\xaf\x27\x1c\0\x04".repeat(30),
            &["odd.las", "unpack"],
            "convert it",
        ),
        refused_with(
            "a Zstandard archive",
            || b"\x28\xb5\x2f\xfd\x04\0".repeat(60),
            &["odd.las", "unpack"],
            "convert it",
        ),
    ]);
    rows
}
