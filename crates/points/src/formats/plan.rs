//! What the columns of a file are that names its columns: place, color, intensity, normal, and the file's own.

use super::measured::JudgedValues;
use super::names::{self, NORMAL, NORMAL_XYZ, RGB};
use crate::column::Type;
use crate::{Attribute, Field, Projection, Schema};

/// Name of a column that is passed over.
pub(super) const SKIPPED: &str = "-";
/// Names of a color in one value of 32 bits.
const PACKED_RGB: [&str; 2] = ["rgb", "rgba"];

/// A column of a file, of one number a point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StoredColumn {
    /// Its name in the file; [`SKIPPED`] if nobody reads it.
    pub name: String,
    /// Type of a column that holds its values.
    pub kind: Type,
    /// True if its values are whole numbers.
    pub is_whole: bool,
}

/// How points have colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlannedColor {
    Absent,
    /// Red, green and blue as whole numbers in these columns.
    Whole([usize; 3]),
    /// Red, green and blue as floats in these columns.
    Floats([usize; 3]),
    /// 0xAARRGGBB in the bits of a number in this column.
    Packed(usize),
}

/// What becomes of each column.
#[derive(Clone, Debug)]
pub(super) struct RowPlan {
    /// Columns of x, y and z.
    pub place: [usize; 3],
    pub color: PlannedColor,
    /// Column of the intensity.
    pub intensity: Option<usize>,
    /// Columns of a normal's x, y and z.
    pub normal: Option<[usize; 3]>,
    /// Other columns, and how they are handed over.
    pub others: Vec<(usize, Field)>,
    /// All columns.
    pub columns: Vec<StoredColumn>,
}

impl RowPlan {
    /// The plan for columns of these names; `None` if they name no place.
    pub fn of(columns: Vec<StoredColumn>) -> Option<Self> {
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        let place = names::place(&names)?;
        let three = RGB.iter().find_map(|rgb| names::find_three(&names, rgb));
        let packed = || PACKED_RGB.iter().find_map(|name| names::find(&names, name));
        let color = match three {
            Some(at) if at.iter().all(|&at| columns[at].is_whole) => PlannedColor::Whole(at),
            Some(at) => PlannedColor::Floats(at),
            None => packed().map_or(PlannedColor::Absent, PlannedColor::Packed),
        };
        let normal = [NORMAL].iter().chain(&NORMAL_XYZ).find_map(|xyz| names::find_three(&names, xyz));
        let intensity = names::intensity(&names).filter(|at| !place.contains(at));
        let mut plan = Self { place, color, intensity, normal, others: Vec::new(), columns };
        for at in 0..plan.columns.len() {
            plan.add_other(at);
        }
        Some(plan)
    }

    /// Plans a column that is offered by its own name.
    fn add_other(&mut self, at: usize) {
        let StoredColumn { name, kind, .. } = &self.columns[at];
        let is_of_color = match self.color {
            PlannedColor::Absent => false,
            PlannedColor::Whole(three) | PlannedColor::Floats(three) => three.contains(&at),
            PlannedColor::Packed(packed) => packed == at,
        };
        let is_known = self.place.contains(&at)
            || is_of_color
            || self.normal.is_some_and(|normal| normal.contains(&at))
            || self.intensity == Some(at) && self.keeps_intensity();
        if is_known || name == SKIPPED {
            return;
        }
        let (mut attribute, mut column_kind) = names::attribute(name, *kind);
        let is_taken = |attribute: &Attribute, others: &[(usize, Field)]| {
            others.iter().any(|(_, field)| field.attribute == *attribute)
        };
        if is_taken(&attribute, &self.others) || self.intensity == Some(at) {
            (attribute, column_kind) = (Attribute::Named(name.clone()), *kind);
        }
        if is_taken(&attribute, &self.others) {
            attribute = Attribute::Named(format!("{name} ({})", at + 1));
        }
        // Its values are known as intensities already.
        let is_detail = self.intensity == Some(at);
        self.others.push((at, Field { is_detail, ..Field::plain(attribute, column_kind) }));
    }

