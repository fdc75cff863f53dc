//! What is drawn where a file's system, its coordinates and the user's units contradict each other.

use super::{PlacedLas, errors, geocentric, tower_on_earth};
use crate::bytes::{tower, world};
use glam::DVec3;
use points::{Project, ReadOptions, Unit, WorldFromFile};

/// Files that name a map's system and are not in it, as copied headers make them.
#[test]
fn coordinates_that_plainly_contradict_the_system_are_taken_for_what_they_are() {
    let utm = [[1024, 0, 1, 1], [3072, 0, 1, 32632]];
    let feet = [[1024, 0, 1, 1], [3072, 0, 1, 2263]];
    let geographic = [[1024, 0, 1, 2], [2048, 0, 1, 4326]];
    let degrees = tower_on_earth(8.0, 47.0, 500.0);
    let cartesian: Vec<DVec3> = degrees.iter().map(geocentric).collect();
    let in_degrees = |keys: &[[u16; 4]]| {
        PlacedLas::new(DVec3::new(1e-9, 1e-9, 1e-3), DVec3::new(8.0, 47.0, 500.0), degrees.clone())
            .with_keys(keys)
    };
    let from_center = |keys: &[[u16; 4]]| {
        PlacedLas::new(DVec3::splat(1e-3), cartesian[0].round(), cartesian.clone()).with_keys(keys)
    };
    for (what, las, words) in [
        ("degrees, UTM", in_degrees(&utm), "but has its coordinates in degrees"),
        ("degrees, feet", in_degrees(&feet), "but has its coordinates in degrees"),
        ("from the center, UTM", from_center(&utm), "but has its coordinates from the earth's center"),
        ("from the center, feet", from_center(&feet), "but has its coordinates from the earth's center"),
        (
            "from the center, degrees",
            from_center(&geographic),
            "but has its coordinates from the earth's center",
        ),
    ] {
        let scan = las.read(&ReadOptions::AS_FILES_SAY);
        let (distance, above) = errors(&scan, 500.0);
        assert!(distance < 5e-3 && above < 5e-3, "{what}: {distance} {above}");
        let [warning] = &scan.warnings[..] else { panic!("{what}: {:?}", scan.warnings) };
        assert!(warning.contains("names another coordinate system") && warning.contains(words), "{warning}");
        assert_eq!(scan.unit_m, Some(1.0), "{what}");
        let off = las.read(&ReadOptions { project: Project::Off, ..ReadOptions::AS_FILES_SAY });
        assert_eq!(off.bounds(), off.bounds_in_file(), "{what}");
    }
}

#[test]
fn a_unit_of_length_is_taken_or_spoken_of() {
    let meters = ReadOptions { unit: Unit::Meters(1.0), ..ReadOptions::AS_FILES_SAY };
    let degrees = || {
        PlacedLas::new(
            DVec3::new(1e-7, 1e-7, 1e-3),
            DVec3::new(16.0, 48.0, 0.0),
            tower_on_earth(16.0, 48.0, 200.0),
        )
    };
    // The user says what the first file is, which does not say it itself.
    let scan = degrees().read(&meters);
    assert_eq!((scan.bounds(), scan.unit_m), (scan.bounds_in_file(), Some(1.0)));
    assert!(scan.warnings.is_empty(), "{:?}", scan.warnings);
    // The second file says that it has angles.
    let keys = [[1024, 0, 1, 2], [2048, 0, 1, 4326]];
    let scan = degrees().with_keys(&keys).read(&meters);
    assert!(matches!(scan.files[0].world_from_file, WorldFromFile::Geographic { .. }));
    assert!(
        scan.warnings.iter().any(|w| w.contains("cloud.unit is the unit of its heights only")),
        "{:?}",
        scan.warnings
    );
    let off = ReadOptions { project: Project::Off, ..meters };
    let scan = degrees().with_keys(&keys).read(&off);
    assert_eq!((scan.bounds(), scan.unit_m), (scan.bounds_in_file(), Some(1.0)));
}

