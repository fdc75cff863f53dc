//! JSON as converters write it: numbers may be `inf` or `nan`, which no JSON has, and any part may be missing.

use crate::ScanError;
use crate::source::Source;
use serde_json::Value;

/// Most bytes of a description. The hierarchy of a million nodes, inline, takes a third of it.
const MOST_BYTES: u64 = 1 << 26;
/// How some editors begin a file of text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads a description.
///
/// # Errors
/// The file cannot be read, is too large, or is no JSON even if what is no number counts as null.
pub(super) fn read(source: &Source) -> Result<Value, ScanError> {
    let bytes = source.bytes(0, MOST_BYTES)?;
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&bytes);
    // A parser that goes no deeper than 128 levels ends on JSON that is nested without end.
    serde_json::from_slice(bytes).or_else(|_| serde_json::from_slice(&without_odd_words(bytes))).map_err(
        |error| ScanError::Line {
            path: source.path().to_owned(),
            line: error.line() as u64,
            problem: format!("is no JSON ({error}): get the file again"),
        },
    )
}

/// Replaces all words that are not JSON by null.
fn without_odd_words(bytes: &[u8]) -> Vec<u8> {
    let (mut fixed, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while at < bytes.len() {
        let rest = &bytes[at..];
        let len = match rest[0] {
            b'"' => string_len(rest),
            byte if is_of_word(byte) => rest.iter().position(|&byte| !is_of_word(byte)).unwrap_or(rest.len()),
            _ => 1,
        };
        let part = &rest[..len];
        let is_json = !is_of_word(part[0]) || serde_json::from_slice::<Value>(part).is_ok();
        fixed.extend_from_slice(if is_json { part } else { b"null" });
        at += len;
    }
    fixed
}

fn is_of_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || b"+-.#()_".contains(&byte)
}

/// Bytes of the string that starts here, with its quotes.
fn string_len(text: &[u8]) -> usize {
    let mut is_escaped = false;
    for (at, &byte) in text.iter().enumerate().skip(1) {
        match byte {
            _ if is_escaped => is_escaped = false,
            b'\\' => is_escaped = true,
            b'"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// A text; empty if there is none.
pub(super) fn text<'a>(of: &'a Value, key: &str) -> &'a str {
    of.get(key).and_then(Value::as_str).unwrap_or_default()
}

/// A finite number.
pub(super) fn number(of: &Value, key: &str) -> Option<f64> {
    of.get(key).and_then(Value::as_f64).filter(|number| number.is_finite())
}

/// A whole number that is not negative, however it is written.
pub(super) fn count(of: &Value, key: &str) -> Option<u64> {
    let value = of.get(key)?;
    value.as_u64().or_else(|| value.as_f64().filter(|number| *number >= 0.0).map(|number| number as u64))
}

/// Three finite numbers in a list.
pub(super) fn triple(of: &Value, key: &str) -> Option<[f64; 3]> {
    let list = of.get(key)?.as_array()?;
    let number = |at: usize| list.get(at).and_then(Value::as_f64).filter(|number| number.is_finite());
    Some([number(0)?, number(1)?, number(2)?])
}

/// The number at a place of a list, if it is finite.
pub(super) fn item(of: &Value, key: &str, at: usize) -> Option<f64> {
    of.get(key)?.as_array()?.get(at)?.as_f64().filter(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Value, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        std::fs::write(&path, text).unwrap();
        read(&Source::open(&path).unwrap()).map_err(|error| error.to_string())
    }

    #[test]
    fn words_that_are_no_numbers_are_null_and_texts_stay() {
        let text = r#"{"a": [inf, -inf, nan, -nan(ind), 1.#INF, NaN, -Infinity], "b\"inf": "x inf, nan", "c": [-1.5e+3,true, null,2]}"#;
        let value = parsed(text).unwrap();
        assert!(value["a"].as_array().unwrap().iter().all(Value::is_null));
        assert_eq!(value["a"].as_array().unwrap().len(), 7);
        assert_eq!(value["b\"inf"], "x inf, nan");
        assert_eq!(value["c"], serde_json::json!([-1500.0, true, null, 2]));
        assert_eq!((triple(&value, "a"), item(&value, "c", 3)), (None, Some(2.0)));
        assert_eq!(parsed("\u{feff}[1]").unwrap(), serde_json::json!([1]));
    }

    #[test]
    fn what_is_no_json_is_an_error_and_deep_nests_end() {
        for text in ["", "{", "[1,2", "{\"a\": \"", "[[[inf"] {
            assert!(parsed(text).unwrap_err().contains("no JSON"), "{text}");
        }
        let deep = "[".repeat(1_000_000);
        assert!(parsed(&deep).unwrap_err().contains("no JSON"));
        assert!(parsed(&"{\"a\":".repeat(1_000_000)).unwrap_err().contains("line 1"));
    }
}
