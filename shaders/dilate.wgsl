// dilate: closes the gaps between points of one surface. A pixel that lies farther than the nearest surface of its
// window, or has no point, takes that surface's depth and the blend of its colours, the closer the heavier;
// others stay as they are. One eye a dispatch; frame.md section 6.
//
// In two passes through workgroup memory: rows first, each pixel with the radius of its own ring, then columns over
// what the rows found. Sums are integers, so their order does not show. A thread makes four neighbours at once: they
// share ten taps. Rows of workgroup memory have odd lengths, so that the threads' taps lie in different banks.

const NUM_THREADS: u32 = TILE_PX.x * TILE_PX.y / 4u;
const NUM_COLUMNS: u32 = TILE_PX.x + 2u * DILATE_REACH_PX;
const NUM_ROWS: u32 = TILE_PX.y + 2u * DILATE_REACH_PX;
const TILE_STRIDE: u32 = NUM_COLUMNS | 1u;
const ROW_STRIDE: u32 = TILE_PX.x | 1u;

/// The tile and what reaches into it.
var<workgroup> tile: array<vec2<u32>, TILE_STRIDE * NUM_ROWS>;
/// Its farthest depth, and the complement of its nearest: both begin at 0.
var<workgroup> farthest: atomic<u32>;
var<workgroup> nearness: atomic<u32>;
/// Nearest depth of each pixel's row window.
var<workgroup> row_nearest: array<u32, ROW_STRIDE * NUM_ROWS>;
/// Sums of that surface's colours times weights, 16 bits each: r | b≪16, g | a≪16. Alpha is 255 throughout, so its
/// sum stands for that of the weights.
var<workgroup> row_sums: array<vec2<u32>, ROW_STRIDE * NUM_ROWS>;

/// Ten values that follow each other.
alias Run = array<u32, 10>;
/// What each of four neighbours sees of a run, at the distances −3 to 3.
alias Taps = array<vec4<u32>, 7>;
/// A part of each of four values.
struct Part {
    shift: u32,
    mask: u32,
}

fn taps(v: Run) -> Taps {
    return Taps(vec4(v[0], v[1], v[2], v[3]), vec4(v[1], v[2], v[3], v[4]), vec4(v[2], v[3], v[4], v[5]),
        vec4(v[3], v[4], v[5], v[6]), vec4(v[4], v[5], v[6], v[7]), vec4(v[5], v[6], v[7], v[8]),
        vec4(v[6], v[7], v[8], v[9]));
}

// Depths without those that a neighbour's radius does not reach.
fn within(radius: vec4<u32>, d: Taps) -> Taps {
    let none = vec4<u32>(EMPTY_DEPTH);
    let two = radius >= vec4<u32>(2u);
    let three = radius >= vec4<u32>(3u);
    return Taps(select(none, d[0], three), select(none, d[1], two), d[2], d[3], d[4], select(none, d[5], two),
        select(none, d[6], three));
}

fn nearest_of(d: Taps) -> vec4<u32> {
    return min(d[3], min(min(min(d[0], d[6]), min(d[1], d[5])), min(d[2], d[4])));
}

// A part of each value whose depth is at most `end`, else 0.
fn counted(end: vec4<u32>, depth: vec4<u32>, value: vec4<u32>, part: Part) -> vec4<u32> {
    return select(vec4<u32>(0u), (value >> vec4<u32>(part.shift)) & vec4<u32>(part.mask), depth <= end);
}

// Sum of what counts, times its weight: a shift for each pixel that it is nearer.
fn weigh(end: vec4<u32>, d: Taps, v: Taps, part: Part) -> vec4<u32> {
    let falloff = vec4<u32>(DILATE_FALLOFF_BITS);
    var sum = counted(end, d[3], v[3], part);
    sum = (sum << falloff) + counted(end, d[2], v[2], part) + counted(end, d[4], v[4], part);
    sum = (sum << falloff) + counted(end, d[1], v[1], part) + counted(end, d[5], v[5], part);
    return (sum << falloff) + counted(end, d[0], v[0], part) + counted(end, d[6], v[6], part);
}

