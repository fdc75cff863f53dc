//! The tree of nodes that both versions of Potree have, whatever their files look like: keys, boxes, and where points lie.

use base::space::Bounds;
use glam::DVec3;

/// Levels below the root that a key can name. Halves of a box that often are smaller than any step of its grid.
pub(super) const MOST_LEVEL: u8 = 40;
/// Bits of a child's number in a path.
const CHILD_BITS: u32 = 3;

/// The place of a node in its tree: the numbers of the children on the way from the root.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct NodeName {
    /// Steps from the root; keys are ordered by it first.
    level: u8,
    path: u128,
}

impl NodeName {
    /// The root's key.
    pub const ROOT: Self = Self { level: 0, path: 0 };

    /// Steps from the root.
    pub fn level(self) -> u8 {
        self.level
    }

    /// The key of a child, 0 to 7; `None` below the deepest level.
    pub fn child(self, number: u8) -> Option<Self> {
        let path = self.path << CHILD_BITS | u128::from(number & 7);
        (self.level < MOST_LEVEL).then_some(Self { level: self.level + 1, path })
    }

    /// The keys of the children that a mask names: bit 0 for child 0.
    pub fn children(self, mask: u8) -> impl Iterator<Item = Option<Self>> {
        (0..8).filter(move |number| mask >> number & 1 == 1).map(move |number| self.child(number))
    }

    /// Numbers of the children on the way, from the root's on.
    pub fn digits(self) -> impl Iterator<Item = u8> {
        (0..u32::from(self.level)).rev().map(move |at| (self.path >> (CHILD_BITS * at)) as u8 & 7)
    }

    /// The name that files give a node: "r", "r0", "r07".
    pub fn name(self) -> String {
        std::iter::once('r').chain(self.digits().map(|digit| char::from(b'0' + digit))).collect()
    }

    /// The key of a name; `None` for a word that is none.
    pub fn parse(name: &str) -> Option<Self> {
        name.strip_prefix('r')?.bytes().try_fold(Self::ROOT, |key, digit| match digit {
            b'0'..=b'7' => key.child(digit - b'0'),
            _ => None,
        })
    }
}

/// A node with points of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct StoredNode {
    pub key: NodeName,
    /// First byte of its points in the file that has them.
    pub offset: u64,
    /// Bytes of its points.
    pub num_bytes: u64,
    /// Points that it is said to have.
    pub num_points: u64,
}

/// The nodes of a scan, and the cube that they halve.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeTree {
    /// Box of the root, of which each level halves all edges.
    pub root: Bounds,
    /// Distance between the root's points, as the file says; each level halves it.
    pub root_spacing: f64,
    /// Nodes with points, the root first, then level by level.
    pub nodes: Vec<StoredNode>,
    /// Deepest level of a node.
    pub depth: u8,
    /// Sentences about what the hierarchy lacks, whose subject is the file.
    pub losses: Vec<String>,
}

impl NodeTree {
    /// Puts the nodes in order, breadth first.
    pub fn in_order(mut self) -> Self {
        self.nodes.sort_by_key(|node| node.key);
        self.depth = self.nodes.last().map_or(0, |node| node.key.level());
        self
    }

    /// Smallest corner of a node's box, counted from that of the root's box, in edges of the root's box. It is exact:
    /// each digit is one bit.
    pub fn low_corner(key: NodeName) -> DVec3 {
        let mut half = 1.0;
        key.digits().fold(DVec3::ZERO, |low, digit| {
            half *= 0.5;
            low + half * DVec3::from_array([2, 1, 0].map(|bit| f64::from(digit >> bit & 1)))
        })
    }

    /// A node's box.
    #[cfg_attr(not(test), expect(dead_code, reason = "the tree itself is to be streamed by it"))]
    pub fn bounds(&self, key: NodeName) -> Bounds {
        let size = self.root.size();
        let min = self.root.min + Self::low_corner(key) * size;
        Bounds { min, max: min + size * halved(key) }
    }

    /// Distance between a node's points, as its place in the tree says.
    #[cfg_attr(not(test), expect(dead_code, reason = "the tree itself is to be streamed by it"))]
    pub fn spacing(&self, key: NodeName) -> f64 {
        self.root_spacing * halved(key)
    }
}

/// The part of the root's edge that a node's edge has.
fn halved(key: NodeName) -> f64 {
    0.5f64.powi(i32::from(key.level()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_names_and_names_are_keys() {
        let deepest = format!("r{}", "74210365".repeat(5));
        for name in ["r", "r0", "r7", "r0123456701234567", &deepest] {
            assert_eq!(NodeName::parse(name).unwrap().name(), name);
        }
        let too_deep = format!("{deepest}0");
        for none in ["", "0", "r8", "r0a", "x0", &too_deep] {
            assert_eq!(NodeName::parse(none), None, "{none}");
        }
        let children: Vec<String> =
            NodeName::parse("r5").unwrap().children(0b1000_0011).map(|key| key.unwrap().name()).collect();
        assert_eq!(children, ["r50", "r51", "r57"]);
        assert_eq!(NodeName::parse(&deepest).unwrap().child(0), None);
    }

    #[test]
    fn boxes_are_halved_by_z_y_and_x() {
        let root = Bounds { min: DVec3::new(10.0, 20.0, 30.0), max: DVec3::new(18.0, 28.0, 38.0) };
        let tree = NodeTree { root, root_spacing: 1.0, ..NodeTree::default() };
        for (name, min) in [
            ("r", [10.0, 20.0, 30.0]),
            ("r1", [10.0, 20.0, 34.0]),
            ("r2", [10.0, 24.0, 30.0]),
            ("r46", [16.0, 22.0, 30.0]),
        ] {
            let key = NodeName::parse(name).unwrap();
            let bounds = tree.bounds(key);
            assert_eq!(bounds.min.to_array(), min, "{name}");
            let edge = 8.0 / f64::from(1u32 << key.level());
            assert_eq!((bounds.size(), tree.spacing(key)), (DVec3::splat(edge), edge / 8.0), "{name}");
        }
    }

    #[test]
    fn the_order_is_breadth_first() {
        let node = |name: &str| StoredNode {
            key: NodeName::parse(name).unwrap(),
            offset: 0,
            num_bytes: 0,
            num_points: 0,
        };
        let nodes = ["r00", "r7", "r", "r0", "r77", "r007"].map(node).to_vec();
        let tree = NodeTree { nodes, ..NodeTree::default() }.in_order();
        let names: Vec<String> = tree.nodes.iter().map(|node| node.key.name()).collect();
        assert_eq!((names.join(" ").as_str(), tree.depth), ("r r0 r7 r00 r77 r007", 3));
    }
}
