//! Rows of kind 8: PLY as the world writes it.

use super::desk::Desk;
use super::las::{Chance, StrangeLas, place};
use super::{StrangerRow, judged, row};

const LINE: u8 = 8;

/// Points of a surface about `edge` wide round the origin.
pub fn statue(num: usize, edge: f64) -> Vec<[f64; 3]> {
    place(num, [0.0; 3], edge).into_iter().map(|point| point.at).collect()
}

/// PLY as text, without colors.
pub fn points(property: &str, points: &[[f64; 3]]) -> String {
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", points.len());
    text += &["x", "y", "z"].map(|axis| format!("property {property} {axis}\n")).concat();
    text += "end_header\n";
    points.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
    text
}

/// Quarters of a square: their places, and their colors red, green, blue, yellow.
const QUARTERS: [([f64; 2], [u8; 3]); 4] = [
    ([-1.0, 1.0], [230, 20, 20]),
    ([1.0, 1.0], [20, 230, 20]),
    ([-1.0, -1.0], [20, 20, 230]),
    ([1.0, -1.0], [230, 230, 20]),
];

/// `num` points in each quarter, with its color.
fn quarters(num: usize) -> Vec<([f64; 3], [u8; 3])> {
    let mut chance = Chance::new(5);
    let mut all = Vec::new();
    for i in 0..4 * num {
        let ([x, y], color) = QUARTERS[i % 4];
        all.push(([x * chance.part(), y * chance.part(), 0.0], color));
    }
    all
}

/// A file is read whole, and its quarters have their colors.
fn shows_quarters(desk: &Desk, num: usize) -> super::Outcome {
    let eye = ["--eye", "0,0,2.2", "--target", "0,0,0", "--up", "0,1,0", "--dilate", "rings"];
    let picture = desk.render(&[&["quarters.ply"], &eye[..]].concat())?;
    let info = desk.info(&["quarters.ply"])?;
    let found = QUARTERS.map(|(_, color)| picture.num_near(color));
    let got = format!("pixels of the four colors {found:?}; {}", info.in_words());
    judged(found.iter().all(|num| *num > 150) && info.points() == num as u64, got)
}

fn of_quarters(
    name: impl Into<String>,
    make: impl Fn() -> Vec<u8> + Send + Sync + 'static,
    num: usize,
) -> StrangerRow {
    row(LINE, name, format!("{num} points in four colors"), move |desk| {
        desk.put("quarters.ply", make());
        shows_quarters(desk, num)
    })
}

const COLORED: &str = "property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n\
                       property uchar blue\n";

/// PLY as text with quarters; `row` writes one vertex.
fn text(head: &str, end: &str, num: usize, row: impl Fn(usize, &[f64; 3], &[u8; 3]) -> String) -> Vec<u8> {
    let body: String = quarters(num / 4).iter().enumerate().map(|(i, (at, rgb))| row(i, at, rgb)).collect();
    (head.replace('\n', end) + &body).into_bytes()
}

fn header(magic: &str, format: &str, count: &str, properties: &str) -> String {
    format!("{magic}\nformat {format} 1.0\ncomment made up\nelement vertex {count}\n{properties}end_header\n")
}

fn texts() -> Vec<StrangerRow> {
    type Write = fn(usize, &[f64; 3], &[u8; 3]) -> String;
    const PLAIN: Write = |_, [x, y, z], [r, g, b]| format!("{x} {y} {z} {r} {g} {b}\n");
    let of = |name: &str, magic: &'static str, count: &'static str, end: &'static str, write: Write| {
        of_quarters(name, move || text(&header(magic, "ascii", count, COLORED), end, 2000, write), 2000)
    };
    vec![
        of("a vertex on two lines", "ply", "2000", "\n", |_, [x, y, z], [r, g, b]| {
            format!("{x} {y} {z}\n{r} {g} {b}\n")
        }),
        of("a vertex on three lines", "ply", "2000", "\n", |_, [x, y, z], [r, g, b]| {
            format!("{x} {y}\n{z} {r}\n{g} {b}\n")
        }),
        of("ten vertices a line", "ply", "2000", "\n", |i, [x, y, z], [r, g, b]| {
            format!("{x} {y} {z} {r} {g} {b}{}", if i % 10 == 9 { "\n" } else { " " })
        }),
        of("a number a line", "ply", "2000", "\n", |_, [x, y, z], [r, g, b]| {
            format!("{x}\n{y}\n{z}\n{r}\n{g}\n{b}\n")
        }),
        of("all on one line", "ply", "2000", "\n", |_, [x, y, z], [r, g, b]| {
            format!("{x} {y} {z} {r} {g} {b} ")
        }),
        of("tabs, spaces, empty lines", "ply", "2000", "\n", |_, [x, y, z], [r, g, b]| {
            format!("  {x}\t{y}  {z}\t\t{r} {g} {b} \n\n")
        }),
        of("lines that end in CR LF", "ply", "2000", "\r\n", |_, [x, y, z], [r, g, b]| {
            format!("{x} {y} {z} {r} {g} {b}\r\n")
        }),
        of("a byte order mark", "\u{feff}ply", "2000", "\n", PLAIN),
        of("PLY in capitals", "PLY", "2000", "\n", PLAIN),
        of("a count of 2e+03", "ply", "2e+03", "\n", PLAIN),
        of("a count of 2000.0", "ply", "2000.0", "\n", PLAIN),
        of("numbers like 1.5E-01 and +2", "ply", "2000", "\n", |_, [x, y, z], [r, g, b]| {
            format!("{x:E} {y:+} {z} +{r} {g}.0 {b}\n")
        }),
    ]
}

