//! A memory replayed in complex numbers with the modes, steps and shares of a run held: its imaginary parts are derivatives without
//! cancellation (W. Squire, G. Trapp, SIAM Rev. 40 (1998) 110–112).

use super::super::order::ByOrder;
use super::super::{Singular, TangentStep};
use crate::collocation::{MAX_NODES, NODE_POLYNOMIAL, Nodes};
use crate::fractional::exponentials::moments;
use crate::fractional::memory::{Memory, NEXT_TO_NODE, collocated};
use crate::fractional::step::SEXTIC;
use crate::fractional::{Form, Kind};
use num_complex::Complex64;
use std::f64::consts::PI;

pub(super) type C = Complex64;

/// The imaginary unit of the parameter.
pub(super) const TINY: f64 = 1e-40;

pub(super) fn real(x: f64) -> C {
    C::new(x, 0.0)
}

/// Γ for Re z > ½ by Stirling's series (DLMF 5.11.1), z taken upwards by the recurrence.
pub(super) fn gamma(z: C) -> C {
    let (mut z, mut below) = (z, real(1.0));
    while z.re < 14.0 {
        below *= z;
        z += 1.0;
    }
    let series = [1.0 / 12.0, -1.0 / 360.0, 1.0 / 1260.0, -1.0 / 1680.0, 1.0 / 1188.0, -691.0 / 360_360.0, 1.0 / 156.0];
    let square = (z * z).inv();
    let rest = series.iter().rev().fold(real(0.0), |sum, c| sum * square + c) / z;
    ((z - 0.5) * z.ln() - z + 0.5 * (2.0 * PI).ln() + rest).exp() / below
}

fn power(x: f64, exponent: C) -> C {
    (exponent * x.ln()).exp()
}

/// e^z − 1 for z that are not small, or whose imaginary part is.
fn exp_m1(z: C) -> C {
    C::new(z.re.exp_m1(), z.im * z.re.exp())
}

/// The memory.
pub(super) struct Replay {
    alpha: C,
    kind: Kind,
    origin: C,
    jump: C,
    eta: f64,
    delta: f64,
    /// Rates, and z; those of the tail have the real weights of the memory.
    lambda: Vec<f64>,
    tail: Vec<f64>,
    z: Vec<C>,
    /// λ, ẇ and z of the tail of the derivative.
    slow: Vec<(f64, f64, C)>,
    order: f64,
    last: (f64, [C; SEXTIC]),
    is_empty: bool,
    travelled: C,
    pub(super) now: C,
    /// Share of the stroke that jumps by this, at this time.
    pub(super) jumps: Vec<(f64, C)>,
}

impl Replay {
    /// As the memory is at t = 0; `order` says how the parameter moves α, in units of [`TINY`].
    pub(super) fn of(memory: &Memory, order: f64, origin: C, jump: C) -> Self {
        let kernel = memory.past().unwrap().kernel();
        let by_order = ByOrder::of(kernel);
        let tail = by_order.ratios().iter().filter(|ratio| **ratio == 0.0).count();
        let slow = by_order.slow.kernel();
        Self {
            alpha: C::new(memory.alpha(), order * TINY),
            kind: memory.kind(),
            origin,
            jump,
            eta: kernel.eta,
            delta: kernel.delta,
            lambda: kernel.lambda.clone(),
            tail: kernel.weight[kernel.modes() - tail..].to_vec(),
            z: vec![real(0.0); kernel.modes()],
            slow: slow.lambda.iter().zip(&slow.weight).map(|(l, w)| (*l, *w, real(0.0))).collect(),
            order,
            last: (0.0, [real(0.0); SEXTIC]),
            is_empty: true,
            travelled: real(0.0),
            now: real(0.0),
            jumps: Vec::new(),
        }
    }

    fn strength(&self) -> C {
        (self.alpha * PI).sin() / PI
    }

    /// w of mode k.
    fn weight(&self, k: usize) -> C {
        match k.checked_sub(self.lambda.len() - self.tail.len()) {
            Some(k) => real(self.tail[k]),
            None => self.trapezoid(self.lambda[k]),
        }
    }

    fn trapezoid(&self, lambda: f64) -> C {
        self.strength() * self.eta * power(lambda, self.alpha)
    }

    /// What moves a weight of the tail.
    fn moved(&self, weight: f64) -> C {
        C::new(0.0, self.order * TINY * weight)
    }

    fn faster(&self, lag: f64) -> Vec<f64> {
        if lag >= self.delta {
            return Vec::new();
        }
        let missing = ((self.delta / lag).ln() / self.eta).ceil() as usize + 2;
        (1..=missing).rev().map(|k| self.lambda[0] * (self.eta * k as f64).exp()).collect()
    }

    fn fast_mode(&self, lambda: f64) -> C {
        taken(lambda, self.last.0, &self.last.1)
    }

