//! How words are packed that shaders write for each other, and for whoever reads them back: masks and places of parts.
//! What the builders of clouds pack is in [`cloud::format`].

use super::EMPTY_DEPTH;
#[cfg(doc)]
use super::{Sums, TILE_HIDES, VisibleBatch, mask_words_per_row};

/// An id is a point's number, moved up by this, and [`ID_ODD`] or nothing.
pub const ID_SHIFT: u32 = 1;
/// In an id: the point's filtered color counts.
pub const ID_ODD: u32 = 1;
/// In a key: the depth's place above the id.
pub const KEY_DEPTH_SHIFT: u32 = 32;
/// A key that no point has reached. Both of its words are [`EMPTY_DEPTH`].
pub const EMPTY_KEY: u64 = (EMPTY_DEPTH as u64) << KEY_DEPTH_SHIFT | EMPTY_DEPTH as u64;

/// [`VisibleBatch::own`]: bits of a child's state.
pub const OWN_BITS: u32 = 8;
/// [`VisibleBatch::own`]: how far a node's state is moved down, to have [`OWN_BITS`].
pub const OWN_SHIFT: u32 = 32 - OWN_BITS;
/// [`VisibleBatch::own`]: there is no child. It is also the mask of one child's bits.
pub const OWN_NONE: u32 = (1 << OWN_BITS) - 1;
/// [`VisibleBatch::own`]: children in a word.
pub const OWN_PER_WORD: u32 = 4;
/// [`VisibleBatch::own`]: a word of no children at all.
pub const OWN_NONE_WORD: u32 = u32::MAX;
/// A node's state counts its drawn points in this many parts of all.
pub const STATE_PARTS: u32 = 1 << 24;
/// A node's state: the place of the count of [`STATE_PARTS`], above [`STATE_LOW`].
pub const STATE_SHIFT: u32 = 8;
/// The low bits of a state that is not 0: they are set, so that one point is drawn at least.
pub const STATE_LOW: u32 = (1 << STATE_SHIFT) - 1;

/// [`Sums::Packed`]: the count's bits.
pub const PACKED_COUNT_MASK: u32 = (1 << PACKED_RED_SHIFT) - 1;
/// [`Sums::Packed`]: the place of red, 18 bits as the other channels.
pub const PACKED_RED_SHIFT: u32 = 10;
/// [`Sums::Packed`]: the place of green.
pub const PACKED_GREEN_SHIFT: u32 = 28;
/// [`Sums::Packed`]: the place of blue.
pub const PACKED_BLUE_SHIFT: u32 = 46;
/// [`Sums::Protected`]: the bits of the count, and of each channel.
pub const PROTECTED_MASK: u32 = (1 << PROTECTED_RED_SHIFT) - 1;
/// [`Sums::Protected`]: the place of red.
pub const PROTECTED_RED_SHIFT: u32 = 16;
/// [`Sums::Protected`]: the place of green.
pub const PROTECTED_GREEN_SHIFT: u32 = 32;
/// [`Sums::Protected`]: the place of blue.
pub const PROTECTED_BLUE_SHIFT: u32 = 48;
/// A tile's word: the place of its row, beside [`TILE_HIDES`] and above its column.
pub const TILE_ROW_SHIFT: u32 = 16;
/// A tile's word: its column's bits.
pub const TILE_COLUMN_MASK: u32 = (1 << TILE_ROW_SHIFT) - 1;
/// Pixels in a word of a mask; see [`mask_words_per_row`].
pub const MASK_WORD_PX: u32 = u32::BITS;
