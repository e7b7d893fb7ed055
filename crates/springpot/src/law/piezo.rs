//! Fractional Kelvin–Voigt element with a piezo stack in it.

use super::Network;
use super::catalog::{ALPHA, CARRIER, DAMPING, Entry, Input, Param, Range, at_least_one_positive};

/// F = (E_c + E_pz)·x + E_d·D^alpha x − alpha_pz·E_pz·U: a positive voltage lengthens the stack and lowers the tension.
///
/// The voltage supplies ∫ alpha_pz·E_pz·U·x' dt.
pub(super) const PIEZO_KELVIN_VOIGT: Entry = Entry {
    name: "piezo-kelvin-voigt",
    equation: "F = (E_c + E_pz)·x + E_d·D^alpha x − alpha_pz·E_pz·U",
    params: &[
        CARRIER,
        Param {
            name: "E_pz",
            unit: "N/m",
            meaning: "stiffness of the piezo stack",
            range: Range::NOT_NEGATIVE,
            default: None,
        },
        DAMPING,
        ALPHA,
        Param { name: "alpha_pz", unit: "m/V", meaning: "free stroke per volt", range: Range::ANY, default: None },
    ],
    inputs: &[Input { name: "U", unit: "V", meaning: "voltage on the stack", range: Range::ANY }],
    source: "equations of motion of a robot with piezo-modified and magnetorheological elements (docs/LITERATURE.md)",
    build: |values, derivative| {
        let &[e_c, e_pz, e_d, alpha, alpha_pz] = values else { unreachable!("values follow params") };
        at_least_one_positive(&[("E_c", e_c), ("E_pz", e_pz), ("E_d", e_d)])?;
        Ok(Network::parallel([
            Network::spring(e_c + e_pz),
            Network::springpot(e_d, alpha, derivative),
            Network::source(alpha_pz * e_pz, 0.0, 0),
        ]))
    },
};
