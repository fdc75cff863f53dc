//! Finds which axis points up by a header's remarks.

use super::{Evidence, UpAxis};

/// The remark of the program `zipper`, which merged the models of Stanford's repository (Bunny, Dragon, Armadillo).
/// These have y up.
const ZIPPER: &str = "zipper output";
/// Column that the program `zipper` writes for each point; others who copied its remark do not.
const ZIPPERS_COLUMN: &str = "confidence";
/// Remarks that begin with one of these name the axis.
const KEYS: [&str; 6] = ["vertical axis", "up axis", "upaxis", "up vector", "world up", "up"];
/// Remark of a program that names y whatever is up.
const NAMES_Y_ALWAYS: &str = "exported from brush";

/// The axis that must be up by the remarks and the columns of points of a header; `None` where that is not evident.
///
/// The names of programs are no evidence: a program writes the axes of the files that it has read.
pub(crate) fn stated(remarks: &[String], columns: &[String]) -> Option<Evidence> {
    let lines: Vec<String> = remarks.iter().map(|remark| plain(remark)).collect();
    let is_zippered = lines.iter().any(|line| line == ZIPPER)
        && columns.iter().any(|name| name.eq_ignore_ascii_case(ZIPPERS_COLUMN));
    if is_zippered {
        return Some(Evidence { up: UpAxis::Y, why: "it is a model of Stanford's repository by its header" });
    }
    if lines.iter().any(|line| line.starts_with(NAMES_Y_ALWAYS)) {
        return None;
    }
    let up = lines.iter().find_map(|line| named_behind_key(line).or_else(|| named_before_up(line)))?;
    Some(Evidence { up, why: "its header names it" })
}

/// Makes a remark lower case, with blanks for all characters that only separate words.
fn plain(remark: &str) -> String {
    let parts = |c: char| if c.is_whitespace() || "_:=,;()[]".contains(c) { ' ' } else { c };
    let words: String = remark.to_lowercase().chars().map(parts).collect();
    words.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The axis in "vertical axis z" or "up axis 0 1 0".
fn named_behind_key(line: &str) -> Option<UpAxis> {
    let rest = KEYS.iter().find_map(|key| line.strip_prefix(key)?.strip_prefix(' '))?;
    let words: Vec<&str> = rest.split(' ').collect();
    if let [word] = words[..] {
        return axis(word);
    }
    let numbers: Vec<f64> = words.iter().map(|word| word.parse()).collect::<Result<_, _>>().ok()?;
    match numbers[..] {
        [0.0, 0.0, z] if z > 0.0 => Some(UpAxis::Z),
        [0.0, y, 0.0] if y > 0.0 => Some(UpAxis::Y),
        [0.0, y, 0.0] if y < 0.0 => Some(UpAxis::MinusY),
        _ => None,
    }
}

/// The axis in "y-up", "z up" or "y down".
fn named_before_up(line: &str) -> Option<UpAxis> {
    let words: Vec<&str> = line.split(' ').collect();
    let ends = |word: &str, end: &str| match axis(word.strip_suffix(end)?)? {
        UpAxis::Y if end == "-down" => Some(UpAxis::MinusY),
        UpAxis::Z if end == "-down" => None,
        up => Some(up),
    };
    let of_word = words.iter().find_map(|word| ends(word, "-up").or_else(|| ends(word, "-down")));
    let of_two = || {
        words.windows(2).find_map(|pair| match (axis(pair[0])?, pair[1]) {
            (up, "up") => Some(up),
            (UpAxis::Y, "down") => Some(UpAxis::MinusY),
            _ => None,
        })
    };
    of_word.or_else(of_two)
}

fn axis(word: &str) -> Option<UpAxis> {
    match word {
        "z" | "+z" => Some(UpAxis::Z),
        "y" | "+y" => Some(UpAxis::Y),
        "-y" => Some(UpAxis::MinusY),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn up(remark: &str) -> Option<UpAxis> {
        stated(&["by hand".into(), remark.into()], &["x".into()]).map(|evidence| evidence.up)
    }

    #[test]
    fn only_a_program_that_is_known_to_have_y_up_turns_a_file() {
        let why = |remark: &str, column: &str| {
            stated(&["by hand".into(), remark.into()], &["x".into(), column.into()])
        };
        assert_eq!(why("zipper output", "confidence").map(|evidence| evidence.up), Some(UpAxis::Y));
        for (remark, column) in [
            ("zipper output", "intensity"),
            ("pointcloud saved from Realsense Viewer", "confidence"),
            ("VCGLIB generated", "confidence"),
            ("Created by CloudCompare v2.11.1", "confidence"),
            ("not zipper output", "confidence"),
        ] {
            assert_eq!(why(remark, column), None, "{remark}");
        }
    }

    #[test]
    fn an_axis_that_is_named_is_believed() {
        for (remark, axis) in [
            ("Vertical Axis: z", UpAxis::Z),
            ("Vertical axis: y", UpAxis::Y),
            ("Vertical axis: 0 1 0", UpAxis::Y),
            ("up_vector = 0.0 -1.0 0.0", UpAxis::MinusY),
            ("UpAxis: -Y", UpAxis::MinusY),
            ("up z", UpAxis::Z),
            ("exported by Some Phone, Y-up, metres", UpAxis::Y),
            ("coordinates: right-handed (y up)", UpAxis::Y),
            ("camera coordinates, y down", UpAxis::MinusY),
        ] {
            assert_eq!(up(remark), Some(axis), "{remark}");
        }
        for remark in [
            "set up y",
            "up to date",
            "made up by hand",
            "up axis: 0 1 1",
            "the y axis",
            "z-down",
            "x up",
            "up",
        ] {
            assert_eq!(up(remark), None, "{remark}");
        }
        let brush = ["Exported from Brush".to_owned(), "Vertical axis: y".to_owned()];
        assert_eq!(stated(&brush, &[]), None);
    }
}
