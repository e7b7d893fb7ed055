//! Where the cases of a run that is written come from.

use super::case::Case;
use crate::error::value_error;
use pyo3::prelude::*;
use springpot::system::Stop;
use springpot_run::sweep::{Parcel, Progress, Source};
use springpot_run::{Asked, Planned};
use std::io;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};

/// Cases that were run before.
pub(super) struct Known(pub(super) Vec<Option<Arc<Parcel>>>);

impl Source for Known {
    fn case(&self, index: usize) -> io::Result<Option<Arc<Parcel>>> {
        Ok(self.0.get(index).cloned().flatten())
    }
}

/// Cases that are run here, and kept.
pub(super) struct Keeping {
    pub(super) planned: Arc<Planned>,
    pub(super) stop: Arc<Stop>,
    pub(super) kept: Arc<Mutex<Vec<Option<Arc<Parcel>>>>>,
}

impl Source for Keeping {
    fn case(&self, index: usize) -> io::Result<Option<Arc<Parcel>>> {
        let Planned { cases, layout, .. } = &*self.planned;
        // What is written counts the rows.
        let unseen = Progress::default();
        let Some(parcel) = Parcel::run(cases, layout, index, &self.stop, &unseen) else {
            return Err(io::ErrorKind::Interrupted.into());
        };
        let parcel = Arc::new(parcel);
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)[index] = Some(parcel.clone());
        Ok(Some(parcel))
    }
}

/// Cases that a callable gives: of an index a [`Case`], or `None` where it is to be asked again.
pub(super) struct Called {
    pub(super) get: Py<PyAny>,
    /// What it raised.
    pub(super) raised: Arc<Mutex<Option<PyErr>>>,
    pub(super) stop: Arc<Stop>,
}

impl Source for Called {
    fn case(&self, index: usize) -> io::Result<Option<Arc<Parcel>>> {
        let ask = || {
            Python::attach(|py| -> PyResult<Option<Arc<Parcel>>> {
                let given = self.get.bind(py).call1((index,))?;
                if given.is_none() {
                    return Ok(None);
                }
                let parcel = given.cast::<Case>()?.get().0.clone();
                if parcel.is_whole() { Ok(Some(parcel)) } else { Err(value_error("a case without all of its rows")) }
            })
        };
        loop {
            match ask() {
                Ok(Some(parcel)) => return Ok(Some(parcel)),
                Ok(None) if !self.stop.load(Ordering::Relaxed) => {}
                Ok(None) => break,
                Err(error) => {
                    self.raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                    self.stop.store(true, Ordering::Relaxed);
                    break;
                }
            }
        }
        Err(io::ErrorKind::Interrupted.into())
    }
}

/// Whether two studies are one: the same scenario with the same changes.
pub(super) fn is_same(a: &Asked, b: &Asked) -> bool {
    (&a.text, &a.overrides, &a.sweeps) == (&b.text, &b.overrides, &b.sweeps)
}