#[test]
fn angles_and_lengths_of_every_number_are_drawn_in_meters() {
    let gradians: Vec<DVec3> =
        tower_on_earth(2.0, 45.0, 100.0).iter().map(|p| *p * DVec3::new(1.0 / 0.9, 1.0 / 0.9, 1.0)).collect();
    for keys in [
        &[[1024, 0, 1, 2], [2048, 0, 1, 4807]][..],
        &[[1024, 0, 1, 2], [2048, 0, 1, 4326], [2054, 0, 1, 9105]],
    ] {
        let las = PlacedLas::new(DVec3::new(1e-9, 1e-9, 1e-4), gradians[0], gradians.clone()).with_keys(keys);
        let (distance, above) = errors(&las.read(&ReadOptions::AS_FILES_SAY), 100.0);
        assert!(distance < 1e-3 && above < 1e-3, "{keys:?}: {distance} {above}");
    }
    for (number, unit_m) in
        [(9005, 0.304_797_265_4), (9014, 1.8288), (9037, 0.914_391_796_2), (9084, 0.914_398_530_744_44)]
    {
        let base = DVec3::new(400_000.0, 170_000.0, 20.0);
        let points = tower().map(|p| (p + base) / unit_m).collect();
        let las = PlacedLas::new(DVec3::splat(1e-3), (base / unit_m).round(), points).with_keys(&[
            [1024, 0, 1, 1],
            [3072, 0, 1, 32767],
            [3076, 0, 1, number],
        ]);
        let scan = las.read(&ReadOptions::AS_FILES_SAY);
        assert!((scan.unit_m.unwrap_or_default() - unit_m).abs() < 1e-9, "{number}: {:?}", scan.unit_m);
        let size = scan.bounds().size() * unit_m;
        assert!((size - DVec3::new(20.0, 20.0, 6.0)).abs().max_element() < 5e-3, "{number}: {size}");
    }
}

/// Systems name the latitude first, and some programs write it so. There is no other reading where |y| is beyond 90.
#[test]
fn latitude_comes_first_where_longitude_cannot() {
    let keys = [[1024, 0, 1, 2], [2048, 0, 1, 4326]];
    let steps = DVec3::new(1e-9, 1e-9, 1e-3);
    for longitude in [151.21, -122.42, 179.0] {
        let in_order = tower_on_earth(longitude, -33.86, 50.0);
        let swapped: Vec<DVec3> = in_order.iter().map(|p| DVec3::new(p.y, p.x, p.z)).collect();
        for (stated, how) in
            [(&keys[..], "has its coordinates in angles, the latitude first"), (&[], "names no")]
        {
            let las = PlacedLas::new(steps, swapped[0], swapped.clone()).with_keys(stated);
            let scan = las.read(&ReadOptions::AS_FILES_SAY);
            let want = PlacedLas::new(steps, in_order[0], in_order.clone())
                .with_keys(stated)
                .read(&ReadOptions::AS_FILES_SAY);
            let differ =
                world(&scan).iter().zip(world(&want)).map(|(a, b)| (*a - b).length()).fold(0.0, f64::max);
            assert!(differ < 5e-3, "{longitude}: {differ} m");
            let [warning] = &scan.warnings[..] else { panic!("{:?}", scan.warnings) };
            assert!(warning.contains(how) && warning.contains("latitude first"), "{warning}");
            assert!(!want.warnings[0].contains("latitude first"), "{:?}", want.warnings);
            for (p_in_file, p) in swapped.iter().zip(world(&scan)) {
                assert!((scan.files[0].world_from_file.p_in_world(*p_in_file) - p).length() < 2e-3);
            }
        }
    }
    // Either order may be meant here; it is then taken as the program's own files have it.
    let swapped: Vec<DVec3> = tower_on_earth(47.0, 8.0, 500.0);
    let scan = PlacedLas::new(steps, swapped[0], swapped).with_keys(&keys).read(&ReadOptions::AS_FILES_SAY);
    assert!(!scan.warnings[0].contains("latitude first"), "{:?}", scan.warnings);
}

#[test]
fn longitudes_may_go_on_to_360_and_no_scan_has_steps_of_a_hundred_meters() {
    let east = tower_on_earth(254.8, 40.0, 1500.0);
    let scan = PlacedLas::new(DVec3::new(1e-9, 1e-9, 1e-3), east[0], east).read(&ReadOptions::AS_FILES_SAY);
    assert!(matches!(scan.files[0].world_from_file, WorldFromFile::Geographic { .. }), "{:?}", scan.warnings);
    // This is a hall whose file names the system of a receiver.
    let keys = [[1024, 0, 1, 2], [2048, 0, 1, 4326]];
    let scan = PlacedLas::new(DVec3::splat(1e-3), DVec3::ZERO, tower().collect()).with_keys(&keys);
    let scan = scan.read(&ReadOptions::AS_FILES_SAY);
    assert_eq!(scan.bounds(), scan.bounds_in_file());
    assert!(scan.warnings[0].contains("its points are not there"), "{:?}", scan.warnings);
}
