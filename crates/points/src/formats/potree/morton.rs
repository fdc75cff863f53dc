//! Three numbers whose bits are interleaved in one, as compressed nodes of Potree 2 have them: x is bit 0, y bit 1.

/// Bytes of a position: its upper halves interleaved, then its lower halves.
pub(super) const POSITION_BYTES: usize = 16;
/// Bytes of a color.
pub(super) const COLOR_BYTES: usize = 8;

/// The three numbers of 21 bits in a code.
pub(super) fn parts(code: u64) -> [u32; 3] {
    [0, 1, 2].map(|axis| every_third(code >> axis))
}

/// Bits 0, 3, 6 … 60.
fn every_third(code: u64) -> u32 {
    let mut bits = code & 0x1249_2492_4924_9249;
    bits = (bits ^ bits >> 2) & 0x10c3_0c30_c30c_30c3;
    bits = (bits ^ bits >> 4) & 0x100f_00f0_0f00_f00f;
    bits = (bits ^ bits >> 8) & 0x001f_0000_ff00_00ff;
    bits = (bits ^ bits >> 16) & 0x001f_0000_0000_ffff;
    ((bits ^ bits >> 32) & 0x001f_ffff) as u32
}

/// The position in its bytes.
pub(super) fn position(bytes: &[u8; POSITION_BYTES]) -> [i32; 3] {
    let [upper, lower] =
        [0, 8].map(|at| parts(u64::from_le_bytes(bytes[at..].first_chunk().copied().unwrap_or_default())));
    // The upper halves have 16 bits; a code of more would lose them here.
    std::array::from_fn(|axis| (upper[axis] << 16 | lower[axis] & 0xffff) as i32)
}

/// Interleaves three numbers of 21 bits.
#[cfg(test)]
pub(super) fn code(parts: [u32; 3]) -> u64 {
    let bits =
        |part: u32, axis: u32| (0..21).map(|bit| u64::from(part >> bit & 1) << (3 * bit + axis)).sum::<u64>();
    (0..3).map(|axis| bits(parts[axis as usize], axis)).sum()
}

/// The bytes of a position.
#[cfg(test)]
pub(super) fn position_bytes(xyz: [i32; 3]) -> Vec<u8> {
    let halves = |shift: u32| code(xyz.map(|c| c as u32 >> shift & 0xffff));
    [halves(16), halves(0)].iter().flat_map(|code| code.to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn positions_and_colors_come_back(xyz: [i32; 3], rgb: [u16; 3]) {
            prop_assert_eq!(position(position_bytes(xyz)[..].first_chunk().unwrap()), xyz);
            prop_assert_eq!(parts(code(rgb.map(u32::from))), rgb.map(u32::from));
        }
    }

    #[test]
    fn x_comes_first() {
        assert_eq!((code([1, 0, 0]), code([0, 1, 0]), code([0, 0, 2])), (1, 2, 32));
    }
}
