//! What is kept of a run so that one can go back through it: of each step the linear map of what parameters change.

use super::step::SolvedStep;
use crate::fractional::{PastOfStep, SEXTIC, Told};
use crate::linalg::columns::add;
use crate::system::sensitivity::Lost;

/// Rows of a matrix, each from its first entry to its last; rows of zeros are not kept.
#[derive(Debug, Default)]
pub(super) struct Map {
    rows: Vec<RowOfMap>,
    values: Vec<f64>,
}

#[derive(Debug, Clone, Copy)]
struct RowOfMap {
    row: u32,
    /// The column of its first entry.
    first: u32,
    /// Where its entries end among all.
    end: u32,
}

impl Map {
    /// Takes in row `row`.
    pub(super) fn push(&mut self, row: usize, values: &[f64]) {
        let is_some = |value: &f64| *value != 0.0;
        if let (Some(first), Some(last)) = (values.iter().position(is_some), values.iter().rposition(is_some)) {
            self.values.extend_from_slice(&values[first..=last]);
            self.rows.push(RowOfMap { row: row as u32, first: first as u32, end: self.values.len() as u32 });
        }
    }

    /// Hands over each row: which, the column of its first entry, its entries.
    fn each(&self, mut take: impl FnMut(usize, usize, &[f64])) {
        let mut from = 0;
        for RowOfMap { row, first, end } in &self.rows {
            take(*row as usize, *first as usize, &self.values[from..*end as usize]);
            from = *end as usize;
        }
    }

    /// Hands over row and column of all that is not 0.
    pub(super) fn entries(&self, mut take: impl FnMut(usize, usize)) {
        self.each(|row, first, values| {
            let entries = (first..).zip(values).filter(|(_, value)| **value != 0.0);
            entries.for_each(|(column, _)| take(row, column));
        });
    }

    /// to += transposed·by, in blocks of `count`: what counts for nothing adds nothing, whatever the map has there.
    pub(super) fn add_transposed(&self, by: &[f64], to: &mut [f64], count: usize) {
        self.each(|row, first, values| {
            let own = &by[row * count..][..count];
            let sums = &mut to[first * count..][..values.len() * count];
            match own {
                [by] if *by == 0.0 => {}
                [by] if by.is_finite() => {
                    add(sums, [*by], [values]);
                }
                _ => {
                    let entries = sums.chunks_exact_mut(count.max(1)).zip(values).filter(|(_, value)| **value != 0.0);
                    for (sums, value) in entries {
                        let counted = sums.iter_mut().zip(own).filter(|(_, by)| **by != 0.0);
                        counted.for_each(|(sum, by)| *sum += value * by);
                    }
                }
            }
        });
    }

    /// Of whatever rests on a row, however little, columns are unknown where the map is.
    pub(super) fn add_unknown(&self, rests: &[bool], to: &mut [f64], count: usize) {
        if self.values.iter().all(|value| !value.is_nan()) {
            return;
        }
        self.each(|row, first, values| {
            let own = &rests[row * count..][..count];
            for (column, _) in (first..).zip(values).filter(|(_, value)| value.is_nan()) {
                let sums = to[column * count..][..count].iter_mut().zip(own);
                sums.filter(|(_, rests)| **rests).for_each(|(sum, _)| *sum = f64::NAN);
            }
        });
    }

    /// Notes which columns it has entries in.
    pub(super) fn mark(&self, used: &mut [bool]) {
        self.each(|_, first, values| {
            used[first..].iter_mut().zip(values).for_each(|(used, value)| *used |= *value != 0.0);
        });
    }

    /// What was taken in, with no room beside it; this one begins anew.
    pub(super) fn take(&mut self) -> Self {
        let taken = Self { rows: self.rows.to_vec(), values: self.values.to_vec() };
        self.rows.clear();
        self.values.clear();
        taken
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.rows[..]) + size_of_val(&self.values[..])
    }
}

