//! The laws of the shift, fitted to the steps from one temperature to the next, whose errors do not depend on one another.

use super::pair::Step;
use crate::identification::{Criteria, Failed, Fit, Parameter, Problem, Rows, Series, Settings, fit};
use crate::law::heat::{GAS, Shift};
use std::f64::consts::LN_10;
use std::sync::atomic::AtomicBool;

/// The least standard deviation of a step, decades: below it the shifts of rows themselves are not known.
const LEAST: f64 = 1e-5;

/// A law of the shift with what the fit says of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShiftFit {
    /// The law.
    pub shift: Shift,
    /// Standard deviations: of C1 and C2 (K), or of the energy (J/mol) and 0; NaN where there is nothing to tell them from.
    pub sd: [f64; 2],
    /// Correlation of C1 and C2.
    pub correlation: f64,
    /// √ of the mean square of what it misses the steps by, decades.
    pub rms: f64,
    /// Schwarz's criterion.
    pub bic: f64,
}

/// log₁₀ of a_T by the parameters, and its derivatives.
type Law = fn(&[f64], &Steps<'_>, f64) -> (f64, [f64; 2]);

struct Steps<'a> {
    temperatures: &'a [f64],
    steps: &'a [Step],
    reference: f64,
    /// T_ref less the coldest, K: C2 is more than that.
    below: f64,
    law: Law,
    /// The median standard deviation of a step.
    usual: f64,
    parameters: Vec<Parameter>,
    series: [Series; 1],
}

impl<'a> Steps<'a> {
    fn new(temperatures: &'a [f64], steps: &'a [Step], reference: f64, law: Law, parameters: Vec<Parameter>) -> Self {
        let below = (reference - temperatures[0]).max(0.0);
        let mut spreads: Vec<f64> = steps.iter().map(|step| step.sd).collect();
        spreads.sort_unstable_by(f64::total_cmp);
        let usual = if steps.len() > 1 { spreads[spreads.len() / 2] } else { 0.0 };
        // As many steps as parameters are met: what is left is what the steps themselves may be off by.
        let series = [Series { has_sd: steps.len() <= parameters.len(), ..Series::new("step") }];
        Self { temperatures, steps, reference, below, law, usual, parameters, series }
    }

    /// What a step counts by: its own standard deviation and the median of all, since those of few rows are uncertain themselves.
    fn sd(&self, k: usize) -> f64 {
        self.steps[k].sd.hypot(self.usual).max(LEAST)
    }

    /// What the law misses step k by, decades, and derivatives.
    fn missed(&self, values: &[f64], k: usize) -> (f64, [f64; 2]) {
        let [cold, warm] = [k, k + 1].map(|k| (self.law)(values, self, self.temperatures[k]));
        (warm.0 - cold.0 - self.steps[k].log_a, std::array::from_fn(|j| warm.1[j] - cold.1[j]))
    }

    fn told(&self, shift: Shift, found: &Fit) -> ShiftFit {
        let count = self.steps.len();
        let rms = ((0..count).map(|k| self.missed(&found.values, k).0.powi(2)).sum::<f64>() / count as f64).sqrt();
        let p = self.parameters.len();
        let sd = std::array::from_fn(|j| if j < p { found.sd(j) } else { 0.0 });
        let correlation = if p == 2 { found.correlation(0, 1) } else { 0.0 };
        ShiftFit { shift, sd, correlation, rms, bic: Criteria::new(found.cost.max(1e-20), count, p).bic }
    }
}

impl Problem for Steps<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn series(&self) -> &[Series] {
        &self.series
    }

    fn rows(&self, values: &[f64], _: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
        for k in 0..self.steps.len() {
            let (missed, by) = self.missed(values, k);
            let jacobian = by.map(|by| by / self.sd(k));
            take(Rows { series: 0, residuals: &[missed / self.sd(k)], jacobian: &jacobian[..values.len()] });
        }
        Ok(())
    }
}

/// −C1 (T − T_ref)/(C2 + T − T_ref), C2 = below + the second value.
fn williams_landel_ferry(values: &[f64], steps: &Steps<'_>, temperature: f64) -> (f64, [f64; 2]) {
    let above = temperature - steps.reference;
    let below = steps.below + values[1] + above;
    (-values[0] * above / below, [-above / below, values[0] * above / (below * below)])
}

fn activated(values: &[f64], steps: &Steps<'_>, temperature: f64) -> (f64, [f64; 2]) {
    let by = (temperature.recip() - steps.reference.recip()) / (GAS * LN_10);
    (values[0] * by, [by, 0.0])
}

/// C1 and C2; `None` with fewer than two steps, or where shifts do not fall with temperature.
pub(super) fn wlf(temperatures: &[f64], steps: &[Step], reference: f64) -> Option<ShiftFit> {
    if steps.len() < 2 {
        return None;
    }
    let positive = |name, start| Parameter::new(name, start, [0.0, f64::INFINITY]);
    let mut parameters = vec![positive("C1", 17.44), positive("C2", 51.6)];
    for (parameter, starts) in
        parameters.iter_mut().zip([[17.44, 8.86, 5.0, 50.0, 200.0], [51.6, 101.6, 20.0, 300.0, 1500.0]])
    {
        parameter.start = starts.to_vec();
    }
    let steps = Steps::new(temperatures, steps, reference, williams_landel_ferry, parameters);
    let found = fit(&steps, &Settings { starts: 12, ..Settings::default() }, &AtomicBool::new(false)).ok()?;
    let [c1, c2] = [found.values[0], steps.below + found.values[1]];
    let is_law = c1 > 0.0 && c1.is_finite() && c2 > 0.0 && c2.is_finite();
    is_law.then(|| steps.told(Shift::Wlf { c1, c2, reference }, &found))
}

/// The energy; 0 where shifts do not fall with temperature.
pub(super) fn arrhenius(temperatures: &[f64], steps: &[Step], reference: f64) -> ShiftFit {
    let parameters = vec![Parameter::new("energy", 1e5, [0.0, f64::INFINITY])];
    let steps = Steps::new(temperatures, steps, reference, activated, parameters);
    let found = fit(&steps, &Settings { starts: 1, ..Settings::default() }, &AtomicBool::new(false));
    match found {
        Ok(found) => steps.told(Shift::Arrhenius { energy: found.values[0], reference }, &found),
        Err(_) => ShiftFit {
            shift: Shift::Arrhenius { energy: 0.0, reference },
            sd: [f64::NAN, 0.0],
            correlation: 0.0,
            rms: f64::NAN,
            bic: f64::INFINITY,
        },
    }
}
