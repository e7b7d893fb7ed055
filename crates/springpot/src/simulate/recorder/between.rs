//! Rows and jumps between two steps, where signals have kinks.

use super::Recorder;
use crate::law::Point;
use crate::simulate::RunError;
use crate::simulate::moment::Moment;
use crate::simulate::row::ElementRow;

impl Recorder<'_> {
    /// The rows up to `until`, when no step is under way.
    pub(in crate::simulate) fn emit_rows_between_steps(&mut self, until: f64) -> Result<(), RunError> {
        while self.next_row_until(until).is_some() {
            let moment = self.moments[0].clone();
            let rows = (0..self.steps.len()).map(|e| self.row_between_steps(e, &moment));
            let rows = rows.collect::<Result<Vec<ElementRow>, _>>()?;
            self.write_row(&moment, &rows, 0.0, 0.0)?;
        }
        Ok(())
    }

    /// An element between two steps.
    fn row_between_steps(&self, e: usize, moment: &Moment) -> Result<ElementRow, RunError> {
        let (element, account) = (&self.system.elements[e], &self.accounts[e]);
        let point = moment.elements[e].point(moment.t);
        let Some(state) = &account.law else { return self.grid_row(e, &point) };
        let observation = element.law.now(&point, state);
        Ok(ElementRow { observation, dissipated: account.dissipated, input: account.input })
    }

    /// Goes on from the far side of a kink and records what jumps there.
    pub(in crate::simulate) fn jump(&mut self, [left, right]: [Moment; 2]) {
        // An impulse of the actuators makes the velocities jump; a jump of an input changes what its element stores.
        self.actuators += right.kinetic - left.kinetic;
        for (e, element) in self.system.elements.iter().enumerate() {
            let account = &mut self.accounts[e];
            let Some(state) = &account.law else { continue };
            let was = left.elements[e].point(left.t);
            let is = Point { inputs: &right.elements[e].inputs, ..was };
            let stored = |at: &Point| element.law.now(at, state).stored;
            if let Some((was, is)) = stored(&was).zip(stored(&is)) {
                account.input += is - was;
            }
        }
        self.moments[0] = right;
    }
}
