//! Parameters within their bounds by least squares, from many starts.

use super::{Datum, Identified, Model, Quantity, sin_cos};
use crate::identification::{self, Failed, Parameter, Rows, Scale, Series, Settings};
use crate::linalg::are_independent;
use std::f64::consts::FRAC_PI_2;
use std::sync::atomic::AtomicBool;

/// Largest relative deviation of what counts as met exactly.
pub(super) const EXACT: f64 = 1e-9;
/// Orders and shares of the spring to start from.
const ORDERS: [f64; 6] = [0.05, 0.2, 0.4, 0.6, 0.8, 0.95];
const SHARES: [f64; 4] = [0.0, 0.3, 0.6, 0.9];

/// Unknowns without dimension: k/K₀, c·ω₀^alpha/K₀, alpha.
type Unknowns = [f64; 3];

/// The data beside their scales.
struct Problem<'a> {
    data: &'a [Datum],
    free: [bool; 3],
    /// What is not free.
    fixed: Unknowns,
    parameters: Vec<Parameter>,
    series: [Series; 1],
    /// Typical stiffness, N/m.
    stiffness: f64,
    /// Typical frequency, rad/s.
    omega: f64,
}

/// The law nearest to the data; `None` where they leave a parameter open.
pub(super) fn nearest(model: Model, data: &[Datum]) -> Option<Identified> {
    let mut problem = Problem::new(model, data)?;
    let start = |(order, share): (f64, f64)| match model {
        Model::Spring => [1.0, 0.0, 1.0],
        Model::Dashpot => [0.0, 1.0, 1.0],
        Model::Springpot => [0.0, 1.0 - share, order],
        Model::KelvinVoigt => [share, 1.0 - share, 1.0],
        Model::FractionalKelvinVoigt => [share, 1.0 - share, order],
    };
    let starts: Vec<Unknowns> = ORDERS.iter().flat_map(|order| SHARES.map(|share| start((*order, share)))).collect();
    problem.begin(&starts);
    let settings = Settings { starts: starts.len(), ..Settings::default() };
    let found = identification::fit(&problem, &settings, &AtomicBool::new(false)).ok()?;
    let [k, c, order] = problem.whole(&found.values);
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
        (!stiffnesses.is_empty()).then(|| Self {
            data,
            free: model.free(),
            fixed: [0.0, 0.0, 1.0],
            parameters: Vec::new(),
            series: [Series::new("deviation")],
            stiffness: mean(stiffnesses),
            omega,
        })
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

    /// Where it is looked for from.
    fn begin(&mut self, starts: &[Unknowns]) {
        let bounds = [[0.0, f64::INFINITY], [0.0, f64::INFINITY], [0.0, 1.0]];
        let parameter = |i: usize| Parameter {
            start: starts.iter().map(|start| start[i]).collect(),
            scale: Scale::Linear,
            ..Parameter::new(["k", "c", "alpha"][i], 1.0, bounds[i])
        };
        self.parameters = (0..3).filter(|i| self.free[*i]).map(parameter).collect();
    }

    /// All unknowns, of the free ones.
    fn whole(&self, free: &[f64]) -> Unknowns {
        let mut free = free.iter();
        std::array::from_fn(|i| self.free[i].then(|| free.next()).flatten().copied().unwrap_or(self.fixed[i]))
    }

    /// Whether every free parameter changes the data in its own way.
    fn determines(&self, at: &Unknowns) -> bool {
        let rows: Vec<[f64; 3]> = self.data.iter().map(|datum| self.deviation(datum, at).1).collect();
        are_independent((0..3).filter(|&i| self.free[i]).map(|i| rows.iter().map(|row| row[i]).collect()))
    }
}

impl identification::Problem for Problem<'_> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn series(&self) -> &[Series] {
        &self.series
    }

    fn rows(&self, values: &[f64], _: &[bool], take: &mut dyn FnMut(Rows<'_>)) -> Result<(), Failed> {
        let at = self.whole(values);
        for datum in self.data {
            let (value, by) = self.deviation(datum, &at);
            let jacobian: Vec<f64> = (0..3).filter(|i| self.free[*i]).map(|i| by[i]).collect();
            take(Rows { series: 0, residuals: &[value], jacobian: &jacobian });
        }
        Ok(())
    }
}
