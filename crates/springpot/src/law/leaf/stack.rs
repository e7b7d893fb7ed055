//! A piezo stack and the circuit that drives it.

use super::columns::{ByColumns, Columns};
use super::contract::{Clock, Guard, Holds, Leaf, When};
use super::hysteresis::{Hysteresis, Matrix, Values, eliminate, resolvent};
use crate::collocation::{MAX_NODES, Nodes, quadrature, quadrature_defect};
use crate::dual::{Dual, Real};
use crate::fractional::KernelError;
use crate::law::prandtl_ishlinskii::Stop;
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{InputValue, LocalError, Observation, Point, Power, Powers, Response, Start, Step, Term};
use crate::law::tangent::{AtRest, Tangent};
use crate::law::told::Told;

/// Iterations for the charge at the nodes where stops bend its way.
const MOST_ITERATIONS: usize = 60;

/// Change of the charge, in units of the largest, at which they end.
const ENOUGH: f64 = 1e-13;

/// What rounding leaves of a voltage, in units of the largest.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// F = −T·V, C·V' + T·x' = q', R·q' + V + v_h = U: a positive voltage lengthens the stack and lowers the tension; v_h is the hysteresis, which the
/// charge moves (Goldfarb & Celanovic 1997).
///
/// The charge is q = C·V + T·x, V(0) = U(0), and v_h(0) = 0: hysteresis counts from there. e = q/(C + T²/k) is what V is where nothing but the stiffness k beside it holds the
/// stack, at rest: the hysteresis is that of e. Stores ½C·V² and what the hysteresis holds, dissipates R·q'² and what it loses; the input supplies U·q'. q is
/// one inner variable, collocated at the nodes of the step.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    /// T > 0, N/V.
    pub coupling: Dual,
    /// C > 0 at a fixed stroke, F.
    pub capacitance: Dual,
    /// R > 0, ohm.
    pub resistance: Dual,
    /// k > 0 of what is beside it, N/m.
    pub stiffness: Dual,
    /// v_h.
    pub drop: VoltageDrop,
    /// Lowest and highest U, V.
    pub range: [f64; 2],
}

/// The hysteresis of a stack as a voltage.
#[derive(Debug, Clone, PartialEq)]
pub enum VoltageDrop {
    /// None.
    None,
    /// alpha_h·z, z moved by e.
    BoucWen {
        /// alpha_h ≥ 0.
        alpha_h: Dual,
        /// z, V.
        hysteresis: Hysteresis,
    },
    /// Σ b_i·s_i, s_i stops of e. With `feed_forward` the input is the V that is wanted, and the circuit is driven with the exact inverse of the
    /// hysteresis, U = u + Σ b_i·(stop of u).
    Stops {
        /// b_i and ρ_i, V.
        stops: Vec<Stop>,
        /// Whether the input is V.
        feed_forward: bool,
    },
}

/// A step worked out.
#[derive(Debug)]
pub struct Solved<T> {
    /// Charge, current, U and v_h at the start and at the nodes.
    charge: Values<T>,
    current: Values<T>,
    drive: Values<T>,
    drop: Values<T>,
    /// z of [`VoltageDrop::BoucWen`].
    z: Values<T>,
    /// By how much the current at the nodes follows the voltages that drive it there; where z stays; and how z holds its own rate back.
    by_drive: Matrix,
    by_drive_alone: Matrix,
    back: Matrix,
    /// ∂U/∂u at the nodes.
    by_input: [f64; MAX_NODES],
}

/// What the state holds.
struct Kept<'a, T> {
    charge: T,
    /// z, or the stops of e.
    hysteresis: &'a [T],
    /// The last input and the stops of it.
    wanted: T,
    inverse: &'a [T],
}

impl Stack {
    /// C + T²/k: the capacitance where the stack may move.
    fn free_capacitance<T: Real>(&self) -> T {
        let coupling = T::of(self.coupling);
        T::of(self.capacitance) + coupling * coupling / T::of(self.stiffness)
    }

    fn stops(&self) -> (&[Stop], bool) {
        match &self.drop {
            VoltageDrop::Stops { stops, feed_forward } => (stops, *feed_forward),
            _ => (&[], false),
        }
    }

