//! Nodes of octrees of files, as EPT and COPC name them: by depth, and by the place among the nodes of that depth.

use std::fmt;

/// The deepest level that nodes may have: at a depth of 31, a cube of the earth has edges of millimeters.
const DEEPEST: u32 = 31;

/// A node's place in its octree. Keys are in the order of depth, the root first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct NodeKey {
    /// Steps from the root, whose depth is 0.
    depth: u32,
    /// Place along each axis, less than 2 to the power of the depth.
    xyz: [u32; 3],
}

impl NodeKey {
    /// The root.
    pub const ROOT: Self = Self { depth: 0, xyz: [0; 3] };

    /// The node with these numbers; `None` if there can be no such node.
    pub fn new(depth: i64, xyz: [i64; 3]) -> Option<Self> {
        let depth = u32::try_from(depth).ok().filter(|depth| *depth <= DEEPEST)?;
        let is_inside = |number: &i64| (0..1i64 << depth).contains(number);
        xyz.iter().all(is_inside).then(|| Self { depth, xyz: xyz.map(|number| number as u32) })
    }

    /// The node of a name such as "2-0-1-3".
    pub fn parse(name: &str) -> Option<Self> {
        let mut numbers = [0; 4];
        let mut words = name.split('-');
        for number in &mut numbers {
            let word = words.next()?;
            let is_plain = !word.is_empty() && word.len() <= 10 && word.bytes().all(|b| b.is_ascii_digit());
            *number = word.parse().ok().filter(|_| is_plain)?;
        }
        let [depth, x, y, z] = numbers;
        Self::new(depth, [x, y, z]).filter(|_| words.next().is_none())
    }

    /// The node's cube, by its smallest corner and its edge, as parts of the root's edge.
    pub fn cube(self) -> ([f64; 3], f64) {
        let edge = 0.5f64.powi(self.depth as i32);
        (self.xyz.map(|number| f64::from(number) * edge), edge)
    }

    /// The edge of a cell of the node's sampling grid, given that of the root.
    pub fn spacing(self, of_root: f64) -> f64 {
        of_root * 0.5f64.powi(self.depth as i32)
    }
}

impl fmt::Display for NodeKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { depth, xyz: [x, y, z] } = self;
        write!(f, "{depth}-{x}-{y}-{z}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_written() {
        for name in ["0-0-0-0", "1-0-1-1", "31-2147483647-0-5"] {
            assert_eq!(NodeKey::parse(name).unwrap().to_string(), name);
        }
        for name in
            ["", "0-0-0", "0-0-0-0-0", "1-2-0-0", "1-+1-0-0", "32-0-0-0", "-1-0-0-0", "0-0-0-99999999999"]
        {
            assert_eq!(NodeKey::parse(name), None, "{name}");
        }
        assert!(NodeKey::parse("1-1-1-1") < NodeKey::parse("2-0-0-0"));
    }

    #[test]
    fn cubes_and_spacings_halve_with_each_depth() {
        let node = NodeKey::parse("2-3-0-1").unwrap();
        assert_eq!(node.cube(), ([0.75, 0.0, 0.25], 0.25));
        assert_eq!((node.spacing(1.0), NodeKey::ROOT.spacing(0.5)), (0.25, 0.5));
    }
}
