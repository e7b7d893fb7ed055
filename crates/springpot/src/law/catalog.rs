//! The catalog of laws: what the parser, the command line and the documentation know about them.

use super::network::Network;
use super::rule::RuleError;
use crate::dual::Dual;
use crate::fractional::Kind as Derivative;
use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

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
#[derive(Debug, Clone, PartialEq)]
pub struct Param {
    /// Name in scenario files.
    pub name: Cow<'static, str>,
    /// Unit in the grammar of quantities; an exponent may name a parameter of the same law. Empty: a pure number.
    pub unit: Cow<'static, str>,
    /// What it is, in a few words.
    pub meaning: Cow<'static, str>,
    /// Admissible values, SI.
    pub range: Range,
    /// Value where the file says nothing; `None`: must be given.
    pub default: Option<f64>,
    /// It is a list of such values; all lists of a law have one length.
    pub is_list: bool,
}

impl Param {
    /// A parameter that must be given.
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        unit: impl Into<Cow<'static, str>>,
        meaning: impl Into<Cow<'static, str>>,
        range: Range,
    ) -> Self {
        Self { name: name.into(), unit: unit.into(), meaning: meaning.into(), range, default: None, is_list: false }
    }

    /// As it is, with a value, SI, where the file says nothing.
    pub fn or(self, default: f64) -> Self {
        Self { default: Some(default), ..self }
    }

    /// A list of them.
    pub fn list(self) -> Self {
        Self { is_list: true, ..self }
    }
}

/// One input of a law: a signal.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    /// Name in scenario files and columns.
    pub name: Cow<'static, str>,
    /// Unit.
    pub unit: Cow<'static, str>,
    /// What it is, in a few words.
    pub meaning: Cow<'static, str>,
    /// Admissible values, SI.
    pub range: Range,
}

impl Input {
    /// An input of these words and values.
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        unit: impl Into<Cow<'static, str>>,
        meaning: impl Into<Cow<'static, str>>,
        range: Range,
    ) -> Self {
        Self { name: name.into(), unit: unit.into(), meaning: meaning.into(), range }
    }
}

/// The order of the fractional derivative, as every law names it.
pub(super) fn alpha() -> Param {
    Param::new("alpha", "", "order of the fractional derivative (0: spring, 1: dashpot)", Range::UNIT)
}

/// The stiffness of the carrier in the laws of the papers.
pub(super) fn carrier() -> Param {
    Param::new("E_c", "N/m", "stiffness of the carrier", Range::NOT_NEGATIVE)
}

/// The coefficient of D^alpha x in the laws of the papers.
pub(super) fn damping() -> Param {
    Param::new("E_d", "N*s^alpha/m", "coefficient of the fractional derivative", Range::NOT_NEGATIVE)
}

/// A law without any positive coefficient is no material.
pub(super) fn at_least_one_positive(parameters: &[(&'static str, Dual)]) -> Result<(), RuleError> {
    if parameters.iter().any(|(_, number)| number.value > 0.0) {
        return Ok(());
    }
    let names: Vec<_> = parameters.iter().map(|(name, _)| *name).collect();
    let rule = match names[..] {
        [only] => format!("{only} > 0"),
        _ => format!("one of {} to be positive", names.join(", ")),
    };
    Err(RuleError { rule, parameter: names[0].into() })
}

/// What a catalog row builds.
pub type Built = Result<Network, RuleError>;

/// How a catalog row builds its law: from the numbers of its parameters (SI, in the order of the row, each within its range), and the derivative
/// that its springpots take. They carry their derivatives into the numbers of its leaves, whatever it makes of them.
pub type Build = Arc<dyn Fn(&[Dual], Derivative) -> Built + Send + Sync>;

/// One law of the catalog. It owns all it says, so that it can come from a file, a network or another language as well.
///
/// ```
/// use springpot::law::{Catalog, Derivative, Entry, Network, Param, Range};
/// use std::sync::Arc;
///
/// // Read from somewhere: springs of different stiffness, side by side.
/// let springs = ["k_left", "k_right"];
/// let entry = Entry {
///     name: "springs".into(),
///     equation: format!("F = ({})·x", springs.join(" + ")).into(),
///     params: springs.iter().map(|name| Param::new(*name, "N/m", "stiffness", Range::NOT_NEGATIVE)).collect(),
///     inputs: Vec::new(),
///     source: "Hooke".into(),
///     build: Arc::new(|values, _| Ok(Network::parallel(values.iter().map(|k| Network::spring(*k))))),
/// };
/// let catalog = Catalog::standard().with(entry);
/// let springs = catalog.get("springs").expect("the law that was added");
/// assert_eq!(springs.equation, "F = (k_left + k_right)·x");
/// assert!(springs.build(&[3.0, 4.0], Derivative::Caputo).is_ok());
/// ```
#[derive(Clone)]
pub struct Entry {
    /// Name in scenario files.
    pub name: Cow<'static, str>,
    /// The law in one line.
    pub equation: Cow<'static, str>,
    /// Parameters, in the order `build` takes them; of a list all values, one after the other.
    pub params: Vec<Param>,
    /// Inputs, in the order the law takes them.
    pub inputs: Vec<Input>,
    /// Where it comes from.
    pub source: Cow<'static, str>,
    /// Builds the law.
    pub build: Build,
}

impl Entry {
    /// The law of these values, in the order of the parameters.
    ///
    /// # Errors
    /// The rule that they break.
    pub fn build(&self, values: &[f64], derivative: Derivative) -> Built {
        let numbers: Vec<Dual> = values.iter().map(|value| Dual::from(*value)).collect();
        (self.build)(&numbers, derivative)
    }

    /// The law where its lists have `length` values: in place of a list `k` it has the parameters `k.0`, `k.1`, …
    pub fn with_lists(&self, length: usize) -> Self {
        let unfold = |param: &Param| match param.is_list {
            false => vec![param.clone()],
            true => (0..length)
                .map(|k| Param { name: format!("{}.{k}", param.name).into(), is_list: false, ..param.clone() })
                .collect(),
        };
        Self { params: self.params.iter().flat_map(unfold).collect(), ..self.clone() }
    }

    /// Its name as messages write it, in quotes.
    pub fn quoted(&self) -> String {
        if self.name.contains('"') { format!("`{}`", self.name) } else { format!("\"{}\"", self.name) }
    }

    /// Whether a parameter is a list.
    pub fn has_lists(&self) -> bool {
        self.params.iter().any(|param| param.is_list)
    }
}

impl fmt::Debug for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, equation, params, inputs, source, build: _ } = self;
        let mut shown = f.debug_struct("Entry");
        shown.field("name", name).field("equation", equation).field("params", params).field("inputs", inputs);
        shown.field("source", source).finish_non_exhaustive()
    }
}

/// A set of laws; a user's crate can add rows to the standard one. Copies share their rows.
#[derive(Debug, Clone)]
pub struct Catalog {
    pub(super) entries: Vec<Arc<Entry>>,
}

impl Catalog {
    /// Adds a law; a law of the same name is replaced.
    pub fn with(mut self, entry: impl Into<Arc<Entry>>) -> Self {
        let entry = entry.into();
        self.entries.retain(|e| e.name != entry.name);
        self.entries.push(entry);
        self
    }

    /// The law of that name.
    pub fn get(&self, name: &str) -> Option<&Arc<Entry>> {
        self.entries.iter().find(|e| e.name == name)
    }

    /// All laws, in order.
    pub fn entries(&self) -> &[Arc<Entry>] {
        &self.entries
    }
}
