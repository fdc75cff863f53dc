//! Points and faces made up, and a writer of PLY files that shares nothing with the reader.

/// How to write the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MadeEncoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

impl MadeEncoding {
    pub const ALL: [Self; 3] = [Self::Ascii, Self::LittleEndian, Self::BigEndian];
}

#[derive(Clone, Debug)]
pub struct MadePoint {
    pub place: [f64; 3],
    pub rgb: [u8; 3],
    pub intensity: u16,
    pub normal: [f32; 3],
}

impl MadePoint {
    pub fn has_place(&self) -> bool {
        self.place.iter().all(|c| c.is_finite())
    }

    pub fn unit_normal(&self) -> [f32; 3] {
        let length = self.normal.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
        self.normal.map(|c| (f64::from(c) / length) as f32)
    }
}

/// Corners of a face, some of which may not exist.
#[derive(Clone, Debug)]
pub struct MadeFace(pub Vec<i32>);

/// What to write: points in the middle of elements and properties that nobody asked for.
#[derive(Clone, Debug)]
pub struct MadePly {
    pub points: Vec<MadePoint>,
    pub faces: Vec<MadeFace>,
    pub faces_first: bool,
    /// True if points get a list, so that their rows differ in size.
    pub lists: bool,
}

impl MadePly {
    /// Makes points of all kinds, and faces of zero to seven corners, each ninth with a corner that does not exist.
    pub fn new(num_points: usize) -> Self {
        // A multiplicative hash gives irregular numbers.
        let hash = |i: usize, salt: u64| (i as u64 * 7 + salt + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let part = |i: usize, salt, bits: u32| hash(i, salt) >> (64 - bits);
        let points = (0..num_points).map(|i| MadePoint {
            place: [0, 1, 2].map(|axis| part(i, axis, 30) as f64 * 1e-7 + [5e5, 4e6, -30.0][axis as usize]),
            rgb: [3, 4, 5].map(|salt| part(i, salt, 8) as u8),
            intensity: part(i, 6, 16) as u16,
            normal: if i % 11 == 7 { [0.0; 3] } else { [7, 8, 9].map(|s| part(i, s, 9) as f32 - 256.5) },
        });
        let faces = (0..num_points / 2 + 9).map(|i| {
            let corner = |k: usize| (part(i, 20 + k as u64, 31) % num_points as u64) as i32;
            let mut corners: Vec<i32> = (0..i % 8).map(corner).collect();
            if i % 9 == 8 {
                corners.extend([[num_points as i32, -1][i % 2]]);
            }
            MadeFace(corners)
        });
        Self { points: points.collect(), faces: faces.collect(), faces_first: false, lists: true }
    }

    fn is_good(&self, face: &MadeFace) -> bool {
        face.0.iter().all(|corner| (0..self.points.len() as i32).contains(corner))
    }

    pub fn num_bad_faces(&self) -> usize {
        self.faces.iter().filter(|face| !self.is_good(face)).count()
    }

    /// The triangles that the faces make, by the numbers of the points that have a place.
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        let numbers: Vec<u32> = self
            .points
            .iter()
            .scan(0, |next, point| {
                *next += u32::from(point.has_place());
                Some(next.saturating_sub(1))
            })
            .collect();
        let mut triangles = Vec::new();
        for face in self.faces.iter().filter(|face| self.is_good(face)) {
            for pair in face.0.get(1..).unwrap_or_default().windows(2) {
                let corners = [face.0[0], pair[0], pair[1]];
                let distinct =
                    corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
                if distinct && corners.iter().all(|&corner| self.points[corner as usize].has_place()) {
                    triangles.push(corners.map(|corner| numbers[corner as usize]));
                }
            }
        }
        triangles
    }

    pub fn bytes(&self, encoding: MadeEncoding) -> Vec<u8> {
        let mut out = Out { bytes: self.header(encoding).into_bytes(), encoding };
        for row in 0..3u8 {
            out.list(&[row, 1, 2][..usize::from(row)]);
            out.number(f64::from(row) * 0.5);
            out.end_row();
        }
        if self.faces_first {
            self.write_faces(&mut out);
        }
        for (i, point) in self.points.iter().enumerate() {
            out.number(point.place[2]);
            out.byte(point.rgb[0]);
            out.byte(point.rgb[1]);
            out.byte(point.rgb[2]);
            if self.lists {
                out.list(&[9, 8, 7][..i % 4]);
            }
            point.normal.iter().for_each(|c| out.single(*c));
            out.number(point.place[0]);
            out.number(point.place[1]);
            out.word(point.intensity);
            out.single(i as f32);
            out.end_row();
        }
        if !self.faces_first {
            self.write_faces(&mut out);
        }
        out.byte(77);
        out.end_row();
        out.bytes
    }

    fn header(&self, encoding: MadeEncoding) -> String {
        let name = match encoding {
            MadeEncoding::Ascii => "ascii",
            MadeEncoding::LittleEndian => "binary_little_endian",
            MadeEncoding::BigEndian => "binary_big_endian",
        };
        let list = if self.lists { "property list uchar uchar weights\n" } else { "" };
        let vertex = format!(
            "element vertex {}\nproperty double z\nproperty uchar red\nproperty uint8 green\nproperty uchar blue\n\
             {list}property float nx\ncomment in between\nproperty float32 ny\n\
             property float nz\nproperty float64 x\nproperty double y\nproperty ushort intensity\n\
             property float Quality\n",
            self.points.len()
        );
        let face = format!(
            "element face {}\nproperty short flags\nproperty list uchar int vertex_indices\n\
             property list uchar uchar more\n",
            self.faces.len()
        );
        let (first, second) = if self.faces_first { (face, vertex) } else { (vertex, face) };
        format!(
            "ply\nformat {name} 1.0\ncomment Generated by a test\nobj_info nothing\n\
             element camera 3\nproperty list uchar uchar before\nproperty double weight\n{first}{second}\
             element end 1\nproperty uchar value\nelement nothing 0\nproperty list int float more\nend_header\n"
        )
    }

    fn write_faces(&self, out: &mut Out) {
        for face in &self.faces {
            out.word(3);
            out.byte(face.0.len() as u8);
            face.0.iter().for_each(|corner| out.integer(*corner));
            out.list(&[1, 2]);
            out.end_row();
        }
    }
}

/// The bytes so far.
struct Out {
    bytes: Vec<u8>,
    encoding: MadeEncoding,
}

impl Out {
    fn put<const N: usize>(&mut self, text: impl std::fmt::Display, little: [u8; N]) {
        match self.encoding {
            MadeEncoding::Ascii => self.bytes.extend(format!("{text} ").bytes()),
            MadeEncoding::LittleEndian => self.bytes.extend(little),
            MadeEncoding::BigEndian => self.bytes.extend(little.iter().rev()),
        }
    }

    fn byte(&mut self, value: u8) {
        self.put(value, [value]);
    }

    fn word(&mut self, value: u16) {
        self.put(value, value.to_le_bytes());
    }

    fn integer(&mut self, value: i32) {
        self.put(value, value.to_le_bytes());
    }

    fn single(&mut self, value: f32) {
        self.put(value, value.to_le_bytes());
    }

    fn number(&mut self, value: f64) {
        self.put(value, value.to_le_bytes());
    }

    fn list(&mut self, values: &[u8]) {
        self.byte(values.len() as u8);
        values.iter().for_each(|value| self.byte(*value));
    }

    fn end_row(&mut self) {
        if self.encoding == MadeEncoding::Ascii {
            self.bytes.extend(b"\r\n");
        }
    }
}
