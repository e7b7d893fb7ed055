//! How large a motion is, so that a relative tolerance means the same from a nanometre to a kilometre.

use crate::model::Model;
use serde::{Deserialize, Serialize};

/// Relative tolerance of the motion's own size, and what it need not fall below.
#[derive(Debug, Clone, Copy)]
pub(in crate::methods) struct Tolerance {
    pub(in crate::methods) rtol: f64,
    /// 0 where none was asked for.
    pub(in crate::methods) atol: f64,
}

impl Tolerance {
    pub(in crate::methods) fn of(&self, size: f64) -> f64 {
        self.atol.max(self.rtol * size.abs())
    }
}

/// How much less than expected a motion may come to before nothing more is expected of it.
const SHORTFALL: f64 = 0.1;

/// Share of the time in which a system answers that no force of a series is resolved below.
const ONSET: f64 = 1e-6;

/// The largest travel |q − q(0)| and speed |v| of every velocity, so far and as the forces at a start or restart let expect.
///
/// Accelerations a that a system answers at the rate ω lead to the speed a·min(t, 1/ω), and so far; what falls short of that, since forces
/// change or something stands in the way, is measured by what it does alone. A singular start moves it at once: there it is a/ω from the first.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(in crate::methods) struct Sizes {
    from: Vec<f64>,
    travel: Vec<f64>,
    speed: Vec<f64>,
    /// Of the expectation: from when on it counts, s, the rate, rad/s, and the accelerations as speeds and as places come from them; 0 where none is
    /// expected.
    since: f64,
    omega: f64,
    is_singular: bool,
    to_travel: Vec<f64>,
    to_speed: Vec<f64>,
    /// Accelerations that come within a stretch of time, s, in which the system answers them, until it is over: what begins as a power of t is
    /// measured by what it comes to soon.
    ahead: Vec<f64>,
    stretch: f64,
    looked: f64,
    /// Share of 1/ω below which no time is told from another.
    onset: f64,
}

impl Sizes {
    pub(in crate::methods) fn new(q: &[f64], nv: usize) -> Self {
        let zero = vec![0.0; nv];
        Self {
            from: q.to_vec(),
            travel: zero.clone(),
            speed: zero.clone(),
            since: 0.0,
            omega: 0.0,
            is_singular: false,
            to_travel: zero.clone(),
            to_speed: zero.clone(),
            ahead: zero,
            stretch: 0.0,
            looked: 0.0,
            onset: 0.0,
        }
    }

    /// Forces may begin like no power of t, alike on every scale of time: what they lead to at first is measured by what it soon is.
    pub(in crate::methods) fn set_steep(&mut self) {
        self.onset = ONSET;
    }

    /// Takes a state of the run in.
    pub(in crate::methods) fn take(&mut self, model: &Model, t: f64, q: &[f64], v: &[f64]) {
        let travel = model.difference(&self.from, q);
        for (largest, value) in self.travel.iter_mut().zip(&travel).chain(self.speed.iter_mut().zip(v)) {
            *largest = largest.max(value.abs());
        }
        if t >= self.looked {
            self.ahead.fill(0.0);
        }
        let time = self.elapsed(t);
        let travels = self.travel.iter().zip(&mut self.to_travel).map(|(seen, a)| (seen, a, 0.5 * time * time));
        let speeds = self.speed.iter().zip(&mut self.to_speed).map(|(seen, a)| (seen, a, time));
        for (_, a, _) in travels.chain(speeds).filter(|(seen, a, factor)| **seen < SHORTFALL * **a * factor) {
            *a = 0.0;
        }
    }

    /// Where accelerations `a` begin at `t` in a system that answers them at the rate `omega` (rad/s).
    pub(in crate::methods) fn expect(&mut self, t: f64, a: &[f64], omega: f64, is_singular: bool) {
        (self.since, self.omega, self.is_singular) = (t, omega, is_singular);
        let finite = |a: &f64| if a.is_finite() { a.abs() } else { 0.0 };
        self.to_travel = a.iter().map(finite).collect();
        self.to_speed = self.to_travel.clone();
    }

    /// Changes of the accelerations by `ahead` are to come within `stretch` seconds from what began last, till which nothing falls short of them.
    pub(in crate::methods) fn look_ahead(&mut self, ahead: Vec<f64>, stretch: f64) {
        (self.ahead, self.stretch, self.looked) = (ahead, stretch, self.since + stretch);
    }

    /// Until when what comes is known, s.
    pub(in crate::methods) fn looked(&self) -> f64 {
        self.looked
    }

    /// When what acts began last, s.
    pub(in crate::methods) fn since(&self) -> f64 {
        self.since
    }

    /// Whether velocity `k` has been 0 so far.
    pub(in crate::methods) fn rests(&self, k: usize) -> bool {
        self.speed[k] == 0.0
    }

    /// The time in which the system answers what began last, s.
    pub(in crate::methods) fn response(&self) -> f64 {
        self.omega.recip()
    }

    /// The largest speed of velocity `k` until `t`.
    pub(in crate::methods) fn speed(&self, k: usize, t: f64) -> f64 {
        self.speed[k].max(self.to_speed[k] * self.time(t)).max(self.coming(k, t))
    }

    /// The speed of velocity `k` until `t` by what was seen ahead.
    pub(in crate::methods) fn coming(&self, k: usize, t: f64) -> f64 {
        self.ahead[k] * self.elapsed(t).min(self.stretch)
    }

    /// The largest travel of velocity `k` until `t`.
    pub(in crate::methods) fn travel(&self, k: usize, t: f64) -> f64 {
        let ahead = self.ahead[k] * self.elapsed(t).min(self.stretch).powi(2);
        self.travel[k].max(self.to_travel[k] * self.time(t).powi(2)).max(ahead)
    }

    fn time(&self, t: f64) -> f64 {
        if self.is_singular { self.omega.recip() } else { self.elapsed(t) }
    }

    /// For how long accelerations have led to speed until `t`, s.
    fn elapsed(&self, t: f64) -> f64 {
        let response = self.omega.recip();
        let least = if self.onset > 0.0 && response.is_finite() { self.onset * response } else { 0.0 };
        (t - self.since).max(least).min(response)
    }
}
