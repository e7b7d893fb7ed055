//! The hysteretic variable of Bouc and Wen, whatever moves it.

use crate::collocation::{MAX_NODES, Nodes};
use crate::dual::{Dual, Real};
use crate::law::catalog::{Param, Range};
use crate::law::rule::RuleError;

/// Iterations for z at the nodes.
const MOST_ITERATIONS: usize = 60;

/// Change of z, in units of the largest, at which they end; they converge quadratically.
const ENOUGH: f64 = 1e-12;

/// What is known at the start of a step and at its nodes.
pub(super) type Values<T = f64> = [T; MAX_NODES + 1];

/// How what is known at the nodes follows something there.
pub(super) type Matrix = [[f64; MAX_NODES]; MAX_NODES];

/// z' = A·v − gamma·|v|·z·|z|^(n−1) − beta·v·|z|^n (Bouc 1967, Wen 1976), v the rate of a stroke, of a part of it, or of a charge.
///
/// A force alpha·z along v stores alpha·z²/(2A) and dissipates (alpha/A)·|z|^(n+1)·(gamma·|v| + beta·v·sgn z) ≥ 0. z' has a kink where v
/// turns round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hysteresis {
    a: Dual,
    beta: Dual,
    gamma: Dual,
    n: Dual,
}

impl Hysteresis {
    /// A without unit, beta and gamma in 1/mⁿ.
    ///
    /// # Errors
    /// [`RuleError`]: A > 0, n ≥ 1, gamma ≥ |beta| so that it dissipates, gamma + beta > 0 so that z is bounded.
    pub fn new(
        a: impl Into<Dual>,
        beta: impl Into<Dual>,
        gamma: impl Into<Dual>,
        n: impl Into<Dual>,
    ) -> Result<Self, RuleError> {
        let own = Self { a: a.into(), beta: beta.into(), gamma: gamma.into(), n: n.into() };
        let [a, beta, gamma, n] = own.of();
        RuleError::unless(a > 0.0, "A > 0", "A")?;
        RuleError::unless(n >= 1.0, "n ≥ 1", "n")?;
        RuleError::unless(gamma >= f64::abs(beta), "gamma ≥ |beta|", "gamma")?;
        RuleError::unless(gamma + beta > 0.0, "gamma + beta > 0", "beta")?;
        Ok(own)
    }

    /// A, beta, gamma and n.
    fn of<T: Real>(&self) -> [T; 4] {
        [self.a, self.beta, self.gamma, self.n].map(T::of)
    }

    /// The same, to be changed.
    pub(super) fn numbers(&mut self) -> [&mut Dual; 4] {
        [&mut self.a, &mut self.beta, &mut self.gamma, &mut self.n]
    }

    /// A: z' per unit of v where z = 0.
    pub fn slope_at_rest<T: Real>(&self) -> T {
        T::of(self.a)
    }

    /// z'.
    pub fn rate<T: Real>(&self, z: T, v: T) -> T {
        let [a, beta, gamma, n] = self.of::<T>();
        a * v - z.abs().powf(n) * (gamma * v.abs() * sign(z).into() + beta * v)
    }

    /// ∂z'/∂z and ∂z'/∂v.
    fn slopes(&self, z: f64, v: f64) -> [f64; 2] {
        let [a, beta, gamma, n] = self.of::<f64>();
        let power = z.abs().powf(n);
        let by_z = -n * z.abs().powf(n - 1.0) * (gamma * v.abs() + beta * v * sign(z));
        [by_z, a - power * (gamma * sign(v) * sign(z) + beta)]
    }

    /// |z|^(n+1)·(gamma·|v| + beta·v·sgn z) ≥ 0: what it dissipates under a force A·z.
    pub fn lost<T: Real>(&self, z: T, v: T) -> T {
        let [_, beta, gamma, n] = self.of::<T>();
        z.abs().powf(n + 1.0.into()) * (gamma * v.abs() + beta * v * sign(z).into())
    }

    /// The largest |z| that strokes lead to.
    fn largest(&self) -> f64 {
        let [a, beta, gamma, n] = self.of::<f64>();
        (a / (gamma + beta)).powf(n.recip())
    }

    /// z at the start and at the nodes of a step of size h, and ∂z_i/∂v_j: z_i = z_0 + h Σ_j A_ij z'_j by Newton's method; NaN where that
    /// finds none.
    ///
    /// `matrix` is A of so many nodes, `rate` v at the start and at the nodes. Where z itself holds v back, v_j = rate_j − Σ_k `back`_jk z_k, and derivatives are those by
    /// `rate`.
    pub fn solve(
        &self,
        (count, matrix): (usize, &Matrix),
        h: f64,
        rate: &[f64],
        back: Option<&Matrix>,
        start: f64,
    ) -> (Values, Matrix) {
        // Beyond what it can be the powers would throw the iteration far off.
        let bound = 2.0 * self.largest().max(start.abs());
        let mut z = [start; MAX_NODES + 1];
        let mut tangent = Matrix::default();
        let way = way(&rate[..=count]);
        for _ in 0..MOST_ITERATIONS {
            // (I − h A diag(∂z'/∂z)) against h A diag(∂z'/∂v) and against the residual.
            let mut system = [[0.0; 2 * MAX_NODES + 1]; MAX_NODES];
            for i in 0..count {
                system[i][i] = 1.0;
                let mut residual = start - z[i + 1];
                for j in 0..count {
                    let held = back.map_or(0.0, |back| (0..count).map(|k| back[j][k] * z[k + 1]).sum());
                    let (weight, at) = (h * matrix[i][j], (z[j + 1], rate[j + 1] - held));
                    // What is held back is looked for with it: there the sign is that of the search.
                    let side = if back.is_none() { on_the_way(at.1, way) } else { at.1 };
                    let [by_z, by_v] = self.slopes(at.0, side);
                    system[i][j] -= weight * by_z;
                    if let Some(back) = back {
                        (0..count).for_each(|k| system[i][k] += weight * by_v * back[j][k]);
                    }
                    system[i][MAX_NODES + j] = weight * by_v;
                    residual += weight * self.rate(at.0, at.1);
                }
                system[i][2 * MAX_NODES] = residual;
            }
            eliminate(&mut system, count);
            let (mut change, mut size) = (0.0f64, f64::MIN_POSITIVE);
            for i in 0..count {
                let next = (z[i + 1] + system[i][2 * MAX_NODES]).clamp(-bound, bound);
                // Not `max`, which would pass over what is no number.
                let moved = (next - z[i + 1]).abs();
                change = if moved > change || moved.is_nan() { moved } else { change };
                z[i + 1] = next;
                size = size.max(next.abs());
                tangent[i] = std::array::from_fn(|j| system[i][MAX_NODES + j]);
            }
            if change <= ENOUGH * size {
                return (z, tangent);
            }
        }
        ([f64::NAN; MAX_NODES + 1], [[f64::NAN; MAX_NODES]; MAX_NODES])
    }

