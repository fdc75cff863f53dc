//! Rows of kind 5: colors by their distribution.

use super::desk::{Desk, RenderRun};
use super::las::{LasPoint, StrangeLas, place};
use super::{StrangerRow, judged, row};

const LINE: u8 = 5;
const EYE: [&str; 5] = ["scan.las", "--eye", "-14,-14,12", "--target", "0,0,2"];

/// Draws the place from a file whose colors `store` makes from the 16-bit ones.
fn drawn(desk: &Desk, format: u8, store: impl Fn(usize, &mut LasPoint)) -> Result<RenderRun, String> {
    let mut points = place(6000, [0.0; 3], 20.0);
    points.iter_mut().enumerate().for_each(|(i, point)| store(i, point));
    desk.put("scan.las", StrangeLas::new(format, points).bytes());
    desk.render(&EYE)
}

/// A row whose scene is drawn as it is in 16 bits, except for a few pixels of odd points and of rounding.
fn as_reference(
    name: &'static str,
    format: u8,
    store: fn(usize, &mut LasPoint),
    most_off: u8,
) -> StrangerRow {
    row(LINE, name, "the picture of the same scene in 16 bits", move |desk| {
        let want = drawn(desk, format, |_, _| ())?;
        let got = drawn(desk, format, store)?;
        let off = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).any(|c| a[c].abs_diff(b[c]) > most_off);
        let num = got.pixels.iter().zip(&want.pixels).filter(off).count();
        judged(
            num * 50 < want.lit() && got.lit() > 500,
            format!("{num} pixels differ, brightest {}", got.brightest()),
        )
    })
}

fn to_bits(point: &mut LasPoint, bits: u32) {
    point.rgb = point.rgb.map(|c| (f64::from(c) / 65535.0 * f64::from((1_u32 << bits) - 1)).round() as u16);
}

/// A row whose scene is shown by another figure than its colors, which is said.
fn not_by_color(
    name: &'static str,
    format: u8,
    store: fn(usize, &mut LasPoint),
    shown_by: &'static str,
) -> StrangerRow {
    let right = format!("shown by {shown_by}; info says why");
    row(LINE, name, right, move |desk| {
        let picture = drawn(desk, format, store)?;
        let text = String::from_utf8_lossy(&desk.run(&["info", "scan.las"]).out).into_owned();
        let said =
            text.lines().find(|line| line.contains("shown by")).unwrap_or("no such word").trim().to_owned();
        let mut shades = picture.pixels.clone();
        shades.sort_unstable();
        shades.dedup();
        let is_said = said.contains("all") || said.contains("none") || said.contains("same");
        judged(
            shades.len() > 30 && said.contains(shown_by) && is_said,
            format!("{} shades; {said}", shades.len()),
        )
    })
}

