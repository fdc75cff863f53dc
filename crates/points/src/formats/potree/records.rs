//! The points of a node as its bytes have them, record after record or unfolded attribute after attribute, as a block.

use super::attributes::{PointColumns, StoredAttribute, WantedColumns};
use super::morton;
use super::unfold::{CannotUnfold, Unfolding};
use crate::Grid;
use crate::block::Block;
use crate::column::{self, Column, Type};
use crate::stats::Stats;
use base::words::counted;

/// Bytes of a position in a record.
const POSITION_BYTES: usize = 12;
/// Most bytes of a record: more than any real one has.
const MOST_RECORD_BYTES: usize = 1 << 16;
/// Names of the position, as [`StoredAttribute::plain_name`] gives them.
const POSITION_NAMES: [&str; 3] = ["position", "positioncartesian", "xyz"];
/// Names of the color whose bits are interleaved in nodes that are folded.
const INTERLEAVED_NAMES: [&str; 2] = ["rgb", "rgba"];

/// How the points of a file's nodes are made up.
#[derive(Clone, Debug)]
pub(super) struct RecordLayout {
    stored: Vec<StoredAttribute>,
    /// First byte of each attribute in a record.
    starts: Vec<usize>,
    /// Number of the attribute that is the position.
    position: usize,
    /// Bytes of a record.
    pub record_bytes: usize,
    pub columns: PointColumns,
}

impl RecordLayout {
    /// The layout of attributes that follow each other in this order, in records, or else folded.
    ///
    /// # Errors
    /// Why there is none, as a sentence whose subject is the file.
    pub fn of(mut stored: Vec<StoredAttribute>, is_folded: bool) -> Result<Self, String> {
        let is_position =
            |attribute: &StoredAttribute| POSITION_NAMES.contains(&attribute.plain_name().as_str());
        let position = stored.iter().position(is_position).ok_or("it stores no position")?;
        let attribute = &mut stored[position];
        let is_whole =
            matches!(attribute.kind, Some(Type::I32 | Type::U32)) && attribute.num_bytes == POSITION_BYTES;
        if !is_whole {
            return Err("its positions are not three whole numbers of 32 bits".into());
        }
        if is_folded {
            attribute.num_bytes = morton::POSITION_BYTES;
            for color in stored.iter_mut().filter(|attribute| {
                let name = attribute.name.to_ascii_lowercase();
                INTERLEAVED_NAMES.contains(&name.as_str())
            }) {
                color.is_interleaved = true;
                color.num_bytes = morton::COLOR_BYTES;
            }
        }
        let mut record_bytes = 0usize;
        let start = |attribute: &StoredAttribute| {
            let start = record_bytes;
            record_bytes = record_bytes.saturating_add(attribute.num_bytes);
            start
        };
        let starts = stored.iter().map(start).collect();
        if record_bytes > MOST_RECORD_BYTES {
            return Err(format!("its points would have {} each", counted(record_bytes, "byte")));
        }
        let columns = PointColumns::of(&stored, position);
        Ok(Self { stored, starts, position, record_bytes, columns })
    }

    /// The points of whole records, placed on the grid by `place`, without those that have no place there; their
    /// number. `None` if there is no memory.
    pub fn records(
        &self,
        records: &[u8],
        wanted: &WantedColumns,
        grid: Grid,
        place: impl Fn([i32; 3]) -> Option<[i32; 3]>,
    ) -> Option<(Block, u64)> {
        let all = records.chunks_exact(self.record_bytes);
        let num_points = all.len();
        let mut xyz = column::zeros(num_points)?;
        let mut kept = None::<Vec<u8>>;
        let mut num_kept = 0;
        for (at, record) in all.enumerate() {
            match place(self.stored_position(record)) {
                Some(placed) => {
                    xyz[num_kept] = placed;
                    num_kept += 1;
                    kept.iter_mut().for_each(|kept| kept.extend_from_slice(record));
                }
                None => {
                    kept.get_or_insert_with(|| records[..at * self.record_bytes].to_vec());
                }
            }
        }
        xyz.truncate(num_kept);
        let records = kept.as_deref().unwrap_or(records);
        let source =
            |source: usize| (records.get(self.starts[source]..).unwrap_or_default(), self.record_bytes);
        let block = filled(xyz, wanted, grid, source)?;
        Some((block, (num_points - num_kept) as u64))
    }

