// dilate: closes the gaps between points of one surface, on the way to the image. A pixel that lies farther than the
// nearest surface of its window, or has no point, takes that surface's depth and the blend of its colors, in which
// nearer pixels weigh more; other pixels stay as they are. One eye a dispatch, a tile a workgroup; docs/FRAME.md §6.
//
// It makes two passes through workgroup memory: rows first, each pixel with those that reach it, then columns over what
// the rows found. A pixel's point reaches as far as its depth's last bits say, and at least as far as the kernel of its
// ring. A tile that is one surface without gaps, or empty, is written as it is. Sums are integers, so their order does
// not show. Neighbors are made at once, eight in a row and four in a column, since they share taps. Rows of workgroup
// memory have odd lengths, so that the threads' taps lie in different banks. A thread keeps its own four pixels' depths
// and colors.

const NUM_THREADS: u32 = TILE_PX.x * TILE_PX.y / PIXELS_PER_THREAD;
const NUM_COLUMNS: u32 = TILE_PX.x + 2u * DILATE_REACH_PX;
const NUM_ROWS: u32 = TILE_PX.y + 2u * DILATE_REACH_PX;
const TILE_STRIDE: u32 = NUM_COLUMNS | 1u;
const ROW_STRIDE: u32 = TILE_PX.x | 1u;
/// Row windows that are made at once.
const ROW_WINDOWS: u32 = 2u * PIXELS_PER_THREAD;
const NUM_RUNS: u32 = TILE_PX.x / ROW_WINDOWS;
/// Depths within this factor of another, nearer or farther, are of one surface: its square is below SURFACE_TOLERANCE.
const WHOLE_TOLERANCE: f32 = 1.0 + 0.49 * (SURFACE_TOLERANCE - 1.0);
/// Pixels above and below the tile that reach into it.
const NUM_ABOVE_BELOW: u32 = 2u * DILATE_REACH_PX * NUM_COLUMNS;
/// All pixels around the tile that reach into it.
const NUM_AROUND: u32 = NUM_ABOVE_BELOW + 2u * DILATE_REACH_PX * TILE_PX.y;

/// The eye, which is read once.
var<private> eye: EyeUniform;

/// Depths of the tile and of the pixels that reach into it.
var<workgroup> tile_depth: array<u32, TILE_STRIDE * NUM_ROWS>;
/// Colors of the same pixels, with 1 for alpha, whose sum is that of the weights.
var<workgroup> tile_color: array<u32, TILE_STRIDE * NUM_ROWS>;
/// Not 0 if a pixel of the tile may take another's surface: the tile is neither one surface without gaps, nor empty.
var<workgroup> varies: atomic<u32>;
/// Nearest depth of each pixel's row window.
var<workgroup> row_nearest: array<u32, ROW_STRIDE * NUM_ROWS>;
/// Sums of each row window's nearest surface, colors times weights, 16 bits each: r | b≪16, g | weights≪16.
var<workgroup> row_sums: array<vec2<u32>, ROW_STRIDE * NUM_ROWS>;

/// Ten values that follow each other.
alias Run = array<u32, 10>;
/// Fourteen values that follow each other: eight neighbors and the pixels that they reach.
alias Row = array<u32, 14>;
/// Bits of one of the two sums that share a word: red below blue, green below the weights.
const HALF_BITS: u32 = 16u;
/// Mask of the lower of the two sums in a word.
const HALF_MASK: u32 = (1u << HALF_BITS) - 1u;
/// A channel's bits in each half.
const CHANNELS_MASK: u32 = CHANNEL_MASK | (CHANNEL_MASK << HALF_BITS);
/// Values of a run that each of four neighbors sees, at the distances −3 to 3.
alias Taps = array<vec4<u32>, 7>;
/// The bits of a value that are summed up.
struct Part {
    shift: u32,
    mask: u32,
}

