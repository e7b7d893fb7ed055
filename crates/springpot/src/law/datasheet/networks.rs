//! The parameters of any linear law of springs, dashpots and springpots nearest to a measured complex stiffness.

use super::fit::{FitError, Measured, check_rows, misfit};
use crate::dual::Dual;
use crate::fractional::Kind as Derivative;
use crate::identification::{self, Failed, Parameter, Rows, Series, Settings};
use crate::law::catalog::{Entry, Param};
use crate::law::network::Network;
use crate::law::step::Point;
use num_complex::Complex64;
use std::sync::atomic::AtomicBool;

/// Places from which the least minimum is looked for.
const STARTS: usize = 48;
/// Rows that are looked at on the way there.
const FEW: usize = 48;
/// Singular values of the column-scaled derivatives below this share of the largest: rows leave a combination open.
const OPEN: f64 = 1e-7;

/// A law fitted to a measurement.
#[derive(Debug, Clone)]
pub struct FittedNetwork {
    /// Its parameters, SI, in the order of the catalog's row.
    pub values: Vec<f64>,
    /// One standard deviation of each, from the deviations of the rows; `None` for one at an end of its range.
    pub spreads: Vec<Option<f64>>,
    /// The law with these parameters.
    pub network: Network,
    /// √(Σ|K(ω) − K_j|²/|K_j|²/n) over the n rows.
    pub rms: f64,
    /// The largest |K(ω) − K_j|/|K_j|.
    pub largest: f64,
    /// The row that has it, from 0.
    pub farthest: usize,
}

impl FittedNetwork {
    /// Re K and Im K at an angular frequency, N/m.
    pub fn complex_stiffness(&self, omega: f64) -> [f64; 2] {
        self.network.complex_modulus(&at(), omega)
    }
}

/// Whether [`fit_network`] takes a law: it is linear, has no inputs, and each parameter is one number that is not negative.
pub fn can_fit(law: &Entry) -> bool {
    let usual = |param: &Param| !param.is_list && param.range.low >= 0.0;
    let values: Vec<f64> = law.params.iter().map(|param| param.range.high.min(0.5).max(param.range.low)).collect();
    law.inputs.is_empty()
        && law.params.iter().all(usual)
        && law.build(&values, Derivative::Caputo).is_ok_and(|network| network.is_linear())
}

/// Fits K(ω) of a law to a measurement: the smallest Σ|K(ω_j) − K_j|²/|K_j|² over all its parameters, the least of the minima that
/// [`identification`] finds from evenly spread places.
///
/// # Errors
/// [`FitError`]: a law that is not linear or has inputs, numbers that are not positive, fewer rows than it takes, or rows that leave a
/// parameter open.
pub fn fit_network(law: &Entry, rows: &[Measured]) -> Result<FittedNetwork, FitError> {
    let name = || law.name.to_string();
    if !can_fit(law) {
        return Err(FitError::OtherLaw { law: name() });
    }
    check_rows(&law.name, rows, law.params.len().div_ceil(2) + 1)?;
    let few: Vec<Measured> = rows.iter().step_by(rows.len().div_ceil(FEW)).copied().collect();
    let starts: Vec<Vec<f64>> = (0..STARTS).map(|k| values(law, &start(law, rows, k))).collect();
    let sought = |rows: &[Measured], starts: &[Vec<f64>]| {
        let problem = Deviations::new(law, rows, starts);
        let settings = Settings { starts: starts.len(), ..Settings::default() };
        identification::fit(&problem, &settings, &AtomicBool::new(false))
            .map_err(|_| FitError::Undetermined { law: name() })
    };
    let near = sought(&few, &starts)?;
    let found = if few.len() == rows.len() { near } else { sought(rows, &[near.values])? };
    let values = found.values.clone();
    let network = law.build(&values, Derivative::Caputo).map_err(|_| FitError::Undetermined { law: name() })?;
    let is_open = |undetermined: &identification::Undetermined| undetermined.ratio < OPEN;
    if !found.cost.is_finite() || !found.unseen.is_empty() || found.undetermined.iter().any(is_open) {
        return Err(FitError::Undetermined { law: name() });
    }
    // Without what correlated deviations widen, as for the laws in closed form.
    let spread = |p: usize| found.at_bound[p].is_none().then(|| found.sd(p) / found.widening);
    let spreads = (0..values.len()).map(spread).collect();
    let mut fitted = FittedNetwork { values, spreads, network, rms: 0.0, largest: 0.0, farthest: 0 };
    (fitted.rms, fitted.largest, fitted.farthest) = misfit(rows, |omega| fitted.complex_stiffness(omega));
    Ok(fitted)
}

