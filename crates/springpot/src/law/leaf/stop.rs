//! Springs that are free at some strokes: taut ropes, pads that lift off, end stops.

use super::contract::Free;
use super::elastic::Elastic;
use super::kind::{LeafBuild, LeafKind};
use crate::law::catalog::{Param, Range};
use crate::law::network::{Holds, Network};
use crate::law::rule::RuleError;

/// F = k·(x − upper) above `upper`, k·(x − lower) below `lower`, 0 between them. Stores ½F²/k.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Stiffness k ≥ 0, N/m.
    pub stiffness: f64,
    /// Where it is free, m: from `lower` to `upper` ≥ `lower`; an end that is infinite is no stop.
    pub lower: f64,
    /// See `lower`.
    pub upper: f64,
}

impl Stop {
    /// F = k·max(x, 0): pulls only.
    pub fn tension(stiffness: f64) -> Self {
        Self { stiffness, lower: f64::NEG_INFINITY, upper: 0.0 }
    }

    /// F = k·min(x, 0): pushes only.
    pub fn compression(stiffness: f64) -> Self {
        Self { stiffness, lower: 0.0, upper: f64::INFINITY }
    }

    /// A stop whose parameters keep its rules.
    ///
    /// # Errors
    /// [`RuleError`]: k ≥ 0, lower ≤ upper.
    pub fn new(stiffness: f64, lower: f64, upper: f64) -> Result<Self, RuleError> {
        RuleError::unless(stiffness >= 0.0, "k ≥ 0", "k")?;
        RuleError::unless(lower <= upper, "lower ≤ upper", "lower")?;
        Ok(Self { stiffness, lower, upper })
    }

    /// How far beyond its free strokes it is.
    fn excess(&self, x: f64) -> f64 {
        (x - self.upper).max(0.0) + (x - self.lower).min(0.0)
    }
}

impl Elastic for Stop {
    fn name(&self) -> &'static str {
        match [self.lower, self.upper] {
            [f64::NEG_INFINITY, 0.0] => "tension",
            [0.0, f64::INFINITY] => "compression",
            _ => "stop",
        }
    }

    fn force(&self, x: f64) -> f64 {
        self.stiffness * self.excess(x)
    }

    fn slope(&self, x: f64) -> f64 {
        // With no play it is a spring, at its end too.
        if x > self.upper || x < self.lower || self.lower == self.upper { self.stiffness } else { 0.0 }
    }

    fn energy(&self, x: f64) -> f64 {
        // From x = 0, where it may be engaged already.
        0.5 * self.stiffness * (self.excess(x).powi(2) - self.excess(0.0).powi(2))
    }

    fn holds(&self) -> Holds {
        match self.stiffness {
            0.0 => Holds::Never,
            _ if self.lower == self.upper => Holds::Always,
            _ => Holds::LetsGo,
        }
    }

    fn free(&self) -> Option<Free> {
        let Self { stiffness, lower, upper } = *self;
        (Elastic::holds(self) == Holds::LetsGo).then_some(Free { stiffness, lower, upper })
    }

    fn is_linear(&self) -> bool {
        self.stiffness == 0.0 || self.lower == self.upper
    }

    fn guards(&self, x: f64, take: &mut dyn FnMut(f64)) {
        if Elastic::is_linear(self) {
            return;
        }
        [self.lower, self.upper].into_iter().filter(|end| end.is_finite()).for_each(|end| take(x - end));
    }
}

fn one_sided(name: &'static str, equation: &'static str, build: LeafBuild) -> LeafKind {
    LeafKind { name, equation, params: vec![Param::new("k", "N/m", "stiffness", Range::NOT_NEGATIVE)], build }
}

/// What networks know of the one that pulls.
pub(super) fn tension() -> LeafKind {
    let build = LeafBuild::Values(|values, _| {
        RuleError::unless(values[0].value >= 0.0, "k ≥ 0", "k")?;
        Ok(Network::leaf(Stop::tension(values[0].value)))
    });
    one_sided("tension", "F = k·max(x, 0)", build)
}

/// What networks know of the one that pushes.
pub(super) fn compression() -> LeafKind {
    let build = LeafBuild::Values(|values, _| {
        RuleError::unless(values[0].value >= 0.0, "k ≥ 0", "k")?;
        Ok(Network::leaf(Stop::compression(values[0].value)))
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
            Ok(Network::leaf(Stop::new(k.value, lower.value, upper.value)?))
        }),
    }
}
