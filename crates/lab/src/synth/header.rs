//! The start of a LAS file: its header, and for LAZ the record that describes the compression.

use super::record::{WrittenFormat, WrittenRecord};
use base::space::Bounds;
use glam::DVec3;
use laz::{LazItemRecordBuilder, LazVlr};
use points::Grid;
use std::io::{Seek, SeekFrom, Write};

/// Figures of the points for the header.
#[derive(Clone, Debug)]
pub struct Totals {
    /// Number of points.
    pub num_points: u64,
    by_return: [u64; 15],
    min: [i32; 3],
    max: [i32; 3],
}

impl Default for Totals {
    fn default() -> Self {
        Self { num_points: 0, by_return: [0; 15], min: [i32::MAX; 3], max: [i32::MIN; 3] }
    }
}

impl Totals {
    /// Counts one more record.
    pub fn count(&mut self, record: &WrittenRecord) {
        self.num_points += 1;
        self.by_return[usize::from(record.return_number.clamp(1, 15)) - 1] += 1;
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(record.xyz[axis]);
            self.max[axis] = self.max[axis].max(record.xyz[axis]);
        }
    }

    /// Adds the figures of another part of the file.
    pub fn add(&mut self, other: &Self) {
        self.num_points += other.num_points;
        for (sum, more) in self.by_return.iter_mut().zip(other.by_return) {
            *sum += more;
        }
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(other.min[axis]);
            self.max[axis] = self.max[axis].max(other.max[axis]);
        }
    }

    /// True box of the points, in world space.
    pub fn bounds(&self, grid: &Grid) -> Bounds {
        if self.num_points == 0 {
            return Bounds::EMPTY;
        }
        Bounds { min: grid.p_in_world(self.min), max: grid.p_in_world(self.max) }
    }
}

/// The start of the file: LAS header and, for LAZ, the record that describes the compression.
pub struct WrittenHeader {
    format: WrittenFormat,
    grid: Grid,
    /// How the points are compressed, if they are.
    pub laz: Option<LazVlr>,
    /// Figures of the points; to be filled in before the last [`WrittenHeader::write_to`].
    pub totals: Totals,
}

/// Day and year in every header: the day on which a scan is made must not change its bytes.
const CREATED: (u16, u16) = (1, 2026);

impl WrittenHeader {
    /// Makes the header of points still to come.
    pub fn new(format: WrittenFormat, grid: Grid, compressed: bool) -> Self {
        let laz = compressed.then(|| {
            let builder = LazItemRecordBuilder::default_for_point_format_id(format.id(), 0);
            // Fails for point formats that LAZ does not know; both of ours are among the known ones.
            LazVlr::from_laz_items(builder.expect("point formats 2 and 7 can be compressed"))
        });
        Self { format, grid, laz, totals: Totals::default() }
    }

    fn raw(&self) -> las::raw::Header {
        let Totals { num_points, by_return, .. } = self.totals;
        let Bounds { min, max } = match self.totals.bounds(&self.grid) {
            b if b.is_empty() => Bounds { min: DVec3::ZERO, max: DVec3::ZERO },
            b => b,
        };
        let new = self.format == WrittenFormat::Rgb7;
        let header_size: u16 = if new { 375 } else { 227 };
        let vlr_bytes = if self.laz.is_some() { 54 + self.laz_record().len() as u32 } else { 0 };
        // The old header's 32-bit counts stay 0 with format 7 [LAS §2.4].
        let legacy = |count: u64| if new { 0 } else { u32::try_from(count).unwrap_or(0) };
        las::raw::Header {
            version: las::Version::new(1, if new { 4 } else { 2 }),
            // Bit 4 says that coordinate systems are WKT, as format 7 demands; bit 0, that GPS time is not of the week.
            global_encoding: if new { 0b1_0001 } else { 0 },
            system_identifier: text("made up"),
            generating_software: text("scanwalk synth"),
            file_creation_day_of_year: CREATED.0,
            file_creation_year: CREATED.1,
            header_size,
            offset_to_point_data: u32::from(header_size) + vlr_bytes,
            number_of_variable_length_records: u32::from(self.laz.is_some()),
            point_data_record_format: self.format.id() | if self.laz.is_some() { 0x80 } else { 0 },
            point_data_record_length: self.format.record_bytes(),
            number_of_point_records: legacy(num_points),
            number_of_points_by_return: std::array::from_fn(|i| legacy(by_return[i])),
            x_scale_factor: self.grid.scale.x,
            y_scale_factor: self.grid.scale.y,
            z_scale_factor: self.grid.scale.z,
            x_offset: self.grid.offset.x,
            y_offset: self.grid.offset.y,
            z_offset: self.grid.offset.z,
            max_x: max.x,
            min_x: min.x,
            max_y: max.y,
            min_y: min.y,
            max_z: max.z,
            min_z: min.z,
            large_file: new.then_some(las::raw::header::LargeFile {
                number_of_point_records: num_points,
                number_of_points_by_return: by_return,
            }),
            ..las::raw::Header::default()
        }
    }

    fn laz_record(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        if let Some(vlr) = &self.laz {
            // Writing to memory cannot fail.
            let _ = vlr.write_to(&mut bytes);
        }
        bytes
    }

    /// Writes the header to the start of the file: once as a placeholder, once with the true counts.
    pub fn write_to(&self, file: &mut (impl Write + Seek)) -> Result<(), las::Error> {
        file.seek(SeekFrom::Start(0))?;
        self.raw().write_to(&mut *file)?;
        if self.laz.is_some() {
            let record = self.laz_record();
            file.write_all(&0_u16.to_le_bytes())?;
            file.write_all(&text::<16>(LazVlr::USER_ID))?;
            file.write_all(&LazVlr::RECORD_ID.to_le_bytes())?;
            file.write_all(&(record.len() as u16).to_le_bytes())?;
            file.write_all(&text::<32>("compression"))?;
            file.write_all(&record)?;
        }
        Ok(())
    }
}

/// A fixed-width text field, filled with zeros.
fn text<const N: usize>(text: &str) -> [u8; N] {
    std::array::from_fn(|i| text.as_bytes().get(i).copied().unwrap_or(0))
}
