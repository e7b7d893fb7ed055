//! `[[parameter]]` and `[sensitivity]`.

use super::sweep::MAX_TOGETHER;
use super::{Keys, Need, Shape, key};

/// Most values that a search begins at.
const MAX_STARTS: usize = 1_000;

/// The methods of derivatives.
pub(crate) const FORWARD: &str = "forward";
pub(crate) const ADJOINT: &str = "adjoint";

pub(crate) static PARAMETER: Keys = Keys {
    words: "A number that may be changed: what a run is differentiated by.",
    keys: &[
        key("name", Shape::Name(&[]), Need::Said("its first path"), "Name of the parameter."),
        key(
            "path",
            Shape::Paths(MAX_TOGETHER),
            Need::Written("path = \"element.NAME.PARAMETER\""),
            "Path of the number such as \"element.NAME.alpha\", or paths that take the same value.",
        ),
        key("bounds", Shape::SweptNumbers(2, 2), Need::Said("what its place takes"), "Smallest and largest value."),
        key(
            "scale",
            Shape::Words(|| vec!["log", "logit", "linear"]),
            Need::Said("by its bounds"),
            "In which variable it moves: by default `\"log\"` from 0 on, `\"logit\"` between two bounds, else `\"linear\"`.",
        ),
        key(
            "start",
            Shape::SweptNumbers(1, MAX_STARTS),
            Need::Said("the value of the file"),
            "Where a search begins: one value, or several.",
        ),
        key(
            "typical",
            Shape::SweptNumber,
            Need::Said("its size, 1 where that is 0"),
            "What a change of it is measured by.",
        ),
        key("prior", Shape::Table(&PRIOR), Need::Optional, "What is known of it beforehand."),
    ],
};

pub(crate) static PRIOR: Keys = Keys {
    words: "What is known of a parameter beforehand.",
    keys: &[
        key("mean", Shape::SweptNumber, Need::Written("mean = 0.5"), "Its mean."),
        key("sd", Shape::SweptNumber, Need::Written("sd = 0.1"), "Its standard deviation, above 0."),
    ],
};

pub(crate) static SENSITIVITY: Keys = Keys {
    words: "Derivatives of the columns of a run by numbers of its file.",
    keys: &[
        key(
            "by",
            Shape::Texts,
            Need::Said("every [[parameter]]"),
            "Names of parameters, or paths: one or an array of them.",
        ),
        key(
            "of",
            Shape::Columns,
            Need::Said("the columns that are written"),
            "Columns that are differentiated: a name, a glob, or an array of them.",
        ),
        key(
            "control",
            Shape::Flag,
            Need::Flag(true),
            "Whether derivatives share in the choice of steps, or take those of the plain run.",
        ),
        key(
            "method",
            Shape::Words(|| vec![FORWARD, ADJOINT]),
            Need::Word(FORWARD),
            "`\"forward\"`: with the run; `\"adjoint\"`: back through it, gradients of metrics alone.",
        ),
    ],
};
