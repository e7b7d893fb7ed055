//! Works over a step whose method integrates them with the motion, at its own order.

/// Terms of the polynomial within a step.
pub(crate) const TERMS: usize = 7;

/// Where works of elements begin: behind those of actuators and joints.
pub(crate) const OF_ELEMENT: usize = 2;
/// Of each element the first, and the second.
pub(crate) const DISSIPATED: usize = 0;
pub(crate) const SUPPLIED: usize = 1;

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

    /// Work `at` until θ.
    pub(crate) fn until(&self, at: usize, theta: f64) -> f64 {
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
        (self.until(OF_ELEMENT + 2 * e, theta), self.until(OF_ELEMENT + 2 * e + 1, theta))
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

/// The terms of [`polynomial`] of Σ_p c_p θ^{p+1}.
pub(crate) fn terms(c: [f64; TERMS]) -> [f64; TERMS] {
    let (mut left, mut terms) = (c, [0.0; TERMS]);
    for (m, term) in terms.iter_mut().enumerate() {
        let count = TERMS - m;
        if m % 2 == 0 {
            // r(θ) = r(1) + (1 − θ) s(θ), with s_p = −Σ_{k > p} r_k.
            *term = left[..count].iter().sum();
            let mut above = 0.0;
            for p in (0..count).rev() {
                let own = left[p];
                left[p] = -above;
                above += own;
            }
        } else {
            *term = left[0];
            left.copy_within(1..count, 0);
        }
    }
    terms
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_those_of_the_polynomial() {
        let c = [0.3, -1.2, 0.7, 2.1, -0.4, 0.9, -1.7];
        for theta in [0.0, 0.3, 0.8, 1.0] {
            let powers = |p: usize| f64::powi(theta, p as i32);
            let value: f64 = (0..TERMS).map(|p| c[p] * powers(p + 1)).sum();
            let slope: f64 = (0..TERMS).map(|p| c[p] * (p + 1) as f64 * powers(p)).sum();
            let [found, rate] = polynomial(terms(c), theta);
            assert!(
                (found - value).abs() < 1e-14 && (rate - slope).abs() < 1e-13,
                "{theta}: {found} {value}, {rate} {slope}"
            );
        }
    }
}