pub fn rows() -> Vec<StrangerRow> {
    let mut rows = vec![
        as_reference("8 bits", 2, |_, p| to_bits(p, 8), 3),
        as_reference("8 bits, LAS 1.4", 7, |_, p| to_bits(p, 8), 3),
        as_reference(
            "8 bits, one point has 256",
            2,
            |i, p| if i == 77 { p.rgb = [256; 3] } else { to_bits(p, 8) },
            3,
        ),
        as_reference(
            "8 bits, 3 points have 65535",
            7,
            |i, p| if i % 2500 == 9 { p.rgb = [65535; 3] } else { to_bits(p, 8) },
            3,
        ),
        as_reference(
            "8 bits in the high byte",
            2,
            |_, p| {
                to_bits(p, 8);
                p.rgb = p.rgb.map(|c| c << 8)
            },
            4,
        ),
        as_reference("12 bits", 2, |_, p| to_bits(p, 12), 3),
        as_reference(
            "12 bits, one point has 60000",
            7,
            |i, p| if i == 5 { p.rgb = [60_000; 3] } else { to_bits(p, 12) },
            3,
        ),
        as_reference("16 bits, a third of the points black", 2, |_, _| (), 3),
        not_by_color("all white (65535)", 2, |_, p| p.rgb = [65535; 3], "intensity"),
        not_by_color("all 1", 7, |_, p| p.rgb = [1; 3], "intensity"),
        not_by_color("all black", 2, |_, p| p.rgb = [0; 3], "intensity"),
        not_by_color(
            "all white (65535), one point has 65534",
            2,
            |i, p| p.rgb = [65535, 65535, if i == 0 { 65534 } else { 65535 }],
            "intensity",
        ),
        not_by_color(
            "all 255, 9 points red",
            7,
            |i, p| p.rgb = if i % 700 == 9 { [255, 0, 0] } else { [255; 3] },
            "intensity",
        ),
        not_by_color(
            "all 1, one point has 60000",
            2,
            |i, p| p.rgb = [if i == 5999 { 60_000 } else { 1 }; 3],
            "intensity",
        ),
        not_by_color(
            "65280 or 65535",
            2,
            |i, p| p.rgb = [if i % 2 == 0 { 65280 } else { 65535 }; 3],
            "intensity",
        ),
        not_by_color("0 or 1", 7, |i, p| p.rgb = [(i % 3 == 0).into(); 3], "intensity"),
        not_by_color("all white, intensity all 0", 2, |_, p| (p.rgb, p.intensity) = ([255; 3], 0), "height"),
    ];
    rows.push(row(
        LINE,
        "8 and 16 bits in one file",
        "a warning with the name; both halves bright",
        |desk| {
            let picture = drawn(desk, 2, |i, p| {
                if i % 2 == 0 {
                    to_bits(p, 8)
                }
            })?;
            let info = desk.info(&["scan.las"])?;
            let dark = picture.pixels.iter().filter(|p| **p != [0; 3] && p.iter().all(|c| *c < 20)).count();
            judged(
                dark * 20 < picture.lit() && info.says(&["scan.las", "8", "16"]),
                format!("{dark} dark pixels; {}", info.in_words()),
            )
        },
    ));
    type Merged = (&'static str, [&'static str; 2], fn(usize, &mut LasPoint));
    const MERGED: [Merged; 3] = [
        ("12 and 16 bits, one tile each", ["12", "16"], |i, p| {
            if i < 3000 {
                to_bits(p, 12)
            }
        }),
        ("8 and 12 bits, point by point", ["8", "12"], |i, p| to_bits(p, if i % 2 == 0 { 8 } else { 12 })),
        ("12 bits, every 100th point wild", ["12", "16"], |i, p| {
            if i % 100 != 3 {
                to_bits(p, 12)
            }
        }),
    ];
    for (name, bits, store) in MERGED {
        rows.push(row(
            LINE,
            name,
            "a warning with the bits; the picture of the same scene in 16 bits",
            move |desk| {
                let want = drawn(desk, 2, |_, _| ())?;
                let got = drawn(desk, 2, store)?;
                let info = desk.info(&["scan.las"])?;
                let off = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).any(|c| a[c].abs_diff(b[c]) > 3);
                let num = got.pixels.iter().zip(&want.pixels).filter(off).count();
                let is_said = info.says(&["scan.las", bits[0], bits[1], "bits at some points"]);
                judged(num * 50 < want.lit() && is_said, format!("{num} pixels differ; {}", info.in_words()))
            },
        ));
    }
    type Mixed = (&'static str, fn(usize) -> bool);
    const MIXED: [Mixed; 4] = [
        ("16 bits, a last tile of 4 % in 8 bits", |i| i >= 5760),
        ("16 bits, every 40th point in 8 bits", |i| i % 40 == 7),
        ("8 bits, a first tile of 4 % in 16 bits", |i| i >= 240),
        ("8 bits, every 40th point in 16 bits", |i| i % 40 != 7),
    ];
    for (name, is_eight) in MIXED {
        rows.push(row(
            LINE,
            name,
            "a warning with the name; the picture of the same scene in 16 bits",
            move |desk| {
                let want = drawn(desk, 2, |_, _| ())?;
                let got = drawn(desk, 2, |i, p| {
                    if is_eight(i) {
                        to_bits(p, 8)
                    }
                })?;
                let info = desk.info(&["scan.las"])?;
                let off = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).any(|c| a[c].abs_diff(b[c]) > 3);
                let num = got.pixels.iter().zip(&want.pixels).filter(off).count();
                let is_said = info.says(&["scan.las", "8", "16"]);
                judged(num * 50 < want.lit() && is_said, format!("{num} pixels differ; {}", info.in_words()))
            },
        ));
    }
    rows.push(as_reference(
        "8 bits, every 150th point has 256",
        2,
        |i, p| if i % 150 == 4 { p.rgb = [256; 3] } else { to_bits(p, 8) },
        3,
    ));
    rows.push(row(LINE, "50 % of the points black", "they are seen; a sentence", |desk| {
        let all = drawn(desk, 2, |_, _| ())?;
        let picture = drawn(desk, 2, |i, p| {
            if i % 2 == 0 {
                p.rgb = [0; 3]
            }
        })?;
        let info = desk.info(&["scan.las"])?;
        judged(
            picture.lit() == all.lit() && info.says(&["scan.las", "3,000 of 6,000 points"]),
            format!("{} of {} pixels are lit; {}", picture.lit(), all.lit(), info.in_words()),
        )
    }));
    rows.push(row(LINE, "97 % of the points black", "they stay visible; a sentence", |desk| {
        let picture = drawn(desk, 2, |i, p| {
            if i % 33 != 0 {
                p.rgb = [0; 3]
            }
        })?;
        let info = desk.info(&["scan.las"])?;
        judged(
            picture.lit() > 900 && info.says(&["scan.las", "color"]),
            format!("{} lit pixels; {}", picture.lit(), info.in_words()),
        )
    }));
    rows.push(row(LINE, "dark 16 bits (no value above 9000)", "dark, as it is", |desk| {
        let picture = drawn(desk, 7, |_, p| p.rgb = p.rgb.map(|c| c / 8))?;
        let brightest = picture.brightest();
        judged((20..60).contains(&brightest), format!("brightest {brightest}"))
    }));
    rows
}
