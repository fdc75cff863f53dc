//! How fast scans are read: M points/s of our reader beside the bare parse rate of the las crate, and peak memory a
//! point. PLY files, as text and binary, are read by ours alone. Prints CSV rows; `docs/bench/load` keeps a run.

use anyhow::Result;
use kit::{reading, steps};
use las::{Builder, Color, Point, PointDataBuilder, Reader, Transform, Vector, Writer, point::Format};
use std::fs::File;
use std::hint::black_box;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Instant;

/// Points that the las crate is asked for at once.
const LAS_CRATE_BLOCK: u64 = 1 << 20;

fn main() -> Result<()> {
    steps::run(bench, read_once)
}

fn bench(folder: &Path, num_points: u64, num_runs: u64) -> Result<()> {
    println!("file,reader,run,points,file_bytes,seconds,m_points_per_s,peak_bytes_per_point");
    for (name, point_format, compressed) in [
        ("las-format-3", 3, false),
        ("las-format-7", 7, false),
        ("laz-format-3", 3, true),
        ("laz-format-7", 7, true),
    ] {
        let path = folder.join(name).with_extension(if compressed { "laz" } else { "las" });
        write_file(&path, point_format, num_points)?;
        for run in 0..num_runs {
            for reader in ["scanwalk", "las-crate"] {
                println!("{name},{reader},{run},{}", steps::in_child(reader, &path)?);
            }
        }
        std::fs::remove_file(&path)?;
    }
    for (name, format, kind) in [
        ("ply-binary-float", "binary_little_endian", "float"),
        ("ply-binary-double", "binary_little_endian", "double"),
        ("ply-text-float", "ascii", "float"),
        ("ply-text-double", "ascii", "double"),
    ] {
        let path = folder.join(name).with_extension("ply");
        write_ply(&path, format, kind, num_points)?;
        for run in 0..num_runs {
            println!("{name},scanwalk,{run},{}", steps::in_child("scanwalk", &path)?);
        }
        std::fs::remove_file(&path)?;
    }
    Ok(())
}

/// Reads a file once and prints a row: points, bytes, seconds, rate, peak memory.
fn read_once(reader: &str, path: &Path) -> Result<()> {
    let start = Instant::now();
    let num_points = if reader == "scanwalk" {
        black_box(reading::file(path)?).num_points()
    } else {
        read_with_las(path)?
    };
    let seconds = start.elapsed().as_secs_f64();
    let file_bytes = std::fs::metadata(path)?.len();
    let rate = num_points as f64 / seconds / 1e6;
    let peak = steps::peak_bytes_per_point(num_points);
    println!("{num_points},{file_bytes},{seconds:.4},{rate:.2},{peak:.2}");
    Ok(())
}

/// The bare parse: reads blocks of raw records into one buffer, takes coordinates from the bytes, keeps nothing.
fn read_with_las(path: &Path) -> Result<usize> {
    let mut reader = Reader::from_path(path)?;
    let mut block = PointDataBuilder::new().for_header(reader.header()).build();
    let (mut num_points, mut sum) = (0, 0i64);
    loop {
        let count = reader.fill_points(LAS_CRATE_BLOCK, &mut block)?;
        if count == 0 {
            break;
        }
        num_points += usize::try_from(count)?;
        for record in block.raw_bytes().chunks_exact(block.record_len()) {
            let axis = |at: usize| {
                i64::from(i32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]]))
            };
            sum = sum.wrapping_add(axis(0) + axis(4) + axis(8));
        }
    }
    black_box(sum);
    Ok(num_points)
}

/// Places and shades of a scanner's sweep over a wavy ground, with noise; neighbors in the file are neighbors in space.
fn sweep(num_points: u64) -> impl Iterator<Item = ([f64; 3], u16)> {
    let row = (num_points as f64).sqrt();
    (0..num_points).map(move |index| {
        let noise = (index.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / (1 << 24) as f64;
        let (x, y) = (index as f64 % row * 0.01, (index as f64 / row).floor() * 0.01);
        let z = (0.5 * x).sin() * (0.3 * y).cos() + 0.01 * noise;
        ([x, y, z], ((z + 2.0) * 60.0 + 8.0 * noise) as u16)
    })
}

/// Writes the sweep as PLY with colors; doubles lie where a projected coordinate system has them.
fn write_ply(path: &Path, format: &str, kind: &str, num_points: u64) -> Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    write!(file, "ply\nformat {format} 1.0\nelement vertex {num_points}\n")?;
    ["x", "y", "z"].into_iter().try_for_each(|name| writeln!(file, "property {kind} {name}"))?;
    ["red", "green", "blue"].into_iter().try_for_each(|name| writeln!(file, "property uchar {name}"))?;
    writeln!(file, "end_header")?;
    for (place, shade) in sweep(num_points) {
        let rgb = [shade, shade / 5 * 4, shade / 5 * 3].map(|c| c.min(255) as u8);
        let far = [place[0] + 5e5, place[1] + 5e6, place[2]];
        match (format, kind) {
            ("ascii", "float") => write!(file, "{:.4} {:.4} {:.4}", place[0], place[1], place[2])?,
            ("ascii", _) => write!(file, "{:.4} {:.4} {:.4}", far[0], far[1], far[2])?,
            (_, "float") => file.write_all(place.map(|c| (c as f32).to_le_bytes()).as_flattened())?,
            _ => file.write_all(far.map(f64::to_le_bytes).as_flattened())?,
        }
        match format {
            "ascii" => writeln!(file, " {} {} {}", rgb[0], rgb[1], rgb[2])?,
            _ => file.write_all(&rgb)?,
        }
    }
    file.flush()?;
    Ok(())
}

/// Writes the sweep as LAS. The writer takes from the file's name whether to compress.
fn write_file(path: &Path, point_format: u8, num_points: u64) -> Result<()> {
    let format = Format::new(point_format)?;
    let mut builder = Builder::from(if point_format < 6 { (1, 2) } else { (1, 4) });
    builder.point_format = format;
    let transform = Transform { scale: 0.001, offset: 0.0 };
    builder.transforms = Vector { x: transform, y: transform, z: transform };
    let mut writer = Writer::from_path(path, builder.into_header()?)?;
    for (index, ([x, y, z], shade)) in sweep(num_points).enumerate() {
        writer.write_point(Point {
            x,
            y,
            z,
            intensity: 3 * shade,
            return_number: 1,
            number_of_returns: 1,
            gps_time: Some(index as f64 * 1e-5),
            color: Some(Color::new(257 * shade, 200 * shade, 150 * shade)),
            ..Default::default()
        })?;
    }
    writer.close()?;
    Ok(())
}
