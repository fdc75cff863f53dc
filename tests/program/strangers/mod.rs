//! What strangers hand to the program: odd inputs of every kind that is known to have gone wrong elsewhere, each
//! written here and given to the program as a user would. The table tells for each input what is right and what came
//! of it, and fails if any row is wrong. Its columns are the kind (files that must not be lost, holes, first views,
//! small scans, colors, units, far points, PLY, many files), input, right, got.

// Links and identities of files are made as Unix has them.
#![cfg(unix)]

mod colors;
mod desk;
mod las;
mod many;
mod outputs;
mod ply;
mod units;
mod views;

use desk::Desk;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The outcome of a row, in words: `Ok` if it is as it should be.
type Outcome = Result<String, String>;

/// A row of the table.
struct StrangerRow {
    kind: u8,
    input: String,
    right: String,
    /// Runs the row on a desk of its own.
    check: Box<dyn Fn(&Desk) -> Outcome + Send + Sync>,
}

fn row(
    kind: u8,
    input: impl Into<String>,
    right: impl Into<String>,
    check: impl Fn(&Desk) -> Outcome + Send + Sync + 'static,
) -> StrangerRow {
    StrangerRow { kind, input: input.into(), right: right.into(), check: Box::new(check) }
}

fn judged(is_right: bool, got: String) -> Outcome {
    if is_right { Ok(got) } else { Err(got) }
}

const KINDS: [&str; 10] =
    ["", "kept", "holes", "first view", "small", "colors", "units", "far", "PLY", "files"];

/// Programs that run at once.
const AT_ONCE: usize = 2;

/// Runs all rows; returns their outcomes.
fn run(rows: &[StrangerRow]) -> Vec<Outcome> {
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<Option<Outcome>>> = Mutex::new(rows.iter().map(|_| None).collect());
    std::thread::scope(|scope| {
        for _ in 0..AT_ONCE {
            scope.spawn(|| {
                while let Some((at, row)) = rows.iter().enumerate().nth(next.fetch_add(1, Ordering::Relaxed))
                {
                    let got = (row.check)(&Desk::new());
                    results.lock().expect("no row panics")[at] = Some(got);
                }
            });
        }
    });
    results.into_inner().expect("no row panics").into_iter().map(|got| got.expect("each row ran")).collect()
}

/// Prints the table; returns how many rows are wrong.
fn print(rows: &[StrangerRow], results: &[Outcome]) -> usize {
    let mut num_wrong = 0;
    println!("| kind | input | right | got | |\n|---|---|---|---|---|");
    for (row, got) in rows.iter().zip(results) {
        let (mark, words) = match got {
            Ok(words) => ("ok", words),
            Err(words) => {
                num_wrong += 1;
                ("WRONG", words)
            }
        };
        let cell = |text: &str| text.replace(['|', '\n'], "/");
        let cells = [KINDS[usize::from(row.kind)], &row.input, &row.right, words, mark].map(cell);
        println!("| {} |", cells.join(" | "));
    }
    println!("{} inputs, {num_wrong} wrong", rows.len());
    num_wrong
}

#[test]
fn odd_inputs_come_out_right() {
    let all = [outputs::rows(), views::rows(), colors::rows(), units::rows(), ply::rows(), many::rows()];
    let mut rows: Vec<StrangerRow> = all.into_iter().flatten().collect();
    rows.sort_by_key(|row| row.kind);
    // One kind can be run alone, to mend it.
    if let Ok(only) = std::env::var("STRANGERS_KIND") {
        rows.retain(|row| KINDS[usize::from(row.kind)] == only);
    }
    let results = run(&rows);
    assert_eq!(print(&rows, &results), 0, "rows are wrong");
}

/// The table can fail: a row whose expectation does not hold, and one whose program does not even start its work.
#[test]
fn a_wrong_row_is_counted() {
    let rows = [
        row(4, "a black picture", "lit", |desk| {
            desk.put("a.las", las::StrangeLas::new(2, las::place(50, [0.0; 3], 9.0)).bytes());
            let picture =
                desk.render(&["a.las", "--eye", "0,0,50", "--target", "0,0,90", "--up", "0,1,0"])?;
            judged(picture.lit() > 0, format!("{} lit pixels", picture.lit()))
        }),
        row(9, "no file", "read", |desk| desk.info(&["no-such.las"]).map(|info| info.in_words())),
        row(9, "a scan", "read", |desk| {
            desk.put("a.las", las::StrangeLas::new(7, las::place(50, [0.0; 3], 9.0)).bytes());
            let info = desk.info(&["a.las"])?;
            judged(info.points() == 50, info.in_words())
        }),
    ];
    assert_eq!(print(&rows, &run(&rows)), 2);
}