/// How many numbers the state has where columns of ones were put in place of what changes, and which number has which column.
#[derive(Debug, Clone, Default)]
pub(crate) struct Starts {
    pub(super) numbers: usize,
    pub(super) columns: Vec<(u32, u32)>,
}

/// A row: quantities by all columns, and what their columns of the past of memories stand for, where those are no step's.
#[derive(Debug)]
pub(super) struct Row {
    pub(super) number: usize,
    pub(super) quantities: Map,
    /// Memory, column and what it stands for.
    pub(super) told: Vec<(u32, u32, Told)>,
}

/// From one cut to the next.
#[derive(Debug, Default)]
pub(super) struct Entry {
    pub(super) starts: Starts,
    /// The state behind it by all columns.
    pub(super) state: Map,
    pub(super) memories: Vec<MemoryOfEntry>,
    pub(super) rows: Vec<Row>,
    /// What ended in it, column by column.
    pub(super) lost: Vec<Lost>,
}

/// What a memory does from one cut to the next.
#[derive(Debug, Default)]
pub(super) struct MemoryOfEntry {
    /// The step that was taken into its past.
    pub(super) past: Option<PastOfStep>,
    /// The coefficients of its piece, and by how much its end moves, by all columns.
    pub(super) kept: Map,
    /// Columns, and what they stand for.
    pub(super) told: Vec<(u32, Told)>,
}

/// Rows of [`MemoryOfEntry::kept`].
pub(super) const PIECES: usize = SEXTIC;

/// What a memory does in a step that is gone back through by its own equations.
#[derive(Debug)]
pub(super) struct MemoryOfStep {
    /// The step as it was taken into its past.
    pub(super) past: Option<PastOfStep>,
    /// How many coefficients its piece has.
    pub(super) rows: usize,
    /// Columns of its law, and what they stand for.
    pub(super) told: Vec<(usize, Told)>,
}

impl MemoryOfStep {
    pub(super) fn bytes(&self) -> usize {
        let told = |(_, told): &(usize, Told)| size_of::<(usize, Told)>() + told.bytes();
        let past = self.past.as_ref().map_or(0, PastOfStep::bytes);
        size_of::<Self>() + past + self.told.iter().map(told).sum::<usize>()
    }
}

/// A part of a stretch.
#[derive(Debug)]
pub(super) enum Part {
    /// From one cut to the next, by all columns.
    Cut(Box<Entry>),
    /// A step by its own equations.
    Step(Box<SolvedStep>),
}

/// A stretch of a run as it is gone back through.
#[derive(Debug, Default)]
pub(crate) struct Entries {
    pub(super) all: Vec<Part>,
    bytes: usize,
}

impl Entries {
    pub(super) fn push(&mut self, entry: Entry) {
        self.bytes += entry.bytes();
        self.all.push(Part::Cut(Box::new(entry)));
    }

    pub(super) fn push_step(&mut self, step: Box<SolvedStep>) {
        self.bytes += step.bytes();
        self.all.push(Part::Step(step));
    }

    /// Whether derivatives end in it.
    pub(crate) fn has_endings(&self) -> bool {
        self.all.iter().any(|part| matches!(part, Part::Cut(entry) if !entry.lost.is_empty()))
    }

    /// How much they hold, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }
}

impl Entry {
    fn bytes(&self) -> usize {
        let told = |told: &Told| size_of::<(u32, u32, Told)>() + told.bytes();
        let memory = |own: &MemoryOfEntry| {
            size_of::<MemoryOfEntry>()
                + own.kept.bytes()
                + own.past.as_ref().map_or(0, PastOfStep::bytes)
                + own.told.iter().map(|(_, own)| told(own)).sum::<usize>()
        };
        let row = |row: &Row| {
            size_of::<Row>() + row.quantities.bytes() + row.told.iter().map(|(_, _, own)| told(own)).sum::<usize>()
        };
        size_of::<Self>()
            + size_of_val(&self.starts.columns[..])
            + self.state.bytes()
            + self.memories.iter().map(memory).sum::<usize>()
            + self.rows.iter().map(row).sum::<usize>()
    }
}
