//! Numbers in text: the plain ones quickly, all others as the standard library and old programs write them, and the bits of
//! packed colors.

/// Most digits behind the point of a plain number: a f64 holds powers of ten up to this exactly.
const MOST_DECIMALS: usize = 22;
/// Powers of ten by their exponents.
const POWERS_OF_TEN: [f64; MOST_DECIMALS + 1] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// The number that a text starts with, and the rest behind it, if it is as plain as nearly all are: digits, perhaps
/// with a point, that make a whole number of at most 2⁵³. It is then a quotient of two exact numbers, so correctly
/// rounded. The number ends at a byte that `parts` it from others.
#[inline]
pub(super) fn plain_number(
    text: &[u8],
    decimal_point: u8,
    parts: impl Fn(&u8) -> bool,
) -> Option<(f64, &[u8])> {
    let digits = text.strip_prefix(b"-").unwrap_or(text);
    let (mut whole, mut num_digits, mut point) = (0u64, 0, None);
    let mut end = digits.len();
    for (at, byte) in digits.iter().enumerate() {
        match byte {
            b'0'..=b'9' => {
                whole = whole.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
                num_digits += 1;
            }
            _ if *byte == decimal_point && point.is_none() => point = Some(at),
            _ if parts(byte) => {
                end = at;
                break;
            }
            _ => return None,
        }
    }
    let num_decimals = point.map_or(0, |point| end - point - 1);
    // 19 digits are less than 2⁶⁴.
    if !(1..=19).contains(&num_digits) || whole > 1 << 53 || num_decimals > MOST_DECIMALS {
        return None;
    }
    let value = whole as f64 / POWERS_OF_TEN[num_decimals];
    Some((if digits.len() < text.len() { -value } else { value }, &digits[end..]))
}

/// Replaces the exponent letter of Fortran's double and quadruple precision by an e: 1.0D+00 becomes 1.0e+00.
fn of_fortran(word: &str) -> String {
    word.replacen(['D', 'd', 'Q', 'q'], "e", 1)
}

/// Parses a word as a number.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let word = std::str::from_utf8(word).ok()?;
    // A comma may stand before the blanks between numbers.
    let word = word.strip_suffix(',').unwrap_or(word);
    match word.parse().or_else(|_| of_fortran(word).parse()) {
        Ok(value) => Some(value),
        // "-nan(ind)", "1.#QNAN", "-1.#INF": what C libraries print where there is no number.
        Err(_) if word.contains('#') || word.to_ascii_lowercase().contains("nan") => Some(f64::NAN),
        Err(_) => None,
    }
}

/// The 32 bits that a number stands for. A float between 1 and 2³² is a whole number that was converted: as bits it
/// would have a nonsensical first byte.
pub(super) fn packed_bits(value: f64, is_float: bool) -> u32 {
    let is_number = !is_float || value == 0.0 || (1.0..=f64::from(u32::MAX)).contains(&value);
    if is_number { value as i64 as u32 } else { (value as f32).to_bits() }
}
