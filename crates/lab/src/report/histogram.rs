//! Histogram of the frames' GPU times; two logs share a plot if they are compared.

use super::axis::Axis;
use super::markup::Markup;
use super::page;
use super::svg::{Plot, RIGHT};
use base::percentile::Sorted;
use base::words::counted;

const NUM_BINS: usize = 60;
const SIDES: [f64; 2] = [52.0, RIGHT];
const HEIGHT: f64 = 200.0;
/// Least height of a bin with a frame, in units: one missed display a minute is to be seen.
const MIN_UNITS: f64 = 1.0;

/// Share and number of the values in each of [`NUM_BINS`] bins from 0 to `top`. The last bin also has all values
/// beyond.
fn shares(sorted: &Sorted, top: f64) -> Vec<(f64, usize)> {
    let values = sorted.values();
    let below = |bin: usize| match bin {
        0 => 0,
        NUM_BINS => values.len(),
        _ => values.partition_point(|value| *value < top * bin as f64 / NUM_BINS as f64),
    };
    let num = |bin| below(bin + 1) - below(bin);
    (0..NUM_BINS).map(|bin| (num(bin) as f64 / values.len().max(1) as f64, num(bin))).collect()
}

/// Plots the GPU times of one or two logs: class, name and times of each. The last bin begins below `top_ms` and has no
/// end.
pub(super) fn histogram(logs: &[(&str, &str, &Sorted)], top_ms: f64, budgets_ms: &[f64]) -> Markup {
    let all: Vec<_> =
        logs.iter().map(|(class, name, sorted)| (class, name, shares(sorted, top_ms))).collect();
    let highest = all.iter().flat_map(|(_, _, shares)| shares).map(|(share, _)| *share).fold(0.0, f64::max);
    let mut plot = Plot::new(
        "How many frames took the GPU how long",
        [Axis::linear(0.0, top_ms), Axis::linear(0.0, 105.0 * highest)],
        SIDES,
        HEIGHT,
    );
    plot.mark_x("GPU milliseconds a frame");
    plot.mark_y(5, "%");
    for (class, name, shares) in &all {
        for (bin, (share, num)) in shares.iter().enumerate().filter(|(_, (_, num))| *num > 0) {
            let [from, to] = [bin, bin + 1].map(|edge| top_ms * edge as f64 / NUM_BINS as f64);
            let end = if bin + 1 == NUM_BINS { "and more".into() } else { format!("to {to:.2}") };
            let words =
                format!("{name}: {from:.2} {end} ms: {}, {:.3} %", counted(num, "frame"), 100.0 * share);
            let corner = plot.at(to, 100.0 * share);
            let lowest = plot.above_bottom(corner, MIN_UNITS);
            plot.bar(class, [plot.at(from, 0.0), [corner[0], corner[1].min(lowest[1])]], &words);
        }
    }
    for budget_ms in budgets_ms.iter().filter(|budget_ms| **budget_ms <= top_ms) {
        plot.line("budget", plot.at(*budget_ms, 0.0), plot.at(*budget_ms, f64::INFINITY));
    }
    let budget = ("budget", "the budget, dashed");
    let keys = logs.iter().map(|(class, name, _)| (*class, *name)).chain([budget]);
    let caption = "Percent of the frames by their GPU time. The bar at the right end has all longer frames too; no \
                   bar with a frame in it is invisibly low.";
    page::figure([plot.finish(), page::keys(keys)], caption)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_frame_is_in_one_bin() {
        let times = [0.0, 1.0, 5.999, 6.0, 60.0, 1e9, -1.0, f64::NAN];
        let shares = shares(&Sorted::new(times), 60.0);
        assert_eq!(shares.len(), NUM_BINS);
        let num = |bin: usize| shares[bin].1;
        assert_eq!([num(0), num(1), num(5), num(6), num(59)], [2, 1, 1, 1, 2], "edges belong to the right");
        assert_eq!(shares.iter().map(|(_, num)| num).sum::<usize>(), 7, "NaN is no time");
        assert!((shares.iter().map(|(share, _)| share).sum::<f64>() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_rare_frame_is_seen() {
        let times = Sorted::new((0..100_000).map(|i| if i == 7 { 9.5 } else { 1.0 }));
        let markup = histogram(&[("a", "x", &times)], 10.0, &[5.0]).into_string();
        assert_eq!(markup.matches("<rect").count(), 2, "{markup}");
        assert!(markup.contains("height=\"1\"") && markup.contains(" 1 frame,"), "{markup}");
        assert_eq!(markup.matches("class=\"budget\"").count(), 2, "line and key: {markup}");
    }
}
