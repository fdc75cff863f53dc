//! The ways to put points into pixels that the papers compare. All draw the same picture, and differ in time. The
//! exceptions are those of [`Method::shows_the_last`], [`Method::Hqs1`] where a pixel gets more points than it can count, and points
//! that are equally far: [`Method::PointList`] shows any of them, and [`Method::Fixed40`], to whose precision more are
//! equally far, shows the smaller color.

use render::layout::Sums;
use render::options::Quality;

base::choice! {
    /// How early-z loads a pixel, before it decides whether to ask for it by an atomic operation.
    pub enum EarlyZLoad {
        /// An atomic load, which may bypass the GPU's first cache.
        Atomic = "atomic",
        /// A plain load as in the papers, which a GPU may answer from its first cache, at the cost of an atomic
        /// operation where that is out of date.
        Plain = "plain",
    }
}

base::choice! {
    /// How points get into pixels, by the papers' names.
    pub enum Method {
        /// As the frame does it, which is the fastest, four points a thread, loaded at once, after a look at the
        /// pixel [2022 §3.4].
        Prefetch = "prefetch",
        /// One point a thread at a time, after a look at the pixel [2022 §3.2].
        Basic = "basic",
        /// Whoever comes last has the pixel, which is wrong, and as fast as writing can be [2021 §5].
        JustSet = "just-set",
        /// Wait until nobody has the pixel locked, lock it, write, unlock it [2021 §2.2, §5].
        BusyLoop = "busy-loop",
        /// Without a lock, a thread compares and exchanges the pixel until no other comes between.
        ExchangeLoop = "exchange-loop",
        /// Every point asks for its pixel [2021 §3.1].
        AtomicMin = "atomic-min",
        /// A look at the pixel first [2021 §3.2].
        EarlyZ = "early-z",
        /// A subgroup that has only one pixel asks once, and so do pairs of threads [2021 §3.3].
        Reduce = "reduce",
        /// A look at the pixel first, then as `reduce` [2021 §3.2, §3.3].
        ReduceEarlyZ = "reduce-early-z",
        /// A look at the pixel first, then a subgroup asks for each of its pixels once [2021 §3.4, §5].
        Dedup = "dedup",
        /// The hardware's own points, which the papers measure against [2022 §4.1].
        PointList = "point-list",
        /// High-quality shading by two 64-bit additions a point [2021 §3.5].
        Hqs = "hqs",
        /// High-quality shading by one 64-bit addition a point, exact up to 1023 points a pixel [2021 §3.5.1].
        Hqs1 = "hqs1",
        /// High-quality shading by one 64-bit addition a point, and further ones where that is not enough [2021 §3.5.1].
        Hqs1r = "hqs1r",
        /// Depth in 40-bit integers from f64 with the color below it, and `resolve` clears the target [2019 §2.1].
        Fixed40 = "fixed40",
        /// As `just-set` in the loop of `prefetch`, which is wrong too.
        PrefetchJustSet = "prefetch-just-set",
    }
}

impl Method {
    /// The quality that the method draws; `None` if it draws either.
    #[must_use]
    pub fn quality(self) -> Option<Quality> {
        match self {
            Self::Prefetch | Self::Basic => None,
            Self::Hqs | Self::Hqs1 | Self::Hqs1r => Some(Quality::Hqs),
            _ => Some(Quality::Closest),
        }
    }

    /// The form of sums that the method requires.
    #[must_use]
    pub fn sums(self) -> Option<Sums> {
        match self {
            // Two 64-bit pairs take the place of four words.
            Self::Hqs => Some(Sums::Wide),
            Self::Hqs1 => Some(Sums::Packed),
            Self::Hqs1r => Some(Sums::Protected),
            _ => None,
        }
    }

    /// True if a thread draws one point at a time, as in the 2021 paper.
    #[must_use]
    pub fn is_basic(self) -> bool {
        !matches!(self, Self::Prefetch | Self::PrefetchJustSet)
    }

    /// True if a pixel shows whichever of its points came last: no two pictures need be the same.
    #[must_use]
    pub fn shows_the_last(self) -> bool {
        matches!(self, Self::JustSet | Self::PrefetchJustSet)
    }

    /// True if a point is always one pixel. Hardware points have no other size, and threads of a subgroup that ask each
    /// other must come with the same number of pixels each.
    #[must_use]
    pub fn draws_pixels(self) -> bool {
        self == Self::PointList || self.is_converged()
    }

    /// True if threads of a subgroup ask each other for their pixels, which takes converged control flow.
    #[must_use]
    pub fn is_converged(self) -> bool {
        matches!(self, Self::Reduce | Self::ReduceEarlyZ | Self::Dedup)
    }

    /// True if the method needs 64-bit atomics of all kinds. The other methods take minima, which every tier can, if
    /// need be of depths alone; hardware points take no atomics.
    #[must_use]
    pub fn needs_int64(self) -> bool {
        use Method as M;
        let takes_minima = matches!(self, M::Prefetch | M::Basic | M::AtomicMin | M::EarlyZ)
            || matches!(self, M::Reduce | M::ReduceEarlyZ | M::Dedup);
        !takes_minima && self != M::PointList
    }
}
