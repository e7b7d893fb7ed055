//! `[[event]]`.

use super::{Keys, Need, Shape, key};
use springpot::system::Direction;

/// The actions that are a word.
pub(crate) const RECORD: &str = "record";
pub(crate) const STOP: &str = "stop";

pub(crate) static EVENT: Keys = Keys {
    words: "Something that happens in a forward run.",
    keys: &[
        key("name", Shape::Name(&[]), Need::Written("name = \"touch\""), "Name."),
        key(
            "when",
            Shape::Text,
            Need::Required("when = \"gripper.z - 0.1\""),
            "An expression of t and of columns, which passes zero where it happens.",
        ),
        key(
            "direction",
            Shape::Words(|| Direction::ALL.map(|(word, _)| word).to_vec()),
            Need::Word("both"),
            "Which passages through zero count.",
        ),
        key(
            "action",
            Shape::WordsOr(|| vec![RECORD, STOP], &ACTION),
            Need::Word(RECORD),
            "What is done besides telling the row: nothing, the run ends, or what is set.",
        ),
    ],
};

pub(crate) static ACTION: Keys = Keys {
    words: "What an event sets.",
    keys: &[key(
        "set",
        Shape::Scalars,
        Need::Written("set = { \"strut.u\" = \"3 V\", \"tau.q1\" = 0 }"),
        "Inputs of elements and torques of joints, by their columns, which hold from then on.",
    )],
};
