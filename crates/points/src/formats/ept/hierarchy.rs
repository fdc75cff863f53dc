//! The hierarchy: which nodes there are, from files of JSON that lead to each other.

use crate::ScanError;
use crate::formats::node::NodeKey;
use crate::source::Source;
use base::task::{Cancelled, Progress};
use base::words::{agreeing, counted};
use rayon::prelude::*;
use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::borrow::Cow;
use std::collections::{BTreeMap, HashSet};
use std::fmt;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// Most bytes of a piece, which has some twenty for each node: more nodes than any real scan has.
const MOST_BYTES: u64 = 1 << 29;
/// Bytes of a piece that are read at once.
const BUFFER_BYTES: usize = 1 << 16;
/// What some editors write before a text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
/// Stands in place of a number of points where a node's piece has it, and what is below the node.
const IS_PIECE: i64 = -1;

/// A node of the octree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EptNode {
    pub key: NodeKey,
    /// Points that the hierarchy announces.
    pub announced: u64,
    /// Edge of a cell of its sampling grid; 0 where the scan does not say.
    pub spacing: f64,
}

/// The nodes, breadth first from the root.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct EptTree {
    pub nodes: Vec<EptNode>,
    /// Sentences about what could not be read, whose subject is the scan.
    pub losses: Vec<String>,
}

/// What a piece of the hierarchy has.
#[derive(Debug, Default)]
struct HierarchyPiece {
    /// Nodes and their numbers of points.
    counts: Vec<(NodeKey, u64)>,
    /// Roots of further pieces.
    pieces: Vec<NodeKey>,
    /// Entries that are no nodes.
    num_senseless: u64,
}

impl EptTree {
    /// Reads the root's piece only, as much as tells how points are stored. It need not be there.
    pub fn first(folder: &Path) -> Vec<NodeKey> {
        let piece = HierarchyPiece::read(folder, NodeKey::ROOT).unwrap_or_default();
        let mut keys: Vec<NodeKey> = piece.counts.into_iter().map(|(key, _)| key).collect();
        keys.extend(piece.pieces);
        keys.sort_unstable();
        if keys.is_empty() { vec![NodeKey::ROOT] } else { keys }
    }

    /// Reads all pieces, those of one depth in parallel. The root's sampling grid has this spacing.
    ///
    /// # Errors
    /// The user stops it, or the root's piece cannot be read.
    pub fn read(folder: &Path, spacing: f64, progress: &Progress) -> Result<Self, ScanError> {
        let mut found = BTreeMap::new();
        let mut seen: HashSet<NodeKey> = HashSet::from([NodeKey::ROOT]);
        let mut pieces = vec![NodeKey::ROOT];
        let (mut num_senseless, mut lost) = (0, Vec::new());
        while !pieces.is_empty() {
            let read: Vec<_> = pieces
                .par_iter()
                .map(|&key| {
                    if progress.is_cancelled() {
                        Ok(HierarchyPiece::default())
                    } else {
                        HierarchyPiece::read(folder, key)
                    }
                })
                .collect();
            if progress.is_cancelled() {
                return Err(Cancelled.into());
            }
            let mut next = Vec::new();
            for (key, piece) in pieces.iter().zip(read) {
                let piece = match piece {
                    Ok(piece) => piece,
                    Err(error) if *key == NodeKey::ROOT => return Err(error),
                    Err(error) => {
                        lost.push((*key, error));
                        continue;
                    }
                };
                num_senseless += piece.num_senseless;
                for (key, count) in piece.counts {
                    let known = found.entry(key).or_insert(0);
                    *known = count.max(*known);
                }
                for key in piece.pieces {
                    // The piece states the node's number of points.
                    found.entry(key).or_insert(0);
                    if seen.insert(key) {
                        next.push(key);
                    }
                }
            }
            pieces = next;
        }
        let node =
            |(key, announced): (NodeKey, u64)| EptNode { key, announced, spacing: key.spacing(spacing) };
        let nodes = found.into_iter().map(node).collect();
        Ok(Self { nodes, losses: losses(num_senseless, &lost) })
    }
}

fn losses(num_senseless: u64, lost: &[(NodeKey, ScanError)]) -> Vec<String> {
    let mut losses = Vec::new();
    if let Some((key, error)) = lost.first() {
        let pieces = counted(lost.len(), "piece");
        let are = agreeing(lost.len(), "is", "are");
        losses.push(format!(
            "has {pieces} of its hierarchy that {are} lost, with the nodes in it (the first is {key}: {error})"
        ));
    }
    if num_senseless > 0 {
        let entries = counted(num_senseless, "entry").replace("entrys", "entries");
        losses.push(format!("has {entries} in its hierarchy that name no nodes"));
    }
    losses
}

fn piece_path(folder: &Path, key: NodeKey) -> PathBuf {
    folder.join("ept-hierarchy").join(format!("{key}.json"))
}

impl HierarchyPiece {
    fn read(folder: &Path, key: NodeKey) -> Result<Self, ScanError> {
        let path = piece_path(folder, key);
        let source = Source::open(&path)?;
        let has_mark = source.bytes(0, 3)? == BYTE_ORDER_MARK;
        let start = if has_mark { BYTE_ORDER_MARK.len() as u64 } else { 0 };
        let text = BufReader::with_capacity(BUFFER_BYTES, source.reader(start)).take(MOST_BYTES);
        let mut json = serde_json::Deserializer::from_reader(text);
        let mut piece = Self::default();
        // What was read before the damage counts.
        match json.deserialize_map(PieceEntries(&mut piece)) {
            Err(error) if piece.counts.is_empty() && piece.pieces.is_empty() => Err(ScanError::Line {
                path,
                line: error.line().max(1) as u64,
                problem: format!("is not the JSON of a hierarchy ({error}); get the file again"),
            }),
            Err(_) => {
                piece.num_senseless += 1;
                Ok(piece)
            }
            Ok(()) => Ok(piece),
        }
    }

