//! Linear models of first order: what a robot with memories does near rest, for whoever designs controllers.

mod fit;
mod power;
mod realise;

pub use fit::{LineariseError, ModelOrder, linearise};

use super::assembly::Owner;
use num_complex::Complex64;

/// x' = A x + B u, y = C x + D u: small motions about rest with every memory as a few decays.
///
/// SI units throughout; matrices are rows. Where the input moves a joint its own coordinates are taken about what the input does at once:
/// then a state is not the coordinate that it is called after, and the outputs are right all the same.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearModel {
    /// A, n × n, 1/s.
    pub a: Vec<Vec<f64>>,
    /// B, n × inputs.
    pub b: Vec<Vec<f64>>,
    /// C, outputs × n.
    pub c: Vec<Vec<f64>>,
    /// D, outputs × inputs.
    pub d: Vec<Vec<f64>>,
    /// What the n states are.
    pub states: Vec<State>,
    /// The largest relative deviation of a channel's frequency response from the exact one over the band.
    pub error: f64,
}

/// A state of a linear model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct State {
    /// What it is.
    pub kind: StateKind,
    pub(super) owner: Owner,
}

/// What a state is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum StateKind {
    /// The coordinate of a velocity, m or rad.
    Position,
    /// A velocity, m/s or rad/s.
    Velocity,
    /// A stroke inside a law, m or rad; of a controller the integral of an error, m·s or rad·s.
    Inner,
    /// A decay of a memory: the stroke of its dashpot, m or rad.
    Memory,
    /// The same of the integral of an error, m·s or rad·s.
    MemoryOfIntegral,
}

/// To whom a state belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum StateOwner {
    /// A velocity of the robot.
    Velocity(usize),
    /// An element.
    Element(usize),
    /// The controller of a velocity.
    Controller(usize),
    /// The filter of its derivative, whose state is a force.
    Filter(usize),
}

impl State {
    /// To whom it belongs.
    pub fn owner(&self) -> StateOwner {
        match self.owner {
            Owner::Velocity(k) => StateOwner::Velocity(k),
            Owner::Element(e) => StateOwner::Element(e),
            Owner::Controller(k) => StateOwner::Controller(k),
            Owner::Filter(k) => StateOwner::Filter(k),
        }
    }
}

impl LinearModel {
    /// C (iω − A)⁻¹ B + D, outputs × inputs; `omega` in rad/s.
    pub fn frequency_response(&self, omega: f64) -> Vec<Vec<Complex64>> {
        let n = self.a.len();
        let entry = |r: usize, c: usize| Complex64::new(-self.a[r][c], if r == c { omega } else { 0.0 });
        let matrix = (0..n * n).map(|k| entry(k / n, k % n)).collect();
        let lu = crate::linalg::ComplexLu::new(n, matrix);
        let inputs = self.d.first().map_or(0, Vec::len);
        let columns: Vec<Vec<Complex64>> = (0..inputs)
            .map(|i| lu.solve(&self.b.iter().map(|row| Complex64::from(row[i])).collect::<Vec<_>>()))
            .collect();
        let of = |c: &[f64], d: &[f64]| -> Vec<Complex64> {
            let one = |(column, d): (&Vec<Complex64>, &f64)| {
                c.iter().zip(column).map(|(c, x)| x * *c).sum::<Complex64>() + *d
            };
            columns.iter().zip(d).map(one).collect()
        };
        self.c.iter().zip(&self.d).map(|(c, d)| of(c, d)).collect()
    }

    /// The eigenvalues of A, 1/s; `None` where the iteration does not end.
    pub fn poles(&self) -> Option<Vec<Complex64>> {
        let n = self.a.len();
        crate::linalg::eigenvalues(self.a.concat(), n)
    }
}
