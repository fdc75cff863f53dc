//! Puts the points of a node that has a grid of its own on the scan's grid.

use crate::block::Block;
use crate::column::Column;
use crate::stats::Stats;
use crate::{Attribute, Grid, Marks};

/// Puts the points of a block on a grid. Returns how many the grid does not reach, which are left out, and the most that
/// a point moved, in steps; `None` if no point had to be moved.
pub(super) fn onto(block: &mut Block, grid: Grid) -> (u64, Option<f64>) {
    let (from, to) = (block.grid, grid);
    block.grid = grid;
    // Whole steps between the origins of two grids of the same steps move nothing.
    let shift = (from.offset - to.offset) / to.scale;
    let whole = shift.round();
    // Offsets in files have some fifteen digits.
    let is_whole = (shift - whole).abs().max_element() < 1e-6 && whole.abs().max_element() < 1e15;
    let is_shifted = from.scale == to.scale && is_whole;
    let (mut gone, mut moved) = (Marks::default(), 0f64);
    for (number, xyz) in block.xyz.iter_mut().enumerate() {
        let mut steps = [0i64; 3];
        if is_shifted {
            steps = std::array::from_fn(|axis| i64::from(xyz[axis]) + whole[axis] as i64);
        } else {
            let exact = (from.p_in_world(*xyz) - to.offset) / to.scale;
            let nearest = exact.round();
            moved = moved.max((exact - nearest).abs().max_element());
            steps.iter_mut().zip(nearest.to_array()).for_each(|(step, value)| *step = value as i64);
        }
        let fits = steps.map(i32::try_from);
        match fits {
            [Ok(x), Ok(y), Ok(z)] => *xyz = [x, y, z],
            _ => gone.set(number),
        }
    }
    let num_gone = gone.count() as u64;
    if num_gone > 0 {
        block.leave_out(&gone);
    }
    let intensity = match block.column(&Attribute::Intensity) {
        Some(Column::U16(intensity)) => &intensity[..],
        _ => &[],
    };
    block.stats = Stats::of(&block.xyz, intensity);
    (num_gone, (!is_shifted).then_some(moved))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Type;
    use glam::DVec3;

    fn block(grid: Grid, xyz: Vec<[i32; 3]>) -> Block {
        let mut block = Block::new(grid, [(Attribute::Intensity, Type::U16)]);
        block.columns[0].1 = Column::U16((0..xyz.len()).map(|number| number as u16).collect());
        block.xyz = xyz;
        block
    }

    #[test]
    fn whole_steps_move_nothing_and_far_points_are_left_out() {
        let grid =
            |scale: f64, offset: f64| Grid { scale: DVec3::splat(scale), offset: DVec3::splat(offset) };
        let mut shifted = block(grid(0.001, 500_000.0), vec![[1, 2, 3], [i32::MAX, 0, 0], [-5; 3]]);
        assert_eq!(onto(&mut shifted, grid(0.001, 499_000.0)), (1, None));
        assert_eq!(shifted.xyz, [[1_000_001, 1_000_002, 1_000_003], [999_995; 3]]);
        assert_eq!(shifted.column(&Attribute::Intensity), Some(&Column::U16(vec![0, 2])));
        assert_eq!((shifted.stats.xyz_min[0], shifted.stats.intensity_max), (999_995, 2));
        let mut coarser = block(grid(0.01, 0.0), vec![[1, -1, 14]]);
        let (num_gone, moved) = onto(&mut coarser, grid(0.1, 0.0));
        assert_eq!((num_gone, &coarser.xyz[..]), (0, &[[0, 0, 1]][..]));
        assert!((moved.unwrap() - 0.4).abs() < 1e-9);
    }
}
