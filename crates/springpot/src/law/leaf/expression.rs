//! The leaf whose force a text says.

use super::columns::{ByColumns, Columns, add_dissipation};
use super::contract::{Holds, Leaf};
use super::kind::{LeafBuild, LeafKind};
use crate::dual::{Dual, Real};
use crate::fractional::KernelError;
use crate::law::catalog::{Param, Range};
use crate::law::state::{State, StateRef};
use crate::law::step::{Observation, Point, Power, Powers, Response, Start, Step, Term};
use crate::law::tangent::{AtRest, Tangent};
use crate::quadrature;
use crate::signal::{BoundExpression, StrokeExpression};
use std::sync::Arc;

/// F = f(x, x'), as an expression of the stroke and its rate says.
///
/// Where no rate occurs in it, it stores ∫₀ˣ f dx and loses nothing. Where one does, nobody knows what of its work it could give back: `stored` and
/// `dissipated` are unknown, as where the integral does not exist. What warms a heated element is (f(x, x') − f(x, 0))·x' then.
#[derive(Debug, Clone)]
pub struct ExpressionLeaf {
    expression: Arc<StrokeExpression>,
    /// Its parameters, in the order of [`StrokeExpression::parameters`].
    numbers: Vec<Dual>,
    /// It with their values.
    bound: Arc<BoundExpression>,
    has_rate: bool,
    holds: Holds,
}

impl ExpressionLeaf {
    /// Of the values of its parameters, in the order of [`StrokeExpression::parameters`].
    pub fn new(expression: Arc<StrokeExpression>, numbers: Vec<Dual>) -> Self {
        let has_rate = expression.has_rate();
        let bound = Arc::new(expression.bind(&Dual::values(&numbers)));
        let holds = holds(&bound, has_rate);
        Self { expression, numbers, bound, has_rate, holds }
    }

    fn at<T: Real>(&self, x: T, rate: T) -> T {
        match T::HAS_SLOPE {
            true => self.expression.value_of(x, rate, &self.numbers),
            false => self.bound.value(x.value(), rate.value()).into(),
        }
    }

    /// f(x, 0), and its derivatives by stroke and rate there.
    fn resting(&self, x: f64) -> (f64, [f64; 2]) {
        let gradient = self.bound.gradient(x, 0.0);
        (gradient.value, gradient.by)
    }

    /// ∫₀ˣ f dx.
    fn energy<T: Real>(&self, x: T) -> T {
        let end = x.value();
        let value = |s: f64| self.at(x * s.into(), 0.0.into());
        let branch = |s: f64| self.bound.branch(s * end, 0.0);
        x * match self.bound.has_kinks() {
            true => {
                let argument = |bit: u32, s: f64| self.bound.argument(bit, s * end, 0.0);
                quadrature::between_kinks([0.0, 1.0], &value, &branch, &argument)
            }
            false => quadrature::smooth([0.0, 1.0], &value),
        }
    }
}

/// Whether its force grows with its stroke or its rate everywhere, as far as strokes and rates from 1e-9 to 1e3 tell.
fn holds(bound: &BoundExpression, has_rate: bool) -> Holds {
    let sizes = || (-9..=3).map(|power| 10.0f64.powi(power));
    let values: Vec<f64> = sizes().map(|size| -size).chain([0.0]).chain(sizes()).collect();
    let rates: &[f64] = if has_rate { &values } else { &[0.0] };
    let points = values.iter().flat_map(|x| rates.iter().map(|rate| bound.gradient(*x, *rate)));
    let (mut gives, mut grows) = (false, true);
    for point in points.filter(|point| point.value.is_finite() && point.by.iter().all(|slope| slope.is_finite())) {
        gives |= point.value != 0.0;
        grows &= point.by.iter().all(|slope| *slope >= 0.0) && point.by.iter().any(|slope| *slope > 0.0);
    }
    match (gives, grows) {
        (false, _) => Holds::Never,
        (true, true) => Holds::Always,
        (true, false) => Holds::AtTimes,
    }
}

