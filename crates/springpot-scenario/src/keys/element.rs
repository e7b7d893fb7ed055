//! `[[element]]`.

use super::heat::{EXPANSION, SHIFT, THERMAL};
use super::robot::NAME;
use super::{ANCHOR, Bound, Field, Key, Keys, Need, Shape, Slot, key};
use springpot::elements::Element;
use springpot::law::Derivative;

/// Names that would collide with columns of the results.
pub(crate) const RESERVED_NAMES: [&str; 7] = ["t", "q", "v", "a", "tau", "energy", "gripper"];

/// The rest that is the coordinate at t = 0.
pub(crate) const START: &str = "start";

/// Pasts by name.
pub(crate) const PASTS: [&str; 3] = ["held", "unloaded", "steady"];

/// A past that began at some time.
pub(crate) static HELD: Keys = Keys {
    words: "Stretched at once to x(0), so long before t = 0, and held there.",
    keys: &[key("held", Shape::Number("s", Bound::Positive), Need::Required("held = \"30 s\""), "For how long.")],
};

/// The kinds of it that `only` knows.
pub(crate) const BETWEEN: &str = "between points";
pub(crate) const ON_JOINT: &str = "on a joint";
pub(crate) const BUSHING: &str = "of a bushing";

const LAW: Key = key("law", Shape::Law, Need::OneOf, "Name of the law: `springpot laws` lists them.");
const NETWORK: Key = key(
    "network",
    Shape::Text,
    Need::OneOf,
    "In place of a law: leaves in series and in parallel, such as \"series(spring(k), dashpot(c))\".",
);
const PARAMETERS: Key = key("parameters", Shape::ByName, Need::Optional, "Parameters, as the law says.");
const INPUTS: Key = key("inputs", Shape::ByName, Need::Optional, "Inputs, as the law says: functions of time.");
const DERIVATIVE: Key = key(
    "derivative",
    Shape::Words(|| [Derivative::Caputo, Derivative::RiemannLiouville].map(|kind| kind.name()).to_vec()),
    Need::Word("caputo"),
    "What happened before t = 0: held at x(0), or unloaded.",
);
const PAST: Key = key(
    "past",
    Shape::WordsOr(|| PASTS.to_vec(), &HELD),
    Need::Optional,
    "What happened before t = 0, in place of `derivative`: held since ever, unloaded, steady, or held for a while.",
);
const PERIOD: Key = key(
    "period",
    Shape::Number("s", Bound::Positive),
    Need::Optional,
    "With past = \"steady\": the period of the stroke, which was always what it is from t = 0 on.",
);
const SCHEME: Key =
    key("scheme", Shape::Scheme, Need::Word("exact"), "The exact memory, or a named scheme on the grid of the rows.");
const SHIFT_KEY: Key = key(
    "shift",
    Shape::Table(&SHIFT),
    Need::Optional,
    "How temperature shifts the rates of springpots and dashpots: a temperature input `T`, or `thermal`, says it.",
);
const THERMAL_KEY: Key = key(
    "thermal",
    Shape::Table(&THERMAL),
    Need::Optional,
    "The temperature as a state in place of an input: losses raise it, the surroundings take the heat.",
);
const EXPANSION_KEY: Key =
    key("expansion", Shape::Table(&EXPANSION), Need::Optional, "How the stress-free length follows the temperature.");
const REST: Key = key(
    "rest",
    Shape::JointNumberOrWord(["rad", "m"], Bound::Any, START),
    Need::Number(0.0),
    "Coordinate at which the stroke is 0; \"start\": that at t = 0, exactly.",
);
const OF_MATERIALS: &[&str] = &[BETWEEN, ON_JOINT];
const OF_POINTS: &[&str] = &[BETWEEN, BUSHING];

/// An element without a robot: what it is made of, and no more.
pub(crate) static LONE: Keys = Keys {
    words: "A law with its parameters and inputs, without a robot.",
    keys: &[
        key("name", Shape::Name(&RESERVED_NAMES), Need::Said("element1, …"), "Name of the element."),
        LAW,
        NETWORK,
        PARAMETERS,
        INPUTS,
        DERIVATIVE,
        PAST,
        SHIFT_KEY,
        THERMAL_KEY,
        EXPANSION_KEY,
    ],
};

