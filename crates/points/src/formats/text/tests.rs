//! Tests of text files that are made here.

use super::*;
use crate::{Block, Column, ColumnNames};

fn opened(
    name: &str,
    text: &[u8],
    columns: &str,
) -> Result<(tempfile::TempDir, Box<dyn Dataset>), ScanError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    let hints = OpenHints { columns: ColumnNames::named(columns).unwrap() };
    let dataset = crate::open(&path, &hints)?;
    Ok((folder, dataset))
}

/// All points of a file as one block, and what else is known of it.
fn read(name: &str, text: &[u8], columns: &str) -> Result<(Block, Trailer, Header), ScanError> {
    let (_folder, dataset) = opened(name, text, columns)?;
    let want = dataset.header().schema.projection();
    let mut blocks = Vec::new();
    let mut take = |block| {
        blocks.push(block);
        Ok(())
    };
    let trailer = dataset.read(&want, &mut take, &Progress::hidden())?;
    assert_eq!(blocks.len(), 1);
    Ok((blocks.remove(0), trailer, dataset.header().clone()))
}

fn places(block: &Block) -> Vec<[f64; 3]> {
    block.xyz.iter().map(|xyz| block.grid.p_in_world(*xyz).to_array()).collect()
}

fn rgb(block: &Block) -> Vec<[u16; 3]> {
    match block.column(&Attribute::Color) {
        Some(Column::U16x3(rgb)) => rgb.clone(),
        other => panic!("{other:?}"),
    }
}

