//! Texts as fields of CSV files (RFC 4180).

use std::borrow::Cow;

/// A cell as it is written: in quotes where it must be.
pub fn quoted(cell: &[u8]) -> Cow<'_, [u8]> {
    if !cell.iter().any(|byte| matches!(byte, b',' | b'"' | b'\n' | b'\r')) {
        return Cow::Borrowed(cell);
    }
    let mut text = vec![b'"'];
    for byte in cell {
        text.extend_from_slice(if *byte == b'"' { b"\"\"" } else { std::slice::from_ref(byte) });
    }
    text.push(b'"');
    Cow::Owned(text)
}

/// Appends a text as one field.
pub fn push_text(line: &mut String, text: &str) {
    line.push_str(&String::from_utf8_lossy(&quoted(text.as_bytes())));
}

#[cfg(test)]
mod tests {
    use super::{push_text, quoted};

    #[test]
    fn quotes_where_they_must_be() {
        let text = |text: &str| {
            let mut line = String::new();
            push_text(&mut line, text);
            line
        };
        for plain in ["", "a b", "N*s^0.3/m", "it's", "µ; 5"] {
            assert_eq!(text(plain), plain);
        }
        assert_eq!(text("a,b"), "\"a,b\"");
        assert_eq!(text("6\" pipe"), "\"6\"\" pipe\"");
        assert_eq!(text("two\r\nlines"), "\"two\r\nlines\"");
        // Bytes that are no text pass.
        assert_eq!(*quoted(b"\xff,"), *b"\"\xff,\"");
    }
}
