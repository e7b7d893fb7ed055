//! The magnetorheological damper of Spencer, Dyke, Sain and Carlson.

use super::columns::{ByColumns, Columns};
use super::contract::{Clock, Guard, Holds, Leaf};
use super::hysteresis::{Hysteresis, Matrix, Values, resolvent};
use super::springpot::Coefficient;
use crate::collocation::{MAX_NODES, Nodes, quadrature, quadrature_defect};
use crate::dual::{Dual, Real};
use crate::fractional::KernelError;
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{InputValue, LocalError, Observation, Point, Power, Powers, Response, Start, Step, Term};
use crate::law::tangent::{AtRest, Tangent};

/// F = c_1·y' + k_1·(x − x_0), y' = (alpha·z + c_0·x' + k_0·(x − y))/(c_0 + c_1), y(0) = x(0), and z of [`Hysteresis`] moved by x' − y',
/// z(0) = 0 (Spencer, Dyke, Sain & Carlson 1997).
///
/// It is a spring k_1 beside a dashpot c_1 that is in series with a dashpot c_0, a spring k_0 and a Bouc–Wen element alpha side by side; c_0, c_1
/// and alpha may follow its input. Stores ½k_1(x − x_0)² + ½k_0(x − y)² + alpha·z²/(2A), dissipates c_1·y'² + c_0·(x' − y')² and what z
/// loses; a varying alpha is supplied with ∫ alpha'·z²/(2A) dt. y and z are inner variables, collocated at the nodes; its kinks are where
/// x' − y' changes sign.
#[derive(Debug, Clone, PartialEq)]
pub struct Spencer {
    /// Viscosity c_0 ≥ 0 at large velocities, N·s/m.
    pub fast: Coefficient,
    /// Viscosity c_1 ≥ 0, by which the force rolls off at small velocities, N·s/m.
    pub slow: Coefficient,
    /// k_0 ≥ 0, N/m.
    pub inner_stiffness: Dual,
    /// k_1 ≥ 0 of the accumulator, N/m.
    pub stiffness: Dual,
    /// x_0, the stroke at which it gives no force, m.
    pub rest: Dual,
    /// alpha ≥ 0, N/m.
    pub alpha: Coefficient,
    /// z.
    pub hysteresis: Hysteresis,
}

/// Its coefficients at one time.
#[derive(Debug, Clone, Copy)]
struct Now<T> {
    fast: T,
    slow: T,
    alpha: InputValue<T>,
}

/// A step worked out.
#[derive(Debug)]
pub struct Solved<T> {
    now: [Now<T>; MAX_NODES + 1],
    /// z, y, z' and y' at the start and at the nodes.
    z: Values<T>,
    y: Values<T>,
    z_rate: Values<T>,
    y_rate: Values<T>,
    /// y'_i by what drives it: of the drive c_0·x' + k_0·x directly; by z; and through z as well, by x'_j − y'_j at z as it is.
    by_drive: Matrix,
    by_z: Matrix,
    by_slip: Matrix,
}

