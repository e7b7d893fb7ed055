//! The catalog of laws: what the parser, the command line and the documentation know about them.

use super::{Derivative, Network, kelvin_voigt, magnetorheological, piezo, thermoviscoelastic};

/// An admissible interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Smallest admissible value.
    pub low: f64,
    /// Largest admissible value.
    pub high: f64,
}

impl Range {
    /// Every finite number.
    pub const ANY: Self = Self { low: f64::MIN, high: f64::MAX };
    /// Zero and above.
    pub const NOT_NEGATIVE: Self = Self { low: 0.0, high: f64::MAX };
    /// Zero to one, both included.
    pub const UNIT: Self = Self { low: 0.0, high: 1.0 };

    /// Whether `value` lies inside; false for NaN.
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }
}

/// One parameter of a law.
#[derive(Debug, Clone, Copy)]
pub struct Param {
    /// Name in scenario files.
    pub name: &'static str,
    /// Unit in the grammar of quantities; an exponent may name a parameter of the same law. Empty: a pure number.
    pub unit: &'static str,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// Admissible values, SI.
    pub range: Range,
    /// Value where the file says nothing; `None`: must be given.
    pub default: Option<f64>,
}

/// One input of a law: a signal.
#[derive(Debug, Clone, Copy)]
pub struct Input {
    /// Name in scenario files and columns.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// Admissible values, SI.
    pub range: Range,
}

/// A rule between parameters that a law needs to be passive.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{rule}")]
pub struct RuleError {
    /// The rule, in words.
    pub rule: String,
    /// The parameter to change.
    pub parameter: &'static str,
}

/// The order of the fractional derivative, as every law names it.
pub(super) const ALPHA: Param = Param {
    name: "alpha",
    unit: "",
    meaning: "order of the fractional derivative (0: spring, 1: dashpot)",
    range: Range::UNIT,
    default: None,
};

/// The stiffness of the carrier in the laws of the papers.
pub(super) const CARRIER: Param =
    Param { name: "E_c", unit: "N/m", meaning: "stiffness of the carrier", range: Range::NOT_NEGATIVE, default: None };

/// The coefficient of D^alpha x in the laws of the papers.
pub(super) const DAMPING: Param = Param {
    name: "E_d",
    unit: "N*s^alpha/m",
    meaning: "coefficient of the fractional derivative",
    range: Range::NOT_NEGATIVE,
    default: None,
};

/// A law without any positive coefficient is no material.
pub(super) fn at_least_one_positive(parameters: &[(&'static str, f64)]) -> Result<(), RuleError> {
    if parameters.iter().any(|(_, value)| *value > 0.0) {
        return Ok(());
    }
    let names: Vec<_> = parameters.iter().map(|(name, _)| *name).collect();
    let rule = match names[..] {
        [only] => format!("{only} > 0"),
        _ => format!("one of {} to be positive", names.join(", ")),
    };
    Err(RuleError { rule, parameter: names[0] })
}

/// What a catalog row builds.
pub type Built = Result<Network, RuleError>;

/// One law of the catalog.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Name in scenario files.
    pub name: &'static str,
    /// The law in one line.
    pub equation: &'static str,
    /// Parameters, in the order `build` takes them.
    pub params: &'static [Param],
    /// Inputs, in the order the law takes them.
    pub inputs: &'static [Input],
    /// Where it comes from.
    pub source: &'static str,
    /// Builds the law from parameter values (SI, in the order of `params`, each within its range).
    pub build: fn(&[f64], Derivative) -> Built,
}

/// A set of laws; a user's crate can add rows to the standard one.
#[derive(Debug, Clone)]
pub struct Catalog {
    entries: Vec<Entry>,
}

impl Catalog {
    /// The laws that come with Springpot.
    pub fn standard() -> Self {
        Self {
            entries: vec![
                kelvin_voigt::SPRING,
                kelvin_voigt::DASHPOT,
                kelvin_voigt::SPRINGPOT,
                kelvin_voigt::KELVIN_VOIGT,
                kelvin_voigt::FRACTIONAL_KELVIN_VOIGT,
                thermoviscoelastic::THERMOVISCOELASTIC,
                piezo::PIEZO_KELVIN_VOIGT,
                magnetorheological::MAGNETORHEOLOGICAL,
            ],
        }
    }

    /// Adds a law; a law of the same name is replaced.
    pub fn with(mut self, entry: Entry) -> Self {
        self.entries.retain(|e| e.name != entry.name);
        self.entries.push(entry);
        self
    }

    /// The law of that name.
    pub fn get(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|e| e.name == name)
    }

    /// All laws, in order.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }
}
