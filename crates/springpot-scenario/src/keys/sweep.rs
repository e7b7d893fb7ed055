//! `[[sweep]]`.

use super::{Key, Keys, Need, Shape, key};

/// Most values of one sweep, and most cases of a grid.
pub const MAX_CASES: usize = 10_000_000;
/// Most blocks.
pub(crate) const MAX_BLOCKS: usize = 16;
/// Most parameters that move together.
pub(crate) const MAX_TOGETHER: usize = 64;

pub(crate) static SWEEP: Keys = Keys {
    words: "Parameters that move together, and their values.",
    keys: &[
        key(
            "parameter",
            Shape::Paths(MAX_TOGETHER),
            Need::Written("parameter = \"element.NAME.PARAMETER\""),
            "A path such as \"element.NAME.alpha\", or paths that take the same value.",
        ),
        key(
            "values",
            Shape::ValuesOr(&SPAN),
            Need::Written("values = [ … ] or values = { from = …, to = …, count = … }"),
            "An array of values, or a table with from, to and count.",
        ),
        key(
            "names",
            Shape::TextList,
            Need::Optional,
            "What the values are called in legends, pages, reports and summaries, one for each.",
        ),
    ],
};

const SPAN_KEYS: &str = "from, to and count";

pub(crate) static SPAN: Keys = Keys {
    words: "Values from one number to another.",
    keys: &[
        key("from", Shape::SweptNumber, Need::Written(SPAN_KEYS), "First value."),
        key("to", Shape::SweptNumber, Need::Written(SPAN_KEYS), "Last value."),
        key("count", Shape::Whole(2, Some(MAX_CASES as i64)), Need::Written(SPAN_KEYS), "Number of values."),
        SCALE,
    ],
};

/// How numbers lie between two ends.
pub(super) const SCALE: Key =
    key("scale", Shape::Words(|| vec!["linear", "log"]), Need::Word("linear"), "Equal differences or equal ratios.");
