//! What is kept of a run so that one can go back through it: of each step the linear map of what parameters change.

use crate::fractional::{PastOfStep, SEXTIC, Told};
use crate::system::sensitivity::Lost;

/// Rows of a matrix of which most are 0.
#[derive(Debug, Default)]
pub(super) struct Map {
    /// Which row each is, and where its entries end.
    rows: Vec<(u32, u32)>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl Map {
    /// Takes in row `row`.
    pub(super) fn push(&mut self, row: usize, values: &[f64]) {
        let before = self.values.len();
        for (column, value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            self.columns.push(column as u32);
            self.values.push(*value);
        }
        if self.values.len() > before {
            self.rows.push((row as u32, self.values.len() as u32));
        }
    }

    /// Hands over row and column of all that is not 0.
    pub(super) fn each(&self, mut take: impl FnMut(usize, usize)) {
        let mut from = 0;
        for (row, end) in &self.rows {
            self.columns[from..*end as usize].iter().for_each(|column| take(*row as usize, *column as usize));
            from = *end as usize;
        }
    }

    /// to += transposed·by, in blocks of `count`: what counts for nothing adds nothing, whatever the map has there.
    pub(super) fn add_transposed(&self, by: &[f64], to: &mut [f64], count: usize) {
        let mut from = 0;
        for (row, end) in &self.rows {
            let own = &by[*row as usize * count..][..count];
            let (entries, end) = (from..*end as usize, *end as usize);
            from = end;
            if own.iter().all(|by| *by == 0.0) {
                continue;
            }
            for (column, value) in self.columns[entries.clone()].iter().zip(&self.values[entries]) {
                let sums = &mut to[*column as usize * count..][..count];
                sums.iter_mut().zip(own).filter(|(_, by)| **by != 0.0).for_each(|(sum, by)| *sum += value * by);
            }
        }
    }

    /// Of whatever rests on a row, however little, columns are unknown where the map is.
    pub(super) fn add_unknown(&self, rests: &[bool], to: &mut [f64], count: usize) {
        if self.values.iter().all(|value| !value.is_nan()) {
            return;
        }
        let mut from = 0;
        for (row, end) in &self.rows {
            let (own, entries) = (&rests[*row as usize * count..][..count], from..*end as usize);
            from = *end as usize;
            let unknown = self.columns[entries.clone()].iter().zip(&self.values[entries]);
            for (column, _) in unknown.filter(|(_, value)| value.is_nan()) {
                let sums = to[*column as usize * count..][..count].iter_mut().zip(own);
                sums.filter(|(_, rests)| **rests).for_each(|(sum, _)| *sum = f64::NAN);
            }
        }
    }

    /// Notes which columns it has entries in.
    pub(super) fn mark(&self, used: &mut [bool]) {
        self.columns.iter().for_each(|column| used[*column as usize] = true);
    }

    /// What was taken in, with no room beside it; this one begins anew.
    pub(super) fn take(&mut self) -> Self {
        let taken = Self { rows: self.rows.to_vec(), columns: self.columns.to_vec(), values: self.values.to_vec() };
        self.rows.clear();
        self.columns.clear();
        self.values.clear();
        taken
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.rows[..]) + size_of_val(&self.columns[..]) + size_of_val(&self.values[..])
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

/// A stretch of a run as it is gone back through.
#[derive(Debug, Default)]
pub(crate) struct Entries {
    pub(super) all: Vec<Entry>,
    bytes: usize,
}

impl Entries {
    pub(super) fn push(&mut self, entry: Entry) {
        self.bytes += entry.bytes();
        self.all.push(entry);
    }

    /// Whether derivatives end in it.
    pub(crate) fn has_endings(&self) -> bool {
        self.all.iter().any(|entry| !entry.lost.is_empty())
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