    fn kept<'a, T: Real>(&self, variables: &'a [T]) -> Kept<'a, T> {
        let (charge, rest) = variables.split_first().expect("a state of this law");
        let (stops, feed_forward) = self.stops();
        match (&self.drop, feed_forward) {
            (VoltageDrop::Stops { .. }, true) => {
                let (hysteresis, rest) = rest.split_at(stops.len());
                Kept { charge: *charge, hysteresis, wanted: rest[0], inverse: &rest[1..] }
            }
            _ => Kept { charge: *charge, hysteresis: rest, wanted: 0.0.into(), inverse: &[] },
        }
    }

    /// V of a charge.
    fn voltage<T: Real>(&self, charge: T, stroke: T) -> T {
        (charge - T::of(self.coupling) * stroke) / T::of(self.capacitance)
    }

    /// Σ b_i·s_i, and how it follows its stroke, after that has moved one way.
    fn held<T: Real>(stops: &[Stop], held: &[T], moved: T) -> [T; 2] {
        stops.iter().zip(held).fold([0.0.into(); 2], |[sum, slope], (stop, held)| {
            let weight = T::of(stop.weight);
            let own = if stop.slips(*held, moved) { 0.0.into() } else { weight };
            [sum + weight * stop.after(*held, moved), slope + own]
        })
    }

    /// U and ∂U/∂u.
    fn driven<T: Real>(&self, kept: &Kept<T>, input: T) -> [T; 2] {
        match self.stops() {
            (stops, true) => {
                let [sum, slope] = Self::held(stops, kept.inverse, input - kept.wanted);
                [input + sum, T::from(1.0) + slope]
            }
            _ => [input, 1.0.into()],
        }
    }

    fn solve(&self, step: &Step, kept: &Kept<f64>) -> Solved<f64> {
        let (nodes, count, h) = (step.nodes, step.nodes.count(), step.h);
        let mut drive = Values::default();
        let mut by_input = [1.0; MAX_NODES];
        for (k, drive) in drive.iter_mut().enumerate().take(count + 1) {
            let [value, slope] = self.driven(kept, step.point(k).inputs[0].value);
            *drive = value;
            if k > 0 {
                by_input[k - 1] = slope;
            }
        }
        // What is left for R and v_h at the charge of the start.
        let left: Values = std::array::from_fn(|k| match k <= count {
            true => drive[k] - self.voltage(kept.charge, step.stroke[k]),
            false => 0.0,
        });
        let mut solved = Solved {
            charge: [kept.charge; MAX_NODES + 1],
            current: Values::default(),
            drive,
            drop: Values::default(),
            z: Values::default(),
            by_drive: Matrix::default(),
            by_drive_alone: Matrix::default(),
            back: Matrix::default(),
            by_input,
        };
        match &self.drop {
            VoltageDrop::Stops { stops, .. } => self.along_stops(step, kept, stops, &left, &mut solved),
            VoltageDrop::None => self.along(step, &left, None, &mut solved),
            VoltageDrop::BoucWen { alpha_h, hysteresis } => {
                self.along(step, &left, Some((alpha_h.value, hysteresis, kept.hysteresis[0])), &mut solved);
            }
        }
        solved.current[0] = (left[0] - solved.drop[0]) / self.resistance.value;
        for (i, row) in nodes.matrix().iter().enumerate().take(count) {
            solved.charge[i + 1] += h * (0..count).map(|j| row[j] * solved.current[j + 1]).sum::<f64>();
        }
        solved
    }

    /// R q'_i + (h/C) Σ_j A_ij q'_j = left_i − alpha_h·z_i.
    fn along(&self, step: &Step, left: &Values, of_z: Option<(f64, &Hysteresis, f64)>, solved: &mut Solved<f64>) {
        let (nodes, count, h) = (step.nodes, step.nodes.count(), step.h);
        let own = resolvent(nodes, &[self.resistance.value; MAX_NODES][..count], h / self.capacitance.value);
        let current = |drop: &Values| -> Values {
            std::array::from_fn(|k| match (1..=count).contains(&k) {
                true => (0..count).map(|j| own[k - 1][j] * (left[j + 1] - drop[j + 1])).sum(),
                false => 0.0,
            })
        };
        let Some((alpha_h, hysteresis, start)) = of_z else {
            (solved.current, solved.by_drive) = (current(&Values::default()), own);
            return;
        };
        let moves = self.free_capacitance::<f64>().recip();
        let free = current(&Values::default()).map(|current| moves * current);
        let back = own.map(|row| row.map(|entry| moves * alpha_h * entry));
        let (z, tangent) = hysteresis.solve((nodes.count(), nodes.matrix()), h, &free, Some(&back), start);
        (solved.by_drive_alone, solved.back) = (own, back);
        solved.z = z;
        solved.drop = z.map(|z| alpha_h * z);
        solved.current = current(&solved.drop);
        for i in 0..count {
            for j in 0..count {
                let slips: f64 =
                    (0..count).map(|k| (0..count).map(|m| back[i][k] * tangent[k][m] * own[m][j]).sum::<f64>()).sum();
                solved.by_drive[i][j] = own[i][j] - slips;
            }
        }
    }

    /// R q'_i + (h/C) Σ_j A_ij q'_j + v_h(e_i) = left_i, by Newton's method: v_h bends where stops begin to slip.
    fn along_stops(&self, step: &Step, kept: &Kept<f64>, stops: &[Stop], left: &Values, solved: &mut Solved<f64>) {
        let (nodes, count, h) = (step.nodes, step.nodes.count(), step.h);
        let (matrix, moves) = (nodes.matrix(), self.free_capacitance::<f64>().recip());
        solved.drop[0] = Self::held(stops, kept.hysteresis, 0.0)[0];
        let mut found = false;
        for _ in 0..MOST_ITERATIONS {
            let mut system = [[0.0; 2 * MAX_NODES + 1]; MAX_NODES];
            for i in 0..count {
                let gone: f64 = (0..count).map(|j| h * matrix[i][j] * solved.current[j + 1]).sum();
                let [drop, slope] = Self::held(stops, kept.hysteresis, moves * gone);
                solved.drop[i + 1] = drop;
                let stiffness = self.capacitance.value.recip() + moves * slope;
                (0..count).for_each(|j| system[i][j] = h * matrix[i][j] * stiffness);
                system[i][i] += self.resistance.value;
                system[i][MAX_NODES + i] = 1.0;
                let meets = self.resistance.value * solved.current[i + 1] + gone / self.capacitance.value + drop;
                system[i][2 * MAX_NODES] = left[i + 1] - meets;
            }
            eliminate(&mut system, count);
            let (mut change, mut size) = (0.0f64, f64::MIN_POSITIVE);
            for i in 0..count {
                let moved = system[i][2 * MAX_NODES];
                solved.current[i + 1] += moved;
                // Not `max`, which would pass over what is no number.
                change = if moved.abs() > change || moved.is_nan() { moved.abs() } else { change };
                size = size.max(solved.current[i + 1].abs());
                solved.by_drive[i] = std::array::from_fn(|j| system[i][MAX_NODES + j]);
            }
            let floor =
                ROUNDING * left.iter().fold(0.0, |most: f64, left| most.max(left.abs())) / self.resistance.value;
            if change <= (ENOUGH * size).max(floor) {
                found = true;
                break;
            }
        }
        if !found {
            solved.current[1..].fill(f64::NAN);
        }
    }

    /// How far e has gone since the start of the step.
    fn gone<T: Real>(&self, kept: &Kept<T>, charge: T) -> T {
        (charge - kept.charge) / self.free_capacitance()
    }

    /// ½C·V² and what z, or stops, hold.
    fn stored<T: Real>(&self, voltage: T, hysteresis: T) -> T {
        let own = T::of(self.capacitance) * voltage * voltage;
        T::from(0.5) * (own + self.free_capacitance::<T>() * hysteresis)
    }

    /// alpha_h·z²/A, or Σ b_i·s_i².
    fn squares<T: Real>(&self, z: T, held: impl Iterator<Item = T>) -> T {
        match &self.drop {
            VoltageDrop::None => 0.0.into(),
            VoltageDrop::BoucWen { alpha_h, hysteresis } => T::of(*alpha_h) * z * z / hysteresis.slope_at_rest(),
            VoltageDrop::Stops { stops, .. } => {
                stops.iter().zip(held).map(|(stop, held)| T::of(stop.weight) * held * held).sum()
            }
        }
    }

    /// Charge, and the hysteresis after it has gone there, at θ of a step.
    fn until<T: Real>(&self, step: &Step<T>, theta: f64, kept: &Kept<T>, solved: &Solved<T>) -> [T; 2] {
        let weights = quadrature(step.nodes, theta);
        let sum = |rates: Values<T>| {
            T::from(step.h) * weights.iter().zip(rates).map(|(weight, rate)| T::from(*weight) * rate).sum()
        };
        let charge = kept.charge + sum(solved.current);
        let z = match &self.drop {
            VoltageDrop::BoucWen { hysteresis, .. } => {
                let moves = T::from(1.0) / self.free_capacitance();
                let last = step.nodes.count();
                let rate = |k: usize| hysteresis.rate(solved.z[k], moves * solved.current[k]);
                solved.z[0] + sum(std::array::from_fn(|k| if k > last { 0.0.into() } else { rate(k) }))
            }
            _ => 0.0.into(),
        };
        [charge, z]
    }

    /// v_h where the charge has gone to `charge`, and z is `z`.
    fn drop_at<T: Real>(&self, kept: &Kept<T>, charge: T, z: T) -> T {
        match &self.drop {
            VoltageDrop::None => 0.0.into(),
            VoltageDrop::BoucWen { alpha_h, .. } => T::of(*alpha_h) * z,
            VoltageDrop::Stops { stops, .. } => Self::held(stops, kept.hysteresis, self.gone(kept, charge))[0],
        }
    }

    fn observation<T: Real>(&self, kept: &Kept<T>, at: &Point<T>, [charge, z]: [T; 2]) -> Observation<T> {
        let voltage = self.voltage(charge, at.stroke);
        let gone = self.gone(kept, charge);
        let held = self.stops().0.iter().zip(kept.hysteresis).map(|(stop, held)| stop.after(*held, gone));
        let stored = Some(self.stored(voltage, self.squares(z, held)));
        let regular = -T::of(self.coupling) * voltage;
        Observation { derivative: at.stroke, regular, singular: 0.0.into(), stored }
    }

    /// Charge and z between two steps.
    fn kept_now<T: Real>(&self, kept: &Kept<T>) -> [T; 2] {
        let has_z = matches!(self.drop, VoltageDrop::BoucWen { .. });
        [kept.charge, if has_z { kept.hysteresis[0] } else { 0.0.into() }]
    }
}