fn intensity(block: &Block) -> Vec<u16> {
    match block.column(&Attribute::Intensity) {
        Some(Column::U16(intensity)) => intensity.clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn columns_are_found_and_shown() {
    for (name, text, format) in [
        ("a.xyz", "1 2 3\n4 5 6\n", "text, columns x y z"),
        ("a.csv", "X,Y,Z\n1,2,3\n", "text, columns x y z, separated by commas"),
        (
            "a.csv",
            "\"Y\",\"X\",\"Z\",\"OffsetTime\"\r\n1,2,3,0.5\r\n",
            "text, columns y x z OffsetTime, separated by commas",
        ),
        ("a.asc", "//X;Y;Z;R;G;B\n1;2;3;4;5;60\n", "text, columns x y z r g b, separated by semicolons"),
        ("a.txt", "1,5\t2\t3\n", "text, columns x y z, separated by tabs, with decimal commas"),
        ("a.pts", "1\n1 2 3 -1613 52 70 64\n", "PTS, columns x y z intensity r g b"),
        ("a.pts", "2\n1 2 3 7\n1 2 3 8\n", "PTS, columns x y z intensity"),
        ("a", "1 2 3 0.6 0 0.8\n4 5 6 0 1 0\n", "text, columns x y z nx ny nz"),
    ] {
        let (_folder, dataset) = opened(name, text.as_bytes(), "").unwrap();
        assert_eq!(dataset.header().format, format, "{text}");
    }
}

#[test]
fn values_go_where_names_say() {
    let text = "Z [mm]\tIntensity\tX [mm]\tClassification\tY [mm]\tr\tg\tb\tnote\n\
                3.5\t100\t1\t2\t2\t0.5\t1\t0\t7\n6\t300\t4\t6\t5\t0\t0\t0.25\t\n";
    let (block, trailer, header) = read("a.txt", text.as_bytes(), "").unwrap();
    assert_eq!(places(&block), [[1.0, 2.0, 3.5], [4.0, 5.0, 6.0]]);
    assert_eq!(rgb(&block), [[32768, 65535, 0], [0, 0, 16384]]);
    assert_eq!((intensity(&block), trailer.white), (vec![100, 300], Some(u16::MAX)));
    assert_eq!(block.column(&Attribute::Classification), Some(&Column::U8(vec![2, 6])));
    let Some(Column::F64(notes)) = block.column(&Attribute::Named("note".into())) else {
        panic!("{block:?}")
    };
    assert!(notes[0] == 7.0 && notes[1].is_nan());
    assert_eq!((header.unit_m, header.vertical_unit_m), (Some(0.001), None));
}

#[test]
fn words_among_numbers_are_not_read() {
    let text = "time,name,x,y,z\n10:00:00,\"a\",1,2,3\n10:00:01,,4,5,6\n";
    let (block, trailer, header) = read("a.csv", text.as_bytes(), "").unwrap();
    assert_eq!((places(&block), trailer.losses.len()), (vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], 0));
    assert_eq!(header.schema.unread, ["time", "name"]);
    assert_eq!(header.format, "text, columns - - x y z, separated by commas");
    let long = format!("{},x,y,z\n{}1,2,3\n", "name".repeat(200), ",");
    assert_eq!(places(&read("a.csv", long.as_bytes(), "").unwrap().0), [[1.0, 2.0, 3.0]]);
}

#[test]
fn a_user_says_what_columns_are() {
    let text = b"9 1 2 3 10 20 30 7\n9 4 5 6 40 50 60 8\n";
    let (block, _, header) = read("a.xyz", text, "-,x,y,z,r,g,b").unwrap();
    assert_eq!(places(&block), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    assert_eq!((rgb(&block)[1], &header.format[..]), ([40, 50, 60], "text, columns - x y z r g b -"));
    // They hold beside a header, and for rows that names do not fit.
    let (block, ..) = read("a.csv", b"u,v,w,i\n1,2,3,4\n", "x,y,z,i").unwrap();
    assert_eq!((places(&block), intensity(&block)), (vec![[1.0, 2.0, 3.0]], vec![4]));
    let error = opened("a.xyz", b"1 2 3\n", "x,y,z,i").map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("rows have 3 columns, and cloud.columns names 4"), "{error}");
}

#[test]
fn headers_that_name_no_place_are_told() {
    let error = opened("a.csv", b"time,volt,ampere\n1,2,3\n", "").map(|_| ()).unwrap_err().to_string();
    assert!(
        error.contains("its columns are time, volt, ampere") && error.contains("cloud.columns"),
        "{error}"
    );
    let (block, _, header) = read("a.txt", b"X,Y,X\n\n0, 0, 0\n.5, .5, 1\n", "").unwrap();
    assert_eq!(places(&block)[1], [0.5, 0.5, 1.0]);
    assert!(
        header.warnings[0].starts_with("names its columns X, Y, X, not x, y and z"),
        "{:?}",
        header.warnings
    );
}

#[test]
fn odd_rows_are_left_out_and_told() {
    let mut text = String::from("# a scan\n");
    for row in 0..1000 {
        text += &match row {
            7 => "1 2\n".into(),
            300 => "1 2 x3 4\n".into(),
            500 => "\n# between\n".into(),
            _ => format!("{row} {} 3.25 9\n", row * 2),
        };
    }
    let (block, trailer, _) = read("a.xyz", text.as_bytes(), "").unwrap();
    assert_eq!(block.xyz.len(), 997);
    assert_eq!(
        trailer.losses,
        ["has 2 lines that could not be read and were left out, first line 9, \"1 2\""]
    );
    let (_, trailer, _) = read("a.xyz", b"1 2 3\nnan nan nan\n4 5 6\n", "").unwrap();
    assert_eq!(trailer.warnings, ["has 1 point without a finite place; it was left out"]);
}

#[test]
fn counts_of_pts_may_repeat_and_lie() {
    let scan = |num: usize, said: usize| {
        let rows: String = (0..num).map(|n| format!("{n} 2 3 {} 1 2 99\n", n as i64 - 2048)).collect();
        format!("{said}\n{rows}")
    };
    let read = |text: String| {
        let (block, trailer, _) = read("a.pts", text.as_bytes(), "").unwrap();
        (block, trailer.losses, trailer.warnings)
    };
    let (block, losses, warnings) = read(scan(30, 30) + &scan(40, 40));
    assert_eq!((block.xyz.len(), losses.len(), warnings.len()), (70, 0, 0));
    assert_eq!((intensity(&block)[0], intensity(&block)[69], rgb(&block)[0]), (0, 65535, [1, 2, 99]));
    let (_, losses, _) = read(scan(30, 30) + &scan(40, 50));
    assert!(losses[0].starts_with("announces 80 points, but only 70 could be read"), "{losses:?}");
    let (_, losses, warnings) = read(scan(30, 5));
    assert_eq!((losses.len(), &warnings[0][..]), (0, "announces 5 points and has 30: all are read"));
}

#[test]
fn parts_meet_without_loss() {
    // Lines of different lengths fill several parts.
    let row = |n: usize| format!("{n}.5 {} {:.*} {}\r\n", n % 97, n % 13, n as f64 / 7.0, n % 1000);
    let text: String = (0..200_000).map(row).collect();
    assert!(text.len() > 3 << 20);
    let (block, trailer, header) = read("a.xyz", text.as_bytes(), "").unwrap();
    assert_eq!((block.xyz.len(), trailer.losses.len()), (200_000, 0));
    assert!(header.num_points.abs_diff(200_000) < 40_000, "{}", header.num_points);
    for (n, place) in places(&block).iter().enumerate().step_by(997) {
        assert!((place[0] - n as f64 - 0.5).abs() < 1e-4 && (place[1] - (n % 97) as f64).abs() < 1e-6);
        assert_eq!(intensity(&block)[n], (n % 1000) as u16);
    }
}

#[test]
fn a_line_without_end_costs_no_more_than_itself() {
    let long = "7".repeat(3 << 20);
    let text = format!("1 2 3\n{long}\n4 5 6\n");
    let (block, trailer, _) = read("a.xyz", text.as_bytes(), "").unwrap();
    assert_eq!((block.xyz.len(), trailer.losses.len()), (2, 1));
    let text = format!("1 2 3\n4 5 6\n{}", "8 ".repeat(5 << 20));
    assert_eq!(read("a.xyz", text.as_bytes(), "").unwrap().0.xyz.len(), 2);
}

#[test]
fn other_texts_are_not_taken_for_scans() {
    for (name, text, words) in [
        ("notes.txt", "Meeting on 1 2 3\nNothing decided\n", "no rows of numbers"),
        ("log.las", "~V\nVERS. 3.0\n~A\n1 2 3\n", "well log"),
        ("a.txt", "v 1 2 3\nv 4 5 6\n", "OBJ"),
        ("water.xyz", "3\nwater\nO 0.0 0.1 0.2\nH 0.3 0.2 0.1\n", "no rows of numbers"),
        (
            "a.asc",
            "ncols 3\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n4 5 6\n",
            "grid of heights",
        ),
        ("a.txt", "", "empty"),
    ] {
        let error = opened(name, text.as_bytes(), "").map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn cut_and_damaged_texts_are_survived() {
    let row = |n: i32| format!("{n}.5,{},{},{},{},{},{}\n", n * 2, n % 9, n - 100, n % 256, 3, 250 - n % 200);
    let text = "x,y,z,i,r,g,b\n".to_owned() + &(0..400).map(row).collect::<String>();
    let mut last = 0;
    for part in 1..=16 {
        let read = read("a.csv", &text.as_bytes()[..text.len() * part / 16], "");
        let num = read.map_or(0, |(block, ..)| block.xyz.len());
        assert!(num >= last && num + 2 >= 400 * part / 16, "{part}: {num}");
        last = num;
    }
    assert_eq!(last, 400);
    let mut random = 99u64;
    for _ in 0..300 {
        let mut damaged = text.clone().into_bytes();
        for _ in 0..5 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let at = (random >> 33) as usize % damaged.len();
            damaged[at] = (random >> 20) as u8;
        }
        if let Ok((block, ..)) = read("a.csv", &damaged, "") {
            assert!(block.xyz.len() >= 380);
        }
    }
}
