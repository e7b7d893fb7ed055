//! Steps, with callables asked between them and signals looked after.

use super::{Inner, failed};
use crate::interrupt::PATIENCE;
use pyo3::prelude::*;
use springpot::integrate::RunError;
use std::time::Instant;

impl Inner {
    /// One step, which ends at the next sample at the latest.
    pub(super) fn step(&mut self, py: Python<'_>) -> PyResult<bool> {
        self.take_samples(py)?;
        let until = self.next_sample();
        let simulation = &mut self.simulation;
        let moved = py.detach(|| simulation.step_until(until)).map_err(|error| failed(py, &error))?;
        py.check_signals()?;
        Ok(moved)
    }

    /// Steps until the time is t.
    pub(super) fn step_to(&mut self, py: Python<'_>, t: f64) -> PyResult<()> {
        let (from, to) = (self.simulation.t(), self.simulation.end());
        if !(from <= t && t <= to) {
            return Err(failed(py, &RunError::Outside { t, from, to }));
        }
        while self.simulation.t() < t {
            self.take_samples(py)?;
            let until = self.next_sample().min(t);
            self.steps_until(py, until)?;
        }
        Ok(())
    }

    /// Without the GIL, which is asked for now and then: Ctrl-C leaves the simulation between two steps.
    fn steps_until(&mut self, py: Python<'_>, until: f64) -> PyResult<()> {
        let simulation = &mut self.simulation;
        loop {
            let walk = || -> Result<bool, RunError> {
                let begun = Instant::now();
                while simulation.t() < until {
                    if !simulation.step_until(until)? {
                        break;
                    }
                    if begun.elapsed() > PATIENCE {
                        return Ok(false);
                    }
                }
                Ok(true)
            };
            let done = py.detach(walk).map_err(|error| failed(py, &error))?;
            py.check_signals()?;
            if done {
                return Ok(());
            }
        }
    }
}
