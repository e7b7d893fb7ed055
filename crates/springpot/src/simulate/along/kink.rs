//! Kinks between two steps: from the last time before one to the first time after it.

use super::Run;
use crate::law::{Observation, Point};
use crate::simulate::RunError;
use crate::simulate::moment::Moment;
use crate::simulate::row::ElementRow;

impl Run<'_> {
    /// The last moment before a kink and the first one after it.
    pub(super) fn look_across(&mut self, before: f64, after: f64) -> Result<[Moment; 2], RunError> {
        let [mut left, mut right] = std::array::from_fn(|_| self.moments[0].clone());
        self.system.evaluate(before, before, &mut self.scratch, &mut left)?;
        self.system.evaluate(after, after, &mut self.scratch, &mut right)?;
        for (j, joint) in self.system.model.joint_names().iter().enumerate() {
            let jump = right.q[j] - left.q[j];
            let reach = (after - before) * (left.v[j].abs() + right.v[j].abs());
            if jump.abs() > 1e-9 * (1.0 + left.q[j].abs()) + reach {
                return Err(RunError::Jump { t: after, joint: joint.clone(), jump });
            }
        }
        Ok([left, right])
    }

    /// Goes on from the far side of a kink, books what jumps there and writes the rows that lie on it.
    pub(super) fn cross(&mut self, [left, right]: [Moment; 2]) -> Result<(), RunError> {
        let until = right.t;
        let branch = self.system.branch(left.t);
        self.emit_rows_on_kink(until, Some(branch))?;
        // An impulse of the actuators makes the velocities jump; a jump of an input changes what its element stores.
        self.actuators += right.kinetic - left.kinetic;
        for (e, element) in self.system.elements.iter().enumerate() {
            let account = &mut self.accounts[e];
            let Some(state) = &account.law else { continue };
            let was = left.elements[e].point(left.t);
            let is = Point { inputs: &right.elements[e].inputs, ..was };
            if let Some((was, is)) = element.law.stored(&was, state).zip(element.law.stored(&is, state)) {
                account.input += is - was;
            }
        }
        self.moments[0] = right;
        self.emit_rows_on_kink(until, None)
    }

    /// The next rows up to `until`, all of them or those on the branch given: no step holds them.
    fn emit_rows_on_kink(&mut self, until: f64, branch: Option<u64>) -> Result<(), RunError> {
        while self.next_row < self.settings.rows.count() {
            let at = self.settings.rows.at(self.next_row);
            if at > until || branch.is_some_and(|branch| self.system.branch(at) != branch) {
                break;
            }
            let mut moment = self.moments[0].clone();
            self.system.evaluate(at, at, &mut self.scratch, &mut moment)?;
            let rows: Vec<ElementRow> = (0..self.steps.len()).map(|e| self.row_on_kink(e, &moment)).collect();
            self.write_row(&moment, &rows, 0.0, 0.0)?;
        }
        Ok(())
    }

    /// Element `e` on a kink: D^alpha x with alpha < 1 goes on from the last step, rates and inputs may jump.
    fn row_on_kink(&self, e: usize, moment: &Moment) -> ElementRow {
        let (element, account) = (&self.system.elements[e], &self.accounts[e]);
        let at = moment.elements[e].point(moment.t);
        let Some(law) = &account.law else { return self.row_on_grid(e, &at) };
        let derivative = if element.law.order() == 1.0 { at.rate } else { account.derivative };
        let force = element.law.force(&at, derivative);
        let observation = Observation { derivative, force, stored: element.law.stored(&at, law) };
        ElementRow { observation, dissipated: account.dissipated, input: account.input }
    }
}
