//! Works over a step whose method integrates them with the motion, at its own order.

/// Terms of the polynomial within a step.
pub(crate) const TERMS: usize = 7;

/// Works of actuators and losses of joints, then what every element dissipates and is supplied with, J.
#[derive(Debug, Default)]
pub(crate) struct Works {
    /// Over the whole step.
    change: Vec<f64>,
    /// The terms of [`polynomial`].
    within: [Vec<f64>; TERMS],
}

impl Works {
    /// Takes those of a step, and the terms within it where they are known.
    pub(crate) fn take(&mut self, change: &[f64], within: Option<[&[f64]; TERMS]>) {
        self.change.clear();
        self.change.extend_from_slice(change);
        for (own, terms) in self.within.iter_mut().zip(within.into_iter().flatten()) {
            own.clear();
            own.extend_from_slice(terms);
        }
    }

    fn until(&self, at: usize, theta: f64) -> f64 {
        if theta == 1.0 {
            return self.change[at];
        }
        polynomial(self.within.each_ref().map(|term| term[at]), theta)[0]
    }

    /// Work of the actuators and losses of the joints from the start of the step to θ.
    pub(super) fn of_joints(&self, theta: f64) -> (f64, f64) {
        (self.until(0, theta), self.until(1, theta))
    }

    /// What element `e` dissipates and is supplied with until then.
    pub(super) fn of_element(&self, e: usize, theta: f64) -> (f64, f64) {
        (self.until(2 + 2 * e, theta), self.until(3 + 2 * e, theta))
    }
}

/// θ(t_0 + (1 − θ)(t_1 + θ(t_2 + (1 − θ)(t_3 + …)))) and its derivative by θ (Hairer, Nørsett & Wanner, Solving ODEs I, II.6).
pub(crate) fn polynomial(terms: [f64; TERMS], theta: f64) -> [f64; 2] {
    let rest = 1.0 - theta;
    terms.into_iter().enumerate().rev().fold([0.0; 2], |[value, slope], (term, own)| {
        let sum = value + own;
        if term % 2 == 0 { [sum * theta, slope * theta + sum] } else { [sum * rest, slope * rest - sum] }
    })
}
