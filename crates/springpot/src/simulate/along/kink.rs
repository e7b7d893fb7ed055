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
        let model = &self.system.model;
        let jumps = model.difference(&left.q, &right.q);
        for (j, joint) in model.joint_names().iter().enumerate() {
            let size = left.q[model.q_range(j)].iter().fold(1.0, |largest: f64, q| largest.max(q.abs()));
            for k in model.v_range(j) {
                let reach = (after - before) * (left.v[k].abs() + right.v[k].abs());
                if jumps[k].abs() > 2e-9 * size + reach {
                    return Err(RunError::Jump { t: after, joint: joint.clone(), jump: jumps[k] });
                }
            }
        }
        Ok([left, right])
    }

    /// Goes from a kink to where the next step starts: one bit behind it, since a sign is 0 while it turns.
    pub(super) fn cross(&mut self, sides: [Moment; 2]) -> Result<f64, RunError> {
        let [_, Moment { t: after, .. }] = sides;
        self.book_jumps(sides);
        self.emit_rows_between_steps(after)?;
        let start = after.next_up();
        let sides = self.look_across(after, start)?;
        self.book_jumps(sides);
        self.emit_rows_between_steps(start)?;
        Ok(start)
    }

    /// The rows up to `until`, when no step is under way.
    fn emit_rows_between_steps(&mut self, until: f64) -> Result<(), RunError> {
        while self.next_row_until(until).is_some() {
            let moment = self.moments[0].clone();
            let rows: Vec<ElementRow> = (0..self.steps.len()).map(|e| self.row_between_steps(e, &moment)).collect();
            self.write_row(&moment, &rows, 0.0, 0.0)?;
        }
        Ok(())
    }

    /// An element between two steps.
    fn row_between_steps(&self, e: usize, moment: &Moment) -> ElementRow {
        let (element, account) = (&self.system.elements[e], &self.accounts[e]);
        let point = moment.elements[e].point(moment.t);
        let Some(state) = &account.law else { return self.grid_row(e, &point) };
        // D^alpha x itself does not jump, but for alpha = 1.
        let derivative = if element.law.order() == 1.0 { point.rate } else { account.derivative };
        let observation = Observation {
            derivative,
            force: element.law.force(&point, derivative),
            stored: element.law.stored(&point, state),
        };
        ElementRow { observation, dissipated: account.dissipated, input: account.input }
    }

    /// Goes on from the far side of a kink and books what jumps there.
    fn book_jumps(&mut self, [left, right]: [Moment; 2]) {
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
    }
}