fn taps(v: Run) -> Taps {
    return Taps(vec4(v[0], v[1], v[2], v[3]), vec4(v[1], v[2], v[3], v[4]), vec4(v[2], v[3], v[4], v[5]),
        vec4(v[3], v[4], v[5], v[6]), vec4(v[4], v[5], v[6], v[7]), vec4(v[5], v[6], v[7], v[8]),
        vec4(v[6], v[7], v[8], v[9]));
}

// Depths of the pixels that reach this far.
fn reaching(depth: vec4<u32>, distance: u32) -> vec4<u32> {
    return select(vec4<u32>(EMPTY_DEPTH), depth, (depth & vec4<u32>(REACH_MASK)) >= vec4<u32>(distance));
}

// Depths of the pixels that reach each neighbor. Every pixel reaches those beside it.
fn within_reach(d: Taps) -> Taps {
    return Taps(reaching(d[0], 3u), reaching(d[1], 2u), d[2], d[3], d[4], reaching(d[5], 2u), reaching(d[6], 3u));
}

fn nearest_of(d: Taps) -> vec4<u32> {
    return min(d[3], min(min(min(d[0], d[6]), min(d[1], d[5])), min(d[2], d[4])));
}

// A part of each value whose depth is at most `end`, else 0.
fn counted(end: vec4<u32>, depth: vec4<u32>, value: vec4<u32>, part: Part) -> vec4<u32> {
    return select(vec4<u32>(0u), (value >> vec4<u32>(part.shift)) & vec4<u32>(part.mask), depth <= end);
}

// Weighted sum of the values that count: a weight is one shift larger for each pixel that the value is nearer.
fn weigh(end: vec4<u32>, d: Taps, v: Taps, part: Part) -> vec4<u32> {
    let falloff = vec4<u32>(DILATE_FALLOFF_BITS);
    var sum = counted(end, d[3], v[3], part);
    sum = (sum << falloff) + counted(end, d[2], v[2], part) + counted(end, d[4], v[4], part);
    sum = (sum << falloff) + counted(end, d[1], v[1], part) + counted(end, d[5], v[5], part);
    return (sum << falloff) + counted(end, d[0], v[0], part) + counted(end, d[6], v[6], part);
}

// Left of the image and above it, coordinates wrap to large ones.
fn is_inside(pixel: vec2<u32>) -> bool {
    return pixel.x < eye.width && pixel.y < eye.height;
}

fn number_of(pixel: vec2<u32>) -> u32 {
    return pixel.y * eye.width + pixel.x;
}

// Place in the tile of the pixels around it.
fn place_around(i: u32) -> vec2<u32> {
    if i < NUM_ABOVE_BELOW {
        let row = i / NUM_COLUMNS;
        return vec2<u32>(i % NUM_COLUMNS, select(row, row + TILE_PX.y, row >= DILATE_REACH_PX));
    }
    let side = (i - NUM_ABOVE_BELOW) % (2u * DILATE_REACH_PX);
    let row = (i - NUM_ABOVE_BELOW) / (2u * DILATE_REACH_PX);
    return vec2<u32>(select(side, side + TILE_PX.x, side >= DILATE_REACH_PX), row + DILATE_REACH_PX);
}

// A pixel's depth, which widens the thread's range of depths; outside the image there is none.
fn load_depth(pixel: vec2<u32>, range: ptr<function, vec2<u32>>) -> u32 {
    if !is_inside(pixel) {
        return EMPTY_DEPTH;
    }
    let w = surface_depth(number_of(pixel));
    *range = vec2<u32>(min((*range).x, w), max((*range).y, w));
    return w;
}

// A depth that reaches as far as the kernel of the pixel's ring, or farther.
fn with_reach(depth: u32, pixel: vec2<u32>) -> u32 {
    let reach = max(depth & REACH_MASK, radius_px(eye, i32(pixel.x), i32(pixel.y)));
    return (depth & ~REACH_MASK) | reach;
}

fn load_color(pixel: vec2<u32>, w: u32) -> u32 {
    if w == EMPTY_DEPTH {
        return 0u;
    }
    return surface_color(number_of(pixel));
}

