//! Numbers that are expressions of `[constants]`.

use super::{Keys, Need, Shape, key};

pub(crate) static SCALAR: Keys = Keys {
    words: "A number made of constants.",
    keys: &[
        key(
            "expression",
            Shape::Text,
            Need::Written("expression = \"…\""),
            "An expression of constants, such as \"3/f\".",
        ),
        key("unit", Shape::Text, Need::Said("SI"), "Unit of its value."),
    ],
};
