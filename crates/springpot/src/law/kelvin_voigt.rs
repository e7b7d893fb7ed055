//! Plain laws: spring, dashpot, springpot, and their parallel combinations.

use super::catalog::{Entry, Param, Range, alpha, at_least_one_positive};
use super::network::Network;
use std::sync::Arc;

fn stiffness() -> Param {
    Param::new("k", "N/m", "stiffness", Range::NOT_NEGATIVE)
}

fn viscosity() -> Param {
    Param::new("c", "N*s/m", "viscosity", Range::NOT_NEGATIVE)
}

fn coefficient() -> Param {
    Param::new("c", "N*s^alpha/m", "coefficient of the fractional derivative", Range::NOT_NEGATIVE)
}

/// F = k·x.
pub(super) fn spring() -> Entry {
    Entry {
        name: "spring".into(),
        equation: "F = k·x".into(),
        params: vec![stiffness()],
        inputs: vec![],
        source: "Hooke".into(),
        build: Arc::new(|values, _| {
            at_least_one_positive(&[("k", values[0])])?;
            Ok(Network::spring(values[0]))
        }),
    }
}

/// F = c·x'.
pub(super) fn dashpot() -> Entry {
    Entry {
        name: "dashpot".into(),
        equation: "F = c·x'".into(),
        params: vec![viscosity()],
        inputs: vec![],
        source: "Newton".into(),
        build: Arc::new(|values, _| {
            at_least_one_positive(&[("c", values[0])])?;
            Ok(Network::dashpot(values[0]))
        }),
    }
}

/// F = c·D^alpha x.
pub(super) fn springpot() -> Entry {
    Entry {
        name: "springpot".into(),
        equation: "F = c·D^alpha x".into(),
        params: vec![coefficient(), alpha()],
        inputs: vec![],
        source: "Scott Blair 1947; Koeller 1984".into(),
        build: Arc::new(|values, derivative| {
            at_least_one_positive(&[("c", values[0])])?;
            Ok(Network::springpot(values[0], values[1], derivative))
        }),
    }
}

/// F = k·x + c·x'.
pub(super) fn kelvin_voigt() -> Entry {
    Entry {
        name: "kelvin-voigt".into(),
        equation: "F = k·x + c·x'".into(),
        params: vec![stiffness(), viscosity()],
        inputs: vec![],
        source: "Kelvin 1865; Voigt 1892".into(),
        build: Arc::new(|values, _| {
            at_least_one_positive(&[("k", values[0]), ("c", values[1])])?;
            Ok(Network::parallel([Network::spring(values[0]), Network::dashpot(values[1])]))
        }),
    }
}

/// F = k·x + c·D^alpha x.
pub(super) fn fractional_kelvin_voigt() -> Entry {
    Entry {
        name: "fractional-kelvin-voigt".into(),
        equation: "F = k·x + c·D^alpha x".into(),
        params: vec![stiffness(), coefficient(), alpha()],
        inputs: vec![],
        source: "Bagley & Torvik 1983".into(),
        build: Arc::new(|values, derivative| {
            at_least_one_positive(&[("k", values[0]), ("c", values[1])])?;
            let &[k, c, alpha] = values else { unreachable!("values follow params") };
            Ok(Network::parallel([Network::spring(k), Network::springpot(c, alpha, derivative)]))
        }),
    }
}
