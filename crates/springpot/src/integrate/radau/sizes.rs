//! How large a motion is, so that a relative tolerance means the same from a nanometre to a kilometre.

use crate::model::Model;
use serde::{Deserialize, Serialize};

/// Relative tolerance of the motion's own size, and what it need not fall below.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tolerance {
    pub(super) rtol: f64,
    /// 0 where none was asked for.
    pub(super) atol: f64,
}

impl Tolerance {
    pub(super) fn of(&self, size: f64) -> f64 {
        self.atol.max(self.rtol * size.abs())
    }
}

/// The largest travel |q − q(0)| and speed |v| of every velocity, so far and as the forces at a start or restart let expect.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Sizes {
    from: Vec<f64>,
    travel: Vec<f64>,
    speed: Vec<f64>,
    expected_travel: Vec<f64>,
    expected_speed: Vec<f64>,
}

impl Sizes {
    pub(super) fn new(q: &[f64], nv: usize) -> Self {
        let zero = vec![0.0; nv];
        Self {
            from: q.to_vec(),
            travel: zero.clone(),
            speed: zero.clone(),
            expected_travel: zero.clone(),
            expected_speed: zero,
        }
    }

    /// Takes a state of the run in.
    pub(super) fn take(&mut self, model: &Model, q: &[f64], v: &[f64]) {
        let travel = model.difference(&self.from, q);
        for (largest, value) in self.travel.iter_mut().zip(&travel).chain(self.speed.iter_mut().zip(v)) {
            *largest = largest.max(value.abs());
        }
    }

    /// Where accelerations `a` begin in a system that answers them at the rate `omega` (rad/s): a/ω and a/ω².
    pub(super) fn expect(&mut self, a: &[f64], omega: f64) {
        let expected = self.expected_travel.iter_mut().zip(&mut self.expected_speed);
        for ((travel, speed), a) in expected.zip(a).filter(|(_, a)| a.is_finite()) {
            *speed = speed.max(a.abs() / omega);
            *travel = travel.max(a.abs() / (omega * omega));
        }
    }

    pub(super) fn speed(&self, k: usize) -> f64 {
        self.speed[k].max(self.expected_speed[k])
    }

    pub(super) fn travel(&self, k: usize) -> f64 {
        self.travel[k].max(self.expected_travel[k])
    }
}
