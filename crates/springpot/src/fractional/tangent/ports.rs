//! The derivative of a memory whose own past is told by columns: what a step makes of each number of that past, for adjoints.
//!
//! In place of modes stand columns of ones: one for what the past adds at each lag that is asked for, one for each sum over modes that an energy asks
//! for. So the rows of a step are a small matrix, however many modes there are.

use super::columns::Columns;
use super::{MemoryTangent, PastOfStep};
use crate::fractional::history::History;
use std::sync::{Arc, Mutex, PoisonError};

/// Which columns stand for the past of a memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PortColumns {
    /// The first of those of lags, and how many there are.
    pub(crate) lags: [usize; 2],
    /// The same of those of energies.
    pub(crate) sums: [usize; 2],
}

/// Σ_k g_k δz_k + Σ_p f_p δu_p of the modes and of the last piece.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Weights {
    pub(super) modes: Vec<f64>,
    pub(super) piece: Vec<f64>,
}

/// What a column stands for: D^alpha x of the past at a lag, or a sum over its modes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Told {
    Lag(f64),
    Sum(Weights),
}

impl Told {
    /// How much it holds beside itself, bytes.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Lag(_) => 0,
            Self::Sum(weights) => weights.bytes(),
        }
    }
}

/// Which sum it is, at a lag of a step of some size.
type Key = (u8, [u64; 2]);

/// Sums: of what is stored, of what is dissipated, of a mean.
pub(super) const STORED: u8 = 0;
pub(super) const DISSIPATED: u8 = 1;
pub(super) const MEAN: u8 = 2;

pub(super) fn key(which: u8, lag: f64, h: f64) -> Key {
    (which, [lag.to_bits(), h.to_bits()])
}

#[derive(Debug, Clone, Default)]
struct Asked {
    lags: Vec<f64>,
    sums: Vec<(Key, Weights)>,
}

/// The columns and what was asked for.
#[derive(Debug)]
pub(super) struct Ports {
    columns: PortColumns,
    asked: Mutex<Asked>,
    kernel: Option<Arc<History>>,
    committed: Option<PastOfStep>,
    /// By how much the end of the last step moves.
    pub(super) moved: Vec<f64>,
}

impl Clone for Ports {
    fn clone(&self) -> Self {
        Self {
            columns: self.columns,
            asked: Mutex::new(self.asked.lock().unwrap_or_else(PoisonError::into_inner).clone()),
            kernel: self.kernel.clone(),
            committed: self.committed.clone(),
            moved: self.moved.clone(),
        }
    }
}

impl Ports {
    fn asked(&mut self) -> &mut Asked {
        self.asked.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes in that a step of size `h`, whose piece has so many coefficients (behind those of the piece before), is taken into `past`, behind which so many modes are put in front,
    /// or dropped.
    pub(super) fn commit(&mut self, past: &History, h: f64, coefficients: [usize; 2], changed: [usize; 2]) {
        let kernel = match self.kernel.take() {
            Some(known) if known.has_kernel_of(past) => known,
            _ => Arc::new(past.without_past()),
        };
        self.committed = Some(PastOfStep::new(kernel.clone(), past, (h, coefficients), changed));
        self.kernel = Some(kernel);
    }

    /// The end of the step that was committed moves by `delta_h`: modes behind it by these shares of that, and the coefficients of its piece.
    pub(super) fn move_end(&mut self, modes: Vec<f64>, piece: Vec<f64>, delta_h: &[f64]) {
        if let Some(committed) = &mut self.committed {
            committed.moved = Some(Weights { modes, piece });
            self.moved.copy_from_slice(delta_h);
        }
    }

    /// The column of a lag; `None` where there is no room for another one.
    pub(super) fn column(&self, lag: f64) -> Option<usize> {
        let Asked { lags, .. } = &mut *self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        let place = lags.iter().position(|known| *known == lag).unwrap_or_else(|| {
            lags.push(lag);
            lags.len() - 1
        });
        let [first, room] = self.columns.lags;
        (place < room).then_some(first + place)
    }

    /// Whether nobody asks for energies.
    pub(super) fn has_no_sums(&self) -> bool {
        self.columns.sums[1] == 0
    }

    /// The column of a sum; `None` where there is no room for another one.
    pub(super) fn column_of_sum(&self, key: Key, weights: impl FnOnce() -> Weights) -> Option<usize> {
        let [first, room] = self.columns.sums;
        let Asked { sums, .. } = &mut *self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        let place = sums.iter().position(|(known, _)| *known == key).or_else(|| {
            (sums.len() < room).then(|| {
                sums.push((key, weights()));
                sums.len() - 1
            })
        });
        place.map(|place| first + place)
    }
}

impl MemoryTangent {
    /// From now on its past is told by these columns.
    pub(crate) fn tell_by(&mut self, columns: PortColumns) {
        self.modes = Columns::new(self.parameters, 0);
        let moved = vec![0.0; self.parameters];
        self.ports = Some(Ports { columns, asked: Mutex::default(), kernel: None, committed: None, moved });
    }