impl Spencer {
    /// The coefficients that must not be negative.
    fn coefficients(&self) -> [(&Coefficient, &'static str); 3] {
        [(&self.fast, "c_0"), (&self.slow, "c_1"), (&self.alpha, "alpha")]
    }

    fn coefficients_at<T: Real>(&self, inputs: &[InputValue<T>]) -> Now<T> {
        let [fast, slow] = [&self.fast, &self.slow].map(|c| c.at(inputs).value);
        Now { fast, slow, alpha: self.alpha.at(inputs) }
    }

    fn coefficients_along<T: Real>(&self, step: &Step<T>) -> [Now<T>; MAX_NODES + 1] {
        std::array::from_fn(|k| self.coefficients_at(step.inputs_at(k.min(step.nodes.count()))))
    }

    /// What drives y where y and z are known: (c_0 + c_1)·y'.
    fn drive<T: Real>(&self, now: &Now<T>, at: &Point<T>, y: T, z: T) -> T {
        now.alpha.value * z + now.fast * at.rate + T::of(self.inner_stiffness) * (at.stroke - y)
    }

    /// y' where y and z are known.
    fn y_rate<T: Real>(&self, now: &Now<T>, at: &Point<T>, y: T, z: T) -> T {
        self.drive(now, at, y, z) / (now.fast + now.slow)
    }

    /// z' at the start and at the nodes.
    fn z_rates<T: Real>(&self, step: &Step<T>, z: &Values<T>, y_rate: &Values<T>) -> Values<T> {
        std::array::from_fn(|k| match k <= step.nodes.count() {
            true => self.hysteresis.rate(z[k], step.rate[k] - y_rate[k]),
            false => 0.0.into(),
        })
    }

    fn solve(&self, step: &Step, [y, z]: [f64; 2]) -> Solved<f64> {
        let (nodes, count, h) = (step.nodes, step.nodes.count(), step.h);
        let now = self.coefficients_along(step);
        let both: Values = std::array::from_fn(|k| now[k].fast + now[k].slow);
        let inner_stiffness = self.inner_stiffness.value;
        // (c_0 + c_1)_i y'_i + k_0 h Σ_j A_ij y'_j = alpha_i z_i + c_0 x'_i + k_0 (x_i − y_0).
        let by_drive = resolvent(nodes, &both[1..=count], inner_stiffness * h);
        let drive: [f64; MAX_NODES] = std::array::from_fn(|i| match i < count {
            true => now[i + 1].fast * step.rate[i + 1] + inner_stiffness * (step.stroke[i + 1] - y),
            false => 0.0,
        });
        let mut free = Values::default();
        let mut back = Matrix::default();
        for i in 0..count {
            free[i + 1] = step.rate[i + 1] - (0..count).map(|j| by_drive[i][j] * drive[j]).sum::<f64>();
            (0..count).for_each(|j| back[i][j] = by_drive[i][j] * now[j + 1].alpha.value);
        }
        let (z, tangent) = self.hysteresis.solve((nodes.count(), nodes.matrix()), h, &free, Some(&back), z);
        let (mut y, mut y_rate) = ([y; MAX_NODES + 1], Values::default());
        y_rate[0] = self.y_rate(&now[0], &step.point(0), y[0], z[0]);
        for i in 0..count {
            y_rate[i + 1] = (0..count).map(|j| by_drive[i][j] * drive[j] + back[i][j] * z[j + 1]).sum();
        }
        for (i, row) in nodes.matrix().iter().enumerate().take(count) {
            y[i + 1] += h * (0..count).map(|j| row[j] * y_rate[j + 1]).sum::<f64>();
        }
        let z_rate = self.z_rates(step, &z, &y_rate);
        let by_slip =
            std::array::from_fn(|i| std::array::from_fn(|j| (0..count).map(|k| back[i][k] * tangent[k][j]).sum()));
        Solved { now, z, y, z_rate, y_rate, by_drive, by_z: back, by_slip }
    }

    fn start(state: StateRef) -> [f64; 2] {
        [state.variables[0], state.variables[1]]
    }
}

impl Leaf for Spencer {
    fn name(&self) -> &'static str {
        "spencer"
    }

    /// y and z.
    fn size(&self) -> StateSize {
        StateSize { memories: 0, variables: 2 }
    }

    fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        state.push_variable(start.stroke);
        state.push_variable(0.0);
        Ok(())
    }

    fn rates(&self, at: &Point, state: StateRef, rates: &mut Vec<f64>) -> bool {
        let [y, z] = Self::start(state);
        let rate = self.y_rate(&self.coefficients_at(at.inputs), at, y, z);
        rates.extend([rate, self.hysteresis.rate(z, at.rate - rate)]);
        true
    }

    fn evaluate(&self, step: &Step, state: StateRef, response: &mut Response) {
        let solved = self.solve(step, Self::start(state));
        let Solved { now, by_drive, by_slip, .. } = &solved;
        let count = step.nodes.count();
        for i in 0..count {
            let slow = now[i + 1].slow;
            response.force[i] += self.force(step, &solved, i + 1);
            response.d_stroke[i][i] += self.stiffness.value;
            for j in 0..count {
                // y' follows the drive of node j, and z, which slips at x' − y'.
                let through: f64 = (0..count).map(|k| by_slip[i][k] * by_drive[k][j]).sum();
                let by_drive = by_drive[i][j] - through;
                response.d_stroke[i][j] += slow * by_drive * self.inner_stiffness.value;
                response.d_rate[i][j] += slow * (by_drive * now[j + 1].fast + by_slip[i][j]);
            }
        }
    }

    fn by_input(&self, step: &Step, state: StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        let slope = |c: &Coefficient| if c.input == Some(input) { c.slope.value } else { 0.0 };
        let [fast, slow, alpha] = [&self.fast, &self.slow, &self.alpha].map(slope);
        let Solved { now, z, y_rate, by_drive, by_slip, .. } = self.solve(step, Self::start(state));
        let count = step.nodes.count();
        for j in 0..count {
            let drive = alpha * z[j + 1] + fast * step.rate[j + 1] - (fast + slow) * y_rate[j + 1];
            for i in 0..count {
                let through: f64 = (0..count).map(|k| by_slip[i][k] * by_drive[k][j]).sum();
                slopes[i][j] += now[i + 1].slow * (by_drive[i][j] - through) * drive;
            }
            slopes[j][j] += slow * y_rate[j + 1];
        }
    }

    fn commit(&self, step: &Step, state: StateMut) {
        let start = Self::start(state.view());
        let solved = self.solve(step, start);
        let mut variables = state.variables.iter_mut();
        self.at_end(step, &start, &solved, &mut |end| variables.next().into_iter().for_each(|own| *own = end));
    }

    fn local_errors(&self, step: &Step, state: StateRef, errors: &mut Vec<LocalError>) {
        let Solved { y, z, y_rate, z_rate, .. } = self.solve(step, Self::start(state));
        let last = step.nodes.count();
        for (values, rates, slope) in [(y, y_rate, 1.0), (z, z_rate, self.hysteresis.slope_at_rest::<f64>())] {
            let defect = step.h * quadrature_defect(step.nodes, &rates);
            // What rounding leaves of a stroke is no error of them.
            let error = if defect <= slope * step.resolution { 0.0 } else { defect };
            errors.push(LocalError::collocated(error, values[last]));
        }
    }

    fn powers(&self, step: &Step, state: StateRef, powers: &mut Powers) {
        let solved = self.solve(step, Self::start(state));
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            let own = self.power(step, state.variables, &solved, k);
            power.dissipation += own.dissipation;
            power.input += own.input;
        }
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: StateRef) -> Observation {
        self.within(step, theta, at, state.variables, &self.solve(step, Self::start(state)))
    }

    fn now(&self, at: &Point, state: StateRef) -> Observation {
        self.between(at, state.variables)
    }

    fn by_columns(&self) -> Option<&dyn ByColumns> {
        Some(self)
    }

    /// The two dashpots in series; without one of them what is left beside the other.
    fn linearised(&self, at: &Point) -> Term {
        let Now::<f64> { fast, slow, alpha } = self.coefficients_at(at.inputs);
        if fast > 0.0 && slow > 0.0 {
            return Term { coefficient: fast * slow / (fast + slow), order: 1.0 };
        }
        let inner = self.inner_stiffness.value + alpha.value * self.hysteresis.slope_at_rest::<f64>();
        Term { coefficient: self.stiffness.value + if slow > 0.0 { inner } else { 0.0 }, order: 0.0 }
    }

    /// y has caught up with x and z is 0: the accumulator alone remains. Small motions are about z = 0, where the hysteresis is the spring alpha·A.
    fn at_rest(&self, at: &Point, _: f64) -> AtRest {
        let Now { fast, slow, alpha } = self.coefficients_at(at.inputs);
        let stiffness = self.stiffness.value;
        let elastic = self.inner_stiffness.value + alpha.value * self.hysteresis.slope_at_rest::<f64>();
        let inner = Tangent::Parallel(vec![Tangent::spring(elastic), Tangent::dashpot(fast)]);
        let behind = Tangent::Series(vec![Tangent::dashpot(slow), inner]);
        let tangent = Tangent::Whole(Box::new(Tangent::Parallel(vec![Tangent::spring(stiffness), behind])));
        AtRest { force: stiffness * (at.stroke - self.rest.value), stiffness: Some(stiffness), tangent }
    }

    fn clock(&self) -> Clock {
        Clock::Own
    }

    fn holds(&self) -> Holds {
        // Without c_0 and k_1 it yields at its largest z.
        if self.fast.is_none() && self.stiffness.value == 0.0 { Holds::AtTimes } else { Holds::Always }
    }

    /// As many as [`Leaf::guards_in`] has, which are in metres: where y rests, the rate itself.
    fn guards(&self, at: &Point, take: &mut dyn FnMut(f64)) {
        take(at.rate);
    }

    fn guards_in(&self, step: &Step, state: StateRef, guards: &mut Vec<Guard>) {
        let Solved { y_rate, .. } = self.solve(step, Self::start(state));
        let last = step.nodes.count();
        guards.push(std::array::from_fn(|k| if k <= last { step.h * (step.rate[k] - y_rate[k]) } else { 0.0 }));
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        self.coefficients().into_iter().try_for_each(|(coefficient, name)| coefficient.check(inputs, name))?;
        let Now { fast, slow, .. } = self.coefficients_at(inputs);
        if fast + slow > 0.0 {
            return Ok(());
        }
        Err(RuleError { rule: "c_0 + c_1 > 0 is broken: both are 0".into(), parameter: self.slow.parameter.clone() })
    }
}

