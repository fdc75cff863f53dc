//! Meshes: triangles and discs in one picture, against their CPU references, against rays, and far and near.

use base::space::View;
use base::task::Progress;
use cloud::spt::SequentialCloud;
use glam::DVec3;
use kit::frames::{Canvas, difference, discs, gpu, hqs, mono, octree_of, scan_of, spt_of, stereo, tiers};
use kit::picture::write_png;
use kit::quality::picture::EyePicture;
use lab::reference::{self, ReferenceCloud, ReferenceFrame};
use lab::technique::tree::VISIBLE_TRIANGLES;
use lab::technique::{LabTechnique, Method};
use points::Scan;
use render::DrawOptions;
use render::layout::depth_of;
use render::options::{Dilate, Quality};
use std::path::Path;
use std::sync::OnceLock;

const OFFSET: DVec3 = DVec3::new(5e5, 4e6, 100.0);
/// Radius of the bumpy ball.
const RADIUS: f64 = 5.0;
/// Height of the ball's bumps.
const BUMP: f64 = 0.2;

/// A ball with bumps and colors, cut into `rings` rings of twice as many quads, the poles closed by triangles.
fn bumpy_ball(rings: u32) -> Scan {
    let columns = 2 * rings;
    let mut xyz = Vec::new();
    let mut rgb = Vec::new();
    let mut add = |polar: f64, round: f64| {
        let bump = (7.0 * polar).sin() * (9.0 * round).cos();
        let direction = DVec3::new(polar.sin() * round.cos(), polar.sin() * round.sin(), polar.cos());
        xyz.push(((RADIUS + BUMP * bump) * direction * 1e4).round().to_array().map(|v| v as i32));
        let c = |v: f64| (127.5 + 127.0 * v) as u16;
        rgb.push([c(bump), c((3.0 * round).sin()), c((40.0 * polar).sin() * (40.0 * round).sin())]);
    };
    let angle = |i: u32, n: u32| f64::from(i) / f64::from(n) * std::f64::consts::PI;
    for ring in 1..rings {
        (0..columns).for_each(|column| add(angle(ring, rings), angle(2 * column, columns)));
    }
    add(0.0, 0.0);
    add(std::f64::consts::PI, 0.0);
    let at = |ring: u32, column: u32| (ring - 1) * columns + column % columns;
    let poles = [xyz.len() as u32 - 2, xyz.len() as u32 - 1];
    let mut triangles = Vec::new();
    for column in 0..columns {
        triangles.push([poles[0], at(1, column), at(1, column + 1)]);
        triangles.push([poles[1], at(rings - 1, column + 1), at(rings - 1, column)]);
        for ring in 1..rings - 1 {
            let [a, b] = [at(ring, column), at(ring, column + 1)];
            let [c, d] = [at(ring + 1, column), at(ring + 1, column + 1)];
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    let mut scan = scan_of(&xyz, 1e-4, OFFSET);
    scan.files[0].points.rgb = rgb;
    scan.files[0].triangles = triangles;
    scan
}

/// The ball, its triangles about 6 cm large, and a cloud of points beside it in a file without triangles.
fn ball_and_points() -> &'static SequentialCloud {
    static SPT: OnceLock<SequentialCloud> = OnceLock::new();
    SPT.get_or_init(|| {
        let mut scan = bumpy_ball(120);
        let points = kit::frames::random_points(20_000, 4.0, 5);
        scan.files.extend(scan_of(&points, 0.001, OFFSET + DVec3::X * 6.0).files);
        spt_of(&scan, false)
    })
}

/// A view from this distance to the ball's center.
fn view_at(distance: f64, size_px: [u32; 2]) -> View {
    stereo(OFFSET + distance * DVec3::new(-0.6, -0.7, 0.4).normalize(), OFFSET, size_px)
}

/// Numbers of visible batches of triangles, and of discs.
fn num_batches(frame: &ReferenceFrame) -> (usize, usize) {
    let is_mesh = |flags: u32| flags & VISIBLE_TRIANGLES != 0;
    let num_meshes = frame.visible.iter().filter(|batch| is_mesh(batch.flags)).count();
    (num_meshes, frame.visible.len() - num_meshes)
}

fn closest() -> DrawOptions {
    DrawOptions { quality: Quality::Closest, ..hqs(discs()) }
}

#[test]
fn frames_equal_their_reference_in_every_tier() {
    let spt = ball_and_points();
    // The views are close to the surface, with all of it in sight, and from within, where triangles reach behind the
    // eyes.
    for (distance, size_px, error_px) in
        [(5.4, [151, 149], 1.0), (16.0, [301, 299], 0.7), (5.01, [97, 83], 4.0)]
    {
        let view = view_at(distance, size_px);
        let scene = ReferenceCloud::sequential(spt, error_px);
        for (quality, dilate) in
            [(Quality::Closest, Dilate::Off), (Quality::Hqs, Dilate::Off), (Quality::Hqs, Dilate::Rings)]
        {
            let options = DrawOptions { quality, dilate, ..hqs(discs()) };
            let want = reference::frame(&scene, &view, &options, None);
            let (num_meshes, num_discs) = num_batches(&want);
            assert!(num_meshes > 10 && num_discs > 0, "{num_meshes} and {num_discs}");
            for tier in tiers() {
                let drawn = Canvas::sequential(spt, error_px, &view, options, tier, 0).draw(&view);
                assert_eq!(difference(&drawn, &want), None, "{distance} {quality:?}, {dilate:?}, {tier:?}");
            }
        }
    }
}

/// The comparison can fail: it sees a corner, a size, a color, a place.
#[test]
fn the_comparison_notices_what_is_wrong() {
    let spt = ball_and_points();
    let view = view_at(14.0, [201, 199]);
    let options = hqs(discs());
    let drawn = Canvas::sequential(spt, 1.0, &view, options, gpu().atomics(), 0).draw(&view);
    let triangles = spt.runs.last().expect("a run").batches.clone();
    let first = spt.cloud.batches[triangles.start as usize].first_point as usize;
    let differs = |change: &dyn Fn(&mut SequentialCloud)| {
        let mut wrong = spt.clone();
        change(&mut wrong);
        difference(&drawn, &reference::frame(&ReferenceCloud::sequential(&wrong, 1.0), &view, &options, None))
            .is_some()
    };
    let words = |change: fn(u32) -> u32| {
        move |spt: &mut SequentialCloud| {
            spt.shapes[first..].iter_mut().filter(|word| **word != 0).for_each(|word| *word = change(*word));
        }
    };
    assert!(!differs(&|_| ()));
    assert!(differs(&words(|word| word & 0xffff_ff00 | word >> 8 & 255)), "corners");
    assert!(differs(&words(|word| word - (8 << 24))), "sizes");
    assert!(differs(&|spt| spt.cloud.colors[first..].iter_mut().for_each(|color| *color ^= 8)), "colors");
    assert!(
        differs(&|spt| spt.cloud.planes[1][first..].iter_mut().for_each(|word| *word ^= 1 << 8)),
        "places"
    );
}

/// A rectangle of two triangles in the plane y = `away`, in meters from the offset, with corners of one color.
fn wall(x: [f64; 2], z: [f64; 2], away: f64) -> SequentialCloud {
    let at = |x: f64, z: f64| DVec3::new(x, away, z) * 1e4;
    let corners = [at(x[0], z[0]), at(x[1], z[0]), at(x[1], z[1]), at(x[0], z[1])];
    let mut scan = scan_of(&corners.map(|p| p.round().to_array().map(|v| v as i32)), 1e-4, OFFSET);
    scan.files[0].points.rgb = vec![[200, 100, 50]; 4];
    scan.files[0].triangles = vec![[0, 1, 2], [0, 2, 3]];
    spt_of(&scan, false)
}

/// Depth of each pixel of an eye at the offset that looks along +y, 90 degrees wide, from its ray and the wall. It is
/// infinite beside the wall, and NaN where the pixel's center lies too close to an edge to tell.
fn rays(x: [f64; 2], z: [f64; 2], away: f64, [width, height]: [u32; 2]) -> Vec<f64> {
    let tangent = |i: u32, n: u32| (2.0 * f64::from(i) + 1.0) / f64::from(n) - 1.0;
    let pixels = (0..height).flat_map(|v| (0..width).map(move |u| (u, v)));
    let of_pixel = |(u, v)| {
        let (px, pz) = (away * tangent(u, width), -away * tangent(v, height));
        // The doubt is two slacks of a pixel.
        let doubt = away * 2.0 / f64::from(width) / 32.0;
        let inside = |p: f64, range: [f64; 2]| (p - range[0]).min(range[1] - p);
        match inside(px, x).min(inside(pz, z)) {
            reach if reach > doubt => away,
            reach if reach < -doubt => f64::INFINITY,
            _ => f64::NAN,
        }
    };
    pixels.map(of_pixel).collect()
}

/// Number of pixels that are not as the rays say.
fn num_wrong(frame: &ReferenceFrame, rays: &[f64]) -> usize {
    let wrong = |(pixel, &ray): (&[u32; 2], &f64)| {
        let depth = f64::from(depth_of(*pixel));
        if ray.is_finite() { (depth - ray).abs() > 1e-5 * ray } else { ray > 0.0 && depth != ray }
    };
    frame.pixels[0].iter().zip(rays).filter(|&pair| wrong(pair)).count()
}

#[test]
fn a_wall_of_two_triangles_fills_its_pixels_exactly() {
    let size_px = [180, 140];
    let view = mono(OFFSET, OFFSET + DVec3::Y, 1.0, size_px);
    for (x, z, away) in [
        ([-1.234, 0.567], [-0.43, 1.01], 2.0),
        ([-50.0, 60.0], [-70.0, 80.0], 3.0),
        ([-0.013, 0.021], [-0.017, 0.011], 0.1),
        ([0.003, 4.0], [0.5217, 0.5497], 5.0),
    ] {
        let spt = wall(x, z, away);
        for options in [closest(), hqs(discs())] {
            let want = reference::frame(&ReferenceCloud::sequential(&spt, 1.0), &view, &options, None);
            let rays = rays(x, z, away, size_px);
            assert!(rays.iter().any(|ray| ray.is_finite()), "something is seen");
            assert_eq!(num_wrong(&want, &rays), 0, "{x:?} {z:?} {away}");
            let beside = self::rays(x, [z[0] + 0.1 * away, z[1] + 0.1 * away], away, size_px);
            assert!(away == 3.0 || num_wrong(&want, &beside) > 0, "the measure sees a shift");
            let drawn = Canvas::sequential(&spt, 1.0, &view, options, gpu().atomics(), 0).draw(&view);
            assert_eq!(difference(&drawn, &want), None);
            let is_plain = |p: &[u32; 2]| p[0] == u32::MAX || p[1] == u32::from_le_bytes([200, 100, 50, 255]);
            assert!(want.pixels[0].iter().all(is_plain), "a mixture of one color is that");
        }
    }
}

/// A floor of two triangles reaches far behind the eye: each pixel below the horizon has its depth.
#[test]
fn triangles_cross_the_near_plane() {
    let corners = [[-400_000, -300_000], [500_000, -400_000], [600_000, 700_000], [-300_000, 500_000]];
    let mut scan = scan_of(&corners.map(|[x, y]| [x, y, 0]), 1e-4, OFFSET);
    scan.files[0].triangles = vec![[0, 1, 2], [0, 2, 3]];
    let spt = spt_of(&scan, false);
    let (size_px, height) = ([161, 120], 1.7);
    let eye = OFFSET + DVec3::Z * height;
    let view = mono(eye, eye + DVec3::Y, 1.0, size_px);
    let options = closest();
    let want = reference::frame(&ReferenceCloud::sequential(&spt, 1.0), &view, &options, None);
    let drawn = Canvas::sequential(&spt, 1.0, &view, options, gpu().atomics(), 0).draw(&view);
    assert_eq!(difference(&drawn, &want), None);
    let mut num_floor = 0;
    for v in 0..size_px[1] {
        let down = (2.0 * f64::from(v) + 1.0) / f64::from(size_px[1]) - 1.0;
        for u in 0..size_px[0] {
            let depth = f64::from(depth_of(want.pixels[0][(v * size_px[0] + u) as usize]));
            // A triangle is as deep beyond its edges as at them.
            let (ray, slack) = (height / down, 2.0 / f64::from(size_px[1]) / 64.0 / down);
            if down < 0.0 {
                assert_eq!(depth, f64::INFINITY, "{u} {v}");
            } else if ray < 25.0 {
                assert!((depth - ray).abs() < (1e-4 + 2.0 * slack) * ray, "{u} {v}: {depth}, not {ray}");
                num_floor += 1;
            }
        }
    }
    assert!(num_floor > 6000, "{num_floor}");
    let behind = mono(eye, eye + DVec3::Z, 1.0, size_px);
    let away = reference::frame(&ReferenceCloud::sequential(&spt, 1.0), &behind, &options, None);
    assert!(away.pixels[0].iter().all(|pixel| pixel[0] == u32::MAX), "nothing is seen behind");
}

/// Half the field of view of pictures of the whole ball.
const TANGENT: f64 = 0.2;

/// Numbers of pixels within the ball's outline, and of those that show nothing, or something behind the center.
fn holes(frame: &ReferenceFrame, distance: f64, size_px: [u32; 2]) -> (usize, usize) {
    let inner = (RADIUS - BUMP) / (distance * distance - RADIUS * RADIUS).sqrt();
    let center = |i: usize, n: u32| (2.0 * i as f64 + 1.0) / f64::from(n) - 1.0;
    let (mut num_inside, mut num_holes) = (0, 0);
    for (i, pixel) in frame.pixels[0].iter().enumerate() {
        let (u, v) =
            (center(i % size_px[0] as usize, size_px[0]), center(i / size_px[0] as usize, size_px[1]));
        if TANGENT * (u * u + v * v).sqrt() < 0.98 * inner {
            num_inside += 1;
            num_holes += usize::from(f64::from(depth_of(*pixel)) > distance);
        }
    }
    (num_inside, num_holes)
}

/// Keeps a picture for people.
fn keep(name: &str, image: &[u32], size_px: [u32; 2]) {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    write_png(&path, size_px, &EyePicture::of_colors(size_px, image.iter().copied()).rgb).expect("a picture");
}

/// All triangles are drawn near by, all discs far away, and there is no hole on the way from one to the other.
#[test]
fn the_transition_has_no_holes() {
    let spt = spt_of(&bumpy_ball(160), false);
    let size_px = [240, 240];
    let mut num_mixed = 0;
    for step in 0..28 {
        let distance = 14.0 * 1.1f64.powi(step);
        let from = DVec3::new(-0.6, -0.7, 0.4).normalize();
        let view = mono(OFFSET + distance * from, OFFSET, TANGENT, size_px);
        for error_px in [1.0, 3.0] {
            let frame =
                reference::frame(&ReferenceCloud::sequential(&spt, error_px), &view, &hqs(discs()), None);
            let (num_inside, num_holes) = holes(&frame, distance, size_px);
            let (num_meshes, num_discs) = num_batches(&frame);
            println!(
                "{distance:.1} m, {error_px} px: {num_meshes} batches of triangles, {num_discs} of discs, {num_holes} holes in {num_inside}"
            );
            assert_eq!(num_holes, 0, "{distance} m, {error_px} px");
            num_mixed += usize::from(num_meshes > 0 && num_discs > 0);
            if error_px == 1.0 {
                keep(&format!("ball-{step:02}.png"), &frame.images[0], size_px);
            }
        }
    }
    assert!(num_mixed > 5);
    let ends = [8.0, 200.0].map(|distance| {
        let view = mono(OFFSET - distance * DVec3::Y, OFFSET, TANGENT, size_px);
        num_batches(&reference::frame(&ReferenceCloud::sequential(&spt, 1.0), &view, &hqs(discs()), None))
    });
    assert!(ends[0].0 > 0 && ends[0].1 == 0, "near: {ends:?}");
    assert!(ends[1].0 == 0 && ends[1].1 > 0, "far: {ends:?}");
}

/// The cells of a flat sheet grow from millimeters to half a meter, each way by itself: many are eighty times as long
/// as wide.
#[test]
fn uneven_sheets_have_no_holes() {
    let edge = 60;
    let at = |i: i32| i * i * 40;
    let xyz: Vec<[i32; 3]> = (0..edge * edge).map(|i| [at(i % edge), 0, at(i / edge)]).collect();
    let mut scan = scan_of(&xyz, 1e-4, OFFSET);
    let cells = (0..(edge - 1) * (edge - 1)).map(|i| (i / (edge - 1) * edge + i % (edge - 1)) as u32);
    let (across, up) = (1, edge as u32);
    scan.files[0].triangles =
        cells.flat_map(|a| [[a, a + across, a + up + across], [a, a + up + across, a + up]]).collect();
    let spt = spt_of(&scan, false);
    let (size_px, size) = ([240, 240], f64::from(at(edge - 1)) * 1e-4);
    let center = OFFSET + DVec3::new(0.5 * size, 0.0, 0.5 * size);
    for step in 0..12 {
        let distance = 15.0 * 1.4f64.powi(step);
        let view = mono(center - DVec3::Y * distance, center, TANGENT, size_px);
        for error_px in [1.0, 3.0] {
            let frame =
                reference::frame(&ReferenceCloud::sequential(&spt, error_px), &view, &hqs(discs()), None);
            let half = 0.97 * 0.5 * size / distance / TANGENT;
            let inside = |i: usize| ((2.0 * i as f64 + 1.0) / 240.0 - 1.0).abs() < half;
            let pixels =
                frame.pixels[0].iter().enumerate().filter(|(i, _)| inside(i % 240) && inside(i / 240));
            let num_inside = pixels.clone().count();
            let num_holes = pixels.filter(|(_, pixel)| pixel[0] == u32::MAX).count();
            assert!(num_inside > 100);
            assert_eq!(num_holes, 0, "{distance} m, {error_px} px, of {num_inside} pixels");
        }
    }
}

/// Discs that are drawn from the triangles' sizes on but no wider than a pixel leave holes, which are noticed.
#[test]
fn holes_are_noticed() {
    let mut spt = spt_of(&bumpy_ball(160), false);
    let first = spt.cloud.batches[spt.runs[0].batches.end as usize].first_point as usize;
    spt.shapes[..first].iter_mut().for_each(|shape| *shape &= 0xffff);
    let size_px = [240, 240];
    let num_holes = [20.0, 30.0, 40.0, 60.0].map(|distance| {
        let view = mono(OFFSET - distance * DVec3::Y, OFFSET, TANGENT, size_px);
        holes(
            &reference::frame(&ReferenceCloud::sequential(&spt, 3.0), &view, &hqs(discs()), None),
            distance,
            size_px,
        )
        .1
    });
    assert!(num_holes.iter().any(|&num| num > 100), "{num_holes:?}");
}

/// Every method draws triangles too, also those whose threads come to a pixel together. Hardware points have no size,
/// so point trees are refused to them.
#[test]
fn methods_draw_meshes_too() {
    let spt = ball_and_points();
    let view = view_at(7.0, [97, 83]);
    for quality in [Quality::Closest, Quality::Hqs] {
        let draw = |method: Method| {
            // Threads that ask each other must all have the same number of pixels.
            let detail = render::layout::Detail { fill_reach_px: None, ..discs() };
            let options = DrawOptions { quality, ..hqs(detail) };
            let technique = LabTechnique { method, ..LabTechnique::tree(1.0) };
            Canvas::sequential_by(technique, spt, &view, options, gpu().atomics(), 0).draw(&view)
        };
        let reference = draw(Method::Prefetch);
        let of_points = |m: &Method| *m == Method::PointList || m.quality().is_some_and(|q| q != quality);
        for method in Method::ALL.into_iter().filter(|method| !of_points(method)) {
            let drawn = draw(method);
            if method == Method::Fixed40 {
                // The triangle with the smaller color stays where triangles meet in a pixel.
                let same = drawn.images[0].iter().zip(&reference.images[0]).filter(|(a, b)| a == b).count();
                assert!(same * 100 > drawn.images[0].len() * 99, "{same}");
            } else if !method.shows_the_last() {
                assert!(drawn.pixels == reference.pixels, "{} {quality:?}", method.name());
            }
        }
    }
}

#[test]
fn hardware_points_are_no_discs() {
    let mut technique = LabTechnique::method(Method::PointList);
    assert!(technique.check(&gpu(), gpu().atomics()).is_ok());
    technique.error_px = Some(1.0);
    let refusal = technique.check(&gpu(), gpu().atomics()).expect_err("discs have sizes").to_string();
    assert!(refusal.contains("point-list") && refusal.contains("discs"), "{refusal}");
}

/// Ways to draw that show only points show those of meshes as any others.
#[test]
fn flat_clouds_and_octrees_show_a_meshs_points() {
    let mesh = bumpy_ball(20);
    let mut points = mesh.clone();
    points.files[0].triangles.clear();
    let flat = |scan: &Scan| cloud::build(scan, &Progress::hidden()).expect("a cloud");
    assert_eq!(flat(&mesh).planes, flat(&points).planes);
    assert_eq!(octree_of(&mesh).cloud.planes, octree_of(&points).cloud.planes);
}

/// The sides of triangles are known: discs at the back are not read then, and the picture stays.
#[test]
fn backs_of_meshes_are_culled() {
    let scan = bumpy_ball(300);
    let (plain, sided) = (spt_of(&scan, false), spt_of(&scan, true));
    let view = view_at(40.0, [400, 400]);
    let options = hqs(discs());
    let frames = [&plain, &sided]
        .map(|spt| reference::frame(&ReferenceCloud::sequential(spt, 1.0), &view, &options, None));
    let [all, front] = frames.each_ref().map(ReferenceFrame::points_read);
    println!("{front} of {all} points read");
    assert!(10 * front < 8 * all, "{front} of {all}");
    assert_eq!(frames.each_ref().map(|frame| num_batches(frame).0), [0, 0]);
}

/// Two triangles that fill the image are drawn by many workgroups, in every tier and by methods of all kinds. The
/// picture is the CPU reference's, and the counts have each triangle once.
#[test]
fn large_triangles_are_drawn_by_many_workgroups() {
    let view = mono(OFFSET, OFFSET + DVec3::Y, 1.0, [400, 384]);
    for (x, away, least) in [([-50.0, 60.0], 3.0, 9), ([-1.0, 1.0], 2.5, 3), ([-0.05, 0.05], 4.0, 1)] {
        let spt = wall(x, x, away);
        for options in [closest(), hqs(discs())] {
            let want = reference::frame(&ReferenceCloud::sequential(&spt, 1.0), &view, &options, None);
            let slices = want.visible.iter().filter(|batch| batch.flags & VISIBLE_TRIANGLES != 0).count();
            assert!(slices >= least && (least > 1 || slices == 1), "{slices} workgroups at {x:?}");
            for tier in tiers() {
                let drawn = Canvas::sequential(&spt, 1.0, &view, options, tier, 0).draw(&view);
                assert_eq!(difference(&drawn, &want), None, "{x:?} {tier:?}");
                assert_eq!(drawn.times.points_read, want.points_read());
                let num_batches = want.visible.chunk_by(|a, b| a.first_point == b.first_point).count();
                assert_eq!(drawn.times.visible_batches as usize, num_batches);
            }
        }
        // Threads that come to a pixel together draw in slices too.
        let detail = render::layout::Detail { fill_reach_px: None, ..discs() };
        let options = DrawOptions { detail, ..closest() };
        let [alone, together] = [Method::AtomicMin, Method::Dedup].map(|method| {
            let technique = LabTechnique { method, ..LabTechnique::tree(1.0) };
            Canvas::sequential_by(technique, &spt, &view, options, gpu().atomics(), 0).draw(&view)
        });
        assert!(alone.pixels == together.pixels);
    }
}

/// There are more slices than there is room for: some batches get fewer workgroups, and nothing is lost.
#[test]
fn slices_end_where_room_does() {
    const NUM_SLIVERS: u32 = 6000;
    let view = mono(OFFSET, OFFSET + DVec3::Y, 1.0, [2000, 2000]);
    // Slivers as long as the image is wide have few pixels, which nobody knows before they are drawn.
    let at = |x: f64, z: f64| (DVec3::new(x, 4.0, z) * 1e4).round().to_array().map(|v| v as i32);
    let sliver = |i: u32| {
        let z = f64::from(i) * 1.2e-3 - 3.6;
        [at(-3.9, z), at(3.9, z), at(3.9, z + 1e-3)]
    };
    let corners: Vec<[i32; 3]> = (0..NUM_SLIVERS).flat_map(sliver).collect();
    let mut scan = scan_of(&corners, 1e-4, OFFSET);
    scan.files[0].triangles = (0..NUM_SLIVERS).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let spt = spt_of(&scan, false);
    let want = reference::frame(&ReferenceCloud::sequential(&spt, 1.0), &view, &closest(), None);
    let num_batches = want.visible.chunk_by(|a, b| a.first_point == b.first_point).count();
    let num_slices = want.visible.len() - num_batches;
    assert_eq!(num_slices, render::layout::MAX_EXTRA_SLICES as usize, "of {num_batches} batches");
    let drawn = Canvas::sequential(&spt, 1.0, &view, closest(), gpu().atomics(), 0).draw(&view);
    assert!(drawn.pixels == want.pixels);
    assert_eq!(drawn.times.visible_batches as usize, num_batches);
}
