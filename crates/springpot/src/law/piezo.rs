//! Fractional Kelvin–Voigt element with a piezo stack in it.

use super::catalog::{Entry, Input, Param, Range, alpha, at_least_one_positive, carrier, damping};
use super::network::Network;
use std::sync::Arc;

/// F = (E_c + E_pz)·x + E_d·D^alpha x − alpha_pz·E_pz·U: a positive voltage lengthens the stack and lowers the tension.
///
/// The voltage supplies ∫ alpha_pz·E_pz·U·x' dt.
pub(super) fn piezo_kelvin_voigt() -> Entry {
    Entry {
        name: "piezo-kelvin-voigt".into(),
        equation: "F = (E_c + E_pz)·x + E_d·D^alpha x − alpha_pz·E_pz·U".into(),
        params: vec![
            carrier(),
            Param::new("E_pz", "N/m", "stiffness of the piezo stack", Range::NOT_NEGATIVE),
            damping(),
            alpha(),
            Param::new("alpha_pz", "m/V", "free stroke per volt", Range::ANY),
        ],
        inputs: vec![Input::new("U", "V", "voltage on the stack", Range::ANY)],
        source:
            "equations of motion of a robot with piezo-modified and magnetorheological elements (docs/LITERATURE.md)"
                .into(),
        build: Arc::new(|values, derivative| {
            let &[e_c, e_pz, e_d, alpha, alpha_pz] = values else { unreachable!("values follow params") };
            at_least_one_positive(&[("E_c", e_c), ("E_pz", e_pz), ("E_d", e_d)])?;
            Ok(Network::parallel([
                Network::spring(e_c + e_pz),
                Network::springpot(e_d, alpha, derivative),
                Network::source(alpha_pz * e_pz, 0.0, 0),
            ]))
        }),
    }
}
