//! A spring that slips: Jenkins' element.

use super::columns::{ByColumns, Columns};
use super::contract::{Guard, Holds, Leaf};
use super::kind::{LeafBuild, LeafKind};
use crate::collocation::{MAX_NODES, Nodes};
use crate::dual::{Dual, Real};
use crate::fractional::KernelError;
use crate::law::catalog::{Param, Range};
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{Observation, Point, Power, Powers, Response, Start, Step, Term};
use crate::law::tangent::{AtRest, Tangent};
use num_complex::Complex64;
use std::cmp::Ordering;
use std::f64::consts::PI;
use std::sync::Arc;

/// A spring k in series with Coulomb friction F_y: F = k·(x − p), |F| ≤ F_y, where p, what has slipped, moves only as far as it must (Jenkins 1962; Iwan 1966).
///
/// Between two turning points dF = k·dx, cut at ±F_y. p(0) = 0, so that F(0) = k·x(0), cut at ±F_y. Stores F²/(2k), dissipates F_y·|p'|; the rate does not
/// matter. p is one inner variable, which follows from the strokes at the nodes alone; where it begins and ceases to slip F has a kink.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jenkins {
    stiffness: Dual,
    limit: Dual,
}

/// What has slipped over a step.
pub struct Slipped<T = f64> {
    /// At the start and at the nodes.
    at: [T; MAX_NODES + 1],
    /// At the end.
    end: T,
    /// By node: the last one until there at which it slips.
    last: [Option<usize>; MAX_NODES],
    /// ∫|p'| dt.
    way: T,
}

/// It yields where it has gone this share of the way to that: the rest is rounding.
const AT_YIELD: f64 = 1.0 - 1e-10;

impl Jenkins {
    /// k in N/m, F_y in N.
    ///
    /// # Errors
    /// [`RuleError`]: k > 0, F_y > 0.
    pub fn new(stiffness: impl Into<Dual>, limit: impl Into<Dual>) -> Result<Self, RuleError> {
        let (stiffness, limit) = (stiffness.into(), limit.into());
        RuleError::unless(stiffness.value > 0.0, "k > 0", "k")?;
        RuleError::unless(limit.value > 0.0, "F_y > 0", "F_y")?;
        Ok(Self { stiffness, limit })
    }

    /// Both one behind the other, which is one again: 1/k = 1/k_1 + 1/k_2, and the weaker slips alone.
    pub fn behind(self, other: Self) -> Self {
        let one = Dual::from(1.0);
        let stiffness = one / (one / self.stiffness + one / other.stiffness);
        Self { stiffness, limit: if other.limit.value < self.limit.value { other.limit } else { self.limit } }
    }

    /// The same with a spring `stiffness` > 0, N/m, behind it.
    pub fn behind_spring(self, stiffness: impl Into<Dual>) -> Self {
        self.behind(Self { stiffness: stiffness.into(), limit: f64::INFINITY.into() })
    }

    /// k, N/m.
    pub fn stiffness(&self) -> f64 {
        self.stiffness.value
    }

    /// F_y, N.
    pub fn limit(&self) -> f64 {
        self.limit.value
    }

    /// The stroke F_y/k at which it yields, m.
    pub fn yields_at(&self) -> f64 {
        self.limit.value / self.stiffness.value
    }

    /// F where `slipped` has slipped before the stroke went to `stroke` on one way, N.
    pub fn force(&self, slipped: f64, stroke: f64) -> f64 {
        (self.stiffness.value * (stroke - slipped)).clamp(-self.limit.value, self.limit.value)
    }

    /// What has slipped once the stroke has gone to `stroke` on one way, m.
    pub fn slipped(&self, slipped: f64, stroke: f64) -> f64 {
        let reach = self.yields_at();
        // Not `clamp`, which ends the program where a stroke is no number.
        slipped.max(stroke - reach).min(stroke + reach)
    }

    fn over(&self, step: &Step, start: f64) -> Slipped {
        let count = step.nodes.count();
        let mut slipped = Slipped { at: [start; MAX_NODES + 1], end: start, last: [None; MAX_NODES], way: 0.0 };
        let mut last = None;
        for i in 0..count {
            let before = slipped.at[i];
            slipped.at[i + 1] = self.slipped(before, step.stroke[i + 1]);
            slipped.way += (slipped.at[i + 1] - before).abs();
            if slipped.at[i + 1] != before {
                last = Some(i);
            }
            slipped.last[i] = last;
        }
        slipped.end = match step.nodes {
            Nodes::Midpoint => self.slipped(slipped.at[1], 2.0 * step.stroke[1] - step.stroke[0]),
            _ => slipped.at[count],
        };
        slipped.way += (slipped.end - slipped.at[count]).abs();
        slipped
    }
}

