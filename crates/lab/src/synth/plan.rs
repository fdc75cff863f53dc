//! Shares out points to scan lines before any point is made, so that a file gets exactly the number asked for, although
//! some rays meet nothing and some meet three things.

/// Points of the lines of a scan: `num_passes` passes (stations, strips, tiles) of `lines_per_pass` lines.
///
/// Every pass is cut into equally many bins along its lines, and a bin has a weight: how many points a fixed
/// number of trial rays gave there. Points are shared out by weight, in integers, without loss.
#[derive(Clone, Debug)]
pub struct LinePlan {
    points: u64,
    num_passes: u64,
    lines_per_pass: u64,
    bins_per_pass: u64,
    weights: Vec<u32>,
    /// Sum of the weights before each bin, and of all.
    before: Vec<u64>,
}

impl LinePlan {
    /// Makes a plan. `weights` go pass after pass, with as many bins in each, and are not all 0.
    pub fn new(points: u64, num_passes: u64, lines_per_pass: u64, weights: Vec<u32>) -> Self {
        let mut before = vec![0];
        let mut sum = 0;
        for &weight in &weights {
            sum += u64::from(weight);
            before.push(sum);
        }
        assert!(sum > 0, "a scene in which no trial ray hits anything");
        let bins_per_pass = weights.len() as u64 / num_passes;
        Self { points, num_passes, lines_per_pass: lines_per_pass.max(1), bins_per_pass, weights, before }
    }

    /// Points of all lines.
    pub fn points(&self) -> u64 {
        self.points
    }

    /// Lines of all passes.
    pub fn num_lines(&self) -> u64 {
        self.num_passes * self.lines_per_pass
    }

    /// Lines of one pass.
    pub fn lines_per_pass(&self) -> u64 {
        self.lines_per_pass
    }

    /// Pass of a line, and the line's number in it.
    pub fn pass_and_line(&self, line: u64) -> (u64, u64) {
        (line / self.lines_per_pass, line % self.lines_per_pass)
    }

    /// Weight of the bin in which the middle of a line lies.
    pub fn weight(&self, line: u64) -> u32 {
        let (pass, line) = self.pass_and_line(line);
        let bin = (2 * line + 1) * self.bins_per_pass / (2 * self.lines_per_pass);
        self.weights[(pass * self.bins_per_pass + bin) as usize]
    }

    /// Points before a line; of line `i` there are `first_point(i + 1) − first_point(i)`.
    pub fn first_point(&self, line: u64) -> u64 {
        let (pass, line) = self.pass_and_line(line);
        // Begin of the line in bins: a whole part, and a rest in units of 1 / lines_per_pass.
        let whole = pass * self.bins_per_pass + line * self.bins_per_pass / self.lines_per_pass;
        let rest = line * self.bins_per_pass % self.lines_per_pass;
        let partial = self.weights.get(whole as usize).map_or(0, |w| u128::from(*w) * u128::from(rest));
        let lines = u128::from(self.lines_per_pass);
        let weight = u128::from(self.before[whole as usize]) * lines + partial;
        let total = u128::from(*self.before.last().unwrap_or(&1)) * lines;
        ((2 * weight * u128::from(self.points) + total) / (2 * total)) as u64
    }
}

/// Keeps `keep` of `of` things, evenly spread over their order.
#[derive(Clone, Debug)]
pub struct Thin {
    keep: u64,
    of: u64,
    seen: u64,
    kept: u64,
}

impl Thin {
    /// Keeps `keep` of `of` things, where `keep ≤ of`.
    pub fn new(keep: u64, of: u64) -> Self {
        Self { keep, of: of.max(1), seen: 0, kept: 0 }
    }

    /// Number of the next `num` things that stay.
    pub fn next(&mut self, num: u64) -> u64 {
        self.seen += num;
        let due = (u128::from(self.seen) * u128::from(self.keep) / u128::from(self.of)) as u64;
        let stay = num.min(due - self.kept);
        self.kept += stay;
        stay
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn lines_hold_exactly_all_points(
            points in 1_u64..1_000_000,
            lines in 1_u64..700,
            weights in prop::collection::vec(1_u32..90, 2 * 36),
        ) {
            let plan = LinePlan::new(points, 2, lines, weights);
            prop_assert_eq!(plan.first_point(0), 0);
            prop_assert_eq!(plan.first_point(plan.num_lines()), points);
            for line in 0..plan.num_lines() {
                prop_assert!(plan.first_point(line) <= plan.first_point(line + 1));
            }
        }

        #[test]
        fn thin_keeps_exactly(keep in 0_u64..500, more in 0_u64..500) {
            let mut thin = Thin::new(keep, keep + more);
            prop_assert_eq!((0..keep + more).map(|_| thin.next(1)).sum::<u64>(), keep);
        }
    }

    #[test]
    fn heavier_bins_get_more() {
        let plan = LinePlan::new(400, 1, 4, vec![1, 3]);
        let points: Vec<u64> = (0..4).map(|i| plan.first_point(i + 1) - plan.first_point(i)).collect();
        assert_eq!(points, [50, 50, 150, 150]);
        assert_eq!(plan.weight(3), 3);
    }

    #[test]
    fn thin_keeps_runs_whole_where_it_can() {
        let mut thin = Thin::new(9, 10);
        let stay: Vec<u64> = [3, 1, 3, 3].map(|n| thin.next(n)).to_vec();
        assert_eq!(stay.iter().sum::<u64>(), 9);
    }
}