impl Columns for Spencer {
    type Solved<T: Real> = Solved<T>;

    fn each_number(&mut self, take: &mut dyn FnMut(&mut Dual)) {
        let Self { fast, slow, inner_stiffness, stiffness, rest, alpha, hysteresis } = self;
        let coefficients = [fast, slow, alpha].into_iter().flat_map(Coefficient::numbers);
        coefficients.chain([inner_stiffness, stiffness, rest]).chain(hysteresis.numbers()).for_each(take);
    }

    fn at_start<T: Real>(&self, at: &Point<T>, take: &mut dyn FnMut(T)) {
        take(at.stroke);
        take(0.0.into());
    }

    fn solved(&self, step: &Step, start: &[f64]) -> Solved<f64> {
        self.solve(step, [start[0], start[1]])
    }

    fn follow(&self, step: &Step<Dual>, start: &[Dual], found: &Solved<f64>) -> Solved<Dual> {
        let (nodes, count, h) = (step.nodes, step.nodes.count(), step.h);
        let now = self.coefficients_along(step);
        let mut y_rate: Values<Dual> = found.y_rate.map(Dual::from);
        let strokes = |y_rate: &Values<Dual>| -> Values<Dual> {
            std::array::from_fn(|k| match k {
                0 => start[0],
                _ => {
                    let row = nodes.matrix()[k - 1].iter().take(count).zip(&y_rate[1..]);
                    start[0] + Dual::from(h) * row.map(|(weight, rate)| Dual::from(*weight) * *rate).sum()
                }
            })
        };
        // What drives y' where y' and z stay, and what comes of it where z stays.
        let y = strokes(&y_rate);
        let driven: Values = std::array::from_fn(|k| {
            if k > count {
                return 0.0;
            }
            let both = (now[k].fast + now[k].slow) * y_rate[k];
            (self.drive(&now[k], &step.point(k), y[k], found.z[k].into()) - both).slope
        });
        for i in 0..count {
            y_rate[i + 1].slope = (0..count).map(|j| found.by_drive[i][j] * driven[j + 1]).sum();
        }
        let slips: Values<Dual> =
            std::array::from_fn(|k| if k > count { Dual::default() } else { step.rate[k] - y_rate[k] });
        let nodes_of_z = (count, nodes.matrix());
        let z = self.hysteresis.follow(nodes_of_z, h, &slips, Some(&found.by_z), start[1], &found.z);
        for i in 0..count {
            y_rate[i + 1].slope += (0..count).map(|j| found.by_z[i][j] * z[j + 1].slope).sum::<f64>();
        }
        let y = strokes(&y_rate);
        y_rate[0] = self.y_rate(&now[0], &step.point(0), y[0], z[0]);
        let z_rate = self.z_rates(step, &z, &y_rate);
        let Solved { by_drive, by_z, by_slip, .. } = *found;
        Solved { now, z, y, z_rate, y_rate, by_drive, by_z, by_slip }
    }

