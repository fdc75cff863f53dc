// Questions that threads of a subgroup ask each other, whatever its size. All of its threads must come here together.

// The smallest value of all threads if they have the same key, else the thread's own.
fn least_if_same(key: u32, value: u32) -> u32 {
    if subgroupAll(key == subgroupBroadcastFirst(key)) {
        return subgroupMin(value);
    }
    return value;
}

// The value of the other thread of a pair.
fn neighbors(value: u32) -> u32 {
    return subgroupShuffleXor(value, 1u);
}

// The smallest value among the threads that have this key. The loop goes round once for each key that there is: WGSL
// cannot ask for all of them at once.
fn least_of_same(key: u32, value: u32) -> u32 {
    var least = value;
    var waits = key != NO_PIXEL;
    while subgroupAny(waits) {
        let first = subgroupMin(select(NO_PIXEL, key, waits));
        let is_first = waits && key == first;
        let first_least = subgroupMin(select(~0u, value, is_first));
        if is_first {
            least = first_least;
            waits = false;
        }
    }
    return least;
}
