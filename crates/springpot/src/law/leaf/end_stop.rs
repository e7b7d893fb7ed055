//! The ends of a joint as stops.

use super::columns::{ByColumns, Columns, add_dissipation};
use super::contract::{Clock, Holds, Leaf};
use crate::dual::{Dual, Real};
use crate::law::rule::RuleError;
use crate::law::state::StateRef;
use crate::law::step::{Observation, Point, Power, Powers, Response, Step, Term};
use crate::law::tangent::{AtRest, Tangent};

/// F = max(k·e + d·x', 0) where x is e ≥ 0 above `upper`, F = min(k·e + d·x', 0) where it is e ≤ 0 below `lower`, 0 between them: it pushes back and
/// never pulls. Stores ½k·e²; what it does not give back is dissipated.
///
/// Where it is reached at speed its force jumps by d·x'.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndStop {
    /// Stiffness k > 0, N/m.
    pub stiffness: Dual,
    /// Damping d ≥ 0, N·s/m.
    pub damping: Dual,
    /// Where it is free, m: from `lower` to `upper` ≥ `lower`; an end that is infinite is no stop.
    pub lower: Dual,
    /// See `lower`.
    pub upper: Dual,
}

impl EndStop {
    /// Stops whose parameters keep their rules.
    ///
    /// # Errors
    /// [`RuleError`]: k > 0, d ≥ 0, lower ≤ upper.
    pub fn new(
        stiffness: impl Into<Dual>,
        damping: impl Into<Dual>,
        lower: impl Into<Dual>,
        upper: impl Into<Dual>,
    ) -> Result<Self, RuleError> {
        let (stiffness, damping) = (stiffness.into(), damping.into());
        let own = Self { stiffness, damping, lower: lower.into(), upper: upper.into() };
        RuleError::unless(stiffness.value > 0.0, "k > 0", "k")?;
        RuleError::unless(damping.value >= 0.0, "d ≥ 0", "d")?;
        RuleError::unless(own.lower.value <= own.upper.value, "lower ≤ upper", "lower")?;
        Ok(own)
    }

    /// How far it is beyond an end, and on which side that is; on the end itself it is beyond.
    fn beyond<T: Real>(&self, x: T) -> Option<(T, f64)> {
        let [lower, upper] = [self.lower, self.upper].map(T::of);
        if x.value() >= upper.value() {
            Some((x - upper, 1.0))
        } else if x.value() <= lower.value() {
            Some((x - lower, -1.0))
        } else {
            None
        }
    }

    fn force_at<T: Real>(&self, x: T, rate: T) -> T {
        let Some((excess, side)) = self.beyond(x) else { return 0.0.into() };
        let force = T::of(self.stiffness) * excess + T::of(self.damping) * rate;
        if side * force.value() > 0.0 { force } else { 0.0.into() }
    }

    /// The force, and its derivatives by stroke and rate.
    fn response(&self, x: f64, rate: f64) -> (f64, f64, f64) {
        match self.force_at(x, rate) {
            0.0 => (0.0, 0.0, 0.0),
            force => (force, self.stiffness.value, self.damping.value),
        }
    }
}

