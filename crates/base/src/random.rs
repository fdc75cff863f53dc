//! Random numbers and noise that are the same on every machine and for every number of threads.
//!
//! Both rest on one mixing function (the finalizer of SplitMix64): a stream is the mixed sequence
//! `key + i·γ`, so any number of streams can be started anywhere without the ones before.

use glam::DVec3;

/// 2⁶⁴ / golden ratio, odd: consecutive multiples spread evenly over 64 bits.
const GAMMA: u64 = 0x9E37_79B9_7F4A_7C15;

/// Mixes 64 bits so that every input bit changes every output bit with probability one half.
pub fn mix(bits: u64) -> u64 {
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^ (bits >> 31)
}

/// One stream of random numbers.
#[derive(Clone, Debug)]
pub struct Rng(u64);

impl Rng {
    /// Stream number `stream` of `seed`; streams are unrelated to each other.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self(mix(mix(seed.wrapping_add(GAMMA)) ^ stream.wrapping_mul(GAMMA)))
    }

    /// 64 evenly distributed bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GAMMA);
        mix(self.0)
    }

    /// A number that is evenly distributed in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// A number that is evenly distributed in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A number of mean 0 and standard deviation 1: the sum of four evenly distributed numbers. It is never beyond
    /// ± 3.47, which suits instruments that reject outliers, and needs no logarithm.
    pub fn normal(&mut self) -> f64 {
        let bits = self.bits();
        let sum: u64 = (0..4).map(|i| (bits >> (16 * i)) & 0xFFFF).sum();
        // Four even numbers of 0..=65535: mean 131070, variance 4 · (65536² − 1) / 12.
        (sum as f64 - 131_070.0) / 37_837.227
    }

    /// A direction that is evenly distributed on the unit sphere.
    pub fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = libm::sincos(self.between(0.0, std::f64::consts::TAU));
        let r = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }
}

/// A fixed number in [0, 1) for an integer cell; `salt` separates uses.
pub fn cell_value(cell: [i64; 3], salt: u64) -> f64 {
    let [x, y, z] = cell.map(|c| c as u64);
    let key = x
        .wrapping_mul(0x8DA6_B343_1D2C_9D05)
        .wrapping_add(y.wrapping_mul(0xD816_3841_F26E_55A3))
        .wrapping_add(z.wrapping_mul(0xCB1A_B31F_6A4D_2B17));
    (mix(key ^ salt.wrapping_mul(GAMMA)) >> 40) as f64 * (1.0 / (1_u64 << 24) as f64)
}

/// Smooth noise in [−1, 1] with features of about one unit.
pub fn noise(p: DVec3) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let f = f * f * (DVec3::splat(3.0) - 2.0 * f);
    let [x, y, z] = cell.to_array().map(|c| c as i64);
    let corner = |i: i64, j: i64, k: i64| cell_value([x + i, y + j, z + k], 0);
    let row = |j, k| corner(0, j, k) * (1.0 - f.x) + corner(1, j, k) * f.x;
    let sheet = |k| row(0, k) * (1.0 - f.y) + row(1, k) * f.y;
    2.0 * (sheet(0) * (1.0 - f.z) + sheet(1) * f.z) - 1.0
}

/// Noise of several scales, each half as large and half as strong; in (−1, 1).
pub fn fractal(p: DVec3, octaves: u32) -> f64 {
    let (mut sum, mut weight, mut total, mut p) = (0.0, 1.0, 0.0, p);
    for _ in 0..octaves {
        sum += weight * noise(p);
        total += weight;
        weight *= 0.5;
        // Not exactly 2 and shifted, so that the lattices of the octaves do not line up.
        p = p * 2.03 + DVec3::splat(17.17);
    }
    sum / total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_has_mean_zero_and_deviation_one() {
        let mut rng = Rng::new(3, 0);
        let values: Vec<f64> = (0..100_000).map(|_| rng.normal()).collect();
        let mean = values.iter().sum::<f64>() / 1e5;
        let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / 1e5;
        assert!(mean.abs() < 0.015, "{mean}");
        assert!((variance - 1.0).abs() < 0.02, "{variance}");
    }

    #[test]
    fn streams_differ_and_repeat() {
        let first = |seed, stream| Rng::new(seed, stream).bits();
        assert_eq!(first(1, 2), first(1, 2));
        assert_ne!(first(1, 2), first(2, 1));
        assert_ne!(first(1, 2), first(1, 3));
        assert_ne!(first(0, 0), first(0, 1));
    }

    #[test]
    fn noise_is_continuous_and_bounded() {
        let mut rng = Rng::new(5, 0);
        for _ in 0..2000 {
            let p = 50.0 * rng.direction();
            let (a, b) = (fractal(p, 4), fractal(p + DVec3::splat(1e-6), 4));
            assert!(a.abs() <= 1.0 && (a - b).abs() < 1e-3);
        }
    }

    /// Known values: a change of the generator changes every made-up scan, and must not go unnoticed.
    #[test]
    fn known_values() {
        assert_eq!(mix(1), 0x5692_161D_100B_05E5);
        assert_eq!(Rng::new(0, 0).bits(), 6_235_967_106_033_911_276);
    }
}
