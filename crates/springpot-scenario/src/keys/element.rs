//! `[[element]]`.

use super::{ANCHOR, Bound, Keys, Need, Shape, key};
use springpot::law::Derivative;

/// Names that would collide with columns of the results.
pub(crate) const RESERVED_NAMES: [&str; 7] = ["t", "q", "v", "a", "tau", "energy", "gripper"];

pub(crate) static ELEMENT: Keys = Keys {
    words: "A material between two points of two bodies.",
    keys: &[
        key(
            "name",
            Shape::Name(&RESERVED_NAMES),
            Need::Written,
            "Name of the element; begins the names of its columns.",
        ),
        key("from", Shape::Table(&ANCHOR), Need::Required, "First end."),
        key("to", Shape::Table(&ANCHOR), Need::Required, "Second end."),
        key("rest_length", Shape::Number("m", Bound::NotNegative), Need::Required, "Length at which the stroke is 0."),
        key("law", Shape::Law, Need::Required, "Name of the law: `springpot laws` lists them."),
        key("parameters", Shape::ByName, Need::Optional, "Parameters, as the law says."),
        key("inputs", Shape::ByName, Need::Optional, "Inputs, as the law says: functions of time."),
        key(
            "derivative",
            Shape::Words(|| [Derivative::Caputo, Derivative::RiemannLiouville].map(|kind| kind.name()).to_vec()),
            Need::Word("caputo"),
            "What happened before t = 0: held at x(0), or unloaded.",
        ),
        key(
            "scheme",
            Shape::Scheme,
            Need::Word("exact"),
            "The exact memory, or a named scheme on the grid of the rows.",
        ),
    ],
};
