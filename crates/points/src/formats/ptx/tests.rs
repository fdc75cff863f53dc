//! Tests of PTX files that are written here: what is read of them, and whatever can be wrong.

use super::*;
use crate::block::Block;
use crate::column::Column;
use glam::DVec3;

/// A scan of `rows` that announces `columns` × `num_rows` and is turned from x to y.
fn scan(columns: usize, num_rows: usize, rows: &str) -> String {
    format!(
        "{columns}\n{num_rows}\n100 0 5\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n100 0 5 1\n{rows}"
    )
}

/// Rows of 7 numbers, of which each fourth has no return.
fn rows(num: usize) -> String {
    let row = |n: usize| match n % 4 {
        1 => "0 0 0 0.500000 0 0 0\n".to_owned(),
        _ => format!("{}.25 {} -1.5 {} {} 7 255\n", n, n % 100, n as f64 / num as f64, n % 256),
    };
    (0..num).map(row).collect()
}

fn read_with(bytes: &[u8]) -> Result<(Header, Block, Trailer), String> {
    let folder = tempfile::tempdir().unwrap();
    // The content tells the format, not the ending.
    let path = folder.path().join("a.txt");
    std::fs::write(&path, bytes).unwrap();
    let source = Source::open(&path).unwrap();
    let head = source.bytes(0, 512).unwrap();
    if !Ptx.probe(&Candidate { path: &path, is_folder: false, head: &head }) {
        return Err("it is no PTX".into());
    }
    let file = Ptx.open(&path, &OpenHints::default()).map_err(|error| error.to_string())?;
    let mut blocks = Vec::new();
    let mut take = |block| {
        blocks.push(block);
        Ok(())
    };
    let want = file.header().schema.projection();
    let trailer = file.read(&want, &mut take, &Progress::hidden()).map_err(|error| error.to_string())?;
    Ok((file.header().clone(), blocks.remove(0), trailer))
}

fn places(block: &Block) -> Vec<DVec3> {
    block.xyz.iter().map(|&xyz| block.grid.p_in_world(xyz)).collect()
}

/// Where row `n` of [`rows`] is.
fn expected(n: usize) -> DVec3 {
    DVec3::new(100.0 - (n % 100) as f64, n as f64 + 0.25, 3.5)
}

#[test]
fn scans_are_turned_and_moved_and_rows_of_zeros_are_no_points() {
    // More rows than a part has, whatever ends their lines.
    let num = 40_000;
    let text = scan(200, 200, &rows(num)) + &scan(3, 1, "1 2 3 0\n1 2 4 1\n1\t2  5 0.5\n");
    for text in
        [text.clone(), text.replace('\n', "\r\n"), text.replace('\n', "\r"), format!("\u{feff}{text}")]
    {
        let (header, block, trailer) = read_with(text.as_bytes()).unwrap();
        let kept: Vec<usize> = (0..num).filter(|n| n % 4 != 1).collect();
        let mut all: Vec<DVec3> = kept.iter().map(|&n| expected(n)).collect();
        all.extend([3.0, 4.0, 5.0].map(|z| DVec3::new(98.0, 1.0, z + 5.0)));
        assert!(places(&block) == all, "{:?}", &places(&block)[..3]);
        let Some(Column::U16x3(rgb)) = block.column(&Attribute::Color) else { panic!() };
        let Some(Column::U16(intensity)) = block.column(&Attribute::Intensity) else { panic!() };
        let Some(Column::F64(raw)) = block.column(&Attribute::Named(INTENSITY.into())) else { panic!() };
        assert_eq!(
            (rgb[1], intensity[1], raw[1]),
            ([2, 7, 255], (2.0f64 / 40_000.0 * 65535.0).round() as u16, 2.0 / 40_000.0)
        );
        assert_eq!((rgb[kept.len()], intensity[kept.len()..].to_vec()), ([0; 3], vec![0, 65535, 32768]));
        let Some(Column::U16(ids)) = block.column(&Attribute::SourceId) else { panic!() };
        assert_eq!((ids[0], ids[kept.len() - 1], ids[kept.len()]), (1, 1, 2));
        assert_eq!((header.num_points, header.stations.len()), (40_003, 2));
        assert_eq!(header.stations[1].file_from_station.unwrap().position, DVec3::new(100.0, 0.0, 5.0));
        assert_eq!(trailer.warnings, ["has 10000 points without a return (0 0 0); they were left out"]);
        assert!(trailer.losses.is_empty(), "{:?}", trailer.losses);
    }
}

#[test]
fn counts_that_lie_and_rows_that_break_are_said() {
    let text = scan(2, 2, "1 2 3 0.5\nbroken\n4 5 6 0.25\n7 8 9 1\n1 1 1 1\n\n") + &scan(5, 5, "1 2 3 0\n");
    let (_, block, trailer) = read_with(text.as_bytes()).unwrap();
    assert_eq!(block.xyz.len(), 5);
    let at = text.find("broken").unwrap();
    assert_eq!(
        trailer.losses,
        [
            "announces 25 rows in scan 2, of which 1 are there".to_owned(),
            format!("has 1 row that could not be read and was left out, first at byte {at}")
        ]
    );
    assert_eq!(trailer.warnings, ["has 2 more rows than announced; they were read"]);
    let none = |text: &str| read_with(text.as_bytes()).err().unwrap();
    assert!(none(&scan(1, 1, "0 0 0 0.5\n")).contains("all its rows are without a return"));
    assert!(none(&scan(1, 1, "")).contains("no rows"));
    assert!(none("1\n1\n0 0 0\n1 0 0\n0 1 0\n").contains("ends within the ten lines"));
}

#[test]
fn rows_may_have_color_or_intensity_alone() {
    let names = |row: &str| read_with(scan(1, 1, row).as_bytes()).unwrap().0.schema.names();
    assert_eq!(names("1 2 3\n"), ["point_source_id"]);
    assert_eq!(names("1 2 3 0.5\n"), ["intensity", "point_source_id"]);
    assert_eq!(names("1 2 3 9 8 7\n"), ["rgb", "point_source_id"]);
    assert_eq!(names("1 2 3 0.5 9 8 7\n"), ["rgb", "intensity", "point_source_id"]);
}

#[test]
fn a_cut_file_keeps_its_whole_rows() {
    let text = scan(10, 10, &rows(100));
    let cut = text.len() - 9;
    let (_, block, trailer) = read_with(&text.as_bytes()[..cut]).unwrap();
    assert_eq!(block.xyz.len(), 74);
    assert_eq!(places(&block)[73], expected(98));
    assert!(trailer.losses.len() == 1 && trailer.losses[0].contains("1 row that could not be read"));
    // A whole file may lack the end of its last line.
    let (_, block, trailer) = read_with(text.trim_end().as_bytes()).unwrap();
    assert_eq!((block.xyz.len(), trailer.losses.len()), (75, 0));
    for part in 0..32 {
        let _ = read_with(&text.as_bytes()[..text.len() * part / 32]);
    }
    let mut random = base::random::Rng::new(5, 0);
    for _ in 0..400 {
        let mut changed = text.clone().into_bytes();
        for _ in 0..=random.bits() % 8 {
            let at = (random.bits() % changed.len() as u64) as usize;
            let at = if random.bits().is_multiple_of(2) { at % 90 } else { at };
            changed[at] = b"0 9\n.-e\xff1\r"[(random.bits() % 10) as usize];
        }
        let _ = read_with(&changed);
    }
}
