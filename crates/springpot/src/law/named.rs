//! Laws that are networks by name.

use super::catalog::{Entry, Param, Range};
use super::network::Network;
use super::rule::RuleError;
use super::written::NetworkText;
use crate::dual::Dual;
use std::sync::Arc;

/// A law as a row: the network behind its name.
struct Row {
    name: &'static str,
    network: &'static str,
    equation: &'static str,
    /// What parameters are, where that of their leaf does not say it.
    words: &'static [(&'static str, &'static str)],
    /// Parameters that need not be given.
    defaults: &'static [(&'static str, f64)],
    source: &'static str,
}

const SPRINGS: &[(&str, &str)] = &[
    ("k_e", "stiffness of the spring beside the others, which remains at last"),
    ("k_m", "stiffness of the spring in series"),
];

const TWO: &[(&str, &str)] = &[
    ("k_1", "stiffness of the first spring"),
    ("k_2", "stiffness of the second spring"),
    ("c_1", "coefficient of the first damper"),
    ("c_2", "coefficient of the second damper"),
    ("alpha_1", "order of the first derivative (0: spring, 1: dashpot)"),
    ("alpha_2", "order of the second derivative (0: spring, 1: dashpot)"),
];

const ROWS: [Row; 9] = [
    Row {
        name: "maxwell",
        network: "series(spring(k), dashpot(c))",
        equation: "F + (c/k)·F' = c·x'",
        words: &[],
        defaults: &[],
        source: "Maxwell 1867",
    },
    Row {
        name: "fractional-maxwell",
        network: "series(spring(k), springpot(c, alpha))",
        equation: "F + (c/k)·D^alpha F = c·D^alpha x",
        words: &[],
        defaults: &[],
        source: "Koeller 1984",
    },
    Row {
        name: "zener",
        network: "parallel(spring(k_e), series(spring(k_m), dashpot(c)))",
        equation: "F + (c/k_m)·F' = k_e·x + c·(1 + k_e/k_m)·x'",
        words: SPRINGS,
        defaults: &[],
        source: "Zener 1948",
    },
    Row {
        name: "fractional-zener",
        network: "parallel(spring(k_e), series(spring(k_m), springpot(c, alpha)))",
        equation: "F + (c/k_m)·D^alpha F = k_e·x + c·(1 + k_e/k_m)·D^alpha x",
        words: SPRINGS,
        defaults: &[],
        source: "Bagley & Torvik 1983",
    },
    Row {
        name: "poynting-thomson",
        network: "series(spring(k_1), parallel(spring(k_2), springpot(c, alpha)))",
        equation: "F = k_1·x_1 = k_2·x_2 + c·D^alpha x_2, x = x_1 + x_2",
        words: TWO,
        defaults: &[("alpha", 1.0)],
        source: "Poynting & Thomson 1902",
    },
    Row {
        name: "burgers",
        network: "series(spring(k_1), dashpot(c_1), parallel(spring(k_2), dashpot(c_2)))",
        equation: "F = k_1·x_1 = c_1·x_2' = k_2·x_3 + c_2·x_3', x = Σ x_i",
        words: TWO,
        defaults: &[],
        source: "Burgers 1935",
    },
    Row {
        name: "fractional-burgers",
        network: "series(spring(k_1), springpot(c_1, alpha_1), parallel(spring(k_2), springpot(c_2, alpha_2)))",
        equation: "F = k_1·x_1 = c_1·D^alpha_1 x_2 = k_2·x_3 + c_2·D^alpha_2 x_3, x = Σ x_i",
        words: TWO,
        defaults: &[],
        source: "Burgers 1935; Koeller 1984",
    },
    Row {
        name: "jeffreys",
        network: "series(dashpot(c_1), parallel(spring(k), dashpot(c_2)))",
        equation: "F = c_1·x_1' = k·x_2 + c_2·x_2', x = x_1 + x_2",
        words: TWO,
        defaults: &[],
        source: "Jeffreys 1929",
    },
    Row {
        name: "bouc-wen",
        network: "bouc-wen(alpha_h, A, beta, gamma, n)",
        equation: "F = alpha_h·z, z' = A·x' − gamma·|x'|·z·|z|^(n−1) − beta·x'·|z|^n",
        words: &[],
        defaults: &[],
        source: "Bouc 1967; Wen 1976",
    },
];

/// All of them.
pub(super) fn entries() -> Vec<Entry> {
    ROWS.iter().map(Row::entry).chain([prony()]).collect()
}

impl Row {
    fn entry(&self) -> Entry {
        let entry = NetworkText::parse(self.network).expect("a network of this file").entry();
        let worded = |param: Param| {
            let of = |(name, _): &&(&str, _)| *name == param.name;
            let (words, default) =
                (self.words.iter().find(of), self.defaults.iter().find(|(name, _)| *name == param.name));
            let meaning = words.map_or(param.meaning, |(_, words)| (*words).into());
            Param { meaning, default: default.map(|(_, value)| *value), ..param }
        };
        let params = entry.params.into_iter().map(worded).collect();
        let (name, equation, source) = (self.name.into(), self.equation.into(), self.source.into());
        Entry { name, equation, params, source, ..entry }
    }
}

/// F = k_e·x + Σ F_i, F_i + tau_i·F_i' = k_i·tau_i·x': relaxation k_e + Σ k_i e^{−t/tau_i}.
fn prony() -> Entry {
    let positive = Range { low: f64::MIN_POSITIVE, high: f64::MAX };
    Entry {
        name: "prony".into(),
        equation: "F = k_e·x + Σ F_i, F_i + tau_i·F_i' = k_i·tau_i·x'".into(),
        params: vec![
            Param::new("k_e", "N/m", "stiffness that remains at last", Range::NOT_NEGATIVE),
            Param::new("k", "N/m", "stiffnesses of the terms", Range::NOT_NEGATIVE).list(),
            Param::new("tau", "s", "relaxation times of the terms", positive).list(),
        ],
        inputs: vec![],
        source: "Wiechert 1893; Prony series of data sheets".into(),
        build: Arc::new(|values, _| {
            let (k_e, rest) = values.split_first().expect("values follow params");
            let (stiffnesses, times) = rest.split_at(rest.len() / 2);
            let terms = stiffnesses.iter().zip(times).filter(|(k, _)| k.value > 0.0);
            let term = |(k, tau): (&Dual, &Dual)| Network::series([Network::spring(*k), Network::dashpot(*k * *tau)]);
            let parts: Vec<Network> =
                (k_e.value > 0.0).then(|| Network::spring(*k_e)).into_iter().chain(terms.map(term)).collect();
            if parts.is_empty() {
                return Err(RuleError { rule: "k_e or one of k to be positive".into(), parameter: "k_e".into() });
            }
            Ok(Network::parallel(parts))
        }),
    }
}