    #[inline]
    fn stored_position(&self, record: &[u8]) -> [i32; 3] {
        let start = self.starts[self.position];
        let bytes = record.get(start..).and_then(<[u8]>::first_chunk).copied().unwrap_or([0; POSITION_BYTES]);
        [0, 4, 8].map(|at| i32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]))
    }

    /// The points of a node that is folded.
    ///
    /// # Errors
    /// The node ends before its points, is damaged, or there is no memory. May panic on damage.
    pub fn folded(
        &self,
        folded: &[u8],
        num_points: usize,
        wanted: &WantedColumns,
        grid: Grid,
    ) -> Result<Block, CannotUnfold> {
        let is_wanted =
            |source: usize| source == self.position || wanted.fills.iter().any(|fill| fill.source == source);
        let last = (0..self.stored.len()).rev().find(|&source| is_wanted(source)).unwrap_or(0);
        let mut unfolding = Unfolding::new(folded);
        let mut unfolded = Vec::new();
        for (source, attribute) in self.stored[..=last].iter().enumerate() {
            let num_bytes = attribute.num_bytes.saturating_mul(num_points);
            unfolded.push(if is_wanted(source) {
                unfolding.next(num_bytes)?
            } else {
                unfolding.skip(num_bytes)?;
                Vec::new()
            });
        }
        let mut xyz = column::zeros(num_points).ok_or(CannotUnfold::Memory)?;
        let positions = unfolded[self.position].as_chunks().0;
        xyz.iter_mut().zip(positions).for_each(|(xyz, bytes)| *xyz = morton::position(bytes));
        let source = |source: usize| {
            let bytes = unfolded.get(source).map(Vec::as_slice).unwrap_or_default();
            (bytes, self.stored[source].num_bytes)
        };
        filled(xyz, wanted, grid, source).ok_or(CannotUnfold::Memory)
    }
}

/// A block of these points, whose columns are filled from attributes: their bytes, and how far values are apart. `None`
/// if there is no memory.
fn filled<'a>(
    xyz: Vec<[i32; 3]>,
    wanted: &WantedColumns,
    grid: Grid,
    source: impl Fn(usize) -> (&'a [u8], usize),
) -> Option<Block> {
    let num_points = xyz.len();
    let zeros =
        |(attribute, kind): &(_, Type)| Some((Clone::clone(attribute), Column::zeros(*kind, num_points)?));
    let mut columns: Vec<_> = wanted.columns.iter().map(zeros).collect::<Option<_>>()?;
    for fill in &wanted.fills {
        let (bytes, stride) = source(fill.source);
        let (_, column) = &mut columns[fill.column];
        if let Some(mut part) = column.parts(num_points.max(1), 1).pop() {
            fill.kind.run(bytes, stride, &mut part);
            let marks = part.into_marks();
            column.mark(&marks, 0);
        }
    }
    let mut block = Block { grid, xyz, columns, stats: Stats::EMPTY };
    // Marks of the last record's bytes must not lie beyond it.
    block.truncate(num_points);
    Some(block.with_stats())
}

#[cfg(test)]
mod tests {
    use super::super::unfold::fold;
    use super::*;
    use crate::{Attribute, Projection};

    fn layout(is_folded: bool) -> RecordLayout {
        let stored = vec![
            StoredAttribute::plain("classification", Type::U8, 1),
            StoredAttribute::plain("position", Type::I32, 3),
            StoredAttribute::plain("rgb", Type::U16, 3),
            StoredAttribute::plain("gps-time", Type::F64, 1),
        ];
        RecordLayout::of(stored, is_folded).unwrap()
    }

    const POINTS: [([i32; 3], [u16; 3], u8, f64); 3] = [
        ([1, -2, 70_000], [65535, 0, 257], 7, 0.5),
        ([i32::MIN, i32::MAX, 0], [1, 2, 3], 2, -1.0),
        ([4, 5, 6], [9, 8, 7], 18, 1e9),
    ];

    fn records() -> Vec<u8> {
        let record = |(xyz, rgb, class, time): &([i32; 3], [u16; 3], u8, f64)| {
            let mut bytes = vec![*class];
            bytes.extend(xyz.iter().flat_map(|c| c.to_le_bytes()));
            bytes.extend(rgb.iter().flat_map(|c| c.to_le_bytes()));
            bytes.extend(time.to_le_bytes());
            bytes
        };
        POINTS.iter().flat_map(record).collect()
    }

