//! Finds which axis of a file points up. The world has z up; models and many photogrammetry programs have y.
//!
//! A file's header may say it, or its surfaces may leave no doubt. Files that could be parts of one model are turned
//! together. A guess must be certain: a scan that is turned wrongly is worse than one that somebody has to turn.

mod header;
mod lying;
mod surface;

pub(super) use header::stated;

use super::{Axes, Header, ScanFile};
use base::words;
use glam::DVec3;
use surface::Vote;

base::choice! {
    /// What is known or said of the axis of the files' coordinates that points up.
    pub enum Up {
        /// The axis that a file's header or its surfaces leave no doubt of, or else z.
        Auto = "auto",
        /// z, as surveyors have it.
        Z = "z",
        /// y, and z points toward the viewer, as in models and much photogrammetry.
        Y = "y",
        /// −y, and z points away from the viewer, as in cameras' coordinates and many splats.
        MinusY = "-y",
    }
}

/// The axis of a file's coordinates that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// z.
    #[default]
    Z,
    /// y.
    Y,
    /// −y.
    MinusY,
}

impl UpAxis {
    /// Converts a vector along the file's axes to one along the world's. No number is rounded.
    #[must_use]
    pub fn in_world(self, v: DVec3) -> DVec3 {
        match self {
            Self::Z => v,
            Self::Y => DVec3::new(v.x, -v.z, v.y),
            Self::MinusY => DVec3::new(v.x, v.z, -v.y),
        }
    }

    /// Name for people: "y".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Z => "z",
            Self::Y => "y",
            Self::MinusY => "-y",
        }
    }
}

/// Why an axis must point up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Evidence {
    /// The axis that must point up.
    pub up: UpAxis,
    /// The end of a sentence: y is taken for up, since …
    pub why: &'static str,
}

/// Coordinates above this many units are an offset: nothing on the earth is that high.
const OFFSET: f64 = 100_000.0;
/// Heights are below this many units, also with an offset.
const HEIGHT: f64 = 10_000.0;

/// The axis that points up in each file, and sentences about files that were turned without being asked. `axes` says
/// what the files' coordinates are: places on the earth have their own up.
pub(super) fn of_files(
    files: &[ScanFile],
    headers: &[Header],
    axes: &[Axes],
    up: Up,
) -> (Vec<UpAxis>, Vec<String>) {
    let set = match up {
        Up::Auto => None,
        Up::Z => Some(UpAxis::Z),
        Up::Y => Some(UpAxis::Y),
        Up::MinusY => Some(UpAxis::MinusY),
    };
    if let Some(set) = set {
        return (vec![set; files.len()], Vec::new());
    }
    let mut ups = vec![UpAxis::Z; files.len()];
    let mut sentences = Vec::new();
    let sentence = |subject: String, evidence: Evidence| {
        let Evidence { up, why } = evidence;
        format!("{subject}: {} is taken for up, since {why} (cloud.up=z leaves it)", up.name())
    };
    let mut open = Vec::new();
    for (at, header) in headers.iter().enumerate().filter(|(at, _)| axes[*at] == Axes::Planar) {
        match header.up {
            Some(evidence) => {
                ups[at] = evidence.up;
                let is_turned = evidence.up != UpAxis::Z;
                sentences.extend(is_turned.then(|| sentence(header.path.display().to_string(), evidence)));
            }
            // Surveys have z up.
            None if header.is_on_fixed_grid => {}
            None => open.push(at),
        }
    }
    let votes: Vec<Vote> = open.iter().map(|&at| vote(&files[at])).collect();
    if let Some((first, evidence)) = together(votes.iter().copied()) {
        open.iter().for_each(|&at| ups[at] = evidence.up);
        sentences.push(sentence(words::files(files[open[first]].path.display(), open.len()), evidence));
    } else if !votes.contains(&Vote::Against) {
        sentences.extend(lying(open.iter().map(|&at| &files[at])));
    }
    (ups, sentences)
}

/// A sentence about files that look as if they lay on their side, although nothing proves it.
fn lying<'a>(files: impl Iterator<Item = &'a ScanFile>) -> Option<String> {
    let found: Vec<(&ScanFile, UpAxis)> =
        files.filter_map(|file| Some((file, lying::likely_up(file)?))).collect();
    let &(first, up) = found.first()?;
    let (subject, up) = (words::files(first.path.display(), found.len()), up.name());
    Some(format!(
        "{subject}: half of the points are in the plane y = 0, the others on one side of it: if they lie on their side, \
         --set cloud.up={up} stands them upright"
    ))
}

/// The evidence that the votes of parts of one model come to, and the number of the first part that has it.
fn together(votes: impl Iterator<Item = Vote>) -> Option<(usize, Evidence)> {
    let mut found: Option<(usize, Evidence)> = None;
    for (at, vote) in votes.enumerate() {
        match (vote, &found) {
            (Vote::Against, _) => return None,
            (Vote::For(evidence), Some((_, other))) if evidence.up != other.up => return None,
            (Vote::For(evidence), None) => found = Some((at, evidence)),
            _ => {}
        }
    }
    found
}

fn vote(file: &ScanFile) -> Vote {
    match offset(file) {
        Some(UpAxis::Z) => Vote::Against,
        Some(up) => Vote::For(Evidence { up, why: "x and z have a map's coordinates" }),
        None => surface::vote(file),
    }
}

/// The axis that must point up because the others have offsets of a map: a hundred kilometers and more, large against
/// the scan.
fn offset(file: &ScanFile) -> Option<UpAxis> {
    let middle = super::world::median(super::world::samples(file).collect());
    let size = file.bounds.size();
    let is_offset = |axis: usize| middle[axis].abs() >= OFFSET && size[axis] < 0.2 * middle[axis].abs();
    let is_height = |axis: usize| middle[axis].abs() < HEIGHT && size[axis] < HEIGHT;
    match (is_offset(0), is_offset(1), is_offset(2)) {
        (_, true, false) => Some(UpAxis::Z),
        (true, false, true) if is_height(1) => Some(UpAxis::Y),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_model_are_turned_together_or_not_at_all() {
        let y = Vote::For(Evidence { up: UpAxis::Y, why: "it has floors" });
        let down = Vote::For(Evidence { up: UpAxis::MinusY, why: "it has floors" });
        let found = |votes: &[Vote]| together(votes.iter().copied()).map(|(at, evidence)| (at, evidence.up));
        assert_eq!(found(&[Vote::Unsure, y, Vote::Unsure]), Some((1, UpAxis::Y)));
        assert_eq!(found(&[y, y]), Some((0, UpAxis::Y)));
        for none in [&[y, Vote::Against][..], &[y, down], &[Vote::Unsure], &[]] {
            assert_eq!(found(none), None, "{none:?}");
        }
    }

    #[test]
    fn turning_keeps_hands_and_puts_up_up() {
        for (up, up_in_file) in [(UpAxis::Z, DVec3::Z), (UpAxis::Y, DVec3::Y), (UpAxis::MinusY, DVec3::NEG_Y)]
        {
            assert_eq!(up.in_world(up_in_file), DVec3::Z);
            let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| up.in_world(axis));
            assert_eq!(x.cross(y), z);
        }
    }
}