impl Stack {
    /// z' at the start and at the nodes.
    fn z_rates<T: Real>(&self, of: &Hysteresis, step: &Step<T>, current: &Values<T>, z: &Values<T>) -> Values<T> {
        let moves = T::from(1.0) / self.free_capacitance();
        std::array::from_fn(|k| match k <= step.nodes.count() {
            true => of.rate(z[k], moves * current[k]),
            false => 0.0.into(),
        })
    }
}

impl Leaf for Stack {
    fn name(&self) -> &'static str {
        "stack"
    }

    /// The charge; z, or the stops; the last input and the stops of it.
    fn size(&self) -> StateSize {
        let (stops, feed_forward) = self.stops();
        let variables = match self.drop {
            VoltageDrop::None => 1,
            VoltageDrop::BoucWen { .. } => 2,
            VoltageDrop::Stops { .. } => 1 + stops.len() + if feed_forward { 1 + stops.len() } else { 0 },
        };
        StateSize { memories: 0, variables }
    }

    fn begin(&self, start: &Start, state: &mut State) -> Result<(), KernelError> {
        let at = Point { t: 0.0, stroke: start.stroke, rate: 0.0, inputs: start.inputs };
        self.at_start(&at, &mut |variable| state.push_variable(variable));
        Ok(())
    }

    fn evaluate(&self, step: &Step, state: StateRef, response: &mut Response) {
        let solved = self.solve(step, &self.kept(state.variables));
        let by_drive = &solved.by_drive;
        let (count, matrix) = (step.nodes.count(), step.nodes.matrix());
        let by_voltage = self.coupling.value / self.capacitance.value;
        for i in 0..count {
            response.force[i] += self.force(step, &solved, i + 1);
            response.d_stroke[i][i] += self.coupling.value * by_voltage;
            for j in 0..count {
                let follows: f64 = (0..count).map(|m| step.h * matrix[i][m] * by_drive[m][j]).sum();
                response.d_stroke[i][j] -= by_voltage * by_voltage * follows;
            }
        }
    }

    fn by_input(&self, step: &Step, state: StateRef, input: usize, slopes: &mut [[f64; MAX_NODES]; MAX_NODES]) {
        if input != 0 {
            return;
        }
        let Solved { by_drive, by_input, .. } = self.solve(step, &self.kept(state.variables));
        let (count, matrix) = (step.nodes.count(), step.nodes.matrix());
        for i in 0..count {
            for j in 0..count {
                let follows: f64 = (0..count).map(|m| step.h * matrix[i][m] * by_drive[m][j]).sum();
                slopes[i][j] -= self.coupling.value / self.capacitance.value * follows * by_input[j];
            }
        }
    }

    fn commit(&self, step: &Step, state: StateMut) {
        let start = state.variables.to_vec();
        let solved = self.solve(step, &self.kept(&start));
        let mut variables = state.variables.iter_mut();
        self.at_end(step, &start, &solved, &mut |end| variables.next().into_iter().for_each(|own| *own = end));
    }

    fn local_errors(&self, step: &Step, state: StateRef, errors: &mut Vec<LocalError>) {
        let kept = self.kept(state.variables);
        let Solved { charge, current, drive, z, .. } = self.solve(step, &kept);
        let last = step.nodes.count();
        // A drive that begins at 0 V may be the difference of voltages as large as the stack takes: their rounding is in it.
        let most = self.range[0].abs().max(self.range[1].abs());
        let volts =
            drive.iter().zip(&charge).map(|(u, q)| u.abs().max(q.abs() / self.capacitance.value)).fold(most, f64::max);
        let mut push = |rates: &Values, value: f64, rounding: f64| {
            let defect = step.h * quadrature_defect(step.nodes, rates);
            let error = if defect <= rounding { 0.0 } else { defect };
            errors.push(LocalError::collocated(error, value));
        };
        push(&current, charge[last], ROUNDING * volts * self.capacitance.value);
        if let VoltageDrop::BoucWen { hysteresis, .. } = &self.drop {
            push(
                &self.z_rates(hysteresis, step, &current, &z),
                z[last],
                ROUNDING * volts * hysteresis.slope_at_rest::<f64>(),
            );
        }
    }

    fn powers(&self, step: &Step, state: StateRef, powers: &mut Powers) {
        let solved = self.solve(step, &self.kept(state.variables));
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            let own = self.power(step, state.variables, &solved, k);
            power.dissipation += own.dissipation;
            power.input += own.input;
        }
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: StateRef) -> Observation {
        let solved = self.solve(step, &self.kept(state.variables));
        self.within(step, theta, at, state.variables, &solved)
    }

    fn now(&self, at: &Point, state: StateRef) -> Observation {
        self.between(at, state.variables)
    }

    fn by_columns(&self) -> Option<&dyn ByColumns> {
        Some(self)
    }

    fn tells(&self) -> &'static [Told] {
        &[Told::VOLTAGE, Told::CHARGE, Told::CURRENT]
    }

    fn tell(&self, when: When, at: &Point, state: StateRef, take: &mut dyn FnMut(f64)) {
        match when {
            When::Within(step, theta) => {
                let solved = self.solve(step, &self.kept(state.variables));
                self.told(Some((step, theta, &solved)), at, state.variables, take);
            }
            When::Between => self.told(None, at, state.variables, take),
        }
    }

    /// Faster than the circuit: its charge stays.
    fn linearised(&self, _: &Point) -> Term {
        let coupling = self.coupling.value;
        Term { coefficient: coupling * coupling / self.capacitance.value, order: 0.0 }
    }

    /// V has come to U. Small motions meet the spring T²/C in series with the dashpot T²R, the hysteresis about 0 beside that, and the force −T·U.
    fn at_rest(&self, at: &Point, _: f64) -> AtRest {
        let coupling = self.coupling.value;
        let square = coupling * coupling;
        let (elastic, drive) = match &self.drop {
            VoltageDrop::None => (0.0, 1.0),
            VoltageDrop::BoucWen { alpha_h, hysteresis } => (alpha_h.value * hysteresis.slope_at_rest::<f64>(), 1.0),
            VoltageDrop::Stops { stops, feed_forward } => {
                let all: f64 = stops.iter().map(|stop| stop.weight.value).sum();
                (all, if *feed_forward { 1.0 + all } else { 1.0 })
            }
        };
        let source = Tangent::Leaf(Term { coefficient: 0.0, order: 0.0 }, Some((0, -coupling * drive)));
        let free = self.free_capacitance::<f64>();
        let lossy = Tangent::dashpot(square * self.resistance.value);
        let inner = Tangent::Parallel(vec![lossy, Tangent::spring(square * elastic / free), source]);
        let circuit = Tangent::Series(vec![Tangent::spring(square / self.capacitance.value), inner]);
        let force = -coupling * at.inputs[0].value;
        AtRest { force, stiffness: None, tangent: Tangent::Whole(Box::new(circuit)) }
    }

    fn clock(&self) -> Clock {
        Clock::Own
    }

    fn holds(&self) -> Holds {
        Holds::Always
    }

    /// None without hysteresis; else as many as [`Leaf::guards_in`] has.
    fn guards(&self, at: &Point, take: &mut dyn FnMut(f64)) {
        let (stops, feed_forward) = self.stops();
        let of_stops = 1 + 2 * stops.len();
        let count = match self.drop {
            VoltageDrop::None => 0,
            _ if feed_forward => 2 * of_stops,
            _ => of_stops,
        };
        (0..count).for_each(|_| take(at.rate));
    }

    /// Where the current turns round, and where stops begin to slip; in metres, as rounding of strokes is.
    fn guards_in(&self, step: &Step, state: StateRef, guards: &mut Vec<Guard>) {
        if self.drop == VoltageDrop::None {
            return;
        }
        let kept = self.kept(state.variables);
        let Solved { charge, current, .. } = self.solve(step, &kept);
        let (last, scale) = (step.nodes.count(), self.coupling.value / self.stiffness.value);
        let mut push = |of: &dyn Fn(usize) -> f64| {
            guards.push(std::array::from_fn(|k| if k <= last { scale * of(k) } else { 0.0 }));
        };
        let (stops, feed_forward) = self.stops();
        let mut bounds = |held: &[f64], moved: &dyn Fn(usize) -> f64| {
            for (stop, held) in stops.iter().zip(held) {
                push(&|k| held + moved(k) - stop.limit.value);
                push(&|k| held + moved(k) + stop.limit.value);
            }
        };
        bounds(kept.hysteresis, &|k| self.gone(&kept, charge[k]));
        if feed_forward {
            bounds(kept.inverse, &|k| step.point(k).inputs[0].value - kept.wanted);
        }
        push(&|k| self.resistance.value * current[k]);
        if feed_forward {
            push(&|k| step.h * step.point(k).inputs[0].rate);
        }
    }

    fn check_inputs(&self, inputs: &[InputValue]) -> Result<(), RuleError> {
        let ([low, high], voltage) = (self.range, inputs[0].value);
        if low <= voltage && voltage <= high {
            return Ok(());
        }
        let (bound, parameter) = if voltage < low { (low, "V_min") } else { (high, "V_max") };
        let rule = format!("V_min ≤ U ≤ V_max is broken: the voltage is {voltage} V, {parameter} is {bound} V");
        Err(RuleError { rule, parameter: parameter.into() })
    }
}

