//! Rubber filled with carbon black.

use super::catalog::{Entry, Param, Range, alpha};
use super::leaf::Jenkins;
use super::network::Network;
use super::rule::RuleError;
use std::sync::Arc;

/// F = k·x + c·D^alpha x + Σ F_i, F_i a spring k_f that slips at F_f.
pub(super) fn filled_rubber() -> Entry {
    let positive = Range { low: f64::MIN_POSITIVE, high: f64::MAX };
    Entry {
        name: "filled-rubber".into(),
        equation: "F = k·x + c·D^alpha x + Σ F_i, dF_i = k_f·dx, cut at ±F_f".into(),
        params: vec![
            Param::new("k", "N/m", "stiffness of the rubber", Range::NOT_NEGATIVE),
            Param::new("c", "N*s^alpha/m", "coefficient of the fractional derivative", Range::NOT_NEGATIVE),
            alpha(),
            Param::new("k_f", "N/m", "stiffnesses of the filler's springs", positive).list(),
            Param::new("F_f", "N", "forces at which they slip", positive).list(),
        ],
        inputs: vec![],
        source: "Jenkins 1962; Sjöberg & Kari 2002".into(),
        build: Arc::new(|values, derivative| {
            let (&[k, c, alpha], fillers) = values.split_first_chunk().expect("values follow params");
            if fillers.is_empty() {
                return Err(RuleError { rule: "one value of k_f and F_f at least".into(), parameter: "k_f".into() });
            }
            let (stiffnesses, forces) = fillers.split_at(fillers.len() / 2);
            RuleError::unless(stiffnesses.iter().all(|k| k.value > 0.0), "k_f > 0", "k_f")?;
            RuleError::unless(forces.iter().all(|force| force.value > 0.0), "F_f > 0", "F_f")?;
            let mut parts = vec![Network::spring(k), Network::springpot(c, alpha, derivative)];
            for (stiffness, force) in stiffnesses.iter().zip(forces) {
                parts.push(Network::leaf(Jenkins::new(*stiffness, *force)?));
            }
            Ok(Network::parallel(parts))
        }),
    }
}
