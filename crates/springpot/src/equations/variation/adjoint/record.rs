//! What is kept of each step, while the run goes on.

use super::room::Columns;
use super::step::{POINTS, Plan};
use super::tape::{Entries, Entry, Map, MemoryOfEntry, PIECES, Row, Starts};
use crate::equations::assembly::Equations;
use crate::equations::control::{OfSamples, Sampler};
use crate::equations::node::Node;
use crate::equations::variation::{NodeVariation, Variation};
use crate::observe::{Quantity, Snapshot};
use crate::system::System;
use crate::system::sensitivity::{Sensitivity, SensitivityError};
use std::sync::{Arc, OnceLock};

/// A run that is being recorded, beside the variation of it by [`Self::columns`].
#[derive(Debug)]
pub(crate) struct Recording {
    columns: Columns,
    quantities: Vec<Quantity>,
    /// Whether anything changed the state since the last cut, and a step was taken into the past.
    is_due: bool,
    took_step: bool,
    starts: Starts,
    /// What steps have in common that are gone back through by their own equations, where there are such.
    plan: OnceLock<Option<Arc<Plan>>>,
    has_events: bool,
    rows: Vec<Row>,
    entries: Entries,
    /// Room to work in: a map that is made, and which columns something is made of.
    map: Map,
    used: Vec<bool>,
}

fn refuse<T>(what: impl Into<String>) -> Result<T, SensitivityError> {
    Err(SensitivityError::Backwards { what: what.into() })
}

impl Recording {
    /// Of a run of which rows of these `quantities` are to be known: with what it is differentiated by. What samples keep are so many numbers; steps may be of one size.
    pub(crate) fn of(
        system: &System,
        by: &Sensitivity,
        quantities: &[Quantity],
        equations: &Equations,
        (samples, has_fixed_steps): (usize, bool),
    ) -> (Self, Arc<Sensitivity>) {
        let columns = Columns::of(system, by, quantities, equations, (samples, has_fixed_steps));
        let ones = columns.sensitivity(by);
        let own = Self {
            columns,
            quantities: quantities.to_vec(),
            is_due: true,
            took_step: false,
            starts: Starts::default(),
            plan: OnceLock::new(),
            has_events: !system.events.is_empty(),
            rows: Vec::new(),
            entries: Entries::default(),
            map: Map::default(),
            used: Vec::new(),
        };
        (own, ones)
    }

    /// From now on columns tell the past of the memories.
    pub(crate) fn attach(&self, variation: &mut Variation) {
        variation.memories_mut().zip(&self.columns.ports).for_each(|(memory, ports)| memory.tell_by(*ports));
    }

    /// Takes over what was kept of the same start: rows of t = 0 are told already.
    pub(crate) fn take_start(&mut self, mut earlier: Self, variation: &mut Variation) {
        earlier.finish(variation);
        self.entries = earlier.entries;
    }

    /// Goes on where columns of ones stand for the state already.
    pub(crate) fn go_on(&mut self, starts: Starts) {
        (self.starts, self.is_due) = (starts, false);
    }

    /// Where the columns of ones stand since the last cut.
    pub(crate) fn starts(&self) -> &Starts {
        &self.starts
    }