    fn force<T: Real>(&self, step: &Step<T>, solved: &Solved<T>, k: usize) -> T {
        solved.now[k].slow * solved.y_rate[k] + T::of(self.stiffness) * (step.stroke[k] - T::of(self.rest))
    }

    fn power<T: Real>(&self, step: &Step<T>, _: &[T], solved: &Solved<T>, k: usize) -> Power<T> {
        let Solved { now, z, y_rate, .. } = solved;
        let (Now { fast, slow, alpha }, slip) = (now[k], step.rate[k] - y_rate[k]);
        let a = self.hysteresis.slope_at_rest();
        let lost = alpha.value / a * self.hysteresis.lost(z[k], slip);
        Power {
            dissipation: slow * y_rate[k] * y_rate[k] + fast * slip * slip + lost,
            input: T::from(0.5) * alpha.rate * z[k] * z[k] / a,
        }
    }

    fn at_end<T: Real>(&self, step: &Step<T>, start: &[T], solved: &Solved<T>, take: &mut dyn FnMut(T)) {
        let last = step.nodes.count();
        for (start, values) in start.iter().zip([&solved.y, &solved.z]) {
            take(if step.nodes == Nodes::Midpoint { T::from(2.0) * values[last] - *start } else { values[last] });
        }
    }

    fn each_rate<T: Real>(&self, step: &Step<T>, _: &[T], solved: &Solved<T>, take: &mut dyn FnMut(T, Values<T>)) {
        let last = step.nodes.count();
        take(solved.y[last], solved.y_rate);
        take(solved.z[last], solved.z_rate);
    }

    fn within<T: Real>(
        &self,
        step: &Step<T>,
        theta: f64,
        at: &Point<T>,
        start: &[T],
        solved: &Solved<T>,
    ) -> Observation<T> {
        let weights = quadrature(step.nodes, theta);
        let until = |start: T, rates: &Values<T>| {
            start + T::from(step.h) * weights.iter().zip(rates).map(|(weight, rate)| T::from(*weight) * *rate).sum()
        };
        self.between(at, &[until(start[0], &solved.y_rate), until(start[1], &solved.z_rate)])
    }

    fn between<T: Real>(&self, at: &Point<T>, variables: &[T]) -> Observation<T> {
        let (now, y, z) = (self.coefficients_at(at.inputs), variables[0], variables[1]);
        let [outer_stiffness, inner_stiffness, rest] = [self.stiffness, self.inner_stiffness, self.rest].map(T::of);
        let (outer, inner) = (at.stroke - rest, at.stroke - y);
        let springs = outer_stiffness * outer * outer + inner_stiffness * inner * inner;
        let stored = T::from(0.5) * (springs + now.alpha.value * z * z / self.hysteresis.slope_at_rest());
        let regular = now.slow * self.y_rate(&now, at, y, z) + outer_stiffness * outer;
        Observation { derivative: at.stroke, regular, singular: 0.0.into(), stored: Some(stored) }
    }
}
