//! Rows of kinds 2, 3, 4 and 7: no holes, the first view, small scans, far points.

use super::desk::Desk;
use super::las::{LasPoint, StrangeLas, place, room, strays};
use super::{Outcome, StrangerRow, judged, row};

const UTM: [f64; 3] = [500_000.0, 5_000_000.0, 400.0];

/// Checks that the walk begins near a place of `edge` round `center`, at arm's length if it is small, and that the
/// place fills the default picture.
fn first_view(desk: &Desk, args: &[&str], center: [f64; 3], edge: f64) -> Outcome {
    let (away, words) = desk.start(args)?.from(center);
    let picture = desk.render(args)?;
    let got = format!("start {words}; picture filled to {:.0} %", 100.0 * picture.span());
    judged(away < (2.5 * edge).max(1.0) && picture.span() >= 0.7 && picture.lit() > 20, got)
}

/// A place among strays.
fn among(num: usize, center: [f64; 3], edge: f64, strays: Vec<LasPoint>) -> StrangeLas {
    let mut points = place(num, center, edge);
    points.extend(strays);
    StrangeLas::new(2, points).at([center[0].round(), center[1].round(), 0.0]).scaled([0.01; 3])
}

fn around(center: [f64; 3], reach: [f64; 3], num: usize) -> Vec<LasPoint> {
    let low = [0, 1, 2].map(|axis| center[axis] - reach[axis]);
    strays(num, low, [0, 1, 2].map(|axis| center[axis] + reach[axis]))
}

/// Points all over a closed sphere of radius 5, seen from inside.
fn sphere(num: usize) -> StrangeLas {
    let point = |direction: glam::DVec3| {
        let at = (5.0 * direction).to_array();
        LasPoint { at, rgb: [50_000, 60_000, 55_000], ..LasPoint::default() }
    };
    StrangeLas::new(2, kit::spread::directions(num).map(point).collect()).scaled([0.0001; 3])
}

pub fn rows() -> Vec<StrangerRow> {
    let mut rows = holes();
    rows.extend(border());
    rows.extend(scenes());
    rows.extend(small());
    rows.extend(far());
    rows
}

fn holes() -> Vec<StrangerRow> {
    const ANGLES: [(&str, &str); 2] = [("Valve Index", "60,40,55,55"), ("Quest 3", "54,40,44,55")];
    let of = |preset: &'static str, (headset, angles): (&str, &'static str), thresholds: &'static str| {
        let name = format!("closed sphere from inside, {preset}, {headset}, thresholds {thresholds}");
        row(2, name, "at most 0.05 % of the pixels empty", move |desk| {
            desk.put("sphere.las", sphere(900_000).bytes());
            let set = format!("lod.threshold_px={thresholds}");
            let look = ["--preset", preset, "--set", "fovea.smooth=false", "--set", &set];
            let view =
                ["--half-angles", angles, "--eye", "0.3,0.2,0.1", "--target", "4,1,0.5", "--size", "480x533"];
            let pixels = sized(desk, &[&["sphere.las"], &look[..], &view].concat())?;
            let empty = pixels.iter().filter(|pixel| **pixel == [0; 3]).count();
            judged(empty * 2000 <= pixels.len(), format!("{empty} of {} pixels", pixels.len()))
        })
    };
    vec![
        of("balanced", ANGLES[0], "[100,200,300]"),
        of("performance", ANGLES[1], "[150,300,450]"),
        of("balanced", ANGLES[1], "[300,600,900]"),
        of("quality", ANGLES[0], "[70,105,140]"),
    ]
}