    fn enter(&mut self, name: &str, count: Option<i64>) {
        match (NodeKey::parse(name), count) {
            (Some(key), Some(IS_PIECE)) => self.pieces.push(key),
            (Some(key), Some(count)) if count >= 0 => self.counts.push((key, count as u64)),
            _ => self.num_senseless += 1,
        }
    }
}

/// Takes in the entries of a piece one by one.
struct PieceEntries<'a>(&'a mut HierarchyPiece);

impl<'de> Visitor<'de> for PieceEntries<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("nodes and their numbers of points")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(name) = map.next_key::<Cow<'de, str>>()? {
            let NodeCount(count) = map.next_value()?;
            self.0.enter(&name, count);
        }
        Ok(())
    }
}

/// A number of points; `None` for anything else, which is passed over.
struct NodeCount(Option<i64>);

impl<'de> Deserialize<'de> for NodeCount {
    fn deserialize<D: Deserializer<'de>>(json: D) -> Result<Self, D::Error> {
        json.deserialize_any(NumberVisitor).map(Self)
    }
}

struct NumberVisitor;

impl<'de> Visitor<'de> for NumberVisitor {
    type Value = Option<i64>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number of points")
    }

    fn visit_i64<E>(self, number: i64) -> Result<Option<i64>, E> {
        Ok(Some(number))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Option<i64>, E> {
        Ok(Some(i64::try_from(number).unwrap_or(i64::MAX)))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Option<i64>, E> {
        Ok(Some(number as i64))
    }

    fn visit_bool<E>(self, _: bool) -> Result<Option<i64>, E> {
        Ok(None)
    }

    fn visit_unit<E>(self) -> Result<Option<i64>, E> {
        Ok(None)
    }

    fn visit_str<E>(self, _: &str) -> Result<Option<i64>, E> {
        Ok(None)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Option<i64>, A::Error> {
        while list.next_element::<IgnoredAny>()?.is_some() {}
        Ok(None)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Option<i64>, A::Error> {
        while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with these pieces of a hierarchy.
    fn folder(pieces: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("ept-hierarchy")).unwrap();
        for (name, text) in pieces {
            std::fs::write(folder.path().join(format!("ept-hierarchy/{name}.json")), text).unwrap();
        }
        folder
    }

    fn read(pieces: &[(&str, &str)]) -> Result<(String, Vec<String>), String> {
        let folder = folder(pieces);
        let tree =
            EptTree::read(folder.path(), 1.0, &Progress::hidden()).map_err(|error| error.to_string())?;
        let names = tree.nodes.iter().map(|node| format!("{}:{}", node.key, node.announced));
        Ok((names.collect::<Vec<_>>().join(" "), tree.losses))
    }

    #[test]
    fn pieces_lead_to_each_other_breadth_first() {
        let (nodes, losses) = read(&[
            ("0-0-0-0", r#"{"1-0-0-1": -1, "0-0-0-0": 5, "1-0-0-0": 3}"#),
            ("1-0-0-1", r#"{"2-0-0-3": 1, "1-0-0-1": 7, "2-0-0-2": -1}"#),
            // A piece that leads back to itself and to the root.
            ("2-0-0-2", r#"{"2-0-0-2": -1, "0-0-0-0": -1, "1-0-0-1": -1}"#),
        ])
        .unwrap();
        assert_eq!(nodes, "0-0-0-0:5 1-0-0-0:3 1-0-0-1:7 2-0-0-2:0 2-0-0-3:1");
        assert_eq!(losses, [""; 0]);
    }

    #[test]
    fn what_is_lost_is_said() {
        let (nodes, losses) = read(&[(
            "0-0-0-0",
            r#"{"0-0-0-0": 5e0, "1-0-0-0": -1, "x": 3, "1-9-0-0": 3, "1-1-0-0": [{}], "1-1-1-0": "7", "1-0-0-1": -7}"#,
        )])
        .unwrap();
        assert_eq!(nodes, "0-0-0-0:5 1-0-0-0:0");
        assert!(losses[0].starts_with("has 1 piece of its hierarchy that is lost"), "{losses:?}");
        assert!(losses[0].contains("1-0-0-0"), "{losses:?}");
        assert_eq!(losses[1], "has 5 entries in its hierarchy that name no nodes");
        // A piece that is cut off, and one that is nested without end.
        let (nodes, losses) = read(&[("0-0-0-0", r#"{"0-0-0-0": 5, "1-0-0-0": "#)]).unwrap();
        assert_eq!((nodes.as_str(), losses.len()), ("0-0-0-0:5", 1));
        let nested = format!(r#"{{"0-0-0-0": 5, "1-0-0-0": {}"#, "[".repeat(1_000_000));
        assert_eq!(read(&[("0-0-0-0", &nested)]).unwrap().1.len(), 1);
        let error = read(&[("0-0-0-0", "[]")]).unwrap_err();
        assert!(error.contains("0-0-0-0.json: line 1: is not the JSON of a hierarchy"), "{error}");
        assert!(read(&[]).unwrap_err().contains("0-0-0-0.json"));
    }
}
