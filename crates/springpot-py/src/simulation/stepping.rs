//! Steps, with callables asked between them and signals looked after.

use super::{Inner, failed};
use crate::interrupt::PATIENCE;
use pyo3::prelude::*;
use springpot::Simulation;
use springpot::system::RunError;
use std::time::Instant;

impl Inner {
    /// One step, which ends at the next sample at the latest.
    pub(super) fn step(&mut self, py: Python<'_>) -> PyResult<bool> {
        self.take_samples(py)?;
        let until = self.next_sample();
        self.walk(py, |simulation, pauses| simulation.step_until_unless(until, pauses))
    }

    /// Steps until the time is t.
    pub(super) fn step_to(&mut self, py: Python<'_>, t: f64) -> PyResult<()> {
        let (from, to) = (self.simulation.t(), self.simulation.end());
        if !(from <= t && t <= to) {
            return Err(failed(py, &RunError::Outside { t, from, to }));
        }
        while self.simulation.t() < t && self.simulation.stopped_by().is_none() {
            self.take_samples(py)?;
            let until = self.next_sample().min(t);
            self.walk(py, |simulation, pauses| {
                while simulation.t() < until {
                    if !simulation.step_until_unless(until, pauses)? || pauses() {
                        break;
                    }
                }
                Ok(())
            })?;
        }
        Ok(())
    }

    /// Takes steps without the GIL, which is asked for now and then: Ctrl-C leaves the simulation before, after or between the tries of a step.
    fn walk<T: Send>(
        &mut self,
        py: Python<'_>,
        mut steps: impl FnMut(&mut Simulation, &mut dyn FnMut() -> bool) -> Result<T, RunError> + Send,
    ) -> PyResult<T> {
        let simulation = &mut self.simulation;
        loop {
            let begun = Instant::now();
            let walked = py.detach(|| steps(simulation, &mut || begun.elapsed() > PATIENCE));
            py.check_signals()?;
            match walked {
                Err(RunError::Interrupted { .. }) => {}
                other => return other.map_err(|error| failed(py, &error)),
            }
        }
    }
}
