//! What a law makes of a step, as a matrix: for adjoints.
//!
//! A law is asked what it changes by as ever, but by columns of ones in place of parameters: by its stroke and its rate at the start, at the nodes and at a
//! row, by its inner variables, by what the past of each memory tells ([`PortColumns`]), and by the parameters that move its numbers or inputs. The
//! columns are few and the same in every step.

use super::{LawVariation, ObservationVariation, PointVariation, StepVariation};
use crate::collocation::STAGES;
use crate::fractional::PortColumns;
use crate::law::network::Network;
use crate::law::state::State;
use crate::law::step::Point;

/// Points that a law is told of: the start, the nodes and a row.
const POINTS: usize = STAGES + 2;
const ROW: usize = STAGES + 1;

/// Columns of stroke and rate at the start, the nodes and a row.
pub(crate) const STROKE: [usize; POINTS] = [0, 2, 3, 4, 8];
pub(crate) const RATE: [usize; POINTS] = [1, 5, 6, 7, 9];
const VARIABLES: usize = 10;

/// How many lags a step asks for of a memory, and a row beside them: of one alone, and inside a series.
const ALONE: usize = STAGES + 1;
const IN_SERIES: usize = 2 * (STAGES + 1) + 4;

/// A law with columns of ones.
#[derive(Debug)]
pub(crate) struct LawProbe {
    columns: usize,
    variables: usize,
    pub(crate) ports: Vec<PortColumns>,
    /// The parameters that stand at the end.
    pub(crate) parameters: Vec<usize>,
    pub(crate) law: LawVariation,
    stroke: Vec<f64>,
    rate: Vec<f64>,
    /// Values and rates of inputs, point by point; empty where no parameter moves any.
    inputs: [Vec<f64>; 2],
    forces: Vec<f64>,
    row: [Vec<f64>; 3],
    /// How many lags of each memory the step asked for, without rows.
    asked: Vec<usize>,
}

impl LawProbe {
    /// Of a law that has begun, at t = 0; `by` are parameters that move it, with the law as each has it. Inputs of parameters are to be told before
    /// ([`Self::input_mut`]), then comes [`Self::begin`].
    pub(crate) fn new(law: &Network, parameters: Vec<usize>, moves_inputs: Option<usize>, state: &State) -> Self {
        let (variables, memories) = (state.size().variables, state.size().memories);
        let room = if law.has_memories_in_series() { IN_SERIES } else { ALONE };
        let first = |m: usize| VARIABLES + variables + m * (room + 3);
        let port = |m: usize| PortColumns {
            lags: [first(m), room],
            travelled: first(m) + room,
            origin: first(m) + room + 1,
            now: first(m) + room + 2,
        };
        let columns = first(memories) + parameters.len();
        let told = |places: [usize; POINTS]| {
            let mut blocks = vec![0.0; POINTS * columns];
            places.iter().enumerate().for_each(|(point, column)| blocks[point * columns + column] = 1.0);
            blocks
        };
        let inputs = || vec![0.0; moves_inputs.map_or(0, |inputs| POINTS * inputs * columns)];
        Self {
            columns,
            variables,
            ports: (0..memories).map(port).collect(),
            parameters,
            law: LawVariation::default(),
            stroke: told(STROKE),
            rate: told(RATE),
            inputs: [inputs(), inputs()],
            forces: vec![0.0; STAGES * columns],
            row: [(); 3].map(|()| vec![0.0; columns]),
            asked: vec![0; memories],
        }
    }

    /// What changes of its state at t = 0 by stroke and rate there and by parameters: δx(0) of each memory, and its inner variables; then ones stand
    /// for them.
    ///
    /// # Errors
    /// The name of a leaf whose derivatives are not known.
    pub(crate) fn begin(
        &mut self,
        law: &Network,
        laws: impl Iterator<Item = Option<Network>>,
        at: &Point,
        state: &State,
    ) -> Result<[Vec<f64>; 2], String> {
        let mut by: Vec<Option<Network>> = vec![None; self.columns - self.parameters.len()];
        by.extend(laws);
        let told = PointVariation {
            stroke: &self.stroke[..self.columns],
            rate: &self.rate[..self.columns],
            inputs: self.inputs.each_ref().map(|blocks| &blocks[..blocks.len() / POINTS]),
            step: None,
            passed: None,
        };
        self.law = LawVariation::begin(law, &by, at, &told, state)?;
        let variables = self.law.variables().to_vec();
        let origins = self.law.memories_mut().iter().flat_map(|memory| memory.known()[6].to_vec()).collect();
        for (memory, port) in self.law.memories_mut().iter_mut().zip(&self.ports) {
            memory.tell_by(*port);
        }
        self.renew();
        Ok([origins, variables])
    }

