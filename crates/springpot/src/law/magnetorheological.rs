//! Magnetorheological element: a springpot whose coefficient follows the voltage of its coil.

use super::catalog::{Entry, Input, Param, Range, alpha, at_least_one_positive, carrier};
use super::leaf::{BoucWen, Coefficient, bouc_wen};
use super::network::Network;
use crate::dual::Dual;
use crate::fractional::Kind as Derivative;
use std::sync::Arc;

/// F = E_c·x + (mu_0 + u·mu)·D^alpha x; the coefficient stands outside the derivative also when u varies.
///
/// Passive only while mu_0 + u·mu ≥ 0, which is checked wherever u is evaluated. A varying u supplies ∫ mu·u'·ψ dt, ψ the energy
/// stored by a springpot of unit coefficient.
pub(super) fn magnetorheological() -> Entry {
    Entry {
        name: "magnetorheological".into(),
        equation: "F = E_c·x + (mu_0 + u·mu)·D^alpha x".into(),
        params: params(),
        inputs: inputs(),
        source:
            "equations of motion of a robot with piezo-modified and magnetorheological elements (docs/LITERATURE.md)"
                .into(),
        build: Arc::new(|values, derivative| {
            let &[e_c, mu_0, mu, alpha] = values else { unreachable!("values follow params") };
            at_least_one_positive(&[("E_c", e_c), ("mu_0", mu_0), ("mu", mu)])?;
            Ok(Network::parallel(parts([e_c, mu_0, mu, alpha], derivative)))
        }),
    }
}

/// F = E_c·x + (mu_0 + u·mu)·D^alpha x + alpha_h·z: with the z of `bouc-wen` beside it, which does not follow u.
pub(super) fn magnetorheological_bouc_wen() -> Entry {
    Entry {
        name: "magnetorheological-bouc-wen".into(),
        equation: "F = E_c·x + (mu_0 + u·mu)·D^alpha x + alpha_h·z(A, beta, gamma, n)".into(),
        params: params().into_iter().chain(bouc_wen::params()).collect(),
        inputs: inputs(),
        source: "that of `magnetorheological`; Bouc 1967, Wen 1976".into(),
        build: Arc::new(|values, derivative| {
            let &[e_c, mu_0, mu, alpha, alpha_h, a, beta, gamma, n] = values else {
                unreachable!("values follow params")
            };
            at_least_one_positive(&[("E_c", e_c), ("mu_0", mu_0), ("mu", mu), ("alpha_h", alpha_h)])?;
            let hysteresis = Network::leaf(BoucWen::new(alpha_h, a, beta, gamma, n)?);
            Ok(Network::parallel(parts([e_c, mu_0, mu, alpha], derivative).into_iter().chain([hysteresis])))
        }),
    }
}

fn params() -> Vec<Param> {
    vec![
        carrier(),
        Param::new("mu_0", "N*s^alpha/m", "coefficient without field", Range::NOT_NEGATIVE),
        Param::new("mu", "N*s^alpha/(m*V)", "change of the coefficient per volt", Range::ANY),
        alpha(),
    ]
}

fn inputs() -> Vec<Input> {
    vec![Input::new("u", "V", "voltage of the coil", Range::ANY)]
}

fn parts([e_c, mu_0, mu, alpha]: [Dual; 4], derivative: Derivative) -> [Network; 2] {
    let coefficient = Coefficient {
        constant: mu_0,
        slope: mu,
        input: Some(0),
        rule: "mu_0 + u·mu ≥ 0".into(),
        parameter: "mu".into(),
    };
    [Network::spring(e_c), Network::varying_springpot(coefficient, alpha, derivative)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::step::InputValue;

    #[test]
    fn a_negative_coefficient_names_the_rule() {
        let law = magnetorheological().build(&[10.0, 50.0, 10.0, 0.5], Derivative::Caputo).unwrap();
        let at = |u: f64| law.check_inputs(&[InputValue { value: u, rate: 0.0 }]);
        assert!(at(-5.0).is_ok());
        let broken = at(-7.0).unwrap_err().to_string();
        assert_eq!(broken, "mu_0 + u·mu ≥ 0 is broken: the coefficient of D^alpha x is -20");
    }
}
