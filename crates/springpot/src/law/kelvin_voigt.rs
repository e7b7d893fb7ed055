//! Plain laws: spring, dashpot, springpot, and their parallel combinations.

use super::Network;
use super::catalog::{ALPHA, Built, Entry, Param, Range, at_least_one_positive};

const STIFFNESS: Param =
    Param { name: "k", unit: "N/m", meaning: "stiffness", range: Range::NOT_NEGATIVE, default: None };
const VISCOSITY: Param =
    Param { name: "c", unit: "N*s/m", meaning: "viscosity", range: Range::NOT_NEGATIVE, default: None };
const COEFFICIENT: Param = Param {
    name: "c",
    unit: "N*s^alpha/m",
    meaning: "coefficient of the fractional derivative",
    range: Range::NOT_NEGATIVE,
    default: None,
};

/// F = k·x.
pub(super) const SPRING: Entry = Entry {
    name: "spring",
    equation: "F = k·x",
    params: &[STIFFNESS],
    inputs: &[],
    source: "Hooke",
    build: |values, _| -> Built {
        at_least_one_positive(&[("k", values[0])])?;
        Ok(Network::spring(values[0]))
    },
};

/// F = c·x'.
pub(super) const DASHPOT: Entry = Entry {
    name: "dashpot",
    equation: "F = c·x'",
    params: &[VISCOSITY],
    inputs: &[],
    source: "Newton",
    build: |values, _| -> Built {
        at_least_one_positive(&[("c", values[0])])?;
        Ok(Network::dashpot(values[0]))
    },
};

/// F = c·D^alpha x.
pub(super) const SPRINGPOT: Entry = Entry {
    name: "springpot",
    equation: "F = c·D^alpha x",
    params: &[COEFFICIENT, ALPHA],
    inputs: &[],
    source: "Scott Blair 1947; Koeller 1984",
    build: |values, derivative| -> Built {
        at_least_one_positive(&[("c", values[0])])?;
        Ok(Network::springpot(values[0], values[1], derivative))
    },
};

/// F = k·x + c·x'.
pub(super) const KELVIN_VOIGT: Entry = Entry {
    name: "kelvin-voigt",
    equation: "F = k·x + c·x'",
    params: &[STIFFNESS, VISCOSITY],
    inputs: &[],
    source: "Kelvin 1865; Voigt 1892",
    build: |values, _| -> Built {
        at_least_one_positive(&[("k", values[0]), ("c", values[1])])?;
        Ok(Network::parallel([Network::spring(values[0]), Network::dashpot(values[1])]))
    },
};

/// F = k·x + c·D^alpha x.
pub(super) const FRACTIONAL_KELVIN_VOIGT: Entry = Entry {
    name: "fractional-kelvin-voigt",
    equation: "F = k·x + c·D^alpha x",
    params: &[STIFFNESS, COEFFICIENT, ALPHA],
    inputs: &[],
    source: "Bagley & Torvik 1983",
    build: |values, derivative| -> Built {
        at_least_one_positive(&[("k", values[0]), ("c", values[1])])?;
        let &[k, c, alpha] = values else { unreachable!("values follow params") };
        Ok(Network::parallel([Network::spring(k), Network::springpot(c, alpha, derivative)]))
    },
};
