//! Back through a run: gradients of numbers that are sums of its rows, by any number of parameters at once.
//!
//! What parameters change goes from step to step by linear maps. They are kept while the run goes on ([`Recording`]), and gone through in the other
//! order, transposed ([`Tape::gradients`]): one pass for each number, however many parameters there are.

mod back;
mod begin;
mod record;
mod tape;

use super::Variation;
use crate::law::variation::probe::LawProbe;
use crate::observe::Quantity;
use tape::{Begin, Entries, Layout, Row, Step};

/// Most that a tape may hold, bytes.
const MOST: usize = 1 << 30;

/// A run that is being recorded.
#[derive(Debug)]
pub(crate) struct Recording {
    /// Slopes at the nodes, with what parameters change where the motion stays.
    pub(crate) variation: Variation,
    /// What rows tell, by ones in place of parameters: those of the run first, then q, v and a, then three numbers of each element.
    rows: Variation,
    laws: Vec<LawProbe>,
    quantities: Vec<Quantity>,
    /// The step at hand.
    step: Option<Box<Step>>,
    tape: Tape,
}

/// A run to be gone back through, step by step.
#[derive(Debug)]
pub struct Tape {
    /// Number of parameters.
    count: usize,
    /// Number of velocities of the extended robot.
    nv: usize,
    /// Number of quantities of a row.
    quantities: usize,
    begin: Begin,
    layouts: Vec<Layout>,
    entries: Entries,
    /// What parameters change of the rest of elements: element, parameter, by how much.
    rests: Vec<(usize, usize, f64)>,
    /// What they change of the start: velocity, parameter, by how much of q and of v.
    starts: Vec<(usize, usize, [f64; 2])>,
}

/// How much a quantity at a row counts in a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Which row, from 0.
    pub row: usize,
    /// Which of [`crate::sensitivity::Sensitivity::adjoint`].
    pub quantity: usize,
    /// ∂(number)/∂(its value there).
    pub slope: f64,
}

impl Tape {
    /// How much it holds, bytes.
    pub fn bytes(&self) -> usize {
        self.entries.bytes()
    }
}

impl Row {
    fn of(number: usize, theta: f64) -> Self {
        Self { number, theta, quantities: Default::default(), elements: Vec::new() }
    }
}
