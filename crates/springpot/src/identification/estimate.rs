//! What a minimum says of its parameters: covariance, correlated residuals, criteria.

use super::look::{Look, Place};
use super::problem::Loss;
use crate::linalg::{Triangle, column_singular_values};

/// Lag-1 correlations above this, and above 2/√rows, widen.
const CORRELATED: f64 = 0.3;
/// Singular values below this share of the largest are rounding.
const ROUNDING: f64 = 1e-13;

/// (RᵀR)⁻¹ of these columns, row by row; infinite where they do not determine a parameter.
pub(super) fn inverse(triangle: &Triangle, columns: &[usize]) -> Vec<f64> {
    let m = columns.len();
    let (scaled, norms) = scaled(triangle, columns);
    let decomposition = column_singular_values(&scaled, m);
    let largest = decomposition.iter().map(|(sigma, _)| *sigma).fold(0.0, f64::max);
    let mut inverse = vec![0.0; m * m];
    for (sigma, direction) in &decomposition {
        let is_open = *sigma <= ROUNDING * largest;
        for i in 0..m {
            for j in 0..m {
                let share = direction[i] * direction[j];
                let term = match is_open {
                    // Infinite for a parameter of its own; no number between two.
                    true if direction[i].abs() < 1e-7 || direction[j].abs() < 1e-7 => 0.0,
                    true if i == j => f64::INFINITY,
                    true => f64::NAN,
                    false => share / (sigma * sigma * norms[i] * norms[j]),
                };
                inverse[i * m + j] += term;
            }
        }
    }
    inverse
}

/// These columns of the triangle, each of norm 1, and their norms.
pub(super) fn scaled(triangle: &Triangle, columns: &[usize]) -> (Vec<f64>, Vec<f64>) {
    let norms: Vec<f64> = columns.iter().map(|j| triangle.norm(*j)).collect();
    let rows = columns.iter().max().map_or(0, |last| last + 1);
    let entry = |i: usize, k: usize| if norms[k] > 0.0 { triangle.at(i, columns[k]) / norms[k] } else { 0.0 };
    let scaled = (0..columns.len()).flat_map(|k| (0..rows).map(move |i| (i, k))).map(|(i, k)| entry(i, k)).collect();
    (scaled, norms)
}

/// Residuals at a minimum, series by series.
#[derive(Debug, Clone)]
pub(super) struct Residuals(pub(super) Vec<Vec<f64>>);

impl Residuals {
    pub(super) fn new(look: &Look<'_>, values: &[f64]) -> Option<Self> {
        let mut all = vec![Vec::new(); look.problem.series().len()];
        let wanted = vec![false; values.len()];
        look.problem.rows(values, &wanted, &mut |rows| all[rows.series].extend_from_slice(rows.residuals)).ok()?;
        Some(Self(all))
    }

    pub(super) fn count(&self) -> usize {
        self.0.iter().map(Vec::len).sum()
    }

    /// 1.4826 times the median of |r| of each series.
    pub(super) fn scales(&self) -> Vec<f64> {
        self.0.iter().map(|series| 1.4826 * median(series.iter().map(|r| r.abs()).collect())).collect()
    }

    /// Of each series the correlation of residuals with the next one, about their mean.
    pub(super) fn lag1(&self) -> Vec<f64> {
        self.0.iter().map(|series| lag1(series)).collect()
    }

    /// By what correlated residuals widen every standard deviation.
    pub(super) fn widening(&self) -> f64 {
        let rows = self.0.iter().map(Vec::len);
        let correlated = self
            .lag1()
            .into_iter()
            .zip(rows)
            .filter(|(rho, rows)| *rho > CORRELATED && *rho > 2.0 / (*rows as f64).sqrt());
        let rho = correlated.map(|(rho, _)| rho).fold(0.0, f64::max);
        ((1.0 + rho) / (1.0 - rho)).sqrt()
    }
}

