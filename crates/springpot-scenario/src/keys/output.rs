//! `[output]`.

use super::{Keys, Need, Shape, key};

pub(crate) static OUTPUT: Keys = Keys {
    words: "What is written.",
    keys: &[
        key(
            "columns",
            Shape::Columns,
            Need::Said("all"),
            "Columns of results.csv and summary.csv: a name, a glob, or an array of them.",
        ),
        key(
            "leaves",
            Shape::Flag,
            Need::Flag(false),
            "Whether each leaf of a law has columns: ELEMENT.LEAF.stroke, .rate, .force and .derivative.",
        ),
    ],
};
