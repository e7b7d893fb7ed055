//! A piezo stack and the circuit that drives it.

use super::contract::{Leaf, When};
use super::hysteresis::{Hysteresis, Matrix, Values, eliminate, resolvent};
use crate::collocation::{MAX_NODES, Nodes, quadrature, quadrature_defect};
use crate::fractional::KernelError;
use crate::law::network::{Guard, Holds};
use crate::law::prandtl_ishlinskii::Stop;
use crate::law::rule::RuleError;
use crate::law::state::{State, StateMut, StateRef, StateSize};
use crate::law::step::{Electric, InputValue, LocalError, Observation, Point, Powers, Response, Start, Step, Term};
use crate::law::tangent::{LeafAtRest, Tangent};

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
    pub coupling: f64,
    /// C > 0 at a fixed stroke, F.
    pub capacitance: f64,
    /// R > 0, ohm.
    pub resistance: f64,
    /// k > 0 of what is beside it, N/m.
    pub stiffness: f64,
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
        alpha_h: f64,
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
struct Solved {
    /// Charge, current, U and v_h at the start and at the nodes.
    charge: Values,
    current: Values,
    drive: Values,
    drop: Values,
    /// z of [`VoltageDrop::BoucWen`].
    z: Values,
    /// By how much the current at the nodes follows the voltages that drive it there.
    by_drive: Matrix,
    /// ∂U/∂u at the nodes.
    by_input: [f64; MAX_NODES],
}

/// What the state holds.
struct Kept<'a> {
    charge: f64,
    /// z, or the stops of e.
    hysteresis: &'a [f64],
    /// The last input and the stops of it.
    wanted: f64,
    inverse: &'a [f64],
}

impl Stack {
    /// C + T²/k: the capacitance where the stack may move.
    fn free_capacitance(&self) -> f64 {
        self.capacitance + self.coupling * self.coupling / self.stiffness
    }

    fn stops(&self) -> (&[Stop], bool) {
        match &self.drop {
            VoltageDrop::Stops { stops, feed_forward } => (stops, *feed_forward),
            _ => (&[], false),
        }
    }

