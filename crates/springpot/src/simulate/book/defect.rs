//! What a step may add to the error of the energy ledger.

use super::Book;
use crate::simulate::ledger::work_defect;

/// A step this short, as a share of the motion, is kept whatever it does to the energy ledger: behind a kink of the rates the
/// powers rise like t^{1−alpha}, which no step resolves, and such a step turns over next to nothing.
const SHORTEST_LEDGER_STEP: f64 = 1e-11;

/// Share of rtol^⅔ that the energy ledger may err in one step, in units of the energy turned over.
const ENERGY_SHARE: f64 = 0.01;

impl Book<'_> {
    /// Estimate of what the step just worked out adds to the error of the ledger, in units of its tolerance; `floor` is a lower bound
    /// of the energy turned over.
    pub(in crate::simulate) fn energy_error(&self, h: f64, floor: f64) -> f64 {
        let turned_over = floor.max(self.turnover.total());
        if self.actuators_unknown() || turned_over == 0.0 || h <= SHORTEST_LEDGER_STEP * self.settings.end {
            return 0.0;
        }
        let mut defect = work_defect(&self.powers.actuators, h) + work_defect(&self.powers.joints, h);
        for step in &self.steps {
            defect += work_defect(&step.powers.map(|p| p.dissipation), h);
            defect += work_defect(&step.powers.map(|p| p.input), h);
        }
        if defect.is_nan() { 0.0 } else { defect / (ENERGY_SHARE * self.settings.rtol.powf(2.0 / 3.0) * turned_over) }
    }
}
