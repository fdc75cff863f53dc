//! Rows of kind 6: units and axes.

use super::desk::Desk;
use super::las::{StrangeLas, place};
use super::{StrangerRow, judged, row};

const LINE: u8 = 6;
/// US survey feet in meters.
const US_FOOT: f64 = 1200.0 / 3937.0;

fn compound(horizontal: &str, vertical: &str) -> String {
    format!(
        "COMPD_CS[\"made up\",PROJCS[\"a projection\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,\
         298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],\
         PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",9],PARAMETER[\"scale_factor\",0.9996],\
         PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\",0],{horizontal}],VERT_CS[\"heights\",\
         VERT_DATUM[\"a datum\",2005],{vertical},AXIS[\"Up\",UP]]]"
    )
}

/// A row whose file has this unit, and whose place has its size in meters, as `info` says.
fn of_unit(
    name: &'static str,
    make: fn() -> StrangeLas,
    set: &'static [&'static str],
    unit_m: f64,
) -> StrangerRow {
    row(LINE, name, format!("unit {unit_m:.7} m, eyes 1.7 m above the ground"), move |desk| {
        desk.put("place.las", make().bytes());
        let args = [&["place.las"], set].concat();
        let info = desk.info(&args)?;
        let unit = info.json["unit_m"].as_f64().unwrap_or(f64::NAN);
        let head = desk.start(&args)?.head;
        let eyes_m = head[2] * unit_m;
        let got = format!("unit {unit:.7}, eyes {eyes_m:.2} m above 0");
        judged((unit / unit_m - 1.0).abs() < 1e-5 && (1.5..40.0).contains(&eyes_m), got)
    })
}

fn meters(edge: f64) -> StrangeLas {
    StrangeLas::new(2, place(3000, [0.0; 3], edge))
}

/// The tower's height in the picture as a share of its height in the picture of the same place in meters.
fn tower(desk: &Desk, las: &StrangeLas, args: &[&str]) -> Result<f64, String> {
    desk.put("tower.las", las.bytes());
    let mut heights = Vec::new();
    let fixed = ["tower.las", "--eye", "0,-60,3", "--target", "0,0,3", "--fov-y", "30"];
    let picture = desk.render(&[&fixed[..], args].concat())?;
    for y in 0..64 {
        let is_lit = (44..52).any(|x| picture.pixels[y * 96 + x] != [0; 3]);
        heights.extend(is_lit.then_some(y));
    }
    let (first, last) = heights.first().zip(heights.last()).ok_or("nothing is lit")?;
    Ok((last + 1 - first) as f64)
}

fn isotropic(
    name: &'static str,
    make: fn(StrangeLas) -> StrangeLas,
    set: &'static [&'static str],
) -> StrangerRow {
    row(LINE, name, "the tower as high as in meters", move |desk| {
        let plain = tower(desk, &meters(20.0), &[])?;
        let mut feet = meters(20.0);
        feet.points.iter_mut().for_each(|point| point.at[2] /= US_FOOT);
        let naive = tower(desk, &feet, &[])?;
        let got = tower(desk, &make(feet), set)?;
        judged(
            (got - plain).abs() <= 2.0 && naive > plain + 4.0,
            format!("{got} pixels, {plain} in meters, {naive} as stored"),
        )
    })
}

/// A place at longitude 8, latitude 47, in degrees and meters.
fn degrees(longitude: f64, latitude: f64) -> StrangeLas {
    let mut points = place(3000, [0.0; 3], 20.0);
    for point in &mut points {
        let [x, y, z] = point.at;
        point.at =
            [longitude + x / (111_320.0 * latitude.to_radians().cos()), latitude + y / 110_574.0, 450.0 + z];
    }
    StrangeLas::new(2, points).scaled([1e-8, 1e-8, 0.001]).at([longitude, latitude, 0.0])
}

/// The same place in geocentric coordinates.
fn geocentric(longitude: f64, latitude: f64) -> StrangeLas {
    let mut points = place(3000, [0.0; 3], 20.0);
    let (a, e2) = (6_378_137.0, 6.694_379_990_14e-3);
    let ((sin_lon, cos_lon), (sin_lat, cos_lat)) =
        (longitude.to_radians().sin_cos(), latitude.to_radians().sin_cos());
    let n = a / (1.0 - e2 * sin_lat * sin_lat).sqrt();
    let middle = [n * cos_lat * cos_lon, n * cos_lat * sin_lon, n * (1.0 - e2) * sin_lat];
    for point in &mut points {
        let [east, north, up] = point.at;
        point.at = [
            middle[0] - sin_lon * east - sin_lat * cos_lon * north + cos_lat * cos_lon * up,
            middle[1] + cos_lon * east - sin_lat * sin_lon * north + cos_lat * sin_lon * up,
            middle[2] + cos_lat * north + sin_lat * up,
        ];
    }
    StrangeLas::new(2, points).at(middle.map(f64::round))
}

