//! LZF, the compression of PCD: runs of bytes as they are, and copies of bytes that came before.
//!
//! A byte below 32 is a run of one byte more than it says. Any other begins a copy: its upper three bits are the length less
//! two (7: plus the next byte), its lower five and the byte behind are the distance less one.

use std::collections::TryReserveError;

/// Most bytes that a byte of input makes: three make a copy of up to 264.
pub(super) const MOST_TIMES: u64 = 88;

/// What could be decompressed.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Decompressed {
    pub bytes: Vec<u8>,
    /// True if the input made sense to its end.
    pub is_whole: bool,
}

/// Decompresses at most `most` bytes, as far as the input makes sense.
///
/// # Errors
/// There is no memory.
pub(super) fn decompress(input: &[u8], most: usize) -> Result<Decompressed, TryReserveError> {
    // No more is taken than the input can make.
    let most = most.min(input.len().saturating_mul(MOST_TIMES as usize));
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(most)?;
    let is_whole = add(input, most, &mut bytes).is_some();
    Ok(Decompressed { bytes, is_whole })
}

/// Appends all that the input makes; `None` where it makes no sense or too much.
fn add(mut input: &[u8], most: usize, bytes: &mut Vec<u8>) -> Option<()> {
    while let Some((&control, rest)) = input.split_first() {
        let room = most - bytes.len();
        if control < 32 {
            let len = usize::from(control) + 1;
            let there = len.min(rest.len());
            bytes.extend_from_slice(&rest[..there.min(room)]);
            if there < len || len > room {
                return None;
            }
            input = &rest[len..];
            continue;
        }
        let mut len = usize::from(control >> 5);
        let mut rest = rest;
        if len == 7 {
            let (&more, behind) = rest.split_first()?;
            len += usize::from(more);
            rest = behind;
        }
        let (&low, behind) = rest.split_first()?;
        input = behind;
        len += 2;
        let distance = (usize::from(control & 31) << 8 | usize::from(low)) + 1;
        let start = bytes.len().checked_sub(distance)?;
        let copied = len.min(room);
        if distance >= copied {
            bytes.extend_from_within(start..start + copied);
        } else {
            // The copy repeats itself.
            (start..start + copied).for_each(|at| bytes.push(bytes[at]));
        }
        if copied < len {
            return None;
        }
    }
    Some(())
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Compresses bytes, not well: runs of equal bytes and copies of what was 7 bytes before.
    pub fn compress(bytes: &[u8]) -> Vec<u8> {
        let (mut output, mut run): (Vec<u8>, Vec<u8>) = (Vec::new(), Vec::new());
        let flush = |run: &mut Vec<u8>, output: &mut Vec<u8>| {
            for chunk in run.chunks(32) {
                output.push(chunk.len() as u8 - 1);
                output.extend_from_slice(chunk);
            }
            run.clear();
        };
        let mut at = 0;
        while at < bytes.len() {
            let found = [1, 4, 7, 16].into_iter().filter(|distance| *distance <= at).find_map(|distance| {
                let len = (at..bytes.len()).take_while(|&i| bytes[i] == bytes[i - distance]).count().min(264);
                (len > 2).then_some((distance, len))
            });
            let Some((distance, len)) = found else {
                run.push(bytes[at]);
                at += 1;
                continue;
            };
            flush(&mut run, &mut output);
            let (d, l) = (distance - 1, len - 2);
            if l < 7 {
                output.push((l << 5 | d >> 8) as u8);
            } else {
                output.extend([(7 << 5 | d >> 8) as u8, (l - 7) as u8]);
            }
            output.push((d & 0xff) as u8);
            at += len;
        }
        flush(&mut run, &mut output);
        output
    }

    proptest! {
        #[test]
        fn what_was_compressed_comes_back(words in proptest::collection::vec((any::<[u8; 4]>(), 1..90usize), 0..40)) {
            let bytes: Vec<u8> = words.iter().flat_map(|(word, times)| word.repeat(*times)).collect();
            let input = compress(&bytes);
            let got = decompress(&input, bytes.len()).unwrap();
            prop_assert_eq!(&got, &Decompressed { bytes: bytes.clone(), is_whole: true });
            // What is cut off gives a beginning.
            for cut in (0..input.len()).step_by(1 + input.len() / 16) {
                let got = decompress(&input[..cut], bytes.len()).unwrap();
                prop_assert!(bytes.starts_with(&got.bytes));
            }
            if !bytes.is_empty() {
                let got = decompress(&input, bytes.len() - 1).unwrap();
                prop_assert_eq!(&got.bytes[..], &bytes[..bytes.len() - 1]);
                prop_assert!(!got.is_whole);
            }
        }

        #[test]
        fn any_bytes_end(input in proptest::collection::vec(any::<u8>(), 0..200), most in 0..5000usize) {
            prop_assert!(decompress(&input, most).unwrap().bytes.len() <= most);
        }
    }

    #[test]
    fn no_more_memory_is_taken_than_the_input_can_fill() {
        let got = decompress(&[0, 7], usize::MAX).unwrap();
        assert!(got.bytes.capacity() < 1000 && got.bytes == [7]);
        // A copy of what is before the beginning.
        assert!(!decompress(&[32, 5], 100).unwrap().is_whole);
    }
}
