//! The columns of events over a step, as its nodes tell them: enough to see that a function stays away from zero.

use crate::collocation::{Cubic, STAGES};
use crate::driver::time_loop::Driver;
use crate::equations::context::Context;
use crate::methods::stepper::Target;
use crate::observe::{Needs, Snapshot};
use crate::system::error::RunError;
use crate::system::event::Event;

/// A function is apart from zero that comes no nearer to it than this share of what it goes over in the step.
const APART: f64 = 0.1;

/// The columns of all events that need no forces, at the start and at the nodes of the step at hand.
#[derive(Debug, Default)]
pub(crate) struct Nodes {
    /// Where those of each event begin.
    first: Vec<usize>,
    /// Values at the nodes, then as coefficients of cubics in θ.
    columns: Vec<[f64; STAGES + 1]>,
    /// Values at the end.
    end: Vec<f64>,
    is_read: bool,
    spare: Vec<f64>,
}

impl Nodes {
    pub(crate) fn of(events: &[Event]) -> Self {
        let mut count = 0;
        let first = events.iter().map(|event| {
            count += event.columns.len();
            count - event.columns.len()
        });
        let first = first.collect();
        Self { first, columns: vec![[0.0; STAGES + 1]; count], end: vec![0.0; count], ..Self::default() }
    }

    /// Forgets what it read of another step.
    pub(crate) fn forget(&mut self) {
        self.is_read = false;
    }

    /// Reads the columns of the step at hand, unless that was done.
    ///
    /// # Errors
    /// Where an element has no direction.
    pub(crate) fn read(
        &mut self,
        cx: Context,
        driver: &mut Driver,
        events: &[Event],
        needs: &[Needs],
        snapshot: &mut Snapshot,
    ) -> Result<(), RunError> {
        if self.is_read {
            return Ok(());
        }
        let quick = || events.iter().zip(needs).zip(&self.first).filter(|((_, needs), _)| **needs < Needs::Forces);
        let most = quick().map(|((_, needs), _)| *needs).max().unwrap_or(Needs::Places);
        for node in 0..=STAGES {
            driver.glance_at_node(cx, node, most, snapshot)?;
            for ((event, _), &first) in quick() {
                for (quantity, column) in event.columns.iter().zip(&mut self.columns[first..]) {
                    column[node] = snapshot.value(*quantity);
                }
            }
        }
        for (column, end) in self.columns.iter_mut().zip(&mut self.end) {
            *end = column[STAGES];
            *column = Cubic::through(column).coefficients;
        }
        self.is_read = true;
        Ok(())
    }

    /// The function of an event at the end of the step, if it stays apart from zero on this side at all these times of it.
    pub(crate) fn end_where_apart(
        &mut self,
        events: &[Event],
        event: usize,
        times: &[f64],
        step: &Target,
        side: i8,
    ) -> Option<f64> {
        let Event { when, columns, .. } = &events[event];
        let of_event = self.first[event]..self.first[event] + columns.len();
        let (own, end) = (&self.columns[of_event.clone()], &self.end[of_event]);
        let side = f64::from(side);
        let at_end = when.value(step.to, end);
        let (mut low, mut high) = (side * at_end, side * at_end);
        let scale = (step.to - step.from).recip();
        for &t in times {
            let theta = (t - step.from) * scale;
            self.spare.clear();
            self.spare.extend(own.iter().map(|u| u[0] + theta * (u[1] + theta * (u[2] + theta * u[3]))));
            let value = side * when.value(t, &self.spare);
            if !value.is_finite() {
                return None;
            }
            (low, high) = (low.min(value), high.max(value));
        }
        (low > 0.0 && low > APART * (high - low)).then_some(at_end)
    }
}
