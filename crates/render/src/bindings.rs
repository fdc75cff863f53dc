//! The one table of the resources that shaders bind: sets of them, by the names that the shaders have for them. A field
//! has the shader's name. Host code fills a set as a struct, so that a resource left out is a build error; a test
//! checks for every variant that each shader finds all of its names in its set (`tests/gpu/shaders/bindings.rs`).
//! Techniques bind resources of their own besides, by name too. A name that ends in [`AGAIN`] is the resource of the
//! name without it, bound a second time as another type.

use wgpu::BindingResource;

/// End of a name for the same resource, bound a second time.
pub const AGAIN: &str = "_again";

/// A set of resources that shaders of one kind may bind. A shader need not bind all of them.
pub trait Set {
    /// The resources.
    type Resources<'a>;

    /// Names of the resources, in order.
    fn names() -> Vec<&'static str>;

    /// The resources in the order of their names.
    fn list(resources: Self::Resources<'_>) -> Vec<BindingResource<'_>>;
}

/// Two sets as one.
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
                /// Fills the set with what `resource` has for each name.
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
        /// Value that the targets are cleared to.
        clear,
        /// The left eye's target.
        left,
        /// The right eye's target.
        right,
        /// Every chunk's counters.
        counters,
    }
    /// The view and the cloud's nodes.
    Cloud, OfCloud {
        /// Eyes and detail.
        view,
        /// The cloud's nodes.
        nodes,
        /// States of the nodes.
        states,
        /// Nodes that `cull` has counted.
        counted,
    }
    /// A chunk of the point pool.
    Chunk, OfChunk {
        /// Place of the chunk in the pool.
        chunk,
        /// The chunk's batches.
        batches,
        /// The chunk's batches that are drawn.
        visible,
        /// The chunk's counters.
        counters,
        /// The coarse bits of coordinates.
        plane_hi,
        /// The middle bits of coordinates.
        plane_mid,
        /// The fine bits of coordinates.
        plane_lo,
        /// The points' own colors.
        colors,
        /// The points' filtered colors.
        filtered_colors,
    }
    /// Both eyes' pixels. A buffer has several names, as each quality sees it.
    Pixels, OfPixels {
        /// The left eye's depths and ids.
        keys_left,
        /// The right eye's depths and ids.
        keys_right,
        /// The left eye's sums in one u64.
        sums_left,
        /// The right eye's sums in one u64.
        sums_right,
        /// The left eye's ids, if they do not fit one atomic with depths.
        ids_left,
        /// The right eye's ids, if they do not fit one atomic with depths.
        ids_right,
        /// The left eye's nearest depths.
        depth_left,
        /// The right eye's nearest depths.
        depth_right,
        /// The left eye's sums in four u32.
        wide_left,
        /// The right eye's sums in four u32.
        wide_right,
    }
    /// One eye, from points to its finished pixels.
    Eye, OfEye {
        /// Size and background of the image.
        resolve,
        /// Tiles to work on.
        tiles,
        /// Mask of the pixels that lenses hide.
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
    /// Resources of overlays beside the cloud, of one eye and one chunk.
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

/// The resources that the geometry stages bind.
pub type Geometry = (Cloud, (Chunk, Pixels));