/// A crop of a picture is the same part of the larger one, also at its border.
fn border() -> Vec<StrangerRow> {
    let of = |name: &'static str, half_angles: &'static str, first: [usize; 2]| {
        row(2, format!("a crop at the {name}"), "the same pixels as in the larger picture", move |desk| {
            desk.put("place.las", StrangeLas::new(2, place(30_000, [0.0; 3], 20.0)).bytes());
            let args = ["place.las", "--preset", "balanced", "--eye", "-12,-9,5", "--target", "0,0,2"];
            let whole = desk.render(
                &[&args[..], &["--half-angles", "45,45,33.69006752597979,33.69006752597979"]].concat(),
            )?;
            let size = ["--size", "48x32", "--half-angles", half_angles];
            let crop = sized(desk, &[&args[..], &size].concat())?;
            let unlike = (0..48 * 32).filter(|at| {
                let (x, y) = (first[0] + at % 48, first[1] + at / 48);
                whole.pixels[y * 96 + x] != crop[*at]
            });
            let num = unlike.count();
            // The angles are given as decimals: a point at a pixel's edge may fall to the other side.
            judged(num <= 8 && whole.lit() > 1000, format!("{num} of 1536 pixels differ"))
        })
    };
    // Tangents of the whole run from −1 to 1 and from −2/3 to 2/3; these parts are halves and quarters of it.
    vec![
        of("middle", "26.56505117707799,26.56505117707799,18.43494882292201,18.43494882292201", [24, 16]),
        of("top left", "45,0,33.69006752597979,0", [0, 0]),
    ]
}

/// Renders in another size than the desk's.
fn sized(desk: &Desk, args: &[&str]) -> Result<Vec<[u8; 3]>, String> {
    let ran = desk.run(&[&["render", "-o", "sized.png"], args].concat());
    let bytes = std::fs::read(desk.path("sized.png")).map_err(|_| ran.in_words())?;
    super::desk::decoded(&bytes)
}

fn scenes() -> Vec<StrangerRow> {
    const NEAR: &str = "start and picture of the scene";
    let of = |name: &str, make: fn() -> StrangeLas, center: [f64; 3], edge: f64| {
        row(3, name, NEAR, move |desk| {
            desk.put("scene.las", make().bytes());
            first_view(desk, &["scene.las"], center, edge)
        })
    };
    let mut rows = vec![
        of(
            "40 points, 1 at 5 km",
            || among(40, UTM, 20.0, strays(1, [505e3, 5e6, 9.0], [506e3, 5e6, 9.0])),
            UTM,
            20.0,
        ),
        of(
            "150 points, 1 at 80 km",
            || among(150, UTM, 30.0, strays(1, [58e4, 5e6, 9.0], [58e4, 5e6, 9.0])),
            UTM,
            30.0,
        ),
        of("5000 points, 15 % zeros", || among(5000, UTM, 20.0, vec![LasPoint::default(); 880]), UTM, 20.0),
        of("8000 points, 4 % all around", || among(8000, UTM, 8.0, around(UTM, [9e3; 3], 330)), UTM, 8.0),
        of(
            "3000 points, 18 % in a clump",
            || among(3000, UTM, 25.0, around([UTM[0] + 7e3, UTM[1], 900.0], [2.0; 3], 650)),
            UTM,
            25.0,
        ),
        of(
            "2000 points of 5 cm, 3 strays",
            || {
                let mut scene = among(2000, [0.0; 3], 0.05, around([90.0, 5.0, 3.0], [1.0; 3], 3));
                scene.scale = [1e-5; 3];
                scene
            },
            [0.0; 3],
            0.05,
        ),
        of(
            "a strip of 4 km by 20 m, none",
            || {
                let mut points = place(6000, UTM, 20.0);
                points.iter_mut().for_each(|point| point.at[0] = UTM[0] + 200.0 * (point.at[0] - UTM[0]));
                StrangeLas::new(2, points).at([500_000.0, 5_000_000.0, 0.0])
            },
            UTM,
            4000.0,
        ),
    ];
    rows.push(row(3, "2 % high noise (class 18), 3 km up", NEAR, |desk| {
        let mut noise = around([UTM[0], UTM[1], 3000.0], [400.0, 400.0, 900.0], 120);
        noise.iter_mut().for_each(|point| point.class = 18);
        desk.put("noise.las", among(6000, UTM, 20.0, noise).bytes());
        let info = desk.info(&["noise.las"])?;
        let got = first_view(desk, &["noise.las"], UTM, 20.0)?;
        judged(info.says(&["noise"]), format!("{got}; {}", info.in_words()))
    }));
    for (format, name) in [(2, "LAS 1.2"), (7, "LAS 1.4")] {
        let name = format!("withheld points, {name}");
        row_of_withheld(&mut rows, name, format);
    }
    rows.push(row(3, "two files 4500 km apart", "a warning with both names; the larger part", |desk| {
        desk.put("near.las", StrangeLas::new(2, place(900, [0.0; 3], 20.0)).bytes());
        let far = StrangeLas::new(2, place(3000, UTM, 20.0)).at([5e5, 5e6, 0.0]);
        desk.put("utm.las", far.bytes());
        let info = desk.info(&["near.las", "utm.las"])?;
        let (away, words) = desk.start(&["near.las", "utm.las"])?.from(UTM);
        judged(info.says(&["near.las", "utm.las"]) && away < 60.0, format!("{words}; {}", info.in_words()))
    }));
    rows.push(row(3, "a room of 6 × 4 × 3", "the walk begins inside, eyes 1.7 above the floor", |desk| {
        desk.put("room.las", StrangeLas::new(2, room(20_000, UTM)).at([5e5, 5e6, 0.0]).bytes());
        let head = desk.start(&["room.las"])?.head;
        let inside = (head[0] - UTM[0]).abs() < 3.0 && (head[1] - UTM[1]).abs() < 2.0;
        judged(inside && (head[2] - UTM[2] - 1.7).abs() < 0.3, format!("{head:.2?}"))
    }));
    rows.push(row(3, "one object of 2 m", "the walk begins outside of it, within sight", |desk| {
        let mut points = place(9000, [0.0; 3], 2.0);
        points.retain(|point| point.at[2] > 0.0);
        desk.put("thing.las", StrangeLas::new(2, points).bytes());
        let (away, words) = desk.start(&["thing.las"])?.from([0.0, 0.0, 0.3]);
        judged((0.5..12.0).contains(&away), words)
    }));
    rows
}

