//! The ends of a joint as stops.

use super::contract::Leaf;
use crate::law::network::Holds;
use crate::law::rule::RuleError;
use crate::law::state::StateRef;
use crate::law::step::{Observation, Point, Powers, Response, Step, Term};
use crate::law::tangent::LeafAtRest;

/// F = max(k·e + d·x', 0) where x is e ≥ 0 above `upper`, F = min(k·e + d·x', 0) where it is e ≤ 0 below `lower`, 0 between them: it pushes back and
/// never pulls. Stores ½k·e²; what it does not give back is dissipated.
///
/// Where it is reached at speed its force jumps by d·x'.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndStop {
    /// Stiffness k > 0, N/m.
    pub stiffness: f64,
    /// Damping d ≥ 0, N·s/m.
    pub damping: f64,
    /// Where it is free, m: from `lower` to `upper` ≥ `lower`; an end that is infinite is no stop.
    pub lower: f64,
    /// See `lower`.
    pub upper: f64,
}

impl EndStop {
    /// Stops whose parameters keep their rules.
    ///
    /// # Errors
    /// [`RuleError`]: k > 0, d ≥ 0, lower ≤ upper.
    pub fn new(stiffness: f64, damping: f64, lower: f64, upper: f64) -> Result<Self, RuleError> {
        RuleError::unless(stiffness > 0.0, "k > 0", "k")?;
        RuleError::unless(damping >= 0.0, "d ≥ 0", "d")?;
        RuleError::unless(lower <= upper, "lower ≤ upper", "lower")?;
        Ok(Self { stiffness, damping, lower, upper })
    }

    /// How far it is beyond an end, and on which side that is; on the end itself it is beyond.
    fn beyond(&self, x: f64) -> Option<(f64, f64)> {
        if x >= self.upper {
            Some((x - self.upper, 1.0))
        } else if x <= self.lower {
            Some((x - self.lower, -1.0))
        } else {
            None
        }
    }

    /// The force, and its derivatives by stroke and rate.
    fn response(&self, x: f64, rate: f64) -> (f64, f64, f64) {
        let Some((excess, side)) = self.beyond(x) else { return (0.0, 0.0, 0.0) };
        let force = self.stiffness * excess + self.damping * rate;
        if side * force > 0.0 { (force, self.stiffness, self.damping) } else { (0.0, 0.0, 0.0) }
    }

    fn stored(&self, x: f64) -> f64 {
        self.beyond(x).map_or(0.0, |(excess, _)| 0.5 * self.stiffness * excess * excess)
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
        for ((power, x), rate) in powers.iter_mut().zip(step.stroke).zip(step.rate) {
            let spring = self.beyond(*x).map_or(0.0, |(excess, _)| self.stiffness * excess);
            power.dissipation += (self.response(*x, *rate).0 - spring) * rate;
        }
    }

    fn now(&self, at: &Point, _: StateRef) -> Observation {
        let regular = self.response(at.stroke, at.rate).0;
        Observation { derivative: at.stroke, regular, singular: 0.0, stored: Some(self.stored(at.stroke)) }
    }

    fn linearised(&self, at: &Point) -> Term {
        Term { coefficient: self.response(at.stroke, at.rate).1, order: 0.0 }
    }

    fn at_rest(&self, at: &Point, _: f64) -> LeafAtRest {
        let (force, slope, damping) = self.response(at.stroke, 0.0);
        let term = Term { coefficient: slope, order: 0.0 };
        LeafAtRest { force, stiffness: Some(slope), term, input: None, damping }
    }

    fn keeps_the_wall_clock(&self) -> bool {
        true
    }

    fn holds(&self) -> Holds {
        Holds::AtTimes
    }

    fn jumps(&self) -> bool {
        self.damping > 0.0
    }

    fn guards(&self, at: &Point, take: &mut dyn FnMut(f64)) {
        // Where it would begin to pull, as a stroke.
        let lag = self.damping / self.stiffness * at.rate;
        for end in [self.lower, self.upper].into_iter().filter(|end| end.is_finite()) {
            take(at.stroke - end);
            if self.damping > 0.0 {
                take(at.stroke - end + lag);
            }
        }
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
