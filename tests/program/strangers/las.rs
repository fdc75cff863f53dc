//! LAS files, byte by byte, as devices and exporters write them; the writer shares nothing with the reader.

/// A point.
#[derive(Clone, Copy, Debug, Default)]
pub struct LasPoint {
    pub at: [f64; 3],
    pub rgb: [u16; 3],
    pub intensity: u16,
    pub class: u8,
    pub withheld: bool,
}

/// A file to write.
#[derive(Clone, Debug)]
pub struct StrangeLas {
    /// Point format: 2 for LAS 1.2 with colors, 0 without; 7 and 6 for the same in LAS 1.4.
    pub format: u8,
    pub scale: [f64; 3],
    pub offset: [f64; 3],
    /// User, number, payload.
    pub vlrs: Vec<(&'static str, u16, Vec<u8>)>,
    pub points: Vec<LasPoint>,
}

impl StrangeLas {
    pub fn new(format: u8, points: Vec<LasPoint>) -> Self {
        Self { format, scale: [0.001; 3], offset: [0.0; 3], vlrs: Vec::new(), points }
    }

    pub fn at(self, offset: [f64; 3]) -> Self {
        Self { offset, ..self }
    }

    pub fn scaled(self, scale: [f64; 3]) -> Self {
        Self { scale, ..self }
    }

    /// Adds GeoTIFF keys: pairs of a key and its short value.
    pub fn geo_keys(mut self, keys: &[(u16, u16)]) -> Self {
        let head = [1, 1, 0, keys.len() as u16];
        let words = head.into_iter().chain(keys.iter().flat_map(|&(key, value)| [key, 0, 1, value]));
        self.vlrs.push(("LASF_Projection", 34735, words.flat_map(u16::to_le_bytes).collect()));
        self
    }

    /// Adds a coordinate system as text.
    pub fn wkt(mut self, text: &str) -> Self {
        self.vlrs.push(("LASF_Projection", 2112, [text.as_bytes(), &[0]].concat()));
        self
    }

    pub fn bytes(&self) -> Vec<u8> {
        let is_new = self.format >= 6;
        let header_bytes: u16 = if is_new { 375 } else { 227 };
        let record_bytes: u16 = [20, 28, 26, 34, 0, 0, 30, 36][usize::from(self.format)];
        let vlr_bytes: usize = self.vlrs.iter().map(|(.., payload)| 54 + payload.len()).sum();
        let has_wkt = self.vlrs.iter().any(|(_, number, _)| *number == 2112);
        let mut out = vec![0; usize::from(header_bytes)];
        let mut put = |at: usize, bytes: &[u8]| out[at..at + bytes.len()].copy_from_slice(bytes);
        put(0, b"LASF");
        put(6, &(if has_wkt { 16_u16 } else { 0 }).to_le_bytes());
        put(24, &[1, if is_new { 4 } else { 2 }]);
        put(94, &header_bytes.to_le_bytes());
        put(96, &(usize::from(header_bytes) as u32 + vlr_bytes as u32).to_le_bytes());
        put(100, &(self.vlrs.len() as u32).to_le_bytes());
        put(104, &[self.format]);
        put(105, &record_bytes.to_le_bytes());
        put(107, &(self.points.len() as u32).to_le_bytes());
        for axis in 0..3 {
            put(131 + 8 * axis, &self.scale[axis].to_le_bytes());
            put(155 + 8 * axis, &self.offset[axis].to_le_bytes());
            let all = self.points.iter().map(|point| point.at[axis]);
            put(179 + 16 * axis, &all.clone().fold(f64::NEG_INFINITY, f64::max).to_le_bytes());
            put(187 + 16 * axis, &all.fold(f64::INFINITY, f64::min).to_le_bytes());
        }
        if is_new {
            put(247, &(self.points.len() as u64).to_le_bytes());
        }
        for (user, number, payload) in &self.vlrs {
            let mut head = [0; 54];
            head[2..2 + user.len()].copy_from_slice(user.as_bytes());
            head[18..20].copy_from_slice(&number.to_le_bytes());
            head[20..22].copy_from_slice(&(payload.len() as u16).to_le_bytes());
            out.extend(head);
            out.extend(payload);
        }
        self.points.iter().for_each(|point| self.record(point, &mut out));
        out
    }

    fn record(&self, point: &LasPoint, out: &mut Vec<u8>) {
        for axis in 0..3 {
            let steps = ((point.at[axis] - self.offset[axis]) / self.scale[axis]).round();
            out.extend((steps as i32).to_le_bytes());
        }
        out.extend(point.intensity.to_le_bytes());
        if self.format >= 6 {
            out.extend([0x11, u8::from(point.withheld) << 2, point.class]);
            out.extend([0; 1 + 2 + 2 + 8]);
        } else {
            out.extend([0x09, point.class | u8::from(point.withheld) << 7]);
            out.extend([0; 1 + 1 + 2]);
        }
        if matches!(self.format, 2 | 7) {
            out.extend(point.rgb.into_iter().flat_map(u16::to_le_bytes));
        }
    }
}

/// Numbers that look random, the same every time.
pub struct Chance(u64);

impl Chance {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// A number from 0 to 1.
    pub fn part(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A place of `edge` × `edge` ground round `center`, with a tower of 0.3 × `edge` in its middle; 16-bit colors.
pub fn place(num: usize, center: [f64; 3], edge: f64) -> Vec<LasPoint> {
    let mut chance = Chance::new(num as u64);
    let mut point = || {
        let [u, v, w] = [0; 3].map(|_: i32| chance.part());
        let (x, y, z) = if chance.part() < 0.6 {
            (u - 0.5, v - 0.5, 0.0)
        } else {
            let (along, side) = (0.2 * (u - 0.5), if v < 0.5 { -0.1 } else { 0.1 });
            if chance.part() < 0.5 { (along, side, 0.3 * w) } else { (side, along, 0.3 * w) }
        };
        let at = [center[0] + edge * x, center[1] + edge * y, center[2] + edge * z];
        let rgb = [u, v, w].map(|part| (65535.0 * (0.2 + 0.8 * part)) as u16);
        LasPoint { at, rgb, intensity: (65535.0 * w) as u16, class: 2, withheld: false }
    };
    (0..num).map(|_| point()).collect()
}

/// The inside of a room of 6 × 4 × 3, its floor's middle at `center`.
pub fn room(num: usize, center: [f64; 3]) -> Vec<LasPoint> {
    let mut chance = Chance::new(7 + num as u64);
    let edges = [6.0, 4.0, 3.0];
    let mut point = || {
        let mut part = [0; 3].map(|_: i32| chance.part());
        let side = (6.0 * chance.part()) as usize;
        part[side / 2] = (side % 2) as f64;
        let at = [0, 1, 2]
            .map(|axis| center[axis] + edges[axis] * (part[axis] - if axis == 2 { 0.0 } else { 0.5 }));
        LasPoint { at, rgb: [40_000, 50_000, 60_000], intensity: 9, class: 2, withheld: false }
    };
    (0..num).map(|_| point()).collect()
}

/// Points anywhere in a box.
pub fn strays(num: usize, low: [f64; 3], high: [f64; 3]) -> Vec<LasPoint> {
    let mut chance = Chance::new(99);
    let mut at = || [0, 1, 2].map(|axis| low[axis] + chance.part() * (high[axis] - low[axis]));
    (0..num).map(|_| LasPoint { at: at(), rgb: [60_000, 0, 60_000], ..LasPoint::default() }).collect()
}
