//! An independent D^alpha: quadrature of the Caputo integral with the exact rate of the stroke, no memory and no time loop.
//!
//! The interval is cut at given points (kinks). The panel that touches t carries the singular weight and is done by
//! Gauss–Jacobi; all others lie at least half their width away from t and are done by Gauss–Legendre.

use springpot::dynamics::{Kinematics, pair};
use springpot::elements::{Element, Measure};
use springpot::equations::State;
use springpot::fractional::Kind;
use springpot::fractional::gamma::gamma;
use springpot::law::{InputValue, Point};
use springpot::system::System;
use std::f64::consts::PI;

/// Nodes and weights on [−1, 1].
pub(crate) type Rule = Vec<(f64, f64)>;

/// P_n^{(a,0)} and its derivative, a > −1.
fn jacobi(n: usize, a: f64, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, 0.5 * (a + (a + 2.0) * x));
    for k in 2..=n {
        let k = k as f64;
        let c = 2.0 * k + a;
        let first = 2.0 * k * (k + a) * (c - 2.0);
        let second = (c - 1.0) * (c * (c - 2.0) * x + a * a);
        let third = 2.0 * (k + a - 1.0) * (k - 1.0) * c;
        (before, value) = (value, (second * value - third * before) / first);
    }
    let n = n as f64;
    let c = 2.0 * n + a;
    let derivative = (n * (a - c * x) * value + 2.0 * n * (n + a) * before) / (c * (1.0 - x * x));
    (value, derivative)
}

