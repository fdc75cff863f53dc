// Counts what a way of drawing does, for `bench`, which draws a frame of its own with it and does not time it. Each
// workgroup has a bin, so that few threads meet in one; the host adds the bins up.

struct Counts {
    num_drawn: atomic<u32>,
    num_asked: atomic<u32>,
    num_looks: atomic<u32>,
    num_colors: atomic<u32>,
    num_chosen: atomic<u32>,
    reserved: array<u32, 3>,
}

/// Bits of a word.
const WORD_BITS: u32 = 32u;

@group(0) @binding(18) var<storage, read_write> count_bins: array<Counts, COUNT_BINS>;

/// True once the point at hand has asked for a pixel.
var<private> has_asked: bool;
/// A bit for each splat that waits for the workgroup: one of its threads has asked for a pixel.
var<workgroup> asked_splats: array<atomic<u32>, WORKGROUP_SIZE>;

fn bin() -> u32 {
    return this_group % COUNT_BINS;
}

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
        atomicAdd(&count_bins[bin()].num_drawn, 1u);
    }
}

// Notes whether the current thread has asked for a pixel of a splat that several threads draw.
fn count_share(splat: u32) {
    if take_asked() {
        atomicOr(&asked_splats[splat / WORD_BITS], 1u << (splat % WORD_BITS));
    }
}

// Counts the splats that the workgroup has drawn together. All its threads come here between two barriers.
fn count_waiting(num_splats: u32) {
    for (var word = this_thread; WORD_BITS * word < num_splats; word += WORKGROUP_SIZE) {
        atomicAdd(&count_bins[bin()].num_drawn, countOneBits(atomicExchange(&asked_splats[word], 0u)));
    }
}

// Counts an atomic, or a write, for a pixel.
fn count_ask() {
    has_asked = true;
    atomicAdd(&count_bins[bin()].num_asked, 1u);
}

// Counts a load of a pixel's word, made to see whether an atomic is worth it.
fn count_look() {
    atomicAdd(&count_bins[bin()].num_looks, 1u);
}

// Counts a load of a point's color.
fn count_color() {
    atomicAdd(&count_bins[bin()].num_colors, 1u);
}
