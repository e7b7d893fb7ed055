//! The law nearest to a measured complex stiffness, and how well the measurement determines it.

use super::{Identified, Model, sin_cos};
use crate::law::catalog::Entry;
use crate::linalg::{are_independent, cholesky_solve};
use std::f64::consts::FRAC_PI_2;

/// Orders at which the least minimum is looked for, in steps of 1/ORDERS.
const ORDERS: usize = 16;
/// Most steps towards it.
const STEPS: usize = 100;
/// A step below this is none.
const STILL: f64 = 1e-15;
/// The least order that is looked at: at 0 spring and springpot are the same, and nothing is lost.
const LEAST: f64 = 1e-6;
/// An order this near to 1 is 1.
const END: f64 = 1e-12;

/// One row of a dynamic measurement: K = storage + i·loss at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Angular frequency, rad/s; positive.
    pub omega: f64,
    /// Re K, N/m; positive.
    pub storage: f64,
    /// Im K, N/m; positive.
    pub loss: f64,
}

/// A law fitted to a measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitted {
    /// The law.
    pub law: Identified,
    /// Covariance of k, c and alpha, in the products of their units; zero beside a parameter that is not free or lies at an end of its
    /// range.
    pub covariance: [[f64; 3]; 3],
    /// √(Σ|K(ω) − K_j|²/|K_j|²/n) over the n rows.
    pub rms: f64,
    /// The largest |K(ω) − K_j|/|K_j|.
    pub largest: f64,
    /// The row that has it, from 0.
    pub farthest: usize,
}

impl Fitted {
    /// One standard deviation of the parameter of that name in the catalog's row; `None` where the law has no such parameter, or
    /// where it lies at an end of its range.
    pub fn spread(&self, name: &str) -> Option<f64> {
        let value = self.law.parameter(name)?;
        let (at, most) = match name {
            "k" => (0, f64::INFINITY),
            "c" => (1, f64::INFINITY),
            _ => (2, 1.0),
        };
        (value > 0.0 && value < most).then(|| self.covariance[at][at].sqrt())
    }
}

/// Why a measurement determines no law.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// A law that such data do not determine ([`Model::of`]).
    #[error("the law {law:?} has parameters that such data say nothing about")]
    OtherLaw {
        /// The law.
        law: String,
    },
    /// A number that is not positive and finite.
    #[error("{what} is {value}, but must be positive and finite")]
    NotPositive {
        /// Its row, from 0.
        row: usize,
        /// `frequency`, `storage` or `loss`.
        what: &'static str,
        /// The number, SI.
        value: f64,
    },
    /// Too few rows for parameters and their spread.
    #[error("{given} {}, and the law {law} needs at least {needed}", if *given == 1 { "row" } else { "rows" })]
    TooFew {
        /// The law.
        law: String,
        /// Rows needed.
        needed: usize,
        /// Rows given.
        given: usize,
    },
    /// Rows that repeat the same frequencies.
    #[error("the law {law} needs at least {needed} different frequencies, and the rows have {given}")]
    SameFrequency {
        /// The law.
        law: String,
        /// Frequencies needed.
        needed: usize,
        /// Different ones that there are.
        given: usize,
    },
    /// The rows leave a parameter open.
    #[error("the rows leave the law {law} open: its parameters change them in the same way")]
    Undetermined {
        /// The law.
        law: String,
    },
}

