//! `shift`, `thermal` and `expansion` of an element.

use super::{Bound, Key, Keys, Need, Shape, key};

/// Temperatures that materials have, K.
const TEMPERATURE: Bound = Bound::Within(150.0, 1500.0, "a temperature from 150 to 1500 K");

/// The kinds of shifts, by name.
pub(crate) const WLF: &str = "wlf";
pub(crate) const ARRHENIUS: &str = "arrhenius";

const fn temperature(name: &'static str, need: Need, words: &'static str) -> Key {
    key(name, Shape::Number("K", TEMPERATURE), need, words)
}

pub(crate) static SHIFT: Keys = Keys {
    words: "By how much temperature slows springpots and dashpots down.",
    keys: &[
        key(
            "kind",
            Shape::Kinds(|| {
                vec![
                    (WLF, "log10 a_T = −C1 (T − T_ref)/(C2 + T − T_ref)"),
                    (ARRHENIUS, "ln a_T = energy/R (1/T − 1/T_ref)"),
                ]
            }),
            Need::Kind,
            "",
        ),
        key("C1", Shape::Number("", Bound::NotNegative), Need::Required("C1 = 17.44"), "Decades far above T_ref.")
            .only(&[WLF]),
        key(
            "C2",
            Shape::Number("K", Bound::Positive),
            Need::Required("C2 = \"51.6 K\""),
            "How far below T_ref the pole lies.",
        )
        .only(&[WLF]),
        key(
            "energy",
            Shape::Number("J/mol", Bound::NotNegative),
            Need::Required("energy = \"80 kJ/mol\""),
            "Activation energy.",
        )
        .only(&[ARRHENIUS]),
        temperature("T_ref", Need::Required("T_ref = \"20 degC\""), "Temperature at which a_T is 1."),
    ],
};

pub(crate) static THERMAL: Keys = Keys {
    words: "The temperature of the element as a state, which its losses raise.",
    keys: &[
        key(
            "capacity",
            Shape::Number("J/K", Bound::Positive),
            Need::Required("capacity = \"50 J/K\""),
            "Heat capacity of the element.",
        ),
        key(
            "conductance",
            Shape::Number("W/K", Bound::NotNegative),
            Need::Required("conductance = \"0.5 W/K\""),
            "Heat flow to the surroundings per kelvin; 0: none.",
        ),
        temperature("ambient", Need::Required("ambient = \"20 degC\""), "Temperature of the surroundings."),
        temperature("start", Need::Said("ambient"), "Temperature at t = 0."),
    ],
};

pub(crate) static EXPANSION: Keys = Keys {
    words: "The stroke of heat: the law sees x − coefficient·(T − T_ref).",
    keys: &[
        key(
            "coefficient",
            Shape::JointNumber(["rad/K", "m/K"], Bound::Any),
            Need::Required("coefficient = \"1 um/K\""),
            "Growth of the stress-free length, of the coordinate of a joint, per kelvin.",
        ),
        temperature("T_ref", Need::Required("T_ref = \"20 degC\""), "Temperature without it."),
    ],
};
