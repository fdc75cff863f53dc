// Counts what a way of drawing does, for `bench`, which draws a frame of its own with it and does not time it. Each thread
// of a workgroup has a bin, so that few meet in one; the host adds the bins up. counted.inc.wgsl says what is counted where.

struct Counts {
    num_drawn: atomic<u32>,
    num_asked: atomic<u32>,
    num_reads: atomic<u32>,
    num_colors: atomic<u32>,
    num_chosen: atomic<u32>,
    reserved: array<u32, 3>,
}

/// Bits of a word.
const WORD_BITS: u32 = 32u;

@group(0) @binding(18) var<storage, read_write> count_bins: array<Counts, WORKGROUP_SIZE>;

/// True once the point at hand has asked for a pixel.
var<private> has_asked: bool;
/// True while a triangle is put into pixels, which counts as one point.
var<private> is_in_triangle: bool;
/// A bit for each splat that waits for the workgroup: one of its threads has asked for a pixel.
var<workgroup> asked_splats: array<atomic<u32>, WORKGROUP_SIZE>;

// True if the current point has asked for a pixel; afterwards the next point is the current one.
fn take_asked() -> bool {
    let asked = has_asked;
    has_asked = false;
    return asked;
}

// Counts a point, disc or triangle that is done: it was drawn if it has asked.
fn count_point() {
    count_once(take_asked());
}

// Counts what threads have drawn together; one of them passes true.
fn count_once(is_drawn: bool) {
    has_asked = false;
    if is_drawn {
        atomicAdd(&count_bins[this_thread].num_drawn, 1u);
    }
}

// Notes whether the current thread has asked for a pixel of a splat that several threads draw.
fn count_share(splat: u32) {
    if take_asked() {
        atomicOr(&asked_splats[splat / WORD_BITS], 1u << (splat % WORD_BITS));
    }
}

// Counts the splats that the workgroup has drawn together, behind the barrier after them.
fn count_waiting() {
    let num_drawn = countOneBits(atomicExchange(&asked_splats[this_thread], 0u));
    if num_drawn > 0u {
        atomicAdd(&count_bins[this_thread].num_drawn, num_drawn);
    }
}

// Counts an atomic, or a write, for a pixel.
fn count_ask() {
    has_asked = true;
    atomicAdd(&count_bins[this_thread].num_asked, 1u);
}

// Counts a load of a pixel's word, made to see whether an atomic is worth it.
fn count_read() {
    atomicAdd(&count_bins[this_thread].num_reads, 1u);
}

// Counts a load of a point's color.
fn count_color() {
    atomicAdd(&count_bins[this_thread].num_colors, 1u);
}
