//! Where the points of a file come to lie: units, heights in units of their own, coordinates on the earth. Files are
//! made up byte by byte.

mod contradicted;

use crate::PROGRAM;
use crate::bytes::{read_bytes_with, tower, world};
use base::task::CancelToken;
use glam::DVec3;
use kit::las_files::save;
use kit::program;
use kit::reading;
use points::{Geodetic, Project, ReadOptions, Scan, Unit, WorldFromFile, read};

const US_FOOT: f64 = 1200.0 / 3937.0;

/// A LAS 1.4 file of point format 0, with its grid, GeoTIFF keys or WKT, and coordinates.
struct PlacedLas {
    scale: DVec3,
    offset: DVec3,
    keys: Vec<[u16; 4]>,
    wkt: String,
    points: Vec<DVec3>,
}

impl PlacedLas {
    fn new(scale: DVec3, offset: DVec3, points: Vec<DVec3>) -> Self {
        Self { scale, offset, keys: Vec::new(), wkt: String::new(), points }
    }

    fn with_keys(self, keys: &[[u16; 4]]) -> Self {
        Self { keys: keys.to_vec(), ..self }
    }

    fn with_wkt(self, wkt: &str) -> Self {
        Self { wkt: wkt.into(), ..self }
    }

    fn bytes(&self) -> Vec<u8> {
        let mut records = Vec::new();
        let mut record = |id: u16, payload: &[u8]| {
            let mut head = [0u8; 54];
            head[2..17].copy_from_slice(b"LASF_Projection");
            head[18..20].copy_from_slice(&id.to_le_bytes());
            head[20..22].copy_from_slice(&(payload.len() as u16).to_le_bytes());
            records.extend_from_slice(&head);
            records.extend_from_slice(payload);
        };
        let mut num_records = 0u32;
        if !self.keys.is_empty() {
            let words =
                [1, 1, 0, self.keys.len() as u16].into_iter().chain(self.keys.iter().flatten().copied());
            record(34735, &words.flat_map(u16::to_le_bytes).collect::<Vec<u8>>());
            num_records += 1;
        }
        if !self.wkt.is_empty() {
            record(2112, self.wkt.as_bytes());
            num_records += 1;
        }
        let mut bytes = vec![0u8; 375];
        bytes[..4].copy_from_slice(b"LASF");
        bytes[6] = if self.wkt.is_empty() { 0 } else { 0x10 };
        bytes[24..26].copy_from_slice(&[1, 4]);
        bytes[94..96].copy_from_slice(&375u16.to_le_bytes());
        bytes[96..100].copy_from_slice(&(375 + records.len() as u32).to_le_bytes());
        bytes[100..104].copy_from_slice(&num_records.to_le_bytes());
        bytes[105..107].copy_from_slice(&20u16.to_le_bytes());
        bytes[107..111].copy_from_slice(&(self.points.len() as u32).to_le_bytes());
        for axis in 0..3 {
            bytes[131 + 8 * axis..139 + 8 * axis].copy_from_slice(&self.scale[axis].to_le_bytes());
            bytes[155 + 8 * axis..163 + 8 * axis].copy_from_slice(&self.offset[axis].to_le_bytes());
        }
        bytes[247..255].copy_from_slice(&(self.points.len() as u64).to_le_bytes());
        bytes.extend_from_slice(&records);
        for p in &self.points {
            let steps = ((*p - self.offset) / self.scale).round();
            bytes.extend(steps.to_array().iter().flat_map(|&step| (step as i32).to_le_bytes()));
            bytes.extend_from_slice(&[0; 8]);
        }
        bytes
    }

    fn read(&self, options: &ReadOptions) -> Scan {
        read_bytes_with("a.las", &self.bytes(), options).unwrap()
    }
}

/// The tower at a place on the earth, as longitude, latitude in degrees and height, by steps of a second: not by the
/// code under test, but by radii of curvature, which is exact to a tenth of a millimeter at this size.
fn tower_on_earth(longitude: f64, latitude: f64, height: f64) -> Vec<DVec3> {
    let (a, e2) = (6_378_137.0, 0.006_694_379_990_141_3);
    let w = 1.0 - e2 * latitude.to_radians().sin().powi(2);
    let (north_m, east_m) =
        (a * (1.0 - e2) / w.powf(1.5) + height, (a / w.sqrt() + height) * latitude.to_radians().cos());
    let place = |p: DVec3| {
        let (dlon, dlat) = ((p.x / east_m).to_degrees(), (p.y / north_m).to_degrees());
        DVec3::new(longitude + dlon, latitude + dlat, height + p.z)
    };
    tower().map(place).collect()
}

