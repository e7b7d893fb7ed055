//! By which parameters derivatives end in a run that was kept, and where: from its start on, over the places of its maps that are not 0.

use super::step::SolvedStep;
use super::tape::{Entries, Entry, Part};
use crate::system::sensitivity::Lost;

/// Which parameters have changed a number so far.
type Reached = Vec<bool>;

/// What is known at a cut.
#[derive(Debug)]
pub(crate) struct Endings {
    parameters: usize,
    columns: usize,
    /// By number of the state, and by memory.
    state: Vec<Reached>,
    memories: Vec<Reached>,
    lost: Vec<Option<Lost>>,
}

impl Endings {
    /// At t = 0, of a run of so many parameters, columns and memories.
    pub(crate) fn new([parameters, columns, memories, _]: [usize; 4]) -> Self {
        let memories = vec![vec![false; parameters]; memories];
        Self { parameters, columns, state: Vec::new(), memories, lost: vec![None; parameters] }
    }

    /// Goes on over a stretch.
    pub(crate) fn go(&mut self, entries: &Entries) {
        for part in &entries.all {
            match part {
                Part::Cut(entry) => self.over(entry),
                Part::Step(step) => self.through(step),
            }
        }
    }

    /// What has ended, parameter by parameter.
    pub(crate) fn lost(self) -> Vec<Lost> {
        self.lost.into_iter().flatten().collect()
    }

    /// Through the equations of a step whatever changes anything changes all.
    fn through(&mut self, step: &SolvedStep) {
        let Self { parameters, state, memories, .. } = self;
        let mut all = vec![false; *parameters];
        step.plan.each_parameter().for_each(|p| all[p] = true);
        state.iter().chain(&*memories).for_each(|reached| join(&mut all, reached));
        memories.iter_mut().for_each(|memory| memory.clone_from(&all));
        state.clear();
        state.resize(step.plan.numbers(), all);
    }

    fn over(&mut self, entry: &Entry) {
        let Self { parameters, columns, state, memories, lost } = self;
        let mut by: Vec<Reached> = vec![vec![false; *parameters]; *columns];
        (0..*parameters).for_each(|p| by[p][p] = true);
        for (number, column) in &entry.starts.columns {
            if let Some(reached) = state.get(*number as usize) {
                by[*column as usize].clone_from(reached);
            }
        }
        for (reached, own) in memories.iter().zip(&entry.memories) {
            own.told.iter().for_each(|(column, _)| join(&mut by[*column as usize], reached));
        }
        for ended in &entry.lost {
            for (p, _) in by[ended.parameter].iter().enumerate().filter(|(_, reached)| **reached) {
                lost[p].get_or_insert_with(|| Lost { parameter: p, ..ended.clone() });
            }
        }
        for (reached, own) in memories.iter_mut().zip(&entry.memories) {
            own.kept.entries(|_, column| join(reached, &by[column]));
        }
        state.clear();
        entry.state.entries(|row, column| {
            if state.len() <= row {
                state.resize(row + 1, vec![false; *parameters]);
            }
            join(&mut state[row], &by[column]);
        });
    }
}

/// What one or the other has changed.
fn join(own: &mut Reached, other: &Reached) {
    own.iter_mut().zip(other).for_each(|(own, other)| *own |= other);
}