    /// Σ w e^{−λτ} z.
    fn history(&self, lag: f64) -> C {
        if self.is_empty {
            return real(0.0);
        }
        let kept: C = (0..self.z.len()).map(|k| self.weight(k) * self.z[k] * (-self.lambda[k] * lag).exp()).sum();
        let slow: C = self.slow.iter().map(|(l, w, z)| self.moved(*w) * z * (-l * lag).exp()).sum();
        let fast = self.faster(lag).into_iter();
        kept + slow + fast.map(|l| self.trapezoid(l) * (-l * lag).exp() * self.fast_mode(l)).sum::<C>()
    }

    fn mean_history(&self, h: f64) -> C {
        if self.is_empty {
            return real(0.0);
        }
        let psi = |lambda: f64| -(-lambda * h).exp_m1() / (lambda * h);
        let kept: C = (0..self.z.len()).map(|k| self.weight(k) * self.z[k] * psi(self.lambda[k])).sum();
        let slow: C = self.slow.iter().map(|(l, w, z)| self.moved(*w) * z * psi(*l)).sum();
        kept + slow + self.fast_tail(self.lambda[0])[1] * self.last.1.iter().sum::<C>() / h
    }

    /// d1, d2, d3 above λ_0.
    fn fast_tail(&self, lambda: f64) -> [C; 3] {
        [1.0, 2.0, 3.0].map(|n| {
            let rest = real(n) - self.alpha;
            self.strength() * self.eta * power(lambda, -rest) / exp_m1(rest * self.eta)
        })
    }

    /// p!/Γ(p+2−α) h^{1−α} θ^{p+1−α}.
    fn moment(&self, p: usize, h: f64, theta: f64) -> C {
        let factorial = (1..=p).map(|k| k as f64).product::<f64>();
        let scale = power(theta * h, real(1.0) - self.alpha);
        scale * theta.powi(p as i32) * factorial / gamma(real(p as f64 + 2.0) - self.alpha)
    }

    fn local(&self, u: &[C; SEXTIC], h: f64, theta: f64) -> C {
        (0..SEXTIC).map(|p| u[p] * self.moment(p, h, theta)).sum()
    }

    /// Each share of the stroke that jumped, with its time.
    fn starts(&self) -> Vec<(f64, C)> {
        let is_singular = self.kind == Kind::RiemannLiouville;
        let start = is_singular.then_some((0.0, self.jump));
        start.into_iter().chain(self.jumps.iter().copied()).collect()
    }

    pub(super) fn singular_part(&self, t: f64) -> C {
        let parts = self.starts().into_iter();
        parts.map(|(at, jump)| jump * power(t - at, -self.alpha) / gamma(real(1.0) - self.alpha)).sum()
    }

    fn singular_moments(&self, step: &TangentStep) -> [C; MAX_NODES] {
        let one = real(1.0);
        let impulse = |c: f64| -> C {
            let until = |t: f64| if t == 0.0 { real(0.0) } else { power(t, one - self.alpha) };
            let (t, lag) = (step.start.t, c * step.start.h);
            let parts = self.starts().into_iter();
            parts.map(|(at, jump)| jump * (until(t - at + lag) - until(t - at))).sum::<C>()
                / gamma(real(2.0) - self.alpha)
                / step.start.h
        };
        let [re, im] = [
            collocated(|c| impulse(c).re, step.nodes, step.places),
            collocated(|c| impulse(c).im, step.nodes, step.places),
        ];
        std::array::from_fn(|i| C::new(re[i], im[i]))
    }

    /// D^α x at the nodes.
    pub(super) fn respond(&self, step: &TangentStep, u: &[C; SEXTIC], singular: Singular) -> Vec<C> {
        let (h, places) = (step.start.h, step.positions());
        let moments = self.singular_moments(step);
        (0..step.nodes.count())
            .map(|i| {
                let c = places[i];
                let regular = if step.nodes == Nodes::Midpoint {
                    let factor = power(h, real(1.0) - self.alpha) / gamma(real(3.0) - self.alpha);
                    factor * u[0] + self.mean_history(h)
                } else {
                    self.local(u, h, c) + self.history(c * h)
                };
                regular
                    + match singular {
                        Singular::Moments => moments[i],
                        Singular::Values => self.singular_part(step.start.t + c * h),
                        Singular::Apart => real(0.0),
                    }
            })
            .collect()
    }

    /// D^α x at θ, without singular parts.
    pub(super) fn at(&self, step: &TangentStep, u: &[C; SEXTIC], theta: f64, rate: C) -> C {
        let h = step.start.h;
        let value = self.local(u, h, theta) + self.history(theta * h);
        if step.form != Form::Rates || step.nodes != Nodes::Radau || theta == 1.0 {
            return value;
        }
        let nodes = step.places.map_or(NODE_POLYNOMIAL, |places| places.node_polynomial());
        let at: f64 = (0..5).map(|p| nodes[p] * theta.powi(p as i32)).sum();
        let cubic: C = (0..4).map(|p| u[p] * theta.powi(p as i32)).sum();
        let miss = (rate - cubic) * at / (at * at + NEXT_TO_NODE);
        value + miss * (0..5).map(|p| self.moment(p, h, theta) * nodes[p]).sum::<C>()
    }

