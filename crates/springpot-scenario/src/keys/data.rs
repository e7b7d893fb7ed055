//! `[[data]]` and `[fit]`.

use super::motion::{SEPARATOR, TIME_COLUMN, TIME_UNIT};
use super::{Bound, Keys, Need, Shape, key};

/// The kinds of records.
pub(crate) const RUN: &str = "run";
pub(crate) const STROKE: &str = "stroke";
pub(crate) const DMA: &str = "dma";
pub(crate) const RELAXATION: &str = "relaxation";
pub(crate) const CREEP: &str = "creep";

const KINDS: [(&str, &str); 5] = [
    (RUN, "`\"run\"`: columns of the run of this scenario"),
    (STROKE, "`\"stroke\"`: the force of one element along a measured stroke"),
    (DMA, "`\"dma\"`: storage and loss of one element over the frequency"),
    (RELAXATION, "`\"relaxation\"`: its force under a stroke of 1 from t = 0 on"),
    (CREEP, "`\"creep\"`: its stroke under a force of 1 from t = 0 on"),
];

/// Those over the time.
const OVER_TIME: &[&str] = &[RUN, STROKE, RELAXATION, CREEP];
const OF_ELEMENTS: &[&str] = &[STROKE, DMA, RELAXATION, CREEP];
const OF_MODULI: &[&str] = &[DMA, RELAXATION, CREEP];
const OF_COLUMNS: &[&str] = &[RUN, STROKE];

pub(crate) static DATA: Keys = Keys {
    words: "A record of measurements, to be fitted or predicted.",
    keys: &[
        key("name", Shape::Name(&[]), Need::Said("data-1, …"), "Name of the record."),
        key("kind", Shape::Kinds(|| KINDS.to_vec()), Need::Word(RUN), ""),
        key("csv", Shape::Text, Need::Written("csv = \"FILE\""), "Path of the CSV file, relative to the scenario."),
        key(
            "columns",
            Shape::ColumnsByName(&DATA_COLUMN),
            Need::Written("columns = { \"q.q2\" = \"encoder2\" }"),
            "What was measured: of the column of a run, or of the kind, the column of the file.",
        ),
        key("element", Shape::Text, Need::Optional, "The element that it is of.").only(OF_ELEMENTS),
        TIME_COLUMN.only(OF_COLUMNS),
        TIME_UNIT.only(OF_COLUMNS),
        SEPARATOR,
        key("window", Shape::Pair("s"), Need::Said("all rows"), "Only rows with t in between count.").only(OVER_TIME),
        key(
            "set",
            Shape::ByName,
            Need::Optional,
            "The conditions of this record: values by path, as `--set` takes them.",
        ),
        key("free", Shape::Texts, Need::Optional, "Paths of parameters of this record alone.").only(OF_COLUMNS),
        key("offset", Shape::Texts, Need::Optional, "Columns whose zero is unknown.").only(OF_COLUMNS),
        key("delay", Shape::Texts, Need::Optional, "Columns that are late by an unknown time.").only(OF_COLUMNS),
        key(
            "past",
            Shape::Words(|| vec!["held", "unloaded", "free"]),
            Need::Word("held"),
            "What was before the record: held at its first stroke, unloaded, or unknown and fitted.",
        )
        .only(&[STROKE]),
        key(
            "low_pass",
            Shape::Number("Hz", Bound::Positive),
            Need::Optional,
            "Stroke and force go through this low-pass, forwards and backwards.",
        )
        .only(&[STROKE]),
        key(
            "relative_sd",
            Shape::Number("", Bound::Positive),
            Need::Said("estimated"),
            "Standard deviation of both columns, as a share.",
        )
        .only(OF_MODULI),
        key("area", Shape::Number("m^2", Bound::Positive), Need::Optional, "Of the sample, where moduli are given.")
            .only(OF_MODULI),
        key("length", Shape::Number("m", Bound::Positive), Need::Optional, "Of the sample, where moduli are given.")
            .only(OF_MODULI),
        key(
            "use",
            Shape::Words(|| vec!["fit", "validation"]),
            Need::Word("fit"),
            "Whether it is fitted, or predicted and scored alone.",
        ),
        key(
            "loss",
            Shape::WordsOr(|| vec!["squares"], &HUBER),
            Need::Word("squares"),
            "How residuals add to the cost.",
        ),
    ],
};

/// A column of a record.
pub(crate) static DATA_COLUMN: Keys = Keys {
    words: "A column of a CSV file that was measured.",
    keys: &[
        key("column", Shape::Text, Need::Written("column = \"NAME\""), "Its name in the file."),
        key("unit", Shape::Text, Need::Said("in brackets behind its name, else SI"), "Unit of its numbers."),
        key("sd", Shape::OfColumn, Need::Said("estimated"), "Standard deviation of its numbers."),
        key("sd_column", Shape::Text, Need::Optional, "In place of `sd`: the column that holds it, in the same unit."),
    ],
};

pub(crate) static HUBER: Keys = Keys {
    words: "Squares up to a multiple of the standard deviation, straight beyond.",
    keys: &[key("huber", Shape::Number("", Bound::Positive), Need::Written("huber = 1.345"), "The multiple.")],
};

/// Most starts.
const MAX_STARTS: i64 = 100_000;

pub(crate) static FIT: Keys = Keys {
    words: "How the parameters are fitted.",
    keys: &[
        key(
            "starts",
            Shape::Whole(1, Some(MAX_STARTS)),
            Need::Number(20.0),
            "Starts: those of the parameters first, then a Latin hypercube.",
        ),
        key("seed", Shape::Whole(0, None), Need::Number(1.0), "Of the random numbers."),
        key(
            "confidence",
            Shape::Number("", Bound::Within(0.5, 0.9999, "write a number such as 0.95")),
            Need::Number(0.95),
            "Of the intervals.",
        ),
        key(
            "intervals",
            Shape::Text,
            Need::Word("wald"),
            "How intervals are found: \"wald\", \"profile\" or \"bootstrap(COUNT)\".",
        ),
        key(
            "laws",
            Shape::TextList,
            Need::Optional,
            "Laws to be fitted one after the other, in place of that of `element`.",
        ),
        key("element", Shape::Text, Need::Optional, "The element whose law `laws` replace."),
    ],
};
