//! Names that ROS takes.

use std::collections::HashSet;

/// Characters of a name that is made of another.
const LONGEST: usize = 60;
/// Bytes of the name of a frame or a joint, which stand in every message.
const LONGEST_FRAME: usize = 255;

/// Names of one kind, no two alike.
#[derive(Debug, Default)]
pub(super) struct Names {
    taken: HashSet<String>,
}

impl Names {
    /// Some that are taken already.
    pub(super) fn with(taken: &[&str]) -> Self {
        Self { taken: taken.iter().map(|name| (*name).to_owned()).collect() }
    }

    /// The name, or with the first number behind it that makes it another one.
    pub(super) fn take(&mut self, name: String) -> String {
        let mut count = 1;
        let mut own = name.clone();
        while !self.taken.insert(own.clone()) {
            count += 1;
            own = format!("{name}_{count}");
        }
        own
    }
}

/// A field: lower-case letters, digits and single underscores, a letter first and no underscore last.
pub(super) fn field(name: &str) -> String {
    let mut made = String::new();
    for c in name.chars().take(LONGEST) {
        match c {
            c if c.is_ascii_alphanumeric() => made.push(c.to_ascii_lowercase()),
            _ if !made.is_empty() && !made.ends_with('_') => made.push('_'),
            _ => {}
        }
    }
    let made = made.trim_end_matches('_');
    match made.chars().next() {
        None => "value".to_owned(),
        Some(c) if c.is_ascii_digit() => format!("n{made}"),
        Some(_) => made.to_owned(),
    }
}

/// A part of a topic: letters, digits and single underscores, a letter first.
pub(super) fn token(name: &str) -> String {
    let mut made = String::new();
    for c in name.chars().take(LONGEST) {
        match c {
            c if c.is_ascii_alphanumeric() => made.push(c),
            _ if !made.ends_with('_') => made.push('_'),
            _ => {}
        }
    }
    match made.chars().next() {
        Some(c) if c.is_ascii_alphabetic() => made,
        _ => format!("e{made}"),
    }
}

/// A type: letters and digits, an upper-case letter first.
pub(super) fn kind(name: &str) -> String {
    let mut made = String::new();
    let mut starts = true;
    for c in name.chars().take(LONGEST) {
        match c.is_ascii_alphanumeric() {
            true if starts => made.push(c.to_ascii_uppercase()),
            true => made.push(c),
            false => {}
        }
        starts = !c.is_ascii_alphanumeric();
    }
    match made.chars().next() {
        Some(c) if c.is_ascii_alphabetic() => made,
        _ => format!("E{made}"),
    }
}

/// A frame or a joint: what it is called, but no longer than a message can afford.
pub(super) fn frame(name: &str) -> String {
    let ends = (0..=LONGEST_FRAME.min(name.len())).rev();
    let end = ends.into_iter().find(|end| name.is_char_boundary(*end)).unwrap_or_default();
    name[..end].replace('\0', " ")
}

/// A text as a comment of a definition: one line, of some length.
pub(super) fn comment(text: &str) -> String {
    text.chars()
        .take(4 * LONGEST)
        .map(|c| if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}') { ' ' } else { c })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_legal_and_no_two_alike() {
        for (name, expected) in [
            ("force", "force"),
            ("Q.q1", "q_q1"),
            ("T", "t"),
            ("", "value"),
            ("é", "value"),
            ("2nd__x_", "n2nd_x"),
            ("<script>", "script"),
        ] {
            assert_eq!(field(name), expected);
        }
        assert_eq!(
            (token("mount.rx"), token("1"), token("_a"), token("")),
            ("mount_rx".into(), "e1".into(), "e_a".into(), "e".into())
        );
        assert_eq!((kind("elbow_strut-2"), kind("7"), kind("…")), ("ElbowStrut2".into(), "E7".into(), "E".into()));
        assert_eq!(field(&"x".repeat(100_000)).len(), LONGEST);
        assert_eq!(frame(&"é".repeat(1000)).len(), 254);
        let mut names = Names::with(&["header"]);
        let made: Vec<String> = ["header", "t", "t", "t_2"].map(|name| names.take(name.to_owned())).into();
        assert_eq!(made, ["header_2", "t", "t_2", "t_2_2"]);
    }
}