/// Fits K(ω) = k + c·(iω)^alpha, or what of it `law` has, to a measurement: the smallest Σ|K(ω_j) − K_j|²/|K_j|² with k ≥ 0, c ≥ 0 and
/// 0 ≤ alpha ≤ 1, in time and memory proportional to the rows.
///
/// k and c are linear and follow in closed form for each alpha (variable projection: G. H. Golub, V. Pereyra, SIAM J. Numer. Anal. 10
/// (1973) 413–432); the least minimum over alpha is found on a grid, then where the derivative changes its sign.
///
/// The covariance is that of the linearised jackknife, every row left out once, with J the derivatives of the relative deviations r
/// and H_j = J_j (JᵀJ)⁻¹ J_jᵀ: (n − 1)/n·Σ d_j d_jᵀ, d_j = (JᵀJ)⁻¹ J_jᵀ (1 − H_j)⁻¹ r_j (J. G. MacKinnon, H. White, J. Econometrics 29
/// (1985) 305–325). It asks neither that storage and loss scatter alike nor that they scatter apart; rows must scatter
/// independently of one another. What the law itself cannot follow counts as scatter.
///
/// # Errors
/// [`FitError`]: a law of another form, numbers that are not positive, fewer than three rows, or too few different frequencies: two,
/// and three for a law of three parameters.
///
/// ```
/// use springpot::law::Catalog;
/// use springpot::law::datasheet::{Identified, Measured, Model, fit};
/// let mount = Identified { model: Model::FractionalKelvinVoigt, stiffness: 2000.0, coefficient: 800.0, order: 0.35 };
/// let rows: Vec<Measured> = [1.0, 10.0, 100.0, 1000.0]
///     .map(|omega| {
///         let [storage, loss] = mount.complex_stiffness(omega);
///         Measured { omega, storage, loss }
///     })
///     .to_vec();
/// let catalog = Catalog::standard();
/// let found = fit(catalog.get("fractional-kelvin-voigt").expect("a law that comes with Springpot"), &rows)?;
/// assert!((found.law.order - 0.35).abs() < 1e-12 && found.largest < 1e-12);
/// # Ok::<(), springpot::law::datasheet::FitError>(())
/// ```
pub fn fit(law: &Entry, rows: &[Measured]) -> Result<Fitted, FitError> {
    let name = || law.name.to_string();
    let model = Model::of(law).ok_or_else(|| FitError::OtherLaw { law: name() })?;
    check(&law.name, model, rows)?;
    let problem = Problem::new(model, rows);
    let order = problem.order();
    let [k, c] = problem.linear(order);
    let law = Identified {
        model,
        stiffness: k * problem.stiffness,
        coefficient: c * problem.stiffness / problem.omega.powf(order),
        order,
    };
    let covariance = problem.covariance([k, c, order]).ok_or_else(|| FitError::Undetermined { law: name() })?;
    let (rms, largest, farthest) = misfit(rows, |omega| law.complex_stiffness(omega));
    Ok(Fitted { law, covariance, rms, largest, farthest })
}

/// Root mean square and largest of the deviations |K*(ω) − measured|/|measured|, and the row of the latter.
pub(super) fn misfit(rows: &[Measured], stiffness: impl Fn(f64) -> [f64; 2]) -> (f64, f64, usize) {
    let (mut square, mut largest, mut farthest) = (0.0, 0.0, 0);
    for (row, Measured { omega, storage, loss }) in rows.iter().enumerate() {
        let [re, im] = stiffness(*omega);
        let deviation = (re - storage).hypot(im - loss) / storage.hypot(*loss);
        square += deviation * deviation / rows.len() as f64;
        if deviation > largest {
            (largest, farthest) = (deviation, row);
        }
    }
    (square.sqrt(), largest, farthest)
}

fn check(law: &str, model: Model, rows: &[Measured]) -> Result<(), FitError> {
    // With every row left out once, the others must determine the law.
    check_rows(law, rows, if model.parameter_count() == 3 { 3 } else { 2 })
}

/// Refuses rows that are not positive, fewer than three or than are `needed`, and fewer frequencies than are `needed`.
pub(super) fn check_rows(law: &str, rows: &[Measured], needed: usize) -> Result<(), FitError> {
    for (row, Measured { omega, storage, loss }) in rows.iter().enumerate() {
        for (what, value) in [("frequency", *omega), ("storage", *storage), ("loss", *loss)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(FitError::NotPositive { row, what, value });
            }
        }
    }
    let least = needed.max(3);
    if rows.len() < least {
        return Err(FitError::TooFew { law: law.to_owned(), needed: least, given: rows.len() });
    }
    let mut frequencies: Vec<f64> = rows.iter().map(|row| row.omega).collect();
    frequencies.sort_unstable_by(f64::total_cmp);
    frequencies.dedup();
    match frequencies.len() {
        given if given < needed => Err(FitError::SameFrequency { law: law.to_owned(), needed, given }),
        _ => Ok(()),
    }
}

