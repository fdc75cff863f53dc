//! Numbers that tests of scenes draw at random, and points of scenes.

use glam::DVec3;

/// Numbers that look random, the same in every run: splitmix64.
pub(super) struct Random(pub u64);

impl Random {
    /// The next number, from 0 to 1.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A scene by name, and what draws positions in it.
pub(super) type SceneMaker = (&'static str, fn(&mut Random) -> DVec3);

/// A position on a floor, four walls and a ceiling, 1 by 1 by 0.5.
pub(super) fn room(random: &mut Random) -> DVec3 {
    let [u, v] = [random.next() - 0.5, random.next() - 0.5];
    let height = 0.5 * (v + 0.5);
    match (6.0 * random.next()) as u32 {
        0 => DVec3::new(u, v, 0.0),
        1 => DVec3::new(u, v, 0.5),
        2 => DVec3::new(u, -0.5, height),
        3 => DVec3::new(u, 0.5, height),
        4 => DVec3::new(-0.5, u, height),
        _ => DVec3::new(0.5, u, height),
    }
}

/// A position on hills, seen from above.
pub(super) fn aerial(random: &mut Random) -> DVec3 {
    let [u, v] = [random.next() - 0.5, random.next() - 0.5];
    DVec3::new(u, v, 0.02 * ((9.0 * u).sin() + (7.0 * v).cos()))
}