impl Columns for Stack {
    type Solved<T: Real> = Solved<T>;

    /// Charge and z; drops of stops follow from the charge exactly.
    fn each_rate<T: Real>(&self, step: &Step<T>, _: &[T], solved: &Solved<T>, take: &mut dyn FnMut(T, Values<T>)) {
        let (Solved { charge, current, z, .. }, last) = (solved, step.nodes.count());
        take(charge[last], *current);
        if let VoltageDrop::BoucWen { hysteresis, .. } = &self.drop {
            take(z[last], self.z_rates(hysteresis, step, current, z));
        }
    }

    fn each_number(&mut self, take: &mut dyn FnMut(&mut Dual)) {
        let Self { coupling, capacitance, resistance, stiffness, drop, .. } = self;
        [coupling, capacitance, resistance, stiffness].into_iter().for_each(&mut *take);
        match drop {
            VoltageDrop::None => {}
            VoltageDrop::BoucWen { alpha_h, hysteresis } => {
                [alpha_h].into_iter().chain(hysteresis.numbers()).for_each(take);
            }
            VoltageDrop::Stops { stops, .. } => {
                stops.iter_mut().flat_map(|stop| [&mut stop.weight, &mut stop.limit]).for_each(take);
            }
        }
    }

    fn at_start<T: Real>(&self, at: &Point<T>, take: &mut dyn FnMut(T)) {
        let voltage = at.inputs[0].value;
        take(T::of(self.capacitance) * voltage + T::of(self.coupling) * at.stroke);
        let (stops, feed_forward) = self.stops();
        let wanted = if feed_forward { Some(1 + stops.len()) } else { None };
        (1..self.size().variables).for_each(|k| take(if Some(k) == wanted { voltage } else { 0.0.into() }));
    }

