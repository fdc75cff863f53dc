//! Tells whether a scan's surfaces can only be a floor and walls, or ground and things on it, if y or −y points up.
//!
//! Most shapes are no proof. A wall that faces north in a file with z up is, point by point, ground in a file with y
//! up; a box is a room either way; a statue may lie. Three shapes are proof, because the other reading has no floor at
//! all:
//!
//! - level surfaces across the axis, and walls all around it of which none is level in the other reading, where as
//!   many surfaces hang over as face up: a room that stands askew to the axes;
//! - a floor and a ceiling that are much wider than the space between them is high: with z up, a gap between two walls,
//!   closed above and below, three times as high as wide;
//! - ground that reaches all over the scan, with things on it that are as high as a quarter of its width and have walls
//!   to all sides: with z up, a wall from which they stick out, and nothing below.

use super::{Evidence, UpAxis};
use crate::{ScanFile, scene};
use base::space::Bounds;
use glam::DVec3;
use std::collections::HashMap;

/// Most surface patches that are looked at.
const MOST: usize = 1 << 16;
/// Fewer surface patches than this prove nothing.
const LEAST: usize = 100;
/// Places on all triangles together that are looked at, beside one on each.
const PLACES: f64 = 4096.0;
/// Cells along the longest edge within which points share a weight: scanners see near surfaces more often.
const CELLS: f64 = 64.0;

/// cos 8°: a surface that deviates less faces along an axis.
const ALONG: f64 = 0.990_27;
/// sin 10°: a surface that deviates less faces across an axis.
const ACROSS: f64 = 0.173_65;
/// Part of the height at the bottom in which floors are, and at the top in which ceilings are.
const LOW: f64 = 0.2;

/// What a file says of its up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Vote {
    /// The file says nothing.
    Unsure,
    /// The file says that z is up.
    Against,
    /// The file says that another axis is up.
    For(Evidence),
}

/// A piece of a surface.
#[derive(Clone, Copy, Debug)]
struct Patch {
    at: DVec3,
    normal: DVec3,
    area: f64,
}

/// The vote of a file's triangles, or else of its normals.
pub(super) fn vote(file: &ScanFile) -> Vote {
    of_patches(if file.triangles.is_empty() { of_points(file) } else { of_triangles(file) })
}

fn of_patches(mut patches: Vec<Patch>) -> Vote {
    let Some(bounds) = scene::find(patches.iter().map(|patch| patch.at).collect()) else {
        return Vote::Unsure;
    };
    patches.retain(|patch| bounds.contains(patch.at));
    if patches.len() < LEAST {
        return Vote::Unsure;
    }
    let with = |up: UpAxis| {
        let turned = patches.iter().map(|patch| Patch {
            at: up.in_world(patch.at),
            normal: up.in_world(patch.normal),
            area: patch.area,
        });
        let bounds = Bounds::around(&[up.in_world(bounds.min), up.in_world(bounds.max)]);
        Surfaces::of(&turned.collect::<Vec<_>>(), &bounds, up.in_world(DVec3::Z))
    };
    let (y, minus_y) = (with(UpAxis::Y), with(UpAxis::MinusY));
    let found = |up: UpAxis, surfaces: &Surfaces| {
        let is_room =
            surfaces.is_room_askew() && (up == UpAxis::Y || surfaces.ceiling <= 0.1 * surfaces.floor);
        let why = if is_room || up == UpAxis::Y && surfaces.is_wide_room() {
            "it has a floor and walls only so"
        } else if surfaces.is_ground_with_things() {
            "it has ground and things on it only so"
        } else {
            return None;
        };
        Some(Evidence { up, why })
    };
    match (found(UpAxis::Y, &y), found(UpAxis::MinusY, &minus_y)) {
        (Some(evidence), None) | (None, Some(evidence)) => Vote::For(evidence),
        // More is level with z up than with y.
        _ if y.across_other > y.level => Vote::Against,
        _ => Vote::Unsure,
    }
}

/// What surfaces are like if an axis is up, which is z here. Areas are shares of the whole area.
#[derive(Clone, Copy, Debug, Default)]
struct Surfaces {
    size: DVec3,
    /// Area that faces up or down.
    level: f64,
    /// Area that faces up and lies low.
    floor: f64,
    /// Area that faces down and lies high.
    ceiling: f64,
    /// Area that faces along the axis that would be up instead, either way.
    across_other: f64,
    /// Area that would be floor instead.
    other_floor: f64,
    /// Area that faces along the third axis.
    across_third: f64,
    /// Area that stands upright.
    walls: f64,
    /// Areas of the walls that face each way along the other axis, and each way along the third.
    facing: [f64; 4],
    /// Area that is higher above the floor than a quarter of the scan's lesser width.
    high: f64,
    /// The part of the scan's width and depth that the floor reaches over.
    reach: f64,
}

