//! A frame drawn into a part of its images is the frame of images of that size, and drawing into the whole again
//! leaves nothing of the part.

use base::space::{Eye, Fov, Pose, View};
use glam::DVec3;
use kit::frames::{Canvas, cloud_of, draw, plain, random_points};
use lab::order::Order;

const FULL_PX: [u32; 2] = [101, 67];
const PART_PX: [u32; 2] = [60, 40];

fn view(center: DVec3, size_px: [u32; 2]) -> View {
    let eye = |x: f64| Eye {
        world_from_view: Pose::look_at(center + DVec3::new(x, -14.0, 3.0), center, DVec3::Z),
        fov: Fov::symmetric(1.0, 1.5),
        size_px,
        gaze_in_view: Eye::AHEAD,
    };
    View { eyes: vec![eye(-0.3), eye(0.3)], near: 0.05 }
}

/// The top left `part_px` of an image that is `width` wide.
fn top_left(pixels: &[u32], width: u32, part_px: [u32; 2]) -> Vec<u32> {
    let rows = pixels.chunks_exact(width as usize).take(part_px[1] as usize);
    rows.flat_map(|row| row[..part_px[0] as usize].to_vec()).collect()
}

#[test]
fn a_part_is_drawn_like_a_small_image() {
    let cloud = cloud_of(&random_points(50_000, 10.0, 4), 0.001, DVec3::ZERO, Order::Morton);
    let center = cloud.bounds.center();
    let [small, whole] =
        [PART_PX, FULL_PX].map(|size_px| draw(&cloud, &view(center, size_px), false, 0).images);

    let mut canvas = Canvas::flat(&cloud, &view(center, FULL_PX), plain(false), 0);
    let mut drawn = |size_px: [u32; 2]| -> Vec<Vec<u32>> {
        canvas.renderer.set_drawn(&[size_px; 2]);
        canvas.draw(&view(center, size_px)).images
    };
    assert!(drawn(FULL_PX) == whole);
    let part = drawn(PART_PX);
    for eye in 0..2 {
        assert!(top_left(&part[eye], FULL_PX[0], PART_PX) == small[eye], "eye {eye}");
        // The comparison can fail: the whole view is in the part, not a corner of it.
        assert!(top_left(&whole[eye], FULL_PX[0], PART_PX) != small[eye], "eye {eye}");
    }
    assert!(drawn(FULL_PX) == whole);
}