fn load(corner: vec2<i32>, thread: u32) {
    let size = vec2<u32>(view.eyes[dilate.eye].width, view.eyes[dilate.eye].height);
    var far = 0u;
    var near = EMPTY_DEPTH;
    for (var i = thread; i < NUM_COLUMNS * NUM_ROWS; i += NUM_THREADS) {
        let local = vec2<u32>(i % NUM_COLUMNS, i / NUM_COLUMNS);
        // Left of the image and above it, coordinates wrap to large ones.
        let pixel = vec2<u32>(corner) + local;
        let inside = all(pixel < size);
        let point = surface[select(0u, pixel.y * size.x + pixel.x, inside)];
        let loaded = select(EMPTY, vec2<u32>(point.x, point.y | OPAQUE), inside && point.x != EMPTY_DEPTH);
        far = max(far, select(0u, point.x, inside));
        near = min(near, loaded.x);
        tile[local.y * TILE_STRIDE + local.x] = loaded;
    }
    atomicMax(&farthest, far);
    atomicMax(&nearness, ~near);
}

// True if no pixel of the tile has anything to take: it is one surface without gaps, or empty.
fn is_whole() -> bool {
    let nearest = ~atomicLoad(&nearness);
    return nearest == EMPTY_DEPTH || atomicLoad(&farthest) <= surface_end(vec4<u32>(nearest)).x;
}

// Sums up the row windows of four pixels, the first of which is column + reach, row of the tile.
fn sum_rows(corner: vec2<i32>, column: u32, row: u32) {
    let i = row * TILE_STRIDE + column;
    let run = array(tile[i], tile[i + 1u], tile[i + 2u], tile[i + 3u], tile[i + 4u], tile[i + 5u], tile[i + 6u],
        tile[i + 7u], tile[i + 8u], tile[i + 9u]);
    let x = corner.x + i32(column + DILATE_REACH_PX);
    let y = corner.y + i32(row);
    let radius = vec4(radius_px(x, y), radius_px(x + 1, y), radius_px(x + 2, y), radius_px(x + 3, y));
    let d = within(radius, taps(Run(run[0].x, run[1].x, run[2].x, run[3].x, run[4].x, run[5].x, run[6].x, run[7].x,
        run[8].x, run[9].x)));
    let nearest = nearest_of(d);
    let end = surface_end(nearest);
    let rgba = taps(Run(run[0].y, run[1].y, run[2].y, run[3].y, run[4].y, run[5].y, run[6].y, run[7].y, run[8].y,
        run[9].y));
    let rb = weigh(end, d, rgba, Part(0u, 0x00ff00ffu));
    let ga = weigh(end, d, rgba, Part(8u, 0x00ff00ffu));

    let to = row * ROW_STRIDE + column;
    row_nearest[to] = nearest.x;
    row_nearest[to + 1u] = nearest.y;
    row_nearest[to + 2u] = nearest.z;
    row_nearest[to + 3u] = nearest.w;
    row_sums[to] = vec2(rb.x, ga.x);
    row_sums[to + 1u] = vec2(rb.y, ga.y);
    row_sums[to + 2u] = vec2(rb.z, ga.z);
    row_sums[to + 3u] = vec2(rb.w, ga.w);
}