fn binaries() -> Vec<StrangerRow> {
    let binary = |is_big: bool, extra: &'static str, extra_bytes: usize| {
        let properties = format!("{extra}{COLORED}");
        let name = if is_big { "binary_big_endian" } else { "binary_little_endian" };
        let mut bytes = header("ply", name, "2000", &properties).into_bytes();
        for (at, rgb) in quarters(500) {
            bytes.extend(std::iter::repeat_n(1, extra_bytes));
            for c in at {
                bytes.extend(if is_big { (c as f32).to_be_bytes() } else { (c as f32).to_le_bytes() });
            }
            bytes.extend(rgb);
        }
        bytes
    };
    vec![
        of_quarters("binary with an int64 before", move || binary(false, "property int64 id\n", 8), 2000),
        of_quarters("big endian with a uint64 before", move || binary(true, "property uint64 id\n", 8), 2000),
        of_quarters("packed rgb as uint", || packed("uint", |word| word.to_string()), 2000),
        of_quarters(
            "packed rgb as float, PCL's way",
            || packed("float", |word| format!("{:e}", f32::from_bits(word))),
            2000,
        ),
    ]
}

fn packed(kind: &str, number: impl Fn(u32) -> String) -> Vec<u8> {
    let properties = format!("property float x\nproperty float y\nproperty float z\nproperty {kind} rgb\n");
    text(&header("ply", "ascii", "2000", &properties), "\n", 2000, |_, [x, y, z], [r, g, b]| {
        let word = u32::from_be_bytes([0, *r, *g, *b]);
        format!("{x} {y} {z} {}\n", number(word))
    })
}

/// A Gaussian splat: the color is in its first coefficients, the opacity is before the sigmoid.
fn splat(num_floaters: usize) -> Vec<u8> {
    let names =
        ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0"];
    let properties: String = names.iter().map(|name| format!("property float {name}\n")).collect();
    let count = (2000 + num_floaters).to_string();
    let mut bytes = header("ply", "binary_little_endian", &count, &properties).into_bytes();
    let mut put = |at: [f64; 3], rgb: [u8; 3], opacity: f32| {
        let color = rgb.map(|c| (f32::from(c) / 255.0 - 0.5) / 0.282_094_79);
        let all = at.map(|c| c as f32).into_iter().chain(color).chain([opacity, -5.0, -5.0, -5.0, 1.0]);
        bytes.extend(all.flat_map(f32::to_le_bytes));
    };
    quarters(500).into_iter().for_each(|(at, rgb)| put(at, rgb, 4.0));
    // Nobody would see these points: their opacity is about 0.00005.
    (0..num_floaters).for_each(|i| put([0.001 * i as f64, 0.0, 1.0], [255, 0, 255], -10.0));
    bytes
}

