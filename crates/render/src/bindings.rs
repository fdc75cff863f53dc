//! The one table of what shaders bind: sets of resources, by the names that the shaders have for them. A field's name is
//! the shader's. Host code fills a set as a struct, so that what it leaves out is a build error; that every shader finds
//! all of its names in its set is a test, for every variant (`tests/gpu/shaders/bindings.rs`). Techniques bind things of their
//! own besides, by name too. A name that ends in [`AGAIN`] is the resource without it, bound a second time as another type.

use wgpu::BindingResource;

/// At the end of a name: the same resource, bound a second time.
pub const AGAIN: &str = "_again";

/// What shaders of one kind may bind. They need not bind all of it.
pub trait Set {
    /// The resources.
    type Resources<'a>;

    /// Their names, in order.
    fn names() -> Vec<&'static str>;

    /// The resources in the order of their names.
    fn list(resources: Self::Resources<'_>) -> Vec<BindingResource<'_>>;
}

/// Both.
impl<A: Set, B: Set> Set for (A, B) {
    type Resources<'a> = (A::Resources<'a>, B::Resources<'a>);

    fn names() -> Vec<&'static str> {
        [A::names(), B::names()].concat()
    }

    fn list((a, b): Self::Resources<'_>) -> Vec<BindingResource<'_>> {
        [A::list(a), B::list(b)].concat()
    }
}

macro_rules! sets {
    ($($(#[$about:meta])* $set:ident, $of:ident { $($(#[$what:meta])* $name:ident,)+ })+) => {
        $(
            $(#[$about])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub enum $set {}

            #[doc = concat!("The resources of [`", stringify!($set), "`].")]
            #[derive(Clone, Debug)]
            pub struct $of<'a> {
                $($(#[$what])* pub $name: BindingResource<'a>,)+
            }

            impl<'a> $of<'a> {
                /// Of whatever has these names.
                pub fn by_name(mut resource: impl FnMut(&'static str) -> BindingResource<'a>) -> Self {
                    Self { $($name: resource(stringify!($name)),)+ }
                }
            }

            impl Set for $set {
                type Resources<'a> = $of<'a>;

                fn names() -> Vec<&'static str> {
                    vec![$(stringify!($name)),+]
                }

                fn list(resources: Self::Resources<'_>) -> Vec<BindingResource<'_>> {
                    vec![$(resources.$name),+]
                }
            }
        )+
    };
}

sets! {
    /// A pair of targets to clear.
    Clear, OfClear {
        /// What it is cleared to.
        clear,
        /// The left eye's.
        left,
        /// The right eye's.
        right,
        /// Every chunk's counters.
        counters,
    }
    /// The view and the cloud's nodes.
    Cloud, OfCloud {
        /// Eyes and detail.
        view,
        /// Its nodes.
        nodes,
        /// Their states.
        states,
        /// Nodes that `cull` has counted.
        counted,
    }
    /// A chunk of the point pool.
    Chunk, OfChunk {
        /// Where it lies in the pool.
        chunk,
        /// Its batches.
        batches,
        /// Those that are drawn.
        visible,
        /// Its counters.
        counters,
        /// The coarse bits of coordinates.
        plane_hi,
        /// The middle bits.
        plane_mid,
        /// The fine bits.
        plane_lo,
        /// The points' own colors.
        colors,
        /// Colors of what samples stand for.
        filtered_colors,
    }
    /// Both eyes' pixels. One buffer has several names, as qualities see it.
    Pixels, OfPixels {
        /// Depth and id.
        keys_left,
        /// The right eye's.
        keys_right,
        /// Sums in one u64.
        sums_left,
        /// The right eye's.
        sums_right,
        /// Ids where they do not fit one atomic with depths.
        ids_left,
        /// The right eye's.
        ids_right,
        /// Nearest depths.
        depth_left,
        /// The right eye's.
        depth_right,
        /// Sums in four u32.
        wide_left,
        /// The right eye's.
        wide_right,
    }
    /// One eye, from points to its finished pixels.
    Eye, OfEye {
        /// The image.
        resolve,
        /// Tiles to work on.
        tiles,
        /// What lenses hide.
        hidden,
        /// The eye's number, and how far dilation reaches.
        dilate,
        /// Nearest depths, or the keys that they are part of.
        depth,
        /// Depth and id.
        keys,
        /// Ids, or the keys that they are part of.
        ids,
        /// Sums in one u64.
        sums,
        /// Sums in four u32.
        wide,
        /// Pixels before gaps are closed.
        surface,
        /// Eyes and detail.
        view,
        /// Finished colors.
        image_color,
        /// Finished depths.
        image_depth,
    }
    /// What overlays know beside the cloud, of one eye and one chunk.
    Overlay, OfOverlay {
        /// The eye's number.
        dilate,
        /// Finished depths.
        image_depth,
        /// Sums in one u64.
        sums,
        /// Sums in four u32.
        wide,
        /// The chunk's counters.
        counters,
        /// The chunk's batches that are drawn.
        visible,
    }
}

/// What the geometry stages bind.
pub type Geometry = (Cloud, (Chunk, Pixels));