// The range of depths that are of one surface with the given pixel's.
fn surface_around(pixel: vec2<u32>) -> vec2<u32> {
    let w = surface_depth(number_of(pixel));
    let depth = bitcast<f32>(w);
    let around = vec2<u32>(bitcast<u32>(depth / WHOLE_TOLERANCE), bitcast<u32>(depth * WHOLE_TOLERANCE));
    return select(around, vec2<u32>(EMPTY_DEPTH), w == EMPTY_DEPTH);
}

fn keep_color(at: u32, color: u32) {
    tile_color[at] = (color & RGB_MASK) | (1u << ALPHA_SHIFT);
}

fn first_run(v: Row) -> Run {
    return Run(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8], v[9]);
}

fn last_run(v: Row) -> Run {
    return Run(v[4], v[5], v[6], v[7], v[8], v[9], v[10], v[11], v[12], v[13]);
}

// Finds the nearest depths of the row windows of four pixels, the first of which goes to `to`, and sums them up.
fn sum_row(to: u32, depth: Run, color: Run) {
    let d = within_reach(taps(depth));
    let nearest = nearest_of(d);
    let end = surface_end(nearest);
    let c = taps(color);
    let rb = weigh(end, d, c, Part(0u, CHANNELS_MASK));
    let gw = weigh(end, d, c, Part(GREEN_SHIFT, CHANNELS_MASK));
    for (var i = 0u; i < PIXELS_PER_THREAD; i += 1u) {
        row_nearest[to + i] = nearest[i];
        row_sums[to + i] = vec2(rb[i], gw[i]);
    }
}

// Sums up the row windows of eight pixels, the first of which lies at column + reach, row of the tile.
fn sum_rows(column: u32, row: u32) {
    let i = row * TILE_STRIDE + column;
    let depth = Row(tile_depth[i], tile_depth[i + 1u], tile_depth[i + 2u], tile_depth[i + 3u], tile_depth[i + 4u],
        tile_depth[i + 5u], tile_depth[i + 6u], tile_depth[i + 7u], tile_depth[i + 8u], tile_depth[i + 9u],
        tile_depth[i + 10u], tile_depth[i + 11u], tile_depth[i + 12u], tile_depth[i + 13u]);
    let color = Row(tile_color[i], tile_color[i + 1u], tile_color[i + 2u], tile_color[i + 3u], tile_color[i + 4u],
        tile_color[i + 5u], tile_color[i + 6u], tile_color[i + 7u], tile_color[i + 8u], tile_color[i + 9u],
        tile_color[i + 10u], tile_color[i + 11u], tile_color[i + 12u], tile_color[i + 13u]);
    let to = row * ROW_STRIDE + column;
    sum_row(to, first_run(depth), first_run(color));
    sum_row(to + PIXELS_PER_THREAD, last_run(depth), last_run(color));
}

// Depths that the rows found in the column windows of four pixels.
fn column_depths(i: u32) -> Taps {
    let k = ROW_STRIDE;
    return within_reach(taps(Run(row_nearest[i], row_nearest[i + k], row_nearest[i + 2u * k],
        row_nearest[i + 3u * k], row_nearest[i + 4u * k], row_nearest[i + 5u * k], row_nearest[i + 6u * k],
        row_nearest[i + 7u * k], row_nearest[i + 8u * k], row_nearest[i + 9u * k])));
}

// Colors of four pixels below each other, whose columns begin at `i` and have depths `d`.
fn blend_columns(i: u32, end: vec4<u32>, d: Taps) -> vec4<u32> {
    let k = ROW_STRIDE;
    let run = array(row_sums[i], row_sums[i + k], row_sums[i + 2u * k], row_sums[i + 3u * k], row_sums[i + 4u * k],
        row_sums[i + 5u * k], row_sums[i + 6u * k], row_sums[i + 7u * k], row_sums[i + 8u * k], row_sums[i + 9u * k]);
    let rb = taps(Run(run[0].x, run[1].x, run[2].x, run[3].x, run[4].x, run[5].x, run[6].x, run[7].x, run[8].x,
        run[9].x));
    let gw = taps(Run(run[0].y, run[1].y, run[2].y, run[3].y, run[4].y, run[5].y, run[6].y, run[7].y, run[8].y,
        run[9].y));
    // Weights are at least 1, so that nothing is divided by 0 where nothing counts; there is no color there either.
    let weights = max(weigh(end, d, gw, Part(HALF_BITS, HALF_MASK)), vec4<u32>(1u));
    let r = mean(weigh(end, d, rb, Part(0u, HALF_MASK)), weights);
    let g = mean(weigh(end, d, gw, Part(0u, HALF_MASK)), weights);
    let b = mean(weigh(end, d, rb, Part(HALF_BITS, HALF_MASK)), weights);
    return r | g << vec4<u32>(GREEN_SHIFT) | b << vec4<u32>(BLUE_SHIFT);
}

