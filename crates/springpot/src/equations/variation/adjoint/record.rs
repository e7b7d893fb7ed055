//! What is kept of each step, while the run goes on.

use super::begin::tell_inputs;
use super::tape::{Entry, KEPT, Row, RowOfElement, Slopes, Sparse, Start, Step, StepOfElement};
use super::{MOST, Recording, Tape};
use crate::collocation::{MAX_NODES, STAGES};
use crate::equations::assembly::Equations;
use crate::equations::node::Node;
use crate::equations::variation::saltation::jumps;
use crate::equations::variation::{ROW, Variation};
use crate::law::variation::probe::LawProbe;
use crate::observe::{Quantity, Snapshot};
use crate::sensitivity::SensitivityError;

/// A jump, in units of what jumps.
const JUMP: f64 = 1e-6;

impl Recording {
    /// Sees a node of the step that was solved.
    pub(crate) fn see(&mut self, equations: &Equations, i: usize, at: Node, force: &[f64]) {
        self.variation.see(equations, i, at, force);
        let by = self.variation.by.clone();
        self.laws.iter_mut().enumerate().for_each(|(e, law)| tell_inputs(law, &by, (e, i), at.t));
    }

    /// Keeps what the step that was seen, of size `h` and with this matrix, transposed, does; until it is taken into the past it may be another one.
    pub(crate) fn keep_step(&mut self, equations: &Equations, (h, free): (f64, &[usize]), matrix: Vec<f64>) {
        let stages = std::array::from_fn(|i| slopes(&self.variation, i + 1, free));
        let element = |(e, law): (usize, &mut LawProbe)| {
            let exact = equations.bank.exact_response(e);
            let response = exact.as_ref().unwrap_or_else(|| equations.bank.response(e));
            let columns = law.columns();
            let mut forces = Sparse::default();
            let asked = law.ask(|told, own, forces| equations.bank.vary(e, told, own, forces));
            asked.chunks_exact(columns).enumerate().for_each(|(i, row)| forces.push_row(i, row));
            let at =
                |slopes: &[[f64; MAX_NODES]; MAX_NODES]| std::array::from_fn(|i| std::array::from_fn(|m| slopes[i][m]));
            StepOfElement {
                response: [at(&response.d_stroke), at(&response.d_rate)],
                forces,
                ..StepOfElement::default()
            }
        };
        let elements = self.laws.iter_mut().enumerate().map(element).collect();
        self.step = Some(Box::new(Step { h, free: free.to_vec(), matrix, stages, elements, rows: Vec::new() }));
    }

    /// Keeps row `number`, where the run is at `snapshot`: at θ of the step at hand, or between two.
    pub(crate) fn keep_row(
        &mut self,
        equations: &Equations,
        theta: Option<f64>,
        number: usize,
        snapshot: &Snapshot,
    ) -> Result<(), SensitivityError> {
        let mut row = Row::of(number, theta.unwrap_or(0.0));
        let nv = self.tape.nv;
        let model = &self.variation.system.model;
        let is_of_motion = self.quantities.iter().all(|of| Variation::is_of_motion(model, *of));
        if !is_of_motion {
            let evaluation = &snapshot.evaluation;
            let force: Vec<f64> = (0..self.laws.len()).map(|e| snapshot.force(e)).collect();
            let at = Node { t: evaluation.t, q: &evaluation.q, v: &evaluation.v, a: &evaluation.a };
            self.rows.see(equations, ROW, at, &force);
            let by = self.variation.by.clone();
            for (e, law) in self.laws.iter_mut().enumerate() {
                self.rows.measure(e, ROW);
                tell_inputs(law, &by, (e, ROW), evaluation.t);
                let point = evaluation.elements[e].point(evaluation.t);
                let mut map = Sparse::default();
                let read = law.read(theta.is_some(), |told, own, sum| match theta {
                    Some(theta) => equations.bank.vary_at(e, (theta, &point), told, own, sum),
                    None => equations.bank.vary_now(e, &point, told, own, sum),
                });
                read.iter().enumerate().for_each(|(k, values)| map.push_row(k, values));
                let lags = law.law.memories_mut().iter().map(|memory| memory.lags()).collect();
                let gradients = self.rows.nodes[ROW].gradients[e].clone();
                row.elements.push(RowOfElement { gradients, map, lags });
            }
        }
        let count = self.tape.count;
        // Columns of rows begin with the parameters; those of the tape end with them.
        let turned = |column: usize| if column < count { self.rows.count() - count + column } else { column - count };
        for (k, of) in self.quantities.iter().enumerate() {
            let motion = match *of {
                Quantity::Time => continue,
                Quantity::Coordinate(velocity) => Some((0, velocity)),
                Quantity::Velocity(velocity) => Some((1, velocity)),
                Quantity::Acceleration(velocity) => Some((2, velocity)),
                _ => None,
            };
            if let Some((place, velocity)) = motion {
                row.quantities.push(k, place * nv + self.variation.own_v[velocity], 1.0);
                continue;
            }
            if snapshot.value(*of).is_nan() {
                continue;
            }
            let Some(values) = self.rows.finite_values(*of, snapshot) else {
                return Err(SensitivityError::Backwards { what: "a column that has no derivative".into() });
            };
            for (column, value) in values.into_iter().enumerate().filter(|(_, value)| *value != 0.0) {
                row.quantities.push(k, turned(column), value);
            }
        }
        match &mut self.step {
            Some(step) if theta.is_some() => step.rows.push(row),
            _ => self.tape.entries.push(Entry::Row(row)),
        }
        Ok(())
    }