/// A row whose scan is walked in meters about its middle, upright, which is said; `info` has the file's own
/// coordinates.
fn projected(name: &'static str, make: fn() -> StrangeLas) -> StrangerRow {
    row(LINE, name, "an upright place of 20 m, walked in meters; said; the box as in the file", move |desk| {
        let las = make();
        desk.put("earth.las", las.bytes());
        let start = desk.start(&["earth.las"])?;
        let info = desk.info(&["earth.las"])?;
        let low = info.json["bbox"][0][1].as_f64().unwrap_or(f64::NAN);
        let true_low = las.points.iter().map(|point| point.at[1]).fold(f64::INFINITY, f64::min);
        let is_own = (low - true_low).abs() < 0.002;
        let is_near = start.head[..2].iter().all(|c| c.abs() < 120.0);
        let is_told = start.ran.says(&["meters"]) || info.says(&["meters"]) || start.ran.says(&["upright"]);
        let got = format!("head at {:.2?}, box from {low}; {}", start.head, start.ran.in_words());
        // Level ground seen from the side is a line with a tower on it, wider than high.
        let picture = desk.render(&["earth.las"])?;
        judged(is_near && is_own && is_told && picture.span() >= 0.7, got)
    })
}

/// A row about what `info` says of the axis that points up, for a room of 7 × 5 × 2.6 with things in it, which stands
/// askew.
fn upright(
    name: &'static str,
    comment: &'static str,
    in_file: fn([f64; 3]) -> [f64; 3],
    up: &'static str,
) -> StrangerRow {
    let right = format!("{up} is up; said if it is not z");
    row(LINE, name, right, move |desk| {
        let mut text = String::new();
        let (mut corners, mut faces) = (Vec::new(), Vec::new());
        for (low, high, is_inside) in [
            ([0.0; 3], [7.0, 5.0, 2.6], true),
            ([2.0, 1.0, 0.0], [4.0, 2.0, 0.75], false),
            ([5.5, 4.0, 0.0], [6.5, 4.9, 1.9], false),
        ] {
            let first = corners.len();
            for i in 0..8 {
                let [x, y, z] = [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] });
                let (sin, cos) = 0.5_f64.sin_cos();
                corners.push(in_file([cos * x - sin * y, sin * x + cos * y, z]));
            }
            for [a, b, c, d] in
                [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
            {
                faces.push(
                    if is_inside { [d, c, b, a] } else { [a, b, c, d] }.map(|corner: usize| first + corner),
                );
            }
        }
        text += &format!("ply\nformat ascii 1.0\ncomment {comment}\nelement vertex {}\n", corners.len());
        text += &["x", "y", "z"].map(|axis| format!("property float {axis}\n")).concat();
        text +=
            &format!("element face {}\nproperty list uchar int vertex_indices\nend_header\n", faces.len());
        corners.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z}\n"));
        faces.iter().for_each(|[a, b, c, d]| text += &format!("4 {a} {b} {c} {d}\n"));
        desk.put("room.ply", text);
        let info = desk.info(&["room.ply"])?;
        let is_said = info.says(&["room.ply", "up", "cloud.up"]);
        judged(
            info.json["up"] == up && is_said == (up != "z"),
            format!("{} is up; {}", info.json["up"], info.in_words()),
        )
    })
}

/// Two tiles side by side, each of which states its unit.
fn tiles() -> StrangerRow {
    row(LINE, "a tile in meters and one in feet", "both of one size and side by side; said", |desk| {
        let mut feet = place(3000, [20.0, 0.0, 0.0], 20.0);
        feet.iter_mut().for_each(|point| point.at = point.at.map(|c| c / 0.3048));
        desk.put("m.las", meters(20.0).geo_keys(&[(1024, 1), (3076, 9001)]).bytes());
        desk.put("ft.las", StrangeLas::new(2, feet).geo_keys(&[(1024, 1), (3076, 9002)]).bytes());
        let info = desk.info(&["m.las", "ft.las"])?;
        let side = |to: usize, axis: usize| info.json["scene"][to][axis].as_f64().unwrap_or(f64::NAN);
        let size = [0, 1, 2].map(|axis| side(1, axis) - side(0, axis));
        let is_right = [40.0, 20.0, 6.0].iter().zip(size).all(|(right, got)| (right - got).abs() < 0.5);
        judged(is_right && info.says(&["ft.las", "unit"]), format!("{size:.1?}; {}", info.in_words()))
    })
}