fn at() -> Point<'static> {
    Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &[] }
}

/// It lies between 0 and 1.
fn is_order(param: &Param) -> bool {
    param.range.high <= 1.0
}

fn values(law: &Entry, unknowns: &[f64]) -> Vec<f64> {
    let value = |(param, u): (&Param, &f64)| if is_order(param) { (1.0 + (-u).exp()).recip() } else { u.exp() };
    law.params.iter().zip(unknowns).map(value).collect()
}

/// One of the places from which minima are looked for, about the means of stiffness and frequency.
fn start(law: &Entry, rows: &[Measured], k: usize) -> Vec<f64> {
    let mean = |of: &dyn Fn(&Measured) -> f64| rows.iter().map(of).sum::<f64>() / rows.len() as f64;
    let (stiffness, omega) = (mean(&|row| row.storage.hypot(row.loss).ln()), mean(&|row| row.omega.ln()));
    let band = rows.iter().fold(0.0, |most: f64, row| most.max((row.omega.ln() - omega).abs()));
    let place = |(p, param): (usize, &Param)| {
        // An additive recurrence with another irrational number for each parameter.
        let share = ((k + 1) as f64 * (2.0 + p as f64 * 1.37).sqrt()).fract() - 0.5;
        match &*param.unit {
            _ if is_order(param) => 5.0 * share,
            unit if unit.contains("s^") => stiffness - 0.5 * omega + (6.0 + band) * share,
            unit if unit.contains("s/") => stiffness - omega + (6.0 + 2.0 * band) * share,
            _ => stiffness + 6.0 * share,
        }
    };
    law.params.iter().enumerate().map(place).collect()
}

/// Real and imaginary parts of (K(ω_j) − K_j)/|K_j|.
struct Deviations<'a> {
    law: &'a Entry,
    rows: &'a [Measured],
    parameters: Vec<Parameter>,
    series: [Series; 1],
}

impl<'a> Deviations<'a> {
    fn new(law: &'a Entry, rows: &'a [Measured], starts: &[Vec<f64>]) -> Self {
        let parameter = |(p, param): (usize, &Param)| {
            let bounds = [0.0, if is_order(param) { 1.0 } else { f64::INFINITY }];
            let start: Vec<f64> = starts.iter().map(|start| start[p]).collect();
            Parameter { start, ..Parameter::new(&*param.name, starts[0][p], bounds) }
        };
        let parameters = law.params.iter().enumerate().map(parameter).collect();
        Self { law, rows, parameters, series: [Series::new("deviation")] }
    }

    /// K at all rows, real and imaginary parts.
    fn stiffness(&self, values: &[f64]) -> Result<Vec<f64>, Failed> {
        let network = self.law.build(values, Derivative::Caputo).map_err(|error| Failed(error.to_string()))?;
        Ok(self.rows.iter().flat_map(|row| network.complex_modulus(&at(), row.omega)).collect())
    }

    /// ∂K/∂p, of the law built of numbers that carry their derivatives by p.
    fn slope(&self, values: &[f64], p: usize) -> Result<Vec<f64>, Failed> {
        let numbers = values.iter().enumerate().map(|(k, value)| Dual { value: *value, slope: f64::from(k == p) });
        let numbers: Vec<Dual> = numbers.collect();
        let network = (self.law.build)(&numbers, Derivative::Caputo).map_err(|error| Failed(error.to_string()))?;
        let slope = |row: &Measured| {
            let s = [Complex64::new(0.0, row.omega), Complex64::ZERO];
            network.modulus_slope(&at(), s).map(|[_, slope]| [slope.re, slope.im])
        };
        let unknown = || Failed(format!("the law {} does not know its derivatives", self.law.name));
        let slopes: Vec<[f64; 2]> = self.rows.iter().map(slope).collect::<Option<_>>().ok_or_else(unknown)?;
        Ok(slopes.into_flattened())
    }
}