    fn solved(&self, step: &Step, start: &[f64]) -> Solved<f64> {
        self.solve(step, &self.kept(start))
    }

    fn follow(&self, step: &Step<Dual>, start: &[Dual], found: &Solved<f64>) -> Solved<Dual> {
        let (kept, count) = (self.kept(start), step.nodes.count());
        let resistance = self.resistance;
        let mut current: Values<Dual> = found.current.map(Dual::from);
        let charges = |current: &Values<Dual>| -> Values<Dual> {
            std::array::from_fn(|k| match k {
                0 => kept.charge,
                _ => {
                    let row = step.nodes.matrix()[k - 1].iter().take(count).zip(&current[1..]);
                    kept.charge + Dual::from(step.h) * row.map(|(weight, rate)| Dual::from(*weight) * *rate).sum()
                }
            })
        };
        let drive: Values<Dual> = std::array::from_fn(|k| self.driven(&kept, step.inputs_at(k.min(count))[0].value)[0]);
        // What drives the current where it and z stay, and what comes of it where z stays.
        let mut charge = charges(&current);
        let left: Values = std::array::from_fn(|k| {
            if k > count {
                return 0.0;
            }
            let voltage = self.voltage(charge[k], step.stroke[k]);
            (drive[k] - voltage - self.drop_at(&kept, charge[k], found.z[k].into()) - resistance * current[k]).slope
        });
        let by_left = match self.drop {
            VoltageDrop::BoucWen { .. } => &found.by_drive_alone,
            _ => &found.by_drive,
        };
        for i in 0..count {
            current[i + 1].slope = (0..count).map(|j| by_left[i][j] * left[j + 1]).sum();
        }
        let mut z = Values::default();
        if let VoltageDrop::BoucWen { alpha_h, hysteresis } = &self.drop {
            let free = self.free_capacitance::<Dual>();
            let moved = current.map(|current| current / free);
            let nodes = (count, step.nodes.matrix());
            z = hysteresis.follow(nodes, step.h, &moved, Some(&found.back), kept.hysteresis[0], &found.z);
            for i in 0..count {
                let held = (0..count).map(|j| by_left[i][j] * z[j + 1].slope).sum::<f64>();
                current[i + 1].slope -= alpha_h.value * held;
            }
        }
        charge = charges(&current);
        let drop: Values<Dual> = std::array::from_fn(|k| self.drop_at(&kept, charge[k], z[k]));
        current[0] = (drive[0] - self.voltage(charge[0], step.stroke[0]) - drop[0]) / resistance;
        let Solved { by_drive, by_drive_alone, back, by_input, .. } = *found;
        Solved { charge, current, drive, drop, z, by_drive, by_drive_alone, back, by_input }
    }