fn geocentric(p: &DVec3) -> DVec3 {
    Geodetic { longitude: p.x.to_radians(), latitude: p.y.to_radians(), height_m: p.z }.geocentric()
}

/// Largest error of the distances between points, and largest error of heights.
fn errors(scan: &Scan, height: f64) -> (f64, f64) {
    let (found, right): (Vec<DVec3>, Vec<DVec3>) = (world(scan), tower().collect());
    let pairs = (0..right.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let distance =
        pairs.map(|(i, j)| ((found[i] - found[j]).length() - (right[i] - right[j]).length()).abs());
    let heights = found.iter().zip(&right).map(|(found, right)| (found.z - height - right.z).abs());
    (distance.fold(0.0, f64::max), heights.fold(0.0, f64::max))
}

/// The size is of longitude, latitude and height in meters, along the same axes as the file's size beside it.
#[test]
fn info_gives_the_size_of_a_scan_on_the_earth_in_the_order_of_its_axes() {
    let tower = tower_on_earth(8.0, 47.0, 500.0);
    let degrees = PlacedLas::new(DVec3::new(1e-9, 1e-9, 1e-3), DVec3::new(8.0, 47.0, 500.0), tower);
    let (_folder, path) = save("a.las", &degrees.with_keys(&[[1024, 0, 1, 2], [2048, 0, 1, 4326]]).bytes());
    let info = program::run(program::command(PROGRAM).arg("info").arg(path));
    let text = info.text();
    let size =
        text.lines().find(|line| line.trim_start().starts_with("size")).unwrap_or_else(|| panic!("{text}"));
    assert!(size.contains("(20.0 x 20.0 x 6.0 m)"), "{size}");
}

#[test]
fn units_are_stated_by_code_or_by_the_user() {
    let tile = PlacedLas::new(DVec3::splat(0.001), DVec3::new(984_000.0, 200_000.0, 0.0), {
        tower().map(|p| p / US_FOOT + DVec3::new(984_000.0, 200_000.0, 0.0)).collect()
    });
    assert_eq!(tile.read(&ReadOptions::AS_FILES_SAY).unit_m, None);
    let by_code = PlacedLas { keys: vec![[1024, 0, 1, 1], [3072, 0, 1, 2263]], ..tile };
    let scan = by_code.read(&ReadOptions::AS_FILES_SAY);
    assert_eq!((scan.unit_m, scan.unit_in_file_m), (Some(US_FOOT), Some(US_FOOT)));
    assert!((scan.bounds().size() * US_FOOT - DVec3::new(20.0, 20.0, 6.0)).abs().max_element() < 1e-3);
    let millimeters = ReadOptions { unit: Unit::Meters(0.001), ..ReadOptions::AS_FILES_SAY };
    let scan = by_code.read(&millimeters);
    assert_eq!(scan.unit_m, Some(0.001));
    assert_eq!(scan.files[0].grid.scale, DVec3::splat(0.001), "a unit of all axes scales none of them");
}

#[test]
fn heights_of_another_unit_are_scaled_to_that_across_and_no_step_is_rounded() {
    let foot = DVec3::new(1.0, 1.0, 1.0 / US_FOOT);
    let base = DVec3::new(583_000.0, 4_507_000.0, 0.0);
    let tile = || PlacedLas::new(DVec3::splat(0.001), base, tower().map(|p| p * foot + base).collect());
    let wkt = r#"COMPD_CS["both",PROJCS["UTM",UNIT["metre",1]],VERT_CS["h",VERT_DATUM["x",2005],UNIT["US survey foot",0.304800609601219]]]"#;
    let keys = [[1024, 0, 1, 1], [3072, 0, 1, 26918], [4099, 0, 1, 9003]];
    let vertical = ReadOptions { vertical_unit: Unit::Meters(US_FOOT), ..ReadOptions::AS_FILES_SAY };
    let stored = tile().read(&ReadOptions::AS_FILES_SAY).files[0].points.xyz.clone();
    for (how, scan) in [
        ("wkt", tile().with_wkt(wkt).read(&ReadOptions::AS_FILES_SAY)),
        ("keys", tile().with_keys(&keys).read(&ReadOptions::AS_FILES_SAY)),
        ("user", tile().read(&vertical)),
    ] {
        let size = scan.bounds().size();
        assert!((size - DVec3::new(20.0, 20.0, 6.0)).abs().max_element() < 1e-3, "{how}: {size}");
        assert_eq!(scan.unit_m, Some(1.0), "{how}");
        assert_eq!(scan.files[0].points.xyz, stored, "{how}");
        // The file's own numbers are kept, to the last bit.
        let file = &scan.files[0];
        assert_eq!(file.in_file.grid.scale, DVec3::splat(0.001), "{how}");
        assert!((file.in_file.bounds.size().z - 6.0 / US_FOOT).abs() < 1e-3, "{how}");
        let p = file.world_from_file.p_in_world(file.in_file.bounds.max);
        assert!((p - file.bounds.max).abs().max_element() < 1e-9, "{how}: {p}");
    }
    // Without a word about the unit of heights the tower is 19.7 units tall. The user's unit of all axes wins over
    // the file's.
    assert!((tile().read(&ReadOptions::AS_FILES_SAY).bounds().size().z - 19.685).abs() < 1e-3);
    let meters = ReadOptions { unit: Unit::Meters(1.0), ..ReadOptions::AS_FILES_SAY };
    assert!((tile().with_wkt(wkt).read(&meters).bounds().size().z - 19.685).abs() < 1e-3);
}

#[test]
fn places_on_the_earth_stand_upright_in_meters_wherever_they_are() {
    let options = ReadOptions::AS_FILES_SAY;
    for longitude in [-179.9999, -73.9, 8.0, 139.7] {
        for latitude in [-77.5, -33.9, 0.3, 47.0, 78.2] {
            for height in [-400.0, 0.0, 4000.0] {
                let degrees = tower_on_earth(longitude, latitude, height);
                let scale = DVec3::new(1e-9, 1e-9, 1e-4);
                let offset = DVec3::new(longitude, latitude, height);
                let geographic = PlacedLas::new(scale, offset, degrees.clone())
                    .with_keys(&[[1024, 0, 1, 2], [2048, 0, 1, 4326]]);
                let cartesian: Vec<DVec3> = degrees.iter().map(geocentric).collect();
                let cartesian = PlacedLas::new(DVec3::splat(1e-4), cartesian[0].round(), cartesian);
                for (what, las) in [
                    ("degrees by code", geographic.read(&options)),
                    (
                        "from the center by code",
                        cartesian.with_keys(&[[1024, 0, 1, 3], [2048, 0, 1, 4978]]).read(&options),
                    ),
                ] {
                    let case = format!("{what} at {longitude}, {latitude}, {height}");
                    let (distance, above) = errors(&las, height);
                    assert!(distance < 1e-3 && above < 1e-3, "{case}: {distance} {above}");
                    assert_eq!(
                        (las.unit_m, las.warnings.len()),
                        (Some(1.0), 1),
                        "{case}: {:?}",
                        las.warnings
                    );
                    // East is x and north is y.
                    let p = world(&las);
                    assert!(
                        ((p[1] - p[0]) - DVec3::new(20.0, 20.0, 6.0)).abs().max_element() < 2e-3,
                        "{case}"
                    );
                    assert!(p[4].truncate().length() < 15.0, "{case}: about the middle");
                }
            }
        }
    }
}

#[test]
fn what_the_file_has_is_kept_beside_what_is_drawn() {
    let degrees = tower_on_earth(16.0, 48.0, 200.0);
    let las = PlacedLas::new(DVec3::new(1e-9, 1e-9, 1e-4), DVec3::new(16.0, 48.0, 200.0), degrees.clone());
    let scan = las.with_keys(&[[1024, 0, 1, 2], [2048, 0, 1, 4326]]).read(&ReadOptions::AS_FILES_SAY);
    let file = &scan.files[0];
    let own = file.in_file.bounds;
    assert!(
        (own.min - degrees[0]).abs().max_element() < 1e-4
            && (own.max - degrees[1]).abs().max_element() < 1e-4
    );
    for (p_in_file, p) in degrees.iter().zip(world(&scan)) {
        assert!((file.world_from_file.p_in_world(*p_in_file) - p).length() < 1e-3);
    }
    assert!(matches!(file.world_from_file, WorldFromFile::Geographic { .. }));
}

#[test]
fn projection_is_off_on_or_forced_as_asked() {
    let with = |project| ReadOptions { project, ..ReadOptions::AS_FILES_SAY };
    let degrees = tower_on_earth(16.0, 48.0, 200.0);
    let las = PlacedLas::new(DVec3::new(1e-9, 1e-9, 1e-4), DVec3::new(16.0, 48.0, 200.0), degrees)
        .with_keys(&[[1024, 0, 1, 2], [2048, 0, 1, 4326]]);
    let off = las.read(&with(Project::Off));
    assert_eq!((off.bounds(), off.unit_m), (off.bounds_in_file(), None));
    assert!(off.warnings[0].contains("looks flat"), "{:?}", off.warnings);
    // A local scan may be one that somebody knows to be in degrees.
    let local = PlacedLas::new(DVec3::splat(1e-3), DVec3::ZERO, tower().collect());
    assert_eq!(local.read(&with(Project::Auto)).unit_m, None);
    assert_eq!(local.read(&with(Project::Degrees)).unit_m, Some(1.0));
}

#[test]
fn files_of_a_scan_share_one_frame() {
    let tile = |points: &[DVec3], keys: &[[u16; 4]]| {
        PlacedLas::new(DVec3::new(1e-9, 1e-9, 1e-4), DVec3::new(8.0, 47.0, 500.0), points.to_vec())
            .with_keys(keys)
            .bytes()
    };
    let degrees = tower_on_earth(8.0, 47.0, 500.0);
    let keys = [[1024, 0, 1, 2], [2048, 0, 1, 4326]];
    let (_a, a) = save("a.las", &tile(&degrees[..2], &keys));
    let (_b, b) = save("b.las", &tile(&degrees[2..], &keys));
    let (_all, all) = save("all.las", &tile(&degrees, &keys));
    let two = reading::files(&[a, b]).unwrap();
    let one = reading::file(&all).unwrap();
    for (p, q) in world(&two).iter().zip(world(&one)) {
        assert!((*p - q).length() < 1e-3, "{p} {q}");
    }
    assert_eq!(two.warnings.len(), 1, "said once: {:?}", two.warnings);
}

#[test]
fn a_system_that_the_points_contradict_is_not_believed() {
    // Such files exist: UTM coordinates, and a geocentric system in the header.
    let utm = |keys: &[[u16; 4]]| {
        let offset = DVec3::new(515_368.0, 4_918_340.0, 2322.0);
        let scan = PlacedLas::new(DVec3::splat(1e-3), offset, tower().map(|p| p + offset).collect())
            .with_keys(keys)
            .read(&ReadOptions::AS_FILES_SAY);
        assert_eq!(scan.bounds(), scan.bounds_in_file(), "{keys:?}");
        assert!(scan.warnings[0].contains("its points are not there"), "{keys:?}: {:?}", scan.warnings);
    };
    utm(&[[1024, 0, 1, 3], [2048, 0, 1, 4978]]);
    utm(&[[1024, 0, 1, 2], [2048, 0, 1, 4326]]);
}

/// Scans in lengths that look a little like degrees or places from the earth's center.
#[test]
fn lengths_are_never_taken_for_places_on_the_earth() {
    let mm = DVec3::splat(1e-3);
    let local = |size: [f64; 3], offset: [f64; 3], scale: DVec3| {
        let (size, offset) = (DVec3::from_array(size), DVec3::from_array(offset));
        let points = (0..50).map(|i| {
            offset + size * DVec3::new(f64::from(i % 5) / 4.0, f64::from(i % 7) / 6.0, f64::from(i) / 49.0)
        });
        PlacedLas::new(scale, offset, points.collect())
    };
    for (what, las) in [
        ("a room", local([5.0, 4.0, 2.5], [8.0, 47.0, 0.0], mm)),
        ("a tree", local([2.5, 2.5, 20.0], [-1.2, -1.2, 0.0], mm)),
        ("a pole", local([0.05, 0.05, 12.0], [16.0, 48.0, 0.0], mm)),
        ("a wire in fine steps", local([0.003, 0.003, 12.0], [16.0, 48.0, 0.0], DVec3::splat(1e-6))),
        ("a thread in fine steps", local([0.0005, 0.0005, 4.0], [16.0, 48.0, 0.0], DVec3::splat(1e-7))),
        ("a tiny thing in fine steps", local([0.005, 0.004, 0.003], [0.0, 0.0, 0.0], DVec3::splat(1e-8))),
        (
            "a thing in finer steps across",
            local([1.0, 0.8, 1.0], [8.0, 47.0, 0.0], DVec3::new(1e-7, 1e-7, 1e-5)),
        ),
        (
            "a thing in much finer steps",
            local([1.0, 0.8, 1.0], [-0.5, -0.4, 0.0], DVec3::new(1e-7, 1e-7, 1e-3)),
        ),
        ("a column in finer steps", local([0.1, 0.1, 1.0], [8.0, 47.0, 0.0], DVec3::new(1e-7, 1e-7, 1e-5))),
        (
            "a small thing far away",
            local([0.01, 0.01, 0.01], [16.0, 48.0, 0.0], DVec3::new(1e-7, 1e-7, 1e-4)),
        ),
        ("a plate", local([1.0, 0.7, 0.0], [2.0, 3.0, 1.0], DVec3::new(1e-7, 1e-7, 1e-4))),
        ("UTM", local([100.0, 100.0, 20.0], [600_000.0, 6_350_000.0, 100.0], mm)),
        ("a mountain in UTM", local([900.0, 900.0, 800.0], [600_000.0, 6_350_000.0, 4000.0], mm)),
        // A program moved these to zero and kept the system's name.
        (
            "a room that was in UTM",
            local([5.0, 4.0, 2.5], [-2.5, -2.0, 0.0], mm).with_keys(&[[1024, 0, 1, 1], [3072, 0, 1, 32632]]),
        ),
        (
            "a pole that was in UTM",
            local([0.05, 0.05, 12.0], [16.0, 48.0, 0.0], mm)
                .with_keys(&[[1024, 0, 1, 1], [3072, 0, 1, 32632]]),
        ),
    ] {
        let scan = las.read(&ReadOptions::AS_FILES_SAY);
        assert_eq!(
            (scan.bounds(), scan.warnings.len()),
            (scan.bounds_in_file(), 0),
            "{what}: {:?}",
            scan.warnings
        );
    }
    // The rule can also find that coordinates are degrees.
    let degrees = PlacedLas::new(
        DVec3::new(1e-7, 1e-7, 1e-3),
        DVec3::new(16.0, 48.0, 0.0),
        tower_on_earth(16.0, 48.0, 200.0),
    );
    let scan = degrees.read(&ReadOptions::AS_FILES_SAY);
    assert!(
        scan.warnings[0].contains("names no coordinate system, but has its coordinates in degrees"),
        "{:?}",
        scan.warnings
    );
    let wide: Vec<DVec3> =
        tower().map(|p| DVec3::new(8.0 + p.x / 10.0, 47.0 + p.y / 10.0, 100.0 * p.z)).collect();
    let flat = || tower_on_earth(16.0, 48.0, 200.0).into_iter().map(|p| p.with_z(200.0));
    for (what, scale, points) in [
        ("one scale for all axes", DVec3::splat(1e-7), tower_on_earth(16.0, 48.0, 200.0)),
        ("two degrees wide", DVec3::new(1e-7, 1e-7, 1e-2), wide),
        ("flat", DVec3::new(1e-7, 1e-7, 1e-3), flat().collect()),
        ("at zero", DVec3::new(1e-7, 1e-7, 1e-3), tower_on_earth(0.01, 0.01, 200.0)),
    ] {
        let scan = PlacedLas::new(scale, DVec3::ZERO, points).read(&ReadOptions::AS_FILES_SAY);
        assert!(
            matches!(scan.files[0].world_from_file, WorldFromFile::Geographic { .. }),
            "{what}: {:?}",
            scan.warnings
        );
    }
    let center: Vec<DVec3> = tower_on_earth(8.0, 47.0, 500.0).iter().map(geocentric).collect();
    let scan = PlacedLas::new(mm, center[0].round(), center).read(&ReadOptions::AS_FILES_SAY);
    assert!(scan.warnings[0].contains("from the earth's center"), "{:?}", scan.warnings);
}

#[test]
fn zeros_beside_places_on_the_earth_are_left_out_and_cost_nothing() {
    let cartesian: Vec<DVec3> = tower_on_earth(8.0, 47.0, 500.0).iter().map(geocentric).collect();
    let keys = [[1024, 0, 1, 3], [2048, 0, 1, 4978]];
    for num_zeros in [0, 1, 5] {
        // There are enough points of the tower for one zero to be a stray.
        let mut points: Vec<DVec3> = cartesian.iter().copied().cycle().take(50).collect();
        points.iter_mut().enumerate().for_each(|(i, p)| *p += DVec3::splat(1e-3 * (i / 5) as f64));
        points.splice(7..7, vec![DVec3::ZERO; num_zeros]);
        let las = PlacedLas::new(DVec3::splat(0.004), DVec3::ZERO, points.clone()).with_keys(&keys);
        let scan = las.read(&ReadOptions::AS_FILES_SAY);
        let file = &scan.files[0];
        assert_eq!(file.points.xyz.len(), 50);
        let told = scan.warnings.iter().filter(|w| w.contains(&format!("a.las: has {num_zeros} point")));
        assert_eq!(told.count(), usize::from(num_zeros > 0), "{:?}", scan.warnings);
        assert!(file.in_file.bounds.size().max_element() < 30.0, "{:?}", file.in_file.bounds);
        let kept = points.iter().filter(|p| **p != DVec3::ZERO);
        for (p_in_file, p) in kept.zip(world(&scan)) {
            let stored = (*p_in_file / 0.004).round() * 0.004;
            let moved = (file.world_from_file.p_in_world(stored) - p).length();
            assert!(moved < 1e-6, "{num_zeros}: {moved}");
        }
    }
}

#[test]
fn files_with_other_units_are_scaled_to_that_of_the_first() {
    // The files have one projection, whose register has it in meters and in feet.
    let base = DVec3::new(400_000.0, 170_000.0, 20.0);
    let tile = |unit_m: f64, shift: f64, keys: &[[u16; 4]]| {
        let points: Vec<DVec3> = tower().map(|p| (p + base + DVec3::X * shift) / unit_m).collect();
        PlacedLas::new(DVec3::splat(0.001), (points[0]).round(), points).with_keys(keys).bytes()
    };
    let meters = [[1024, 0, 1, 1], [3076, 0, 1, 9001]];
    let feet = [[1024, 0, 1, 1], [3076, 0, 1, 9002]];
    let both: Vec<DVec3> =
        [0.0, 20.0].iter().flat_map(|&shift| tower().map(move |p| p + base + DVec3::X * shift)).collect();
    for feet_first in [false, true] {
        let shift = |is_feet: bool| if is_feet == feet_first { 0.0 } else { 20.0 };
        let (_a, a) = save("m.las", &tile(1.0, shift(false), &meters));
        let (_b, b) = save("ft.las", &tile(0.3048, shift(true), &feet));
        let paths = if feet_first { [b, a] } else { [a, b] };
        let scan = reading::files(&paths).unwrap();
        let unit_m = if feet_first { 0.3048 } else { 1.0 };
        assert_eq!(scan.unit_m, Some(unit_m));
        for (p, right) in world(&scan).iter().zip(&both) {
            assert!((*p * unit_m - *right).length() < 2e-3, "{p} {right}");
        }
        let [warning] = &scan.warnings[..] else { panic!("{:?}", scan.warnings) };
        let other = if feet_first {
            "m.las: has its lengths in another unit, meter"
        } else {
            "ft.las: has its lengths in another unit, foot"
        };
        assert!(warning.contains(other), "{warning}");
        // A unit that the user states is that of all files.
        let options = ReadOptions { unit: Unit::Meters(1.0), ..ReadOptions::AS_FILES_SAY };
        let scan = read(&paths, &options, &CancelToken::default()).unwrap();
        assert!(!scan.warnings.iter().any(|w| w.contains("another unit")), "{:?}", scan.warnings);
        assert_eq!(scan.bounds(), scan.bounds_in_file());
    }
    // Nothing is scaled beside a file that states no unit.
    let (_a, a) = save("m.las", &tile(1.0, 0.0, &meters));
    let (_b, b) = save("none.las", &tile(1.0, 20.0, &[]));
    let scan = reading::files(&[b, a]).unwrap();
    assert_eq!((scan.warnings.len(), scan.unit_m), (0, Some(1.0)), "{:?}", scan.warnings);
}