fn lag1(series: &[f64]) -> f64 {
    let mean = series.iter().sum::<f64>() / series.len().max(1) as f64;
    let both: f64 = series.windows(2).map(|pair| (pair[0] - mean) * (pair[1] - mean)).sum();
    let square: f64 = series.iter().map(|r| (r - mean).powi(2)).sum();
    if square > 0.0 { both / square } else { 0.0 }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        n if !n.is_multiple_of(2) => values[n / 2],
        n => 0.5 * (values[n / 2 - 1] + values[n / 2]),
    }
}

/// Covariance of `columns` in the units of the parameters, before widening.
///
/// σ²(JᵀJ)⁻¹; where a loss is Huber's, H⁻¹ M H⁻¹ with H = Σ m JᵀJ and M = Σ v JᵀJ over the series, m the share of rows that the loss takes as
/// squares and v the mean square of its influence (P. J. Huber, Ann. Statist. 1 (1973) 799–821).
pub(super) fn covariance(
    look: &Look<'_>,
    places: &[Place],
    columns: &[usize],
    residuals: &Residuals,
    noise: f64,
) -> Option<(Vec<f64>, Triangle)> {
    let values = look.values(places);
    let (n, m) = (values.len(), columns.len());
    let wanted: Vec<bool> = (0..n).map(|j| columns.contains(&j)).collect();
    let triangle = look.by_values(&values, &wanted)?;
    if look.problem.series().iter().all(|series| series.loss == Loss::Squares) {
        let covariance = inverse(&triangle, columns).into_iter().map(|entry| noise * entry).collect();
        return Some((covariance, triangle));
    }
    let freedom = look.freedom(m) / residuals.count() as f64;
    let weights: Vec<(f64, f64)> = residuals
        .0
        .iter()
        .enumerate()
        .map(|(s, rows)| {
            let (loss, count) = (look.loss(s), rows.len().max(1) as f64);
            let inside = rows.iter().filter(|r| loss.is_inside(**r)).count() as f64 / count;
            let square = rows.iter().map(|r| loss.influence(*r).powi(2)).sum::<f64>() / count;
            (inside.sqrt(), (square / freedom).sqrt())
        })
        .collect();
    let bread = look.weighted(&values, &wanted, |series| weights[series].0)?;
    let meat = look.weighted(&values, &wanted, |series| weights[series].1)?;
    let bread = inverse(&bread, columns);
    let meat = |i: usize, j: usize| meat.product(columns[i], columns[j]);
    let half: Vec<f64> =
        (0..m * m).map(|at| (0..m).map(|k| bread[at / m * m + k] * meat(k, at % m)).sum::<f64>()).collect();
    let covariance = (0..m * m).map(|at| (0..m).map(|k| half[at / m * m + k] * bread[k * m + at % m]).sum()).collect();
    Some((covariance, triangle))
}

/// Criteria of a cost over n rows and p parameters, to choose among laws: those of least value are best. The variance counts as one more
/// parameter (K. P. Burnham, D. R. Anderson, Model Selection and Multimodel Inference, 2002).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criteria {
    /// Akaike's, corrected for few rows: n ln(cost/n) + 2(p + 1) + 2(p + 1)(p + 2)/(n − p − 2); infinite for fewer rows than that.
    pub aicc: f64,
    /// Schwarz's: n ln(cost/n) + (p + 1) ln n.
    pub bic: f64,
}

impl Criteria {
    /// Those of a cost.
    pub fn new(cost: f64, rows: usize, parameters: usize) -> Self {
        let (n, p) = (rows as f64, parameters as f64);
        let fit = n * (cost / n).max(f64::MIN_POSITIVE).ln();
        let correction = if n > p + 2.0 { 2.0 * (p + 1.0) * (p + 2.0) / (n - p - 2.0) } else { f64::INFINITY };
        Self { aicc: fit + 2.0 * (p + 1.0) + correction, bic: fit + (p + 1.0) * n.ln() }
    }
}