    fn force<T: Real>(&self, step: &Step<T>, solved: &Solved<T>, k: usize) -> T {
        -T::of(self.coupling) * self.voltage(solved.charge[k], step.stroke[k])
    }

    fn power<T: Real>(&self, _: &Step<T>, start: &[T], solved: &Solved<T>, k: usize) -> Power<T> {
        let (kept, Solved { charge, current, drive, z, .. }) = (self.kept(start), solved);
        let (free, gone) = (self.free_capacitance(), self.gone(&kept, charge[1]));
        let moves = current[k] / free;
        let lost = match &self.drop {
            VoltageDrop::None => 0.0.into(),
            VoltageDrop::BoucWen { alpha_h, hysteresis } => {
                T::of(*alpha_h) / hysteresis.slope_at_rest() * hysteresis.lost(z[k], moves)
            }
            // Steps end where stops begin and cease to slip: what they do at the first node they do all along.
            VoltageDrop::Stops { stops, .. } => {
                let slipping = stops.iter().zip(kept.hysteresis).filter(|(stop, held)| stop.slips(**held, gone));
                slipping.map(|(stop, _)| T::of(stop.weight) * T::of(stop.limit) * moves.abs()).sum()
            }
        };
        let dissipation = T::of(self.resistance) * current[k] * current[k] + free * lost;
        Power { dissipation, input: drive[k] * current[k] }
    }

