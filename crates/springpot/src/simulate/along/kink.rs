//! Kinks between two steps: from the last time before one to the first time after it.

use super::Run;
use crate::simulate::RunError;
use crate::simulate::jump::refuse_jumps;
use crate::simulate::moment::Moment;

impl Run<'_> {
    /// The last moment before a kink and the first one after it.
    pub(super) fn look_across(&mut self, before: f64, after: f64) -> Result<[Moment; 2], RunError> {
        let [mut left, mut right] = std::array::from_fn(|_| self.recorder.moments[0].clone());
        self.recorder.system.evaluate(before, before, &mut self.recorder.scratch, &mut left)?;
        self.recorder.system.evaluate(after, after, &mut self.recorder.scratch, &mut right)?;
        let system = self.recorder.system;
        let (mut v, mut a) = (vec![0.0; system.model.nv()], vec![0.0; system.model.nv()]);
        let speed = |k: usize| left.v[k].abs() + right.v[k].abs();
        refuse_jumps(&system.model, (before, &left.q), (after, &right.q), speed, system.motion.solved_to(), |t, q| {
            system.motion.at(&system.model, t, q, &mut v, &mut a)?;
            Ok(())
        })?;
        Ok([left, right])
    }

    /// Goes from a kink to where the next step starts: one bit behind it, since a sign is 0 while it turns.
    pub(super) fn cross(&mut self, sides: [Moment; 2]) -> Result<f64, RunError> {
        let [_, Moment { t: after, .. }] = sides;
        self.recorder.jump(sides);
        self.recorder.emit_rows_between_steps(after)?;
        let start = self.recorder.system.past_turns(after);
        if start == after {
            return Ok(after);
        }
        let sides = self.look_across(after, start)?;
        self.recorder.jump(sides);
        self.recorder.emit_rows_between_steps(start)?;
        Ok(start)
    }
}
