// Stands in for subgroup.inc.wgsl on devices without subgroups: the whole workgroup is one, and its threads tell each
// other through its memory. It is slow; the pictures are right.

var<workgroup> told: array<vec2<u32>, WORKGROUP_SIZE>;

fn tell(key: u32, value: u32) {
    workgroupBarrier();
    told[this_thread] = vec2<u32>(key, value);
    workgroupBarrier();
}

fn least_if_same(key: u32, value: u32) -> u32 {
    tell(key, value);
    var least = value;
    var same = true;
    for (var i = 0u; i < WORKGROUP_SIZE; i += 1u) {
        same = same && told[i].x == key;
        least = min(least, told[i].y);
    }
    return select(value, least, same);
}

fn neighbors(value: u32) -> u32 {
    tell(value, 0u);
    return told[this_thread ^ 1u].x;
}

fn least_of_same(key: u32, value: u32) -> u32 {
    tell(key, value);
    var least = value;
    for (var i = 0u; i < WORKGROUP_SIZE; i += 1u) {
        least = select(least, min(least, told[i].y), told[i].x == key);
    }
    return least;
}
