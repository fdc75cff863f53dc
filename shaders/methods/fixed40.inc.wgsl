// Depths in 40-bit integers: ranges of distance, each with a precision of its own. [2019 §2.1]

fn depth40_of(depth: f64) -> u64 {
    var steps = depth * RANGE_A_STEPS;
    var first = 0lu;
    if depth >= RANGE_C_BEGIN {
        steps = (depth - RANGE_C_BEGIN) * RANGE_C_STEPS;
        first = RANGE_C_FIRST;
    } else if depth >= RANGE_B_BEGIN {
        steps = (depth - RANGE_B_BEGIN) * RANGE_B_STEPS;
        first = RANGE_B_FIRST;
    }
    return min(first + u64(steps), EMPTY40 - 1lu);
}

fn depth_of(depth40: u64) -> f64 {
    if depth40 >= RANGE_C_FIRST {
        return RANGE_C_BEGIN + f64(depth40 - RANGE_C_FIRST) / RANGE_C_STEPS;
    }
    if depth40 >= RANGE_B_FIRST {
        return RANGE_B_BEGIN + f64(depth40 - RANGE_B_FIRST) / RANGE_B_STEPS;
    }
    return f64(depth40) / RANGE_A_STEPS;
}
