//! CPU reference of `depth`: the nearest point of each pixel of every eye.

use super::points::Put;
use render::layout::KEY_DEPTH_SHIFT;

/// `closest` quality: keeps each pixel's least key, depth ≪ 32 | id.
pub fn key(keys: &mut [Vec<u64>], Put { eye, pixel, w, id, .. }: Put) {
    let key = u64::from(w.to_bits()) << KEY_DEPTH_SHIFT | u64::from(id);
    keys[eye][pixel] = keys[eye][pixel].min(key);
}

/// `hqs` quality: keeps each pixel's least depth.
pub fn nearest(depth: &mut [Vec<u32>], Put { eye, pixel, w, .. }: Put) {
    depth[eye][pixel] = depth[eye][pixel].min(w.to_bits());
}