impl Leaf for EndStop {
    fn name(&self) -> &'static str {
        "end-stop"
    }

    fn evaluate(&self, step: &Step, _: StateRef, response: &mut Response) {
        for i in 0..step.nodes.count() {
            let (force, by_stroke, by_rate) = self.response(step.stroke[i + 1], step.rate[i + 1]);
            response.force[i] += force;
            response.d_stroke[i][i] += by_stroke;
            response.d_rate[i][i] += by_rate;
        }
    }

    fn powers(&self, step: &Step, _: StateRef, powers: &mut Powers) {
        add_dissipation(self, step, powers);
    }

    fn now(&self, at: &Point, _: StateRef) -> Observation {
        self.between(at, &[])
    }

    fn by_columns(&self) -> Option<&dyn ByColumns> {
        Some(self)
    }

    fn linearised(&self, at: &Point) -> Term {
        Term { coefficient: self.response(at.stroke, at.rate).1, order: 0.0 }
    }

    fn at_rest(&self, at: &Point, _: f64) -> AtRest {
        let (force, slope, damping) = self.response(at.stroke, 0.0);
        AtRest { force, stiffness: Some(slope), tangent: Tangent::damped(slope, damping) }
    }

    fn clock(&self) -> Clock {
        Clock::Wall
    }

    fn holds(&self) -> Holds {
        Holds::AtTimes
    }

    fn jumps(&self) -> bool {
        self.damping.value > 0.0
    }

    fn jumps_at(&self, stroke: Dual, take: &mut dyn FnMut(Dual)) {
        let ends = [self.lower, self.upper].into_iter().filter(|end| end.value.is_finite() && self.jumps());
        ends.for_each(|end| take(stroke - end));
    }

    fn guards(&self, at: &Point, take: &mut dyn FnMut(f64)) {
        // Where it would begin to pull, as a stroke.
        let lag = self.damping.value / self.stiffness.value * at.rate;
        for end in [self.lower.value, self.upper.value].into_iter().filter(|end| end.is_finite()) {
            take(at.stroke - end);
            if self.damping.value > 0.0 {
                take(at.stroke - end + lag);
            }
        }
    }
}

impl Columns for EndStop {
    type Solved<T: Real> = ();

    fn each_number(&mut self, take: &mut dyn FnMut(&mut Dual)) {
        let Self { stiffness, damping, lower, upper } = self;
        [stiffness, damping, lower, upper].into_iter().for_each(take);
    }

    fn solved(&self, _: &Step, _: &[f64]) {}

    fn follow(&self, _: &Step<Dual>, _: &[Dual], (): &()) {}

    fn force<T: Real>(&self, step: &Step<T>, (): &(), k: usize) -> T {
        self.force_at(step.stroke[k], step.rate[k])
    }

    fn power<T: Real>(&self, step: &Step<T>, _: &[T], (): &(), k: usize) -> Power<T> {
        let (x, rate) = (step.stroke[k], step.rate[k]);
        let spring = self.beyond(x).map_or(0.0.into(), |(excess, _)| T::of(self.stiffness) * excess);
        Power { dissipation: (self.force_at(x, rate) - spring) * rate, input: 0.0.into() }
    }

    fn between<T: Real>(&self, at: &Point<T>, _: &[T]) -> Observation<T> {
        let stored = self
            .beyond(at.stroke)
            .map_or(0.0.into(), |(excess, _)| T::from(0.5) * T::of(self.stiffness) * excess * excess);
        let regular = self.force_at(at.stroke, at.rate);
        Observation { derivative: at.stroke, regular, singular: 0.0.into(), stored: Some(stored) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_pushes_and_never_pulls() {
        let stop = EndStop::new(100.0, 5.0, -1.0, 2.0).unwrap();
        let force = |x: f64, rate: f64| stop.response(x, rate).0;
        assert_eq!([force(0.0, 9.0), force(1.999, 9.0), force(-0.999, -9.0)], [0.0; 3]);
        assert_eq!(force(2.1, 1.0), 100.0 * (2.1 - 2.0) + 5.0);
        assert_eq!([force(2.1, -1.999), force(2.1, -2.001)].map(|f| f > 0.0), [true, false]);
        assert_eq!(force(-1.5, -1.0), -55.0);
        assert_eq!(force(-1.5, 11.0), 0.0);
        assert_eq!(force(2.0, 3.0), 15.0);
        assert!(EndStop::new(0.0, 1.0, 0.0, 1.0).is_err() && EndStop::new(1.0, -1.0, 0.0, 1.0).is_err());
        assert!(EndStop::new(1.0, 0.0, 1.0, 0.9).is_err());
    }
}