    fn kept<'a>(&self, state: StateRef<'a>) -> Kept<'a> {
        let (charge, rest) = state.variables.split_first().expect("a state of this law");
        let (stops, feed_forward) = self.stops();
        match (&self.drop, feed_forward) {
            (VoltageDrop::Stops { .. }, true) => {
                let (hysteresis, rest) = rest.split_at(stops.len());
                Kept { charge: *charge, hysteresis, wanted: rest[0], inverse: &rest[1..] }
            }
            _ => Kept { charge: *charge, hysteresis: rest, wanted: 0.0, inverse: &[] },
        }
    }

    /// V of a charge.
    fn voltage(&self, charge: f64, stroke: f64) -> f64 {
        (charge - self.coupling * stroke) / self.capacitance
    }

    /// Σ b_i·s_i, and how it follows its stroke, after that has moved one way.
    fn held(stops: &[Stop], held: &[f64], moved: f64) -> [f64; 2] {
        stops.iter().zip(held).fold([0.0; 2], |[sum, slope], (stop, held)| {
            let own = if stop.slips(*held, moved) { 0.0 } else { stop.weight };
            [sum + stop.weight * stop.after(*held, moved), slope + own]
        })
    }

    /// U and ∂U/∂u.
    fn driven(&self, kept: &Kept, input: f64) -> [f64; 2] {
        match self.stops() {
            (stops, true) => {
                let [sum, slope] = Self::held(stops, kept.inverse, input - kept.wanted);
                [input + sum, 1.0 + slope]
            }
            _ => [input, 1.0],
        }
    }

    fn solve(&self, step: &Step, kept: &Kept) -> Solved {
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
            by_input,
        };
        match &self.drop {
            VoltageDrop::Stops { stops, .. } => self.along_stops(step, kept, stops, &left, &mut solved),
            VoltageDrop::None => self.along(step, &left, None, &mut solved),
            VoltageDrop::BoucWen { alpha_h, hysteresis } => {
                self.along(step, &left, Some((*alpha_h, hysteresis, kept.hysteresis[0])), &mut solved);
            }
        }
        solved.current[0] = (left[0] - solved.drop[0]) / self.resistance;
        for (i, row) in nodes.matrix().iter().enumerate().take(count) {
            solved.charge[i + 1] += h * (0..count).map(|j| row[j] * solved.current[j + 1]).sum::<f64>();
        }
        solved
    }

    /// R q'_i + (h/C) Σ_j A_ij q'_j = left_i − alpha_h·z_i.
    fn along(&self, step: &Step, left: &Values, of_z: Option<(f64, &Hysteresis, f64)>, solved: &mut Solved) {
        let (nodes, count, h) = (step.nodes, step.nodes.count(), step.h);
        let own = resolvent(nodes, &[self.resistance; MAX_NODES][..count], h / self.capacitance);
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
        let moves = self.free_capacitance().recip();
        let free = current(&Values::default()).map(|current| moves * current);
        let back = own.map(|row| row.map(|entry| moves * alpha_h * entry));
        let (z, tangent) = hysteresis.solve((nodes.count(), nodes.matrix()), h, &free, Some(&back), start);
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
    fn along_stops(&self, step: &Step, kept: &Kept, stops: &[Stop], left: &Values, solved: &mut Solved) {
        let (nodes, count, h) = (step.nodes, step.nodes.count(), step.h);
        let (matrix, moves) = (nodes.matrix(), self.free_capacitance().recip());
        solved.drop[0] = Self::held(stops, kept.hysteresis, 0.0)[0];
        let mut found = false;
        for _ in 0..MOST_ITERATIONS {
            let mut system = [[0.0; 2 * MAX_NODES + 1]; MAX_NODES];
            for i in 0..count {
                let gone: f64 = (0..count).map(|j| h * matrix[i][j] * solved.current[j + 1]).sum();
                let [drop, slope] = Self::held(stops, kept.hysteresis, moves * gone);
                solved.drop[i + 1] = drop;
                let stiffness = self.capacitance.recip() + moves * slope;
                (0..count).for_each(|j| system[i][j] = h * matrix[i][j] * stiffness);
                system[i][i] += self.resistance;
                system[i][MAX_NODES + i] = 1.0;
                let meets = self.resistance * solved.current[i + 1] + gone / self.capacitance + drop;
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
            let floor = ROUNDING * left.iter().fold(0.0, |most: f64, left| most.max(left.abs())) / self.resistance;
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
    fn gone(&self, kept: &Kept, charge: f64) -> f64 {
        (charge - kept.charge) / self.free_capacitance()
    }

    /// ½C·V² and what z, or stops, hold.
    fn stored(&self, voltage: f64, hysteresis: f64) -> f64 {
        0.5 * (self.capacitance * voltage * voltage + self.free_capacitance() * hysteresis)
    }

    /// alpha_h·z²/A, or Σ b_i·s_i².
    fn squares(&self, z: f64, held: impl Iterator<Item = f64>) -> f64 {
        match &self.drop {
            VoltageDrop::None => 0.0,
            VoltageDrop::BoucWen { alpha_h, hysteresis } => alpha_h * z * z / hysteresis.slope_at_rest(),
            VoltageDrop::Stops { stops, .. } => {
                stops.iter().zip(held).map(|(stop, held)| stop.weight * held * held).sum()
            }
        }
    }

    /// Charge, and the hysteresis after it has gone there, at θ of a step.
    fn until(&self, step: &Step, theta: f64, kept: &Kept, solved: &Solved) -> [f64; 2] {
        let weights = quadrature(step.nodes, theta);
        let sum = |rates: Values| step.h * weights.iter().zip(rates).map(|(weight, rate)| weight * rate).sum::<f64>();
        let charge = kept.charge + sum(solved.current);
        let z = match &self.drop {
            VoltageDrop::BoucWen { hysteresis, .. } => {
                let moves = self.free_capacitance().recip();
                let last = step.nodes.count();
                let rate = |k: usize| hysteresis.rate(solved.z[k], moves * solved.current[k]);
                solved.z[0] + sum(std::array::from_fn(|k| if k > last { 0.0 } else { rate(k) }))
            }
            _ => 0.0,
        };
        [charge, z]
    }

    /// v_h where the charge has gone to `charge`, and z is `z`.
    fn drop_at(&self, kept: &Kept, charge: f64, z: f64) -> f64 {
        match &self.drop {
            VoltageDrop::None => 0.0,
            VoltageDrop::BoucWen { alpha_h, .. } => alpha_h * z,
            VoltageDrop::Stops { stops, .. } => Self::held(stops, kept.hysteresis, self.gone(kept, charge))[0],
        }
    }

    fn observation(&self, kept: &Kept, at: &Point, [charge, z]: [f64; 2]) -> Observation {
        let voltage = self.voltage(charge, at.stroke);
        let gone = self.gone(kept, charge);
        let held = self.stops().0.iter().zip(kept.hysteresis).map(|(stop, held)| stop.after(*held, gone));
        let stored = Some(self.stored(voltage, self.squares(z, held)));
        Observation { derivative: at.stroke, regular: -self.coupling * voltage, singular: 0.0, stored }
    }

    /// Charge and z between two steps.
    fn between(&self, kept: &Kept) -> [f64; 2] {
        [kept.charge, if matches!(self.drop, VoltageDrop::BoucWen { .. }) { kept.hysteresis[0] } else { 0.0 }]
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
        let voltage = start.inputs[0].value;
        state.push_variable(self.capacitance * voltage + self.coupling * start.stroke);
        let (stops, feed_forward) = self.stops();
        let wanted = if feed_forward { Some(1 + stops.len()) } else { None };
        (1..self.size().variables).for_each(|k| state.push_variable(if Some(k) == wanted { voltage } else { 0.0 }));
        Ok(())
    }

    fn evaluate(&self, step: &Step, state: StateRef, response: &mut Response) {
        let Solved { charge, by_drive, .. } = self.solve(step, &self.kept(state));
        let (count, matrix) = (step.nodes.count(), step.nodes.matrix());
        let by_voltage = self.coupling / self.capacitance;
        for i in 0..count {
            response.force[i] -= self.coupling * self.voltage(charge[i + 1], step.stroke[i + 1]);
            response.d_stroke[i][i] += self.coupling * by_voltage;
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
        let Solved { by_drive, by_input, .. } = self.solve(step, &self.kept(state));
        let (count, matrix) = (step.nodes.count(), step.nodes.matrix());
        for i in 0..count {
            for j in 0..count {
                let follows: f64 = (0..count).map(|m| step.h * matrix[i][m] * by_drive[m][j]).sum();
                slopes[i][j] -= self.coupling / self.capacitance * follows * by_input[j];
            }
        }
    }

    fn commit(&self, step: &Step, state: StateMut) {
        let kept = self.kept(state.view());
        let solved = self.solve(step, &kept);
        let last = step.nodes.count();
        // The rates are constant, and the node in the middle.
        let end = |values: &Values| match step.nodes {
            Nodes::Midpoint => 2.0 * values[last] - values[0],
            _ => values[last],
        };
        let charge = end(&solved.charge);
        let gone = self.gone(&kept, charge);
        let (stops, feed_forward) = self.stops();
        let (wanted, count) = (step.point(last).inputs[0].value, stops.len());
        let moved = wanted - kept.wanted;
        state.variables[0] = charge;
        if matches!(self.drop, VoltageDrop::BoucWen { .. }) {
            state.variables[1] = end(&solved.z);
        }
        for (held, stop) in state.variables[1..].iter_mut().zip(stops) {
            *held = stop.after(*held, gone);
        }
        if feed_forward {
            state.variables[1 + count] = wanted;
            for (held, stop) in state.variables[2 + count..].iter_mut().zip(stops) {
                *held = stop.after(*held, moved);
            }
        }
    }

    fn local_errors(&self, step: &Step, state: StateRef, errors: &mut Vec<LocalError>) {
        let kept = self.kept(state);
        let Solved { charge, current, drive, z, .. } = self.solve(step, &kept);
        let last = step.nodes.count();
        // A drive that begins at 0 V may be the difference of voltages as large as the stack takes: their rounding is in it.
        let most = self.range[0].abs().max(self.range[1].abs());
        let volts =
            drive.iter().zip(&charge).map(|(u, q)| u.abs().max(q.abs() / self.capacitance)).fold(most, f64::max);
        let mut push = |rates: &Values, value: f64, rounding: f64| {
            let defect = step.h * quadrature_defect(step.nodes, rates);
            let error = if defect <= rounding { 0.0 } else { defect };
            errors.push(LocalError { error, value, order: 0.0, sharpness: 1.0 });
        };
        push(&current, charge[last], ROUNDING * volts * self.capacitance);
        if let VoltageDrop::BoucWen { hysteresis, .. } = &self.drop {
            let moves = self.free_capacitance().recip();
            let rates = std::array::from_fn(|k| if k > last { 0.0 } else { hysteresis.rate(z[k], moves * current[k]) });
            push(&rates, z[last], ROUNDING * volts * hysteresis.slope_at_rest());
        }
    }

    fn powers(&self, step: &Step, state: StateRef, powers: &mut Powers) {
        let kept = self.kept(state);
        let Solved { charge, current, drive, z, .. } = self.solve(step, &kept);
        let (free, gone) = (self.free_capacitance(), self.gone(&kept, charge[1]));
        for (k, power) in powers.iter_mut().enumerate().take(step.nodes.count() + 1) {
            let moves = current[k] / free;
            let lost = match &self.drop {
                VoltageDrop::None => 0.0,
                VoltageDrop::BoucWen { alpha_h, hysteresis } => {
                    alpha_h / hysteresis.slope_at_rest() * hysteresis.lost(z[k], moves)
                }
                // Steps end where stops begin and cease to slip: what they do at the first node they do all along.
                VoltageDrop::Stops { stops, .. } => {
                    let slipping = stops.iter().zip(kept.hysteresis).filter(|(stop, held)| stop.slips(**held, gone));
                    slipping.map(|(stop, _)| stop.weight * stop.limit * moves.abs()).sum()
                }
            };
            power.dissipation += self.resistance * current[k] * current[k] + free * lost;
            power.input += drive[k] * current[k];
        }
    }

    fn at(&self, step: &Step, theta: f64, at: &Point, state: StateRef) -> Observation {
        let kept = self.kept(state);
        let until = self.until(step, theta, &kept, &self.solve(step, &kept));
        self.observation(&kept, at, until)
    }

    fn now(&self, at: &Point, state: StateRef) -> Observation {
        let kept = self.kept(state);
        self.observation(&kept, at, self.between(&kept))
    }

    fn electric(&self, when: When, at: &Point, state: StateRef) -> Option<Electric> {
        let kept = self.kept(state);
        let [charge, z] = match when {
            When::Within(step, theta) => self.until(step, theta, &kept, &self.solve(step, &kept)),
            When::Between => self.between(&kept),
        };
        let drop = self.drop_at(&kept, charge, z);
        let [drive, _] = self.driven(&kept, at.inputs[0].value);
        let voltage = self.voltage(charge, at.stroke) + drop;
        Some(Electric { voltage, charge, current: (drive - voltage) / self.resistance })
    }

    fn is_electric(&self) -> bool {
        true
    }

    /// Faster than the circuit: its charge stays.
    fn linearised(&self, _: &Point) -> Term {
        Term { coefficient: self.coupling * self.coupling / self.capacitance, order: 0.0 }
    }

    /// V has come to U.
    fn at_rest(&self, at: &Point, _: f64) -> LeafAtRest {
        let [force, input] = [-self.coupling * at.inputs[0].value, -self.coupling];
        LeafAtRest { force, stiffness: None, term: self.linearised(at), input: Some((0, input)), damping: 0.0 }
    }

    /// The spring T²/C in series with the dashpot T²R, the hysteresis about 0 beside it, and the force −T·U.
    fn tangent(&self, _: &Point) -> Option<Tangent> {
        let square = self.coupling * self.coupling;
        let leaf = |coefficient: f64, order: f64| Tangent::Leaf(Term { coefficient, order }, None);
        let (elastic, drive) = match &self.drop {
            VoltageDrop::None => (0.0, 1.0),
            VoltageDrop::BoucWen { alpha_h, hysteresis } => (alpha_h * hysteresis.slope_at_rest(), 1.0),
            VoltageDrop::Stops { stops, feed_forward } => {
                let all: f64 = stops.iter().map(|stop| stop.weight).sum();
                (all, if *feed_forward { 1.0 + all } else { 1.0 })
            }
        };
        let source = Tangent::Leaf(Term { coefficient: 0.0, order: 0.0 }, Some((0, -self.coupling * drive)));
        let inner =
            vec![leaf(square * self.resistance, 1.0), leaf(square * elastic / self.free_capacitance(), 0.0), source];
        Some(Tangent::Series(vec![leaf(square / self.capacitance, 0.0), Tangent::Parallel(inner)]))
    }

    fn has_clock(&self) -> bool {
        true
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
        let kept = self.kept(state);
        let Solved { charge, current, .. } = self.solve(step, &kept);
        let (last, scale) = (step.nodes.count(), self.coupling / self.stiffness);
        let mut push = |of: &dyn Fn(usize) -> f64| {
            guards.push(std::array::from_fn(|k| if k <= last { scale * of(k) } else { 0.0 }));
        };
        let (stops, feed_forward) = self.stops();
        let mut bounds = |held: &[f64], moved: &dyn Fn(usize) -> f64| {
            for (stop, held) in stops.iter().zip(held) {
                push(&|k| held + moved(k) - stop.limit);
                push(&|k| held + moved(k) + stop.limit);
            }
        };
        bounds(kept.hysteresis, &|k| self.gone(&kept, charge[k]));
        if feed_forward {
            bounds(kept.inverse, &|k| step.point(k).inputs[0].value - kept.wanted);
        }
        push(&|k| self.resistance * current[k]);
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
