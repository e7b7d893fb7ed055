//! `[design]`.

use super::{Bound, Keys, Need, Shape, key};

/// Most starts of a search.
const MAX_STARTS: i64 = 1_000;

pub(crate) static DESIGN: Keys = Keys {
    words: "What `springpot design` moves the parameters for.",
    keys: &[
        key("minimise", Shape::Text, Need::Optional, "The metric that is to be small."),
        key("maximise", Shape::Text, Need::Optional, "The metric that is to be large."),
        key("worst", Shape::Flag, Need::Flag(false), "Of swept cases: whether the worst one counts, or their mean."),
        key(
            "constraints",
            Shape::Tables(&CONSTRAINT, None),
            Need::Optional,
            "What must hold besides, in every case: limits of metrics.",
        ),
        key("starts", Shape::Whole(1, Some(MAX_STARTS)), Need::Number(8.0), "Where the search begins, how often."),
        key("seed", Shape::Whole(0, None), Need::Number(1.0), "Of the starts behind those of the parameters."),
        key(
            "rtol",
            Shape::Number("", Bound::Within(1e-9, 0.1, "1e-6")),
            Need::Number(1e-6),
            "How exactly parameters are found.",
        ),
    ],
};

pub(crate) static CONSTRAINT: Keys = Keys {
    words: "A limit of a metric.",
    keys: &[
        key("metric", Shape::Text, Need::Written("metric = \"peak\""), "The name of a [[metric]]."),
        key("min", Shape::SweptNumber, Need::Optional, "Its smallest value, in its unit."),
        key("max", Shape::SweptNumber, Need::Optional, "Its largest value, in its unit."),
    ],
};