// Colours of four pixels below each other, whose columns begin at `i` and have depths `d`.
fn blend_columns(i: u32, end: vec4<u32>, d: Taps) -> vec4<u32> {
    let k = ROW_STRIDE;
    let run = array(row_sums[i], row_sums[i + k], row_sums[i + 2u * k], row_sums[i + 3u * k], row_sums[i + 4u * k],
        row_sums[i + 5u * k], row_sums[i + 6u * k], row_sums[i + 7u * k], row_sums[i + 8u * k], row_sums[i + 9u * k]);
    let rb = taps(Run(run[0].x, run[1].x, run[2].x, run[3].x, run[4].x, run[5].x, run[6].x, run[7].x, run[8].x,
        run[9].x));
    let ga = taps(Run(run[0].y, run[1].y, run[2].y, run[3].y, run[4].y, run[5].y, run[6].y, run[7].y, run[8].y,
        run[9].y));
    // Where nothing counts there is no colour either, and no division by 0.
    let weights = max(weigh(end, d, ga, Part(16u, 0xffffu)) / 255u, vec4<u32>(1u));
    let half = weights / 2u;
    let r = (weigh(end, d, rb, Part(0u, 0xffffu)) + half) / weights;
    let g = (weigh(end, d, ga, Part(0u, 0xffffu)) + half) / weights;
    let b = (weigh(end, d, rb, Part(16u, 0xffffu)) + half) / weights;
    return r | g << vec4<u32>(8u) | b << vec4<u32>(16u) | vec4<u32>(OPAQUE);
}

// Fills four pixels below each other.
fn fill_columns(pixel: vec2<u32>, column: u32, row: u32) {
    let i = row * ROW_STRIDE + column;
    let k = ROW_STRIDE;
    let run = Run(row_nearest[i], row_nearest[i + k], row_nearest[i + 2u * k], row_nearest[i + 3u * k],
        row_nearest[i + 4u * k], row_nearest[i + 5u * k], row_nearest[i + 6u * k], row_nearest[i + 7u * k],
        row_nearest[i + 8u * k], row_nearest[i + 9u * k]);
    let x = i32(pixel.x);
    let y = i32(pixel.y);
    let radius = vec4(radius_px(x, y), radius_px(x, y + 1), radius_px(x, y + 2), radius_px(x, y + 3));
    let d = within(radius, taps(run));
    let nearest = nearest_of(d);
    let end = surface_end(nearest);

    let own = array(own_pixel(column, row), own_pixel(column, row + 1u), own_pixel(column, row + 2u),
        own_pixel(column, row + 3u));
    // An empty pixel that finds nothing stays too.
    let stays = (vec4(own[0].x, own[1].x, own[2].x, own[3].x) <= end) | (nearest == vec4<u32>(EMPTY_DEPTH));
    var color = vec4<u32>(0u);
    if !all(stays) {
        color = blend_columns(i, end, d);
    }
    store(pixel, select(vec2(nearest.x, color.x), own[0], stays.x));
    store(pixel + vec2(0u, 1u), select(vec2(nearest.y, color.y), own[1], stays.y));
    store(pixel + vec2(0u, 2u), select(vec2(nearest.z, color.z), own[2], stays.z));
    store(pixel + vec2(0u, 3u), select(vec2(nearest.w, color.w), own[3], stays.w));
}

fn own_pixel(column: u32, row: u32) -> vec2<u32> {
    return tile[(row + DILATE_REACH_PX) * TILE_STRIDE + column + DILATE_REACH_PX];
}

fn store(pixel: vec2<u32>, value: vec2<u32>) {
    let width = view.eyes[dilate.eye].width;
    if pixel.x < width && pixel.y < view.eyes[dilate.eye].height {
        image[pixel.y * width + pixel.x] = value;
    }
}

@compute @workgroup_size(NUM_THREADS)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let first = first_pixel(group, groups);
    let corner = vec2<i32>(first) - i32(DILATE_REACH_PX);
    load(corner, thread);
    workgroupBarrier();
    let whole = is_whole();
    if !whole {
        for (var i = thread; i < TILE_PX.x / 4u * NUM_ROWS; i += NUM_THREADS) {
            sum_rows(corner, 4u * (i / NUM_ROWS), i % NUM_ROWS);
        }
    }
    workgroupBarrier();
    let column = thread % TILE_PX.x;
    let row = 4u * (thread / TILE_PX.x);
    if whole {
        for (var i = row; i < row + 4u; i += 1u) {
            store(first + vec2(column, i), own_pixel(column, i));
        }
    } else {
        fill_columns(first + vec2(column, row), column, row);
    }
}
