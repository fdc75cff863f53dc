//! Files that the reading tests make for themselves, written with the las crate.

use las::{Builder, Color, Point, Transform, Vector, Writer, point::Format};
use std::io::Cursor;

/// A LAS or LAZ file to make.
#[derive(Clone, Copy, Debug)]
pub struct Fixture {
    /// Minor version of LAS 1.x.
    pub minor: u8,
    /// Point format, 0–10.
    pub point_format: u8,
    /// True for LAZ.
    pub compressed: bool,
    /// Number of points.
    pub num_points: usize,
    /// Bytes that each record is longer than its format.
    pub extra_bytes: u16,
}

impl Fixture {
    /// LAS 1.4 or the lowest version that has the format; 1000 points.
    pub fn new(point_format: u8) -> Self {
        let minor = [2, 2, 2, 2, 3, 3, 4, 4, 4, 4, 4][usize::from(point_format)];
        Self { minor, point_format, compressed: false, num_points: 1000, extra_bytes: 0 }
    }

    /// The same file as LAZ.
    pub fn compressed(self) -> Self {
        Self { compressed: true, ..self }
    }

    /// The same file with another number of points.
    pub fn with_points(self, num_points: usize) -> Self {
        Self { num_points, ..self }
    }

    /// The bytes of the file.
    pub fn bytes(&self) -> Vec<u8> {
        let mut format = Format::new(self.point_format).unwrap();
        format.is_compressed = self.compressed;
        format.extra_bytes = self.extra_bytes;
        let mut builder = Builder::from((1, self.minor));
        builder.point_format = format;
        builder.generating_software = "fixture".into();
        builder.transforms = Vector {
            x: Transform { scale: 0.01, offset: 500_000.0 },
            y: Transform { scale: 0.01, offset: 4_000_000.0 },
            z: Transform { scale: 0.001, offset: 100.0 },
        };
        las_bytes(builder, (0..self.num_points).map(|index| self.point(index, &format)))
    }

    fn point(&self, index: usize, format: &Format) -> Point {
        // A multiplicative hash gives values without any regularity.
        let hash = (index as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let part = |shift: u64, bits: u64| (hash >> shift) & ((1 << bits) - 1);
        Point {
            x: 500_000.0 + part(0, 16) as f64 * 0.01,
            y: 4_000_000.0 + part(16, 16) as f64 * 0.01,
            z: 100.0 + part(32, 14) as f64 * 0.001,
            intensity: part(40, 16) as u16,
            return_number: 1,
            number_of_returns: 1,
            gps_time: format.has_gps_time.then_some(index as f64),
            color: format
                .has_color
                .then(|| Color::new(part(3, 16) as u16, part(21, 16) as u16, part(44, 16) as u16)),
            waveform: format.has_waveform.then(Default::default),
            nir: format.has_nir.then_some(7),
            extra_bytes: vec![1; usize::from(self.extra_bytes)],
            ..Default::default()
        }
    }
}

/// The bytes of a file with this header and these points.
pub fn las_bytes(header: Builder, points: impl IntoIterator<Item = Point>) -> Vec<u8> {
    let mut writer = Writer::new(Cursor::new(Vec::new()), header.into_header().unwrap()).unwrap();
    points.into_iter().for_each(|point| writer.write_point(point).unwrap());
    writer.close().unwrap();
    writer.into_inner().unwrap().into_inner()
}

/// Writes `bytes` into a folder of its own; the file lives as long as the folder that is returned.
pub fn save(name: &str, bytes: &[u8]) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}
