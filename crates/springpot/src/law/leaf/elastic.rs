//! What gives a force that follows from the stroke alone.

use super::contract::{Free, Holds, Leaf, When};
use crate::dual::Dual;
use crate::law::state::StateRef;
use crate::law::step::{Observation, Point, Response, Step, Term};
use crate::law::tangent::{AtRest, Tangent};
use crate::law::variation::{ObservationVariation, PointVariation, StepVariation, VariationRef, add};

/// F(x), linear or not: a leaf that keeps nothing and loses nothing.
///
/// ```
/// use springpot::law::{Elastic, Holds, Network, Point, Start};
///
/// /// F = f·sinh(x/d).
/// #[derive(Debug)]
/// struct Stiffening { f: f64, d: f64 }
///
/// impl Elastic for Stiffening {
///     fn name(&self) -> &'static str { "stiffening" }
///     fn force(&self, x: f64) -> f64 { self.f * (x / self.d).sinh() }
///     fn slope(&self, x: f64) -> f64 { self.f / self.d * (x / self.d).cosh() }
///     fn energy(&self, x: f64) -> f64 { self.f * self.d * ((x / self.d).cosh() - 1.0) }
///     fn holds(&self) -> Holds { Holds::Always }
/// }
///
/// let law = Network::leaf(Stiffening { f: 2.0, d: 0.1 });
/// let state = law.begin(&Start { stroke: 0.1, jump: 0.0, inputs: &[] })?;
/// let now = law.now(&Point { t: 0.0, stroke: 0.1, rate: 0.0, inputs: &[] }, &state);
/// assert_eq!(now.force(), 2.0 * 1.0f64.sinh());
/// # Ok::<(), springpot::fractional::KernelError>(())
/// ```
pub trait Elastic: Send + Sync + std::fmt::Debug {
    /// What it is called ([`Leaf::name`]).
    fn name(&self) -> &'static str;

    /// F at the stroke `x`, N; continuous.
    fn force(&self, x: f64) -> f64;

    /// dF/dx, N/m; at a kink that of either side.
    fn slope(&self, x: f64) -> f64;

    /// ∫₀ˣ F dx, J.
    fn energy(&self, x: f64) -> f64;

    /// What may stand in a series by itself ([`Leaf::holds`]).
    fn holds(&self) -> Holds;

    /// The strokes at which it carries nothing ([`Leaf::free`]).
    fn free(&self) -> Option<Free> {
        None
    }

    /// Whether F is an affine function of x.
    fn is_linear(&self) -> bool {
        false
    }

    /// Hands over its numbers ([`Leaf::numbers`]).
    fn numbers(&self, _take: &mut dyn FnMut(Dual)) -> bool {
        false
    }

    /// Hands over ∂F/∂n and ∂(∫₀ˣ F dx)/∂n at the stroke `x` by each number n, in their order.
    fn by_numbers(&self, _x: f64, _take: &mut dyn FnMut([f64; 2])) {}

    /// Hands over functions of x that pass zero where F has a kink ([`Leaf::guards`]).
    fn guards(&self, _x: f64, _take: &mut dyn FnMut(f64)) {}
}

impl<T: Elastic> Leaf for T {
    fn name(&self) -> &'static str {
        Elastic::name(self)
    }

    fn evaluate(&self, step: &Step, _: StateRef, response: &mut Response) {
        for i in 0..step.nodes.count() {
            response.force[i] += self.force(step.stroke[i + 1]);
            response.d_stroke[i][i] += self.slope(step.stroke[i + 1]);
        }
    }

    fn now(&self, at: &Point, _: StateRef) -> Observation {
        let x = at.stroke;
        Observation { derivative: x, regular: self.force(x), singular: 0.0, stored: Some(self.energy(x)) }
    }

    fn linearised(&self, at: &Point) -> Term {
        Term { coefficient: self.slope(at.stroke).abs(), order: 0.0 }
    }

    fn linearised_slope(&self, _: &Point<Dual>) -> Option<Term> {
        if !Elastic::is_linear(self) {
            return None;
        }
        let (mut numbers, mut by_numbers, mut at_zero) = (Vec::new(), Vec::new(), Vec::new());
        let known = Elastic::numbers(self, &mut |number| numbers.push(number));
        self.by_numbers(1.0, &mut |[force, _]| by_numbers.push(force));
        self.by_numbers(0.0, &mut |[force, _]| at_zero.push(force));
        let each = numbers.iter().zip(by_numbers.iter().zip(&at_zero));
        let coefficient = each.map(|(number, (one, zero))| number.slope * (one - zero)).sum();
        known.then_some(Term { coefficient, order: 0.0 })
    }

    fn at_rest(&self, at: &Point, _: f64) -> AtRest {
        let slope = self.slope(at.stroke);
        let stiffness = (Elastic::holds(self) != Holds::Never).then_some(slope);
        AtRest { force: self.force(at.stroke), stiffness, tangent: Tangent::spring(slope) }
    }

    fn holds(&self) -> Holds {
        Elastic::holds(self)
    }

    fn free(&self) -> Option<Free> {
        Elastic::free(self)
    }

    fn is_linear(&self) -> bool {
        Elastic::is_linear(self)
    }

    fn guards(&self, at: &Point, take: &mut dyn FnMut(f64)) {
        Elastic::guards(self, at.stroke, take);
    }

    fn numbers(&self, take: &mut dyn FnMut(Dual)) -> bool {
        Elastic::numbers(self, take)
    }

    fn vary(&self, step: &Step, _: StateRef, _: &StepVariation, own: VariationRef, forces: &mut [f64]) {
        for (i, forces) in forces.chunks_exact_mut(own.count).enumerate() {
            let mut numbers = own.numbers.chunks_exact(own.count);
            self.by_numbers(step.stroke[i + 1], &mut |[force, _]| {
                numbers.next().into_iter().for_each(|number| add(forces, force, number));
            });
        }
    }

    fn vary_at(
        &self,
        _: When,
        at: &Point,
        _: StateRef,
        told: &PointVariation,
        own: VariationRef,
        sum: &mut ObservationVariation,
    ) {
        let mut numbers = own.numbers.chunks_exact(own.count);
        self.by_numbers(at.stroke, &mut |[force, energy]| {
            let Some(number) = numbers.next() else { return };
            add(sum.force, force, number);
            add(sum.stored, energy, number);
        });
        add(sum.force, self.slope(at.stroke), told.stroke);
        add(sum.stored, self.force(at.stroke), told.stroke);
    }
}