    /// The same plan for a file that has these columns, among which `moved` finds each.
    pub fn moved(&self, columns: Vec<StoredColumn>, moved: impl Fn(usize) -> usize) -> Self {
        let color = match self.color {
            PlannedColor::Absent => PlannedColor::Absent,
            PlannedColor::Whole(at) => PlannedColor::Whole(at.map(&moved)),
            PlannedColor::Floats(at) => PlannedColor::Floats(at.map(&moved)),
            PlannedColor::Packed(at) => PlannedColor::Packed(moved(at)),
        };
        Self {
            place: self.place.map(&moved),
            color,
            intensity: self.intensity.map(&moved),
            normal: self.normal.map(|normal| normal.map(&moved)),
            others: self.others.iter().map(|(at, field)| (moved(*at), field.clone())).collect(),
            columns,
        }
    }

    /// True if intensities are stored as [`Attribute::Intensity`] has them.
    pub fn keeps_intensity(&self) -> bool {
        self.intensity.is_some_and(|at| matches!(self.columns[at].kind, Type::U8 | Type::U16))
    }

    /// The attributes that points have.
    pub fn schema(&self, unread: Vec<String>) -> Schema {
        let standard = [
            (self.color != PlannedColor::Absent, Attribute::Color, Type::U16x3),
            (self.intensity.is_some(), Attribute::Intensity, Type::U16),
            (self.normal.is_some(), Attribute::Normal, Type::F32x3),
        ];
        let standard = standard.into_iter().filter(|(is_there, ..)| *is_there);
        let standard = standard.map(|(_, attribute, kind)| Field::plain(attribute, kind));
        let fields = standard.chain(self.others.iter().map(|(_, field)| field.clone())).collect();
        Schema { fields, unread }
    }

    /// The plan for what is wanted.
    pub fn projected(&self, want: &Projection) -> Self {
        let mut plan = self.clone();
        if !want.wants(&Attribute::Color) {
            plan.color = PlannedColor::Absent;
        }
        plan.intensity = self.intensity.filter(|_| want.wants(&Attribute::Intensity));
        plan.normal = self.normal.filter(|_| want.wants(&Attribute::Normal));
        plan.others.retain(|(_, field)| want.wants(&field.attribute));
        plan
    }

    /// What only all values together tell.
    pub fn judged(&self) -> JudgedValues {
        JudgedValues {
            colors: matches!(self.color, PlannedColor::Floats(_)),
            intensities: self.intensity.is_some() && !self.keeps_intensity(),
            whole_intensities: self.intensity.is_some_and(|at| self.columns[at].is_whole),
        }
    }

    /// The largest that a color can be, if its type says so.
    pub fn white(&self) -> Option<u16> {
        match self.color {
            PlannedColor::Packed(_) => Some(255),
            PlannedColor::Whole(at) if at.iter().all(|&at| self.columns[at].kind == Type::U8) => Some(255),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(names: &str) -> Vec<StoredColumn> {
        let column = |name: &str| StoredColumn { name: name.into(), kind: Type::F64, is_whole: false };
        names.split_whitespace().map(column).collect()
    }

    #[test]
    fn columns_are_what_their_names_say() {
        let plan =
            RowPlan::of(columns("Z Y X Red Green Blue Intensity Normal_X normal_y normal_z time")).unwrap();
        assert_eq!((plan.place, plan.color), ([2, 1, 0], PlannedColor::Floats([3, 4, 5])));
        assert_eq!((plan.intensity, plan.normal), (Some(6), Some([7, 8, 9])));
        let others: Vec<String> =
            plan.others.iter().map(|(_, field)| field.attribute.name().into()).collect();
        assert_eq!(others, ["extra:Intensity", "extra:time"]);
        assert_eq!(plan.schema(vec![]).names(), ["rgb", "intensity", "normals", "extra:time"]);
        let plan = plan.projected(&Projection::of([Attribute::Named("time".into())]));
        assert_eq!((plan.color, plan.intensity, plan.normal), (PlannedColor::Absent, None, None));
        assert_eq!(plan.others.len(), 1);
    }

    #[test]
    fn a_place_needs_three_names_and_others_may_be_named_twice() {
        assert!(RowPlan::of(columns("X Y X")).is_none());
        assert!(RowPlan::of(columns("lat lon height")).is_some_and(|plan| plan.place == [1, 0, 2]));
        let plan = RowPlan::of(columns("x y z a a - rgb")).unwrap();
        let named = |name: &str| Attribute::Named(name.into());
        let others: Vec<Attribute> = plan.others.iter().map(|(_, field)| field.attribute.clone()).collect();
        assert_eq!(others, [named("a"), named("a (5)")]);
        assert_eq!((plan.color, plan.white()), (PlannedColor::Packed(6), Some(255)));
    }
}
