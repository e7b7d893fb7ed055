//! Magnetorheological element: a springpot whose coefficient follows the voltage of its coil.

use super::Network;
use super::catalog::{ALPHA, CARRIER, Entry, Input, Param, Range, at_least_one_positive};
use super::leaf::Coefficient;

/// F = E_c·x + (mu_0 + u·mu)·D^alpha x; the coefficient stands outside the derivative also when u varies.
///
/// Passive only while mu_0 + u·mu ≥ 0, which is checked wherever u is evaluated. A varying u supplies ∫ mu·u'·ψ dt, ψ the energy
/// stored by a springpot of unit coefficient.
pub(super) const MAGNETORHEOLOGICAL: Entry = Entry {
    name: "magnetorheological",
    equation: "F = E_c·x + (mu_0 + u·mu)·D^alpha x",
    params: &[
        CARRIER,
        Param {
            name: "mu_0",
            unit: "N*s^alpha/m",
            meaning: "coefficient without field",
            range: Range::NOT_NEGATIVE,
            default: None,
        },
        Param {
            name: "mu",
            unit: "N*s^alpha/(m*V)",
            meaning: "change of the coefficient per volt",
            range: Range::ANY,
            default: None,
        },
        ALPHA,
    ],
    inputs: &[Input { name: "u", unit: "V", meaning: "voltage of the coil", range: Range::ANY }],
    source: "equations of motion of a robot with piezo-modified and magnetorheological elements (docs/LITERATURE.md)",
    build: |values, derivative| {
        let &[e_c, mu_0, mu, alpha] = values else { unreachable!("values follow params") };
        at_least_one_positive(&[("E_c", e_c), ("mu_0", mu_0), ("mu", mu)])?;
        let rule = "mu_0 + u·mu ≥ 0";
        let coefficient = Coefficient { constant: mu_0, slope: mu, input: Some(0), rule, parameter: "mu" };
        Ok(Network::parallel([Network::spring(e_c), Network::varying_springpot(coefficient, alpha, derivative)]))
    },
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Derivative, InputValue};

    #[test]
    fn a_negative_coefficient_names_the_rule() {
        let law = (MAGNETORHEOLOGICAL.build)(&[10.0, 50.0, 10.0, 0.5], Derivative::Caputo).unwrap();
        let at = |u: f64| law.check_inputs(&[InputValue { value: u, rate: 0.0 }]);
        assert!(at(-5.0).is_ok());
        let broken = at(-7.0).unwrap_err().to_string();
        assert_eq!(broken, "mu_0 + u·mu ≥ 0 is broken: the coefficient of D^alpha x is -20");
    }
}
