//! Files that are made here as bytes: reading them, and what is asked of what was read.

use base::task::CancelToken;
use glam::DVec3;
use kit::las_files::save;
use points::{ReadOptions, Scan, ScanError, ScanFile, read};

/// A tower 6 m high and 20 m across, with points within, in meters about its foot.
pub const TOWER: [[f64; 3]; 5] =
    [[-10.0, -10.0, 0.0], [10.0, 10.0, 6.0], [3.0, -4.0, 1.5], [-7.25, 2.5, 0.0], [0.0, 0.0, 3.0]];

/// The points of [`TOWER`].
pub fn tower() -> impl Iterator<Item = DVec3> {
    TOWER.into_iter().map(DVec3::from_array)
}

/// Reads bytes as a file of this name.
pub fn read_bytes(name: &str, bytes: &[u8]) -> Result<Scan, ScanError> {
    read_bytes_with(name, bytes, &ReadOptions::AS_FILES_SAY)
}

/// Reads bytes as a file of this name, with these options.
pub fn read_bytes_with(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Scan, ScanError> {
    let (_folder, path) = save(name, bytes);
    read(&[path], options, &CancelToken::default())
}

/// Checks that reading a file of this name fails; the message must name the file and hold `expected`.
pub fn assert_refused(name: &str, bytes: &[u8], expected: &str) {
    let message = read_bytes(name, bytes).map(|scan| scan.num_points()).unwrap_err().to_string();
    assert!(message.contains(&format!("{name}: ")) && message.contains(expected), "{message}");
    assert!(!message.contains('\n'), "more than a line: {message}");
}

/// Places of the points in the world.
pub fn world(scan: &Scan) -> Vec<DVec3> {
    scan.files.iter().flat_map(|file| file.points.xyz.iter().map(|&xyz| file.grid.p_in_world(xyz))).collect()
}

/// The colors that points are drawn with.
pub fn shown(file: &ScanFile) -> Vec<[u8; 3]> {
    let color = |at: usize| file.color(at).to_le_bytes();
    (0..file.points.xyz.len()).map(color).map(|[r, g, b, _]| [r, g, b]).collect()
}
