//! The parameters of any linear law of springs, dashpots and springpots nearest to a measured complex stiffness.

use super::fit::{FitError, Measured, check_rows, misfit};
use crate::fractional::Kind as Derivative;
use crate::law::catalog::{Entry, Param};
use crate::law::network::Network;
use crate::law::step::Point;
use crate::linalg::{Lu, are_independent};

/// Places from which the least minimum is looked for.
const STARTS: usize = 96;
/// Rows that are looked at on the way there.
const FEW: usize = 48;
const STEPS: usize = 60;
const LAST_STEPS: usize = 400;
/// Step of the differences, in the logarithm of a parameter.
const STEP: f64 = 1e-5;
/// An order this near to an end of its range has come to it.
const END: f64 = 1e-3;

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
/// Levenberg–Marquardt steps in their logarithms (orders: in ln alpha/(1 − alpha)) find from evenly spread places.
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
    let starts = (0..STARTS).map(|k| start(law, rows, k));
    let found = starts.map(|start| descend(law, &few, start, STEPS));
    let best = found.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, unknowns)| unknowns).unwrap_or_default();
    let (cost, unknowns) = descend(law, rows, best, LAST_STEPS);
    let values = values(law, &unknowns);
    let network = law.build(&values, Derivative::Caputo).map_err(|_| FitError::Undetermined { law: name() })?;
    let free: Vec<usize> = (0..values.len()).filter(|&p| is_inside(&law.params[p], values[p])).collect();
    let slopes: Vec<Vec<f64>> = free.iter().map(|&p| slope(law, rows, &unknowns, p)).collect();
    if !cost.is_finite() || !are_independent(slopes.iter().cloned()) {
        return Err(FitError::Undetermined { law: name() });
    }
    let mut spreads = vec![None; values.len()];
    let variance = cost / (2 * rows.len() - free.len()).max(1) as f64;
    for (place, inverse) in diagonal_of_inverse(&slopes).into_iter().enumerate() {
        let p = free[place];
        let by_unknown = if is_order(&law.params[p]) { values[p] * (1.0 - values[p]) } else { values[p] };
        spreads[p] = Some(by_unknown * (inverse * variance).sqrt());
    }
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

fn is_inside(param: &Param, value: f64) -> bool {
    !is_order(param) || (value > END && value < 1.0 - END)
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
fn deviations(law: &Entry, rows: &[Measured], unknowns: &[f64]) -> Option<Vec<f64>> {
    let network = law.build(&values(law, unknowns), Derivative::Caputo).ok()?;
    let of = |row: &Measured| {
        let ([re, im], size) = (network.complex_modulus(&at(), row.omega), row.storage.hypot(row.loss));
        [(re - row.storage) / size, (im - row.loss) / size]
    };
    let all: Vec<f64> = rows.iter().flat_map(of).collect();
    all.iter().all(|value| value.is_finite()).then_some(all)
}

/// The derivative of the deviations by unknown `p`.
fn slope(law: &Entry, rows: &[Measured], unknowns: &[f64], p: usize) -> Vec<f64> {
    let moved = |h: f64| {
        let mut unknowns = unknowns.to_vec();
        unknowns[p] += h;
        deviations(law, rows, &unknowns)
    };
    match (moved(STEP), moved(-STEP)) {
        (Some(up), Some(down)) => up.iter().zip(down).map(|(up, down)| (up - down) / (2.0 * STEP)).collect(),
        _ => vec![0.0; 2 * rows.len()],
    }
}

/// Downhill to a minimum of the sum of squares: that sum and the unknowns.
fn descend(law: &Entry, rows: &[Measured], start: Vec<f64>, most: usize) -> (f64, Vec<f64>) {
    let square = |vector: &[f64]| vector.iter().map(|x| x * x).sum::<f64>();
    let Some(mut own) = deviations(law, rows, &start) else { return (f64::INFINITY, start) };
    let (mut x, mut cost, mut damping) = (start, square(&own), 1e-3);
    let mut lu = Lu::default();
    for _ in 0..most {
        let n = x.len();
        let slopes: Vec<Vec<f64>> = (0..n).map(|p| slope(law, rows, &x, p)).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (before, mut taken) = (cost, f64::INFINITY);
        while damping < 1e12 {
            let mut step: Vec<f64> = slopes.iter().map(|slope| -dot(slope, &own)).collect();
            let solvable = lu.factor(n, |matrix| {
                for (k, entry) in matrix.iter_mut().enumerate() {
                    let (a, b) = (k / n, k % n);
                    *entry = dot(&slopes[a], &slopes[b]);
                    *entry += if a == b { damping * *entry + 1e-14 } else { 0.0 };
                }
            });
            if solvable {
                lu.solve(&mut step);
                let longest = step.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                let factor = (2.0 / longest).min(1.0);
                let tried: Vec<f64> = x.iter().zip(&step).map(|(x, step)| x + factor * step).collect();
                if let Some(next) = deviations(law, rows, &tried).filter(|next| square(next) < cost) {
                    (x, cost, own, taken) = (tried, square(&next), next, longest);
                    damping = (0.2 * damping).max(1e-14);
                    break;
                }
            }
            damping *= 4.0;
        }
        if taken < 1e-13 || cost >= before * (1.0 - 1e-13) || cost < 1e-28 {
            break;
        }
    }
    (cost, x)
}

/// The diagonal of (JᵀJ)⁻¹ of these columns of J.
fn diagonal_of_inverse(columns: &[Vec<f64>]) -> Vec<f64> {
    let n = columns.len();
    let mut lu = Lu::default();
    let product = |a: usize, b: usize| columns[a].iter().zip(&columns[b]).map(|(a, b)| a * b).sum::<f64>();
    if !lu.factor(n, |matrix| (0..n * n).for_each(|k| matrix[k] = product(k / n, k % n))) {
        return vec![f64::INFINITY; n];
    }
    let entry = |k: usize, lu: &mut Lu| {
        let mut unit = vec![0.0; n];
        unit[k] = 1.0;
        lu.solve(&mut unit);
        unit[k].max(0.0)
    };
    (0..n).map(|k| entry(k, &mut lu)).collect()
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
