//! Which axis of a file points up: by its header, its coordinates, its surfaces, or as the user says. Files are made up.

use crate::PROGRAM;
use crate::bytes::{TOWER, read_bytes, read_bytes_with, tower, world};
use glam::DVec3;
use kit::las_files::save;
use kit::program;
use points::{ReadOptions, Scan, Up};

/// Reads bytes as a file of this name, with this axis up.
fn read_up(name: &str, bytes: &[u8], up: Up) -> Scan {
    read_bytes_with(name, bytes, &ReadOptions { up, ..ReadOptions::AS_FILES_SAY }).unwrap()
}

fn ply(remark: &str, column: &str) -> Vec<u8> {
    let mut text = format!("ply\nformat ascii 1.0\ncomment {remark}\nelement vertex 5\n");
    text += &format!(
        "property float x\nproperty float y\nproperty float z\nproperty float {column}\nend_header\n"
    );
    TOWER.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z} 1\n"));
    text.into_bytes()
}

#[test]
fn files_are_turned_only_where_their_header_leaves_no_doubt_or_the_user_asks() {
    let turned = |bytes: &[u8], up| {
        let scan = read_up("a.ply", bytes, up);
        (scan.bounds().size() != scan.bounds_in_file().size(), scan.warnings.len())
    };
    let zippered = ply("zipper output", "confidence");
    assert_eq!(turned(&zippered, Up::Auto), (true, 1));
    assert_eq!(turned(&zippered, Up::Z), (false, 0));
    assert_eq!(turned(&zippered, Up::Y), (true, 0));
    for remark in [
        "pointcloud saved from Realsense Viewer",
        "VCGLIB generated",
        "zipper",
        "Created in Blender version 4.0",
    ] {
        assert_eq!(turned(&ply(remark, "confidence"), Up::Auto), (false, 0), "{remark}");
    }
    assert_eq!(turned(&ply("zipper output", "scalar"), Up::Auto), (false, 0));
    assert_eq!(turned(&ply("Vertical axis: y", "scalar"), Up::Auto), (true, 1));
    assert_eq!(turned(&ply("Vertical axis: z", "scalar"), Up::Auto), (false, 0));
    assert_eq!(turned(&ply("by hand", "scalar"), Up::MinusY), (true, 0));
    let first = |up| world(&read_up("a.ply", &ply("by hand", "s"), up))[1];
    assert_eq!(first(Up::Z), DVec3::new(10.0, 10.0, 6.0));
    assert_eq!(first(Up::Y), DVec3::new(10.0, -6.0, 10.0));
    assert_eq!(first(Up::MinusY), DVec3::new(10.0, 6.0, -10.0));
}

/// A mesh of a room that stands askew, with a table in it: its file's axes by `in_file`.
fn room(in_file: impl Fn(DVec3) -> DVec3, remark: &str) -> Vec<u8> {
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    let mut block = |low: DVec3, high: DVec3, inside: bool| {
        let first = corners.len();
        corners.extend((0..8).map(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        }));
        for [a, b, c, d] in
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        {
            let face = if inside { [d, c, b, a] } else { [a, b, c, d] };
            faces.push(face.map(|corner| first + corner));
        }
    };
    block(DVec3::ZERO, DVec3::new(6.0, 4.0, 2.5), true);
    block(DVec3::new(1.0, 1.0, 0.0), DVec3::new(2.5, 1.8, 0.7), false);
    let turn = glam::DQuat::from_rotation_z(0.6);
    let (num, num_faces) = (corners.len(), faces.len());
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment {remark}\nelement vertex {num}\nproperty double x\nproperty double y\n"
    );
    text += &format!(
        "property double z\nelement face {num_faces}\nproperty list uchar int vertex_indices\nend_header\n"
    );
    for corner in corners {
        let p = in_file(turn * corner);
        text += &format!("{} {} {}\n", p.x, p.y, p.z);
    }
    faces.iter().for_each(|[a, b, c, d]| text += &format!("4 {a} {b} {c} {d}\n"));
    text.into_bytes()
}

