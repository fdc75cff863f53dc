//! Which axis of a file points up. Everything here has z up; models and many photogrammetry programs have y.

/// The axis of the files' coordinates that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Up {
    /// y where a file's header leaves no doubt of it, else z.
    #[default]
    Auto,
    /// z, as surveyors have it.
    Z,
    /// y, and z points towards the viewer.
    Y,
}

/// The remark of the program that merged the models of Stanford's repository (Bunny, Dragon, Armadillo), which have y up.
const ZIPPER: &str = "zipper output";
/// What that program writes of each point; others who copied the remark do not.
const ZIPPERS_COLUMN: &str = "confidence";

/// Why a file must have y up, as the end of a sentence whose subject is the file; `None` where that is not evident.
///
/// Nothing else is evidence. The shape of a scan is none: a wall that faces north in a file with z up has the extents and
/// the normals of ground in a file with y up. The remarks of other programs are none: they are copied by programs
/// with other axes.
pub(super) fn why_y(remarks: &[String], columns: &[String]) -> Option<&'static str> {
    let is_zippered = remarks.iter().any(|remark| remark.trim().eq_ignore_ascii_case(ZIPPER))
        && columns.iter().any(|name| name.eq_ignore_ascii_case(ZIPPERS_COLUMN));
    is_zippered.then_some("is a model of Stanford's repository by its header")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_program_that_is_known_to_have_y_up_turns_a_file() {
        let why = |remark: &str, column: &str| {
            why_y(&["by hand".into(), remark.into()], &["x".into(), column.into()])
        };
        assert!(why("zipper output", "confidence").is_some());
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
}
