//! Parameters within their bounds by the method of Levenberg and Marquardt, from many starts.
//!
//! K. Levenberg, Q. Appl. Math. 2 (1944) 164–168; D. W. Marquardt, J. SIAM 11 (1963) 431–441.

use super::{Datum, Identified, Model, Quantity, sin_cos};
use std::f64::consts::FRAC_PI_2;

/// Largest relative deviation of what counts as met exactly.
pub(super) const EXACT: f64 = 1e-9;
/// A parameter whose effect lies this near to that of the others is not determined.
const DEPENDENT: f64 = 1e-7;
const ITERATIONS: usize = 200;
/// Orders and shares of the spring to start from.
const ORDERS: [f64; 6] = [0.05, 0.2, 0.4, 0.6, 0.8, 0.95];
const SHARES: [f64; 4] = [0.0, 0.3, 0.6, 0.9];

/// Unknowns without dimension: k/K₀, c·ω₀^alpha/K₀, alpha.
type Unknowns = [f64; 3];

/// The data beside their scales.
struct Problem<'a> {
    data: &'a [Datum],
    free: [bool; 3],
    /// Typical stiffness, N/m.
    stiffness: f64,
    /// Typical frequency, rad/s.
    omega: f64,
}

/// The law nearest to the data; `None` where they leave a parameter open.
pub(super) fn nearest(model: Model, data: &[Datum]) -> Option<Identified> {
    let problem = Problem::new(model, data)?;
    let mut best: Option<(f64, Unknowns)> = None;
    for order in ORDERS {
        for share in SHARES {
            let start = match model {
                Model::Spring => [1.0, 0.0, 1.0],
                Model::Dashpot => [0.0, 1.0, 1.0],
                Model::Springpot => [0.0, 1.0 - share, order],
                Model::KelvinVoigt => [share, 1.0 - share, 1.0],
                Model::FractionalKelvinVoigt => [share, 1.0 - share, order],
            };
            let (cost, found) = problem.descend(start);
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, found));
            }
        }
    }
    let (_, [k, c, order]) = best?;
    problem.determines(&[k, c, order]).then(|| Identified {
        model,
        stiffness: k * problem.stiffness,
        coefficient: c * problem.stiffness / problem.omega.powf(order),
        order,
    })
}

impl<'a> Problem<'a> {
    fn new(model: Model, data: &'a [Datum]) -> Option<Self> {
        let mean = |values: Vec<f64>| (values.iter().map(|v| v.ln()).sum::<f64>() / values.len() as f64).exp();
        let frequencies: Vec<f64> = data.iter().map(|datum| datum.omega).filter(|omega| *omega > 0.0).collect();
        let omega = if frequencies.is_empty() { 1.0 } else { mean(frequencies) };
        let stiffnesses = data.iter().filter_map(|datum| match datum.quantity {
            Quantity::LossFactor => None,
            Quantity::Damping => Some(datum.value * if datum.omega > 0.0 { datum.omega } else { omega }),
            _ => Some(datum.value),
        });
        let stiffnesses: Vec<f64> = stiffnesses.collect();
        (!stiffnesses.is_empty()).then(|| Self { data, free: model.free(), stiffness: mean(stiffnesses), omega })
    }

    /// Relative deviation of one datum and its derivatives by the unknowns.
    fn deviation(&self, datum: &Datum, &[k, c, order]: &Unknowns) -> (f64, [f64; 3]) {
        let (sin, cos) = sin_cos(order);
        let ratio = datum.omega / self.omega;
        let (power, log) = match datum.omega {
            0.0 => (if order == 0.0 { 1.0 } else { 0.0 }, 0.0),
            _ => (ratio.powf(order), ratio.ln()),
        };
        let part = [power * cos, power * sin];
        let value = [k + c * part[0], c * part[1]];
        let by =
            [[1.0, 0.0], part, [c * (part[0] * log - FRAC_PI_2 * part[1]), c * (part[1] * log + FRAC_PI_2 * part[0])]];
        let wanted = datum.value / if datum.quantity == Quantity::LossFactor { 1.0 } else { self.stiffness };
        // The value of the quantity, and its derivatives by Re K and Im K.
        let (model, weights) = match datum.quantity {
            Quantity::LossFactor => {
                let tan = value[1] / value[0];
                (tan, [-tan / value[0], 1.0 / value[0]])
            }
            Quantity::Stiffness => {
                let size = value[0].hypot(value[1]);
                (size, value.map(|part| part / size))
            }
            Quantity::Storage => (value[0], [1.0, 0.0]),
            Quantity::Loss => (value[1], [0.0, 1.0]),
            // At rest it is the c of a dashpot.
            Quantity::Damping if datum.omega == 0.0 => {
                return (c / self.omega / wanted - 1.0, [0.0, 1.0 / (self.omega * wanted), 0.0]);
            }
            Quantity::Damping => (value[1] / datum.omega, [0.0, 1.0 / datum.omega]),
        };
        (model / wanted - 1.0, by.map(|d| (weights[0] * d[0] + weights[1] * d[1]) / wanted))
    }