    /// What is stored and how fast it dissipates at θ.
    pub(super) fn energy(&self, step: &TangentStep, u: &[C; SEXTIC], theta: f64, rate: C) -> [C; 2] {
        if theta == 0.0 && self.is_empty {
            return [real(0.0); 2];
        }
        let h = step.start.h;
        let lag = theta * h;
        let scaled: [C; SEXTIC] = std::array::from_fn(|p| u[p] * theta.powi(p as i32));
        let shortest = Nodes::Radau.positions()[0] * h;
        let front = if shortest < 0.25 * self.delta { self.faster(shortest) } else { Vec::new() };
        let mut forms = [real(0.0); 2];
        let mut take = |lambda: f64, weight: C, z: C, is_front: bool| {
            let mut value = z * (-lambda * lag).exp() + taken(lambda, lag, &scaled);
            for (t, size) in &self.jumps {
                value += *size * (-lambda * (step.start.t + lag - t)).exp();
            }
            if !(is_front && theta == 0.0) {
                forms[0] += weight * value * value * 0.5;
            }
            forms[1] += weight * value * value * lambda;
        };
        for k in 0..self.z.len() {
            take(self.lambda[k], self.weight(k), self.z[k], false);
        }
        front.iter().for_each(|l| take(*l, self.trapezoid(*l), self.fast_mode(*l), true));
        self.slow.iter().for_each(|(l, w, z)| take(*l, self.moved(*w), *z, false));
        let top = front.first().copied().unwrap_or(self.lambda[0]);
        let [d1, d2, d3] = self.fast_tail(top);
        let inertia = if theta == 0.0 { self.fast_tail(self.lambda[0])[1] } else { d2 };
        let bend = (1..SEXTIC).map(|p| u[p] * (p as f64 * theta.powi(p as i32 - 1))).sum::<C>() / h;
        [forms[0] + inertia * rate * rate * 0.5, forms[1] + rate * (d1 * rate - d2 * bend * 2.0) + d3 * bend * bend]
    }

    /// Takes a step that the memory has not committed yet; it ends at x = `end`, where x is known to `resolution`.
    pub(super) fn commit(&mut self, memory: &Memory, step: &TangentStep, u: &[C; SEXTIC], end: Option<(C, f64)>) {
        let (h, mut u) = (step.start.h, *u);
        self.now = self.local(&u, h, 1.0) + self.history(h);
        let travel = |u: &[C; SEXTIC]| (0..SEXTIC).map(|p| u[p] * (h / (p + 1) as f64)).sum::<C>();
        if let Some((stroke, resolution)) = end
            && let Some(debt) = memory.debt(&step.polynomial, stroke.re, resolution)
        {
            let owed = (stroke - self.origin) - (self.travelled + travel(&u));
            u[0] += owed * (debt.rate / debt.owed);
        }
        self.travelled += travel(&u);
        let shortest = memory.shortest_lag(h, step.places);
        let front = self.faster(shortest);
        if !front.is_empty() {
            let z: Vec<C> = front.iter().map(|l| self.fast_mode(*l)).collect();
            self.delta *= (-self.eta * front.len() as f64).exp();
            self.lambda.splice(0..0, front);
            self.z.splice(0..0, z);
        }
        for (lambda, z) in self.lambda.iter().zip(&mut self.z) {
            *z = *z * (-lambda * h).exp() + taken(*lambda, h, &u);
        }
        for (lambda, _, z) in &mut self.slow {
            *z = *z * (-*lambda * h).exp() + taken(*lambda, h, &u);
        }
        (self.last, self.is_empty) = ((h, u), false);
        let surplus = ((shortest / self.delta).ln() / self.eta).floor();
        if surplus >= 16.0 {
            self.lambda.drain(..surplus as usize);
            self.z.drain(..surplus as usize);
            self.delta *= (self.eta * surplus).exp();
        }
    }

    /// A stretch by x(0) that was `age` before t = 0.
    pub(super) fn age(&mut self, age: C) {
        self.now += self.jump * (-self.alpha * age.ln()).exp() / gamma(real(1.0) - self.alpha);
        let jump = std::mem::take(&mut self.jump);
        for (lambda, z) in self.lambda.iter().zip(&mut self.z) {
            *z += jump * (-age * *lambda).exp();
        }
        self.slow.iter_mut().for_each(|(lambda, _, z)| *z += jump * (-age * *lambda).exp());
        (self.is_empty, self.last.0) = (false, age.re);
    }
}

/// ∫ e^{−λ(τ−s)} y(s/τ) ds over a piece of width τ.
fn taken(lambda: f64, width: f64, y: &[C; SEXTIC]) -> C {
    let mut psi = [0.0; SEXTIC];
    moments(lambda * width, &mut psi);
    y.iter().zip(psi).map(|(y, psi)| y * psi).sum::<C>() * width
}