pub fn rows() -> Vec<StrangerRow> {
    let mut rows = texts();
    rows.extend(binaries());
    rows.push(of_quarters("Gaussian splat", || splat(0), 2000));
    rows.push(row(
        LINE,
        "Gaussian splat, 300 of no opacity",
        "2000 points drawn, the 300 left out and said",
        |desk| {
            desk.put("quarters.ply", splat(300));
            let info = desk.info(&["quarters.ply"])?;
            let got = shows_quarters(desk, 2000)?;
            judged(info.says(&["300"]), format!("{got}; {}", info.in_words()))
        },
    ));
    rows.push(row(LINE, "compressed splat", "decoded, or refused by its name with what to do", |desk| {
        let chunk = ["min_x", "min_y", "min_z", "max_x", "max_y", "max_z"].map(|n| format!("property float {n}\n")).concat();
        let packed = ["position", "rotation", "scale", "color"].map(|n| format!("property uint packed_{n}\n")).concat();
        let head = format!(
            "ply\nformat binary_little_endian 1.0\nelement chunk 1\n{chunk}element vertex 256\n{packed}end_header\n"
        );
        let mut bytes = head.into_bytes();
        bytes.extend([-1.0, -1.0, -1.0, 1.0, 1.0, 1.0_f32].into_iter().flat_map(f32::to_le_bytes));
        (0..1024_u32).for_each(|i| bytes.extend(i.wrapping_mul(0x9e37_79b9).to_le_bytes()));
        desk.put("small.ply", bytes);
        let ran = desk.run(&["info", "small.ply"]);
        judged(ran.code == Some(0) || ran.says(&["small.ply", "splat", "compressed"]), ran.in_words())
    }));
    for (name, property) in
        [("reflectance", "float"), ("scalar_Intensity", "float"), ("scalar_Reflectance", "double")]
    {
        rows.push(row(LINE, format!("property {property} {name}"), "shown by intensity", move |desk| {
            let properties =
                format!("property float x\nproperty float y\nproperty float z\nproperty {property} {name}\n");
            let write = |i: usize, [x, y, z]: &[f64; 3], _: &[u8; 3]| {
                format!("{x} {y} {z} {}\n", 0.01 * (i % 97) as f64)
            };
            desk.put("seen.ply", text(&header("ply", "ascii", "2000", &properties), "\n", 2000, write));
            let ran = desk.run(&["info", "seen.ply"]);
            let said = String::from_utf8_lossy(&ran.out).into_owned();
            let line = said
                .lines()
                .find(|line| line.contains("shown by"))
                .unwrap_or("no word of it")
                .trim()
                .to_owned();
            judged(line.contains("intensity"), line)
        }));
    }
    rows.push(row(LINE, "an element named points, with gray", "its points, shown by intensity", |desk| {
        let properties = "property float x\nproperty float y\nproperty float z\nproperty uchar gray\n";
        let head = header("ply", "ascii", "2000", properties).replace("element vertex", "element points");
        desk.put("gray.ply", text(&head, "\n", 2000, |i, [x, y, z], _| format!("{x} {y} {z} {}\n", i % 200)));
        let said = String::from_utf8_lossy(&desk.run(&["info", "gray.ply"]).out).into_owned();
        judged(said.contains("2,000") && said.contains("shown by intensity"), said)
    }));
    rows.push(row(LINE, "decimal commas", "an error that says so, with the line", |desk| {
        let head = header("ply", "ascii", "2000", "property float x\nproperty float y\nproperty float z\n");
        let write =
            |_: usize, [x, y, z]: &[f64; 3], _: &[u8; 3]| format!("{x:.3} {y:.3} {z:.3}\n").replace('.', ",");
        desk.put("commas.ply", text(&head, "\n", 2000, write));
        let ran = desk.run(&["info", "commas.ply"]);
        judged(ran.code == Some(1) && ran.says(&["commas.ply", "line", "not commas"]), ran.in_words())
    }));
    rows.push(row(LINE, "colors on faces only", "half red, half green", |desk| {
        let mut text =
            "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
                        element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\n\
                        property uchar green\nproperty uchar blue\nend_header\n"
                .to_owned();
        for x in [-1.0, 0.05] {
            for [dx, y] in [[0.0, -1.0], [0.95, -1.0], [0.95, 1.0], [0.0, 1.0]] {
                text += &format!("{} {y} 0\n", x + dx);
            }
        }
        text += "4 0 1 2 3 230 20 20\n4 4 5 6 7 20 230 20\n";
        desk.put("faces.ply", text);
        let eye = ["--eye", "0,0,2.2", "--target", "0,0,0", "--up", "0,1,0", "--lod", "spt"];
        let picture = desk.render(&[&["faces.ply"], &eye[..]].concat())?;
        let found = [[230, 20, 20], [20, 230, 20]].map(|color| picture.num_near(color));
        judged(found.iter().all(|num| *num > 300), format!("pixels of the two colors {found:?}"))
    }));
    rows.push(row(LINE, "a texture named in the header", "the sentence that it is not read", |desk| {
        let head = header("ply", "ascii", "2000", "property float x\nproperty float y\nproperty float z\n");
        let head = head.replace("comment made up", "comment TextureFile statue.png");
        desk.put("skin.ply", text(&head, "\n", 2000, |_, [x, y, z], _| format!("{x} {y} {z}\n")));
        let info = desk.info(&["skin.ply"])?;
        judged(info.says(&["texture"]), info.in_words())
    }));
    // The reader of another format is not mistaken for this one.
    rows.push(row(LINE, "a LAS file that is called .ply", "read as what it is", |desk| {
        desk.put("wrong.ply", StrangeLas::new(2, place(777, [0.0; 3], 9.0)).bytes());
        let info = desk.info(&["wrong.ply"])?;
        judged(info.points() == 777, info.in_words())
    }));
    rows
}
