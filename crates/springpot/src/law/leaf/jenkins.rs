//! A spring that slips: Jenkins' element.

use super::contract::Leaf;
use super::kind::{LeafBuild, LeafKind};
use crate::collocation::{MAX_NODES, Nodes};
use crate::fractional::KernelError;
use crate::law::catalog::{Param, Range};
use crate::law::network::{Guard, Holds, Network};
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{Observation, Point, Powers, Response, Start, Step, Term};
use crate::law::tangent::LeafAtRest;
use num_complex::Complex64;
use std::f64::consts::PI;

/// A spring k in series with Coulomb friction F_y: F = k·(x − p), |F| ≤ F_y, where p, what has slipped, moves only as far as it must (Jenkins 1962; Iwan 1966).
///
/// Between two turning points dF = k·dx, cut at ±F_y. p(0) = 0, so that F(0) = k·x(0), cut at ±F_y. Stores F²/(2k), dissipates F_y·|p'|; the rate does not
/// matter. p is one inner variable, which follows from the strokes at the nodes alone; where it begins and ceases to slip F has a kink.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jenkins {
    stiffness: f64,
    limit: f64,
}

/// What has slipped over a step.
struct Slipped {
    /// At the start and at the nodes.
    at: [f64; MAX_NODES + 1],
    /// At the end.
    end: f64,
    /// By node: the last one until there at which it slips.
    last: [Option<usize>; MAX_NODES],
    /// ∫|p'| dt.
    way: f64,
}

impl Jenkins {
    /// k in N/m, F_y in N.
    ///
    /// # Errors
    /// [`RuleError`]: k > 0, F_y > 0.
    pub fn new(stiffness: f64, limit: f64) -> Result<Self, RuleError> {
        RuleError::unless(stiffness > 0.0, "k > 0", "k")?;
        RuleError::unless(limit > 0.0, "F_y > 0", "F_y")?;
        Ok(Self { stiffness, limit })
    }

    /// Both one behind the other, which is one again: 1/k = 1/k_1 + 1/k_2, and the weaker slips alone.
    pub fn behind(self, other: Self) -> Self {
        let stiffness = (self.stiffness.recip() + other.stiffness.recip()).recip();
        Self { stiffness, limit: self.limit.min(other.limit) }
    }

    /// The same with a spring `stiffness` > 0, N/m, behind it.
    pub fn behind_spring(self, stiffness: f64) -> Self {
        self.behind(Self { stiffness, limit: f64::INFINITY })
    }

    /// k, N/m.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// F_y, N.
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// The stroke F_y/k at which it yields, m.
    pub fn yields_at(&self) -> f64 {
        self.limit / self.stiffness
    }

    /// F where `slipped` has slipped before the stroke went to `stroke` on one way, N.
    pub fn force(&self, slipped: f64, stroke: f64) -> f64 {
        (self.stiffness * (stroke - slipped)).clamp(-self.limit, self.limit)
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

    fn observation(&self, at: &Point, slipped: f64) -> Observation {
        let force = self.force(slipped, at.stroke);
        let stored = Some(0.5 * force * force / self.stiffness);
        Observation { derivative: at.stroke, regular: force, singular: 0.0, stored }
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
                    response.d_stroke[i][i] += self.stiffness;
                    // What slipped before follows the stroke there.
                    last.into_iter().for_each(|last| response.d_stroke[i][last] -= self.stiffness);
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
        variables[0] = turns.iter().chain(turns).fold(0.0, |slipped, stroke| self.slipped(slipped, *stroke));
    }

    /// F_y·|p'|: in proportion to the rate where it slips all along, and with the integral F_y·∫|p'| dt to the last bit.
    fn powers(&self, step: &Step, state: StateRef, powers: &mut Powers) {
        let slipped = self.over(step, state.variables[0]);
        if slipped.way == 0.0 {
            return;
        }
        let (count, weights) = (step.nodes.count(), step.quadrature(1.0));
        let direction = (slipped.at[1] - slipped.at[0]).signum();
        let along = |k: usize| (direction * step.rate[k]).max(0.0);
        let whole = |share: &dyn Fn(usize) -> f64| (0..=count).map(|k| step.h * weights[k] * share(k)).sum::<f64>();
        let slips_at_once = slipped.at[1] != slipped.at[0];
        let share: &dyn Fn(usize) -> f64 = if slips_at_once && whole(&along) > 0.0 { &along } else { &|_| 1.0 };
        let scale = self.limit * slipped.way / whole(share);
        for (k, power) in powers.iter_mut().enumerate().take(count + 1) {
            power.dissipation += scale * share(k);
        }
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: StateRef) -> Observation {
        let slipped = self.over(step, state.variables[0]);
        let before = step.positions().iter().take_while(|node| **node < theta).count();
        self.observation(at, slipped.at[before])
    }

    fn now(&self, at: &Point, state: StateRef) -> Observation {
        self.observation(at, state.variables[0])
    }

    /// Small and fast strokes do not make it slip.
    fn linearised(&self, _: &Point) -> Term {
        Term { coefficient: self.stiffness, order: 0.0 }
    }

    /// With x = A cos θ it comes back from F_y over 0 ≤ θ ≤ ϑ, cos ϑ = 1 − 2F_y/(k·A), and slips until θ = π (Caughey 1960).
    fn harmonic(&self, _: &Point, amplitude: f64, _: f64) -> Option<Complex64> {
        let share = self.yields_at() / amplitude;
        if share >= 1.0 {
            return Some(self.stiffness.into());
        }
        let angle = 2.0 * share.sqrt().asin();
        let storage = self.stiffness / PI * (angle - 0.5 * (2.0 * angle).sin());
        Some(Complex64::new(storage, 4.0 * self.limit / (PI * amplitude) * (1.0 - share)))
    }

    /// As it is where the stroke came from 0 on one way; small motions do not make it slip.
    fn at_rest(&self, at: &Point, _: f64) -> LeafAtRest {
        let slipped = self.slipped(0.0, at.stroke);
        let slope = if slipped == 0.0 { self.stiffness } else { 0.0 };
        LeafAtRest {
            force: self.force(0.0, at.stroke),
            stiffness: Some(slope),
            term: self.linearised(at),
            input: None,
            damping: 0.0,
        }
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
        match self.slipped(start, step.stroke[1]) == start {
            true => push(&|_| reach),
            false => push(&|k| step.h * step.rate[k]),
        }
    }

    fn slips(&self) -> Option<Jenkins> {
        Some(*self)
    }

    fn holds(&self) -> Holds {
        // It yields at F_y.
        Holds::AtTimes
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
        build: LeafBuild::Values(|values, _| Ok(Network::leaf(Jenkins::new(values[0].value, values[1].value)?))),
    }
}
