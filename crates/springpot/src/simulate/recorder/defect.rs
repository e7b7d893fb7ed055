//! What a step may add to the error of the energy ledger.

use super::Recorder;
use crate::simulate::ledger::work_defect;

/// A step this short, as a share of the motion, is kept whatever it does to the energy ledger: behind a kink of the rates the
/// powers rise like t^{1−alpha}, which no step resolves, and such a step turns over next to nothing.
const SHORTEST_LEDGER_STEP: f64 = 1e-11;

/// Energies below this count as none, J.
const TINY_ENERGY: f64 = 1e-280;

/// Share of rtol^⅔ that the energy ledger may err in one step, in units of the energy turned over.
const ENERGY_SHARE: f64 = 0.01;

/// Share of rtol^⅔ that what an element has dissipated may err in one step, in units of itself, at least so many times rtol^⅔
/// of the energy turned over: beside a violent motion an element may lose little.
const ACCOUNT_SHARE: f64 = 0.03;
const ACCOUNT_FLOOR: f64 = 100.0;

impl Recorder<'_> {
    /// Estimate of what the step just worked out adds to the error of the ledger, in units of its tolerance; `floor` is a lower bound
    /// of the energy turned over.
    pub(in crate::simulate) fn energy_error(&self, h: f64, floor: f64) -> f64 {
        let turned_over = floor.max(self.turnover.total());
        // Of denormal energies no share can be told.
        if self.actuators_unknown() || turned_over < TINY_ENERGY || h <= SHORTEST_LEDGER_STEP * self.settings.end {
            return 0.0;
        }
        let allowed = self.settings.rtol.powf(2.0 / 3.0);
        let mut defect = work_defect(&self.powers.actuators, h) + work_defect(&self.powers.joints, h);
        let mut worst_account = 0.0f64;
        for (step, account) in self.steps.iter().zip(&self.accounts) {
            let (dissipation, input) = (step.powers.map(|p| p.dissipation), step.powers.map(|p| p.input));
            let own = work_defect(&dissipation, h);
            defect += own + work_defect(&input, h);
            // Of NaN the larger is the other one.
            let size = account.dissipated.abs() + (ACCOUNT_FLOOR * allowed).min(1.0) * turned_over;
            worst_account = worst_account.max(own / (ACCOUNT_SHARE * allowed * size));
        }
        if defect.is_nan() { 0.0 } else { worst_account.max(defect / (ENERGY_SHARE * allowed * turned_over)) }
    }
}
