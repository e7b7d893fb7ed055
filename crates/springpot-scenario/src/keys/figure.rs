//! `[[figure]]` and `[output]`.

use super::{Keys, Need, Shape, key};

const CURVES: &[&str] = &["curves"];

/// The kinds of it that `only` knows are the kinds of figures.
pub(crate) static FIGURE: Keys = Keys {
    words: "A figure of curves, or of the robot.",
    keys: &[
        key("name", Shape::FileName, Need::Said("figure-1, …"), "Name of its files without an ending."),
        key("title", Shape::Text, Need::Said("none"), "Title."),
        key("x", Shape::Column, Need::Word("t"), "Column of the abscissa.").only(CURVES),
        key(
            "y",
            Shape::Columns,
            Need::Required("y = [\"strut.Q.q2\"]: the columns to draw"),
            "A column, a glob such as \"strut.Q.*\", or an array of them.",
        )
        .only(CURVES),
        key("units", Shape::TextsByName, Need::Said("SI"), "Units to draw columns in, by column or glob.").only(CURVES),
        key("where", Shape::ByName, Need::Said("all cases"), "Only the cases with these values, by swept path."),
        key("kind", Shape::Words(|| vec!["curves", "robot"]), Need::Word("curves"), "What is drawn."),
    ],
};

pub(crate) static OUTPUT: Keys = Keys {
    words: "What is written.",
    keys: &[key(
        "columns",
        Shape::Columns,
        Need::Said("all"),
        "Columns of results.csv and summary.csv: a name, a glob, or an array of them.",
    )],
};
