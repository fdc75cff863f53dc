//! How fast scans are read: M points/s of our reader beside the bare parse rate of the las crate, and peak
//! memory a point. Prints CSV rows; `docs/bench/load` keeps a run.

#[path = "support/steps.rs"]
mod steps;

use anyhow::Result;
use las::{Builder, Color, Point, PointDataBuilder, Reader, Transform, Vector, Writer, point::Format};
use scanwalk::progress::Stop;
use std::path::{Path, PathBuf};
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
    Ok(())
}

/// A row: points, bytes, seconds, rate, peak memory.
fn read_once(reader: &str, path: &Path) -> Result<()> {
    let start = Instant::now();
    let num_points = if reader == "scanwalk" { read_with_scanwalk(path)? } else { read_with_las(path)? };
    let seconds = start.elapsed().as_secs_f64();
    let file_bytes = std::fs::metadata(path)?.len();
    let rate = num_points as f64 / seconds / 1e6;
    let peak = steps::peak_bytes_per_point(num_points);
    println!("{num_points},{file_bytes},{seconds:.4},{rate:.2},{peak:.2}");
    Ok(())
}

fn read_with_scanwalk(path: &Path) -> Result<usize> {
    let paths: [PathBuf; 1] = [path.to_owned()];
    let scan = scanwalk::scan::read(&paths, &scanwalk::scan::ReadOptions::default(), &Stop::default())?;
    Ok(std::hint::black_box(scan).num_points())
}

/// The bare parse: blocks of raw records into one buffer, coordinates taken from the bytes, nothing kept.
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
    std::hint::black_box(sum);
    Ok(num_points)
}

/// A scanner's sweep over a wavy ground: neighbours in the file are neighbours in space, with noise.
/// The writer takes from the file's name whether to compress.
fn write_file(path: &Path, point_format: u8, num_points: u64) -> Result<()> {
    let format = Format::new(point_format)?;
    let mut builder = Builder::from(if point_format < 6 { (1, 2) } else { (1, 4) });
    builder.point_format = format;
    let transform = Transform { scale: 0.001, offset: 0.0 };
    builder.transforms = Vector { x: transform, y: transform, z: transform };
    let mut writer = Writer::from_path(path, builder.into_header()?)?;
    let row = (num_points as f64).sqrt();
    for index in 0..num_points {
        let noise = (index.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / (1 << 24) as f64;
        let (x, y) = (index as f64 % row * 0.01, (index as f64 / row).floor() * 0.01);
        let z = (0.5 * x).sin() * (0.3 * y).cos() + 0.01 * noise;
        let shade = ((z + 2.0) * 60.0 + 8.0 * noise) as u16;
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