@compute @workgroup_size(NUM_THREADS)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    eye = view.eyes[dilate.eye];
    let tile = tile_of(group, groups);
    let first = first_pixel(tile);
    let corner = first - DILATE_REACH_PX;
    // This thread's own pixels are four below each other.
    let column = thread % TILE_PX.x;
    let row = PIXELS_PER_THREAD * (thread / TILE_PX.x);
    let a = first + vec2(column, row);
    let b = a + vec2(0u, 1u);
    let c = a + vec2(0u, 2u);
    let d = a + vec2(0u, 3u);
    let at = (row + DILATE_REACH_PX) * TILE_STRIDE + column + DILATE_REACH_PX;

    let whole = surface_around(first);
    var range = vec2<u32>(EMPTY_DEPTH, 0u);
    let own = vec4<u32>(load_depth(a, &range), load_depth(b, &range), load_depth(c, &range), load_depth(d, &range));
    tile_depth[at] = with_reach(own.x, a);
    tile_depth[at + TILE_STRIDE] = with_reach(own.y, b);
    tile_depth[at + 2u * TILE_STRIDE] = with_reach(own.z, c);
    tile_depth[at + 3u * TILE_STRIDE] = with_reach(own.w, d);
    for (var i = thread; i < NUM_AROUND; i += NUM_THREADS) {
        let place = place_around(i);
        let pixel = corner + place;
        tile_depth[place.y * TILE_STRIDE + place.x] = with_reach(load_depth(pixel, &range), pixel);
    }
    if range.x < whole.x || range.y > whole.y {
        atomicStore(&varies, 1u);
    }
    workgroupBarrier();
    var depth = own;
    var color = vec4<u32>(load_color(a, own.x), load_color(b, own.y), load_color(c, own.z), load_color(d, own.w));
    if atomicLoad(&varies) != 0u {
        keep_color(at, color.x);
        keep_color(at + TILE_STRIDE, color.y);
        keep_color(at + 2u * TILE_STRIDE, color.z);
        keep_color(at + 3u * TILE_STRIDE, color.w);
        for (var i = thread; i < NUM_AROUND; i += NUM_THREADS) {
            let place = place_around(i);
            let at = place.y * TILE_STRIDE + place.x;
            keep_color(at, load_color(corner + place, tile_depth[at]));
        }
        workgroupBarrier();
        for (var i = thread; i < NUM_RUNS * NUM_ROWS; i += NUM_THREADS) {
            sum_rows(ROW_WINDOWS * (i / NUM_ROWS), i % NUM_ROWS);
        }
        workgroupBarrier();
        let i = row * ROW_STRIDE + column;
        let around = column_depths(i);
        let nearest = nearest_of(around);
        let end = surface_end(nearest);
        // An empty pixel that finds no surface stays too.
        let stays = (own <= end) | (nearest == vec4<u32>(EMPTY_DEPTH));
        if !all(stays) {
            depth = select(nearest & vec4<u32>(~REACH_MASK), own, stays);
            color = select(blend_columns(i, end, around), color, stays);
        }
    }
    into_image(a, depth.x, color.x, hides(tile));
    into_image(b, depth.y, color.y, hides(tile));
    into_image(c, depth.z, color.z, hides(tile));
    into_image(d, depth.w, color.w, hides(tile));
}
