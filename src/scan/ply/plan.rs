//! What is done with the rows of an element: which values are a point's, a face's, nobody's.

use super::header::{Element, Shape};
use super::rows::{NUM_SLOTS, Rows, SLOT_INTENSITY, SLOT_NORMAL, SLOT_PLACE, SLOT_RGB};
use super::value::{Type, Values};

/// Names of the values of a point, lower case, by slot; the first that there is counts.
const NAMES: [&[&str]; NUM_SLOTS] = [
    &["x"],
    &["y"],
    &["z"],
    &["red", "r", "diffuse_red"],
    &["green", "g", "diffuse_green"],
    &["blue", "b", "diffuse_blue"],
    &["intensity", "scalar_intensity", "i"],
    &["nx"],
    &["ny"],
    &["nz"],
];
/// Names of the list of a face's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// What the rows of an element are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    Points(Kept),
    /// Polygons, a list of corners each.
    Faces,
    /// Strips of triangles, which −1 parts.
    Strips,
    Unused,
}

/// What a point has beside its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kept {
    pub color: Color,
    pub intensity: Intensity,
    pub normal: bool,
}

/// How colours are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Color {
    Absent,
    /// Integers; the largest that each of red, green, blue can be.
    Integers([u16; 3]),
    Floats,
}

/// How intensities are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Intensity {
    Absent,
    Integers,
    Floats,
}

/// One property of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Keep(Type, usize),
    Skip(Type),
    Corners(Type, Type),
    SkipList(Type, Type),
}

/// How to read an element.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// Rows announced.
    pub count: u64,
    pub purpose: Purpose,
    /// Names of a point's properties that nothing is done with.
    pub extra: Vec<String>,
    steps: Vec<Step>,
}

impl Plan {
    /// For the element that holds the points.
    ///
    /// # Errors
    /// The names of the coordinates that are missing.
    pub fn of_points(element: &Element) -> Result<Self, String> {
        let slots: [Option<(usize, Type)>; NUM_SLOTS] = NAMES.map(|names| find(element, names));
        let missing: Vec<&str> =
            SLOT_PLACE.filter(|&slot| slots[slot].is_none()).map(|slot| NAMES[slot][0]).collect();
        if !missing.is_empty() {
            return Err(missing.join(" and no "));
        }
        let kinds = |range: std::ops::Range<usize>| -> Option<Vec<Type>> {
            slots[range].iter().map(|slot| slot.map(|(_, kind)| kind)).collect()
        };
        let largest = |kind: Type| if kind.num_bytes() == 1 { u16::from(u8::MAX) } else { u16::MAX };
        let color = match kinds(SLOT_RGB).as_deref() {
            Some(kinds) if kinds.iter().any(|kind| kind.is_float()) => Color::Floats,
            Some(&[red, green, blue]) => Color::Integers([red, green, blue].map(largest)),
            _ => Color::Absent,
        };
        let intensity = match slots[SLOT_INTENSITY] {
            None => Intensity::Absent,
            Some((_, kind)) if kind.is_float() => Intensity::Floats,
            Some(_) => Intensity::Integers,
        };
        let kept = Kept { color, intensity, normal: kinds(SLOT_NORMAL).is_some() };
        let used = |slot: usize| match slot {
            _ if SLOT_RGB.contains(&slot) => kept.color != Color::Absent,
            _ if SLOT_NORMAL.contains(&slot) => kept.normal,
            _ => true,
        };
        let slot_of =
            |at| (0..NUM_SLOTS).find(|&slot| used(slot) && slots[slot].is_some_and(|(index, _)| index == at));
        let mut plan = Self::unused(element);
        plan.purpose = Purpose::Points(kept);
        for (at, step) in plan.steps.iter_mut().enumerate() {
            match (*step, slot_of(at)) {
                (Step::Skip(kind), Some(slot)) => *step = Step::Keep(kind, slot),
                _ => plan.extra.push(element.properties[at].name.clone()),
            }
        }
        Ok(plan)
    }

    /// For any other element.
    pub fn of_others(element: &Element) -> Self {
        let mut plan = Self::unused(element);
        let purpose = match element.name.as_str() {
            "face" => Purpose::Faces,
            "tristrips" => Purpose::Strips,
            _ => return plan,
        };
        let corners =
            element.properties.iter().position(|property| CORNERS.contains(&property.name.as_str()));
        if let Some(at) = corners
            && let Step::SkipList(count, item) = plan.steps[at]
        {
            plan.steps[at] = Step::Corners(count, item);
            plan.purpose = purpose;
        }
        plan
    }

    fn unused(element: &Element) -> Self {
        let step = |shape| match shape {
            Shape::Value(kind) => Step::Skip(kind),
            Shape::List(count, item) => Step::SkipList(count, item),
        };
        let steps = element.properties.iter().map(|property| step(property.shape)).collect();
        Self { count: element.count, purpose: Purpose::Unused, extra: Vec::new(), steps }
    }

    /// Properties of a row.
    pub fn num_properties(&self) -> u64 {
        self.steps.len() as u64
    }

    /// Size of a row in binary files: least, and whether all are of that size.
    pub fn row_bytes(&self) -> (u64, bool) {
        let sizes = self.steps.iter().map(|step| match step {
            Step::Keep(kind, _) | Step::Skip(kind) => (kind.num_bytes(), true),
            Step::Corners(count, _) | Step::SkipList(count, _) => (count.num_bytes(), false),
        });
        sizes.fold((0, true), |(sum, all_fixed), (size, fixed)| (sum + size, all_fixed && fixed))
    }

    /// Reads one row. `None` if it is not whole; nothing of it is kept then.
    pub fn read_row(&self, values: &mut impl Values, rows: &mut Rows) -> Option<()> {
        let mut kept = [f64::NAN; NUM_SLOTS];
        rows.corners.clear();
        for step in &self.steps {
            match *step {
                Step::Keep(kind, slot) => kept[slot] = values.value(kind)?,
                Step::Skip(kind) => values.skip(kind, 1)?,
                // `as` saturates: a count below zero is none.
                Step::SkipList(count, item) => {
                    let count = values.value(count)? as u64;
                    values.skip(item, count)?;
                }
                Step::Corners(count, item) => {
                    for _ in 0..values.value(count)? as u64 {
                        rows.corners.push(values.value(item)?);
                    }
                }
            }
        }
        match self.purpose {
            Purpose::Points(has) => rows.push_point(has, &kept),
            Purpose::Faces => rows.push_face(),
            Purpose::Strips => rows.push_strips(),
            Purpose::Unused => {}
        }
        Some(())
    }
}

/// Index and type of the property with the first of `names` that there is.
fn find(element: &Element, names: &[&str]) -> Option<(usize, Type)> {
    names.iter().find_map(|name| {
        element.properties.iter().enumerate().find_map(|(at, property)| match property.shape {
            Shape::Value(kind) if property.name.eq_ignore_ascii_case(name) => Some((at, kind)),
            _ => None,
        })
    })
}
