//! Kinks between two steps: from the last time before one to the first time after it.

use super::Run;
use crate::simulate::RunError;
use crate::simulate::moment::Moment;

impl Run<'_> {
    /// The last moment before a kink and the first one after it.
    pub(super) fn look_across(&mut self, before: f64, after: f64) -> Result<[Moment; 2], RunError> {
        let [mut left, mut right] = std::array::from_fn(|_| self.book.moments[0].clone());
        self.book.system.evaluate(before, before, &mut self.book.scratch, &mut left)?;
        self.book.system.evaluate(after, after, &mut self.book.scratch, &mut right)?;
        let model = &self.book.system.model;
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
        self.book.jump(sides);
        self.book.emit_rows_between_steps(after)?;
        if !self.book.system.turns_at(after) {
            return Ok(after);
        }
        let start = after.next_up();
        let sides = self.look_across(after, start)?;
        self.book.jump(sides);
        self.book.emit_rows_between_steps(start)?;
        Ok(start)
    }
}
