//! Fractional Kelvin–Voigt element that expands with temperature.

use super::catalog::{Entry, Input, Param, Range, alpha, at_least_one_positive, carrier, damping};
use super::heat::TEMPERATURE;
use super::network::Network;
use std::sync::Arc;

/// F = (E_c + E_kv)·x + E_d·D^alpha x − a_kv·E_kv·(T − T_ref): the tension falls as the element warms.
///
/// The thermal force does work on the joined bodies: input energy ∫ a_kv·E_kv·(T − T_ref)·x' dt.
pub(super) fn thermoviscoelastic() -> Entry {
    Entry {
        name: "thermoviscoelastic".into(),
        equation: "F = (E_c + E_kv)·x + E_d·D^alpha x − a_kv·E_kv·(T − T_ref)".into(),
        params: vec![
            carrier(),
            Param::new("E_kv", "N/m", "stiffness of the part that expands", Range::NOT_NEGATIVE),
            damping(),
            alpha(),
            Param::new("a_kv", "m/K", "thermal expansion of the element", Range::ANY),
            Param::new("T_ref", "K", "temperature without thermal force", TEMPERATURE).or(273.15),
        ],
        inputs: vec![Input::new("T", "K", "temperature", TEMPERATURE)],
        source: "generalized forces of a robot with a fractional thermoviscoelastic element (docs/LITERATURE.md)"
            .into(),
        build: Arc::new(|values, derivative| {
            let &[e_c, e_kv, e_d, alpha, a_kv, t_ref] = values else { unreachable!("values follow params") };
            at_least_one_positive(&[("E_c", e_c), ("E_kv", e_kv), ("E_d", e_d)])?;
            Ok(Network::parallel([
                Network::spring(e_c + e_kv),
                Network::springpot(e_d, alpha, derivative),
                Network::source(a_kv * e_kv, t_ref, 0),
            ]))
        }),
    }
}
