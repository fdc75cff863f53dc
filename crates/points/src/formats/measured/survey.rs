//! The first pass over a file's parts, which finds what must be known of all points before any is put on a grid.

use super::{Part, PartColors, PartIntensities, Places, RowsSeen, both, count_channels};
use crate::grid;
use base::space::Bounds;
use glam::DVec3;

/// Places that are kept as a sample, evenly over the file; somewhat more may be kept.
const SAMPLE: u64 = 1 << 16;

/// What was found so far.
#[derive(Clone, Debug)]
pub(super) struct PartSurvey {
    pub rows: RowsSeen,
    /// Points with a place.
    pub num_kept: u64,
    /// Box of the points with a place.
    pub bounds: Bounds,
    /// Places of a sample of them.
    pub sample: Vec<DVec3>,
    /// Numbers of float channels between 0 and 1, above 1, and above 255.
    pub channels: [u64; 3],
    /// The smallest and largest finite intensity.
    pub intensity: (f64, f64),
    /// Finite intensities of the sample.
    pub intensities: Vec<f64>,
}

impl Default for PartSurvey {
    fn default() -> Self {
        Self {
            rows: RowsSeen::default(),
            num_kept: 0,
            bounds: Bounds::EMPTY,
            sample: Vec::new(),
            channels: [0; 3],
            intensity: (f64::MAX, f64::MIN),
            intensities: Vec::new(),
        }
    }
}

impl PartSurvey {
    /// What a part has, of a file of about `num_points` points.
    pub fn of(part: &Part, num_points: u64) -> Self {
        let mut found = Self { rows: RowsSeen::of(part), ..Self::default() };
        let stride = usize::try_from(num_points.div_ceil(SAMPLE).max(1)).unwrap_or(usize::MAX);
        match &part.places {
            Places::Anywhere(places) => {
                for (number, place) in places.iter().enumerate() {
                    if !grid::is_place(place) {
                        continue;
                    }
                    found.add(number, part);
                    let place = DVec3::from_array(*place);
                    found.bounds = found.bounds.with(place);
                    if number % stride == 0 {
                        found.sample.push(place);
                        found.add_to_sample(number, part);
                    }
                }
            }
            // The box of these is not asked for.
            Places::OnGrid(xyz, none) => {
                for number in (0..xyz.len()).filter(|&number| !none.get(number)) {
                    found.add(number, part);
                    if number % stride == 0 {
                        found.add_to_sample(number, part);
                    }
                }
            }
        }
        found
    }

    #[inline]
    fn add(&mut self, number: usize, part: &Part) {
        self.num_kept += 1;
        if let PartColors::Floats(colors) = &part.colors {
            count_channels(&mut self.channels, colors[number].map(f64::from));
        }
        if let PartIntensities::Numbers(intensities) = &part.intensities
            && intensities[number].is_finite()
        {
            self.intensity = both(self.intensity, (intensities[number], intensities[number]));
        }
    }

    fn add_to_sample(&mut self, number: usize, part: &Part) {
        if let PartIntensities::Numbers(intensities) = &part.intensities
            && intensities[number].is_finite()
        {
            self.intensities.push(intensities[number]);
        }
    }

    /// Adds what a later part has.
    pub fn append(&mut self, later: Self) {
        self.rows.add(later.rows);
        self.num_kept += later.num_kept;
        self.bounds = self.bounds.union(later.bounds);
        self.sample.extend(later.sample);
        self.channels = std::array::from_fn(|range| self.channels[range] + later.channels[range]);
        self.intensity = both(self.intensity, later.intensity);
        self.intensities.extend(later.intensities);
    }
}
