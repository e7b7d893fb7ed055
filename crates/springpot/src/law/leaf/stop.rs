//! Springs that are free at some strokes: taut ropes, pads that lift off, end stops.

use super::contract::{Free, Holds};
use super::elastic::Elastic;
use super::kind::{LeafBuild, LeafKind};
use crate::dual::Dual;
use crate::law::catalog::{Param, Range};
use crate::law::rule::RuleError;
use std::sync::Arc;

/// F = k·(x − upper) above `upper`, k·(x − lower) below `lower`, 0 between them. Stores ½F²/k.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Stiffness k ≥ 0, N/m.
    pub stiffness: Dual,
    /// Where it is free, m: from `lower` to `upper` ≥ `lower`; an end that is infinite is no stop.
    pub lower: Dual,
    /// See `lower`.
    pub upper: Dual,
}

impl Stop {
    /// F = k·max(x, 0): pulls only.
    pub fn tension(stiffness: impl Into<Dual>) -> Self {
        Self { stiffness: stiffness.into(), lower: f64::NEG_INFINITY.into(), upper: 0.0.into() }
    }

    /// F = k·min(x, 0): pushes only.
    pub fn compression(stiffness: impl Into<Dual>) -> Self {
        Self { stiffness: stiffness.into(), lower: 0.0.into(), upper: f64::INFINITY.into() }
    }

    /// A stop whose parameters keep its rules.
    ///
    /// # Errors
    /// [`RuleError`]: k ≥ 0, lower ≤ upper.
    pub fn new(stiffness: impl Into<Dual>, lower: impl Into<Dual>, upper: impl Into<Dual>) -> Result<Self, RuleError> {
        let own = Self { stiffness: stiffness.into(), lower: lower.into(), upper: upper.into() };
        RuleError::unless(own.stiffness.value >= 0.0, "k ≥ 0", "k")?;
        RuleError::unless(own.lower.value <= own.upper.value, "lower ≤ upper", "lower")?;
        Ok(own)
    }

    fn ends(&self) -> [f64; 2] {
        [self.lower.value, self.upper.value]
    }

    /// How far below and above its free strokes it is.
    fn beyond(&self, x: f64) -> [f64; 2] {
        let [lower, upper] = self.ends();
        [(x - lower).min(0.0), (x - upper).max(0.0)]
    }

    /// How far beyond its free strokes it is.
    fn excess(&self, x: f64) -> f64 {
        let [below, above] = self.beyond(x);
        above + below
    }
}

impl Elastic for Stop {
    fn name(&self) -> &'static str {
        match self.ends() {
            [f64::NEG_INFINITY, 0.0] => "tension",
            [0.0, f64::INFINITY] => "compression",
            _ => "stop",
        }
    }

    fn force(&self, x: f64) -> f64 {
        self.stiffness.value * self.excess(x)
    }

    fn slope(&self, x: f64) -> f64 {
        let [lower, upper] = self.ends();
        // With no play it is a spring, at its end too.
        if x > upper || x < lower || lower == upper { self.stiffness.value } else { 0.0 }
    }

    fn energy(&self, x: f64) -> f64 {
        // From x = 0, where it may be engaged already.
        0.5 * self.stiffness.value * (self.excess(x).powi(2) - self.excess(0.0).powi(2))
    }

    fn numbers(&self, take: &mut dyn FnMut(Dual)) -> bool {
        [self.stiffness, self.lower, self.upper].into_iter().for_each(take);
        true
    }

    fn by_numbers(&self, x: f64, take: &mut dyn FnMut([f64; 2])) {
        take([self.excess(x), 0.5 * (self.excess(x).powi(2) - self.excess(0.0).powi(2))]);
        let k = self.stiffness.value;
        for (own, zero) in self.beyond(x).into_iter().zip(self.beyond(0.0)) {
            take([if own == 0.0 { 0.0 } else { -k }, -k * (own - zero)]);
        }
    }

    fn holds(&self) -> Holds {
        let [lower, upper] = self.ends();
        match self.stiffness.value {
            0.0 => Holds::Never,
            _ if lower == upper => Holds::Always,
            _ => Holds::LetsGo,
        }
    }

    fn free(&self) -> Option<Free> {
        let (stiffness, [lower, upper]) = (self.stiffness.value, self.ends());
        (Elastic::holds(self) == Holds::LetsGo).then_some(Free { stiffness, lower, upper })
    }

    fn is_linear(&self) -> bool {
        self.stiffness.value == 0.0 || self.lower.value == self.upper.value
    }

    fn guards(&self, x: f64, take: &mut dyn FnMut(f64)) {
        if Elastic::is_linear(self) {
            return;
        }
        self.ends().into_iter().filter(|end| end.is_finite()).for_each(|end| take(x - end));
    }
}

fn one_sided(name: &'static str, equation: &'static str, build: LeafBuild) -> LeafKind {
    LeafKind { name, equation, params: vec![Param::new("k", "N/m", "stiffness", Range::NOT_NEGATIVE)], build }
}

/// What networks know of the one that pulls.
pub(super) fn tension() -> LeafKind {
    let build = LeafBuild::Values(|values, _| {
        RuleError::unless(values[0].value >= 0.0, "k ≥ 0", "k")?;
        Ok(Arc::new(Stop::tension(values[0])))
    });
    one_sided("tension", "F = k·max(x, 0)", build)
}

/// What networks know of the one that pushes.
pub(super) fn compression() -> LeafKind {
    let build = LeafBuild::Values(|values, _| {
        RuleError::unless(values[0].value >= 0.0, "k ≥ 0", "k")?;
        Ok(Arc::new(Stop::compression(values[0])))
    });
    one_sided("compression", "F = k·min(x, 0)", build)
}

/// What networks know of the one that is free between two ends.
pub(super) fn kind() -> LeafKind {
    LeafKind {
        name: "stop",
        equation: "F = k·(x − upper) above upper, k·(x − lower) below lower, 0 between",
        params: vec![
            Param::new("k", "N/m", "stiffness", Range::NOT_NEGATIVE),
            Param::new("lower", "m", "stroke below which it pushes", Range::ANY),
            Param::new("upper", "m", "stroke above which it pulls", Range::ANY),
        ],
        build: LeafBuild::Values(|values, _| {
            let &[k, lower, upper] = values else { unreachable!("values follow params") };
            Ok(Arc::new(Stop::new(k, lower, upper)?))
        }),
    }
}