impl Surfaces {
    fn of(patches: &[Patch], bounds: &Bounds, other: DVec3) -> Self {
        let size = bounds.size();
        let third = DVec3::Z.cross(other);
        let part = |at: DVec3| (at - bounds.min) / size.max(DVec3::splat(f64::MIN_POSITIVE));
        let high = 0.25 * size.x.min(size.y);
        let mut surfaces = Self { size, ..Self::default() };
        let mut floor = Bounds::EMPTY;
        let all: f64 = patches.iter().map(|patch| patch.area).sum();
        for Patch { at, normal, area } in patches {
            let (share, at_part) = (area / all, part(*at));
            let along = |axis: DVec3| normal.dot(axis);
            let other_part = if other.y < 0.0 { 1.0 - at_part.y } else { at_part.y };
            let mut add = |is: bool, sum: fn(&mut Self) -> &mut f64| {
                *sum(&mut surfaces) += if is { share } else { 0.0 };
            };
            let is_floor = normal.z > ALONG && at_part.z < LOW;
            add(normal.z.abs() > ALONG, |s| &mut s.level);
            add(is_floor, |s| &mut s.floor);
            add(normal.z < -ALONG && at_part.z > 1.0 - LOW, |s| &mut s.ceiling);
            add(along(other).abs() > ALONG, |s| &mut s.across_other);
            add(along(other) > ALONG && other_part < LOW, |s| &mut s.other_floor);
            add(along(third).abs() > ALONG, |s| &mut s.across_third);
            let is_wall = normal.z.abs() < ACROSS;
            add(is_wall, |s| &mut s.walls);
            add(is_wall && along(other) > 0.3, |s| &mut s.facing[0]);
            add(is_wall && along(other) < -0.3, |s| &mut s.facing[1]);
            add(is_wall && along(third) > 0.3, |s| &mut s.facing[2]);
            add(is_wall && along(third) < -0.3, |s| &mut s.facing[3]);
            add(at.z - bounds.min.z > high, |s| &mut s.high);
            if is_floor {
                floor = floor.with(*at);
            }
        }
        if !floor.is_empty() {
            surfaces.reach = (floor.size() / size).truncate().min_element();
        }
        surfaces
    }

    fn is_room_askew(&self) -> bool {
        let [front, back, ..] = self.facing;
        self.level >= 0.15
            && self.floor >= 0.08
            && self.across_other <= 0.15 * self.level
            && self.other_floor <= 0.1 * self.floor
            && self.walls >= 0.2
            && front.min(back) >= 0.2 * self.walls
    }

    fn is_wide_room(&self) -> bool {
        let [front, back, ..] = self.facing;
        self.floor >= 0.12
            && self.ceiling >= 0.5 * self.floor
            && self.size.z <= 0.33 * self.size.x.min(self.size.y)
            && self.level >= 3.0 * self.across_other.max(self.across_third)
            && self.walls >= 0.05
            && front.min(back) >= 0.5 * front.max(back)
    }

    fn is_ground_with_things(&self) -> bool {
        let others = 1.0 - self.floor;
        self.floor >= 0.15
            && self.ceiling <= 0.1 * self.floor
            && self.reach >= 0.8
            && self.high >= 0.03
            && self.other_floor <= 0.05 * self.floor
            && self.across_other <= 0.5 * self.level
            && self.walls >= 0.25 * others
            && self.facing.iter().all(|&facing| facing >= 0.15 * self.walls)
    }
}

fn of_triangles(file: &ScanFile) -> Vec<Patch> {
    let step = file.triangles.len().div_ceil(MOST).max(1);
    let corner = |number: u32| Some(file.grid.p_in_world(*file.points.xyz.get(number as usize)?));
    let triangle = |&[a, b, c]: &[u32; 3]| {
        let corners = [corner(a)?, corner(b)?, corner(c)?];
        let twice = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        (twice.length() > 0.0).then_some((corners, twice))
    };
    let triangles: Vec<([DVec3; 3], DVec3)> =
        file.triangles.iter().step_by(step).filter_map(triangle).collect();
    let all: f64 = triangles.iter().map(|(_, twice)| 0.5 * twice.length()).sum();
    let patches = |([a, b, c], twice): ([DVec3; 3], DVec3)| {
        let area = 0.5 * twice.length();
        // A floor may be two triangles, so a larger triangle has more places that count.
        let num = 1 + (area / all * PLACES) as usize;
        let at = move |i: usize| {
            // Places lie evenly over the unit square, folded into its lower half.
            let u = (i as f64 + 0.5) / num as f64;
            let v = (0.5 + i as f64 * 0.618_033_988_749_895).fract();
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            a + (b - a) * u + (c - a) * v
        };
        (0..num).map(move |i| Patch { at: at(i), normal: twice.normalize(), area: area / num as f64 })
    };
    triangles.into_iter().flat_map(patches).collect()
}

/// Patches of points with normals; the points of a cell share the weight of one.
fn of_points(file: &ScanFile) -> Vec<Patch> {
    let normals = &file.points.normals;
    let step = normals.len().div_ceil(MOST).max(1);
    let numbers = (0..normals.len()).step_by(step);
    let patch = |number: usize| {
        let normal = DVec3::from_array(normals[number].map(f64::from));
        let at = file.grid.p_in_world(file.points.xyz[number]);
        (normal.length() > 0.5).then(|| Patch { at, normal: normal.normalize(), area: 1.0 })
    };
    let mut patches: Vec<Patch> = numbers.filter_map(patch).collect();
    let Some(scene) = scene::find(patches.iter().map(|patch| patch.at).collect()) else { return Vec::new() };
    let edge = (scene.edge() / CELLS).max(f64::MIN_POSITIVE);
    let cell = |patch: &Patch| ((patch.at - scene.min) / edge).floor().to_array().map(|c| c as i64);
    let mut counts: HashMap<[i64; 3], u32> = HashMap::new();
    patches.iter().for_each(|patch| *counts.entry(cell(patch)).or_default() += 1);
    patches.iter_mut().for_each(|patch| patch.area = 1.0 / f64::from(counts[&cell(patch)]));
    patches
}

#[cfg(test)]
#[path = "surface_tests.rs"]
mod tests;