pub(crate) static ELEMENT: Keys = Keys {
    words: "A material between two points of two bodies, on a joint, or the materials of a bushing.",
    keys: &[
        key(
            "name",
            Shape::Name(&RESERVED_NAMES),
            Need::Written(NAME),
            "Name of the element; begins the names of its columns.",
        ),
        key(
            "enabled",
            Shape::Flag,
            Need::Flag(true),
            "false: it is not there; its cells are empty, and it is not drawn.",
        ),
        key(
            "from",
            Shape::Table(&END),
            Need::Required("from = { body = \"NAME\", point = [x, y, z] }"),
            "First end, or first frame.",
        )
        .only(OF_POINTS),
        key(
            "via",
            Shape::Tables(&ANCHOR, None),
            Need::Optional,
            "Points between the ends, over which the element runs as a cable.",
        )
        .only(&[BETWEEN]),
        key(
            "to",
            Shape::Table(&END),
            Need::Required("to = { body = \"NAME\", point = [x, y, z] }"),
            "Second end, or second frame.",
        )
        .only(OF_POINTS),
        key(
            "rest_length",
            Shape::NumberOrWord("m", Bound::Length, START),
            Need::Required("rest_length = \"70 cm\" or \"start\""),
            "Length at which the stroke is 0; \"start\": the length at t = 0, exactly.",
        )
        .only(&[BETWEEN]),
        key("joint", Shape::Text, Need::Optional, "In place of two ends: the joint whose coordinate it acts on.")
            .only(&[ON_JOINT]),
        REST.only(&[ON_JOINT]),
        key(
            "bushing",
            Shape::Table(&COMPONENTS),
            Need::Optional,
            "In place of one law: a law for each of the relative coordinates of two frames.",
        )
        .only(&[BUSHING]),
        LAW.only(OF_MATERIALS),
        NETWORK.only(OF_MATERIALS),
        PARAMETERS.only(OF_MATERIALS),
        INPUTS.only(OF_MATERIALS),
        DERIVATIVE.only(OF_MATERIALS),
        PAST.only(OF_MATERIALS),
        PERIOD.only(OF_MATERIALS),
        SCHEME.only(OF_MATERIALS),
        SHIFT_KEY.only(OF_MATERIALS),
        THERMAL_KEY.only(OF_MATERIALS),
        EXPANSION_KEY.only(OF_MATERIALS),
    ],
};

/// An end of an element: a point, of a bushing a frame.
pub(crate) static END: Keys = Keys {
    words: "A point on a body, of a bushing a frame.",
    keys: &[
        key(
            "body",
            Shape::Text,
            Need::Required("body = \"NAME\" or body = \"world\""),
            "Name of a body or link, or \"world\".",
        ),
        key(
            "point",
            Shape::Vector("m"),
            Need::Required("point = [x, y, z] in the body's joint frame, m"),
            "The point in the frame of the body's joint.",
        ),
        key(
            "rpy",
            Shape::Vector("rad"),
            Need::Vector([0.0; 3]),
            "Roll, pitch and yaw of the frame against that of the body's joint.",
        )
        .only(&[BUSHING]),
    ],
};

const fn component(name: &'static str, words: &'static str) -> Key {
    key(name, Shape::Table(&COMPONENT), Need::Optional, words)
}

/// The relative coordinates of two frames.
pub(crate) static COMPONENTS: Keys = Keys {
    words: "Laws of a bushing; the coordinates that are left out carry nothing.",
    keys: &[
        component("x", "Along x of the frame `from`."),
        component("y", "Along y of the frame `from`."),
        component("z", "Along z of the frame `from`."),
        component("rx", "Component x of the rotation vector of the turn from `from` to `to`."),
        component("ry", "Component y of the rotation vector."),
        component("rz", "Component z of the rotation vector."),
    ],
};

pub(crate) static COMPONENT: Keys = Keys {
    words: "The material of one relative coordinate.",
    keys: &[
        REST,
        LAW,
        NETWORK,
        PARAMETERS,
        INPUTS,
        DERIVATIVE,
        PAST,
        PERIOD,
        SCHEME,
        SHIFT_KEY,
        THERMAL_KEY,
        EXPANSION_KEY,
    ],
};

/// Its keys that are numbers of an element between points.
pub(crate) const ELEMENT_FIELDS: &[Field<Element>] = &[("rest_length", |element| Slot::Number(&mut element.rest))];
