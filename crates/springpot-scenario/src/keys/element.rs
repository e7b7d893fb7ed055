//! `[[element]]`.

use super::robot::NAME;
use super::{ANCHOR, Bound, Field, Keys, Need, Shape, Slot, key};
use springpot::elements::Element;
use springpot::law::Derivative;

/// Names that would collide with columns of the results.
pub(crate) const RESERVED_NAMES: [&str; 7] = ["t", "q", "v", "a", "tau", "energy", "gripper"];

/// The rest length that is the length at t = 0.
pub(crate) const START: &str = "start";

/// Pasts by name.
pub(crate) const PASTS: [&str; 3] = ["held", "unloaded", "steady"];

/// A past that began at some time.
pub(crate) static HELD: Keys = Keys {
    words: "Stretched at once to x(0), so long before t = 0, and held there.",
    keys: &[key("held", Shape::Number("s", Bound::Positive), Need::Required("held = \"30 s\""), "For how long.")],
};

pub(crate) static ELEMENT: Keys = Keys {
    words: "A material between two points of two bodies.",
    keys: &[
        key(
            "name",
            Shape::Name(&RESERVED_NAMES),
            Need::Written(NAME),
            "Name of the element; begins the names of its columns.",
        ),
        key(
            "from",
            Shape::Table(&ANCHOR),
            Need::Required("from = { body = \"NAME\", point = [x, y, z] }"),
            "First end.",
        ),
        key("to", Shape::Table(&ANCHOR), Need::Required("to = { body = \"NAME\", point = [x, y, z] }"), "Second end."),
        key(
            "rest_length",
            Shape::NumberOrWord("m", Bound::Length, START),
            Need::Required("rest_length = \"70 cm\" or \"start\""),
            "Length at which the stroke is 0; \"start\": the length at t = 0, exactly.",
        ),
        key("law", Shape::Law, Need::OneOf, "Name of the law: `springpot laws` lists them."),
        key(
            "network",
            Shape::Text,
            Need::OneOf,
            "In place of a law: leaves in series and in parallel, such as \"series(spring(k), dashpot(c))\".",
        ),
        key("parameters", Shape::ByName, Need::Optional, "Parameters, as the law says."),
        key("inputs", Shape::ByName, Need::Optional, "Inputs, as the law says: functions of time."),
        key(
            "derivative",
            Shape::Words(|| [Derivative::Caputo, Derivative::RiemannLiouville].map(|kind| kind.name()).to_vec()),
            Need::Word("caputo"),
            "What happened before t = 0: held at x(0), or unloaded.",
        ),
        key(
            "past",
            Shape::WordsOr(|| PASTS.to_vec(), &HELD),
            Need::Optional,
            "What happened before t = 0, in place of `derivative`: held since ever, unloaded, steady, or held for a while.",
        ),
        key(
            "period",
            Shape::Number("s", Bound::Positive),
            Need::Optional,
            "With past = \"steady\": the period of the stroke, which was always what it is from t = 0 on.",
        ),
        key(
            "scheme",
            Shape::Scheme,
            Need::Word("exact"),
            "The exact memory, or a named scheme on the grid of the rows.",
        ),
    ],
};

/// Its keys that are numbers of the element.
pub(crate) const ELEMENT_FIELDS: &[Field<Element>] = &[("rest_length", |element| Slot::Number(&mut element.rest))];