#[test]
fn a_mesh_whose_surfaces_leave_no_doubt_is_turned_unless_its_header_or_the_user_says_otherwise() {
    let y_up = |p: DVec3| DVec3::new(p.x, p.z, -p.y);
    let height = |bytes: &[u8], up| {
        let scan = read_up("room.ply", bytes, up);
        (scan.bounds().size().z, scan.warnings)
    };
    let (z, warnings) = height(&room(y_up, "by hand"), Up::Auto);
    assert!((z - 2.5).abs() < 1e-6, "{z}");
    let told = "room.ply: y is taken for up, since it has a floor and walls only so (cloud.up=z leaves it)";
    assert!(matches!(&warnings[..], [one] if one.ends_with(told)), "{warnings:?}");
    for (bytes, up) in [(room(y_up, "by hand"), Up::Z), (room(y_up, "Vertical axis: z"), Up::Auto)] {
        let (z, warnings) = height(&bytes, up);
        assert!(z > 4.0 && warnings.is_empty(), "{z}: {warnings:?}");
    }
    // A room with z up stays as it is.
    let (z, warnings) = height(&room(|p| p, "by hand"), Up::Auto);
    assert!((z - 2.5).abs() < 1e-6 && warnings.is_empty(), "{z}: {warnings:?}");
}

#[test]
fn a_maps_coordinates_along_x_and_z_mean_y_is_up() {
    let text = |place: fn(DVec3) -> DVec3| {
        let mut text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\nproperty double z\nend_header\n".to_owned();
        for p in tower().map(place) {
            text += &format!("{} {} {}\n", p.x, p.y, p.z);
        }
        text.into_bytes()
    };
    let read = |place| read_bytes("map.ply", &text(place)).unwrap();
    let turned = read(|p| DVec3::new(p.x + 5e5, p.z + 300.0, -p.y - 5e6));
    assert!((turned.bounds().size() - DVec3::new(20.0, 20.0, 6.0)).abs().max_element() < 1e-6);
    assert!(
        turned.bounds().min.y > 4e6 && turned.warnings[0].contains("a map's coordinates"),
        "{:?}",
        turned.warnings
    );
    // These are as surveys have them: in a map's coordinates, in millimeters about a local zero, and far up.
    for place in [
        |p: DVec3| p + DVec3::new(5e5, 5e6, 300.0),
        |p: DVec3| p * 1000.0,
        |p: DVec3| p + DVec3::new(0.0, 0.0, 400_000.0),
    ] {
        let scan = read(place);
        assert_eq!((scan.bounds(), scan.warnings.len()), (scan.bounds_in_file(), 0), "{:?}", scan.warnings);
    }
}

/// Points of houses on their ground, with y up, in a file with a remark.
fn houses(remark: &str) -> Vec<u8> {
    let num = 3000;
    let mut text = format!("ply\nformat ascii 1.0\ncomment {remark}\nelement vertex {num}\n");
    text += "property float x\nproperty float y\nproperty float z\nend_header\n";
    for at in 0..num {
        let [u, v] = [0.754_877_666, 0.569_840_291].map(|step| (f64::from(at) * step).fract());
        let [x, y, z] = match at % 4 {
            0 | 2 => [60.0 * u, 0.0, 40.0 * v],
            1 => [20.0 + 10.0 * u, 8.0, 10.0 + 10.0 * v],
            _ => [20.0 + 10.0 * u, 8.0 * v, 20.0],
        };
        text += &format!("{x} {y} {z}\n");
    }
    text.into_bytes()
}

#[test]
fn points_that_may_lie_on_their_side_are_not_turned_but_it_is_said() {
    let warnings = |remark, up| {
        let scan = read_up("houses.ply", &houses(remark), up);
        let is_turned = scan.bounds().size() != scan.bounds_in_file().size();
        (is_turned, scan.warnings)
    };
    let (is_turned, said) = warnings("by hand", Up::Auto);
    let end = "lie on their side, --set cloud.up=y stands them upright";
    assert!(!is_turned && matches!(&said[..], [one] if one.ends_with(end)), "{said:?}");
    // A user or file that has said what is up needs no hint.
    for (remark, up) in [("by hand", Up::Z), ("by hand", Up::Y), ("Vertical axis: z", Up::Auto)] {
        let (_, said) = warnings(remark, up);
        assert!(said.is_empty(), "{remark} {up:?}: {said:?}");
    }
    let (_folder, path) = save("houses.ply", &houses("by hand"));
    let info = program::run(program::command(PROGRAM).arg("info").arg(path));
    assert!(info.text().contains(end));
}
