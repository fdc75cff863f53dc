//! Damages files, and checks whatever is still read of them.

use points::Scan;
use proptest::sample::Index;

/// Changes some of the bytes, and may cut off the end.
pub fn damaged(mut bytes: Vec<u8>, damage: &[(Index, u8)], cut: Option<Index>) -> Vec<u8> {
    for (index, value) in damage {
        let index = index.index(bytes.len());
        bytes[index] = *value;
    }
    if let Some(cut) = cut {
        bytes.truncate(cut.index(bytes.len()));
    }
    bytes
}

/// Asserts that there are points, and that each column has a value for every point or none at all.
pub fn assert_sound(scan: &Scan) {
    let file = &scan.files[0];
    let (points, num_points) = (&file.points, file.points.xyz.len());
    assert!(num_points > 0);
    for len in [points.rgb.len(), points.intensity.len(), points.normals.len()] {
        assert!(len == 0 || len == num_points);
    }
    assert!(file.triangles.iter().flatten().all(|&corner| (corner as usize) < num_points));
    assert!(scan.bounds().min.is_finite() && scan.bounds().max.is_finite());
    let _ = file.color(num_points - 1);
}

/// Most memory that this process has ever held, where the system tells.
pub fn peak_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

/// Memory that reading may take at most: more than all tests of a file need at once, and far less than the headers of
/// the property tests claim.
pub const MOST_KIB: u64 = 512 << 10;
