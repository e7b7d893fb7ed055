//! Whether the steps of a run saw what the motion does.

use super::Recorder;
use crate::equations::context::Context;
use crate::equations::control::Misread;
use crate::observe::Snapshot;

/// How much more than the tolerance a row may depart from its step, and what it may in any case: steps err less than the
/// tolerance by far where they see the motion.
const DEPARTURE: f64 = 1e3;
const LEAST_DEPARTURE: f64 = 1e-5;

impl Recorder {
    /// The first expression of the state that the step at hand took on the wrong side of a kink, where a row shows it.
    pub(crate) fn misread(&mut self, cx: Context, snapshot: &Snapshot) -> Option<Misread> {
        let allowed = LEAST_DEPARTURE.max(DEPARTURE * self.settings.rtol);
        self.equations.misread(cx, allowed, &snapshot.evaluation)
    }

    /// Compares the rates at θ of the step with what its memories were told, the polynomial through its nodes: the first element that departs too
    /// far, and how far in units of D^alpha x.
    ///
    /// A departure δx' that lasts a step adds up to δx'·h^{1−alpha} to D^alpha x.
    pub(crate) fn departure(&self, theta: f64, snapshot: &Snapshot) -> Option<(usize, f64)> {
        let (_, h) = self.span();
        if theta >= 1.0 || h <= 0.0 {
            return None;
        }
        let allowed = LEAST_DEPARTURE.max(DEPARTURE * self.settings.rtol);
        let taking_part = (0..self.equations.bank.len()).filter(|&e| self.equations.bank.takes_part(e));
        for e in taking_part {
            let [_, rates] = self.equations.bank.told(e);
            let told = self.equations.bank.rate_within(e, theta);
            let is = snapshot.evaluation.elements[e].reading.rate;
            // Parts in series share the stroke: what is little of all of it is no departure of any of them.
            let fastest = rates.iter().fold(is.abs(), |fastest, rate| fastest.max(rate.abs()));
            if (is - told).abs() <= allowed * fastest {
                continue;
            }
            // Where the motion is sought a rate is a difference of velocities, each of which is known to the tolerance.
            let evaluation = &snapshot.evaluation;
            let parts = evaluation.elements[e].gradient.iter().zip(&evaluation.v).map(|(g, v)| (g * v).abs());
            if !self.takes_elements_work && (is - told).abs() <= self.settings.rtol * parts.sum::<f64>() {
                continue;
            }
            let derivative = snapshot.elements[e].observation.derivative.abs();
            // D^alpha x and its share of a step are those of the time of the memories.
            let pace = self.equations.bank.pace(e);
            for (m, error) in self.equations.bank.errors(e).iter().enumerate().filter(|(_, error)| error.order > 0.0) {
                let departure = (is - told).abs() * h * (h * pace).powf(-error.order);
                let scale = self.equations.bank.scale(e, m).max(if derivative.is_finite() { derivative } else { 0.0 });
                let resolution = 8.0 * self.equations.bank.resolution(e) * (h * pace).powf(-error.order);
                let floor = self.settings.atol.unwrap_or(0.0) + resolution;
                if departure > allowed * scale + floor {
                    return Some((e, departure / scale));
                }
            }
        }
        None
    }
}