    fn cost(&self, unknowns: &Unknowns) -> f64 {
        let cost = self.data.iter().map(|datum| self.deviation(datum, unknowns).0.powi(2)).sum();
        if f64::is_nan(cost) { f64::INFINITY } else { cost }
    }

    /// The least cost that is reached from `start`, and where.
    fn descend(&self, start: Unknowns) -> (f64, Unknowns) {
        let (mut at, mut cost, mut damping) = (start, self.cost(&start), 1e-3);
        for _ in 0..ITERATIONS {
            if !cost.is_finite() || cost == 0.0 {
                break;
            }
            let (mut normal, mut gradient) = ([[0.0; 3]; 3], [0.0; 3]);
            for datum in self.data {
                let (deviation, slopes) = self.deviation(datum, &at);
                for i in 0..3 {
                    gradient[i] += slopes[i] * deviation;
                    for j in 0..3 {
                        normal[i][j] += slopes[i] * slopes[j];
                    }
                }
            }
            let moves: [bool; 3] = std::array::from_fn(|i| {
                let leaves_below = at[i] <= 0.0 && gradient[i] > 0.0;
                let leaves_above = i == 2 && at[i] >= 1.0 && gradient[i] < 0.0;
                self.free[i] && !leaves_below && !leaves_above
            });
            for i in 0..3 {
                for j in 0..3 {
                    if !(moves[i] && moves[j]) {
                        normal[i][j] = 0.0;
                    }
                }
                normal[i][i] = if moves[i] { normal[i][i] * (1.0 + damping) } else { 1.0 };
                gradient[i] = if moves[i] { gradient[i] } else { 0.0 };
            }
            let Some(step) = solve(normal, gradient) else { break };
            let mut next: Unknowns = std::array::from_fn(|i| (at[i] - step[i]).max(0.0));
            next[2] = next[2].min(1.0);
            let next_cost = self.cost(&next);
            if next_cost < cost {
                (at, cost, damping) = (next, next_cost, (damping / 10.0).max(1e-15));
            } else {
                damping *= 10.0;
                if damping > 1e12 {
                    break;
                }
            }
        }
        (cost, at)
    }

    /// Whether every free parameter changes the data in its own way.
    fn determines(&self, at: &Unknowns) -> bool {
        let rows: Vec<[f64; 3]> = self.data.iter().map(|datum| self.deviation(datum, at).1).collect();
        let columns = (0..3).filter(|&i| self.free[i]).map(|i| rows.iter().map(|row| row[i]).collect::<Vec<f64>>());
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for mut column in columns {
            let size = norm(&column);
            for other in &basis {
                let along: f64 = column.iter().zip(other).map(|(a, b)| a * b).sum();
                column.iter_mut().zip(other).for_each(|(a, b)| *a -= along * b);
            }
            let rest = norm(&column);
            if !rest.is_finite() || rest <= DEPENDENT * size {
                return false;
            }
            basis.push(column.iter().map(|a| a / rest).collect());
        }
        true
    }
}

fn norm(column: &[f64]) -> f64 {
    column.iter().map(|a| a * a).sum::<f64>().sqrt()
}

/// A positive definite system by Cholesky; `None` where it is singular.
fn solve(a: [[f64; 3]; 3], b: [f64; 3]) -> Option<[f64; 3]> {
    let mut l = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..=i {
            let rest = a[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            l[i][j] = if i == j { rest.sqrt() } else { rest / l[j][j] };
        }
        if l[i][i].is_nan() || l[i][i] <= 0.0 {
            return None;
        }
    }
    let mut x = b;
    for i in 0..3 {
        x[i] = (x[i] - (0..i).map(|k| l[i][k] * x[k]).sum::<f64>()) / l[i][i];
    }
    for i in (0..3).rev() {
        x[i] = (x[i] - (i + 1..3).map(|k| l[k][i] * x[k]).sum::<f64>()) / l[i][i];
    }
    Some(x)
}
