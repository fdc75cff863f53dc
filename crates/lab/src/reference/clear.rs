//! CPU reference of `clear`.

/// A key that no point has reached.
pub const EMPTY: u64 = render::layout::EMPTY_KEY;

/// An eye's pixels, all of one value.
#[must_use]
pub fn pixels<T: Clone>([width, height]: [u32; 2], value: T) -> Vec<T> {
    vec![value; width as usize * height as usize]
}