    fn at_end<T: Real>(&self, step: &Step<T>, start: &[T], solved: &Solved<T>, take: &mut dyn FnMut(T)) {
        let (kept, last) = (self.kept(start), step.nodes.count());
        // The rates are constant, and the node in the middle.
        let end = |values: &Values<T>| match step.nodes {
            Nodes::Midpoint => T::from(2.0) * values[last] - values[0],
            _ => values[last],
        };
        let charge = end(&solved.charge);
        take(charge);
        if matches!(self.drop, VoltageDrop::BoucWen { .. }) {
            take(end(&solved.z));
        }
        let (stops, feed_forward) = self.stops();
        let gone = self.gone(&kept, charge);
        stops.iter().zip(kept.hysteresis).for_each(|(stop, held)| take(stop.after(*held, gone)));
        if feed_forward {
            let wanted = step.inputs_at(last)[0].value;
            take(wanted);
            let moved = wanted - kept.wanted;
            stops.iter().zip(kept.inverse).for_each(|(stop, held)| take(stop.after(*held, moved)));
        }
    }

    fn within<T: Real>(
        &self,
        step: &Step<T>,
        theta: f64,
        at: &Point<T>,
        start: &[T],
        solved: &Solved<T>,
    ) -> Observation<T> {
        let kept = self.kept(start);
        self.observation(&kept, at, self.until(step, theta, &kept, solved))
    }

    fn between<T: Real>(&self, at: &Point<T>, variables: &[T]) -> Observation<T> {
        let kept = self.kept(variables);
        self.observation(&kept, at, self.kept_now(&kept))
    }

    fn told<T: Real>(
        &self,
        within: Option<(&Step<T>, f64, &Solved<T>)>,
        at: &Point<T>,
        variables: &[T],
        take: &mut dyn FnMut(T),
    ) {
        let kept = self.kept(variables);
        let [charge, z] = match within {
            Some((step, theta, solved)) => self.until(step, theta, &kept, solved),
            None => self.kept_now(&kept),
        };
        let drop = self.drop_at(&kept, charge, z);
        let [drive, _] = self.driven(&kept, at.inputs[0].value);
        let voltage = self.voltage(charge, at.stroke) + drop;
        [voltage, charge, (drive - voltage) / T::of(self.resistance)].into_iter().for_each(take);
    }
}
