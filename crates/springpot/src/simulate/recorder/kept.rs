//! What of a recorder must outlast a step.

use super::{Account, Findings, Recorder};
use crate::simulate::ledger::Turnover;
use crate::simulate::moment::Moment;
use crate::simulate::{Checkpoint, Report, RunError, StepperState};
use serde::{Deserialize, Serialize};

/// A recorder between two steps. Whatever else it holds follows from the system and its settings, or is filled anew by every step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::simulate) struct RecorderState {
    accounts: Vec<Account>,
    /// Where the next step starts.
    pub(in crate::simulate) moment: Moment,
    pub(in crate::simulate) next_row: usize,
    actuators: f64,
    joints: f64,
    potential_origin: f64,
    origin: f64,
    turnover: Turnover,
    residual: f64,
    findings: Findings,
    report: Report,
}

impl Recorder<'_> {
    /// Hands over the state between two steps where it is wanted; `last` says that the run stops here for now.
    pub(in crate::simulate) fn keep(
        &mut self,
        t: f64,
        last: bool,
        stepper_state: impl FnOnce() -> StepperState,
    ) -> Result<(), RunError> {
        if !self.rows.wants_checkpoint(t, last) {
            return Ok(());
        }
        let recorder = RecorderState {
            accounts: self.accounts.clone(),
            moment: self.moments[0].clone(),
            next_row: self.next_row,
            actuators: self.actuators,
            joints: self.joints,
            potential_origin: self.potential_origin,
            origin: self.origin,
            turnover: self.turnover,
            residual: self.residual,
            findings: self.findings,
            report: self.report,
        };
        self.rows.checkpoint(Checkpoint { recorder, stepper_state: stepper_state() })?;
        Ok(())
    }

    /// Goes on from what was kept of a run of the same system.
    pub(in crate::simulate) fn restore(&mut self, recorder: RecorderState) {
        let RecorderState {
            accounts,
            moment,
            next_row,
            actuators,
            joints,
            potential_origin,
            origin,
            turnover,
            residual,
            findings,
            report,
        } = recorder;
        self.accounts = accounts;
        self.moments[0] = moment;
        self.next_row = next_row;
        self.actuators = actuators;
        self.joints = joints;
        self.potential_origin = potential_origin;
        self.origin = origin;
        self.turnover = turnover;
        self.residual = residual;
        self.findings = findings;
        self.report = report;
    }
}

impl RecorderState {
    /// Whether this can be the recorder of a system of that many elements, coordinates and velocities.
    pub(in crate::simulate) fn fit(&self, elements: usize, nq: usize, nv: usize) -> bool {
        let Moment { q, v, a, .. } = &self.moment;
        let sizes = [self.accounts.len(), self.moment.elements.len(), q.len(), v.len(), a.len()];
        sizes == [elements, elements, nq, nv, nv]
    }
}