/// A geocentric scan with zeros for what was not seen.
fn zeros_on_earth() -> StrangerRow {
    row(LINE, "geocentric, with 40 zeros", "the scene of 20 m; the zeros left out, said", |desk| {
        let mut las =
            geocentric(8.0, 47.0).geo_keys(&[(1024, 3), (2048, 4978)]).at([0.0; 3]).scaled([0.003; 3]);
        las.points.splice(70..70, vec![super::las::LasPoint::default(); 40]);
        desk.put("earth.las", las.bytes());
        let info = desk.info(&["earth.las"])?;
        let (start, picture) = (desk.start(&["earth.las"])?, desk.render(&["earth.las"])?);
        let is_near = start.head[..2].iter().all(|c| c.abs() < 120.0);
        let got = format!("head at {:.2?}; {}", start.head, info.in_words());
        judged(
            info.points() == 3000
                && info.says(&["earth.las", "40", "far"])
                && is_near
                && picture.span() >= 0.7,
            got,
        )
    })
}

pub fn rows() -> Vec<StrangerRow> {
    let y_up = |[x, y, z]: [f64; 3]| [x, z, -y];
    let mut rows = vec![
        upright("a mesh of a room, y up", "made up", y_up, "y"),
        upright("a mesh of a room, z up", "made up", |p| p, "z"),
        upright("a header that names y", "Vertical axis: y", |p| p, "y"),
        upright("a header that names z", "Vertical Axis: z", y_up, "z"),
        tiles(),
        zeros_on_earth(),
        of_unit(
            "EPSG:2263 by its code alone",
            || meters(65.0).geo_keys(&[(1024, 1), (3072, 2263)]),
            &[],
            US_FOOT,
        ),
        of_unit(
            "EPSG:2225 by its code alone",
            || meters(65.0).geo_keys(&[(1024, 1), (3072, 2225)]),
            &[],
            US_FOOT,
        ),
        of_unit(
            "EPSG:32632 by its code alone",
            || meters(20.0).geo_keys(&[(1024, 1), (3072, 32632)]),
            &[],
            1.0,
        ),
        of_unit("linear units key: feet", || meters(65.0).geo_keys(&[(1024, 1), (3076, 9002)]), &[], 0.3048),
        of_unit("no unit, cloud.unit=ft", || meters(65.0), &["--set", "cloud.unit=ft"], 0.3048),
        of_unit(
            "no unit, cloud.unit=cm",
            || meters(2000.0).scaled([0.01; 3]),
            &["--set", "cloud.unit=cm"],
            0.01,
        ),
        of_unit("no unit, cloud.unit=0.9144", || meters(22.0), &["--set", "cloud.unit=0.9144"], 0.9144),
        isotropic(
            "meters across, US feet up (WKT)",
            |las| {
                StrangeLas { format: 7, ..las }
                    .wkt(&compound("UNIT[\"metre\",1]", "UNIT[\"US survey foot\",0.304800609601219]"))
            },
            &[],
        ),
        isotropic(
            "meters across, US feet up (GeoTIFF keys)",
            |las| las.geo_keys(&[(1024, 1), (3072, 32632), (4099, 9003)]),
            &[],
        ),
        isotropic(
            "feet up by cloud.vertical_unit",
            |las| las,
            &["--set", "cloud.unit=m", "--set", "cloud.vertical_unit=us-ft"],
        ),
        projected("degrees, EPSG:4326", || degrees(8.0, 47.0).geo_keys(&[(1024, 2), (2048, 4326)])),
        projected("degrees, nothing stated", || degrees(-71.3, 42.4)),
        projected("geocentric, EPSG:4978", || geocentric(8.0, 47.0).geo_keys(&[(1024, 3), (2048, 4978)])),
        projected("geocentric in the south", || {
            geocentric(150.9, -33.8).geo_keys(&[(1024, 3), (2048, 4978)])
        }),
    ];
    rows.push(row(LINE, "a statue in millimeters, cloud.unit=mm", "seen from 0.3 to 6 m away", |desk| {
        let text = super::ply::points("float", &super::ply::statue(3000, 250.0));
        desk.put("statue.ply", text);
        let (away, _) = desk.start(&["statue.ply", "--set", "cloud.unit=mm"])?.from([0.0, 0.0, 60.0]);
        judged((300.0..6000.0).contains(&away), format!("{:.2} m", away / 1000.0))
    }));
    rows
}