    /// The same memory by other columns, of which each moves its order as one of these does or not at all, and whose past is told by `ports`.
    pub(crate) fn narrowed(&self, of: &[Option<usize>], ports: PortColumns) -> Self {
        let zeros = || vec![0.0; of.len()];
        let mut own = Self {
            parameters: of.len(),
            alpha: of.iter().map(|p| p.map_or(0.0, |p| self.alpha[p])).collect(),
            origin: zeros(),
            travelled: zeros(),
            now: zeros(),
            told: None,
            jumps: Vec::new(),
            modes: Columns::new(of.len(), 0),
            piece: Columns::new(of.len(), self.piece.rows()),
            by_order: None,
            is_recalled: self.is_recalled,
            ports: None,
        };
        own.tell_by(ports);
        own
    }

    /// Hands over to the same memory by other columns what is the same for all of them: where the order moves, and how wide the last piece is.
    pub(crate) fn lend(&mut self, other: &mut Self) {
        std::mem::swap(&mut self.by_order, &mut other.by_order);
        if other.piece.rows() != self.piece.rows() {
            other.piece = Columns::new(other.parameters, self.piece.rows());
        }
    }

    /// Nothing was asked for.
    pub(crate) fn forget_asked(&mut self) {
        if let Some(ports) = &mut self.ports {
            *ports.asked() = Asked::default();
        }
    }

    /// How many lags and sums were asked for.
    pub(crate) fn count_asked(&mut self) -> [usize; 2] {
        self.ports.as_mut().map_or([0; 2], |ports| {
            let Asked { lags, sums } = ports.asked();
            [lags.len(), sums.len()]
        })
    }

    /// Forgets what was asked for but the first lags and sums: gives the rest, each with its column.
    pub(crate) fn split_asked(&mut self, [lags, sums]: [usize; 2]) -> Vec<(usize, Told)> {
        let Some(ports) = &mut self.ports else { return Vec::new() };
        let PortColumns { lags: [of_lags, room], sums: [of_sums, _] } = ports.columns;
        let asked = ports.asked();
        let lags_left = asked.lags.drain(lags.min(asked.lags.len())..).zip(of_lags + lags..of_lags + room);
        let mut all: Vec<_> = lags_left.map(|(lag, column)| (column, Told::Lag(lag))).collect();
        let sums_left = asked.sums.drain(sums.min(asked.sums.len())..).zip(of_sums + sums..);
        all.extend(sums_left.map(|((_, weights), column)| (column, Told::Sum(weights))));
        all
    }

    /// Blocks of what it keeps beside its modes: of what these have seen, of D^α x, of x(0).
    pub(crate) fn kept_mut(&mut self) -> [&mut [f64]; 3] {
        [&mut self.travelled, &mut self.now, &mut self.origin]
    }

    /// What jumped at t = 0 is what its x(0) is now.
    pub(crate) fn take_origin(&mut self) {
        let origin = &self.origin;
        self.jumps.iter_mut().filter(|jump| jump.is_start).for_each(|jump| jump.size.copy_from_slice(origin));
    }

    /// δu_p of the last step, as it was taken into the past.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = &[f64]> {
        (0..self.piece.rows()).map(|p| self.piece.row(p))
    }

    /// What the step that was committed last did to the past.
    pub(crate) fn take_past(&mut self) -> Option<PastOfStep> {
        self.ports.as_mut()?.committed.take()
    }

    /// By how much the end of the last step moved that moves.
    pub(crate) fn moved(&self) -> Option<&[f64]> {
        self.ports.as_ref().map(|ports| &ports.moved[..])
    }
}
