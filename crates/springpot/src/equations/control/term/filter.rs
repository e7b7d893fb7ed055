//! A filter of first order behind a derivative.

use crate::collocation::{MAX_NODES, Nodes, STAGES, quadrature};
use crate::law::Response;
use crate::linalg::Lu;

/// T·y' + y = d over a run, y(0) = 0, collocated at the nodes of every step.
#[derive(Debug, Clone)]
pub(super) struct Filter {
    /// T > 0, s.
    time: f64,
    /// y at the start of the step.
    start: f64,
    /// y_i = Σ_j weight_ij d_j + of_start_i·y_0 at the nodes.
    weight: [[f64; STAGES]; STAGES],
    of_start: [f64; STAGES],
    /// y' at the start and at the nodes.
    rate: [f64; STAGES + 1],
}

/// The longest step, s, after which what began with a filter of that time is known to a share of `tolerance`: R(−h/T) − e^{−h/T} ≈ (h/T)⁶/7200 a step.
pub(in crate::equations::control) fn longest_step(time: f64, tolerance: f64) -> f64 {
    time * (7200.0 * tolerance).powf(0.2)
}

impl Filter {
    pub(super) fn new(time: f64) -> Self {
        let (weight, of_start) = ([[0.0; STAGES]; STAGES], [0.0; STAGES]);
        Self { time, start: 0.0, weight, of_start, rate: [0.0; STAGES + 1] }
    }

    /// Begins a step of size `h` at whose start y is `start` and d is `derivative`.
    pub(super) fn start(&mut self, h: f64, nodes: Nodes, [start, derivative]: [f64; 2]) {
        self.start = start;
        self.rate[0] = (derivative - start) / self.time;
        // (I + h/T·A)·y = y_0 + h/T·A·d.
        let share = h / self.time;
        let matrix = nodes.matrix();
        let mut lu = Lu::default();
        lu.factor(STAGES, |own| {
            for (i, row) in matrix.iter().enumerate().take(STAGES) {
                (0..STAGES).for_each(|j| own[i * STAGES + j] = share * row[j] + if i == j { 1.0 } else { 0.0 });
            }
        });
        self.of_start = [1.0; STAGES];
        lu.solve(&mut self.of_start);
        for j in 0..STAGES {
            let mut column: [f64; STAGES] = std::array::from_fn(|i| share * matrix[i][j]);
            lu.solve(&mut column);
            (0..STAGES).for_each(|i| self.weight[i][j] = column[i]);
        }
    }

    /// Puts y at the nodes in place of d.
    pub(super) fn take(&mut self, values: &mut [f64]) {
        let derived: [f64; STAGES] = std::array::from_fn(|i| values[i]);
        for i in 0..STAGES {
            let own = self.weight[i].iter().zip(derived).map(|(weight, d)| weight * d).sum::<f64>();
            values[i] = own + self.of_start[i] * self.start;
            self.rate[i + 1] = (derived[i] - values[i]) / self.time;
        }
    }

    /// What of ∂y_i is ∂d_j.
    pub(super) fn respond(&self, of_derivative: &Response) -> Response {
        let through = |slopes: &[[f64; MAX_NODES]; MAX_NODES]| {
            let mut own = [[0.0; MAX_NODES]; MAX_NODES];
            for i in 0..STAGES {
                for j in 0..STAGES {
                    own[i][j] = (0..STAGES).map(|m| self.weight[i][m] * slopes[m][j]).sum();
                }
            }
            own
        };
        let mut response = Response::default();
        (response.d_stroke, response.d_rate) = (through(&of_derivative.d_stroke), through(&of_derivative.d_rate));
        response
    }

    /// y at θ of the step.
    pub(super) fn at(&self, nodes: Nodes, h: f64, theta: f64) -> f64 {
        let weights = quadrature(nodes, theta);
        self.start + h * weights.iter().zip(self.rate).map(|(weight, rate)| weight * rate).sum::<f64>()
    }

    /// y at the end of a step of size `h` along which d goes straight between its ends, from `start` on.
    pub(super) fn along(&self, h: f64, start: f64, [first, last]: [f64; 2]) -> f64 {
        let share = h / self.time;
        let (decay, slope) = ((-share).exp(), (last - first) / share);
        // d − slope of it in units of T is what y runs after.
        last - slope + (start - first + slope) * decay
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against y = ∫ e^{(s − t)/T} d(s) ds/T.
    #[test]
    fn steps_are_of_their_order() {
        let time = 0.05;
        let exact = |t: f64| {
            // d = sin(3t).
            let w = 3.0 * time;
            ((3.0 * t).sin() - w * (3.0 * t).cos() + w * (-t / time).exp()) / (1.0 + w * w)
        };
        let error = |count: usize, ends: bool| {
            let (mut filter, mut y, h) = (Filter::new(time), 0.0, 1.0 / count as f64);
            for k in 0..count {
                let d = |theta: f64| (3.0 * (k as f64 + theta) * h).sin();
                if ends {
                    y = filter.along(h, y, [d(0.0), d(1.0)]);
                    continue;
                }
                filter.start(h, Nodes::Radau, [y, d(0.0)]);
                let mut values: Vec<f64> = Nodes::Radau.positions().iter().map(|theta| d(*theta)).collect();
                filter.take(&mut values);
                assert!((filter.at(Nodes::Radau, h, 1.0) - values[STAGES - 1]).abs() < 1e-14);
                y = values[STAGES - 1];
            }
            (y - exact(1.0)).abs()
        };
        assert!(error(80, false) < 1e-9 && error(40, false) / error(80, false) > 2.0f64.powf(4.5));
        assert!(error(80, true) < 1e-4 && error(40, true) / error(80, true) > 2.0f64.powf(1.8));
    }
}