    /// Ones stand for the state where the next step begins.
    pub(crate) fn renew(&mut self) {
        let columns = self.columns;
        let variables = self.law.variables_mut();
        variables.fill(0.0);
        for (k, block) in variables.chunks_exact_mut(columns).enumerate() {
            block[VARIABLES + k] = 1.0;
        }
        self.law.memories_mut().iter_mut().for_each(|memory| memory.begin_ports());
        self.asked.fill(0);
    }

    /// Number of columns.
    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    /// The column of inner variable `k`.
    pub(crate) fn variable(&self, k: usize) -> usize {
        VARIABLES + k
    }

    /// Number of inner variables.
    pub(crate) fn variables(&self) -> usize {
        self.variables
    }

    /// The column of the parameter at this place of its own.
    pub(crate) fn parameter(&self, place: usize) -> usize {
        self.columns - self.parameters.len() + place
    }

    /// Sets what a parameter, by its place, changes of value and rate of an input at a point; there is none where no parameter moves inputs.
    pub(crate) fn input_mut(&mut self, point: usize, input: usize, place: usize) -> [&mut f64; 2] {
        let (columns, column) = (self.columns, self.parameter(place));
        let at = (point * (self.inputs[0].len() / (POINTS * columns)) + input) * columns + column;
        self.inputs.each_mut().map(|blocks| &mut blocks[at])
    }

    /// Whether parameters move inputs.
    pub(crate) fn moves_inputs(&self) -> bool {
        !self.inputs[0].is_empty()
    }

    /// Nothing changes of inputs at a point.
    pub(crate) fn still_inputs(&mut self, point: usize) {
        for blocks in &mut self.inputs {
            let own = blocks.len() / POINTS;
            blocks[point * own..(point + 1) * own].fill(0.0);
        }
    }

    /// The inputs at the end of the step are those where the next one starts.
    pub(crate) fn carry_inputs(&mut self) {
        for blocks in &mut self.inputs {
            let own = blocks.len() / POINTS;
            blocks.copy_within(STAGES * own..ROW * own, 0);
        }
    }

    /// Its forces at the nodes by all columns, where strokes and rates at the nodes stay.
    pub(crate) fn ask(&mut self, ask: impl FnOnce(&StepVariation, &LawVariation, &mut [f64])) -> &[f64] {
        self.law.memories_mut().iter_mut().for_each(|memory| memory.keep_lags(0));
        self.forces.fill(0.0);
        let (step, inputs) = (ROW * self.columns, self.inputs.each_ref());
        let inputs = inputs.map(|blocks| &blocks[..blocks.len() / POINTS * ROW]);
        let (stroke, rate) = (&self.stroke[..step], &self.rate[..step]);
        let told = StepVariation { count: self.columns, stroke, rate, inputs, passed: None };
        ask(&told, &self.law, &mut self.forces);
        for (asked, memory) in self.asked.iter_mut().zip(self.law.memories_mut()) {
            *asked = memory.lags().len();
        }
        &self.forces
    }

    /// Takes the step into its state.
    pub(crate) fn commit(&mut self, commit: impl FnOnce(&StepVariation, &mut LawVariation)) {
        for (asked, memory) in self.asked.iter().zip(self.law.memories_mut()) {
            memory.keep_lags(*asked);
        }
        let (step, inputs) = (ROW * self.columns, self.inputs.each_ref());
        let inputs = inputs.map(|blocks| &blocks[..blocks.len() / POINTS * ROW]);
        let (stroke, rate) = (&self.stroke[..step], &self.rate[..step]);
        commit(&StepVariation { count: self.columns, stroke, rate, inputs, passed: None }, &mut self.law);
    }

    /// Its force, its stored energy and D^alpha x by all columns: at a row of the step, or between two steps.
    pub(crate) fn read(
        &mut self,
        within: bool,
        read: impl FnOnce(&PointVariation, &LawVariation, &mut ObservationVariation),
    ) -> &[Vec<f64>; 3] {
        for (asked, memory) in self.asked.iter().zip(self.law.memories_mut()) {
            memory.keep_lags(*asked);
        }
        self.row.iter_mut().for_each(|row| row.fill(0.0));
        let (step, blocks) = (ROW * self.columns, self.inputs.each_ref());
        let inputs = blocks.map(|blocks| &blocks[..blocks.len() / POINTS * ROW]);
        let (stroke, rate) = (&self.stroke[..step], &self.rate[..step]);
        let around = StepVariation { count: self.columns, stroke, rate, inputs, passed: None };
        let told = PointVariation {
            stroke: &self.stroke[step..],
            rate: &self.rate[step..],
            inputs: blocks.map(|blocks| &blocks[blocks.len() / POINTS * ROW..]),
            step: within.then_some(around),
            passed: None,
        };
        let [force, stored, derivative] = &mut self.row;
        read(&told, &self.law, &mut ObservationVariation { force, stored, derivative, told: &mut Vec::new() });
        &self.row
    }
}
