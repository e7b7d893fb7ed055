//! Texts of files as a terminal may have them: what would steer it, or be seen by nobody, is shown in its place.

use springpot_run::table::cut;
use std::borrow::Cow;
use std::io::{self, Write};

/// Longest runs without a blank in a message and in what would be right, characters: longer ones than any name or path.
const LONGEST_RUN: usize = 200;
const LONGEST_RUN_OF_HELP: usize = 1000;
/// Longest name, path or number in a description, characters.
const LONGEST_WORD: usize = 120;
/// Longest message.
const LONGEST: usize = 4000;
/// Longest title.
const LONGEST_TITLE: usize = 100;

/// What stands for a character that a terminal would obey or nobody would see; `None` for all others.
///
/// Control characters of ASCII have pictures (U+2400 …), all else is U+FFFD: C1 controls, marks of direction, blanks and
/// joiners without width, line and paragraph separators, tags.
pub(crate) fn picture(c: char) -> Option<char> {
    match c {
        '\0'..='\u{1f}' => char::from_u32('\u{2400}' as u32 + c as u32),
        '\u{7f}' => Some('\u{2421}'),
        '\u{80}'..='\u{9f}'
        | '\u{ad}'
        | '\u{61c}'
        | '\u{180e}'
        | '\u{200b}'..='\u{200f}'
        | '\u{2028}'..='\u{202e}'
        | '\u{2060}'..='\u{206f}'
        | '\u{feff}'
        | '\u{fff9}'..='\u{fffb}'
        | '\u{e0000}'..='\u{e007f}' => Some(char::REPLACEMENT_CHARACTER),
        _ => None,
    }
}

/// A text on one line.
pub(crate) fn line(text: &str) -> String {
    shown(text, |_| false).into_owned()
}

/// A text of several lines, which may be indented by tabs.
pub(crate) fn lines(text: &str) -> Cow<'_, str> {
    shown(text, |c| matches!(c, '\n' | '\t'))
}

fn shown(text: &str, is_kept: impl Fn(char) -> bool) -> Cow<'_, str> {
    let steers = |c: char| picture(c).filter(|_| !is_kept(c));
    match text.chars().any(|c| steers(c).is_some()) {
        true => text.chars().map(|c| steers(c).unwrap_or(c)).collect::<String>().into(),
        false => text.into(),
    }
}

/// JSON with such characters as `\u` escapes: the same values.
pub(crate) fn json(text: &str) -> Cow<'_, str> {
    // Line ends and blanks stand between values only: in texts they are escapes already.
    let steers = |c: char| picture(c).is_some() && !matches!(c, '\n' | '\r' | '\t');
    if !text.chars().any(steers) {
        return text.into();
    }
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match steers(c) {
            true => c.encode_utf16(&mut [0; 2]).iter().for_each(|unit| escaped.push_str(&format!("\\u{unit:04x}"))),
            false => escaped.push(c),
        }
    }
    escaped.into()
}

/// The title of a scenario: one line that is not too long.
pub(crate) fn title(text: &str) -> String {
    line(&cut(text, LONGEST_TITLE))
}

/// What is wrong: runs without a blank that are too long are cut, and so is the whole.
pub(crate) fn message(text: &str) -> String {
    brief(text, LONGEST_RUN)
}

/// Words of a description, in which names may be of any length.
pub(crate) fn words(text: &str) -> String {
    let words = text.split_inclusive([' ', '\n']).map(|word| cut(word, LONGEST_WORD));
    lines(&words.collect::<String>()).into_owned()
}

/// What would be right.
pub(crate) fn help(text: &str) -> String {
    brief(text, LONGEST_RUN_OF_HELP)
}

fn brief(text: &str, longest_run: usize) -> String {
    let runs = text.split_inclusive([' ', '\n']).map(|run| cut(run, longest_run));
    lines(&cut(&runs.collect::<String>(), LONGEST)).into_owned()
}

/// Rows on the way to a terminal. Each piece that is written must be whole characters.
pub(crate) struct Plain<W>(pub(crate) W);

impl<W: Write> Write for Plain<W> {
    fn write(&mut self, piece: &[u8]) -> io::Result<usize> {
        self.0.write_all(lines(&String::from_utf8_lossy(piece)).as_bytes())?;
        Ok(piece.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_is_shown_and_the_rest_stays() {
        let steering = "a\u{1b}]0;x\u{7}\u{9b}\u{202e}b\u{200b}\u{2066}c\u{7f}\nd\te";
        assert_eq!(line(steering), "a␛]0;x␇\u{fffd}\u{fffd}b\u{fffd}\u{fffd}c␡␊d␉e");
        assert_eq!(lines("a\n\tb\r"), "a\n\tb␍");
        let ordinary = "π m² größer Ω 力学 q\u{308} \u{a0}→ «…» 🤖";
        assert_eq!(line(ordinary), ordinary);
        for c in (0..=0x10_ffff).filter_map(char::from_u32) {
            let one = line(c.encode_utf8(&mut [0; 4]));
            assert!(one.chars().count() == 1 && !one.chars().any(char::is_control), "{c:?}");
        }
    }

    #[test]
    fn escaped_json_has_the_same_values() {
        let names = ["a\u{1b}\n\t\u{202e}\u{9b}b", "π \u{e0041}", "plain"];
        let text = serde_json::to_string_pretty(&names).unwrap();
        let escaped = json(&text);
        assert!(escaped.chars().all(|c| c == '\n' || picture(c).is_none()), "{escaped}");
        assert!(
            escaped.contains("\\u202e") && escaped.contains("\\udb40\\udc41") && escaped.contains('π'),
            "{escaped}"
        );
        assert_eq!(serde_json::from_str::<Vec<String>>(&escaped).unwrap(), names);
    }

    #[test]
    fn titles_and_messages_are_cut() {
        assert_eq!(title(&"é".repeat(500)).chars().count(), LONGEST_TITLE);
        let long = message(&format!("value {} is wrong\nand more", "9".repeat(1_000_000)));
        assert!(long.starts_with("value 99") && long.ends_with("9 is wrong\nand more"), "{long}");
        assert!(long.chars().count() < LONGEST_RUN + 30);
        assert_eq!(message(&"word ".repeat(100_000)).chars().count(), LONGEST);
    }
}
