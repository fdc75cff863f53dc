//! What a file that is no scan of ours looks like, in words, so that the message helps.

use super::ScanError;
use std::path::Path;

/// First bytes, what they mean.
const SIGNATURES: &[(&[u8], &str)] = &[
    (b"ASTM-E57", "it is an E57 file"),
    (b"# .PCD", "it is a PCD file"),
    (b"VERSION .7", "it is a PCD file"),
    (b"PK\x03\x04", "it is a ZIP archive"),
    (b"\x1f\x8b", "it is a gzip archive"),
    (b"\x28\xb5\x2f\xfd", "it is a Zstandard archive"),
    (b"glTF", "it is a glTF model"),
    (b"II*\0", "it is a TIFF picture"),
    (b"MM\0*", "it is a TIFF picture"),
    (b"\x89PNG", "it is a PNG picture"),
    (b"\xff\xd8\xff", "it is a JPEG picture"),
    (b"%PDF", "it is a PDF document"),
];

/// The error for a file that starts with `head` and has no reader.
pub(crate) fn not_a_scan(path: &Path, head: &[u8]) -> ScanError {
    let (looks_like, advice) = describe(head);
    ScanError::NotAScan { path: path.to_owned(), looks_like, advice }
}

fn describe(head: &[u8]) -> (String, &'static str) {
    const CONVERT: &str = "this is not supported yet, convert it to LAS, LAZ or PLY";
    if head.is_empty() {
        return ("it is empty".into(), "copy or download it again");
    }
    if head.starts_with(b"version https://git-lfs") {
        let advice = "fetch the real file with `git lfs pull`";
        return ("it is a Git LFS pointer, a note of where the real file lies".into(), advice);
    }
    if let Some((_, what)) = SIGNATURES.iter().find(|(signature, _)| head.starts_with(signature)) {
        return ((*what).into(), CONVERT);
    }
    if head.trim_ascii_start().starts_with(b"<") {
        return ("it is XML or a web page".into(), "check where it was downloaded from");
    }
    if head.trim_ascii_start().starts_with(b"{") {
        return ("it is JSON (perhaps of an EPT or Potree folder)".into(), CONVERT);
    }
    if is_text(head) {
        return ("it is text".into(), CONVERT);
    }
    let start: Vec<String> = head.iter().take(4).map(|byte| format!("{byte:02x}")).collect();
    let looks_like = format!("it starts with the bytes {}, as no scan does", start.join(" "));
    (looks_like, "it is damaged or of another kind; get it again or convert it to LAS, LAZ or PLY")
}

/// Printable characters and white space only. A cut multi-byte character at the end is no counter-proof.
fn is_text(head: &[u8]) -> bool {
    let text = match std::str::from_utf8(head) {
        Ok(text) => text,
        Err(error) if error.error_len().is_none() => {
            std::str::from_utf8(&head[..error.valid_up_to()]).unwrap_or_default()
        }
        Err(_) => return false,
    };
    !text.is_empty() && text.chars().all(|c| !c.is_control() || c.is_whitespace())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_what_it_sees() {
        let cases: [(&[u8], &str); 6] = [
            (b"", "empty"),
            (b"version https://git-lfs.github.com/spec/v1\noid sha256:", "Git LFS"),
            (b"ASTM-E57\x01\0\0\0", "E57"),
            (b"  <html>", "web page"),
            ("1.0 2.0 3.0 \u{e9}\n".as_bytes(), "text"),
            (b"\x8f\x00\x01\x02", "8f 00 01 02"),
        ];
        for (head, expected) in cases {
            let message = not_a_scan(Path::new("a.las"), head).to_string();
            assert!(message.starts_with("a.las: ") && message.contains(expected), "{message}");
        }
    }

    #[test]
    fn text_cut_in_a_character_is_text_and_binary_is_not() {
        assert!(is_text(&"abc é".as_bytes()[..5]));
        assert!(!is_text(b"abc\xff\xfedef"));
        assert!(!is_text(b"abc\0"));
    }
}