/// A row without dimension.
#[derive(Clone, Copy)]
struct Row {
    /// ln(ω/ω₀).
    log: f64,
    /// K₀/|K_j|.
    weight: f64,
    /// K_j/|K_j|.
    goal: [f64; 2],
}

/// The rows beside their scales, with k/K₀, c·ω₀^alpha/K₀ and alpha as unknowns.
struct Problem {
    rows: Vec<Row>,
    free: [bool; 3],
    /// K₀, the geometric mean, N/m.
    stiffness: f64,
    /// ω₀, the geometric mean, rad/s.
    omega: f64,
}

/// The end of an interval that stayed in the last step.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Neither,
    Low,
    High,
}

impl Problem {
    fn new(model: Model, rows: &[Measured]) -> Self {
        let mean = |of: &dyn Fn(&Measured) -> f64| (rows.iter().map(of).sum::<f64>() / rows.len() as f64).exp();
        let omega = mean(&|row| row.omega.ln());
        let stiffness = mean(&|row| row.storage.hypot(row.loss).ln());
        let scaled = |row: &Measured| {
            let size = row.storage.hypot(row.loss);
            Row { log: (row.omega / omega).ln(), weight: stiffness / size, goal: [row.storage / size, row.loss / size] }
        };
        Self { rows: rows.iter().map(scaled).collect(), free: model.free(), stiffness, omega }
    }

    /// The order of the least minimum.
    fn order(&self) -> f64 {
        let [_, _, true] = self.free else { return 1.0 };
        let order = |step: usize| (step as f64 / ORDERS as f64).max(LEAST);
        let cost = |step: usize| self.cost(order(step), self.linear(order(step)));
        let costs: Vec<f64> = (0..=ORDERS).map(cost).collect();
        let best = (0..=ORDERS).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
        let found = self.level(order(best.saturating_sub(1)), order((best + 1).min(ORDERS)));
        // Where the cost has two valleys between two steps of the grid, the grid may be nearer.
        let is_better = self.cost(found, self.linear(found)) <= costs[best];
        match if is_better { found } else { order(best) } {
            order if order <= LEAST => 0.0,
            order if order > 1.0 - END => 1.0,
            order => order,
        }
    }

    /// Where the cost falls no more between two orders: false position with the Illinois rule, which halves the value of an end that stays.
    fn level(&self, mut low: f64, mut high: f64) -> f64 {
        // Where k and c are the best ones, only the partial derivative by the order is left of the total one.
        let slope = |order: f64| self.slope(order, self.linear(order));
        let (mut below, mut above) = (slope(low), slope(high));
        if below >= 0.0 {
            return low;
        }
        if above <= 0.0 {
            return high;
        }
        let (mut last, mut stayed) = (low, Side::Neither);
        for _ in 0..STEPS {
            let next = low - below * (high - low) / (above - below);
            let at = slope(next);
            if at == 0.0 || (next - last).abs() <= STILL || next <= low || next >= high {
                return next.clamp(low, high);
            }
            last = next;
            if at < 0.0 {
                (low, below) = (next, at);
                above *= if stayed == Side::High { 0.5 } else { 1.0 };
                stayed = Side::High;
            } else {
                (high, above) = (next, at);
                below *= if stayed == Side::Low { 0.5 } else { 1.0 };
                stayed = Side::Low;
            }
        }
        last
    }

    /// The best k ≥ 0 and c ≥ 0 for this order.
    fn linear(&self, order: f64) -> [f64; 2] {
        let (sin, cos) = sin_cos(order);
        let (mut spring, mut both, mut springpot, mut to) = (0.0, 0.0, 0.0, [0.0; 2]);
        for Row { log, weight, goal } in &self.rows {
            let part = weight * (order * log).exp();
            spring += weight * weight;
            both += weight * part * cos;
            springpot += part * part;
            to[0] += weight * goal[0];
            to[1] += part * (goal[0] * cos + goal[1] * sin);
        }
        let alone = [[to[0] / spring, 0.0], [0.0, to[1] / springpot]];
        match self.free {
            [true, false, _] => return alone[0],
            [false, _, _] => return alone[1],
            _ => {}
        }
        let determinant = spring * springpot - both * both;
        let found = [(to[0] * springpot - to[1] * both) / determinant, (to[1] * spring - to[0] * both) / determinant];
        if found.iter().all(|value| *value >= 0.0 && value.is_finite()) {
            return found;
        }
        // Each alone lowers the sum of squares by (its product with the data)²/(its own square).
        alone[usize::from(to[1] * to[1] / springpot > to[0] * to[0] / spring)]
    }

