//! Texts as fields of CSV files (RFC 4180).

use std::borrow::Cow;

/// A cell as it is written: in quotes where it must be.
pub fn quoted(cell: &[u8]) -> Cow<'_, [u8]> {
    if !cell.iter().fold(false, |found, byte| found | matches!(byte, b',' | b'"' | b'\n' | b'\r')) {
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

/// Stands where a text was cut.
pub const CUT: char = '…';

/// Longest field of a table that a message repeats, characters.
const LONGEST_FIELD: usize = 60;

/// A text of at most `most` characters: two thirds from the beginning of a longer one, the rest from its end.
pub fn cut(text: &str, most: usize) -> Cow<'_, str> {
    // No text has more characters than bytes.
    let count = if text.len() <= most { 0 } else { text.chars().count() };
    if count <= most {
        return text.into();
    }
    let head = 2 * most / 3;
    let tail = most - head - 1;
    text.chars().take(head).chain([CUT]).chain(text.chars().skip(count - tail)).collect::<String>().into()
}

/// A field of a table in a message, in quotes.
pub fn cut_field(text: &[u8]) -> String {
    format!("{:?}", cut(&String::from_utf8_lossy(text), LONGEST_FIELD))
}

#[cfg(test)]
mod tests {
    use super::{LONGEST_FIELD, cut, cut_field, push_text, quoted};

    #[test]
    fn long_texts_are_cut() {
        assert_eq!(cut("abcdefghij", 10), "abcdefghij");
        assert_eq!(cut("abcdefghijk", 10), "abcdef…ijk");
        assert_eq!(cut("ääääääääää", 10), "ääääääääää");
        assert_eq!(cut_field(&[b'x'; 100]).chars().count(), LONGEST_FIELD + 2);
    }

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
