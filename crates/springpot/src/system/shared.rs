//! What systems that are alike work out once.

use crate::fractional::Kernels;
use crate::signal::{Agenda, AgendaError, Signal, Watched};
use std::collections::VecDeque;
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Looks that are kept: those of a motion, of its references and of its temperatures.
const KEPT: usize = 16;

/// What systems have in common, as the cases of a sweep do that move in the same way: what their signals do, and kernels. Everything in it follows
/// from what it is asked with, so that it changes no bit of a run; it keeps the last few of each.
#[derive(Clone, Default)]
pub struct Shared(Arc<Inner>);

impl fmt::Debug for Shared {
    /// Nothing of what it holds: what is printed of systems tells them apart.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Shared")
    }
}

#[derive(Debug, Default)]
struct Inner {
    looks: Mutex<VecDeque<Look>>,
    /// Signals that were looked through, look by look.
    looked: AtomicU64,
    kernels: Kernels,
}

/// What signals do over a run.
#[derive(Debug)]
struct Look {
    asked: Asked,
    agenda: Arc<Agenda>,
}

#[derive(Debug)]
struct Asked {
    signals: Vec<(Signal, bool, f64)>,
    end: f64,
    tolerance: f64,
    most: u64,
}

impl Asked {
    fn is(&self, signals: &[Watched<'_>], (end, tolerance, most): (f64, f64, u64)) -> bool {
        let is_same = |((signal, is_position, slack), watched): (&(Signal, bool, f64), &Watched<'_>)| {
            *is_position == watched.is_position && *slack == watched.slack && signal.is_same(watched.signal)
        };
        (self.end, self.tolerance, self.most) == (end, tolerance, most)
            && self.signals.len() == signals.len()
            && self.signals.iter().zip(signals).all(is_same)
    }
}

impl Shared {
    /// What [`Agenda::new`] finds, or has found.
    ///
    /// # Errors
    /// As there.
    pub(super) fn look(
        &self,
        signals: &[Watched<'_>],
        (end, tolerance, most): (f64, f64, u64),
        stop: &AtomicBool,
    ) -> Result<Arc<Agenda>, AgendaError> {
        let range = (end, tolerance, most);
        let known = self.looks().iter().find(|look| look.asked.is(signals, range)).map(|look| look.agenda.clone());
        if let Some(agenda) = known {
            return Ok(agenda);
        }
        self.0.looked.fetch_add(1, Ordering::Relaxed);
        // Not under the lock: others go on, and may look at the same.
        let agenda = Arc::new(Agenda::new(signals, end, tolerance, most, Some(stop))?);
        let signals = signals.iter().map(|watched| (watched.signal.clone(), watched.is_position, watched.slack));
        let asked = Asked { signals: signals.collect(), end, tolerance, most };
        let mut looks = self.looks();
        if looks.len() == KEPT {
            looks.pop_front();
        }
        looks.push_back(Look { asked, agenda: agenda.clone() });
        Ok(agenda)
    }

    /// How often signals were looked through.
    pub fn looked(&self) -> u64 {
        self.0.looked.load(Ordering::Relaxed)
    }

    /// The kernels of memories.
    pub fn kernels(&self) -> &Kernels {
        &self.0.kernels
    }

    fn looks(&self) -> MutexGuard<'_, VecDeque<Look>> {
        self.0.looks.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
