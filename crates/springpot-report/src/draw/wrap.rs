//! Long texts in several lines.

use super::Font;

/// Splits a text at blanks into lines no wider than `width` pixels; a word that is too long is split anywhere, and what does not
/// fit into `most` lines ends in "…". Line breaks and other control characters count as blanks. Never empty.
pub(crate) fn wrap(font: &Font, text: &str, size: f64, width: f64, most: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    let fits = |line: &str| font.width(line, size) <= width;
    let words = text.split(|c: char| c.is_whitespace() || c.is_control()).filter(|word| !word.is_empty());
    'words: for word in words {
        let last = lines.len() - 1;
        let joined = if lines[last].is_empty() { word.to_owned() } else { format!("{} {word}", lines[last]) };
        if fits(&joined) {
            lines[last] = joined;
            continue;
        }
        let mut rest = word;
        if !lines[last].is_empty() {
            if lines.len() == most {
                end_early(&mut lines, fits);
                break 'words;
            }
            lines.push(String::new());
        }
        while !fits(rest) {
            let cut = head(rest, fits);
            let last = lines.len() - 1;
            lines[last] = rest[..cut].to_owned();
            rest = &rest[cut..];
            if rest.is_empty() {
                continue 'words;
            }
            if lines.len() == most {
                end_early(&mut lines, fits);
                break 'words;
            }
            lines.push(String::new());
        }
        let last = lines.len() - 1;
        lines[last] = rest.to_owned();
    }
    lines
}

/// Length in bytes of the longest beginning that fits; at least one character.
fn head(word: &str, fits: impl Fn(&str) -> bool) -> usize {
    let ends = word.char_indices().map(|(start, c)| start + c.len_utf8());
    let first = word.chars().next().map_or(0, char::len_utf8);
    ends.take_while(|end| fits(&word[..*end])).last().unwrap_or(first)
}

/// Ends the last line in "…", shortened until it fits.
fn end_early(lines: &mut [String], fits: impl Fn(&str) -> bool) {
    if let Some(line) = lines.last_mut() {
        while !line.is_empty() && !fits(&format!("{line}…")) {
            line.pop();
        }
        line.push('…');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn breaks_at_blanks_and_keeps_every_word() {
        let font = Font::load().unwrap();
        let text = "Generalized force of the strut at five temperatures";
        let lines = wrap(&font, text, 10.0, 120.0, 9);
        assert!(lines.len() > 2);
        assert!(lines.iter().all(|line| font.width(line, 10.0) <= 120.0));
        assert_eq!(lines.join(" "), text);
    }

    #[test]
    fn long_words_and_long_texts() {
        let font = Font::load().unwrap();
        let word = "m".repeat(100);
        let lines = wrap(&font, &word, 10.0, 100.0, 99);
        assert_eq!(lines.concat(), word);
        let lines = wrap(&font, &word, 10.0, 100.0, 2);
        assert_eq!(lines.len(), 2);
        assert!(lines[1].ends_with('…') && font.width(&lines[1], 10.0) <= 100.0);
        assert_eq!(wrap(&font, "", 10.0, 100.0, 2), [""]);
        assert_eq!(wrap(&font, "a\nb\tc", 10.0, 100.0, 2), ["a b c"]);
        assert_eq!(wrap(&font, "ab", 10.0, 0.0, 3), ["a", "b"]);
    }
}