impl identification::Problem for Deviations<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn series(&self) -> &[Series] {
        &self.series
    }

    fn rows(&self, values: &[f64], wanted: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
        let stiffness = self.stiffness(values)?;
        let n = values.len();
        let size = |k: usize| self.rows[k / 2].storage.hypot(self.rows[k / 2].loss);
        let goal = |k: usize| [self.rows[k / 2].storage, self.rows[k / 2].loss][k % 2];
        let residuals: Vec<f64> = stiffness.iter().enumerate().map(|(k, own)| (own - goal(k)) / size(k)).collect();
        let mut jacobian = vec![0.0; residuals.len() * n];
        for p in (0..n).filter(|p| wanted[*p]) {
            let slope = self.slope(values, p)?;
            slope.into_iter().enumerate().for_each(|(k, slope)| jacobian[k * n + p] = slope / size(k));
        }
        take(Rows { series: 0, residuals: &residuals, jacobian: &jacobian });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::catalog::Catalog;

    /// Laws that come with Springpot and values that make all their parts matter between 0.01 and 1000 rad/s.
    const LAWS: [(&str, &[f64]); 8] = [
        ("maxwell", &[800.0, 90.0]),
        ("fractional-maxwell", &[900.0, 120.0, 0.6]),
        ("zener", &[300.0, 700.0, 50.0]),
        ("fractional-zener", &[300.0, 5000.0, 400.0, 0.45]),
        ("poynting-thomson", &[4000.0, 500.0, 300.0, 0.7]),
        ("burgers", &[2000.0, 9000.0, 600.0, 60.0]),
        ("jeffreys", &[700.0, 200.0, 3.0]),
        ("fractional-kelvin-voigt", &[200.0, 60.0, 0.3]),
    ];

    fn rows(law: &Entry, values: &[f64], noise: f64) -> Vec<Measured> {
        let network = law.build(values, Derivative::Caputo).unwrap();
        let row = |k: usize| {
            let omega = 10f64.powf(-2.0 + 0.125 * k as f64);
            let [storage, loss] = network.complex_modulus(&at(), omega);
            let factor = |seed: f64| 1.0 + noise * (seed * (k + 1) as f64).sin();
            Measured { omega, storage: storage * factor(12.9), loss: loss * factor(7.3) }
        };
        (0..41).map(row).collect()
    }

    #[test]
    fn exact_rows_give_their_law_back() {
        let catalog = Catalog::standard();
        for (name, values) in LAWS {
            let law = catalog.get(name).unwrap();
            let found = fit_network(law, &rows(law, values, 0.0)).unwrap();
            assert!(found.largest < 1e-8, "{name}: {found:?}");
            for (own, expected) in found.values.iter().zip(values) {
                assert!((own / expected - 1.0).abs() < 1e-5, "{name}: {:?}", found.values);
            }
        }
    }

    #[test]
    fn scattered_rows_give_it_within_its_spread() {
        let catalog = Catalog::standard();
        let law = catalog.get("fractional-zener").unwrap();
        let values = LAWS[3].1;
        let found = fit_network(law, &rows(law, values, 0.02)).unwrap();
        assert!(found.rms > 0.005 && found.rms < 0.03, "{found:?}");
        for ((own, expected), spread) in found.values.iter().zip(values).zip(&found.spreads) {
            let spread = spread.unwrap();
            assert!((own - expected).abs() < 4.0 * spread && spread < 0.2 * expected, "{found:?}");
        }
    }

    #[test]
    fn what_rows_cannot_say_is_refused() {
        let catalog = Catalog::standard();
        let of = |name: &str, rows: &[Measured]| fit_network(catalog.get(name).unwrap(), rows).map(|_| ()).unwrap_err();
        let spring = rows(catalog.get("fractional-maxwell").unwrap(), LAWS[1].1, 0.0);
        assert!(matches!(of("bouc-wen", &spring), FitError::OtherLaw { .. }));
        assert!(matches!(of("thermoviscoelastic", &spring), FitError::OtherLaw { .. }));
        assert!(matches!(of("prony", &spring), FitError::OtherLaw { .. }));
        assert!(matches!(of("burgers", &spring[..2]), FitError::TooFew { .. }));
        let odd = [Measured { storage: -1.0, ..spring[0] }, spring[1], spring[2], spring[3]];
        assert!(matches!(of("maxwell", &odd), FitError::NotPositive { .. }));
    }
}
