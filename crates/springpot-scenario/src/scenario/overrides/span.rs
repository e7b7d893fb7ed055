//! `FROM:TO:COUNT` and `FROM:TO:COUNT:log` behind `--sweep`.

use super::split;
use crate::units;
use std::ops::Range;

/// What is wrong, and where.
type Wrong = (Range<usize>, String);

/// The parts of a span that stands in `value`, as many as are written; `None` where no span is meant.
pub(super) fn ends(text: &str, value: Range<usize>) -> Result<Option<Vec<Range<usize>>>, Wrong> {
    let written = &text[value.clone()];
    let ends = split(text, value.clone(), ':');
    if ends.len() == 1 {
        let dots = written.find("..").filter(|dots| is_number(&written[..*dots]));
        return match dots {
            Some(dots) => {
                let at = value.start + dots;
                Err((
                    at..at + 2,
                    format!("{written} is no span: colons stand between its ends, and a count behind them"),
                ))
            }
            None => Ok(None),
        };
    }
    if !is_number(&text[ends[0].clone()]) {
        return Ok(None);
    }
    if let Some(empty) = ends.iter().find(|end| end.is_empty()) {
        return Err((empty.start..text.len().min(empty.end + 1), format!("{written} lacks a number")));
    }
    match ends.len() {
        2 => Err((value, format!("{written} has two ends and no count"))),
        3 | 4 => Ok(Some(ends)),
        _ => Err((ends[4].clone(), format!("{written} has {} parts", ends.len()))),
    }
}

/// Whether a text is a number, with a unit or without.
fn is_number(text: &str) -> bool {
    text.trim().parse::<f64>().is_ok() || units::split_quantity(text).is_some()
}
