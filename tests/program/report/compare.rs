//! Two logs side by side.

use super::{faults, log_of};
use lab::report::Comparison;
use timing::FrameLogFile;

/// Frame times that resemble the one before, drawn anew for each seed.
fn drawn(mean_ms: f64, seed: u64) -> impl FnMut(u64) -> f64 {
    let (mut bits, mut state) = (seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1, 0.0);
    let mut unit = move || {
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        (bits >> 11) as f64 / (1_u64 << 53) as f64
    };
    move |_| {
        state = 0.9 * state + 0.6 * (unit() - 0.5);
        mean_ms + state
    }
}

fn compared(a: &FrameLogFile, b: &FrameLogFile) -> Comparison {
    Comparison::of(["a.csv".into(), "b <2>.csv".into()], [a, b])
}

#[test]
fn chance_is_no_difference() {
    let mut num_clear = 0;
    for seed in 0..10 {
        let logs = [2 * seed + 1, 2 * seed + 2].map(|seed| log_of(3000, drawn(8.0, seed)));
        let comparison = compared(&logs[0], &logs[1]);
        num_clear += usize::from(comparison.differences[0].is_clear());
    }
    assert!(num_clear <= 2, "{num_clear} of 10 pairs of the same kind look different");
}

#[test]
fn a_real_shift_is_a_difference() {
    let (a, b) = (log_of(3000, drawn(8.0, 1)), log_of(2500, drawn(9.0, 2)));
    let comparison = compared(&a, &b);
    for difference in &comparison.differences {
        assert!(difference.is_clear(), "{difference:?}");
        let [low, high] = difference.ratio.unwrap();
        assert!(low > 1.05 && high < 1.2, "{difference:?}");
    }
    let back = compared(&b, &a);
    assert!(back.to_string().contains("B faster") && !back.to_string().contains("B slower"));
    let text = comparison.to_string();
    for expected in ["A           a.csv", "B slower", "over budget", "median ms", "  depth"] {
        assert!(text.contains(expected), "{expected} is not in\n{text}");
    }
    let page = comparison.page();
    assert_eq!(faults(&page), Vec::<String>::new());
    for expected in ["A: a.csv, B: b &lt;2&gt;.csv", "<rect class=\"a\"", "<rect class=\"b\"", "B slower"] {
        assert!(page.contains(expected), "{expected} is not in the page");
    }
}

#[test]
fn logs_of_different_programs_and_lengths() {
    let usual = log_of(500, drawn(8.0, 1));
    let mut other = log_of(500, drawn(8.0, 2));
    other.facts[1].1 = "another GPU".into();
    other.stages[1] = "prefetch".into();
    let mut untimed = usual.clone();
    untimed.frames.iter_mut().for_each(|frame| frame.gpu_ms = f64::NAN);
    let few = log_of(5, drawn(8.0, 3));
    for (name, b) in [("other", &other), ("untimed", &untimed), ("few", &few), ("empty", &log_of(0, |_| 1.0))]
    {
        let comparison = compared(&usual, b);
        assert_eq!(faults(&comparison.page()), Vec::<String>::new(), "{name}");
        assert!(comparison.to_string().contains("frames"), "{name}");
    }
    let comparison = compared(&usual, &other);
    assert_eq!(comparison.differing_facts(), [("device", ["some GPU", "another GPU"])]);
    let names: Vec<&str> = comparison.differences.iter().map(|d| d.name.as_str()).collect();
    assert_eq!(names, ["GPU", "clear", "lod", "cull", "depth", "color", "resolve", "prefetch"]);
    assert_eq!(comparison.differences[2].medians_ms[1], None, "only A has it");
    assert!(compared(&usual, &few).to_string().contains("too few frames"));
}
