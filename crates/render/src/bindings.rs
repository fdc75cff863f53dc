//! The one table of the resources that shaders bind: sets of them, by the names that the shaders have for them. A field
//! has the shader's name. Host code fills a set as a struct, so that a resource left out is a build error; a test
//! checks for every variant that each shader finds all of its names in its set (`tests/gpu/shaders/bindings.rs`).
//! Techniques make sets of their own for their own shaders ([`crate::sets`]). What the frame's shaders bind besides for a
//! technique is in the set [`OtherSet`].

pub use wgpu::BindingResource;

/// A set of resources that shaders of one kind may bind. A shader need not bind all of them.
pub trait Set {
    /// True if [`OtherSet`] are among them.
    const HAS_OTHERS: bool;

    /// The resources.
    type Resources<'a>;

    /// Names of the resources, except those of [`OtherSet`].
    fn names() -> Vec<&'static str>;

    /// The resource of this name.
    fn find<'a>(resources: &Self::Resources<'a>, name: &str) -> Option<BindingResource<'a>>;
}

/// Two sets as one.
impl<A: Set, B: Set> Set for (A, B) {
    const HAS_OTHERS: bool = A::HAS_OTHERS || B::HAS_OTHERS;

    type Resources<'a> = (A::Resources<'a>, B::Resources<'a>);

    fn names() -> Vec<&'static str> {
        [A::names(), B::names()].concat()
    }

    fn find<'a>((a, b): &Self::Resources<'a>, name: &str) -> Option<BindingResource<'a>> {
        A::find(a, name).or_else(|| B::find(b, name))
    }
}

/// The resources of a technique and of its clouds, by names of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OtherSet {}

/// The resources of [`OtherSet`].
#[derive(Clone, Debug)]
pub struct OfOthers<'a>(pub(crate) Vec<(&'static str, BindingResource<'a>)>);

impl Set for OtherSet {
    const HAS_OTHERS: bool = true;

    type Resources<'a> = OfOthers<'a>;

    fn names() -> Vec<&'static str> {
        vec![]
    }

    fn find<'a>(resources: &Self::Resources<'a>, name: &str) -> Option<BindingResource<'a>> {
        resources.0.iter().find(|(own, _)| *own == name).map(|(_, resource)| resource.clone())
    }
}

/// Makes sets of resources, each with a struct that has a field for each name.
#[macro_export]
macro_rules! sets {
    ($($(#[$about:meta])* $set:ident, $of:ident { $($(#[$what:meta])* $name:ident,)+ })+) => {
        $(
            $(#[$about])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub enum $set {}

            #[doc = concat!("The resources of [`", stringify!($set), "`].")]
            #[derive(Clone, Debug)]
            pub struct $of<'a> {
                $($(#[$what])* pub $name: $crate::bindings::BindingResource<'a>,)+
            }

            impl<'a> $of<'a> {
                /// Fills the set with what `resource` has for each name.
                pub fn by_name(mut resource: impl FnMut(&'static str) -> $crate::bindings::BindingResource<'a>) -> Self {
                    Self { $($name: resource(stringify!($name)),)+ }
                }
            }

            impl $crate::bindings::Set for $set {
                const HAS_OTHERS: bool = false;

                type Resources<'a> = $of<'a>;

                fn names() -> Vec<&'static str> {
                    vec![$(stringify!($name)),+]
                }

                fn find<'a>(
                    resources: &Self::Resources<'a>,
                    name: &str,
                ) -> Option<$crate::bindings::BindingResource<'a>> {
                    match name {
                        $(stringify!($name) => Some(resources.$name.clone()),)+
                        _ => None,
                    }
                }
            }
        )+
    };
}

sets! {
    /// A pair of targets to clear.
    ClearSet, OfClear {
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
    CloudSet, OfCloud {
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
    ChunkSet, OfChunk {
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
    PixelSet, OfPixels {
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
    EyeSet, OfEye {
        /// Size and background of the image.
        resolve,
        /// Tiles to work on.
        tiles,
        /// Mask of the pixels that lenses hide.
        hidden,
        /// The eye's number.
        dilate,
        /// Nearest depths, or the keys that they are part of.
        depth,
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
    OverlaySet, OfOverlay {
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
    /// What is seen beside the scan.
    ScenerySet, OfScenery {
        /// What an eye's scenery is drawn with.
        scenery,
        /// Finished depths.
        image_depth,
        /// The card's picture.
        card,
        /// How the card's picture is looked up.
        card_sampler,
    }
}

/// The resources that passes over a chunk's batches bind.
pub type BatchSet = (CloudSet, (ChunkSet, OtherSet));
/// The resources of [`BatchSet`].
pub type OfBatches<'a> = (OfCloud<'a>, (OfChunk<'a>, OfOthers<'a>));
/// The resources that the geometry stages bind.
pub type GeometrySet = (BatchSet, PixelSet);
