//! Long texts in several lines.

use super::Font;

/// Splits a text at blanks into lines no wider than `width` pixels; a word that is too long is split anywhere, and what does not
/// fit into `most` lines ends in "…". Equations stay whole, and what follows the last comma, a unit, does not stand alone, where there is
/// room. Line breaks and other control characters count as blanks. Never empty.
pub(crate) fn wrap(font: &Font, text: &str, size: f64, width: f64, most: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    let fits = |line: &str| font.width(line, size) <= width;
    let words = words(text, fits);
    'words: for word in words.iter().map(String::as_str) {
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

/// As [`wrap`], but what does not fit is left out before the last line, which keeps the end of the text behind a "…".
pub(crate) fn wrap_to_end(font: &Font, text: &str, size: f64, width: f64, most: usize) -> Vec<String> {
    let mut lines = wrap(font, text, size, width, usize::MAX);
    if lines.len() <= most {
        return lines;
    }
    lines.truncate(most);
    let text = text.trim_end();
    let ends = text.char_indices().rev().map(|(start, _)| format!("…{}", &text[start..]));
    let longest = ends.take_while(|end| font.width(end, size) <= width).last();
    if let (Some(line), Some(end)) = (lines.last_mut(), longest) {
        *line = end;
    }
    lines
}

/// As [`wrap`], in lines of about one length.
pub(crate) fn wrap_evenly(font: &Font, text: &str, size: f64, width: f64, most: usize) -> Vec<String> {
    let whole = wrap(font, text, size, width, most);
    let narrower = (1..).map(|step| wrap(font, text, size, width - 4.0 * f64::from(step), most));
    // Lines that hold other text have split a word or ended early.
    let is_as_good = |lines: &Vec<String>| lines.len() == whole.len() && lines.join(" ") == whole.join(" ");
    if whole.len() < 2 { whole } else { narrower.take_while(is_as_good).last().unwrap_or(whole.clone()) }
}

/// What lines are broken between.
fn words(text: &str, fits: impl Fn(&str) -> bool) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut single =
        text.split(|c: char| c.is_whitespace() || c.is_control()).filter(|word| !word.is_empty()).peekable();
    while let Some(word) = single.next() {
        let is_last = single.peek().is_none();
        match words.last_mut() {
            Some(before)
                if (word == "=" || before.ends_with(" =") || (is_last && before.ends_with(',')))
                    && fits(&format!("{before} {word}")) =>
            {
                before.push(' ');
                before.push_str(word);
            }
            _ => words.push(word.to_owned()),
        }
    }
    words
}

/// Length in bytes of the longest beginning that fits, behind a mark between parts of a name where there is one in its second half; at least one
/// character.
fn head(word: &str, fits: impl Fn(&str) -> bool) -> usize {
    let ends = word.char_indices().map(|(start, c)| start + c.len_utf8());
    let first = word.chars().next().map_or(0, char::len_utf8);
    let longest = ends.take_while(|end| fits(&word[..*end])).last().unwrap_or(first);
    let behind_mark = word[..longest].rfind(['_', '-', '.']).map(|mark| mark + 1);
    behind_mark.filter(|cut| 2 * cut >= longest).unwrap_or(longest)
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
    fn equations_and_units_stay_whole() {
        let font = Font::load().unwrap();
        let width = |text: &str| font.width(text, 10.0) + 0.1;
        let lines = |text: &str, longest: &str| wrap(&font, text, 10.0, width(longest), 3);
        assert_eq!(lines("the damper, α = 0.5", "the damper, α ="), ["the damper,", "α = 0.5"]);
        assert_eq!(lines("stroke x of gauge, pm", "stroke x of gauge,"), ["stroke x of", "gauge, pm"]);
        assert_eq!(lines("U = 60·sin(t)", "60·sin(t)"), ["U =", "60·sin(t)"]);
        let evenly = |text: &str, longest: &str| wrap_evenly(&font, text, 10.0, width(longest), 3);
        assert_eq!(
            evenly("forces of the strut and the strap", "forces of the strut and the"),
            ["forces of the strut", "and the strap"]
        );
        assert_eq!(evenly("forces of the strut", "forces of the strut"), ["forces of the strut"]);
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
        let lines = wrap(&font, "strut_between_world_and_forearm", 10.0, font.width("strut_between_world_an", 10.0), 3);
        assert_eq!(lines, ["strut_between_world_", "and_forearm"]);
        let (one, other) = (format!("{word}_left"), format!("{word}_right"));
        let ends = [&one, &other].map(|text| wrap_to_end(&font, text, 10.0, 100.0, 2));
        assert!(ends.iter().flatten().all(|line| font.width(line, 10.0) <= 100.0) && ends[0].len() == 2);
        assert!(ends[0][1].starts_with('…') && ends[0][1].ends_with("m_left") && ends[1][1].ends_with("m_right"));
        assert_eq!(wrap_to_end(&font, "short one", 10.0, 100.0, 2), ["short one"]);
        assert_eq!(wrap(&font, "", 10.0, 100.0, 2), [""]);
        assert_eq!(wrap(&font, "a\nb\tc", 10.0, 100.0, 2), ["a b c"]);
        assert_eq!(wrap(&font, "ab", 10.0, 0.0, 3), ["a", "b"]);
    }
}