    /// The step at hand is about to be taken into the past.
    ///
    /// # Errors
    /// More than a tape may hold.
    pub(crate) fn commit(&mut self, equations: &Equations, t: f64) -> Result<(), SensitivityError> {
        let Some(mut step) = self.step.take() else { return Ok(()) };
        for (e, (law, own)) in self.laws.iter_mut().zip(&mut step.elements).enumerate() {
            law.commit(|told, own| equations.bank.commit_variation(e, told, own));
            let columns = law.columns();
            let memories = law.law.memories_mut();
            for (m, memory) in memories.iter_mut().enumerate() {
                let [a, b, c, d, travelled, now, _] = memory.known();
                let rows = [a, b, c, d, travelled, now];
                rows.into_iter().enumerate().for_each(|(k, row)| own.kept.push_row(m * KEPT + k, row));
                own.lags.push(memory.lags());
                own.pasts.push(memory.take_past());
            }
            let first = own.lags.len() * KEPT;
            let variables = law.law.variables().chunks_exact(columns);
            variables.enumerate().for_each(|(k, row)| own.kept.push_row(first + k, row));
            law.carry_inputs();
            law.renew();
        }
        self.variation.nodes.swap(0, STAGES);
        self.tape.entries.push(Entry::Step(step));
        if self.tape.bytes() > MOST {
            let what = format!("steps beyond t = {t} s: what is kept of them comes to more than 1 GiB");
            return Err(SensitivityError::Backwards { what });
        }
        Ok(())
    }

    /// Goes to the far side of what was crossed, `start`, where velocities and accelerations were those `before` and are those `after`; at a change of the
    /// robot's own where `is_own`.
    ///
    /// # Errors
    /// What cannot be gone back through.
    pub(crate) fn settle(
        &mut self,
        equations: &Equations,
        start: Node,
        [before, after]: [[&[f64]; 2]; 2],
        is_own: bool,
    ) -> Result<(), SensitivityError> {
        let ([v, a], [v_after, a_after]) = (before, after);
        let refuse = |what: &str| Err(SensitivityError::Backwards { what: format!("{what} at t = {} s", start.t) });
        if jumps(JUMP, v, v_after, |_| true) {
            return refuse("velocities that jump");
        }
        if is_own && jumps(JUMP, a, a_after, |_| true) {
            return refuse("forces that jump where the motion makes them");
        }
        let by = self.variation.by.clone();
        self.laws.iter_mut().enumerate().for_each(|(e, law)| tell_inputs(law, &by, (e, 0), start.t));
        self.see_start(equations, start)
    }

    /// Sees where a step starts, and keeps how its accelerations follow.
    pub(super) fn see_start(&mut self, equations: &Equations, start: Node) -> Result<(), SensitivityError> {
        let force: Vec<f64> = (0..self.laws.len()).map(|e| equations.force_behind(e)).collect();
        self.variation.see(equations, 0, start, &force);
        let free = self.variation.of_run(equations.free());
        let n = self.tape.nv;
        let mass = &self.variation.nodes[0].slopes.d_a;
        let mass = free.iter().flat_map(|&column| free.iter().map(move |&row| mass[row * n + column])).collect();
        let slopes = slopes(&self.variation, 0, &free);
        let (by, mut forces) = (self.variation.by.clone(), Vec::new());
        for (e, law) in self.laws.iter_mut().enumerate() {
            // Between two steps the row is the start itself.
            tell_inputs(law, &by, (e, ROW), start.t);
            let mut map = Sparse::default();
            let point = equations.bank.point(e, 0);
            let [force, ..] = law.read(false, |told, own, sum| equations.bank.vary_now(e, &point, told, own, sum));
            map.push_row(0, force);
            forces.push(map);
        }
        self.tape.entries.push(Entry::Start(Start { free, mass, slopes, forces }));
        Ok(())
    }

    /// All that was kept, at the end of the run.
    pub(crate) fn into_tape(self) -> Tape {
        self.tape
    }
}

/// The slopes at node `i` that was seen.
fn slopes(variation: &Variation, i: usize, free: &[usize]) -> Slopes {
    let (node, n, count) = (&variation.nodes[i], variation.nv(), variation.count());
    let rows = |all: &[f64]| free.iter().flat_map(|&row| all[row * n..(row + 1) * n].iter().copied()).collect();
    let mut explicit = Sparse::default();
    free.iter().enumerate().for_each(|(r, &row)| explicit.push_row(r, &node.explicit[row * count..(row + 1) * count]));
    Slopes { by_q: rows(&node.slopes.d_q), by_v: rows(&node.slopes.d_v), explicit, gradients: node.gradients.clone() }
}