    /// z with its derivatives, where [`Self::solve`] has found `z`; `moved` is v at the start and at the nodes with its derivatives where z stays.
    pub(super) fn follow(
        &self,
        (count, matrix): (usize, &Matrix),
        h: f64,
        moved: &[Dual],
        back: Option<&Matrix>,
        start: Dual,
        z: &Values,
    ) -> Values<Dual> {
        // (I − h A diag(∂z'/∂z)) δz = δz_0 + h A δz', of which v at the nodes follows z by −∂z'/∂v·back.
        let mut system = [[0.0; MAX_NODES + 1]; MAX_NODES];
        let way = way(&Dual::values(&moved[..=count]));
        for (i, row) in system.iter_mut().enumerate().take(count) {
            row[i] = 1.0;
            row[MAX_NODES] = start.slope;
            for j in 0..count {
                let (weight, v) = (h * matrix[i][j], moved[j + 1]);
                let v = Dual { value: on_the_way(v.value, way), ..v };
                let [by_z, by_v] = self.slopes(z[j + 1], v.value);
                row[j] -= weight * by_z;
                if let Some(back) = back {
                    (0..count).for_each(|k| row[k] += weight * by_v * back[j][k]);
                }
                row[MAX_NODES] += weight * self.rate(z[j + 1].into(), v).slope;
            }
        }
        eliminate(&mut system, count);
        std::array::from_fn(|k| match k {
            0 => start,
            _ if k <= count => Dual { value: z[k], slope: system[k - 1][MAX_NODES] },
            _ => Dual::default(),
        })
    }
}

/// Share of the largest rate below which one is 0 but for rounding.
const AT_REST: f64 = 1e-10;

/// The largest of the rates of a step, with its sign.
fn way(rate: &[f64]) -> f64 {
    rate.iter().fold(0.0, |way: f64, rate| if rate.abs() > way.abs() { *rate } else { way })
}

/// A rate on the side of the others where it is 0 but for rounding: a step ends where the stroke turns round, and is all on one side of that.
fn on_the_way(v: f64, way: f64) -> f64 {
    if v.abs() <= AT_REST * way.abs() { v.abs().max(f64::MIN_POSITIVE).copysign(way) } else { v }
}

/// −1, 0 or 1.
fn sign(x: impl Real) -> f64 {
    match x.value() {
        0.0 => 0.0,
        x => x.signum(),
    }
}

/// Solves the leading `count` rows for their right sides.
pub(super) fn eliminate<const WIDTH: usize>(system: &mut [[f64; WIDTH]; MAX_NODES], count: usize) {
    for k in 0..count {
        let pivot = (k..count).max_by(|&a, &b| system[a][k].abs().total_cmp(&system[b][k].abs())).unwrap_or(k);
        system.swap(k, pivot);
        let scale = system[k][k];
        system[k].iter_mut().for_each(|entry| *entry /= scale);
        for i in (0..count).filter(|&i| i != k) {
            let (factor, row) = (system[i][k], system[k]);
            system[i].iter_mut().zip(row).for_each(|(entry, other)| *entry -= factor * other);
        }
    }
}

/// The inverse of diag(`own`) + `share`·A: what maps drives to rates where each rate r_i meets own_i·r_i and share·h times what it has become.
pub(super) fn resolvent(nodes: Nodes, own: &[f64], share: f64) -> Matrix {
    let (count, matrix) = (nodes.count(), nodes.matrix());
    let mut system = [[0.0; 2 * MAX_NODES]; MAX_NODES];
    for i in 0..count {
        (0..count).for_each(|j| system[i][j] = share * matrix[i][j]);
        system[i][i] += own[i];
        system[i][MAX_NODES + i] = 1.0;
    }
    eliminate(&mut system, count);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| if i < count && j < count { system[i][MAX_NODES + j] } else { 0.0 })
    })
}

/// A, beta, gamma and n, in the order of [`Hysteresis::new`]; beta and gamma by the unit of z.
pub(in crate::law) fn params(per: &'static str) -> [Param; 4] {
    [
        Param::new("A", "", "rate of z per unit of x' where z = 0", Range { low: f64::MIN_POSITIVE, high: f64::MAX }),
        Param::new("beta", per, "shape of the loops", Range::ANY),
        Param::new("gamma", per, "shape of the loops, |beta| or more", Range::NOT_NEGATIVE),
        Param::new("n", "", "how sharply it yields", Range { low: 1.0, high: f64::MAX }),
    ]
}
