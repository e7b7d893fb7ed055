//! The derivative of a memory whose own past is told by columns: what a step makes of each number of that past, for adjoints.
//!
//! In place of modes stand columns of ones: one for what the past adds at each lag that is asked for, one for δ of what the modes have seen, for δx(0)
//! and for δD^α x. So the rows of a step are a small matrix, however many modes there are.

use super::columns::Columns;
use super::{MemoryTangent, PastOfStep};
use crate::fractional::history::History;
use std::sync::{Arc, Mutex, PoisonError};

/// Which columns stand for the past of a memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PortColumns {
    /// The first of those of lags, and how many there are.
    pub(crate) lags: [usize; 2],
    /// δ of what the modes have seen of the stroke.
    pub(crate) travelled: usize,
    /// δx(0).
    pub(crate) origin: usize,
    /// δD^α x after the last step.
    pub(crate) now: usize,
}

/// The columns and the lags that were asked for.
#[derive(Debug)]
pub(super) struct Ports {
    columns: PortColumns,
    lags: Mutex<Vec<f64>>,
    kernel: Option<Arc<History>>,
    committed: Option<PastOfStep>,
}

impl Clone for Ports {
    fn clone(&self) -> Self {
        Self {
            columns: self.columns,
            lags: Mutex::new(self.lags()),
            kernel: self.kernel.clone(),
            committed: self.committed.clone(),
        }
    }
}

impl Ports {
    fn lags(&self) -> Vec<f64> {
        self.lags.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Takes in that a step of size `h` is taken into `past`, behind which so many modes are put in front, or dropped.
    pub(super) fn commit(&mut self, past: &History, h: f64, changed: [usize; 2]) {
        let kernel = match self.kernel.take() {
            Some(known) if known.has_kernel_of(past) => known,
            _ => Arc::new(past.without_past()),
        };
        self.committed = Some(PastOfStep::new(kernel.clone(), past, h, changed));
        self.kernel = Some(kernel);
    }

    /// The column of a lag; `None` where there is no room for another one.
    pub(super) fn column(&self, lag: f64) -> Option<usize> {
        let mut lags = self.lags.lock().unwrap_or_else(PoisonError::into_inner);
        let place = lags.iter().position(|known| *known == lag).unwrap_or_else(|| {
            lags.push(lag);
            lags.len() - 1
        });
        let [first, room] = self.columns.lags;
        (place < room).then_some(first + place)
    }
}

impl MemoryTangent {
    /// From now on its past is told by these columns; at t = 0, where its δx(0) was found.
    pub(crate) fn tell_by(&mut self, columns: PortColumns) {
        self.modes = Columns::new(self.parameters, 0);
        self.ports = Some(Ports { columns, lags: Mutex::default(), kernel: None, committed: None });
        self.begin_ports();
    }

    /// The columns are ones again, and no lag was asked for.
    pub(crate) fn begin_ports(&mut self) {
        let Some(Ports { columns, lags, .. }) = &mut self.ports else { return };
        lags.get_mut().unwrap_or_else(PoisonError::into_inner).clear();
        let PortColumns { travelled, origin, now, .. } = *columns;
        let blocks = [(&mut self.travelled, travelled), (&mut self.origin, origin), (&mut self.now, now)];
        for (block, column) in blocks {
            block.fill(0.0);
            block[column] = 1.0;
        }
    }

    /// The lags that were asked for, in the order of their columns.
    pub(crate) fn lags(&self) -> Vec<f64> {
        self.ports.as_ref().map_or_else(Vec::new, Ports::lags)
    }

    /// Forgets all but the first lags that were asked for.
    pub(crate) fn keep_lags(&mut self, count: usize) {
        if let Some(Ports { lags, .. }) = &mut self.ports {
            lags.get_mut().unwrap_or_else(PoisonError::into_inner).truncate(count);
        }
    }

    /// δu_p of the last step, δ of what the modes have seen, δD^α x and δx(0).
    pub(crate) fn known(&self) -> [&[f64]; 7] {
        let [a, b, c, d] = [0, 1, 2, 3].map(|p| self.piece.row(p));
        [a, b, c, d, &self.travelled, &self.now, &self.origin]
    }

    /// What the step that was committed last did to the past.
    pub(crate) fn take_past(&mut self) -> Option<PastOfStep> {
        self.ports.as_mut()?.committed.take()
    }
}
