//! A run looks at itself: whether its steps saw what the motion does, and whether its energies balance.

use super::Recorder;
use crate::fractional::step::{MAX_NODES, lagrange_row};
use crate::simulate::moment::Moment;
use crate::simulate::row::ElementRow;
use crate::simulate::{Report, RunError};
use serde::{Deserialize, Serialize};

/// How much more than the tolerance a row may depart from its step, and what it may in any case: steps err less than the
/// tolerance by far where they see the motion.
const DEPARTURE: f64 = 1e3;
const LEAST_DEPARTURE: f64 = 1e-5;

/// How much more than the tolerance the balance may be off, in units of the energy turned over, and what it may in any case.
const IMBALANCE: f64 = 1e3;
const LEAST_IMBALANCE: f64 = 1e-4;

/// What a run found out about itself so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::simulate) struct Findings {
    /// The first row whose rate is not that of its step: its time, the element, the departure in units of D^alpha x.
    departure: Option<(f64, usize, f64)>,
    /// Time of the largest residual of the balance, s.
    residual_at: f64,
    /// What rounding may do to the balance, J.
    rounding: f64,
}

impl Recorder<'_> {
    /// Compares the rates of a row at θ of its step with what the step's memory was told: the cubic through its nodes.
    ///
    /// A departure δx' that lasts a step adds up to δx'·h^{1−alpha} to D^alpha x.
    pub(in crate::simulate) fn compare_with_step(&mut self, theta: f64, moment: &Moment, rows: &[ElementRow]) {
        if self.findings.departure.is_some() || theta >= 1.0 {
            return;
        }
        let [from, .., to] = &self.moments;
        let h = to.t - from.t;
        let mut cubic = [0.0; MAX_NODES + 1];
        for (k, weight) in cubic.iter_mut().enumerate() {
            *weight = lagrange_row(k).iter().rev().fold(0.0, |sum, c| sum * theta + c);
        }
        let allowed = LEAST_DEPARTURE.max(DEPARTURE * self.settings.rtol);
        for (e, (account, row)) in self.accounts.iter().zip(rows).enumerate() {
            if account.law.is_none() || h <= 0.0 {
                continue;
            }
            let told: f64 = cubic.iter().zip(&self.steps[e].rate).map(|(w, rate)| w * rate).sum();
            let is = moment.elements[e].rate;
            let derivative = row.observation.derivative.abs();
            for (m, error) in self.steps[e].errors.iter().enumerate().filter(|(_, error)| error.order > 0.0) {
                let departure = (is - told).abs() * h.powf(1.0 - error.order);
                let scale = self.scale_with_step(e, m).max(if derivative.is_finite() { derivative } else { 0.0 });
                let resolution = 8.0 * self.steps[e].resolution * h.powf(-error.order);
                let floor = self.settings.atol.unwrap_or(0.0) + resolution;
                if departure > allowed * scale + floor {
                    self.findings.departure = Some((moment.t, e, departure / scale));
                    return;
                }
            }
        }
    }

    /// Takes in how far the balance is off at t, and what rounding makes of it.
    pub(in crate::simulate) fn take_residual(&mut self, residual: f64, moment: &Moment, rows: &[ElementRow]) {
        if residual.abs() > self.residual {
            self.findings.residual_at = moment.t;
        }
        self.residual = if residual.is_nan() { f64::NAN } else { self.residual.max(residual.abs()) };
        // Strokes are differences of lengths, heights of bodies are counted from the world's origin.
        let forces = rows.iter().zip(&moment.elements).map(|(row, at)| (row.observation.force() * at.length).abs());
        let sizes =
            moment.potential.abs() + self.potential_origin.abs() + forces.filter(|x| x.is_finite()).sum::<f64>();
        self.findings.rounding = self.findings.rounding.max(64.0 * f64::EPSILON * sizes);
    }

    /// Whether the run may be believed; to be asked at its end.
    ///
    /// # Errors
    /// [`RunError::Missed`] where a row contradicts its step, [`RunError::Unbalanced`] where the energies do not balance.
    pub(in crate::simulate) fn verdict(&self) -> Result<(), RunError> {
        if let Some((t, e, departure)) = self.findings.departure {
            return Err(RunError::Missed { t, element: self.system.elements[e].name.clone(), departure });
        }
        let allowed = LEAST_IMBALANCE.max(IMBALANCE * self.settings.rtol);
        let turned_over = self.turnover.total();
        if self.residual > allowed * turned_over + self.findings.rounding {
            let t = self.findings.residual_at;
            return Err(RunError::Unbalanced { t, residual: self.residual, turned_over });
        }
        Ok(())
    }
}

impl Report {
    /// Whether the energies of the run balance as far as a figure can show; `true` where they are not known.
    pub fn is_balanced(&self) -> bool {
        let known = self.energy_residual.zip(self.energy_turned_over);
        known.is_none_or(|(residual, turned_over)| residual <= LEAST_IMBALANCE * turned_over)
    }
}