    /// How much it holds, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.entries.bytes()
    }

    /// Whether rows were kept since the last cut.
    pub(crate) fn has_rows(&self) -> bool {
        !self.rows.is_empty()
    }

    /// What was kept up to the last cut.
    pub(crate) fn take_entries(&mut self) -> Entries {
        std::mem::take(&mut self.entries)
    }

    /// Numbers of parameters, of columns, of memories and of quantities of a row.
    pub(crate) fn sizes(&self) -> [usize; 4] {
        let Columns { parameters, ports, all, .. } = &self.columns;
        [*parameters, *all, ports.len(), self.quantities.len()]
    }

    /// Another step is about to be tried.
    pub(crate) fn begin_step(&mut self, variation: &mut Variation) {
        variation.memories_mut().for_each(|memory| memory.forget_asked());
    }

    /// A step was taken into the past, or something was crossed.
    pub(crate) fn note(&mut self, step: bool) {
        self.is_due = true;
        self.took_step |= step;
    }

    /// Whether a step was taken into the past since the last cut: sums over what is behind it are not told by columns.
    pub(crate) fn took_step(&self) -> bool {
        self.took_step
    }

    /// Whether the step at hand can be gone back through by its own equations: nothing changed since the last cut, and nothing but motion and memories
    /// goes on through the step.
    pub(crate) fn takes_whole(&self, variation: &Variation, equations: &Equations) -> bool {
        let is_cut = !self.is_due && self.rows.is_empty();
        if !is_cut || self.has_events || !equations.is_smooth() || !variation.goes_on(equations) {
            return false;
        }
        let parameters = self.columns.parameters;
        let plan = || variation.plan(equations, &self.quantities, parameters).map(Arc::new);
        let numbers = self.plan.get_or_init(plan).as_ref().map_or(0, |plan| plan.numbers());
        numbers > 0 && self.starts.columns.iter().all(|(number, _)| (*number as usize) < numbers)
    }

    /// Keeps such a step, of size h, which starts and has its stages there; `fill` writes J into zeros, of the stages as they were seen. `false` where that
    /// is singular.
    pub(crate) fn keep_step(
        &self,
        variation: &mut Variation,
        equations: &Equations,
        size: (f64, [Node; POINTS]),
        fill: impl FnOnce(&Variation, &[NodeVariation], &mut [f64]),
    ) -> bool {
        let Some(plan) = self.plan.get().and_then(Option::as_ref) else { return false };
        variation.keep_step(equations, (plan, &self.starts), size, fill)
    }

    /// Notes row `number` at θ of such a step; `false` where it tells more than the motion.
    pub(crate) fn note_row(&self, variation: &mut Variation, number: usize, theta: f64) -> bool {
        let is_noted = variation.is_unsolved() && self.quantities.iter().all(|of| variation.is_motion(*of));
        if is_noted {
            variation.note_row(number, theta);
        }
        is_noted
    }

    /// Takes such a step into the past: columns of ones stand for the state behind it.
    pub(crate) fn take_step(&mut self, variation: &mut Variation, equations: &Equations) {
        let Some(step) = variation.commit_step(equations, self.columns.parameters) else { return };
        self.starts.columns.clear();
        let numbers = 0..step.plan.numbers() as u32;
        self.starts.columns.extend(numbers.map(|number| (number, self.columns.parameters as u32 + number)));
        self.entries.push_step(step);
    }

    /// Cuts what was taken into the past off, where anything was: columns of ones stand for the state from here on.
    ///
    /// # Errors
    /// More numbers than there are columns.
    pub(crate) fn cut(
        &mut self,
        variation: &mut Variation,
        equations: &Equations,
        mut sampler: Option<&mut Sampler>,
    ) -> Result<(), SensitivityError> {
        if !std::mem::take(&mut self.is_due) {
            return Ok(());
        }
        self.took_step = false;
        if variation.leaves_branches() {
            return refuse("branches of control that are left but not yet crossed");
        }
        let (state, mut starts) = (&mut self.map, Starts::default());
        starts.columns.reserve_exact(self.columns.units);
        let Columns { parameters, units, .. } = self.columns;
        let mut take = |block: &mut [f64]| {
            if block.iter().any(|change| *change != 0.0) {
                let column = parameters + starts.columns.len();
                state.push(starts.numbers, block);
                block.fill(0.0);
                if column < parameters + units {
                    block[column] = 1.0;
                }
                starts.columns.push((starts.numbers as u32, column as u32));
            }
            starts.numbers += 1;
        };
        variation.each_block(&mut take);
        if let Some(sampler) = &mut sampler {
            sampler.each_block(self.columns.all, &mut take);
        }
        if starts.columns.len() > units {
            return refuse("a state of more numbers than were expected");
        }
        let state = self.map.take();
        self.close(variation, state);
        self.starts = starts;
        variation.hold(sampler.and_then(|sampler| sampler.held_changes()));
        variation.stand_again(equations);
        Ok(())
    }

    /// What was not yet cut off, at the end of the run.
    pub(crate) fn finish(&mut self, variation: &mut Variation) {
        self.close(variation, Map::default());
    }

    fn close(&mut self, variation: &mut Variation, state: Map) {
        let lost = variation.take_lost();
        let rows = std::mem::take(&mut self.rows);
        let Self { map, used, columns, .. } = self;
        used.clear();
        used.resize(columns.all, false);
        state.mark(used);
        rows.iter().for_each(|row| row.quantities.mark(used));
        let mut memories = Vec::with_capacity(columns.ports.len());
        for memory in variation.memories_mut() {
            let mut own = MemoryOfEntry::default();
            let told = memory.split_asked([0; 2]);
            own.past = memory.take_past();
            if let Some(past) = &own.past {
                memory.pieces().enumerate().for_each(|(p, row)| map.push(p, row));
                memory.moved().into_iter().filter(|_| past.has_moved()).for_each(|moved| map.push(PIECES, moved));
            }
            own.kept = map.take();
            own.kept.mark(used);
            own.told = told.into_iter().map(|(column, told)| (column as u32, told)).collect();
            memories.push(own);
        }
        for memory in &mut memories {
            memory.told.retain(|(column, _)| used[*column as usize]);
        }
        let starts = std::mem::take(&mut self.starts);
        self.entries.push(Entry { starts, state, memories, rows, lost });
    }

    /// A row is about to be read: whether its quantities are all of the motion, and what memories were asked for before.
    pub(crate) fn begin_row(&self, variation: &mut Variation) -> (bool, Vec<[usize; 2]>) {
        let is_of_motion = self.quantities.iter().all(|of| variation.is_motion(*of));
        (is_of_motion, variation.memories_mut().map(|memory| memory.count_asked()).collect())
    }

    /// Keeps row `number`, where the run is at `snapshot`: what changes there was worked out.
    ///
    /// # Errors
    /// What has no derivative.
    pub(crate) fn keep_row(
        &mut self,
        number: usize,
        snapshot: &Snapshot,
        variation: &mut Variation,
        before: Vec<[usize; 2]>,
    ) -> Result<(), SensitivityError> {
        let mut row = Row { number, quantities: Map::default(), told: Vec::new() };
        let Self { map, used, .. } = self;
        for (k, of) in self.quantities.iter().enumerate() {
            if snapshot.value(*of).is_nan() {
                continue;
            }
            match variation.values(*of, snapshot) {
                Some(mut values) => {
                    // What is infinite is as unknown as what is lost.
                    values.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = f64::NAN);
                    map.push(k, &values);
                }
                None => return refuse("a column that has no derivative"),
            }
        }
        row.quantities = map.take();
        used.clear();
        used.resize(self.columns.all, false);
        row.quantities.mark(used);
        for (m, (memory, before)) in variation.memories_mut().zip(before).enumerate() {
            let own = memory.split_asked(before).into_iter().filter(|(column, _)| used[*column]);
            row.told.extend(own.map(|(column, told)| (m as u32, column as u32, told)));
        }
        self.rows.push(row);
        Ok(())
    }
}
