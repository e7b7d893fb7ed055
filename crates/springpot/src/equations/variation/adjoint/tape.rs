//! What is kept of a run so that one can go back through it: of each step the linear map of what parameters change.

use crate::collocation::STAGES;
use crate::fractional::{PastOfStep, PortColumns};

/// Entries of a matrix that are not 0.
#[derive(Debug, Default)]
pub(super) struct Sparse(Vec<(u32, u32, f64)>);

impl Sparse {
    /// Takes in row `row`.
    pub(super) fn push_row(&mut self, row: usize, values: &[f64]) {
        let entries = values.iter().enumerate().filter(|(_, value)| **value != 0.0);
        self.0.extend(entries.map(|(column, value)| (row as u32, column as u32, *value)));
    }

    pub(super) fn push(&mut self, row: usize, column: usize, value: f64) {
        self.0.push((row as u32, column as u32, value));
    }

    /// to += factor·(transposed) by, in blocks of `count`.
    pub(super) fn add_transposed(&self, factor: f64, by: &[f64], to: &mut [f64], count: usize) {
        for (row, column, value) in &self.0 {
            let (from, into) = (*row as usize * count, *column as usize * count);
            let scaled = factor * value;
            to[into..into + count].iter_mut().zip(&by[from..from + count]).for_each(|(to, by)| *to += scaled * by);
        }
    }

    fn bytes(&self) -> usize {
        self.0.capacity() * size_of::<(u32, u32, f64)>()
    }
}

/// A run as it is gone back through.
#[derive(Debug, Default)]
pub(super) struct Entries {
    all: Vec<Entry>,
    bytes: usize,
}

#[derive(Debug)]
pub(super) enum Entry {
    /// The accelerations where a step starts were worked out anew.
    Start(Start),
    /// A row between two steps.
    Row(Row),
    Step(Box<Step>),
}

impl Entries {
    pub(super) fn push(&mut self, entry: Entry) {
        self.bytes += entry.bytes();
        self.all.push(entry);
    }

    pub(super) fn bytes(&self) -> usize {
        self.bytes
    }

    pub(super) fn into_all(self) -> impl Iterator<Item = Entry> {
        self.all.into_iter()
    }

    /// From the last one on.
    pub(super) fn backwards(&self) -> impl Iterator<Item = &Entry> {
        self.all.iter().rev()
    }
}

/// Slopes of the equations of motion: of the velocities that are free by all.
#[derive(Debug, Default)]
pub(super) struct Slopes {
    pub(super) by_q: Vec<f64>,
    pub(super) by_v: Vec<f64>,
    /// By parameters.
    pub(super) explicit: Sparse,
    /// ∂y/∂q and ∂y'/∂q of every element.
    pub(super) gradients: Vec<[Vec<f64>; 2]>,
}

/// M δa = −(…) where a step starts.
#[derive(Debug)]
pub(super) struct Start {
    pub(super) free: Vec<usize>,
    /// M, transposed.
    pub(super) mass: Vec<f64>,
    pub(super) slopes: Slopes,
    /// Forces of the elements by the columns of their laws.
    pub(super) forces: Vec<Sparse>,
}

/// A row, in the step that it is told with or between two.
#[derive(Debug)]
pub(super) struct Row {
    pub(super) number: usize,
    pub(super) theta: f64,
    /// Quantities by q, v and a of the robot, by force, stored energy and D^alpha x of each element, and by parameters.
    pub(super) quantities: Sparse,
    /// What the elements make of it; none where no quantity is theirs.
    pub(super) elements: Vec<RowOfElement>,
}

#[derive(Debug)]
pub(super) struct RowOfElement {
    pub(super) gradients: [Vec<f64>; 2],
    /// Force, stored energy and D^alpha x by the columns of the law.
    pub(super) map: Sparse,
    /// Lags of each memory.
    pub(super) lags: Vec<Vec<f64>>,
}

/// A step that was taken into the past.
#[derive(Debug)]
pub(super) struct Step {
    pub(super) h: f64,
    pub(super) free: Vec<usize>,
    /// Of all stages, transposed.
    pub(super) matrix: Vec<f64>,
    pub(super) stages: [Slopes; STAGES],
    pub(super) elements: Vec<StepOfElement>,
    pub(super) rows: Vec<Row>,
}

#[derive(Debug, Default)]
pub(super) struct StepOfElement {
    /// ∂F_i/∂x_m and ∂F_i/∂x'_m.
    pub(super) response: [[[f64; STAGES]; STAGES]; 2],
    /// Forces at the nodes by the columns of the law.
    pub(super) forces: Sparse,
    /// What is kept behind the step by the same columns: [`KEPT`] rows of each memory, then the inner variables.
    pub(super) kept: Sparse,
    pub(super) lags: Vec<Vec<f64>>,
    pub(super) pasts: Vec<Option<PastOfStep>>,
}

/// Rows that a memory keeps: four coefficients of its piece, what its modes have seen, D^alpha x.
pub(super) const KEPT: usize = 6;

/// What begins at t = 0.
#[derive(Debug, Default)]
pub(super) struct Begin {
    /// Of every element.
    pub(super) gradients: Vec<[Vec<f64>; 2]>,
    /// δx(0) of each memory, then inner variables, by the columns of the law.
    pub(super) kept: Vec<Sparse>,
}

/// Which column of a law is what.
#[derive(Debug)]
pub(super) struct Layout {
    pub(super) columns: usize,
    pub(super) ports: Vec<PortColumns>,
    /// Columns of the inner variables.
    pub(super) variables: Vec<usize>,
    /// Column and parameter.
    pub(super) parameters: Vec<(usize, usize)>,
}

fn of_numbers<'n>(all: impl IntoIterator<Item = &'n Vec<f64>>) -> usize {
    all.into_iter().map(|numbers| size_of_val(&numbers[..])).sum()
}

impl Slopes {
    fn bytes(&self) -> usize {
        of_numbers([&self.by_q, &self.by_v]) + self.explicit.bytes() + of_numbers(self.gradients.iter().flatten())
    }
}

impl Row {
    fn bytes(&self) -> usize {
        let own = |own: &RowOfElement| of_numbers(own.gradients.iter().chain(&own.lags)) + own.map.bytes();
        size_of::<Self>()
            + self.quantities.bytes()
            + self.elements.iter().map(|element| size_of::<RowOfElement>() + own(element)).sum::<usize>()
    }
}

impl Entry {
    fn bytes(&self) -> usize {
        size_of::<Self>()
            + match self {
                Self::Start(Start { mass, slopes, forces, .. }) => {
                    of_numbers([mass]) + slopes.bytes() + forces.iter().map(Sparse::bytes).sum::<usize>()
                }
                Self::Row(row) => row.bytes(),
                Self::Step(step) => {
                    let element = |own: &StepOfElement| {
                        size_of::<StepOfElement>()
                            + own.forces.bytes()
                            + own.kept.bytes()
                            + of_numbers(&own.lags)
                            + size_of_val(&own.pasts[..])
                    };
                    size_of::<Step>()
                        + of_numbers([&step.matrix])
                        + step.stages.iter().map(Slopes::bytes).sum::<usize>()
                        + step.elements.iter().map(element).sum::<usize>()
                        + step.rows.iter().map(Row::bytes).sum::<usize>()
                }
            }
    }
}
