//! The rows of a run: a system's observables and their values.

use super::System;
use super::ledger::Balance;
use super::moment::Moment;
pub(super) use crate::observe::snapshot::ElementRow;
use crate::observe::snapshot::Snapshot;
use crate::observe::{Observables, Shape, Table};
use crate::table::Column;

impl System {
    /// What can be observed of it, in the order of a run's rows.
    pub fn observables(&self) -> Observables {
        let mut observables = Observables::new(&self.model, &self.elements);
        if self.gripper.is_some() {
            observables = observables.with_gripper(self.motion.has_path());
        }
        if self.tells_joint_losses { observables.with_joint_losses() } else { observables }
    }

    /// The columns of a run's rows, in order.
    pub fn columns(&self) -> Vec<Column> {
        self.observables().columns()
    }

    /// A table for the rows of its runs.
    pub fn table(&self) -> Table {
        Table::new(&self.observables())
    }

    /// Fills one row; `balance` holds the work and losses, `residual` the ledger's residual, NaN where unknown.
    pub(super) fn fill_row(
        &self,
        moment: &Moment,
        elements: &[ElementRow],
        balance: &Balance,
        joints: f64,
        residual: f64,
        row: &mut Vec<f64>,
    ) {
        let snapshot = Snapshot { moment, elements, actuators: balance.actuators, joints, residual };
        let shape = Shape {
            nq: self.model.nq(),
            nv: self.model.nv(),
            gripper: self.gripper.is_some(),
            wanted: self.motion.has_path(),
            joint_losses: self.tells_joint_losses,
        };
        row.clear();
        let inputs = self.elements.iter().map(|element| element.entry.inputs.len());
        // No field says -0.
        shape.each(inputs, &mut |quantity| row.push(snapshot.value(quantity) + 0.0));
    }
}
