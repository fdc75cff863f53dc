//! What is drawn where a file's system, its coordinates and the user's units contradict each other.

use crate::{Las, errors, geocentric, tower, tower_on_earth};
use glam::DVec3;
use scanwalk::scan::{Project, ReadOptions, Unit, WorldFromFile};

/// Files that name a map's system and are not in it, as copied headers make them.
#[test]
fn coordinates_that_plainly_contradict_the_system_are_taken_for_what_they_are() {
    let utm = [[1024, 0, 1, 1], [3072, 0, 1, 32632]];
    let feet = [[1024, 0, 1, 1], [3072, 0, 1, 2263]];
    let geographic = [[1024, 0, 1, 2], [2048, 0, 1, 4326]];
    let degrees = tower_on_earth(8.0, 47.0, 500.0);
    let cartesian: Vec<DVec3> = degrees.iter().map(geocentric).collect();
    let in_degrees = |keys: &[[u16; 4]]| {
        Las::new(DVec3::new(1e-9, 1e-9, 1e-3), DVec3::new(8.0, 47.0, 500.0), degrees.clone()).with_keys(keys)
    };
    let from_centre = |keys: &[[u16; 4]]| {
        Las::new(DVec3::splat(1e-3), cartesian[0].round(), cartesian.clone()).with_keys(keys)
    };
    for (what, las, words) in [
        ("degrees, UTM", in_degrees(&utm), "but has its coordinates in degrees"),
        ("degrees, feet", in_degrees(&feet), "but has its coordinates in degrees"),
        ("from the centre, UTM", from_centre(&utm), "but has its coordinates from the earth's centre"),
        ("from the centre, feet", from_centre(&feet), "but has its coordinates from the earth's centre"),
        (
            "from the centre, degrees",
            from_centre(&geographic),
            "but has its coordinates from the earth's centre",
        ),
    ] {
        let scan = las.read(&ReadOptions::default());
        let (distance, above) = errors(&scan, 500.0);
        assert!(distance < 5e-3 && above < 5e-3, "{what}: {distance} {above}");
        let [warning] = &scan.warnings[..] else { panic!("{what}: {:?}", scan.warnings) };
        assert!(warning.contains("names another coordinate system") && warning.contains(words), "{warning}");
        assert_eq!(scan.unit_m, Some(1.0), "{what}");
        let off = las.read(&ReadOptions { project: Project::Off, ..ReadOptions::default() });
        assert_eq!(off.bounds(), off.bounds_in_file(), "{what}");
    }
}

#[test]
fn a_unit_of_length_is_taken_or_spoken_of() {
    let metres = ReadOptions { unit: Unit::Metres(1.0), ..ReadOptions::default() };
    let degrees = || {
        Las::new(DVec3::new(1e-7, 1e-7, 1e-3), DVec3::new(16.0, 48.0, 0.0), tower_on_earth(16.0, 48.0, 200.0))
    };
    // A file that does not say what it is: then the user says it.
    let scan = degrees().read(&metres);
    assert_eq!((scan.bounds(), scan.unit_m), (scan.bounds_in_file(), Some(1.0)));
    assert!(scan.warnings.is_empty(), "{:?}", scan.warnings);
    // One that says it has angles.
    let keys = [[1024, 0, 1, 2], [2048, 0, 1, 4326]];
    let scan = degrees().with_keys(&keys).read(&metres);
    assert!(matches!(scan.files[0].world_from_file, WorldFromFile::Geographic { .. }));
    assert!(
        scan.warnings.iter().any(|w| w.contains("cloud.unit is the unit of its heights only")),
        "{:?}",
        scan.warnings
    );
    let off = ReadOptions { project: Project::Off, ..metres };
    let scan = degrees().with_keys(&keys).read(&off);
    assert_eq!((scan.bounds(), scan.unit_m), (scan.bounds_in_file(), Some(1.0)));
}

#[test]
fn angles_and_lengths_of_every_number_are_drawn_in_metres() {
    let gradians: Vec<DVec3> =
        tower_on_earth(2.0, 45.0, 100.0).iter().map(|p| *p * DVec3::new(1.0 / 0.9, 1.0 / 0.9, 1.0)).collect();
    for keys in [
        &[[1024, 0, 1, 2], [2048, 0, 1, 4807]][..],
        &[[1024, 0, 1, 2], [2048, 0, 1, 4326], [2054, 0, 1, 9105]],
    ] {
        let las = Las::new(DVec3::new(1e-9, 1e-9, 1e-4), gradians[0], gradians.clone()).with_keys(keys);
        let (distance, above) = errors(&las.read(&ReadOptions::default()), 100.0);
        assert!(distance < 1e-3 && above < 1e-3, "{keys:?}: {distance} {above}");
    }
    for (number, unit_m) in
        [(9005, 0.304_797_265_4), (9014, 1.8288), (9037, 0.914_391_796_2), (9084, 0.914_398_530_744_44)]
    {
        let base = DVec3::new(400_000.0, 170_000.0, 20.0);
        let points = tower().map(|p| (p + base) / unit_m).collect();
        let las = Las::new(DVec3::splat(1e-3), (base / unit_m).round(), points).with_keys(&[
            [1024, 0, 1, 1],
            [3072, 0, 1, 32767],
            [3076, 0, 1, number],
        ]);
        let scan = las.read(&ReadOptions::default());
        assert!((scan.unit_m.unwrap_or_default() - unit_m).abs() < 1e-9, "{number}: {:?}", scan.unit_m);
        let size = scan.bounds().size() * unit_m;
        assert!((size - DVec3::new(20.0, 20.0, 6.0)).abs().max_element() < 5e-3, "{number}: {size}");
    }
}