fn row_of_withheld(rows: &mut Vec<StrangerRow>, name: String, format: u8) {
    let right = "not drawn, said; drawn with cloud.show_withheld";
    rows.push(row(3, name, right, move |desk| {
        let mut points = place(4000, [0.0; 3], 20.0);
        let mut deleted = strays(600, [-8.0, -8.0, 1.0], [8.0, 8.0, 6.0]);
        deleted.iter_mut().for_each(|point| (point.rgb, point.withheld) = ([65535, 0, 65535], true));
        points.extend(deleted);
        desk.put("kept.las", StrangeLas::new(format, points).bytes());
        let info = desk.info(&["kept.las"])?;
        let args = ["kept.las", "--eye", "-14,-14,12", "--target", "0,0,2"];
        let hidden = desk.render(&args)?.num_near([255, 0, 255]);
        let shown = desk.render(&[&args[..], &["--set", "cloud.show_withheld=true"]].concat())?;
        let shown = shown.num_near([255, 0, 255]);
        let got = format!("{hidden} magenta pixels, {shown} when asked; {}", info.in_words());
        judged(hidden == 0 && shown > 50 && info.says(&["withheld"]), got)
    }));
}

fn small() -> Vec<StrangerRow> {
    let mut rows = Vec::new();
    for (name, num) in [("one point", 1), ("700 equal points", 700), ("two points 1 mm apart", 2)] {
        rows.push(row(4, name, "a lit pixel in the middle", move |desk| {
            let at = |i: usize| [UTM[0] + if num == 2 { 0.001 * i as f64 } else { 0.0 }, UTM[1], UTM[2]];
            let point = |i| LasPoint { at: at(i), rgb: [65535, 65535, 9], ..LasPoint::default() };
            desk.put("few.las", StrangeLas::new(2, (0..num).map(point).collect()).at(UTM).bytes());
            let picture = desk.render(&["few.las"])?;
            judged(
                picture.middle_is_lit() || num == 2 && picture.lit() > 0,
                format!("{} lit pixels", picture.lit()),
            )
        }));
    }
    for (name, edge) in [("8 cm", 0.08), ("5 mm", 5e-3), ("300 µm", 3e-4), ("40 µm", 4e-5)] {
        rows.push(row(4, format!("a scan of {name}"), "whole and large in the picture", move |desk| {
            let las = StrangeLas::new(2, place(4000, [1.0, 2.0, 3.0], edge)).at([1.0, 2.0, 3.0]);
            desk.put("tiny.las", las.scaled([edge * 1e-6; 3]).bytes());
            let picture = desk.render(&["tiny.las"])?;
            let border =
                (0..96).filter(|x| picture.pixels[*x] != [0; 3] || picture.pixels[63 * 96 + x] != [0; 3]);
            let cut = border.count();
            let got = format!("filled to {:.0} %, {cut} pixels at the border", 100.0 * picture.span());
            judged(picture.span() >= 0.7 && cut < 20 && picture.lit() > 300, got)
        }));
    }
    rows.push(row(
        4,
        "an eye that looks away",
        "exit 0, a sentence: nothing in view, and where it is",
        |desk| {
            desk.put("place.las", StrangeLas::new(2, place(2000, UTM, 20.0)).at([5e5, 5e6, 0.0]).bytes());
            let args = [
                "place.las",
                "--eye",
                "500000,5000000,500",
                "--target",
                "500000,5000000,900",
                "--up",
                "0,1,0",
            ];
            let picture = desk.render(&args)?;
            judged(picture.lit() == 0 && picture.ran.says(&["nothing", "in view"]), picture.ran.in_words())
        },
    ));
    rows
}