/// Gauss–Jacobi for the weight (1 − x)^a: exact for polynomials of degree 2n − 1.
pub(crate) fn gauss_jacobi(n: usize, a: f64) -> Rule {
    let mut rule: Rule = Vec::with_capacity(n);
    for k in 0..n {
        // Asymptotic guess, then Newton with the roots found before divided out.
        let mut x = ((k as f64 + 0.75 + 0.5 * a) * PI / (n as f64 + 0.5 * (a + 1.0))).cos();
        for _ in 0..60 {
            let (value, derivative) = jacobi(n, a, x);
            let others: f64 = rule.iter().map(|(root, _)| 1.0 / (x - root)).sum();
            let step = value / (derivative - value * others);
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        let (_, derivative) = jacobi(n, a, x);
        rule.push((x, 1.0 / ((1.0 - x * x) * derivative * derivative)));
    }
    // The weights are known up to a factor; their sum is the integral of the weight function.
    let sum: f64 = rule.iter().map(|(_, w)| w).sum();
    let scale = 2f64.powf(1.0 + a) / (1.0 + a) / sum;
    rule.into_iter().map(|(x, w)| (x, w * scale)).collect()
}

/// The quadrature for one order.
#[derive(Debug)]
pub(crate) struct Truth {
    alpha: f64,
    legendre: Rule,
    jacobi: Rule,
    /// Panel boundaries from 0 to the end, kinks among them.
    panels: Vec<f64>,
    /// The rate at the Gauss–Legendre nodes of the panels, where it was sampled beforehand.
    sampled: Vec<Vec<f64>>,
}

impl Truth {
    /// Panels of at most `width` between 0, `cuts` and `end`.
    pub(crate) fn new(alpha: f64, end: f64, width: f64, cuts: &[f64]) -> Self {
        let mut stops: Vec<f64> = cuts.iter().copied().filter(|t| 0.0 < *t && *t < end).collect();
        stops.push(end);
        stops.sort_by(f64::total_cmp);
        let mut panels = vec![0.0];
        for stop in stops {
            let from = *panels.last().unwrap();
            let count = ((stop - from) / width).ceil().max(1.0) as usize;
            panels.extend((1..count).map(|k| from + (stop - from) * k as f64 / count as f64));
            panels.push(stop);
        }
        Self { alpha, legendre: gauss_jacobi(20, 0.0), jacobi: gauss_jacobi(24, -alpha), panels, sampled: Vec::new() }
    }

    /// Evaluates the rate once at the nodes of every panel; from now on no other rate may be given.
    pub(crate) fn sample(&mut self, rate: &dyn Fn(f64) -> f64) {
        let nodes =
            |w: &[f64]| self.legendre.iter().map(|(x, _)| rate(w[0] + 0.5 * (w[1] - w[0]) * (1.0 + x))).collect();
        self.sampled = self.panels.windows(2).map(nodes).collect();
    }

    /// Caputo derivative at t of the function with rate `rate`; for alpha = 0 the increment, for alpha = 1 the rate.
    pub(crate) fn caputo(&self, t: f64, rate: &dyn Fn(f64) -> f64) -> f64 {
        if self.alpha == 1.0 {
            return rate(t);
        }
        // A boundary within rounding of t is no boundary.
        let last = self.panels.partition_point(|p| *p < t * (1.0 - 1e-12)).max(1) - 1;
        let mut sum = 0.0;
        for k in 0..last {
            let (from, to) = (self.panels[k], self.panels[k + 1]);
            sum += match self.sampled.get(k) {
                Some(rates) if is_far(from, to, t) => self.far(from, to, t, |node, _| rates[node]),
                _ => self.near(from, to, t, rate),
            };
        }
        let (from, half) = (self.panels[last], 0.5 * (t - self.panels[last]));
        let near: f64 = self.jacobi.iter().map(|(x, w)| w * rate(from + half * (1.0 + x))).sum();
        (sum + near * half.powf(1.0 - self.alpha)) / gamma(1.0 - self.alpha)
    }

    /// A panel that does not touch t, cut until it is far enough away.
    fn near(&self, from: f64, to: f64, t: f64, rate: &dyn Fn(f64) -> f64) -> f64 {
        if is_far(from, to, t) {
            return self.far(from, to, t, |_, s| rate(s));
        }
        let middle = if t - to > 1e-3 * (to - from) { 0.5 * (from + to) } else { to - 0.1 * (to - from) };
        self.near(from, middle, t, rate) + self.near(middle, to, t, rate)
    }

    /// A panel far from t; `rate` takes the index of the node and its time.
    fn far(&self, from: f64, to: f64, t: f64, rate: impl Fn(usize, f64) -> f64) -> f64 {
        let half = 0.5 * (to - from);
        let term = |(node, (x, w)): (usize, &(f64, f64))| {
            let s = from + half * (1.0 + x);
            w * (t - s).powf(-self.alpha) * rate(node, s)
        };
        half * self.legendre.iter().enumerate().map(term).sum::<f64>()
    }
}

/// Whether t is at least half the panel's width away from it.
fn is_far(from: f64, to: f64, t: f64) -> bool {
    t - to >= 0.5 * (to - from)
}

/// Length, rate and gradient of an element along the motion of its system, by the rigid bodies alone.
pub(crate) fn pair_at(system: &System, element: &Element, t: f64) -> (f64, f64, Vec<f64>) {
    let State { q, v, .. } = system.state(t).expect("a motion that can be followed");
    let kinematics = Kinematics::at_velocity(&system.model, &q, &v);
    let Measure::Line(line) = &element.measure else { panic!("an element between two points") };
    let (pair, gradient) = pair(&system.model, &kinematics, &line.from, &line.to);
    (pair.length, pair.rate, gradient)
}

/// D^alpha x of element `index` at the times `t` (positive, ascending).
pub(crate) fn derivatives(system: &System, index: usize, times: &[f64], width: f64, cuts: &[f64]) -> Vec<f64> {
    let element = &system.elements[index];
    let inputs = vec![InputValue::default(); element.inputs.len()];
    let alpha = element.law.reported_order(&Point { t: 0.0, stroke: 0.0, rate: 0.0, inputs: &inputs });
    let end = times.last().copied().unwrap_or(1.0);
    let rate = |s: f64| pair_at(system, element, s).1;
    let mut truth = Truth::new(alpha, end, width, cuts);
    truth.sample(&rate);
    let start = pair_at(system, element, 0.0).0;
    let jump = if element.derivative == Kind::RiemannLiouville { element.jump(start) } else { 0.0 };
    let value = |t: f64| match alpha {
        0.0 => {
            let stroke = pair_at(system, element, t).0 - element.rest;
            if element.derivative == Kind::Caputo { stroke - (start - element.rest) } else { stroke }
        }
        1.0 => rate(t),
        _ => truth.caputo(t, &rate) + jump * t.powf(-alpha) / gamma(1.0 - alpha),
    };
    times.iter().map(|t| value(*t)).collect()
}
