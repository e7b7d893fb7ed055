//! Exponentials, and what they make of lags, that memories of one order have in common.

use super::kernel::{Kernel, KernelError};
use super::lanes::{Block, blocks};
use super::table::{SLOTS, Table};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

/// Kernels that a [`Kernels`] keeps.
const KEPT: usize = 64;

/// Tables that are shared: what nobody has any more by the time that its room is used again.
const SHELVED: usize = 2 * SLOTS;

/// A kernel, by blocks of eight modes.
#[derive(Debug)]
pub(super) struct Modes {
    pub(super) kernel: Kernel,
    /// λ and w of the kernel.
    pub(super) lambda: Vec<Block>,
    pub(super) weight: Vec<Block>,
    /// [`Kernel::fast_tail`].
    pub(super) fast_tail: [f64; 3],
    /// Of the lags that were asked for last, the oldest first.
    tables: Mutex<VecDeque<Arc<Table>>>,
}

impl Modes {
    fn new(kernel: Kernel) -> Self {
        let (lambda, weight) = (blocks(&kernel.lambda), blocks(&kernel.weight));
        Self { fast_tail: kernel.fast_tail(), lambda, weight, kernel, tables: Mutex::default() }
    }

    /// The table of a lag with `count` moments, in the room of `table` where nobody else has that.
    pub(super) fn fill(&self, mut table: Arc<Table>, lag: f64, count: usize) -> Arc<Table> {
        if Arc::get_mut(&mut table).is_none() {
            table = Arc::default();
        }
        if let Some(own) = Arc::get_mut(&mut table) {
            own.fill(lag, count, self.kernel.modes(), [&self.lambda, &self.weight]);
        }
        table
    }

    /// The same, made where nobody asked for it before.
    pub(super) fn table(&self, lag: f64, count: usize) -> Arc<Table> {
        let mut tables = lock(&self.tables);
        if let Some(table) = tables.iter().find(|table| table.is_of(lag, count * self.lambda.len(), 0.0)) {
            return table.clone();
        }
        let oldest = if tables.len() < SHELVED { None } else { tables.pop_front() };
        let table = self.fill(oldest.unwrap_or_default(), lag, count);
        tables.push_back(table.clone());
        table
    }
}

/// The modes of the memories of one bank: those with the same kernel share them for as long as they have it. Nothing on it outlives them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shelf {
    modes: Arc<Mutex<Vec<Weak<Modes>>>>,
    kernels: Kernels,
}

impl Shelf {
    /// One whose kernels are looked up among others' first.
    pub(crate) fn of(kernels: Kernels) -> Self {
        Self { modes: Arc::default(), kernels }
    }

    /// The modes of a kernel.
    pub(super) fn modes(&self, kernel: Kernel) -> Arc<Modes> {
        let mut all = lock(&self.modes);
        all.retain(|modes| modes.strong_count() > 0);
        if let Some(modes) = all.iter().filter_map(Weak::upgrade).find(|modes| modes.kernel == kernel) {
            return modes;
        }
        let modes = Arc::new(Modes::new(kernel));
        all.push(Arc::downgrade(&modes));
        modes
    }

    /// The modes of a new kernel ([`Kernel::new`]).
    pub(super) fn built(
        &self,
        alpha: f64,
        tolerance: f64,
        delta: f64,
        horizon: f64,
    ) -> Result<Arc<Modes>, KernelError> {
        Ok(self.modes(self.kernels.built(alpha, tolerance, delta, horizon)?))
    }
}

/// Kernels that were built, by order, tolerance and lags: elements of one order, and cases of a sweep that leave it, share one. The last
/// few dozen are kept.
#[derive(Debug, Clone, Default)]
pub struct Kernels(Arc<Mutex<VecDeque<Built>>>);

/// A kernel, and what it was built with.
#[derive(Debug)]
struct Built {
    asked: [f64; 4],
    kernel: Kernel,
}

impl Kernels {
    /// What [`Kernel::new`] builds, or has built.
    ///
    /// # Errors
    /// As there.
    pub fn built(&self, alpha: f64, tolerance: f64, delta: f64, horizon: f64) -> Result<Kernel, KernelError> {
        let asked = [alpha, tolerance, delta, horizon];
        if let Some(Built { kernel, .. }) = lock(&self.0).iter().find(|built| built.asked == asked) {
            return Ok(kernel.clone());
        }
        // Not under the lock: others go on, and may build the same.
        let kernel = Kernel::new(alpha, tolerance, delta, horizon)?;
        let mut all = lock(&self.0);
        if all.len() == KEPT {
            all.pop_front();
        }
        all.push_back(Built { asked, kernel: kernel.clone() });
        Ok(kernel)
    }

    /// How many are kept.
    pub fn len(&self) -> usize {
        lock(&self.0).len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::super::history::History;
    use super::*;

    const RANGE: [f64; 3] = [1e-10, 1e-3, 10.0];

    fn open(shelf: &Shelf, alpha: f64) -> History {
        let [tolerance, delta, horizon] = RANGE;
        History::open(shelf, alpha, tolerance, delta, horizon).unwrap()
    }

    /// A step of a size of its own now and then, and short ones that ask for more modes.
    fn step(history: &mut History, n: u32, size: f64) -> f64 {
        let h = if n.is_multiple_of(7) { 1e-4 } else { 0.01 + 1e-3 * f64::from(n % 3) };
        for c in [0.15, 0.64, 1.0] {
            history.prepare(c * h, 4, 0.0);
        }
        history.extend(0.15 * h);
        let told = history.advance(h, &[size, -0.3 * size, 0.1, 0.02], 0.0);
        history.drop_surplus(0.15 * h);
        told + history.at(0.15 * h)
    }

    #[test]
    fn histories_that_share_have_the_bits_of_one_alone() {
        let (shelf, alphas) = (Shelf::default(), [0.3, 0.3, 0.7, 0.3]);
        let mut shared = alphas.map(|alpha| open(&shelf, alpha));
        let mut alone = alphas.map(|alpha| open(&Shelf::default(), alpha));
        for n in 0..200 {
            for (k, (shared, alone)) in shared.iter_mut().zip(&mut alone).enumerate() {
                // The last one lags behind, so that it has other modes at times.
                if k < 3 || n % 5 > 0 {
                    let size = 1.0 + k as f64;
                    assert_eq!(step(shared, n, size).to_bits(), step(alone, n, size).to_bits(), "{k}, step {n}");
                }
            }
        }
        assert_eq!(shared[0].modes().len(), alone[0].modes().len());
    }

    #[test]
    fn nothing_is_kept_that_nobody_has() {
        let shelf = Shelf::default();
        let mut histories: Vec<History> = (0..10).map(|_| open(&shelf, 0.4)).collect();
        for n in 0..50 {
            for history in &mut histories {
                step(history, n, 1.0);
            }
        }
        assert_eq!(
            (lock(&shelf.modes).iter().filter(|modes| modes.strong_count() > 0).count(), shelf.kernels.len()),
            (1, 1)
        );
        let modes = lock(&shelf.modes).iter().find_map(Weak::upgrade).unwrap();
        assert!(lock(&modes.tables).len() <= SHELVED);
        drop((histories, modes));
        assert!(lock(&shelf.modes).iter().all(|modes| modes.strong_count() == 0));
        for k in 0..2 * KEPT {
            open(&shelf, 0.4 + 1e-3 * k as f64);
        }
        assert_eq!(shelf.kernels.len(), KEPT);
    }
}
