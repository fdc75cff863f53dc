//! Where the eyes' images lie in the window. Everything is in physical pixels, with (0, 0) at the top left and y
//! down.

use super::MirroredEyes;

/// A rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PixelRect {
    /// Left edge.
    pub x: f32,
    /// Top edge.
    pub y: f32,
    /// Width.
    pub width: f32,
    /// Height.
    pub height: f32,
}

/// Place of one eye's image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pane {
    /// 0 for the left eye, 1 for the right.
    pub eye: usize,
    /// The part of the window that it may paint; whole pixels.
    pub clip: PixelRect,
    /// Where the whole image would lie; larger than `clip` where the image is cropped.
    pub image: PixelRect,
}

/// What gives way where image and area differ in shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fit {
    /// The image covers the area; its parts outside are cropped.
    Cover,
    /// The whole image is seen; bars stay empty.
    Whole,
}

/// The panes of a window: one eye covers it, as headset mirrors do; two stand side by side, each whole.
/// `longest_px` is the longest edge that the GPU's viewport may have.
pub(super) fn panes(
    mirror: MirroredEyes,
    images_px: [[u32; 2]; 2],
    window_px: [u32; 2],
    longest_px: u32,
) -> Vec<Pane> {
    let [width, height] = window_px.map(|edge| edge as f32);
    let pane = |eye: usize, clip: PixelRect, fit: Fit| {
        let covering = fitted(images_px[eye], clip, fit);
        let image = if covering.width.max(covering.height) > longest_px as f32 {
            fitted(images_px[eye], clip, Fit::Whole)
        } else {
            covering
        };
        Pane { eye, clip, image }
    };
    let window = PixelRect { x: 0.0, y: 0.0, width, height };
    let half = (width / 2.0).floor();
    match mirror {
        MirroredEyes::Left => vec![pane(0, window, Fit::Cover)],
        MirroredEyes::Right => vec![pane(1, window, Fit::Cover)],
        MirroredEyes::Both => vec![
            pane(0, PixelRect { width: half, ..window }, Fit::Whole),
            pane(1, PixelRect { x: half, width: width - half, ..window }, Fit::Whole),
        ],
    }
}

/// The eye whose image is seen at a place of the window, and where in the image that is: fractions of its width from the left
/// and of its height from the top.
pub(super) fn seen_at(panes: &[Pane], [x, y]: [f64; 2]) -> Option<(usize, [f64; 2])> {
    let within = |rect: &PixelRect| {
        let at = [
            (x - f64::from(rect.x)) / f64::from(rect.width),
            (y - f64::from(rect.y)) / f64::from(rect.height),
        ];
        at.iter().all(|at| (0.0..1.0).contains(at)).then_some(at)
    };
    panes.iter().find_map(|pane| within(&pane.clip).and_then(|_| Some((pane.eye, within(&pane.image)?))))
}

/// The image's rectangle around the middle of `area`, its shape kept. The corner lies on a whole pixel, so
/// that an image of the area's own size is copied pixel by pixel.
fn fitted(image_px: [u32; 2], area: PixelRect, fit: Fit) -> PixelRect {
    let [width, height] = image_px.map(|edge| edge.max(1) as f32);
    let (across, down) = (area.width / width, area.height / height);
    let scale = if fit == Fit::Cover { across.max(down) } else { across.min(down) };
    let (width, height) = (width * scale, height * scale);
    PixelRect {
        x: (area.x + (area.width - width) / 2.0).round(),
        y: (area.y + (area.height - height) / 2.0).round(),
        width,
        height,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const EYE: [u32; 2] = [960, 1080];
    const LONGEST: u32 = 16_384;

    fn only(mirror: MirroredEyes, images: [[u32; 2]; 2], window: [u32; 2]) -> Pane {
        let all = panes(mirror, images, window, LONGEST);
        assert_eq!(all.len(), 1);
        all[0]
    }

    #[test]
    fn a_place_of_the_window_is_one_of_an_image() {
        let both = panes(MirroredEyes::Both, [EYE; 2], [2000, 1000], LONGEST);
        // Each half has the whole image, 888.9 × 1000, in its middle.
        let at = |x, y| seen_at(&both, [x, y]);
        let (eye, [across, down]) = at(500.0, 250.0).expect("the left eye");
        assert!(eye == 0 && (across - 0.5).abs() < 1e-3 && (down - 0.25).abs() < 1e-3);
        assert_eq!(at(1500.0, 500.0).map(|(eye, _)| eye), Some(1));
        assert_eq!([at(10.0, 500.0), at(990.0, 500.0), at(1500.0, 1000.0)], [None; 3], "bars, and below");
        let left = panes(MirroredEyes::Left, [EYE; 2], [960, 540], LONGEST);
        // The image covers the window, so its upper and lower quarters are cropped.
        assert_eq!(seen_at(&left, [0.0, 0.0]), Some((0, [0.0, 0.25])));
    }

    #[test]
    fn an_image_of_the_windows_size_is_copied() {
        let pane = only(MirroredEyes::Left, [EYE; 2], EYE);
        assert_eq!(pane.image, PixelRect { x: 0.0, y: 0.0, width: 960.0, height: 1080.0 });
    }

    #[test]
    fn one_eye_covers_a_wide_window_and_is_cropped_above_and_below() {
        let pane = only(MirroredEyes::Right, [[1, 1], EYE], [1280, 720]);
        assert_eq!(pane.eye, 1);
        assert_eq!(pane.image, PixelRect { x: 0.0, y: -360.0, width: 1280.0, height: 1440.0 });
    }

    #[test]
    fn both_eyes_are_whole_and_side_by_side() {
        let both = panes(MirroredEyes::Both, [EYE; 2], [1281, 720], LONGEST);
        assert_eq!([both[0].eye, both[1].eye], [0, 1]);
        assert_eq!([both[0].clip.width, both[1].clip.width], [640.0, 641.0]);
        assert_eq!(both[0].image, PixelRect { x: 0.0, y: 0.0, width: 640.0, height: 720.0 });
        assert_eq!(both[1].image.x, 641.0, "the spare pixel is split evenly, rounded");
    }

    #[test]
    fn a_crop_beyond_the_gpus_viewport_becomes_whole() {
        let sliver = panes(MirroredEyes::Left, [EYE; 2], [16_000, 100], LONGEST);
        assert!(sliver[0].image.height <= 100.0);
    }

    proptest! {
        #[test]
        fn shapes_are_kept_and_areas_covered_or_kept_within(
            image in prop::array::uniform2(1u32..5000),
            window in prop::array::uniform2(2u32..5000),
            mirror in prop::sample::select(vec![MirroredEyes::Left, MirroredEyes::Right, MirroredEyes::Both]),
        ) {
            for Pane { clip, image: placed, .. } in panes(mirror, [image; 2], window, u32::MAX) {
                let shape = image[0] as f32 / image[1] as f32;
                prop_assert!((placed.width / placed.height / shape - 1.0).abs() < 1e-3);
                // The corner is rounded by up to half a pixel.
                let covers = placed.x <= clip.x + 0.51
                    && placed.y <= clip.y + 0.51
                    && placed.x + placed.width >= clip.x + clip.width - 0.51
                    && placed.y + placed.height >= clip.y + clip.height - 0.51;
                let within = placed.width <= clip.width * 1.001 && placed.height <= clip.height * 1.001;
                let kept = if mirror == MirroredEyes::Both { within } else { covers };
                prop_assert!(kept, "{placed:?} in {clip:?}");
            }
        }
    }
}