/// A grid of 10 × 10 points 0.1 apart, and points far from it.
fn grid_and(property: &str, far: &[[&str; 3]]) -> String {
    let num = 100 + far.len();
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {num}\n");
    text += &["x", "y", "z"].map(|axis| format!("property {property} {axis}\n")).concat();
    text += "end_header\n";
    for i in 0..100 {
        text += &format!("{:.1} {:.1} 0\n", 0.1 * f64::from(i % 10), 0.1 * f64::from(i / 10));
    }
    far.iter().for_each(|at| text += &format!("{}\n", at.join(" ")));
    text
}

fn far() -> Vec<StrangerRow> {
    type Far = &'static [[&'static str; 3]];
    const FAR: [(&str, &str, Far); 6] = [
        ("1 point at 2e9", "float", &[["2e9", "0", "0"]]),
        ("1 point at 7e12", "double", &[["0", "7e12", "0"]]),
        ("1 point at 3e38", "float", &[["3e38", "-3e38", "1"]]),
        ("2 points at 1e300", "double", &[["1e300", "0", "0"], ["0", "-1e300", "0"]]),
        ("NaN, infinity, 4e9", "float", &[["nan", "0", "0"], ["inf", "0", "0"], ["4e9", "1", "1"]]),
        ("3 points at 6e7", "double", &[["6e7", "1", "0"], ["-6e7", "0", "5"], ["0", "6e7", "0"]]),
    ];
    let of = |(name, property, far): (&str, &'static str, Far)| {
        let right = "all 100 points apart; the file's name in a warning if any is left out; sane numbers";
        row(7, format!("a grid of 1 m, {name} ({property})"), right, move |desk| {
            desk.put("grid.ply", grid_and(property, far));
            let info = desk.info(&["grid.ply"])?;
            let eye = ["--eye", "0.45,0.45,1.2", "--target", "0.45,0.45,0", "--up", "0,1,0"];
            let picture = desk.render(&[&["grid.ply"], &eye[..]].concat())?;
            let text = desk.run(&["info", "grid.ply"]);
            let longest = String::from_utf8_lossy(&text.out)
                .split(|c: char| !c.is_ascii_digit())
                .map(str::len)
                .max()
                .unwrap_or(0);
            let is_told = info.points() == 100 + far.len() as u64 || info.says(&["grid.ply"]);
            let got = format!("{} pixels lit, {longest} digits; {}", picture.lit(), info.in_words());
            judged(picture.lit() == 100 && is_told && longest < 20, got)
        })
    };
    FAR.into_iter().map(of).collect()
}
