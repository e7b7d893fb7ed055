//! Indices that no character has: `E_{d}` is E with a lowered d.

/// Size of an index beside that of its text, and how far below the line it stands, em.
pub(crate) const LOWERED: f64 = 0.72;
pub(crate) const DROP: f64 = 0.17;

/// A stretch of a text, on its line or below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Piece<'t> {
    pub(crate) text: &'t str,
    pub(crate) lowered: bool,
}

/// A text in its pieces; braces that do not close stay as they are.
pub(crate) fn pieces(text: &str) -> impl Iterator<Item = Piece<'_>> {
    let (mut rest, mut index) = (text, None);
    std::iter::from_fn(move || {
        if let Some(text) = index.take() {
            return Some(Piece { text, lowered: true });
        }
        let split = rest.find("_{").and_then(|start| {
            let length = rest[start + 2..].find('}').filter(|length| *length > 0)?;
            Some((&rest[..start], &rest[start + 2..start + 2 + length], &rest[start + 3 + length..]))
        });
        let Some((before, lowered, after)) = split else {
            let last = std::mem::take(&mut rest);
            return (!last.is_empty()).then_some(Piece { text: last, lowered: false });
        };
        rest = after;
        if before.is_empty() {
            return Some(Piece { text: lowered, lowered: true });
        }
        index = Some(lowered);
        Some(Piece { text: before, lowered: false })
    })
}

/// The text in one line without marks, for those who hear it.
pub(crate) fn plain(text: &str) -> String {
    pieces(text).map(|piece| piece.text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_told_apart() {
        let shown = |text: &str| -> Vec<String> {
            pieces(text).map(|p| if p.lowered { format!("({})", p.text) } else { p.text.to_owned() }).collect()
        };
        assert_eq!(shown("E_{d} of strut, μ_{0}"), ["E", "(d)", " of strut, μ", "(0)"]);
        assert_eq!(shown("_{d}"), ["(d)"]);
        assert_eq!(shown("wrist_2_link"), ["wrist_2_link"]);
        assert_eq!(shown("a_{b"), ["a_{b"]);
        assert_eq!(shown("a_{}"), ["a_{}"]);
        assert!(shown("").is_empty());
        assert_eq!(plain("Q_{max}, N"), "Qmax, N");
    }
}
