//! A recorded head path, replayed: for measurements that can be repeated.
//!
//! A text file, one pose a line: `time_s,x,y,z,qx,qy,qz,qw`: seconds from the start, then `world_from_head`
//! (scan coordinates; the head looks along its −z, y up). Lines that begin with `#` and a header line of names
//! are skipped. Between two poses the head moves evenly; after the last it stays.

use base::space::Pose;
use base::words::advice;
use glam::{DQuat, DVec3};
use std::fmt;
use std::path::{Path, PathBuf};

/// Names of a line's values.
const HEADER: &str = "time_s,x,y,z,qx,qy,qz,qw";
/// How long a jump from one held pose to the next takes: no frame falls into it.
const JUMP_S: f64 = 1e-6;

/// Why a path could not be read.
#[derive(Debug, thiserror::Error)]
pub enum PosePathError {
    /// The file cannot be read.
    #[error("{} cannot be read: {source}{advice}", path.display(), advice = advice(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's words.
        source: std::io::Error,
    },
    /// A line of the file is no pose.
    #[error("{}, line {line}: {what}; a line is time_s,x,y,z,qx,qy,qz,qw", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Number of the line, counted from 1.
        line: usize,
        /// What is wrong.
        what: &'static str,
    },
    /// The file holds no pose at all.
    #[error("{}: holds no pose; a line is time_s,x,y,z,qx,qy,qz,qw", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
}

/// Poses of the head over time.
#[derive(Clone, Debug, PartialEq)]
pub struct PosePath {
    /// Seconds, ascending, and `world_from_head`; never empty.
    poses: Vec<(f64, Pose)>,
}

impl PosePath {
    /// Reads a path file.
    ///
    /// # Errors
    /// Unreadable file, a line that is no pose, times that go backwards, no pose.
    pub fn read(path: &Path) -> Result<Self, PosePathError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| PosePathError::Io { path: path.to_path_buf(), source })?;
        let fail = |line, what| PosePathError::Line { path: path.to_path_buf(), line, what };
        let mut poses: Vec<(f64, Pose)> = Vec::new();
        for (number, line) in text.lines().enumerate().map(|(i, l)| (i + 1, l.trim())) {
            if line.is_empty() || line.starts_with('#') || line.starts_with("time_s") {
                continue;
            }
            let values: Result<Vec<f64>, _> = line.split(',').map(|v| v.trim().parse::<f64>()).collect();
            let values = values.map_err(|_| fail(number, "a value is not a number"))?;
            let [time, x, y, z, qx, qy, qz, qw] = values[..] else {
                return Err(fail(number, "there are not 8 values"));
            };
            let orientation = DQuat::from_xyzw(qx, qy, qz, qw);
            if !values.iter().all(|v| v.is_finite()) || orientation.length() < 1e-6 {
                return Err(fail(number, "the pose is not finite, or its quaternion is zero"));
            }
            if poses.last().is_some_and(|(before, _)| time <= *before) {
                return Err(fail(number, "the time does not rise"));
            }
            let pose = Pose { position: DVec3::new(x, y, z), orientation: orientation.normalize() };
            poses.push((time, pose));
        }
        if poses.is_empty() {
            return Err(PosePathError::Empty { path: path.to_path_buf() });
        }
        Ok(Self { poses })
    }

    /// A path that holds each pose for `hold_s` seconds and then jumps to the next; `None` without a pose.
    #[must_use]
    pub fn holding(poses: impl IntoIterator<Item = Pose>, hold_s: f64) -> Option<Self> {
        let held = poses.into_iter().enumerate().flat_map(|(at, pose)| {
            let begin_s = at as f64 * hold_s;
            [(begin_s, pose), (begin_s + hold_s - JUMP_S, pose)]
        });
        let poses: Vec<_> = held.collect();
        (!poses.is_empty()).then_some(Self { poses })
    }

    /// `world_from_head` at a time in seconds: the first pose before its time, the last one after its time.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Pose {
        let after = self.poses.partition_point(|(t, _)| *t <= time_s);
        let (Some((t0, a)), Some((t1, b))) = (self.poses.get(after.wrapping_sub(1)), self.poses.get(after))
        else {
            return self.poses[after.min(self.poses.len() - 1)].1;
        };
        let s = (time_s - t0) / (t1 - t0);
        Pose { position: a.position.lerp(b.position, s), orientation: a.orientation.slerp(b.orientation, s) }
    }
}

/// The file's text, with all digits.
impl fmt::Display for PosePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{HEADER}")?;
        for (time_s, Pose { position, orientation }) in &self.poses {
            write!(f, "{time_s}")?;
            let values = position.to_array().into_iter().chain(orientation.to_array());
            values.into_iter().try_for_each(|value| write!(f, ",{value}"))?;
            writeln!(f)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<PosePath, PosePathError> {
        let file = tempfile::NamedTempFile::new().expect("a file");
        std::fs::write(file.path(), text).expect("written");
        PosePath::read(file.path())
    }

    #[test]
    fn moves_evenly_between_poses() {
        let path =
            read("time_s,x,y,z,qx,qy,qz,qw\n# start\n1,0,0,0,0,0,0,1\n3,4,0,0,0,0,1,0\n").expect("a path");
        assert_eq!(path.at(0.0), path.at(1.0));
        assert_eq!(path.at(9.0).position.x, 4.0);
        let half = path.at(2.0);
        assert!((half.position.x - 2.0).abs() < 1e-12);
        assert!((half.orientation * DVec3::X).x.abs() < 1e-9, "a quarter turn");
    }

    #[test]
    fn what_is_written_is_read_and_holds() {
        let pose = |x: f64| Pose {
            position: DVec3::new(4e6 + x / 3.0, 0.1, -7e-9),
            orientation: DQuat::from_rotation_z(x),
        };
        let path = PosePath::holding([pose(1.0), pose(2.0)], 2.0).expect("two poses");
        let read = read(&path.to_string()).expect("a path");
        for (time_s, x) in [(0.0, 1.0), (2.0, 2.0), (99.0, 2.0)] {
            assert_eq!(read.at(time_s).position, pose(x).position, "{time_s} s: to the last bit");
        }
        for (time_s, x) in [(1.9, 1.0), (2.1, 2.0)] {
            assert!(read.at(time_s).position.abs_diff_eq(pose(x).position, 1e-8), "{time_s} s");
            let turned = read.at(time_s).orientation.dot(pose(x).orientation);
            assert!((turned.abs() - 1.0).abs() < 1e-15, "{time_s} s");
        }
        assert_eq!(PosePath::holding([], 2.0), None);
    }

    #[test]
    fn mistakes_name_their_line() {
        for (text, place) in [
            ("0,0,0,0,0,0,0,1\n1,2,3\n", "line 2"),
            ("0,0,0,x,0,0,0,1\n", "line 1"),
            ("0,0,0,0,0,0,0,0\n", "line 1"),
            ("1,0,0,0,0,0,0,1\n1,0,0,0,0,0,0,1\n", "line 2"),
            ("# nothing\n", "holds no pose"),
        ] {
            let message = read(text).expect_err(text).to_string();
            assert!(message.contains(place), "{message}");
        }
    }
}
