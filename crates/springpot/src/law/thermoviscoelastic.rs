//! Fractional Kelvin–Voigt element that expands with temperature.

use super::Network;
use super::catalog::{ALPHA, CARRIER, DAMPING, Entry, Input, Param, Range, at_least_one_positive};

const TEMPERATURE: Range = Range { low: 150.0, high: 1500.0 };

/// F = (E_c + E_kv)·x + E_d·D^alpha x − a_kv·E_kv·(T − T_ref): the tension falls as the element warms.
///
/// The thermal force does work on the joined bodies: input energy ∫ a_kv·E_kv·(T − T_ref)·x' dt.
pub(super) const THERMOVISCOELASTIC: Entry = Entry {
    name: "thermoviscoelastic",
    equation: "F = (E_c + E_kv)·x + E_d·D^alpha x − a_kv·E_kv·(T − T_ref)",
    params: &[
        CARRIER,
        Param {
            name: "E_kv",
            unit: "N/m",
            meaning: "stiffness of the part that expands",
            range: Range::NOT_NEGATIVE,
            default: None,
        },
        DAMPING,
        ALPHA,
        Param {
            name: "a_kv",
            unit: "m/K",
            meaning: "thermal expansion of the element",
            range: Range::ANY,
            default: None,
        },
        Param {
            name: "T_ref",
            unit: "K",
            meaning: "temperature without thermal force",
            range: TEMPERATURE,
            default: Some(273.15),
        },
    ],
    inputs: &[Input { name: "T", unit: "K", meaning: "temperature", range: TEMPERATURE }],
    source: "generalized forces of a robot with a fractional thermoviscoelastic element (docs/LITERATURE.md)",
    build: |values, derivative| {
        let &[e_c, e_kv, e_d, alpha, a_kv, t_ref] = values else { unreachable!("values follow params") };
        at_least_one_positive(&[("E_c", e_c), ("E_kv", e_kv), ("E_d", e_d)])?;
        Ok(Network::parallel([
            Network::spring(e_c + e_kv),
            Network::springpot(e_d, alpha, derivative),
            Network::source(a_kv * e_kv, t_ref, 0),
        ]))
    },
};