impl Leaf for ExpressionLeaf {
    fn name(&self) -> &'static str {
        "expression"
    }

    fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        if self.has_rate || !self.energy(start.stroke).is_finite() {
            state.hide_energy();
        }
        Ok(())
    }

    fn evaluate(&self, step: &Step, _: StateRef, response: &mut Response) {
        for i in 0..step.nodes.count() {
            let own = self.bound.gradient(step.stroke[i + 1], step.rate[i + 1]);
            response.force[i] += own.value;
            response.d_stroke[i][i] += own.by[0];
            response.d_rate[i][i] += own.by[1];
        }
    }

    fn powers(&self, step: &Step, _: StateRef, powers: &mut Powers) {
        if self.has_rate {
            add_dissipation(self, step, powers);
        }
    }

    fn now(&self, at: &Point, _: StateRef) -> Observation {
        self.between(at, &[])
    }

    fn by_columns(&self) -> Option<&dyn ByColumns> {
        Some(self)
    }

    fn linearised(&self, at: &Point) -> Term {
        match self.bound.gradient(at.stroke, at.rate).by {
            [stiffness, 0.0] => Term { coefficient: stiffness.abs(), order: 0.0 },
            [_, damping] => Term { coefficient: damping.abs(), order: 1.0 },
        }
    }

    fn linearised_slope(&self, _: &Point<Dual>) -> Option<Term> {
        let is_linear = Leaf::is_linear(self);
        let [none, one] = [0.0, 1.0].map(Dual::from);
        let [stroke, rate] = [(one, none), (none, one)].map(|(x, v)| self.at(x, v) - self.at(none, none));
        let own = if rate.value == 0.0 { stroke } else { rate };
        is_linear.then_some(Term { coefficient: own.slope, order: 0.0 })
    }

    fn at_rest(&self, at: &Point, _: f64) -> AtRest {
        let (force, [slope, damping]) = self.resting(at.stroke);
        // Of a dashpot there is none.
        let stiffness = (!self.has_rate || force != 0.0 || slope != 0.0).then_some(slope);
        AtRest { force, stiffness, tangent: Tangent::damped(slope, damping) }
    }

    fn holds(&self) -> Holds {
        self.holds
    }

    fn is_linear(&self) -> bool {
        self.expression.is_affine()
    }

    fn guards(&self, at: &Point, take: &mut dyn FnMut(f64)) {
        self.bound.kinks(at.stroke, at.rate, take);
    }

    fn jumps(&self) -> bool {
        self.expression.may_jump()
    }

    fn jumps_at(&self, stroke: Dual, take: &mut dyn FnMut(Dual)) {
        self.expression.kinks(stroke, 0.0.into(), &self.numbers, &mut |kink| {
            if kink.jumps {
                take(kink.argument);
            }
        });
    }
}

impl Columns for ExpressionLeaf {
    type Solved<T: Real> = ();

    fn each_number(&mut self, take: &mut dyn FnMut(&mut Dual)) {
        self.numbers.iter_mut().for_each(take);
    }

    fn solved(&self, _: &Step, _: &[f64]) {}

    fn follow(&self, _: &Step<Dual>, _: &[Dual], (): &()) {}

    fn force<T: Real>(&self, step: &Step<T>, (): &(), k: usize) -> T {
        self.at(step.stroke[k], step.rate[k])
    }

    fn power<T: Real>(&self, step: &Step<T>, _: &[T], (): &(), k: usize) -> Power<T> {
        let none = || 0.0.into();
        if !self.has_rate {
            return Power { dissipation: none(), input: none() };
        }
        let (x, rate) = (step.stroke[k], step.rate[k]);
        Power { dissipation: (self.at(x, rate) - self.at(x, none())) * rate, input: none() }
    }

    fn between<T: Real>(&self, at: &Point<T>, _: &[T]) -> Observation<T> {
        let stored = (!self.has_rate).then(|| self.energy(at.stroke));
        Observation { derivative: at.stroke, regular: self.at(at.stroke, at.rate), singular: 0.0.into(), stored }
    }
}

/// What networks know of it.
pub(super) fn kind() -> LeafKind {
    let meaning = "expression of the stroke x, its rate v and parameters, such as \"k*x + b*x^3\"";
    LeafKind {
        name: "expression",
        equation: "F = f(x, v), an expression of stroke, rate and parameters",
        params: vec![Param::new("f", "", meaning, Range::ANY)],
        build: LeafBuild::Expression(|expression, numbers| Arc::new(ExpressionLeaf::new(expression.clone(), numbers))),
    }
}