impl Leaf for Jenkins {
    fn name(&self) -> &'static str {
        "jenkins"
    }

    fn size(&self) -> StateSize {
        StateSize { memories: 0, variables: 1 }
    }

    fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        state.push_variable(self.slipped(0.0, start.stroke));
        Ok(())
    }

    fn evaluate(&self, step: &Step, state: StateRef, response: &mut Response) {
        let slipped = self.over(step, state.variables[0]);
        for i in 0..step.nodes.count() {
            response.force[i] += self.force(slipped.at[i], step.stroke[i + 1]);
            match slipped.last[i] {
                Some(last) if last == i => {}
                last => {
                    response.d_stroke[i][i] += self.stiffness.value;
                    // What slipped before follows the stroke there.
                    last.into_iter().for_each(|last| response.d_stroke[i][last] -= self.stiffness.value);
                }
            }
        }
    }

    fn commit(&self, step: &Step, state: StateMut) {
        state.variables[0] = self.over(step, state.variables[0]).end;
    }

    fn recalls(&self) -> bool {
        true
    }

    /// Where it came to from p = 0: a loop that yields is the same after a period, whatever was before.
    fn recall(&self, turns: &[f64], variables: &mut [f64]) {
        self.after_turns(turns, &mut |slipped| variables[0] = slipped);
    }

    /// F_y·|p'|: in proportion to the rate where it slips all along, and with the integral F_y·∫|p'| dt to the last bit.
    fn powers(&self, step: &Step, state: StateRef, powers: &mut Powers) {
        let slipped = self.over(step, state.variables[0]);
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            power.dissipation += self.power(step, &[], &slipped, k).dissipation;
        }
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: StateRef) -> Observation {
        let slipped = self.over(step, state.variables[0]);
        let before = step.positions().iter().take_while(|node| **node < theta).count();
        self.between(at, &[slipped.at[before]])
    }

    fn now(&self, at: &Point, state: StateRef) -> Observation {
        self.between(at, state.variables)
    }

    /// Small and fast strokes do not make it slip.
    fn linearised(&self, _: &Point) -> Term {
        Term { coefficient: self.stiffness.value, order: 0.0 }
    }

    /// With x = A cos θ it comes back from F_y over 0 ≤ θ ≤ ϑ, cos ϑ = 1 − 2F_y/(k·A), and slips until θ = π (Caughey 1960).
    fn harmonic(&self, _: &Point, amplitude: f64, _: f64) -> Option<Complex64> {
        let share = self.yields_at() / amplitude;
        if share >= 1.0 {
            return Some(self.stiffness.value.into());
        }
        let angle = 2.0 * share.sqrt().asin();
        let storage = self.stiffness.value / PI * (angle - 0.5 * (2.0 * angle).sin());
        Some(Complex64::new(storage, 4.0 * self.limit.value / (PI * amplitude) * (1.0 - share)))
    }

    /// As it is where the stroke came from 0 on one way; small motions do not make it slip.
    fn at_rest(&self, at: &Point, _: f64) -> AtRest {
        let slipped = self.slipped(0.0, at.stroke);
        let slope = if slipped == 0.0 { self.stiffness.value } else { 0.0 };
        let tangent = Tangent::Leaf(self.linearised(at), None);
        AtRest { force: self.force(0.0, at.stroke), stiffness: Some(slope), tangent }
    }

    /// As many as [`Leaf::guards_in`] has.
    fn guards(&self, at: &Point, take: &mut dyn FnMut(f64)) {
        let reach = self.yields_at();
        [at.stroke - reach, at.stroke + reach, reach].into_iter().for_each(take);
    }

    /// How far the strokes are at which it yields from where it begins, and, where it slips, the rate, which turns round there; all in metres, as rounding of
    /// strokes is.
    fn guards_in(&self, step: &Step, state: StateRef, guards: &mut Vec<Guard>) {
        let (count, reach, start) = (step.nodes.count(), self.yields_at(), state.variables[0]);
        let mut push = |of: &dyn Fn(usize) -> f64| {
            guards.push(std::array::from_fn(|k| if k <= count { of(k) } else { 0.0 }));
        };
        push(&|k| step.stroke[k] - start - reach);
        push(&|k| step.stroke[k] - start + reach);
        // Where it slips at first it may stick again before the first node, which then knows nothing of it.
        let gone = step.stroke[0] - start;
        let slips_at_first = gone.abs() >= AT_YIELD * reach && gone * step.rate[0] > 0.0;
        match !slips_at_first && self.slipped(start, step.stroke[1]) == start {
            true => push(&|_| reach),
            false => push(&|k| step.h * step.rate[k]),
        }
    }

    fn by_columns(&self) -> Option<&dyn ByColumns> {
        Some(self)
    }

    fn slips(&self) -> Option<Jenkins> {
        Some(*self)
    }

    fn holds(&self) -> Holds {
        // It yields at F_y.
        Holds::AtTimes
    }
}

/// Where it begins and ceases to slip it is as on the side that the step takes.
impl Columns for Jenkins {
    type Solved<T: Real> = Slipped<T>;

    fn each_number(&mut self, take: &mut dyn FnMut(&mut Dual)) {
        [&mut self.stiffness, &mut self.limit].into_iter().for_each(take);
    }

