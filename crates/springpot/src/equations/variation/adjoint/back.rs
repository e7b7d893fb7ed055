//! Back over what was kept.
//!
//! With s̄ = ∂m/∂s of the state s behind a cut, and y = R c, s = S c of the columns c in front of it: c̄ = Sᵀ s̄ + Σ Rᵀ ∂m/∂y. Those of parameters add
//! up; those of ones are ∂m/∂s of the state at the cut before.

use super::tape::{Entries, Entry, PIECES, Part};
use super::through::Through;
use crate::fractional::{MemoryAdjoint, OfStep};
use crate::system::sensitivity::Share;

/// How much a quantity of a row counts: row, quantity, number, slope.
type Seed = (usize, usize, usize, f64);

/// ∂m/∂ all that is known at a cut, for M numbers m side by side.
#[derive(Debug)]
pub(crate) struct Backwards {
    /// M.
    pub(super) count: usize,
    parameters: usize,
    /// Number of columns, of quantities of a row.
    columns: usize,
    quantities: usize,
    seeds: Vec<Seed>,
    pub(super) state: Vec<f64>,
    pub(super) memories: Vec<MemoryAdjoint>,
    pub(super) sum: Vec<f64>,
    /// Which numbers count rows behind the cut.
    pub(super) counts: Vec<bool>,
    /// Room for what counts of columns: of all, and of a row.
    by: Vec<f64>,
    of_row: Vec<f64>,
    /// Room to go through steps in.
    pub(super) room: Through,
}

impl Backwards {
    /// At the end of a run of so many parameters, columns and memories and so many quantities of a row, for numbers that change by these shares.
    pub(crate) fn new(shares: &[Vec<Share>], [parameters, columns, memories, quantities]: [usize; 4]) -> Self {
        let count = shares.len();
        let mut seeds: Vec<Seed> = Vec::new();
        for (m, own) in shares.iter().enumerate() {
            seeds.extend(own.iter().map(|share| (share.row, share.quantity, m, share.slope)));
        }
        seeds.sort_by_key(|(row, ..)| *row);
        Self {
            count,
            parameters,
            columns,
            quantities,
            seeds,
            state: Vec::new(),
            memories: (0..memories).map(|_| MemoryAdjoint::new(count)).collect(),
            sum: vec![0.0; parameters * count],
            counts: vec![false; count],
            by: Vec::new(),
            of_row: Vec::new(),
            room: Through::default(),
        }
    }

    /// Goes back over a stretch.
    pub(crate) fn go(&mut self, entries: &Entries) {
        for part in entries.all.iter().rev() {
            match part {
                Part::Cut(entry) => self.over(entry),
                Part::Step(step) => self.through(step),
            }
        }
    }

    /// The derivatives of each number by all parameters.
    pub(crate) fn gradients(self) -> Vec<Vec<f64>> {
        let Self { count, parameters, sum, .. } = self;
        (0..count).map(|m| (0..parameters).map(|p| sum[p * count + m]).collect()).collect()
    }

    /// What counts of the quantities of a row, and whether it rests on them; `None` where nothing does.
    pub(super) fn counted(&self, row: usize) -> Option<(Vec<f64>, Vec<bool>)> {
        let own = &self.seeds[self.seeds.partition_point(|(at, ..)| *at < row)..];
        let own = &own[..own.partition_point(|(at, ..)| *at == row)];
        let mut by = vec![0.0; self.quantities * self.count];
        let mut rests = vec![false; by.len()];
        for (_, quantity, m, slope) in own {
            let place = quantity * self.count + m;
            (by[place], rests[place]) = (by[place] + slope, true);
        }
        (!own.is_empty()).then_some((by, rests))
    }

    fn over(&mut self, entry: &Entry) {
        let count = self.count;
        let (mut by, mut of_row) = (std::mem::take(&mut self.by), std::mem::take(&mut self.of_row));
        by.clear();
        by.resize(self.columns * count, 0.0);
        // What columns of the past that are a row's own count, told once the step was gone back over.
        let mut told_by_rows = Vec::new();
        let mut counts = self.counts.clone();
        for row in &entry.rows {
            let Some((seeds, rests)) = self.counted(row.number) else { continue };
            for (m, counts) in counts.iter_mut().enumerate() {
                *counts |= rests.iter().skip(m).step_by(count).any(|rests| *rests);
            }
            of_row.clear();
            of_row.resize(self.columns * count, 0.0);
            row.quantities.add_transposed(&seeds, &mut of_row, count);
            row.quantities.add_unknown(&rests, &mut of_row, count);
            for (memory, column, told) in &row.told {
                let own = &mut of_row[*column as usize * count..][..count];
                told_by_rows.push((*memory as usize, told, own.to_vec()));
                own.fill(0.0);
            }
            by.iter_mut().zip(&of_row).for_each(|(sum, own)| *sum += own);
        }
        for (memory, own) in self.memories.iter_mut().zip(&entry.memories) {
            let Some(past) = &own.past else { continue };
            let OfStep { piece, moved } = memory.take_back(past);
            let mut kept = piece.concat();
            kept.resize(PIECES * count, 0.0);
            kept.extend(moved.unwrap_or_else(|| vec![0.0; count]));
            own.kept.add_transposed(&kept, &mut by, count);
        }
        entry.state.add_transposed(&self.state, &mut by, count);
        for ended in &entry.lost {
            let own = by[ended.parameter * count..][..count].iter_mut().zip(&self.counts);
            own.filter(|(_, counts)| **counts).for_each(|(by, _)| *by = f64::NAN);
        }
        self.sum.iter_mut().zip(&by).for_each(|(sum, by)| *sum += by);
        for (memory, own) in self.memories.iter_mut().zip(&entry.memories) {
            for (column, told) in &own.told {
                memory.tell(own.past.as_ref(), told, &by[*column as usize * count..][..count]);
            }
        }
        for (memory, told, by) in told_by_rows {
            self.memories[memory].tell(entry.memories[memory].past.as_ref(), told, &by);
        }
        self.state.clear();
        self.state.resize(entry.starts.numbers * count, 0.0);
        for (number, column) in &entry.starts.columns {
            let (number, column) = (*number as usize * count, *column as usize * count);
            self.state[number..number + count].copy_from_slice(&by[column..column + count]);
        }
        (self.by, self.of_row, self.counts) = (by, of_row, counts);
    }
}