    fn arrays() -> Vec<u8> {
        let mut bytes: Vec<u8> = POINTS.iter().map(|point| point.2).collect();
        bytes.extend(POINTS.iter().flat_map(|point| morton::position_bytes(point.0)));
        bytes.extend(POINTS.iter().flat_map(|point| morton::code(point.1.map(u32::from)).to_le_bytes()));
        bytes.extend(POINTS.iter().flat_map(|point| point.3.to_le_bytes()));
        bytes
    }

    #[test]
    fn records_and_folded_nodes_have_the_same_points() {
        let want = Projection::of([
            Attribute::Color,
            Attribute::Noise,
            Attribute::GpsTime,
            Attribute::Classification,
        ]);
        let (plain, folded) = (layout(false), layout(true));
        assert_eq!((plain.record_bytes, folded.record_bytes), (27, 33));
        let wanted = plain.columns.wanted(&want);
        let (block, num_far) = plain.records(&records(), &wanted, Grid::default(), Some).unwrap();
        assert_eq!((num_far, block.xyz.clone()), (0, POINTS.map(|point| point.0).to_vec()));
        assert_eq!(
            block.column(&Attribute::Color),
            Some(&Column::U16x3(POINTS.map(|point| point.1).to_vec()))
        );
        assert_eq!(block.column(&Attribute::GpsTime), Some(&Column::F64(vec![0.5, -1.0, 1e9])));
        let Some(Column::Bool(noise)) = block.column(&Attribute::Noise) else { panic!("no noise") };
        assert_eq!([0, 1, 2].map(|at| noise.get(at)), [true, false, true]);
        let bytes = fold(&arrays());
        let same = folded.folded(&bytes, 3, &folded.columns.wanted(&want), Grid::default()).unwrap();
        assert_eq!((same.xyz, same.columns), (block.xyz, block.columns));
        // What lies behind the last wanted attribute is not looked at.
        let only = folded.columns.wanted(&Projection::of([Attribute::Classification]));
        let cut = &bytes[..bytes.len() - 26];
        assert!(folded.folded(cut, 3, &only, Grid::default()).is_ok());
        let all = folded.columns.wanted(&want);
        assert_eq!(folded.folded(cut, 3, &all, Grid::default()).unwrap_err(), CannotUnfold::Ends);
        assert_eq!(folded.folded(&bytes, 4, &all, Grid::default()).unwrap_err(), CannotUnfold::Ends);
    }

    #[test]
    fn points_without_a_place_are_left_out_with_all_that_they_have() {
        let plain = layout(false);
        let wanted = plain.columns.wanted(&plain.columns.schema().projection());
        for far in [i32::MIN, 1, 4] {
            let place = |xyz: [i32; 3]| (xyz[0] != far).then_some(xyz);
            let (block, num_far) = plain.records(&records(), &wanted, Grid::default(), place).unwrap();
            let left: Vec<_> = POINTS.iter().filter(|point| point.0[0] != far).collect();
            assert_eq!((num_far, block.xyz.len()), (1, 2));
            let times: Vec<f64> = left.iter().map(|point| point.3).collect();
            assert_eq!(block.column(&Attribute::GpsTime), Some(&Column::F64(times)));
        }
    }

    #[test]
    fn senseless_records_have_no_layout() {
        let of = |attributes: &[(&str, Type, usize)]| {
            let stored = attributes.iter().map(|(name, kind, num)| StoredAttribute::plain(name, *kind, *num));
            RecordLayout::of(stored.collect(), false).map(|layout| layout.record_bytes)
        };
        assert_eq!(of(&[("position", Type::I32, 3), ("a", Type::U8, 1)]), Ok(13));
        assert!(of(&[("a", Type::U8, 1)]).unwrap_err().contains("no position"));
        assert!(of(&[("position", Type::F32, 3)]).unwrap_err().contains("32 bits"));
        assert!(of(&[("position", Type::I32, 2)]).unwrap_err().contains("32 bits"));
        assert!(
            of(&[("position", Type::I32, 3), ("a", Type::U64, 1 << 40)]).unwrap_err().contains("bytes each")
        );
    }
}