    fn at_start<T: Real>(&self, at: &Point<T>, take: &mut dyn FnMut(T)) {
        take(self.follows(0.0.into(), at.stroke, self.slipped(0.0, at.stroke.value())));
    }

    fn after_turns<T: Real>(&self, turns: &[T], take: &mut dyn FnMut(T)) {
        take(turns.iter().chain(turns).fold(0.0.into(), |slipped: T, stroke| {
            self.follows(slipped, *stroke, self.slipped(slipped.value(), stroke.value()))
        }));
    }

    fn solved(&self, step: &Step, start: &[f64]) -> Slipped {
        self.over(step, start[0])
    }

    fn follow(&self, step: &Step<Dual>, start: &[Dual], found: &Slipped) -> Slipped<Dual> {
        let count = step.nodes.count();
        let (mut at, mut way) = ([start[0]; MAX_NODES + 1], Dual::default());
        for i in 0..count {
            at[i + 1] = self.follows(at[i], step.stroke[i + 1], found.at[i + 1]);
            way += (at[i + 1] - at[i]).abs();
        }
        let end = match step.nodes {
            Nodes::Midpoint => {
                let stroke = Dual::from(2.0) * step.stroke[1] - step.stroke[0];
                self.follows(at[1], stroke, found.end)
            }
            _ => at[count],
        };
        way += (end - at[count]).abs();
        Slipped { at, end, last: found.last, way }
    }

    fn force<T: Real>(&self, step: &Step<T>, slipped: &Slipped<T>, k: usize) -> T {
        self.pull(slipped.at[k], step.stroke[k])
    }

    fn power<T: Real>(&self, step: &Step<T>, _: &[T], slipped: &Slipped<T>, k: usize) -> Power<T> {
        let zero = T::from(0.0);
        if slipped.way.value() == 0.0 {
            return Power { dissipation: zero, input: zero };
        }
        let (count, weights) = (step.nodes.count(), step.quadrature(1.0));
        let direction = T::from((slipped.at[1].value() - slipped.at[0].value()).signum());
        let along = |k: usize| {
            let rate = direction * step.rate[k];
            if rate.value() > 0.0 { rate } else { zero }
        };
        let whole =
            |share: &dyn Fn(usize) -> T| -> T { (0..=count).map(|k| T::from(step.h * weights[k]) * share(k)).sum() };
        let slips_at_once = slipped.at[1].value() != slipped.at[0].value();
        let share: &dyn Fn(usize) -> T =
            if slips_at_once && whole(&along).value() > 0.0 { &along } else { &|_| T::from(1.0) };
        let scale = T::of(self.limit) * slipped.way / whole(share);
        Power { dissipation: scale * share(k), input: zero }
    }

    fn at_end<T: Real>(&self, _: &Step<T>, _: &[T], slipped: &Slipped<T>, take: &mut dyn FnMut(T)) {
        take(slipped.end);
    }

    fn within<T: Real>(
        &self,
        step: &Step<T>,
        theta: f64,
        at: &Point<T>,
        _: &[T],
        slipped: &Slipped<T>,
    ) -> Observation<T> {
        let before = step.positions().iter().take_while(|node| **node < theta).count();
        self.between(at, &[slipped.at[before]])
    }

    fn between<T: Real>(&self, at: &Point<T>, variables: &[T]) -> Observation<T> {
        let force = self.pull(variables[0], at.stroke);
        let stored = Some(T::from(0.5) * force * force / T::of(self.stiffness));
        Observation { derivative: at.stroke, regular: force, singular: 0.0.into(), stored }
    }
}

impl Jenkins {
    /// p behind `before`, of which it is known to be `found`, where the stroke has gone to `stroke`.
    fn follows<T: Real>(&self, before: T, stroke: T, found: f64) -> T {
        let reach = T::of(self.limit) / T::of(self.stiffness);
        match found.total_cmp(&before.value()) {
            Ordering::Equal => before,
            Ordering::Greater => stroke - reach,
            Ordering::Less => stroke + reach,
        }
    }

    /// [`Self::force`].
    fn pull<T: Real>(&self, slipped: T, stroke: T) -> T {
        let ([stiffness, limit], force) =
            ([self.stiffness, self.limit].map(T::of), self.force(slipped.value(), stroke.value()));
        match (force >= self.limit.value, force <= -self.limit.value) {
            (true, _) => limit,
            (_, true) => -limit,
            (false, false) => stiffness * (stroke - slipped),
        }
    }
}

/// Its parameters, in the order of its arguments.
fn params() -> Vec<Param> {
    let positive = Range { low: f64::MIN_POSITIVE, high: f64::MAX };
    vec![
        Param::new("k", "N/m", "stiffness before it slips", positive),
        Param::new("F_y", "N", "force at which it slips", positive),
    ]
}

/// What networks know of it.
pub(super) fn kind() -> LeafKind {
    LeafKind {
        name: "jenkins",
        equation: "dF = k·dx, cut at ±F_y",
        params: params(),
        build: LeafBuild::Values(|values, _| Ok(Arc::new(Jenkins::new(values[0], values[1])?))),
    }
}
