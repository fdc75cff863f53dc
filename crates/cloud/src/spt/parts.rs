//! Cuts the list into parts, the batches: discs that a tolerance draws together and that lie near each other. Then
//! splits those discs off a part that are not needed together.
//!
//! Splitting a part never costs a read: each piece has a box and an interval within the whole part's, so wherever it is
//! read, the whole would have been. It costs workgroups, so no piece is split off that is too small for one.
//!
//! - Discs that are drawn at any nearness, as points are, are split from others: else the others are read close up,
//!   where there are as many of them as of points and none is drawn.
//! - Discs whose normals are of one cluster are split off: they face away together [SPT §3.10]. A few parts hold the
//!   discs that are drawn far away, with normals of all clusters, and stay whole.

use super::sequence::{DiscShape, ListPart, NO_CLUSTER, octave};
use rayon::prelude::*;
use std::ops::Range;

/// A part ends with its octave, unless it is smaller than this or an eighth of the list: within an octave, discs that
/// follow each other are neighbors.
const MIN_DISCS: usize = 2048;
/// Discs of a part at least, however short the list: a few a thread.
const MIN_DISCS_OF_FEW: usize = 256;
/// Discs of a part at most. The GPU allows more; fewer have smaller boxes, and only a whole batch can be culled.
pub(super) const MAX_DISCS: usize = 4096;
/// Discs that are split off at least: one a thread.
pub(super) const MIN_APART: usize = 128;

/// A node's number, and its disc's interval and size.
pub(super) type DiscEntry = (u32, DiscShape);

/// Entries, and the cluster and the size of each group of them.
type Grouped = (Vec<DiscEntry>, Vec<(u8, usize)>);

/// Cuts a list that is sorted by falling octaves of `max`, and puts the entries of each part next to each other.
pub(super) fn parts(
    entries: Vec<DiscEntry>,
    cluster: &(impl Fn(u32) -> u8 + Sync),
) -> (Vec<DiscEntry>, Vec<ListPart>) {
    let apart = |range: &Range<usize>| asunder(entries[range.clone()].to_vec(), cluster);
    let pieces: Vec<Grouped> = cut(&entries).par_iter().map(apart).collect();
    drop(entries);
    let mut ordered = Vec::with_capacity(pieces.iter().map(|(entries, _)| entries.len()).sum());
    let mut parts = Vec::new();
    for (entries, sizes) in pieces {
        for (cluster, size) in sizes {
            let end = parts.last().map_or(0, |(_, part): &(_, ListPart)| part.entries.end);
            let part =
                ListPart { cluster: (cluster != NO_CLUSTER).then_some(cluster), entries: end..end + size };
            parts.push((cluster, part));
        }
        ordered.extend(entries);
    }
    let largest = |part: &ListPart| ordered[part.entries.clone()].iter().map(|(_, shape)| shape.max).max();
    parts.sort_by_cached_key(|(cluster, part)| (*cluster, u8::MAX - largest(part).map_or(0, octave)));
    (ordered, parts.into_iter().map(|(_, part)| part).collect())
}

/// Ranges of entries that become parts.
fn cut(entries: &[DiscEntry]) -> Vec<Range<usize>> {
    let mut parts = Vec::new();
    let mut start = 0;
    let min_discs = (entries.len() / 8).clamp(MIN_DISCS_OF_FEW, MIN_DISCS);
    for (entry, (_, shape)) in entries.iter().enumerate() {
        let (num_discs, next) = (entry + 1 - start, entries.get(entry + 1));
        let falls = next.is_none_or(|(_, next)| octave(next.max) < octave(shape.max));
        if num_discs == MAX_DISCS || falls && num_discs >= min_discs || next.is_none() {
            parts.push(start..entry + 1);
            start = entry + 1;
        }
    }
    parts
}

/// Orders the entries of a part so that those that belong together are next to each other; returns the groups' clusters
/// and sizes too.
fn asunder(entries: Vec<DiscEntry>, cluster: &impl Fn(u32) -> u8) -> Grouped {
    let is_for_afar = |(_, shape): &DiscEntry| shape.min > 0;
    let num_for_afar = entries.iter().filter(|entry| is_for_afar(entry)).count();
    let sets_apart = num_for_afar >= MIN_APART;
    let mut grouped: Vec<(bool, u8, DiscEntry)> = entries
        .into_iter()
        .map(|entry| (sets_apart && is_for_afar(&entry), cluster(entry.0), entry))
        .collect();
    let mut counts = [[0; NO_CLUSTER as usize + 1]; 2];
    grouped.iter().for_each(|(afar, cluster, _)| counts[usize::from(*afar)][usize::from(*cluster)] += 1);
    for (afar, cluster, _) in &mut grouped {
        if counts[usize::from(*afar)][usize::from(*cluster)] < MIN_APART {
            *cluster = NO_CLUSTER;
        }
    }
    // The sort is stable: entries of a group stay in Morton order.
    grouped.sort_by_key(|(afar, cluster, _)| (*afar, *cluster));
    let groups = grouped.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1));
    let sizes = groups.map(|group| (group[0].1, group.len())).collect();
    (grouped.into_iter().map(|(.., entry)| entry).collect(), sizes)
}