    /// Deviations of one row, relative to |K_j|, and their derivatives by the unknowns.
    fn deviation(row: &Row, [k, c, order]: [f64; 3], (sin, cos): (f64, f64)) -> [(f64, [f64; 3]); 2] {
        let part = row.weight * (order * row.log).exp();
        let [re, im] = [part * cos, part * sin];
        [
            (k * row.weight + c * re - row.goal[0], [row.weight, re, c * (row.log * re - FRAC_PI_2 * im)]),
            (c * im - row.goal[1], [0.0, im, c * (row.log * im + FRAC_PI_2 * re)]),
        ]
    }

    fn deviations(&self, [k, c]: [f64; 2], order: f64) -> impl Iterator<Item = [(f64, [f64; 3]); 2]> {
        let turn = sin_cos(order);
        self.rows.iter().map(move |row| Self::deviation(row, [k, c, order], turn))
    }

    fn cost(&self, order: f64, linear: [f64; 2]) -> f64 {
        self.deviations(linear, order).flatten().map(|(value, _)| value * value).sum()
    }

    /// Half the derivative of the cost by the order.
    fn slope(&self, order: f64, linear: [f64; 2]) -> f64 {
        self.deviations(linear, order).flatten().map(|(value, by)| value * by[2]).sum()
    }

    /// Covariance of k, c and alpha in SI; `None` where the rows leave one of them open.
    fn covariance(&self, [k, c, order]: [f64; 3]) -> Option<[[f64; 3]; 3]> {
        let inside = [k > 0.0, c > 0.0, order > 0.0 && order < 1.0];
        let active: [bool; 3] = std::array::from_fn(|i| self.free[i] && inside[i]);
        let rows = || {
            let masked = move |(value, by): (f64, [f64; 3])| {
                (value, std::array::from_fn(|i| if active[i] { by[i] } else { 0.0 }))
            };
            self.deviations([k, c], order).map(move |row| row.map(masked))
        };
        let columns = (0..3).filter(|i| active[*i]);
        if !are_independent(columns.map(|i| rows().flatten().map(|(_, by): (f64, [f64; 3])| by[i]).collect())) {
            return None;
        }
        let mut normal = [[0.0; 3]; 3];
        for (_, by) in rows().flatten() {
            add_product(&mut normal, &by);
        }
        for i in (0..3).filter(|i| !active[*i]) {
            normal[i][i] = 1.0;
        }
        let mut covariance = [[0.0; 3]; 3];
        for [(re, by_re), (im, by_im)] in rows() {
            let (of_re, of_im) = (cholesky_solve(normal, by_re)?, cholesky_solve(normal, by_im)?);
            let [a, b, d] = [1.0 - dot(&by_re, &of_re), -dot(&by_re, &of_im), 1.0 - dot(&by_im, &of_im)];
            let determinant = a * d - b * b;
            let left_out = [(d * re - b * im) / determinant, (a * im - b * re) / determinant];
            add_product(&mut covariance, &std::array::from_fn(|i| of_re[i] * left_out[0] + of_im[i] * left_out[1]));
        }
        let count = self.rows.len() as f64;
        // c = c'·K₀/ω₀^alpha moves with alpha too.
        let scale = self.stiffness / self.omega.powf(order);
        let to_si = [[self.stiffness, 0.0, 0.0], [0.0, scale, -c * scale * self.omega.ln()], [0.0, 0.0, 1.0]];
        let entry = |i: usize, j: usize| {
            let half = |m: usize| dot(&covariance[m], &to_si[j]);
            (count - 1.0) / count * (0..3).map(|m| to_si[i][m] * half(m)).sum::<f64>()
        };
        let si: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)));
        si.iter().flatten().all(|value| value.is_finite()).then_some(si)
    }
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Adds v·vᵀ.
fn add_product(sum: &mut [[f64; 3]; 3], v: &[f64; 3]) {
    for i in 0..3 {
        for j in 0..3 {
            sum[i][j] += v[i] * v[j];
        }
    }
}
